//! A field, its scene and a groom give the motion of every strand.
//!
//! *Invariant:* this crate has never heard of markers: it sees what a field file holds and nothing else.

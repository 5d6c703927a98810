//! What travels in the messages, and its translation from and to the vocabulary.
//!
//! The types here are the format's own and stay as they are for ever, whatever becomes of the vocabulary's.

pub(crate) mod edits;
pub(crate) mod foxglove;
pub(crate) mod manifest;
pub(crate) mod proto;
pub(crate) mod scene;
pub(crate) mod tags;
pub(crate) mod unique;
pub(crate) mod v0;

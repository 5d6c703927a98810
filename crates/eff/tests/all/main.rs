//! All tests of the field file in one program: each by itself would compile the reader, the writer and their libraries
//! once more, as these are generic over where bytes come from and go to.

#![allow(clippy::unwrap_used)]

mod arbitrary;
mod bad;
mod exercise;
mod forge;
mod good;

mod conformance;
mod damage;
mod fuzz;
mod reader;
mod recover;
mod round_trip;
mod seeds;

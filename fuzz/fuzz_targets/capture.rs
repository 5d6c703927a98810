//! Any bytes through the guess at a capture's format and the reader it leads to.
#![no_main]
#![allow(dead_code, reason = "the file has a function for each of two targets")]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/ingest/tests/support/exercise.rs"]
mod exercise;

fuzz_target!(|bytes: &[u8]| exercise::exercise_capture(bytes));

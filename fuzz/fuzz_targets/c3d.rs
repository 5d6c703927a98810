//! Any bytes through the C3D reader, and what it can read through the writer and back.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/c3d/tests/support/exercise.rs"]
mod exercise;

fuzz_target!(|bytes: &[u8]| exercise::exercise(bytes));

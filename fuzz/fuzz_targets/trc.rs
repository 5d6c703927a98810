//! Any bytes through the TRC reader.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/trc/tests/support/exercise.rs"]
mod exercise;

fuzz_target!(|bytes: &[u8]| exercise::exercise(bytes));

//! Any bytes through the readers of Vicon and Motive CSV.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/csv/tests/support/exercise.rs"]
mod exercise;

fuzz_target!(|bytes: &[u8]| exercise::exercise(bytes));

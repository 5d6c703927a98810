//! Any bytes, their checksums made right, through the reader of single steps and of parts.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../crates/eff/tests/all/exercise/mod.rs"]
mod exercise;

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = bytes.to_vec();
    exercise::refit(&mut bytes);
    exercise::read_in_parts(&bytes);
});

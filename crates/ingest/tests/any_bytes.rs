//! Whatever the bytes, there is an answer and no panic.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/exercise.rs"]
mod exercise;

use exercise::{exercise_capture, exercise_session};
use proptest::prelude::*;

/// Beginnings that lead a guess to each reader.
const BEGINNINGS: [&[u8]; 6] = [
    b"",
    b"\x02\x50\x00\x00",
    b"DataRate\tUnits\n1\tmm\nFrame#\tTime\tA\n",
    b"Format Version,1.23\n,Type,Marker,Marker,Marker\n,Name,A,A,A\n,,Position,Position,Position\nFrame,Time,X,Y,Z\n",
    b"Trajectories\n100\n,,A,,\nFrame,Sub Frame,X,Y,Z\n,,mm,mm,mm\n",
    b"{\"strands\": [",
];

proptest! {
    #[test]
    fn there_is_an_answer(
        beginning in 0..BEGINNINGS.len(),
        bytes in prop::collection::vec(prop_oneof![any::<u8>(), prop::sample::select(b"0123456789.,-\n\r\";:{}[]".to_vec())], 0..600),
    ) {
        let bytes = [BEGINNINGS[beginning], &bytes].concat();
        exercise_capture(&bytes);
        exercise_session(&bytes);
    }
}

/// The seeds of the fuzz target `capture`, and inputs that once failed.
#[test]
fn every_seed_of_a_capture() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/capture");
    let seeds: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    assert!(!seeds.is_empty());
    for seed in seeds {
        exercise_capture(&std::fs::read(seed).unwrap());
    }
}

/// The seeds of the fuzz target `session`, and inputs that once failed.
#[test]
fn every_seed_of_a_session() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/session");
    let seeds: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    assert!(!seeds.is_empty());
    for seed in seeds {
        exercise_session(&std::fs::read(seed).unwrap());
    }
}

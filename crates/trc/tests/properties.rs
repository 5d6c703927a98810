//! What holds for every sequence of bytes.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

#[path = "support/exercise.rs"]
mod exercise;

use exercise::exercise;
use proptest::prelude::*;
use proptest::sample::Index;

const TRC: &str = "PathFileType\t4\t(X/Y/Z)\ttrial.trc\r\n\
    DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\r\n\
    100.00\t100.00\t2\t2\tmm\t100.00\t1\t2\r\nFrame#\tTime\tLFHD\t\t\tNOSE\t\t\r\n\
    \t\tX1\tY1\tZ1\tX2\tY2\tZ2\r\n\r\n7\t0.00\t165.1\t331.8\t1508.1\t\t\t\r\n8\t0.01\t165.2\t331.9\tNaN\t1.5\t2.5\t3.5\r\n";

proptest! {
    /// No damage to a file makes the reader panic.
    #[test]
    fn damaged_files_are_read_or_refused(
        damage in prop::collection::vec((any::<Index>(), any::<Option<u8>>()), 1..8),
        comma in any::<bool>(),
    ) {
        let mut bytes = if comma { TRC.replace('\t', ",") } else { TRC.to_owned() }.into_bytes();
        for (place, with) in damage {
            let idx = place.index(bytes.len());
            match with {
                Some(byte) => bytes[idx] = byte,
                None => drop(bytes.remove(idx)),
            }
        }
        exercise(&bytes);
    }

    /// No bytes make the reader panic.
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let header = b"DataRate\tUnits\n1\tmm\nFrame#\tTime\tA\n";
        let below = [&header[..], &bytes].concat();
        exercise(&bytes);
        exercise(&below);
    }
}

/// The seeds of the fuzz target, and inputs that once failed.
#[test]
fn every_seed() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fuzz/seeds/trc");
    let seeds: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    assert!(!seeds.is_empty());
    for seed in seeds {
        exercise(&std::fs::read(seed).unwrap());
    }
}

//! Damaged files: every flipped bit is noticed, every cut is found, nothing panics.

use crate::arbitrary::small_file;
use tousle_eff::{Code, ReadOptions, read, validate};

/// One bit of every seventh byte, another one from byte to byte.
#[test]
fn flipped_bytes_are_noticed() {
    let mut bytes = small_file();
    for at in (0..bytes.len()).step_by(7) {
        flip(&mut bytes, at, at % 8);
    }
}

#[test]
#[ignore = "takes minutes; the test above takes a bit here and there"]
fn every_flipped_bit_is_noticed() {
    let mut bytes = small_file();
    for at in 0..bytes.len() {
        for bit in 0..8 {
            flip(&mut bytes, at, bit);
        }
    }
}

fn flip(bytes: &mut [u8], at: usize, bit: usize) {
    bytes[at] ^= 1 << bit;
    assert!(!validate(&*bytes).unwrap().is_sound, "byte {at}, bit {bit}");
    assert!(read(&*bytes, &ReadOptions::default()).is_err(), "byte {at}, bit {bit}");
    bytes[at] ^= 1 << bit;
}

#[test]
fn cuts_are_found() {
    let bytes = small_file();
    for length in (0..bytes.len()).step_by(11) {
        let validation = validate(&bytes[..length]).unwrap();
        assert!(validation.errors().any(|f| f.code == Code::Cut), "{length} {:?}", validation.findings);
        assert!(read(&bytes[..length], &ReadOptions::default()).is_err(), "{length}");
    }
}

#[test]
fn what_follows_the_end_is_found() {
    let mut bytes = small_file();
    bytes.push(0);
    let codes: Vec<_> = validate(&bytes[..]).unwrap().findings.into_iter().map(|f| f.code).collect();
    assert_eq!(codes, [Code::Trailing]);
}

#[test]
fn noise_is_no_file() {
    let mut noise = 1u64;
    let bytes: Vec<u8> = std::iter::repeat_with(|| {
        noise = noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (noise >> 33) as u8
    })
    .take(5000)
    .collect();
    for start in 0..200 {
        assert!(!validate(&bytes[start..]).unwrap().is_sound);
    }
    assert_eq!(validate(&b""[..]).unwrap().findings[0].code, Code::Cut);
}

//! Bytes that nobody meant: mutated field files, most of them with right checksums, so that what lies behind the
//! checksums is reached. Nothing may panic, and whoever accepts a file must agree with the others.
//!
//! Some thousand in every test run, the same each time; for longer, with other ones:
//!
//!     TOUSLE_FUZZ_SECS=1200 cargo test --release -p tousle-eff --test all fuzz

use crate::exercise::{all_agree, refit};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// A small fast generator (xorshift64*), the same on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() >> 33) as usize % n.max(1)
    }
}

#[test]
fn no_bytes_panic_and_all_readers_agree() {
    let secs = std::env::var("TOUSLE_FUZZ_SECS").ok().map(|s| s.parse().unwrap());
    let end = secs.map(|secs| Instant::now() + Duration::from_secs(secs));
    let mut random = Random(secs.map_or(1, |_| u64::from(std::process::id())) | 1);
    let seeds = seeds();
    let mut n = 0u64;
    let mut n_sound = 0u64;
    while end.map_or(n < 3000, |end| Instant::now() < end) {
        let mut bytes = seeds[random.below(seeds.len())].clone();
        for _ in 0..=random.below(3) {
            mutate(&mut bytes, &mut random);
        }
        if random.below(8) > 0 {
            refit(&mut bytes);
        }
        n_sound += u64::from(all_agree(&bytes));
        n += 1;
    }
    println!("{n} files, {n_sound} of them still sound");
    assert!(n_sound > 0 && n_sound < n);
}

/// Sound files in which mutations reach far: their chunks are not packed.
fn seeds() -> Vec<Vec<u8>> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/eff");
    let mut seeds = Vec::new();
    for kind in ["v1/good", "v0/good"] {
        let mut paths: Vec<_> =
            fs::read_dir(fixtures.join(kind)).unwrap().map(|e| e.unwrap().path()).collect();
        paths.sort();
        for path in paths.iter().filter(|p| p.extension().is_some_and(|e| e == "mcap")) {
            seeds.push(fs::read(path).unwrap());
        }
    }
    let stranger = fs::read(fixtures.join("v1/good/stranger.eff.mcap")).unwrap();
    seeds.extend(std::iter::repeat_n(stranger, 20));
    seeds
}

fn mutate(bytes: &mut Vec<u8>, random: &mut Random) {
    // Half of them near the beginning, where the messages are and not the schemas.
    let at =
        if random.below(2) == 0 { random.below(bytes.len()) } else { random.below(bytes.len().min(6000)) };
    let interesting = [0, 1, 0x7f, 0x80, 0xff, 0x7f80_0000, 0x7fff_ffff, u64::MAX, 1 << 40, 1 << 63];
    match random.below(7) {
        0 => bytes.truncate(at),
        1 => {
            let end = (at + random.below(20)).min(bytes.len());
            drop(bytes.drain(at..end));
        }
        2 => {
            let end = (at + random.below(40)).min(bytes.len());
            let copy = bytes[at..end].to_vec();
            let to = random.below(bytes.len());
            bytes.splice(to..to, copy);
        }
        3 => {
            let value = interesting[random.below(interesting.len())].to_le_bytes();
            let n = [1, 2, 4, 8][random.below(4)];
            let end = (at + n).min(bytes.len());
            bytes[at..end].copy_from_slice(&value[..end - at]);
        }
        4 if !bytes.is_empty() => bytes[at] = random.next() as u8,
        5 if !bytes.is_empty() => bytes[at] = bytes[at].wrapping_add([1, 255][random.below(2)]),
        _ if !bytes.is_empty() => bytes[at] ^= 1 << random.below(8),
        _ => {}
    }
    if bytes.is_empty() {
        bytes.push(0x89);
    }
}

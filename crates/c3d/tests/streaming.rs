//! Reading holds a piece of the file, however long the trial, and touches only the frames asked for.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use std::io::{Read, Result, Seek, SeekFrom};
use support::{File, float};
use tousle_c3d::{Point, Reader};

const FRAMES: usize = 4_000_000;

/// A file of four million frames that exists only where it is read: zeros behind a real start, all of them points at
/// the origin. Remembers what was asked of it.
struct Endless {
    start: Vec<u8>,
    n_bytes: u64,
    at: u64,
    n_read: usize,
    longest_read: usize,
}

impl Endless {
    fn new() -> Self {
        let file = File { last_frame: 65535, data: vec![], ..File::default() };
        let start = file.with(&[float(1, "LONG_FRAMES", FRAMES as f32)]).bytes();
        let n_bytes = start.len() as u64 + 16 * FRAMES as u64;
        Self { start, n_bytes, at: 0, n_read: 0, longest_read: 0 }
    }
}

impl Read for Endless {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize> {
        let n = bytes.len().min((self.n_bytes - self.at) as usize);
        for (i, byte) in bytes[..n].iter_mut().enumerate() {
            *byte = self.start.get(self.at as usize + i).copied().unwrap_or(0);
        }
        self.at += n as u64;
        self.n_read += n;
        self.longest_read = self.longest_read.max(bytes.len());
        Ok(n)
    }
}

impl Seek for Endless {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::End(by) => self.n_bytes.checked_add_signed(by).unwrap(),
            SeekFrom::Current(by) => self.at.checked_add_signed(by).unwrap(),
        };
        Ok(self.at)
    }
}

#[test]
fn frames_are_read_a_piece_at_a_time() {
    let mut source = Endless::new();
    let mut n_frames = 0;
    let mut reader = Reader::new(&mut source).unwrap();
    let count = |frame: usize, points: &[Option<Point>]| {
        assert_eq!((frame, points), (n_frames, &[Some(Point::default())][..]));
        n_frames += 1;
    };
    reader.read_frames(&[0], 0..FRAMES, count).unwrap();
    assert_eq!(n_frames, FRAMES);
    assert!(source.longest_read <= 64 * 1024, "{} bytes at once", source.longest_read);
}

#[test]
fn only_what_is_asked_for_is_read() {
    let mut source = Endless::new();
    let mut reader = Reader::new(&mut source).unwrap();
    assert_eq!(reader.info().n_frames, FRAMES);
    let trajectories = reader.read_trajectories(&[0], 3_000_000..3_000_010).unwrap();
    assert_eq!(trajectories, [[Some(Point::default()); 10]]);
    // Header, parameters and ten frames.
    assert!(source.n_read < 4096, "{} bytes read", source.n_read);
}

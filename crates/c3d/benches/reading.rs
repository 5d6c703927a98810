//! Reading speed per byte beside the crate `c3dio` and beside a plain read of the same bytes.
//!
//! `made_up` is written by our own writer: 60 markers, 6,000 frames, floats. With the folder of shared data in
//! `TOUSLE_SHARED`, `corpus` is every file of the mocap corpus that `c3dio` reads rightly, `no_analog` those of them
//! without analog samples, which `c3dio` decodes and we step over.
#![allow(clippy::unwrap_used, reason = "a measurement may fail")]

use divan::counter::BytesCount;
use divan::{Bencher, black_box};
use std::fs::File;
use std::io::{Read, Seek};
use std::path::PathBuf;
use tousle_c3d::{Point, Reader, Trial, Writer};

fn main() {
    if std::env::var_os("TOUSLE_SHARED").is_none() {
        eprintln!("only made-up data: TOUSLE_SHARED is not set");
    }
    divan::main();
}

const SETS: [&str; 3] = ["made_up", "corpus", "no_analog"];

/// Every point of every frame.
#[divan::bench(args = SETS)]
fn all_points(bencher: Bencher<'_, '_>, set: &str) {
    measure(bencher, set, |path| all(&mut Reader::new(File::open(path).unwrap()).unwrap()));
}

/// Every point of every frame, of bytes in memory.
#[divan::bench(args = SETS)]
fn all_points_in_memory(bencher: Bencher<'_, '_>, set: &str) {
    let files: Vec<Vec<u8>> = files(set).iter().map(|path| std::fs::read(path).unwrap()).collect();
    let n_bytes: usize = files.iter().map(Vec::len).sum();
    bencher.counter(BytesCount::new(n_bytes)).bench_local(|| {
        for bytes in &files {
            black_box(all(&mut Reader::from_bytes(bytes).unwrap()));
        }
    });
}

/// The first point of every frame.
#[divan::bench(args = SETS)]
fn one_point(bencher: Bencher<'_, '_>, set: &str) {
    measure(bencher, set, |path| {
        let mut reader = Reader::new(File::open(path).unwrap()).unwrap();
        let n_frames = reader.info().n_frames;
        let first: &[usize] = if reader.info().n_points == 0 { &[] } else { &[0] };
        reader.read_trajectories(first, 0..n_frames).unwrap()
    });
}

#[divan::bench(args = SETS)]
fn c3dio(bencher: Bencher<'_, '_>, set: &str) {
    measure(bencher, set, |path| c3dio::C3d::load_path(path.clone()).unwrap());
}

#[divan::bench(args = SETS)]
fn plain_read(bencher: Bencher<'_, '_>, set: &str) {
    measure(bencher, set, |path| std::fs::read(path).unwrap());
}

fn measure<T>(bencher: Bencher<'_, '_>, set: &str, read: impl Fn(&PathBuf) -> T) {
    let files = files(set);
    let n_bytes: u64 = files.iter().map(|path| path.metadata().unwrap().len()).sum();
    bencher.counter(BytesCount::new(n_bytes)).bench_local(|| {
        for path in &files {
            black_box(read(path));
        }
    });
}

fn all<R: Read + Seek>(reader: &mut Reader<R>) -> Vec<Vec<Option<Point>>> {
    let n_frames = reader.info().n_frames;
    let all: Vec<_> = (0..reader.info().n_points).collect();
    reader.read_trajectories(&all, 0..n_frames).unwrap()
}

fn files(set: &str) -> Vec<PathBuf> {
    match (set, std::env::var_os("TOUSLE_SHARED")) {
        ("made_up", _) => vec![made_up()],
        (_, None) => Vec::new(),
        (_, Some(shared)) => corpus(&PathBuf::from(shared).join("corpus/mocap"), set == "no_analog"),
    }
}

/// The files that `c3dio` reads rightly, by the corpus's own account.
fn corpus(corpus: &std::path::Path, only_without_analog: bool) -> Vec<PathBuf> {
    let expected = std::fs::read(corpus.join("expected.json")).unwrap();
    let expected: serde_json::Value = serde_json::from_slice(&expected).unwrap();
    let files = expected["files"].as_object().unwrap().iter();
    files
        .filter(|(_, entry)| entry["rust_crates"]["c3dio 0.8.0"] == "right")
        .filter(|(_, entry)| !only_without_analog || entry["expected"]["analog"]["channels"] == 0)
        .map(|(name, _)| corpus.join(name))
        .collect()
}

fn made_up() -> PathBuf {
    let path = std::env::temp_dir().join("tousle-c3d-made-up.c3d");
    let labels: Vec<String> = (0..60).map(|i| format!("S{i:02}")).collect();
    let (n_frames, unit) = (6_000, Some("mm".to_owned()));
    let trial = Trial { rate_hz: 240.0, n_frames, unit, labels, ..Trial::default() };
    let mut writer = Writer::new(Vec::new(), &trial).unwrap();
    for frame in 0..n_frames {
        let point =
            |i: usize| (!(frame + i).is_multiple_of(50)).then(|| Point::at([frame as f32, i as f32, 1.0]));
        writer.write_frame(&(0..60).map(point).collect::<Vec<_>>()).unwrap();
    }
    std::fs::write(&path, writer.finish().unwrap()).unwrap();
    path
}

//! Reading speed per byte of the text formats, to a whole `Capture`, beside a plain read of the same bytes and
//! beside a pass that only looks at each byte. C3D has a measurement of its own beside the crate `c3dio`.
//!
//! `made_up_*` are written here: 60 markers, 3,000 frames. With the folder of shared data in `TOUSLE_SHARED`, the
//! others are the files of the mocap corpus that can be read.
#![allow(clippy::unwrap_used, reason = "a measurement may fail")]

use divan::counter::BytesCount;
use divan::{Bencher, black_box};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use tousle_core::LengthUnit;
use tousle_ingest::{IngestOptions, read_capture, summarize};

fn main() {
    if std::env::var_os("TOUSLE_SHARED").is_none() {
        eprintln!("only made-up data: TOUSLE_SHARED is not set");
    }
    divan::main();
}

const SETS: [&str; 5] = ["made_up_vicon", "made_up_trc", "vicon-csv", "motive-csv", "trc"];

/// From a file to positions in meters.
#[divan::bench(args = SETS)]
fn capture(bencher: Bencher<'_, '_>, set: &str) {
    let unit = Some(LengthUnit::Millimeter);
    let options = IngestOptions { unit, rate_hz: Some(100.0), allow_cut: true, ..IngestOptions::default() };
    measure(bencher, set, |path| read_capture(&std::fs::read(path).unwrap(), &options).unwrap());
}

/// From a file to what `tousle inspect` says of it.
#[divan::bench(args = SETS)]
fn inspect(bencher: Bencher<'_, '_>, set: &str) {
    measure(bencher, set, |path| summarize(&std::fs::read(path).unwrap()).unwrap());
}

/// What a line counter costs.
#[divan::bench(args = SETS)]
fn each_byte(bencher: Bencher<'_, '_>, set: &str) {
    measure(bencher, set, |path| {
        let bytes = std::fs::read(path).unwrap();
        bytes.iter().filter(|b| matches!(b, b'\n' | b',' | b'\t')).count()
    });
}

#[divan::bench(args = SETS)]
fn plain_read(bencher: Bencher<'_, '_>, set: &str) {
    measure(bencher, set, |path| std::fs::read(path).unwrap());
}

fn measure<T>(bencher: Bencher<'_, '_>, set: &str, read: impl Fn(&Path) -> T) {
    let files = files(set);
    let n_bytes: u64 = files.iter().map(|path| std::fs::metadata(path).unwrap().len()).sum();
    bencher.counter(BytesCount::new(n_bytes)).bench_local(|| {
        for path in &files {
            black_box(read(path));
        }
    });
}

fn files(set: &str) -> Vec<PathBuf> {
    if let Some(format) = set.strip_prefix("made_up_") {
        let path = std::env::temp_dir().join(format!("tousle-reading.{format}"));
        std::fs::write(&path, if format == "trc" { trc() } else { vicon() }).unwrap();
        return vec![path];
    }
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else { return Vec::new() };
    let folder = PathBuf::from(shared).join("corpus/mocap").join(set);
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    let options = IngestOptions {
        unit: Some(LengthUnit::Millimeter),
        rate_hz: Some(100.0),
        allow_cut: true,
        ..IngestOptions::default()
    };
    files.retain(|path| read_capture(&std::fs::read(path).unwrap(), &options).is_ok());
    files.sort();
    files
}

const N_MARKERS: usize = 60;
const N_FRAMES: usize = 3000;

/// Six digits, as programs write them.
fn coordinate(frame: usize, marker: usize, axis: usize) -> f64 {
    900.0 + 700.0 * libm::sin((frame * 7 + marker * 13 + axis * 29) as f64 * 0.01)
}

fn vicon() -> String {
    let mut text = String::from("Trajectories\n100\n,,");
    (0..N_MARKERS).for_each(|m| write!(text, "Wig:M{m},,,").unwrap());
    let columns = |cell: &str| vec![cell; 3 * N_MARKERS].join(",");
    let xyz = vec!["X,Y,Z"; N_MARKERS].join(",");
    write!(text, "\nFrame,Sub Frame,{xyz}\n,,{}\n", columns("mm")).unwrap();
    for frame in 0..N_FRAMES {
        write!(text, "{},0", frame + 1).unwrap();
        for k in 0..3 * N_MARKERS {
            write!(text, ",{:.4}", coordinate(frame, k / 3, k % 3)).unwrap();
        }
        text.push('\n');
    }
    text
}

fn trc() -> String {
    let mut text = format!(
        "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n\
         100\t100\t{N_FRAMES}\t{N_MARKERS}\tmm\nFrame#\tTime"
    );
    (0..N_MARKERS).for_each(|m| write!(text, "\tM{m}\t\t").unwrap());
    text.push_str("\n\t");
    (1..=N_MARKERS).for_each(|m| write!(text, "\tX{m}\tY{m}\tZ{m}").unwrap());
    text.push_str("\n\n");
    for frame in 0..N_FRAMES {
        write!(text, "{}\t{:.2}", frame + 1, frame as f64 * 0.01).unwrap();
        for k in 0..3 * N_MARKERS {
            write!(text, "\t{:.4}", coordinate(frame, k / 3, k % 3)).unwrap();
        }
        text.push('\n');
    }
    text
}

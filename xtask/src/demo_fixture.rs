//! The capture that `tousle demo` carries: the beginning of a longer one, as 16-bit C3D.

use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use tousle_c3d::{Point, Reader, Storage, Trial, Writer};

/// Frames that are kept: a still second and three of wind.
const N_FRAMES: usize = 480;
/// One step of a coordinate, mm: half the best cameras' noise.
const SCALE_MM: f32 = 0.1;

/// Writes `fixtures/demo` from the folder of a capture.
pub fn make(capture: &Path) -> Result<()> {
    let name = capture.file_name().context("the folder has no name")?.to_string_lossy().into_owned();
    let out = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../fixtures/demo"));
    fs::create_dir_all(&out)?;
    let read = |file: &str| fs::read(capture.join(file)).with_context(|| format!("cannot read {file}"));
    fs::write(out.join("gusts.c3d"), cut(&read(&format!("{name}.c3d"))?)?)?;
    let mut session: serde_json::Value = serde_json::from_slice(&read("session.json")?)?;
    session["name"] = "gusts".into();
    session["frames"] = N_FRAMES.into();
    fs::write(out.join("session.json"), serde_json::to_string_pretty(&session)? + "\n")?;
    let groom: serde_json::Value = serde_json::from_slice(&read("style_b.json")?)?;
    fs::write(out.join("bob.json"), serde_json::to_string(&groom)? + "\n")?;
    Ok(())
}

/// The first frames of a C3D file, stored as integers.
fn cut(bytes: &[u8]) -> Result<Vec<u8>> {
    let mut reader = Reader::new(std::io::Cursor::new(bytes))?;
    let info = reader.info().clone();
    let n_frames = N_FRAMES.min(info.n_frames);
    let wanted: Vec<usize> = (0..info.n_points).collect();
    let trajectories = reader.read_trajectories(&wanted, 0..n_frames)?;
    let trial = Trial {
        storage: Storage::Int16,
        scale: SCALE_MM,
        rate_hz: info.rate_hz.unwrap_or(120.0) as f32,
        first_frame: info.first_frame,
        n_frames,
        unit: info.unit.clone(),
        labels: info.labels.clone(),
        ..Trial::default()
    };
    let mut writer = Writer::new(Vec::new(), &trial)?;
    for frame in 0..n_frames {
        let points: Vec<Option<Point>> = trajectories.iter().map(|t| t[frame]).collect();
        writer.write_frame(&points)?;
    }
    Ok(writer.finish()?)
}

//! The truth beside a capture: where hair and head really went, and the wind.

use crate::{ReferenceLock, TrueMotion, TrueWind};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use tousle_core::{PoseTrack, Vec3};
use tousle_export::{NpzError, read_numbers_npz, read_poses_npz};
use tousle_field::GridSpec;

/// The truth of one capture. For judging only: nothing in it may be an input to what is judged.
#[derive(Clone, Debug)]
pub struct Truth {
    capture: PathBuf,
    facts: Facts,
}

/// What makes a truth folder unusable.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TruthError {
    /// A file cannot be read.
    #[error("{file}: cannot be read")]
    Io {
        /// The file, as seen from the capture's folder.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// A JSON file does not hold what it should.
    #[error("{file}: not as expected")]
    Json {
        /// The file, as seen from the capture's folder.
        file: String,
        /// Where and what.
        source: serde_json::Error,
    },
    /// An array is not as it should be.
    #[error("{file}")]
    Array {
        /// The file, as seen from the capture's folder.
        file: String,
        /// Where and what.
        source: NpzError,
    },
    /// Two files disagree.
    #[error("{file}: found {found}, expected {expected}")]
    Mismatch {
        /// The file, as seen from the capture's folder.
        file: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
}

/// What `truth/truth.json` says, as far as it is used here.
#[derive(Clone, Debug, Deserialize)]
struct Facts {
    name: String,
    marker_strand: Vec<String>,
    reference_lock: LockFacts,
    air: AirFacts,
}

#[derive(Clone, Debug, Deserialize)]
struct LockFacts {
    lock_width_m: f64,
    linear_density_kg_per_m: f64,
}

#[derive(Clone, Debug, Deserialize)]
struct AirFacts {
    density_kg_m3: f64,
    kinematic_viscosity_m2_s: f64,
}

/// What `style_b.json` says, as far as it is used here.
#[derive(Deserialize)]
struct StyleB {
    strands: Vec<StyleBStrand>,
}

#[derive(Deserialize)]
struct StyleBStrand {
    name: String,
}

impl Truth {
    /// Opens the truth of the capture in a folder, `truth/` within it.
    ///
    /// # Errors
    /// [`TruthError`] if `truth/truth.json` is not there or not as it should be.
    pub fn open(capture: &Path) -> Result<Self, TruthError> {
        let facts = read_json(capture, "truth/truth.json")?;
        Ok(Self { capture: capture.to_owned(), facts })
    }

    /// The capture's name.
    pub fn name(&self) -> &str {
        &self.facts.name
    }

    /// Where the control points of the other hairstyle, `style_b.json`, really go in this wind.
    ///
    /// # Errors
    /// [`TruthError`] if a file is not there or not as it should be.
    pub fn style_b(&self) -> Result<TrueMotion, TruthError> {
        let groom: StyleB = read_json(&self.capture, "style_b.json")?;
        let npz = self.npz("truth/style_b.npz")?;
        let times_secs: Vec<f64> = npz.numbers("t", &[0])?;
        let counts = npz.numbers("counts", &[groom.strands.len()])?;
        let counts: Vec<usize> = counts.into_iter().map(|n| n as usize).collect();
        let n_points = counts.iter().sum();
        let positions_m = npz.vectors("pos", &[times_secs.len(), n_points, 3])?;
        let names = groom.strands.into_iter().map(|s| s.name);
        Ok(TrueMotion { times_secs, positions_m, locks: names.zip(counts).collect(), starts_at_root: true })
    }

    /// Where the captured wig's markers really went, by true identity.
    ///
    /// # Errors
    /// [`TruthError`] if the file is not there or not as it should be.
    pub fn markers(&self) -> Result<TrueMotion, TruthError> {
        let npz = self.npz("truth/markers.npz")?;
        let strands = &self.facts.marker_strand;
        let times_secs: Vec<f64> = npz.numbers("t", &[0])?;
        let positions_m = npz.vectors("pos_head", &[times_secs.len(), strands.len(), 3])?;
        let locks: Vec<(String, usize)> =
            strands.chunk_by(|a, b| a == b).map(|lock| (lock[0].clone(), lock.len())).collect();
        if !locks.is_sorted_by(|a, b| a.0 < b.0) {
            return Err(TruthError::Mismatch {
                file: "truth/truth.json".to_owned(),
                found: "markers of one lock apart".to_owned(),
                expected: "lock after lock".to_owned(),
            });
        }
        Ok(TrueMotion { times_secs, positions_m, locks, starts_at_root: false })
    }

    /// The true wind on the grid.
    ///
    /// # Errors
    /// [`TruthError`] if the file is not there or not as it should be.
    pub fn wind(&self) -> Result<TrueWind, TruthError> {
        const N: usize = 30;
        let npz = self.npz("truth/field.npz")?;
        let times_secs: Vec<f64> = npz.numbers("t", &[0])?;
        let t = times_secs.len();
        let (lock, air) = (&self.facts.reference_lock, &self.facts.air);
        Ok(TrueWind {
            grid: GridSpec { origin_m: Vec3::repeat(-0.3), edge_m: 0.02, dims: [N; 3] },
            velocity_quanta: npz.numbers("u_q", &[t, 3, N, N, N])?.into_iter().map(|q| q as i8).collect(),
            scale_mps: npz.numbers("scale", &[])?[0] as f32,
            solid: npz.mask("solid", &[N, N, N])?,
            hair: npz.mask("hair", &[t, N, N, N])?,
            times_secs,
            reference_lock: ReferenceLock {
                lock_width_m: lock.lock_width_m,
                linear_density_kg_per_m: lock.linear_density_kg_per_m,
                air_density: air.density_kg_m3,
                kinematic_viscosity: air.kinematic_viscosity_m2_s,
            },
        })
    }

    /// The head's true poses.
    ///
    /// # Errors
    /// [`TruthError`] if the file is not there or not as it should be.
    pub fn head(&self) -> Result<PoseTrack, TruthError> {
        const FILE: &str = "truth/head.npz";
        read_poses_npz(&read(&self.capture, FILE)?)
            .map_err(|source| TruthError::Array { file: FILE.to_owned(), source })
    }

    fn npz(&self, file: &'static str) -> Result<Npz, TruthError> {
        Ok(Npz { file, bytes: read(&self.capture, file)? })
    }
}

/// An archive of the truth folder, with its name for messages.
struct Npz {
    file: &'static str,
    bytes: Vec<u8>,
}

impl Npz {
    /// An array of numbers, first axis slowest; 0 in `shape` stands for any length.
    fn numbers(&self, key: &'static str, shape: &[usize]) -> Result<Vec<f64>, TruthError> {
        read_numbers_npz(&self.bytes, key, shape)
            .map_err(|source| TruthError::Array { file: self.file.to_owned(), source })
    }

    /// An array whose last axis is 3, as vectors.
    fn vectors(&self, key: &'static str, shape: &[usize]) -> Result<Vec<[f32; 3]>, TruthError> {
        let flat = self.numbers(key, shape)?;
        Ok(flat.chunks_exact(3).map(|p| [p[0] as f32, p[1] as f32, p[2] as f32]).collect())
    }

    /// An array as masks: everything but 0 is true.
    fn mask(&self, key: &'static str, shape: &[usize]) -> Result<Vec<bool>, TruthError> {
        Ok(self.numbers(key, shape)?.into_iter().map(|x| x != 0.0).collect())
    }
}

fn read(capture: &Path, file: &str) -> Result<Vec<u8>, TruthError> {
    std::fs::read(capture.join(file)).map_err(|source| TruthError::Io { file: file.to_owned(), source })
}

fn read_json<T: serde::de::DeserializeOwned>(capture: &Path, file: &str) -> Result<T, TruthError> {
    serde_json::from_slice(&read(capture, file)?)
        .map_err(|source| TruthError::Json { file: file.to_owned(), source })
}

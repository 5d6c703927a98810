//! A capture's folder, as far as everything that judges it is the same.

use crate::{Truth, TruthError};
use std::path::{Path, PathBuf};
use tousle_core::{Groom, STANDARD_GRAVITY, Session};
use tousle_field::Scene;
use tousle_groom::GroomOptions;

/// A capture with its session, the other hairstyle, and the truth.
#[derive(Clone, Debug)]
pub struct CaptureFolder {
    folder: PathBuf,
    name: String,
    /// The truth, for judging only.
    pub truth: Truth,
}

/// What keeps a capture from being benched.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BenchError {
    /// The folder of captures cannot be listed.
    #[error("cannot list the captures in {}", folder.display())]
    List {
        /// The folder.
        folder: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// There is nothing to bench.
    #[error("found no capture in {}, expected folders that hold truth/truth.json", folder.display())]
    NoCaptures {
        /// The folder.
        folder: PathBuf,
    },
    /// A capture that was asked for is not there.
    #[error("found no capture {name} in {}, expected one of {}", folder.display(), there.join(", "))]
    NoSuchCapture {
        /// Its name.
        name: String,
        /// The folder.
        folder: PathBuf,
        /// The names of those that are there.
        there: Vec<String>,
    },
    /// The system gives no thread.
    #[error("cannot start a thread")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A file of the capture cannot be used.
    #[error("capture {capture}: {stage} failed")]
    Stage {
        /// The capture's name.
        capture: String,
        /// What failed.
        stage: &'static str,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl CaptureFolder {
    /// All captures with a truth beside them in a folder, by name.
    ///
    /// # Errors
    /// [`BenchError`] if there is none, or a truth cannot be read.
    pub fn all(captures: &Path) -> Result<Vec<Self>, BenchError> {
        let list = |source| BenchError::List { folder: captures.to_owned(), source };
        let mut found = Vec::new();
        for entry in std::fs::read_dir(captures).map_err(list)? {
            let folder = entry.map_err(list)?.path();
            if folder.join("truth").join("truth.json").is_file() {
                found.push(Self::open(&folder)?);
            }
        }
        found.sort_by(|a, b| a.name.cmp(&b.name));
        if found.is_empty() {
            return Err(BenchError::NoCaptures { folder: captures.to_owned() });
        }
        Ok(found)
    }

    /// Those of [`CaptureFolder::all`] that are named; all if none is.
    ///
    /// # Errors
    /// As [`CaptureFolder::all`], and if one is not there.
    pub fn named(captures: &Path, names: &[String]) -> Result<Vec<Self>, BenchError> {
        let mut found = Self::all(captures)?;
        if let Some(name) = names.iter().find(|name| found.iter().all(|folder| folder.name != **name)) {
            let there = found.into_iter().map(|folder| folder.name).collect();
            return Err(BenchError::NoSuchCapture { name: name.clone(), folder: captures.to_owned(), there });
        }
        found.retain(|folder| names.is_empty() || names.contains(&folder.name));
        Ok(found)
    }

    /// The capture in a folder that is named like it.
    ///
    /// # Errors
    /// [`BenchError`] if the truth cannot be read.
    pub fn open(folder: &Path) -> Result<Self, BenchError> {
        let name = folder.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let truth = Truth::open(folder).map_err(failed(&name, "reading the truth"))?;
        Ok(Self { folder: folder.to_owned(), name, truth })
    }

    /// The capture's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The bytes of the capture, as CSV.
    pub fn csv(&self) -> Result<Vec<u8>, BenchError> {
        self.bytes(&format!("{}.csv", self.name))
    }

    /// The bytes of the session.
    pub fn session_bytes(&self) -> Result<Vec<u8>, BenchError> {
        self.bytes("session.json")
    }

    /// The other hairstyle, which nobody captured.
    ///
    /// # Errors
    /// [`BenchError`] if its file cannot be used.
    pub fn style_b(&self) -> Result<Groom, BenchError> {
        let bytes = self.bytes("style_b.json")?;
        let read = tousle_groom::read_groom(&bytes, &GroomOptions::default());
        Ok(read.map_err(failed(&self.name, "reading style B"))?.groom)
    }

    /// The true poses, and what the session says of body and air.
    ///
    /// # Errors
    /// [`BenchError`] if a file cannot be used.
    pub fn true_scene(&self) -> Result<Scene, BenchError> {
        let session: Session = tousle_ingest::read_session(&self.session_bytes()?)
            .map_err(failed(&self.name, "reading the session"))?;
        let poses = self.truth.head().map_err(self.truth_failed())?;
        Ok(Scene {
            rest_pose: poses.poses[0],
            poses,
            // The captures' world is z up, whatever a session may say of it.
            gravity_world: tousle_core::Vec3::new(0.0, 0.0, -STANDARD_GRAVITY),
            air_density: session.air_density,
            body: session.body,
        })
    }

    pub(crate) fn truth_failed(&self) -> impl Fn(TruthError) -> BenchError {
        failed(&self.name, "reading the truth")
    }

    fn bytes(&self, file: &str) -> Result<Vec<u8>, BenchError> {
        tousle_pipeline::read_file(&self.folder.join(file)).map_err(failed(&self.name, "reading a file"))
    }
}

/// Turns a stage's error into a bench's.
pub(crate) fn failed<E: Into<Box<dyn std::error::Error + Send + Sync>>>(
    capture: &str,
    stage: &'static str,
) -> impl Fn(E) -> BenchError {
    move |source| BenchError::Stage { capture: capture.to_owned(), stage, source: source.into() }
}

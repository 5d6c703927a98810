//! `WindSamples` → `FieldSequence`: scattered vectors fill the grid.
//!
//! [`rasterize`] takes the vectors measured at markers and gives every voxel of every time step a vector and a
//! flag that says where it came from. Method `paper` follows section 3.3 of the 2008 paper.

mod paper;
mod physical;

use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::{Progress, Vec3, WindSamples};
use tousle_field::{Field, FieldSequence, GridSpec, VoxelFlag};
use tousle_flow::AirFlow;

/// Which method fills the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum RasterMethod {
    /// Kazama, Sugisaki and Morishima 2008, section 3.3.
    #[default]
    Paper,
    /// The air that the method `physical` of `fit` found, at every voxel's center.
    Physical,
}

/// How the grid is filled.
#[derive(Clone, Debug, PartialEq)]
pub struct RasterOptions {
    /// The method.
    pub method: RasterMethod,
    /// Where the voxels are.
    pub grid: GridSpec,
    /// Whether standard deviations are wanted, which take as long as all the rest; without them nothing is `Interpolated`. Only
    /// the method `physical` knows any.
    pub with_sd: bool,
}

/// The field, and what happened on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// The field, without layers.
    pub sequence: FieldSequence,
    /// What happened.
    pub report: RasterReport,
}

/// Where the voxels of all steps came from.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RasterReport {
    /// Voxels times steps that held a marker.
    pub n_measured: u64,
    /// Voxels times steps between measured ones.
    pub n_interpolated: u64,
    /// Voxels times steps taken from the outside wind.
    pub n_outside: u64,
    /// Samples that lay outside the grid and were not used.
    pub n_samples_outside: u64,
    /// Time steps without any measured voxel: all of them is outside wind.
    pub n_steps_empty: u64,
}

/// Why no field can be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RasterError {
    /// There are no time steps.
    #[error("found samples of 0 time steps, expected at least 1")]
    Empty,
    /// Every step needs a wind outside.
    #[error("found the outside wind of {found} steps, expected {expected}")]
    OutsideMismatch {
        /// Steps of outside wind.
        found: usize,
        /// Steps of samples.
        expected: usize,
    },
    /// The method needs air that another one knows nothing of.
    #[error("found samples without the air they are of, which the method physical lays on the grid")]
    NoAir,
    /// The markers are all outside the grid.
    #[error("none of {n_samples} samples lies in the grid of {extent_mm} mm about the head")]
    NothingInGrid {
        /// Samples in all steps.
        n_samples: u64,
        /// The grid's extent along x, mm.
        extent_mm: f64,
    },
}

/// Fills the grid with wind from samples and the wind outside.
///
/// In: head-space samples by time step and one outside vector a step, in the same quantity. Out: a vector and a
/// flag for each voxel center and step. Steps are independent of one another and run in parallel; the result
/// does not depend on the number of threads.
///
/// # Errors
/// [`RasterError`] if there is no step, the outside does not match, or no sample lies in the grid.
pub fn rasterize(
    samples: &WindSamples,
    outside: &[Vec3],
    air: Option<&AirFlow>,
    options: &RasterOptions,
    progress: &dyn Progress,
) -> Result<Raster, RasterError> {
    let n_steps = samples.steps.len();
    if n_steps == 0 {
        return Err(RasterError::Empty);
    }
    if outside.len() != n_steps {
        return Err(RasterError::OutsideMismatch { found: outside.len(), expected: n_steps });
    }
    let grid = options.grid;
    let n_samples: u64 = samples.steps.iter().map(|s| s.len() as u64).sum();
    let n_inside = samples.steps.iter().flatten().filter(|s| grid.contains(s.position_m)).count() as u64;
    if n_inside == 0 {
        let extent_mm = grid.dims[0] as f64 * grid.edge_m * 1e3;
        return Err(RasterError::NothingInGrid { n_samples, extent_mm });
    }
    let done = AtomicU64::new(0);
    let laid = match (options.method, air) {
        (RasterMethod::Paper, _) => None,
        (RasterMethod::Physical, Some(air)) => Some(physical::Voxels::new(&grid, air, options.with_sd)),
        (RasterMethod::Physical, None) => return Err(RasterError::NoAir),
    };
    let fill = |(step, (samples, outside)): (usize, (&Vec<_>, &Vec3))| {
        let field = match &laid {
            None => paper::fill_step(&grid, samples, *outside),
            Some(voxels) => voxels.fill_step(step, samples),
        };
        progress.at(done.fetch_add(1, Ordering::Relaxed) + 1, n_steps as u64);
        field
    };
    let steps: Vec<Field> = samples.steps.par_iter().zip(outside).enumerate().map(fill).collect();
    let report = report(&steps, n_samples - n_inside);
    let (quantity, rate_hz) = (samples.quantity, samples.rate_hz);
    let sequence = FieldSequence { grid, quantity, start_secs: 0.0, rate_hz, steps, layers: Vec::new() };
    Ok(Raster { sequence, report })
}

fn report(steps: &[Field], n_samples_outside: u64) -> RasterReport {
    let count = |flag| steps.iter().flat_map(|s| &s.flags).filter(|f| **f == flag).count() as u64;
    let empty = |step: &&Field| !step.flags.contains(&VoxelFlag::Measured);
    RasterReport {
        n_measured: count(VoxelFlag::Measured),
        n_interpolated: count(VoxelFlag::Interpolated),
        n_outside: count(VoxelFlag::Outside),
        n_samples_outside,
        n_steps_empty: steps.iter().filter(empty).count() as u64,
    }
}

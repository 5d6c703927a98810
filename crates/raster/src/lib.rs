//! `WindSamples` → `FieldSequence`: scattered vectors fill the grid.
//!
//! [`rasterize`] takes the vectors measured at markers and gives every voxel of every time step a vector and a
//! flag that says where it came from. Method `paper` follows section 3.3 of the 2008 paper; `physical` asks the air that was
//! fitted, and [`add_deviations`] says how sure it is.

mod paper;
mod physical;

use rayon::prelude::*;
use serde::Serialize;
use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::{Progress, Vec3, WindSample, WindSamples};
use tousle_field::{Field, FieldSequence, GridSpec, VoxelFlag};
use tousle_flow::{AirFlow, STEPS_AT_ONCE};

/// Which method fills the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RasterMethod {
    /// Kazama, Sugisaki and Morishima 2008, section 3.3.
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
    /// Voxels times steps between measured ones; by `physical`, where locks tell of the air and no marker was.
    pub n_interpolated: u64,
    /// Voxels times steps taken from the outside wind; by `physical`, where locks tell little.
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
/// flag for each voxel center and step; how sure they are, and with the method `physical` which are `Interpolated`,
/// [`add_deviations`] says. Steps are independent of one another and run in parallel; the result does not depend on the number
/// of threads.
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
    if !samples.steps.iter().flatten().any(|sample| grid.contains(sample.position_m)) {
        let n_samples = samples.steps.iter().map(|step| step.len() as u64).sum();
        let extent_mm = grid.dims[0] as f64 * grid.edge_m * 1e3;
        return Err(RasterError::NothingInGrid { n_samples, extent_mm });
    }
    let done = AtomicU64::new(0);
    let laid = match (options.method, air) {
        (RasterMethod::Paper, _) => None,
        (RasterMethod::Physical, Some(air)) => Some(physical::Voxels::new(&grid, air)),
        (RasterMethod::Physical, None) => return Err(RasterError::NoAir),
    };
    let fill = |(part, (samples, outside)): (usize, (&[Vec<_>], &[Vec3]))| {
        let first = part * STEPS_AT_ONCE;
        let fields: Vec<Field> = match &laid {
            None => {
                samples.iter().zip(outside).map(|(s, outside)| paper::fill_step(&grid, s, *outside)).collect()
            }
            Some(voxels) => voxels.fill_steps(first..first + samples.len(), samples),
        };
        let n_filled = fields.len() as u64;
        progress.at(done.fetch_add(n_filled, Ordering::Relaxed) + n_filled, n_steps as u64);
        fields
    };
    let parts = samples.steps.par_chunks(STEPS_AT_ONCE).zip(outside.par_chunks(STEPS_AT_ONCE));
    let steps: Vec<Vec<Field>> = parts.enumerate().map(fill).collect();
    let steps = steps.into_iter().flatten().collect();
    let (quantity, rate_hz) = (samples.quantity, samples.rate_hz);
    let sequence = FieldSequence { grid, quantity, start_secs: 0.0, rate_hz, steps, layers: Vec::new() };
    Ok(Raster::of(sequence, samples))
}

/// Says how sure a field of the method `physical` is.
///
/// In: what [`rasterize`] made of the air. Adds a standard deviation for each voxel and step, and `Interpolated` where locks
/// tell of the air. Steps run in parallel, as there.
///
/// # Panics
/// If the field has more steps than the air.
pub fn add_deviations(raster: &mut Raster, air: &AirFlow, progress: &dyn Progress) {
    let Raster { sequence, report } = raster;
    let deviations = physical::Deviations::new(&sequence.grid, air);
    let (done, n_steps) = (AtomicU64::new(0), sequence.steps.len() as u64);
    sequence.steps.par_iter_mut().enumerate().for_each(|(step, field)| {
        deviations.add_to(field, step);
        progress.at(done.fetch_add(1, Ordering::Relaxed) + 1, n_steps);
    });
    *report = RasterReport::of(&sequence.steps, report.n_samples_outside);
}

impl Raster {
    /// A field that [`rasterize`] made of some samples.
    pub fn of(sequence: FieldSequence, samples: &WindSamples) -> Self {
        let is_outside = |sample: &&WindSample| !sequence.grid.contains(sample.position_m);
        let n_samples_outside = samples.steps.iter().flatten().filter(is_outside).count() as u64;
        let report = RasterReport::of(&sequence.steps, n_samples_outside);
        Self { sequence, report }
    }
}

impl RasterReport {
    fn of(steps: &[Field], n_samples_outside: u64) -> Self {
        let count = |flag| steps.iter().flat_map(|s| &s.flags).filter(|f| **f == flag).count() as u64;
        let empty = |step: &&Field| !step.flags.contains(&VoxelFlag::Measured);
        Self {
            n_measured: count(VoxelFlag::Measured),
            n_interpolated: count(VoxelFlag::Interpolated),
            n_outside: count(VoxelFlag::Outside),
            n_samples_outside,
            n_steps_empty: steps.iter().filter(empty).count() as u64,
        }
    }
}

//! How far a field is from the true wind.

use crate::stats::{mean, median};
use serde::Serialize;
use tousle_core::{Quantity, Vec3};
use tousle_field::{Field, FieldSequence, GridSpec, VoxelFlag};

/// The true wind on a grid, and where there was hair to measure it.
#[derive(Clone, Debug, PartialEq)]
pub struct TrueWind {
    /// Where the voxels are.
    pub grid: GridSpec,
    /// Time of each step, s.
    pub times_secs: Vec<f64>,
    /// Air velocity over the ground in units of [`TrueWind::scale_mps`], head axes: step after step, component
    /// after component, x slowest, z fastest.
    pub velocity_quanta: Vec<i8>,
    /// What one unit of [`TrueWind::velocity_quanta`] is, m/s.
    pub scale_mps: f32,
    /// Which voxels lie inside the head.
    pub solid: Vec<bool>,
    /// Which voxels held the captured wig's hair, step after step.
    pub hair: Vec<bool>,
    /// Turns air velocity into the force that a force field is compared with.
    pub reference_lock: ReferenceLock,
}

/// A lock at rest across the wind: what a field of forces per mass is judged on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceLock {
    /// How wide it is, m.
    pub lock_width_m: f64,
    /// Mass per length, kg/m.
    pub linear_density_kg_per_m: f64,
    /// Density of the air, kg/m³.
    pub air_density: f64,
    /// Kinematic viscosity of the air, m²/s.
    pub kinematic_viscosity: f64,
}

/// How far a field is from the true wind, from 1.3 s to the end, where the truth blows at 0.3 m/s or more.
///
/// `None` where there is no voxel to compare.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldScore {
    /// Voxels that hold hair at that time.
    pub hair: Option<VectorScore>,
    /// Voxels within 2 of one that holds hair, or that hold hair at some other time.
    pub nearby: Option<VectorScore>,
    /// The rest, the head's inside left out.
    pub elsewhere: Option<VectorScore>,
}

/// How far a set of vectors is from the true ones.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VectorScore {
    /// How many vectors were compared.
    pub samples: usize,
    /// Mean cosine of the angle between the two.
    pub cos_mean: f64,
    /// Median angle between the two, degrees.
    pub angle_median_deg: f64,
    /// Share of vectors within 30° of the truth.
    pub within_30deg: f64,
    /// Median of the relative error in length.
    pub magnitude_error_median: f64,
    /// Root mean square of the difference over that of the truth.
    pub vector_error: f64,
    /// The one factor that brings the field closest to the truth.
    pub best_scale: f64,
    /// [`VectorScore::vector_error`] once that factor is applied.
    pub vector_error_best_scale: f64,
}

/// What keeps a field from being scored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FieldScoreError {
    /// The field is on other voxels.
    #[error("found a grid of {found:?}, expected the truth's {expected:?}")]
    OtherGrid {
        /// The field's grid.
        found: Box<GridSpec>,
        /// The truth's grid.
        expected: Box<GridSpec>,
    },
    /// The field is not fit for use.
    #[error("the field cannot be sampled")]
    Field(#[from] tousle_field::FieldError),
}

/// Wind is on and settled from here, s.
const SCORED_FROM_SECS: f64 = 1.3;

/// Speed below which the truth has no direction worth comparing, m/s.
const LEAST_SPEED_MPS: f64 = 0.3;

/// Scores a field against the true wind, voxel by voxel, its layers included.
///
/// A field of forces per mass is compared with the drag of the reference lock in the true wind. The step nearest
/// in time is taken; a field of one step stands for all times. Definitions: `score/score_field.py` beside the
/// captures, except that all voxels count where the program draws 1,500 a region and step by a random generator
/// of its own: `hair` agrees to rounding (it never has more), the others within what that draw leaves open
/// (1 % of a median angle, 0.005 in the rest).
///
/// # Errors
/// [`FieldScoreError`] if the grids differ ([`resample_to_truth`] first) or the field is not sound.
pub fn score_field(predicted: &FieldSequence, truth: &TrueWind) -> Result<FieldScore, FieldScoreError> {
    predicted.check()?;
    if !same_grid(&predicted.grid, &truth.grid) {
        let (found, expected) = (Box::new(predicted.grid), Box::new(truth.grid));
        return Err(FieldScoreError::OtherGrid { found, expected });
    }
    let flat = (!predicted.layers.is_empty()).then(|| predicted.flattened());
    let predicted = flat.as_ref().unwrap_or(predicted);
    let least = truth.in_quantity(predicted.quantity, Vec3::x() * LEAST_SPEED_MPS).norm();
    let mut regions = [const { Pairs::new() }; 3];
    let ever = truth.hair_at_any_time();
    for (k, &time) in truth.times_secs.iter().enumerate().filter(|(_, t)| **t >= SCORED_FROM_SECS) {
        let nearest = (time * predicted.rate_hz).round_ties_even() as usize;
        let step = &predicted.steps[nearest.min(predicted.steps.len() - 1)];
        for (voxel, region) in truth.regions(k, &ever).into_iter().enumerate() {
            let Some(region) = region else { continue };
            let true_vector = truth.in_quantity(predicted.quantity, truth.velocity_mps(k, voxel));
            if true_vector.norm() > least {
                regions[region as usize].push(step.vector(voxel), true_vector);
            }
        }
    }
    let [hair, nearby, elsewhere] = regions.map(Pairs::score);
    Ok(FieldScore { hair, nearby, elsewhere })
}

/// A field of another grid or rate, sampled at the truth's voxel centers and times, its layers included.
pub fn resample_to_truth(field: &FieldSequence, truth: &TrueWind) -> FieldSequence {
    let steps = truth.times_secs.iter().map(|&time| {
        let slice = field.at(time);
        let mut step = Field { outside: slice.outside(), ..Field::still(&truth.grid) };
        for voxel in 0..truth.grid.n_voxels() {
            step.set_vector(voxel, slice.sample(truth.grid.cell_center_m(truth.grid.unflat(voxel))));
        }
        step
    });
    FieldSequence {
        grid: truth.grid,
        quantity: field.quantity,
        start_secs: 0.0,
        rate_hz: truth.rate_hz(),
        steps: steps.collect(),
        layers: Vec::new(),
    }
}

impl TrueWind {
    /// Steps a second; 30 where there is one step only.
    pub fn rate_hz(&self) -> f64 {
        match self.times_secs.as_slice() {
            [first, .., last] => (self.times_secs.len() - 1) as f64 / (last - first),
            _ => 30.0,
        }
    }

    /// The true wind as a field that hair can be simulated in.
    ///
    /// Nothing is known outside the grid: there the wind is the mean over the grid's outermost voxels.
    pub fn to_sequence(&self) -> FieldSequence {
        let n = self.grid.n_voxels();
        let rim: Vec<usize> = (0..n).filter(|&v| self.is_outermost(v)).collect();
        let steps = (0..self.times_secs.len()).map(|k| {
            let mut step = Field { flags: vec![VoxelFlag::Measured; n], ..Field::still(&self.grid) };
            for voxel in 0..n {
                step.set_vector(voxel, self.velocity_mps(k, voxel));
            }
            step.outside = rim.iter().map(|&v| self.velocity_mps(k, v)).sum::<Vec3>() / rim.len() as f64;
            step
        });
        FieldSequence {
            grid: self.grid,
            quantity: Quantity::AirVelocity,
            start_secs: self.times_secs.first().copied().unwrap_or(0.0),
            rate_hz: self.rate_hz(),
            steps: steps.collect(),
            layers: Vec::new(),
        }
    }

    /// How far each component of a field is from the truth, over the field's own standard deviation, by region (hair,
    /// nearby, elsewhere), from 1.3 s on; `None` where the field states none or lies on another grid.
    pub fn errors_over_sd(&self, field: &FieldSequence) -> Option<[Vec<f32>; 3]> {
        if !same_grid(&field.grid, &self.grid) {
            return None;
        }
        let mut ratios = [const { Vec::new() }; 3];
        let ever = self.hair_at_any_time();
        for (k, &time) in self.times_secs.iter().enumerate().filter(|(_, t)| **t >= SCORED_FROM_SECS) {
            let nearest = (time * field.rate_hz).round_ties_even() as usize;
            let step = &field.steps[nearest.min(field.steps.len() - 1)];
            let sd = step.sd.as_ref()?;
            for (voxel, region) in self.regions(k, &ever).into_iter().enumerate() {
                let Some(region) = region else { continue };
                let off = step.vector(voxel) - self.velocity_mps(k, voxel);
                ratios[region as usize].extend(off.iter().map(|c| c.abs() as f32 / sd[voxel].max(1e-6)));
            }
        }
        Some(ratios)
    }

    /// The true air velocity in a voxel, head axes, m/s.
    pub fn velocity_mps(&self, step: usize, voxel: usize) -> Vec3 {
        let n = self.grid.n_voxels();
        let component = |c: usize| f32::from(self.velocity_quanta[(3 * step + c) * n + voxel]);
        Vec3::from([0, 1, 2].map(|c| f64::from(component(c) * self.scale_mps)))
    }

    fn in_quantity(&self, quantity: Quantity, velocity: Vec3) -> Vec3 {
        match quantity {
            Quantity::AirVelocity => velocity,
            Quantity::ForcePerMass => self.reference_lock.acceleration(velocity),
        }
    }

    fn is_outermost(&self, voxel: usize) -> bool {
        let at = self.grid.unflat(voxel).0;
        (0..3).any(|a| at[a] == 0 || at[a] + 1 == self.grid.dims[a])
    }

    fn hair_at(&self, step: usize) -> &[bool] {
        let n = self.grid.n_voxels();
        &self.hair[step * n..(step + 1) * n]
    }

    fn hair_at_any_time(&self) -> Vec<bool> {
        let n = self.grid.n_voxels();
        (0..n).map(|v| (0..self.times_secs.len()).any(|k| self.hair[k * n + v])).collect()
    }

    /// The region of every voxel at a step; `None` inside the head.
    fn regions(&self, step: usize, ever: &[bool]) -> Vec<Option<Region>> {
        let hair: Vec<bool> = self.hair_at(step).iter().zip(&self.solid).map(|(h, s)| *h && !s).collect();
        let near = self.dilated(&self.dilated(&hair));
        let region = |v: usize| match (self.solid[v], hair[v], near[v] || ever[v]) {
            (true, _, _) => None,
            (false, true, _) => Some(Region::Hair),
            (false, false, true) => Some(Region::Nearby),
            (false, false, false) => Some(Region::Elsewhere),
        };
        (0..hair.len()).map(region).collect()
    }

    /// A mask grown by its six neighbors.
    fn dilated(&self, mask: &[bool]) -> Vec<bool> {
        let mut grown = mask.to_vec();
        let [nx, ny, nz] = self.grid.dims;
        for (axis_stride, axis_len) in [(ny * nz, nx), (nz, ny), (1, nz)] {
            for v in (0..mask.len()).filter(|&v| mask[v]) {
                let at = v / axis_stride % axis_len;
                if at > 0 {
                    grown[v - axis_stride] = true;
                }
                if at + 1 < axis_len {
                    grown[v + axis_stride] = true;
                }
            }
        }
        grown
    }
}

impl ReferenceLock {
    /// The drag per mass of the lock at rest across this wind, m/s²: quadratic, its coefficient
    /// 1 + 10 Re^(−2/3) rising towards low Reynolds numbers.
    pub fn acceleration(&self, velocity_mps: Vec3) -> Vec3 {
        let speed = velocity_mps.norm();
        let over_width = libm::cbrt(self.kinematic_viscosity / self.lock_width_m);
        let coefficient_times_speed = speed + 10.0 * libm::cbrt(speed) * over_width * over_width;
        let per_mass = 0.5 * self.air_density * self.lock_width_m / self.linear_density_kg_per_m;
        velocity_mps * (per_mass * coefficient_times_speed)
    }
}

#[derive(Clone, Copy)]
enum Region {
    Hair = 0,
    Nearby = 1,
    Elsewhere = 2,
}

/// Predicted and true vectors, as their sums and the series that medians need.
struct Pairs {
    angles: Vec<f64>,
    magnitude_errors: Vec<f64>,
    cosines: Vec<f64>,
    predicted_squared: f64,
    true_squared: f64,
    product: f64,
}

impl Pairs {
    const fn new() -> Self {
        Self {
            angles: Vec::new(),
            magnitude_errors: Vec::new(),
            cosines: Vec::new(),
            predicted_squared: 0.0,
            true_squared: 0.0,
            product: 0.0,
        }
    }

    fn push(&mut self, predicted: Vec3, truth: Vec3) {
        let (length, true_length) = (predicted.norm(), truth.norm());
        let cosine = predicted.dot(&truth) / f64::max(length * true_length, 1e-12);
        self.cosines.push(cosine);
        self.angles.push(libm::acos(cosine.clamp(-1.0, 1.0)));
        self.magnitude_errors.push((length - true_length).abs() / true_length);
        self.predicted_squared += predicted.norm_squared();
        self.true_squared += truth.norm_squared();
        self.product += predicted.dot(&truth);
    }

    fn score(mut self) -> Option<VectorScore> {
        let samples = self.cosines.len();
        let best_scale = self.product / f64::max(self.predicted_squared, 1e-30);
        let cos_30 = libm::cos(30f64.to_radians());
        let within = self.cosines.iter().filter(|c| **c > cos_30).count();
        (samples > 0).then(|| VectorScore {
            samples,
            cos_mean: mean(&self.cosines),
            angle_median_deg: median(&mut self.angles).to_degrees(),
            within_30deg: within as f64 / samples as f64,
            magnitude_error_median: median(&mut self.magnitude_errors),
            vector_error: self.error_at_scale(1.0),
            best_scale,
            vector_error_best_scale: self.error_at_scale(best_scale),
        })
    }

    /// |scale · predicted − true| / |true| from the three sums.
    fn error_at_scale(&self, scale: f64) -> f64 {
        let difference = scale * scale * self.predicted_squared - 2.0 * scale * self.product;
        f64::max(1.0 + difference / self.true_squared, 0.0).sqrt()
    }
}

fn same_grid(a: &GridSpec, b: &GridSpec) -> bool {
    // The truth's origin passed through f32.
    a.dims == b.dims && (a.edge_m - b.edge_m).abs() < 1e-6 && (a.origin_m - b.origin_m).norm() < 1e-6
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 5³ voxels of 20 mm, one step at 2 s; 1 m/s along x everywhere, hair in the corner, head across from it.
    fn truth() -> TrueWind {
        let grid = GridSpec::cube(0.1, 0.02).unwrap();
        let n = grid.n_voxels();
        let mut velocity_quanta = vec![0; 3 * n];
        velocity_quanta[..n].fill(25);
        let mut solid = vec![false; n];
        solid[n - 1] = true;
        let mut hair = vec![false; n];
        hair[0] = true;
        let reference_lock = ReferenceLock {
            lock_width_m: 0.005,
            linear_density_kg_per_m: 0.002,
            air_density: 1.2,
            kinematic_viscosity: 1.5e-5,
        };
        TrueWind {
            grid,
            times_secs: vec![2.0],
            velocity_quanta,
            scale_mps: 0.04,
            solid,
            hair,
            reference_lock,
        }
    }

    #[test]
    fn the_truth_itself_is_exact() {
        let truth = truth();
        let score = score_field(&truth.to_sequence(), &truth).unwrap();
        // Within two steps along the axes of a corner: 3 + 6 voxels. One of 125 is the head's.
        let samples = [score.hair, score.nearby, score.elsewhere].map(|s| s.unwrap().samples);
        assert_eq!(samples, [1, 9, 114]);
        let elsewhere = score.elsewhere.unwrap();
        assert!((elsewhere.cos_mean - 1.0).abs() < 1e-12);
        assert!(elsewhere.vector_error < 1e-7);
        assert_eq!(elsewhere.within_30deg, 1.0);
    }

    /// Half the speed and 60 degrees off: the vector error is √(1 + ¼ − ½), the best scale 1.
    #[test]
    fn a_known_error_is_told() {
        let truth = truth();
        let mut field = truth.to_sequence();
        for voxel in 0..truth.grid.n_voxels() {
            field.steps[0].set_vector(voxel, Vec3::new(0.25, 0.0, 0.25 * 3f64.sqrt()));
        }
        let score = score_field(&field, &truth).unwrap().nearby.unwrap();
        assert!((score.cos_mean - 0.5).abs() < 1e-7);
        assert!((score.angle_median_deg - 60.0).abs() < 1e-4);
        assert!((score.magnitude_error_median - 0.5).abs() < 1e-6);
        assert!((score.vector_error - 0.75f64.sqrt()).abs() < 1e-6);
        assert!((score.best_scale - 1.0).abs() < 1e-6);
        assert_eq!(score.within_30deg, 0.0);
    }

    /// ½ · 1.2 · 0.005 / 0.002 · (1 + 10 (1.5e-5 / 0.005)^⅔) = 1.5 (1 + 10 · 0.0208008).
    #[test]
    fn forces_are_judged_by_the_drag_of_the_reference_lock() {
        let truth = truth();
        let acceleration = truth.reference_lock.acceleration(Vec3::x());
        assert!((acceleration.x - 1.5 * 1.208_008_382).abs() < 1e-8, "{acceleration}");
        let mut field = FieldSequence { quantity: Quantity::ForcePerMass, ..truth.to_sequence() };
        for voxel in 0..truth.grid.n_voxels() {
            field.steps[0].set_vector(voxel, acceleration);
        }
        assert!(score_field(&field, &truth).unwrap().hair.unwrap().vector_error < 1e-6);
    }

    #[test]
    fn another_grid_is_refused_until_it_is_resampled() {
        let truth = truth();
        let grid = GridSpec::cube(0.1, 0.05).unwrap();
        let mut step = Field::still(&grid);
        step.u[..8].fill(1.0);
        let field = FieldSequence { grid, steps: vec![step], ..truth.to_sequence() };
        assert!(matches!(score_field(&field, &truth), Err(FieldScoreError::OtherGrid { .. })));
        let score = score_field(&resample_to_truth(&field, &truth), &truth).unwrap();
        assert!(score.nearby.unwrap().vector_error < 1e-6);
    }
}

use crate::{FieldLayer, GridSpec};
use serde::{Deserialize, Serialize};
use tousle_core::{Quantity, Vec3};

/// Wind over time on a grid around the head, in head axes.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldSequence {
    /// Where the voxels are.
    pub grid: GridSpec,
    /// What the vectors are.
    pub quantity: Quantity,
    /// Time of the first step, s after the capture's first frame.
    pub start_secs: f64,
    /// Steps a second, > 0; in between the field is linear in time.
    pub rate_hz: f64,
    /// The steps, at least one. A single step stands for all times.
    pub steps: Vec<Field>,
    /// Edits, added when the field is sampled, in order.
    pub layers: Vec<FieldLayer>,
}

/// One time step of a field.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The vectors at voxel centers, head axes: all x components, then all y, then all z; within a component x
    /// slowest, z fastest ([`GridSpec::flat`]).
    pub u: Vec<f32>,
    /// Where each voxel's vector comes from.
    pub flags: Vec<VoxelFlag>,
    /// Standard deviation of each voxel's vector (per component), in the quantity's unit, if it is known.
    pub sd: Option<Vec<f32>>,
    /// The wind outside the grid, head axes.
    pub outside: Vec3,
}

/// Where a voxel's vector comes from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum VoxelFlag {
    /// From the wind outside the grid, perhaps bent towards what was measured nearest; by `physical`, from what is likely of
    /// air where the locks tell little.
    #[default]
    Outside = 0,
    /// No marker was in it, but the markers tell of it: by the method `paper` it lies between measured voxels, by `physical`
    /// the locks around narrowed down the air here.
    Interpolated = 1,
    /// A marker was in it.
    Measured = 2,
}

impl VoxelFlag {
    /// The flag of a byte in a file; `None` for a byte that means nothing.
    pub fn from_byte(byte: u8) -> Option<Self> {
        match byte {
            0 => Some(Self::Outside),
            1 => Some(Self::Interpolated),
            2 => Some(Self::Measured),
            _ => None,
        }
    }
}

/// What makes a sequence unusable.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// There is no step.
    #[error("the field has no time steps")]
    Empty,
    /// The rate is not a finite number above 0.
    #[error("found a rate of {found} Hz, expected a number above 0")]
    BadRate {
        /// The rate.
        found: f64,
    },
    /// The first step is at no time.
    #[error("found a first step at {found} s, expected a finite time")]
    BadStart {
        /// When it is.
        found: f64,
    },
    /// The grid has no voxel, or nobody knows where.
    #[error(
        "found a grid of {dims:?} voxels of {edge_m} m from {origin_m:?} m on, expected at least one of a size above 0"
    )]
    BadGrid {
        /// Voxels along x, y, z.
        dims: [usize; 3],
        /// Their edge, m.
        edge_m: f64,
        /// The lowest corner, head space, m.
        origin_m: [f64; 3],
    },
    /// An array does not fit the grid.
    #[error("step {step}: found {found} {what}, expected {expected}")]
    BadSize {
        /// Index of the step.
        step: usize,
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// What the grid asks for.
        expected: usize,
    },
    /// A vector is NaN or infinite.
    #[error("step {step}, voxel {voxel:?}: found {found}, expected a finite number")]
    NotFinite {
        /// Index of the step.
        step: usize,
        /// The voxel; `None` for the wind outside.
        voxel: Option<[usize; 3]>,
        /// The value.
        found: f64,
    },
}

/// Whether no number is NaN or infinite: a quick pass, before a slow one that says where.
pub fn all_finite(numbers: &[f32]) -> bool {
    // As whole numbers their sizes are in order, with infinity and NaN last; a maximum of these is vector code.
    let size = |number: &f32| (number.to_bits() & 0x7fff_ffff) as i32;
    numbers.iter().map(size).fold(0, i32::max) < f32::INFINITY.to_bits() as i32
}

impl Field {
    /// A step of still air, all of it taken from outside.
    pub fn still(grid: &GridSpec) -> Self {
        let n = grid.n_voxels();
        Self { u: vec![0.0; 3 * n], flags: vec![VoxelFlag::Outside; n], sd: None, outside: Vec3::zeros() }
    }

    /// The vector at a voxel's center, by its flat index.
    ///
    /// # Panics
    /// If `flat` is past the end.
    pub fn vector(&self, flat: usize) -> Vec3 {
        let n = self.flags.len();
        Vec3::new(f64::from(self.u[flat]), f64::from(self.u[n + flat]), f64::from(self.u[2 * n + flat]))
    }

    /// Sets the vector at a voxel's center, by its flat index.
    ///
    /// # Panics
    /// If `flat` is past the end.
    pub fn set_vector(&mut self, flat: usize, vector: Vec3) {
        let n = self.flags.len();
        for axis in 0..3 {
            self.u[axis * n + flat] = vector[axis] as f32;
        }
    }

    /// The vector at a point, head space, m: trilinear between voxel centers; beyond the outermost centers the
    /// nearest one holds, and outside the box it passes into [`Field::outside`] ([`GridSpec::share_outside`]).
    pub fn sample(&self, grid: &GridSpec, point_m: Vec3) -> Vec3 {
        let far = grid.share_outside(point_m);
        if far >= 1.0 {
            return self.outside;
        }
        let near = self.gather(&Stencil::at(grid, point_m));
        near + (self.outside - near) * far
    }

    /// The weighted sum of the vectors at a stencil's voxels.
    fn gather(&self, stencil: &Stencil) -> Vec3 {
        let n = self.flags.len();
        let mut sum = [0.0; 3];
        for (component, sum) in sum.iter_mut().enumerate() {
            let plane = &self.u[component * n..(component + 1) * n];
            for (flat, weight) in stencil.flats.iter().zip(&stencil.weights) {
                *sum += f64::from(plane[*flat]) * weight;
            }
        }
        Vec3::from(sum)
    }
}

/// The eight voxels around a point of the box and the weight of each, which add up to 1.
///
/// At an edge of the box a voxel stands in for neighbors that are not there, so it can occur more than once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stencil {
    /// The voxels, by their flat index.
    pub flats: [usize; 8],
    /// The weight of each.
    pub weights: [f64; 8],
}

impl Stencil {
    /// The voxels around a point of the box, head space, m; outside the box, those nearest to it.
    pub fn at(grid: &GridSpec, point_m: Vec3) -> Self {
        let place = (point_m - grid.origin_m) / grid.edge_m - Vec3::repeat(0.5);
        let strides = [grid.dims[1] * grid.dims[2], grid.dims[2], 1];
        let mut flats = [0; 8];
        let mut weights = [1.0; 8];
        for axis in 0..3 {
            let last = grid.dims[axis] - 1;
            let at = place[axis].clamp(0.0, last as f64);
            let low = at as usize;
            let share = at - low as f64;
            let [near, far] = [low, (low + 1).min(last)].map(|voxel| voxel * strides[axis]);
            for corner in 0..8 {
                let is_far = corner >> axis & 1 == 1;
                flats[corner] += if is_far { far } else { near };
                weights[corner] *= if is_far { share } else { 1.0 - share };
            }
        }
        Self { flats, weights }
    }
}

/// A field at one time, ready to be sampled anywhere: two neighboring steps and the share of the second.
#[derive(Clone, Copy, Debug)]
pub struct FieldSlice<'a> {
    sequence: &'a FieldSequence,
    layers: &'a [FieldLayer],
    /// Indices of the steps.
    around: [usize; 2],
    share: f64,
    time_secs: f64,
}

impl FieldSequence {
    /// Time of the last step, s.
    pub fn end_secs(&self) -> f64 {
        self.start_secs + (self.steps.len().max(1) - 1) as f64 / self.rate_hz
    }

    /// Time of a step, s.
    pub fn time_secs(&self, step: usize) -> f64 {
        self.start_secs + step as f64 / self.rate_hz
    }

    /// The field at a time, s; before the first step the first holds, after the last the last.
    ///
    /// # Panics
    /// If the sequence has no step; [`FieldSequence::check`] refuses such a one.
    pub fn at(&self, time_secs: f64) -> FieldSlice<'_> {
        let last = self.steps.len() - 1;
        let place = ((time_secs - self.start_secs) * self.rate_hz).clamp(0.0, last as f64);
        let before = place as usize;
        let after = (before + 1).min(last);
        let (around, share) = ([before, after], place - before as f64);
        FieldSlice { sequence: self, layers: &self.layers, around, share, time_secs }
    }

    /// The steps with every layer that is not muted added at voxel centers, for tools that know no layers.
    ///
    /// Layers that begin or end between two steps are only as exact as the steps are dense.
    pub fn flattened(&self) -> Self {
        let mut flat = Self { layers: Vec::new(), ..self.clone() };
        for (k, step) in flat.steps.iter_mut().enumerate() {
            let time_secs = self.time_secs(k);
            for layer in &self.layers {
                let presence = layer.presence(time_secs);
                if presence == 0.0 {
                    continue;
                }
                for voxel in 0..self.grid.n_voxels() {
                    let center_m = self.grid.cell_center_m(self.grid.unflat(voxel));
                    let before = step.vector(voxel);
                    let after = layer.apply(center_m, presence, before);
                    if after != before {
                        step.set_vector(voxel, after);
                    }
                }
            }
        }
        flat
    }

    /// Checks that every array fits the grid, and that every vector and the times are finite. (A standard deviation may be
    /// infinite.)
    ///
    /// # Errors
    /// The first [`FieldError`] in step order.
    pub fn check(&self) -> Result<(), FieldError> {
        if self.steps.is_empty() {
            return Err(FieldError::Empty);
        }
        if !(self.rate_hz.is_finite() && self.rate_hz > 0.0) {
            return Err(FieldError::BadRate { found: self.rate_hz });
        }
        if !self.start_secs.is_finite() {
            return Err(FieldError::BadStart { found: self.start_secs });
        }
        let GridSpec { dims, edge_m, origin_m } = self.grid;
        let is_somewhere = origin_m.iter().all(|c| c.is_finite());
        if dims.contains(&0) || !(edge_m.is_finite() && edge_m > 0.0 && is_somewhere) {
            return Err(FieldError::BadGrid { dims, edge_m, origin_m: origin_m.into() });
        }
        let n = self.grid.n_voxels();
        for (step, field) in self.steps.iter().enumerate() {
            let sd_len = field.sd.as_ref().map_or(n, Vec::len);
            for (what, found, expected) in [
                ("vector components", field.u.len(), 3 * n),
                ("flags", field.flags.len(), n),
                ("standard deviations", sd_len, n),
            ] {
                if found != expected {
                    return Err(FieldError::BadSize { step, what, found, expected });
                }
            }
            let found = if all_finite(&field.u) { None } else { field.u.iter().position(|c| !c.is_finite()) };
            if let Some(at) = found {
                let voxel = Some(self.grid.unflat(at % n).0);
                return Err(FieldError::NotFinite { step, voxel, found: f64::from(field.u[at]) });
            }
            if let Some(c) = field.outside.iter().find(|c| !c.is_finite()) {
                return Err(FieldError::NotFinite { step, voxel: None, found: *c });
            }
        }
        Ok(())
    }
}

impl<'a> FieldSlice<'a> {
    /// The same steps under other layers than the sequence's own.
    pub fn with_layers(self, layers: &'a [FieldLayer]) -> Self {
        Self { layers, ..self }
    }

    /// The indices of the steps around the time, and the share of the second.
    pub(crate) fn around(&self) -> ([usize; 2], f64) {
        (self.around, self.share)
    }

    fn steps(&self) -> [&'a Field; 2] {
        self.around.map(|step| &self.sequence.steps[step])
    }

    /// The vector at a point, head space, m, layers included.
    pub fn sample(&self, point_m: Vec3) -> Vec3 {
        let grid = &self.sequence.grid;
        // Both steps lie on the same grid: where the point is in it is found once.
        let far = grid.share_outside(point_m);
        let mut vector = Vec3::zeros();
        if far < 1.0 {
            let stencil = Stencil::at(grid, point_m);
            let [before, after] = self.steps().map(|step| step.gather(&stencil));
            vector = before + (after - before) * self.share;
        }
        if far > 0.0 {
            vector += (self.outside() - vector) * far;
        }
        for layer in self.layers {
            let presence = layer.presence(self.time_secs);
            if presence > 0.0 {
                vector = layer.apply(point_m, presence, vector);
            }
        }
        vector
    }

    /// The wind outside the grid.
    pub fn outside(&self) -> Vec3 {
        let [before, after] = self.steps();
        before.outside * (1.0 - self.share) + after.outside * self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field that is linear in space is sampled exactly between voxel centers.
    #[test]
    fn a_linear_field_is_sampled_exactly() {
        let grid = GridSpec::cube(0.6, 0.1).unwrap();
        let linear = |p: Vec3| Vec3::new(1.0 + p.x, 2.0 - p.y + p.z, 0.5 * p.x * 3.0);
        let mut field = Field::still(&grid);
        for flat in 0..grid.n_voxels() {
            field.set_vector(flat, linear(grid.cell_center_m(grid.unflat(flat))));
        }
        for point in [Vec3::zeros(), Vec3::new(0.13, -0.2, 0.08), Vec3::new(-0.25, 0.25, 0.25)] {
            assert!((field.sample(&grid, point) - linear(point)).norm() < 1e-6, "{point}");
        }
    }

    #[test]
    fn time_is_linear_between_steps_and_held_outside() {
        let grid = GridSpec::cube(0.2, 0.1).unwrap();
        let step = |x: f64| {
            let mut field = Field::still(&grid);
            for flat in 0..8 {
                field.set_vector(flat, Vec3::new(x, 0.0, 0.0));
            }
            Field { outside: Vec3::new(10.0 * x, 0.0, 0.0), ..field }
        };
        let sequence = FieldSequence {
            grid,
            quantity: Quantity::AirVelocity,
            start_secs: 1.0,
            rate_hz: 10.0,
            steps: vec![step(0.0), step(1.0), step(4.0)],
            layers: Vec::new(),
        };
        sequence.check().unwrap();
        for (t, x) in [(0.0, 0.0), (1.05, 0.5), (1.15, 2.5), (9.0, 4.0)] {
            assert!((sequence.at(t).sample(Vec3::zeros()).x - x).abs() < 1e-6, "{t}");
            assert!((sequence.at(t).sample(Vec3::new(9.0, 0.0, 0.0)).x - 10.0 * x).abs() < 1e-5, "{t}");
        }
    }

    #[test]
    fn a_nan_is_found_with_its_place() {
        let grid = GridSpec::cube(0.2, 0.1).unwrap();
        let mut field = Field::still(&grid);
        field.u[8 + 5] = f32::NAN;
        let sequence = FieldSequence {
            grid,
            quantity: Quantity::AirVelocity,
            start_secs: 0.0,
            rate_hz: 30.0,
            steps: vec![field],
            layers: Vec::new(),
        };
        let error = sequence.check().unwrap_err();
        assert!(matches!(error, FieldError::NotFinite { step: 0, voxel: Some([1, 0, 1]), .. }), "{error}");
    }
}

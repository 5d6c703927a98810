use crate::{Field, FieldLayer, FieldSequence, GridSpec};
use tousle_core::Vec3;

/// A field ready to be asked by very many points, in single precision.
///
/// Beside [`FieldSequence::at`] it knows where no air is and can lay the two steps around a time together once for
/// all points.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    sequence: &'a FieldSequence,
    /// 1 for each voxel with air, 0 for one without; `None` if all have some.
    air: Option<Vec<f32>>,
    /// Whether a step is still, outside the grid too.
    is_still: Vec<bool>,
    origin: [f32; 3],
    per_edge: f32,
    /// Half the box's shortest side, m.
    fades_over: f32,
}

/// A [`Sampler`]'s field at one time.
#[derive(Clone, Debug)]
pub struct Moment<'a> {
    sampler: &'a Sampler<'a>,
    source: Source<'a>,
    outside: [f32; 3],
    is_still: bool,
    /// The layers that are there, and how much of each.
    layers: Vec<(&'a FieldLayer, f64)>,
}

/// Where a moment's vectors are.
#[derive(Clone, Debug)]
enum Source<'a> {
    /// Two neighboring steps and the share of the second, laid together for each point.
    Steps { before: &'a Field, after: &'a Field, share: f32 },
    /// Laid together beforehand: a vector and a weight (0 without air) a voxel.
    Together(Vec<[f32; 4]>),
}

/// Voxels around a point, their weights, and how much of the wind there is that outside the grid.
struct Corners {
    flats: [usize; 8],
    weights: [f32; 8],
    far: f32,
}

impl<'a> Sampler<'a> {
    /// A sampler of a field that [`FieldSequence::check`] has passed.
    ///
    /// `is_solid` says whether a point of head space, m, lies in the head. A voxel whose center does and whose vector
    /// is exactly zero in every step holds no air: read between voxel centers, such zeros would slow the wind down
    /// over a whole voxel outside, which hair close to the scalp would feel. Between voxels with and without air, the
    /// weights of those with air make up the whole.
    pub fn new(sequence: &'a FieldSequence, is_solid: impl Fn(Vec3) -> bool) -> Self {
        let grid = &sequence.grid;
        let n = grid.n_voxels();
        let is_empty = |flat: usize| {
            sequence
                .steps
                .iter()
                .all(|s| s.u[flat] == 0.0 && s.u[n + flat] == 0.0 && s.u[2 * n + flat] == 0.0)
        };
        let has_air: Vec<bool> =
            (0..n).map(|v| !(is_solid(grid.cell_center_m(grid.unflat(v))) && is_empty(v))).collect();
        let any_without = has_air.iter().any(|air| !air);
        let shortest = grid.dims.iter().copied().min().unwrap_or(1) as f64 * grid.edge_m;
        let is_still = |step: &Field| step.outside == Vec3::zeros() && step.u.iter().all(|u| *u == 0.0);
        Self {
            sequence,
            is_still: sequence.steps.iter().map(is_still).collect(),
            air: any_without.then(|| has_air.iter().map(|air| f32::from(u8::from(*air))).collect()),
            origin: grid.origin_m.map(|c| c as f32).into(),
            per_edge: (1.0 / grid.edge_m) as f32,
            fades_over: (0.5 * shortest) as f32,
        }
    }

    /// The field at a time, s; before the first step the first holds, after the last the last.
    ///
    /// `together` lays the two steps around the time together for the whole grid: worth it for more points than
    /// the grid has voxels over six.
    ///
    /// # Panics
    /// If the sequence has no step.
    pub fn at(&'a self, time_secs: f64, together: bool) -> Moment<'a> {
        let slice = self.sequence.at(time_secs);
        let (before, after, share) = slice.steps();
        let layers = self.sequence.layers.iter().map(|layer| (layer, layer.presence(time_secs)));
        let layers: Vec<_> = layers.filter(|(_, presence)| *presence > 0.0).collect();
        let still_step = |step: &Field| {
            let place = self.sequence.steps.iter().position(|s| core::ptr::eq(s, step));
            place.is_some_and(|place| self.is_still[place])
        };
        let source = if together {
            Source::Together(self.lay_together(before, after, share as f32))
        } else {
            Source::Steps { before, after, share: share as f32 }
        };
        Moment {
            sampler: self,
            source,
            outside: slice.outside().map(|c| c as f32).into(),
            is_still: layers.is_empty() && still_step(before) && still_step(after),
            layers,
        }
    }

    fn lay_together(&self, before: &Field, after: &Field, share: f32) -> Vec<[f32; 4]> {
        let n = before.flags.len();
        (0..n)
            .map(|v| {
                let at = |axis: usize| {
                    let (a, b) = (before.u[axis * n + v], after.u[axis * n + v]);
                    a + (b - a) * share
                };
                [at(0), at(1), at(2), self.air.as_ref().map_or(1.0, |air| air[v])]
            })
            .collect()
    }

    #[inline]
    fn corners(&self, point_m: [f32; 3]) -> Corners {
        let GridSpec { dims, .. } = self.sequence.grid;
        let strides = [dims[1] * dims[2], dims[2], 1];
        let mut low = 0;
        let mut step = [0; 3];
        let mut share = [0.0; 3];
        let mut beyond2 = 0.0;
        for axis in 0..3 {
            let place = (point_m[axis] - self.origin[axis]) * self.per_edge;
            let size = dims[axis] as f32;
            let beyond = (-place).max(place - size).max(0.0);
            beyond2 += beyond * beyond;
            let last = dims[axis] - 1;
            let at = (place - 0.5).clamp(0.0, last as f32);
            let voxel = (at as usize).min(last);
            share[axis] = at - voxel as f32;
            low += voxel * strides[axis];
            step[axis] = if voxel < last { strides[axis] } else { 0 };
        }
        let far = if beyond2 > 0.0 {
            let far = beyond2.sqrt() / (self.per_edge * self.fades_over);
            // A NaN counts as far away.
            if far < 1.0 { far } else { 1.0 }
        } else {
            0.0
        };
        let [x, y, z] = share;
        let (x0, y0, z0) = (1.0 - x, 1.0 - y, 1.0 - z);
        let [sx, sy, sz] = step;
        Corners {
            flats: [
                low,
                low + sz,
                low + sy,
                low + sy + sz,
                low + sx,
                low + sx + sz,
                low + sx + sy,
                low + sx + sy + sz,
            ],
            weights: [
                x0 * y0 * z0,
                x0 * y0 * z,
                x0 * y * z0,
                x0 * y * z,
                x * y0 * z0,
                x * y0 * z,
                x * y * z0,
                x * y * z,
            ],
            far,
        }
    }
}

impl Moment<'_> {
    /// Whether no wind blows anywhere.
    pub fn is_still(&self) -> bool {
        self.is_still
    }

    /// The vector at a point, head space, m, layers included; where no air is, zero.
    // Not to be copied into a caller's unrolled loop: eight copies take the compiler minutes and gain nothing.
    #[inline(never)]
    pub fn sample(&self, point_m: [f32; 3]) -> [f32; 3] {
        let corners = self.sampler.corners(point_m);
        let mut near = [0.0f32; 4];
        if corners.far < 1.0 {
            near = match &self.source {
                Source::Together(voxels) => gather_together(voxels, &corners),
                Source::Steps { before, after, share } => {
                    gather_steps(before, after, *share, self.sampler.air.as_deref(), &corners)
                }
            };
        }
        let per_weight = if near[3] > 1e-6 { 1.0 / near[3] } else { 0.0 };
        let mut vector = [0.0; 3];
        for axis in 0..3 {
            let inside = near[axis] * per_weight;
            vector[axis] = inside + (self.outside[axis] - inside) * corners.far;
        }
        if !self.layers.is_empty() {
            let point_m = Vec3::from(point_m.map(f64::from));
            let extra: Vec3 = self.layers.iter().map(|(layer, share)| layer.extra_at(point_m) * *share).sum();
            for axis in 0..3 {
                vector[axis] += extra[axis] as f32;
            }
        }
        vector
    }
}

#[inline]
fn gather_together(voxels: &[[f32; 4]], corners: &Corners) -> [f32; 4] {
    let mut sum = [0.0f32; 4];
    for (flat, weight) in corners.flats.iter().zip(&corners.weights) {
        let voxel = &voxels[*flat];
        for k in 0..4 {
            sum[k] += voxel[k] * weight;
        }
    }
    sum
}

#[inline]
fn gather_steps(
    before: &Field,
    after: &Field,
    share: f32,
    air: Option<&[f32]>,
    corners: &Corners,
) -> [f32; 4] {
    let n = before.flags.len();
    let mut sum = [0.0f32; 4];
    let mut weights = corners.weights;
    if let Some(air) = air {
        for (weight, flat) in weights.iter_mut().zip(&corners.flats) {
            *weight *= air[*flat];
        }
    }
    sum[3] = weights.iter().sum();
    for (axis, sum) in sum.iter_mut().take(3).enumerate() {
        let (a, b) = (&before.u[axis * n..(axis + 1) * n], &after.u[axis * n..(axis + 1) * n]);
        for (flat, weight) in corners.flats.iter().zip(&weights) {
            *sum += (a[*flat] + (b[*flat] - a[*flat]) * share) * weight;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Quantity;

    /// Two steps of a wind that grows with x, y and time, with a head of still voxels in the middle.
    fn sequence(grid: GridSpec, hollow: impl Fn(Vec3) -> bool) -> FieldSequence {
        let steps = (0..3_u32).map(|k| {
            let mut step = Field { outside: Vec3::new(9.0, 0.0, 0.0), ..Field::still(&grid) };
            for flat in 0..grid.n_voxels() {
                let p = grid.cell_center_m(grid.unflat(flat));
                if !hollow(p) {
                    step.set_vector(flat, Vec3::new(1.0 + p.x, 2.0 + p.y, 1.0 + f64::from(k)));
                }
            }
            step
        });
        FieldSequence {
            grid,
            quantity: Quantity::AirVelocity,
            start_secs: 0.0,
            rate_hz: 10.0,
            steps: steps.collect(),
            layers: Vec::new(),
        }
    }

    /// Both ways to sample agree with the sequence's own, inside and outside the box.
    #[test]
    fn both_ways_agree_with_the_sequence() {
        let grid = GridSpec::cube(0.6, 0.1).unwrap();
        let sequence = sequence(grid, |_| false);
        let sampler = Sampler::new(&sequence, |_| false);
        for time in [-1.0, 0.0, 0.07, 0.13, 5.0] {
            let slow = sequence.at(time);
            for point in
                [Vec3::zeros(), Vec3::new(0.11, -0.27, 0.299), Vec3::new(0.4, 0.1, -0.35), Vec3::repeat(2.0)]
            {
                let single: [f32; 3] = point.map(|c| c as f32).into();
                let expected = slow.sample(point);
                for together in [false, true] {
                    let found = Vec3::from(sampler.at(time, together).sample(single).map(f64::from));
                    assert!((found - expected).norm() < 1e-5, "{time} {point} {found} {expected}");
                }
            }
        }
    }

    /// Right outside a head that holds no air the wind is that of the nearest air, not a mixture with nothing.
    #[test]
    fn a_head_without_air_does_not_slow_the_wind() {
        let grid = GridSpec::cube(0.6, 0.1).unwrap();
        let in_head = |p: Vec3| p.norm() < 0.12;
        let sequence = sequence(grid, in_head);
        let point = [0.14f32, 0.0, 0.0];
        let blind = Sampler::new(&sequence, |_| false).at(0.0, false).sample(point);
        for together in [false, true] {
            let seeing = Sampler::new(&sequence, in_head);
            let found = seeing.at(0.0, together).sample(point);
            assert!((found[2] - 1.0).abs() < 1e-5 && blind[2] < 0.95, "{found:?} {blind:?}");
        }
    }
}

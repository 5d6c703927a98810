use core::ops::Range;
use rayon::prelude::*;
use tousle_core::WindSample;
use tousle_field::{Field, GridSpec, Stencil, VoxelFlag};
use tousle_flow::{AirFlow, AirPlace, AirPoint};

/// The voxels of a grid, ready to be given the air of any step.
pub(crate) struct Voxels<'a> {
    grid: &'a GridSpec,
    air: &'a AirFlow,
    /// The voxels that are not inside the head, where no air is.
    flats: Vec<usize>,
    /// Their centers.
    points: Vec<AirPoint>,
}

impl<'a> Voxels<'a> {
    pub(crate) fn new(grid: &'a GridSpec, air: &'a AirFlow) -> Self {
        let center_m = |flat| grid.cell_center_m(grid.unflat(flat));
        let flats: Vec<usize> =
            (0..grid.n_voxels()).filter(|flat| !air.stream.is_solid(center_m(*flat))).collect();
        let points = flats.par_iter().map(|flat| air.point(center_m(*flat))).collect();
        Self { grid, air, flats, points }
    }

    /// The air at some steps: the most likely velocity at each center, and where a marker was. `samples` are those of each.
    pub(crate) fn fill_steps(&self, steps: Range<usize>, samples: &[Vec<WindSample>]) -> Vec<Field> {
        let states = &self.air.states[steps.clone()];
        let mut fields: Vec<Field> = states
            .iter()
            .map(|state| Field { outside: state.outside(), ..Field::still(self.grid) })
            .collect();
        let n_voxels = self.grid.n_voxels();
        self.air.during(steps).read(&self.points, |point, from, rows| {
            let flat = self.flats[point];
            for (axis, row) in rows.into_iter().enumerate() {
                let fields = fields[from..].iter_mut().zip(row);
                fields.for_each(|(field, component)| field.u[axis * n_voxels + flat] = *component);
            }
        });
        for (field, samples) in fields.iter_mut().zip(samples) {
            for voxel in samples.iter().filter_map(|sample| self.grid.voxel_at(sample.position_m)) {
                field.flags[self.grid.flat(voxel)] = VoxelFlag::Measured;
            }
        }
        fields
    }
}

/// How sure the air is, known on a lattice coarser than the grid: it changes as slowly as swirls do.
pub(crate) struct Deviations<'a> {
    air: &'a AirFlow,
    /// The lattice's points.
    points: Vec<AirPlace>,
    /// By voxel of the grid, the points around it, of which those in the head count nothing; `None` inside the head.
    stencils: Vec<Option<Stencil>>,
}

/// Distance of the lattice's points, m.
const COARSE_M: f64 = 0.06;

/// Where the variance of swirls is below this share of what it was before any lock was asked, a voxel is interpolated: some
/// decimeter about the locks, in strong swirls twice as far. Elsewhere it is the stream outside.
const KNOWN_SHARE: f64 = 0.75;

impl<'a> Deviations<'a> {
    pub(crate) fn new(grid: &GridSpec, air: &'a AirFlow) -> Self {
        let dims = grid.dims.map(|n| ((n as f64 * grid.edge_m / COARSE_M).ceil() as usize).max(1));
        let coarse = GridSpec { origin_m: grid.origin_m, edge_m: COARSE_M, dims };
        let is_air: Vec<bool> = (0..coarse.n_voxels())
            .map(|flat| !air.stream.is_solid(coarse.cell_center_m(coarse.unflat(flat))))
            .collect();
        let point = |flat| air.place(coarse.cell_center_m(coarse.unflat(flat)));
        let stencil = |flat| {
            let center_m = grid.cell_center_m(grid.unflat(flat));
            (!air.stream.is_solid(center_m)).then(|| in_air(Stencil::at(&coarse, center_m), &is_air))
        };
        Self {
            air,
            points: (0..coarse.n_voxels()).map(point).collect(),
            stencils: (0..grid.n_voxels()).map(stencil).collect(),
        }
    }

    /// Adds them to a step, and flags where locks tell of the air.
    pub(crate) fn add_to(&self, field: &mut Field, step: usize) {
        let spreads = self.air.spreads(step, &self.points);
        let mut sd = vec![0.0f32; self.stencils.len()];
        for (flat, stencil) in self.stencils.iter().enumerate() {
            let Some(stencil) = stencil else { continue };
            let (mut deviation_mps, mut unknown_swirls) = (0.0, 0.0);
            for (point, weight) in stencil.flats.iter().zip(&stencil.weights) {
                deviation_mps += weight * spreads[*point].deviation_mps;
                unknown_swirls += weight * spreads[*point].unknown_swirls;
            }
            sd[flat] = deviation_mps as f32;
            if unknown_swirls < KNOWN_SHARE && field.flags[flat] == VoxelFlag::Outside {
                field.flags[flat] = VoxelFlag::Interpolated;
            }
        }
        field.sd = Some(sd);
    }
}

/// A stencil of which only the points in the air count, if there are any: nothing is unknown in a head.
fn in_air(mut stencil: Stencil, is_air: &[bool]) -> Stencil {
    let counts = stencil.flats.map(|flat| if is_air[flat] { 1.0 } else { 0.0 });
    let sum: f64 = stencil.weights.iter().zip(counts).map(|(weight, counts)| weight * counts).sum();
    if sum > 0.0 {
        stencil.weights.iter_mut().zip(counts).for_each(|(weight, counts)| *weight *= counts / sum);
    }
    stencil
}

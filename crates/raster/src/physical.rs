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
    /// By voxel of the grid, the points around it; `None` inside the head.
    stencils: Vec<Option<Stencil>>,
}

/// Distance of the lattice's points, m.
const COARSE_M: f64 = 0.06;

/// Where the spread of the swirls is below this share of what it was before any lock was asked, a voxel is
/// interpolated; elsewhere it is the stream outside.
const KNOWN_SHARE: f64 = 0.75;

impl<'a> Deviations<'a> {
    pub(crate) fn new(grid: &GridSpec, air: &'a AirFlow) -> Self {
        let dims = grid.dims.map(|n| ((n as f64 * grid.edge_m / COARSE_M).ceil() as usize).max(1));
        let coarse = GridSpec { origin_m: grid.origin_m, edge_m: COARSE_M, dims };
        let point = |flat| air.place(coarse.cell_center_m(coarse.unflat(flat)));
        let stencil = |flat| {
            let center_m = grid.cell_center_m(grid.unflat(flat));
            (!air.stream.is_solid(center_m)).then(|| Stencil::at(&coarse, center_m))
        };
        Self {
            air,
            points: (0..coarse.n_voxels()).map(point).collect(),
            stencils: (0..grid.n_voxels()).map(stencil).collect(),
        }
    }

    /// Adds them to a step, and flags where locks tell of the air.
    pub(crate) fn add_to(&self, field: &mut Field, step: usize) {
        let spreads_mps = self.air.spreads_mps(step, &self.points);
        let swirl_mps = self.air.states[step].swirl_mps;
        let mut sd = vec![0.0f32; self.stencils.len()];
        for (flat, stencil) in self.stencils.iter().enumerate() {
            let Some(stencil) = stencil else { continue };
            let parts = stencil.flats.iter().zip(&stencil.weights);
            let spread_mps: f64 = parts.map(|(point, weight)| spreads_mps[*point] * weight).sum();
            sd[flat] = spread_mps as f32;
            if spread_mps < KNOWN_SHARE * swirl_mps && field.flags[flat] == VoxelFlag::Outside {
                field.flags[flat] = VoxelFlag::Interpolated;
            }
        }
        field.sd = Some(sd);
    }
}

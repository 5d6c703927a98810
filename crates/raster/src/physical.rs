use tousle_core::{Vec3, WindSample};
use tousle_field::{Field, GridSpec, VoxelFlag};
use tousle_flow::{AirFlow, StreamAt};

/// The voxels of a grid, ready to be given the air of any step.
pub(crate) struct Voxels<'a> {
    grid: &'a GridSpec,
    air: &'a AirFlow,
    /// What the stream does at each voxel's center; `None` inside the head, where no air is.
    streams: Vec<Option<StreamAt>>,
    /// A coarser lattice on which the uncertainty is known.
    coarse: GridSpec,
    /// Its points, and what the stream does there.
    coarse_points: Vec<(Vec3, StreamAt)>,
}

/// Distance of the points at which the uncertainty is computed, m: it changes as slowly as swirls do.
const COARSE_M: f64 = 0.06;

/// Where the spread of the swirls is below this share of what it was before any lock was asked, a voxel is
/// interpolated; elsewhere it is the stream outside.
const KNOWN_SHARE: f64 = 0.75;

impl<'a> Voxels<'a> {
    pub(crate) fn new(grid: &'a GridSpec, air: &'a AirFlow) -> Self {
        let streams = (0..grid.n_voxels())
            .map(|flat| {
                let center_m = grid.cell_center_m(grid.unflat(flat));
                (!air.stream.is_solid(center_m)).then(|| air.stream.at(center_m))
            })
            .collect();
        let dims = grid.dims.map(|n| ((n as f64 * grid.edge_m / COARSE_M).ceil() as usize).max(1));
        let coarse = GridSpec { origin_m: grid.origin_m, edge_m: COARSE_M, dims };
        let point = |flat| {
            let point_m = coarse.cell_center_m(coarse.unflat(flat));
            (point_m, air.stream.at(point_m))
        };
        let coarse_points = (0..coarse.n_voxels()).map(point).collect();
        Self { grid, air, streams, coarse, coarse_points }
    }

    /// The air at a step: the most likely velocity at each center, how sure it is, and where it comes from.
    pub(crate) fn fill_step(&self, step: usize, samples: &[WindSample]) -> Field {
        let state = &self.air.states[step];
        let mut field = Field { outside: state.outside(), ..Field::still(self.grid) };
        let n_modes = state.n_modes();
        let coefficients: Vec<f64> = state.values.iter().take(n_modes).map(|c| c * state.swirl_mps).collect();
        let swirls = self.air.modes.flow(&coefficients);
        let spreads = self.spreads(step);
        let parts = state.parts();
        let mut sd = vec![0.0f32; self.grid.n_voxels()];
        for (flat, stream) in self.streams.iter().enumerate() {
            let Some(stream) = stream else { continue };
            let center_m = self.grid.cell_center_m(self.grid.unflat(flat));
            let wind = stream.wind(state.outside(), &parts, state.wake(), state.layer_m());
            field.set_vector(flat, wind.velocity + swirls.at(center_m) * wind.layer);
            let (spread, known) = self.read(&spreads, center_m);
            sd[flat] = spread as f32;
            if known < KNOWN_SHARE {
                field.flags[flat] = VoxelFlag::Interpolated;
            }
        }
        for sample in samples {
            if let Some(voxel) = self.grid.voxel_at(sample.position_m) {
                field.flags[self.grid.flat(voxel)] = VoxelFlag::Measured;
            }
        }
        field.sd = Some(sd);
        field
    }

    /// Standard deviation a component, and that of the swirls over what it was before, at the coarse points.
    fn spreads(&self, step: usize) -> Vec<(f64, f64)> {
        let swirl_mps = self.air.states[step].swirl_mps;
        let spreads_mps = self.air.spreads_mps(step, &self.coarse_points);
        spreads_mps.into_iter().map(|spread| (spread, spread / swirl_mps)).collect()
    }

    fn read(&self, spreads: &[(f64, f64)], point_m: Vec3) -> (f64, f64) {
        let stencil = tousle_field::Stencil::at(&self.coarse, point_m);
        let mut sum = (0.0, 0.0);
        for (flat, weight) in stencil.flats.iter().zip(&stencil.weights) {
            sum.0 += spreads[*flat].0 * weight;
            sum.1 += spreads[*flat].1 * weight;
        }
        sum
    }
}

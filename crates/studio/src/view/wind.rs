//! The field as arrows and as a slice.

use super::color::{ColorBy, UNKNOWN, of_origin, ramp};
use eframe::egui::Color32;
use tousle_core::{Quantity, Vec3};
use tousle_field::{Field, FieldLayer, FieldSequence, VoxelFlag, VoxelIndex};

/// Where arrows stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrows {
    /// Nowhere.
    #[default]
    Off,
    /// All over the grid.
    Everywhere,
    /// Where something was measured or interpolated.
    Measured,
    /// In the slice.
    Slice,
}

impl Arrows {
    /// All of them, as they are offered.
    pub const ALL: [Self; 4] = [Self::Off, Self::Everywhere, Self::Measured, Self::Slice];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "Off",
            Self::Everywhere => "Everywhere",
            Self::Measured => "Where measured",
            Self::Slice => "In the slice",
        }
    }
}

/// How the field is shown.
#[derive(Clone, Debug, PartialEq)]
pub struct WindLook {
    /// Where arrows stand.
    pub arrows: Arrows,
    /// Whether the slice is shown.
    pub slice: bool,
    /// The axis across which the slice lies: 0 forward, 1 left, 2 up.
    pub slice_axis: usize,
    /// Where on that axis, 0 to 1 of the grid.
    pub slice_at: f64,
    /// What both are colored by.
    pub color_by: ColorBy,
}

impl Default for WindLook {
    fn default() -> Self {
        Self { arrows: Arrows::Off, slice: false, slice_axis: 1, slice_at: 0.5, color_by: ColorBy::Strength }
    }
}

/// What is fully colored: the numbers at the end of each ramp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Strength, in the quantity's unit.
    pub strength: f64,
    /// Standard deviation, likewise; `None` if the field knows none.
    pub deviation: Option<f64>,
}

/// The most arrows all over the grid: more hide one another.
const MAX_ARROWS: usize = 1100;
/// Cells of the slice along each side.
const N_CELLS: usize = 64;
/// The longest arrow, in distances between arrows.
const LONGEST: f64 = 0.95;

impl Scales {
    /// What 98 of 100 voxels stay below, in steps over the whole time.
    pub fn of(field: &FieldSequence) -> Self {
        let every = field.steps.len().div_ceil(12);
        let steps = || field.steps.iter().step_by(every);
        let vectors = |s: &Field| (0..s.flags.len()).map(|v| s.vector(v).norm()).collect::<Vec<_>>();
        let strength = high(steps().flat_map(vectors).collect()).unwrap_or(1.0);
        let deviations = steps().filter_map(|s| s.sd.as_ref()).flatten().map(|sd| f64::from(*sd));
        let deviation = high(deviations.filter(|sd| sd.is_finite()).collect());
        Self { strength: round_up(strength), deviation: deviation.map(round_up) }
    }
}

/// The unit of a field's vectors.
pub fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::AirVelocity => "m/s",
        Quantity::ForcePerMass => "m/s²",
    }
}

/// The 98th percentile.
fn high(mut values: Vec<f64>) -> Option<f64> {
    let at = values.len().checked_sub(1)? * 98 / 100;
    Some(*values.select_nth_unstable_by(at, f64::total_cmp).1)
}

/// The next number of one digit, or of one and a half: 4.3 becomes 4.5.
fn round_up(value: f64) -> f64 {
    if !(value.is_finite() && value > 0.0) {
        return 1.0;
    }
    let step = libm::pow(10.0, libm::floor(libm::log10(value))) / 2.0;
    (value / step).ceil() * step
}

/// The field at one time, with the stack on it.
#[derive(Debug)]
pub struct Wind<'a> {
    field: &'a FieldSequence,
    slice: tousle_field::FieldSlice<'a>,
    /// The step nearest in time: whose flags and deviations are shown.
    step: &'a Field,
    layers: Vec<(&'a FieldLayer, f64)>,
    scales: Scales,
    color_by: ColorBy,
}

impl<'a> Wind<'a> {
    /// The field at a time, s.
    pub fn at(
        field: &'a FieldSequence,
        stack: &'a [FieldLayer],
        time_secs: f64,
        scales: Scales,
        color_by: ColorBy,
    ) -> Self {
        let step = ((time_secs - field.start_secs) * field.rate_hz).round() as usize;
        let layers = stack.iter().map(|layer| (layer, layer.presence(time_secs)));
        Self {
            field,
            slice: field.at(time_secs),
            step: &field.steps[step.min(field.steps.len() - 1)],
            layers: layers.filter(|(_, presence)| *presence > 0.0).collect(),
            scales,
            color_by,
        }
    }

    fn vector(&self, point_m: Vec3) -> Vec3 {
        let apply = |vector, (layer, presence): &(&FieldLayer, f64)| layer.apply(point_m, *presence, vector);
        self.layers.iter().fold(self.slice.sample(point_m), apply)
    }

    fn color(&self, point_m: Vec3, vector: Vec3) -> Color32 {
        let voxel = self.field.grid.voxel_at(point_m).map(|voxel| self.field.grid.flat(voxel));
        match self.color_by {
            ColorBy::Strength => ramp((vector.norm() / self.scales.strength) as f32),
            ColorBy::Origin => of_origin(voxel.map_or(VoxelFlag::Outside, |v| self.step.flags[v])),
            ColorBy::Deviation => {
                let sd = voxel.and_then(|v| self.step.sd.as_ref().map(|sd| sd[v]));
                let share = |sd: f32| sd / self.scales.deviation.unwrap_or(1.0) as f32;
                sd.filter(|sd| sd.is_finite()).map_or(UNKNOWN, |sd| ramp(share(sd)))
            }
        }
    }

    /// Three vectors an arrow: its middle, from tail to head, color.
    pub fn arrows(&self, look: &WindLook) -> Vec<[f32; 4]> {
        let grid = &self.field.grid;
        let (places, apart): (Vec<Vec3>, f64) = match look.arrows {
            Arrows::Off => return Vec::new(),
            Arrows::Everywhere => {
                let stride =
                    (1..).find(|s| grid.dims.iter().map(|n| n.div_ceil(*s)).product::<usize>() <= MAX_ARROWS);
                let stride = stride.unwrap_or(1);
                let along = |axis: usize| (stride / 2..grid.dims[axis]).step_by(stride);
                let places =
                    along(0).flat_map(|x| along(1).flat_map(move |y| along(2).map(move |z| [x, y, z])));
                (places.map(|v| grid.cell_center_m(VoxelIndex(v))).collect(), stride as f64 * grid.edge_m)
            }
            Arrows::Measured => {
                let known = self.step.flags.iter().enumerate().filter(|(_, f)| **f != VoxelFlag::Outside);
                (known.map(|(v, _)| grid.cell_center_m(grid.unflat(v))).collect(), grid.edge_m * 1.5)
            }
            Arrows::Slice => {
                let every = [0, 1, 2].map(|axis| grid.dims[axis].div_ceil(30));
                let [u, v] = others(look.slice_axis);
                let along = |axis: usize| (0..grid.dims[axis]).step_by(every[axis]);
                let place = |i: usize, j: usize| {
                    let mut voxel = [0; 3];
                    (voxel[u], voxel[v]) = (i, j);
                    let mut center = grid.cell_center_m(VoxelIndex(voxel));
                    center[look.slice_axis] = self.slice_m(look);
                    center
                };
                let places = along(u).flat_map(|i| along(v).map(move |j| (i, j)));
                (places.map(|(i, j)| place(i, j)).collect(), grid.edge_m * every[u] as f64)
            }
        };
        let mut arrows = Vec::with_capacity(3 * places.len());
        for place in places {
            let vector = self.vector(place);
            let strength = vector.norm();
            // Below a hundredth of the scale an arrow has no direction to speak of, in the head no air.
            if strength > 0.01 * self.scales.strength {
                let length = LONGEST * apart * (strength / self.scales.strength).min(1.0).sqrt();
                arrows.push(single(place, 0.0));
                arrows.push(single(vector * (length / strength), 0.0));
                arrows.push(rgba(self.color(place, vector), 1.0));
            }
        }
        arrows
    }

    /// Two vectors a vertex of the slice's triangles: place, color and opacity.
    pub fn slice(&self, look: &WindLook) -> Vec<[f32; 4]> {
        let grid = &self.field.grid;
        let (low, size) = (grid.origin_m, grid.far_corner_m() - grid.origin_m);
        let [u, v] = others(look.slice_axis);
        let corner = |i: usize, j: usize| {
            let mut place = low;
            place[u] += size[u] * i as f64 / N_CELLS as f64;
            place[v] += size[v] * j as f64 / N_CELLS as f64;
            place[look.slice_axis] = self.slice_m(look);
            let vector = self.vector(place);
            // Air at rest is seen through.
            let opacity = 0.25 + 0.45 * (vector.norm() / self.scales.strength).min(1.0) as f32;
            [single(place, 0.0), rgba(self.color(place, vector), opacity)]
        };
        let corners: Vec<Vec<_>> =
            (0..=N_CELLS).map(|i| (0..=N_CELLS).map(|j| corner(i, j)).collect()).collect();
        let cells = (0..N_CELLS).flat_map(|i| (0..N_CELLS).map(move |j| (i, j)));
        let triangles =
            |(i, j): (usize, usize)| [(i, j), (i + 1, j), (i, j + 1), (i, j + 1), (i + 1, j), (i + 1, j + 1)];
        cells.flat_map(triangles).flat_map(|(i, j)| corners[i][j]).collect()
    }

    /// Where the slice is on its axis, m.
    fn slice_m(&self, look: &WindLook) -> f64 {
        let grid = &self.field.grid;
        let (low, high) = (grid.origin_m[look.slice_axis], grid.far_corner_m()[look.slice_axis]);
        low + (high - low) * look.slice_at
    }
}

/// The two axes that are not this one.
fn others(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

fn single(v: Vec3, w: f32) -> [f32; 4] {
    [v.x as f32, v.y as f32, v.z as f32, w]
}

fn rgba(color: Color32, opacity: f32) -> [f32; 4] {
    let [r, g, b] = [color.r(), color.g(), color.b()].map(|c| f32::from(c) / 255.0);
    [r, g, b, opacity]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing;

    #[test]
    fn scales_are_round_numbers_above_nearly_all() {
        let mut field = testing::field();
        for step in &mut field.steps {
            step.u.fill(2.5);
        }
        assert_eq!(Scales::of(&field), Scales { strength: 4.5, deviation: None });
        assert_eq!(round_up(0.0), 1.0);
        assert!((round_up(0.012) - 0.015).abs() < 1e-12);
    }

    #[test]
    fn arrows_and_slices_lie_in_the_grid_and_show_the_stack() {
        let mut field = testing::field();
        field.steps.iter_mut().for_each(|step| step.u[..216].fill(3.0));
        let layer = testing::layer("lift");
        let stack = [layer];
        let wind = Wind::at(&field, &stack, 0.55, Scales::of(&field), ColorBy::Strength);
        let look = WindLook { arrows: Arrows::Everywhere, ..WindLook::default() };
        let arrows = wind.arrows(&look);
        assert_eq!(arrows.len(), 3 * 216);
        assert!(arrows.chunks(3).all(|a| a[0][..3].iter().all(|c| c.abs() < 0.3) && a[1][0] > 0.0));
        assert_eq!(wind.slice(&look).len(), 2 * 6 * N_CELLS * N_CELLS);
        assert!(wind.vector(Vec3::new(0.1, 0.0, -0.1)).x > 3.9);
    }
}

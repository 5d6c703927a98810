mod ghosts;
mod layers;
mod places;

use crate::{Field, FieldLayer, FieldSequence, Window};
use ghosts::{GhostVectors, Ghosts};
use layers::Placed;
use places::{Places, Raw, Voxels, lay_together};
use pulp::{Simd, WithSimd};
use std::sync::{Arc, OnceLock};
use tousle_core::Vec3;

/// A field ready to be asked by very many points, in single precision.
///
/// Beside [`FieldSequence::at`] it knows where no air is and what stands in for it, and can lay the two steps around a
/// time together once for all points.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    sequence: &'a FieldSequence,
    /// What stands in for air where there is none; `None` if all voxels have some.
    ghosts: Option<Arc<Ghosts>>,
    /// Each step's, once someone asks for it.
    ghost_vectors: Arc<[OnceLock<GhostVectors>]>,
    /// What is laid out of each step.
    kept: Window,
    /// Each step as it is looked up, once someone asks for it.
    laid_out: Arc<[OnceLock<Voxels>]>,
    /// Whether a step is still, outside the grid too.
    is_still: Arc<[bool]>,
    layers: Vec<Placed<'a>>,
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
    layers: Vec<(&'a Placed<'a>, f32)>,
}

/// How a [`Sampler`] reads the steps of its field. The vectors are the same to the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// As they lie in memory: for points so few that most voxels are never asked for.
    AsTheyLie,
    /// Each laid out once so that what a point needs of it is in one place.
    LaidOut,
    /// Laid out, and the two steps around a time laid together for the whole grid: for more points than the grid has
    /// voxels over six.
    Together,
}

/// Where a moment's vectors are: mostly in two neighboring steps, with the share of the second.
#[derive(Clone, Debug)]
enum Source<'a> {
    AsTheyLie { before: Raw<'a>, after: Raw<'a>, share: f32 },
    LaidOut { before: &'a Voxels, after: &'a Voxels, share: f32 },
    Together(Voxels),
}

/// How many points are looked up side by side.
pub const SAMPLED_AT_ONCE: usize = 16;

const WIDTH: usize = SAMPLED_AT_ONCE;

/// Some points or vectors: rows of x, y and z.
pub type Rows = [[f32; SAMPLED_AT_ONCE]; 3];

/// How many [`Rows`] are looked for in the grid before the first of them is read: a processor finds the next while it waits for
/// the voxels of one.
const FOUND_AHEAD: usize = 2;

impl<'a> Sampler<'a> {
    /// A sampler of a field that [`FieldSequence::check`] has passed.
    ///
    /// `is_solid` says whether a point of head space, m, lies in the head. A voxel whose center does and whose vector
    /// is exactly zero in every step holds no air. Where there is air beside it, it is read as that goes on towards it.
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
        let shortest = grid.dims.iter().copied().min().unwrap_or(1) as f64 * grid.edge_m;
        let is_still = |step: &Field| step.outside == Vec3::zeros() && step.u.iter().all(|u| *u == 0.0);
        Self {
            sequence,
            kept: Window::whole(grid),
            laid_out: sequence.steps.iter().map(|_| OnceLock::new()).collect(),
            is_still: sequence.steps.iter().map(is_still).collect(),
            ghosts: Ghosts::of(grid, &has_air).map(Arc::new),
            ghost_vectors: sequence.steps.iter().map(|_| OnceLock::new()).collect(),
            layers: Placed::common(&sequence.layers),
            origin: grid.origin_m.map(|c| c as f32).into(),
            per_edge: (1.0 / grid.edge_m) as f32,
            fades_over: (0.5 * shortest) as f32,
        }
    }

    /// The same for points of a box alone, by its lower and its upper corner, head space, m: of each step no more is laid
    /// out than these need. They see the same to the bit; others see what is nearest to them in the box.
    pub fn within(self, low_m: Vec3, high_m: Vec3) -> Self {
        let grid = &self.sequence.grid;
        // Single precision may see a point on the other side of a voxel's center.
        let slack_m = Vec3::repeat(1e-3 * grid.edge_m);
        let kept = Window::around(grid, low_m - slack_m, high_m + slack_m);
        let laid_out = self.sequence.steps.iter().map(|_| OnceLock::new()).collect();
        Self { kept, laid_out, ..self }
    }

    /// The field.
    pub fn sequence(&self) -> &'a FieldSequence {
        self.sequence
    }

    /// How many voxels of a step are laid out.
    pub fn n_kept(&self) -> usize {
        self.kept.n_voxels()
    }

    /// The same steps under other layers than the sequence's own.
    pub fn with_layers(&self, layers: &'a [FieldLayer]) -> Self {
        self.with_variants(layers, &[])
    }

    /// The same steps under other layers, for variants that are asked for in turn: of the points given to
    /// [`Moment::sample_all`], every n-th belongs to the same of n variants and sees its layers beside the common ones; n
    /// divides [`SAMPLED_AT_ONCE`].
    pub fn with_variants(&self, layers: &'a [FieldLayer], variants: &[&'a [FieldLayer]]) -> Self {
        let mut placed = Placed::common(layers);
        placed.extend(Placed::in_turn(variants));
        Self { layers: placed, ..self.clone() }
    }

    /// Whether no wind blows anywhere at a time, s, layers left out.
    ///
    /// # Panics
    /// If the sequence has no step.
    pub fn is_still_at(&self, time_secs: f64) -> bool {
        let (around, _) = self.sequence.at(time_secs).around();
        around.iter().all(|step| self.is_still[*step])
    }

    /// The field at a time, s; before the first step the first holds, after the last the last.
    ///
    /// # Panics
    /// If the sequence has no step.
    pub fn at(&'a self, time_secs: f64, reading: Reading) -> Moment<'a> {
        let slice = self.sequence.at(time_secs);
        let (around, share) = slice.around();
        let share = share as f32;
        let layers = self.layers.iter().map(|placed| (placed, placed.presence(time_secs) as f32));
        let layers: Vec<_> = layers.filter(|(_, presence)| *presence > 0.0).collect();
        let laid_out = || around.map(|step| self.laid_out[step].get_or_init(|| self.lay_out(step)));
        let source = match reading {
            Reading::AsTheyLie => {
                let [before, after] = around.map(|step| self.raw(step));
                Source::AsTheyLie { before, after, share }
            }
            Reading::LaidOut => {
                let [before, after] = laid_out();
                Source::LaidOut { before, after, share }
            }
            Reading::Together => {
                let [before, after] = laid_out();
                Source::Together(lay_together(before, after, share))
            }
        };
        Moment {
            sampler: self,
            source,
            outside: slice.outside().map(|c| c as f32).into(),
            is_still: layers.is_empty() && around.iter().all(|step| self.is_still[*step]),
            layers,
        }
    }

    fn raw(&self, step: usize) -> Raw<'_> {
        let field = &self.sequence.steps[step];
        let n = field.flags.len();
        let ghosts = self.ghosts.as_deref().map(|ghosts| {
            let vectors = self.ghost_vectors[step].get_or_init(|| ghosts.vectors(field));
            (ghosts, &vectors[..])
        });
        Raw { vectors: [0, 1, 2].map(|axis| &field.u[axis * n..][..n]), ghosts }
    }

    fn lay_out(&self, step: usize) -> Voxels {
        let Raw { vectors, ghosts } = self.raw(step);
        let grid = &self.sequence.grid;
        let mut voxels = vec![[0.0; 4]; self.kept.n_voxels() + 1];
        for (voxels, row) in voxels.chunks_mut(self.kept.dims[2]).zip(self.kept.rows(grid)) {
            // Slices of one length: only so the compiler makes vector instructions of the loop.
            let [x, y, z] = vectors.map(|component| &component[row.clone()]);
            for (k, voxel) in voxels.iter_mut().enumerate() {
                *voxel = [x[k], y[k], z[k], 0.0];
            }
        }
        if let Some((ghosts, vectors)) = ghosts {
            for (flat, [x, y, z]) in ghosts.flats().zip(vectors) {
                if let Some(place) = self.kept.place(grid.unflat(flat)) {
                    voxels[place] = [*x, *y, *z, 0.0];
                }
            }
        }
        voxels.into_boxed_slice()
    }

    /// Where points lie in a window of the grid.
    #[inline(always)]
    fn places(&self, points_m: &Rows, window: Window) -> Places {
        let strides = [(window.dims[1] * window.dims[2]) as u32, window.dims[2] as u32, 1];
        let mut low = [0; WIDTH];
        let mut steps = [[0; WIDTH]; 2];
        let mut shares = [[0.0; WIDTH]; 3];
        let mut beyond2 = [0.0f32; WIDTH];
        for axis in 0..3 {
            let size = self.sequence.grid.dims[axis] as f32;
            let first = window.first[axis];
            let last = first + window.dims[axis] - 1;
            for k in 0..WIDTH {
                let place = (points_m[axis][k] - self.origin[axis]) * self.per_edge;
                let beyond = larger(larger(-place, place - size), 0.0);
                beyond2[k] += beyond * beyond;
                let at = smaller(larger(place - 0.5, first as f32), last as f32);
                // A whole number may count as the end of the voxel before.
                let voxel = floor_index(at).max(first as u32);
                shares[axis][k] = at - voxel as f32;
                low[k] += (voxel - first as u32) * strides[axis];
                if axis < 2 {
                    steps[axis][k] = if voxel < last as u32 { strides[axis] } else { 0 };
                }
            }
        }
        let per_fade = 1.0 / (self.per_edge * self.fades_over);
        let mut far = [0.0; WIDTH];
        for k in 0..WIDTH {
            far[k] = smaller(beyond2[k].sqrt() * per_fade, 1.0);
        }
        Places { low, steps, shares, far }
    }
}

/// The larger of two; the second if the first is NaN.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two; the second if the first is NaN.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// A whole number with `at` between it and the next, both included; for `at` from 0 to 2²².
///
/// Half less plus 1.5 · 2²³ is rounded to a whole number, which then stands in the last bits. A conversion would do
/// too, but one number at a time.
#[inline(always)]
fn floor_index(at: f32) -> u32 {
    const SHIFT: f32 = 12_582_912.0;
    (at - 0.5 + SHIFT).to_bits() - SHIFT.to_bits()
}

impl Moment<'_> {
    /// Whether no wind blows anywhere.
    pub fn is_still(&self) -> bool {
        self.is_still
    }

    /// The vectors at points, head space, m, layers included; deep in a head, zero.
    ///
    /// Compiled for the widest registers of the machine it runs on; once, whoever asks.
    #[inline(never)]
    pub fn sample_all(&self, points_m: &[Rows], vectors: &mut [Rows]) {
        pulp::Arch::new().dispatch(Sample { moment: self, points_m, vectors });
    }

    /// [`Moment::sample_all`] of up to [`FOUND_AHEAD`], layers left out.
    #[inline(always)]
    fn look_up<S: Simd>(&self, simd: S, points_m: &[Rows], vectors: &mut [Rows]) {
        let window = match &self.source {
            Source::AsTheyLie { .. } => Window::whole(&self.sampler.sequence.grid),
            _ => self.sampler.kept,
        };
        let mut places = [Places::ZERO; FOUND_AHEAD];
        for (places, points_m) in places.iter_mut().zip(points_m) {
            *places = self.sampler.places(points_m, window);
        }
        // Loops: what an array's `map` or an iterator's `for_each` is given would be called, compiled for any processor.
        match &self.source {
            Source::Together(voxels) => {
                for (found, places) in vectors.iter_mut().zip(&places) {
                    *found = places.gather(simd, voxels);
                }
            }
            Source::LaidOut { before, after, share } => {
                for (found, places) in vectors.iter_mut().zip(&places) {
                    *found = places.gather_mixed(*before, *after, *share);
                }
            }
            Source::AsTheyLie { before, after, share } => {
                for (found, places) in vectors.iter_mut().zip(&places) {
                    *found = places.gather_mixed(before, after, *share);
                }
            }
        }
        for (vectors, places) in vectors.iter_mut().zip(&places) {
            for (component, outside) in vectors.iter_mut().zip(self.outside) {
                for (inside, far) in component.iter_mut().zip(places.far) {
                    *inside += (outside - *inside) * far;
                }
            }
        }
    }

    /// [`Moment::sample_all`] for a single point.
    pub fn sample(&self, point_m: [f32; 3]) -> [f32; 3] {
        let mut vectors = [[[0.0; WIDTH]; 3]];
        self.sample_all(&[point_m.map(|c| [c; WIDTH])], &mut vectors);
        vectors[0].map(|component| component[0])
    }
}

/// [`Moment::sample_all`], for some registers.
struct Sample<'a, 'm> {
    moment: &'a Moment<'m>,
    points_m: &'a [Rows],
    vectors: &'a mut [Rows],
}

impl WithSimd for Sample<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { moment, points_m, vectors } = self;
        for (points_m, vectors) in points_m.chunks(FOUND_AHEAD).zip(vectors.chunks_mut(FOUND_AHEAD)) {
            moment.look_up(simd, points_m, vectors);
            for (placed, presence) in &moment.layers {
                for (points_m, vectors) in points_m.iter().zip(&mut *vectors) {
                    placed.apply(points_m, *presence, vectors);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::GridSpec;
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

    const READINGS: [Reading; 3] = [Reading::AsTheyLie, Reading::LaidOut, Reading::Together];

    /// All ways to read agree with the sequence's own, inside and outside the box, and with each other to the bit.
    #[test]
    fn all_ways_agree_with_the_sequence() {
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
                for reading in READINGS {
                    let found = Vec3::from(sampler.at(time, reading).sample(single).map(f64::from));
                    assert!((found - expected).norm() < 1e-5, "{time} {point} {found} {expected}");
                }
                let found = READINGS.map(|reading| sampler.at(time, reading).sample(single));
                assert!(found.iter().all(|f| *f == found[0]), "{time} {point} {found:?}");
            }
        }
    }

    /// Points of a box see the same wherever no more than it needs is laid out; of a box beyond the grid, too.
    #[test]
    fn points_of_a_box_need_no_more_than_it_holds() {
        let grid = GridSpec { dims: [6, 5, 4], ..GridSpec::cube(0.6, 0.1).unwrap() };
        let in_head = |p: Vec3| p.norm() < 0.12;
        let sequence = sequence(grid, in_head);
        let whole = Sampler::new(&sequence, in_head);
        for (low, high) in [
            (Vec3::new(-0.11, -0.07, -0.2), Vec3::new(0.08, 0.12, -0.05)),
            (Vec3::new(0.2, -0.5, -0.2), Vec3::new(0.5, -0.1, 0.6)),
        ] {
            let part = whole.clone().within(low, high);
            assert!(part.n_kept() < whole.n_kept());
            for k in 0..1000 {
                let shares = Vec3::new(f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100)) / 9.0;
                let point = (low + (high - low).component_mul(&shares)).map(|c| c as f32).into();
                for reading in READINGS {
                    let [part, whole] = [&part, &whole].map(|s| s.at(0.07, reading).sample(point));
                    assert_eq!(part, whole, "{point:?} {reading:?}");
                }
            }
        }
    }

    /// Points that share voxels and points that do not are looked up in other ways, and in all registers see the same to the bit.
    #[test]
    fn a_point_does_not_know_who_is_looked_up_beside_it() {
        let grid = GridSpec::cube(0.6, 0.1).unwrap();
        let in_head = |p: Vec3| p.norm() < 0.12;
        let sequence = sequence(grid, in_head);
        let sampler = Sampler::new(&sequence, in_head);
        let moment = sampler.at(0.07, Reading::Together);
        for spread in [0.0, 0.01, 0.05, 0.1, 0.2, 0.7] {
            let point =
                |k: usize| [0, 1, 2].map(|axis| (spread * libm::sin((7 * k + 3 * axis) as f64)) as f32);
            let row = |n: usize| [0, 1, 2].map(|axis| core::array::from_fn(|k| point(WIDTH * n + k)[axis]));
            let points: Vec<Rows> = (0..3).map(row).collect();
            let mut together = vec![[[0.0; WIDTH]; 3]; points.len()];
            moment.sample_all(&points, &mut together);
            for k in 0..WIDTH * points.len() {
                let found = together[k / WIDTH].map(|component| component[k % WIDTH]);
                assert_eq!(found, moment.sample(point(k)), "{spread} {k}");
            }
            let mut alone = together.clone();
            let sample = Sample { moment: &moment, points_m: &points, vectors: &mut alone };
            sample.with_simd(pulp::Scalar::new());
            assert_eq!(alone, together, "in all registers, {spread}");
        }
    }

    /// Two variants and a common layer: each point sees the common one, every second the first variant's.
    #[test]
    fn variants_are_seen_in_turn() {
        let grid = GridSpec::cube(0.6, 0.1).unwrap();
        let still = FieldSequence { steps: vec![Field::still(&grid)], ..sequence(grid, |_| false) };
        let layer = |extra: Vec3| FieldLayer {
            id: "1".into(),
            name: "1".into(),
            muted: false,
            first_secs: 0.0,
            last_secs: 2.0,
            ease: crate::Ease { rise: 0.0, fall: 0.0 },
            handles: vec![crate::Handle { center_m: Vec3::zeros(), reach_m: 0.1, extra }],
            reshape: None,
            origin: crate::LayerOrigin::Drag {
                strand: "A".into(),
                control_point: 1,
                target_m: Vec3::zeros(),
                method: "paper".into(),
            },
        };
        let (common, first, second) = ([layer(Vec3::z())], [layer(Vec3::x())], [layer(Vec3::y())]);
        let sampler = Sampler::new(&still, |_| false);
        let variants = sampler.with_variants(&common, &[&first, &second]);
        let mut points = [[0.0; WIDTH]; 3];
        points[0][3] = 0.2;
        let mut found = [[[0.0; WIDTH]; 3]];
        variants.at(1.0, Reading::LaidOut).sample_all(&[points], &mut found);
        let found = found[0];
        let found = [0, 1, 2, 3].map(|k| found.map(|component| component[k]));
        assert_eq!(found, [[1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [0.0; 3]]);
        assert_eq!(sampler.with_layers(&common).at(1.0, Reading::LaidOut).sample([0.0; 3]), [0.0, 0.0, 1.0]);
    }

    /// Right outside a head that holds no air the wind is what it is farther off, as it changes towards the head, and not a mixture
    /// with nothing.
    #[test]
    fn the_wind_goes_on_to_a_head_without_air() {
        let grid = GridSpec::cube(0.6, 0.1).unwrap();
        let in_head = |p: Vec3| p.norm() < 0.12;
        let sequence = sequence(grid, in_head);
        let seeing = Sampler::new(&sequence, in_head);
        let blind = Sampler::new(&sequence, |_| false);
        for k in 0..200 {
            let angle = f64::from(k);
            let way = Vec3::new(libm::cos(angle), libm::sin(angle), libm::sin(0.37 * angle)).normalize();
            let at = way * (0.12 + 0.0005 * angle);
            let (expected, point) = (Vec3::new(1.0 + at.x, 2.0 + at.y, 1.0), at.map(|c| c as f32).into());
            for reading in READINGS {
                let found = Vec3::from(seeing.at(0.0, reading).sample(point).map(f64::from));
                assert!((found - expected).norm() < 1e-5, "{found}, not {expected}, at {at}");
            }
            let slowed = blind.at(0.0, Reading::LaidOut).sample(point)[2];
            assert!(k > 0 || slowed < 0.95, "the head has no air: {slowed}");
        }
    }
}

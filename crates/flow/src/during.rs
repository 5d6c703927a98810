//! The air at several steps at once, a lane each.

use crate::shelter::LeeLanes;
use crate::stream::NearHead;
use crate::swirl::Node;
use crate::{AirFlow, StreamAt, SwirlModes, SwirlPlace};
use core::ops::Range;
use nalgebra::Matrix3;
use tousle_core::Vec3;
use tousle_lanes::{Lane, MOST_LANES, NullaryFnOnce, Precision, Registers, Vector, WithLanes, fade};

/// As many steps as are told at once.
pub const STEPS_AT_ONCE: usize = MOST_LANES;

/// A number for each step.
pub(crate) type Row = [f32; STEPS_AT_ONCE];

/// A point near the head, ready to be asked for the wind of any step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirPoint {
    stream: StreamAt,
    swirl: Option<SwirlPlace>,
}

/// The air at some steps, ready to be read at many points.
#[derive(Clone, Debug)]
pub struct AirSteps<'a> {
    modes: &'a SwirlModes,
    registers: Registers,
    n_steps: usize,
    /// The wind far away, m/s.
    outside: [Row; 3],
    /// The wakes' strength.
    wake: Row,
    /// The share that the layer takes at the scalp.
    taken: Row,
    /// That over the layer's displacement thickness, 1/m.
    per_layer: Row,
    parts: Vec<PartSteps>,
    /// Swirls at the nodes of the modes, m/s.
    nodes: Vec<Node>,
}

/// A part of the wind far away.
#[derive(Clone, Debug)]
struct PartSteps {
    /// What it is of the wind far away, m/s; none where there is no such part.
    wind: [Row; 3],
    lee: LeeLanes<Row>,
}

impl AirFlow {
    /// A point of head space, m.
    pub fn point(&self, point_m: Vec3) -> AirPoint {
        AirPoint { stream: self.stream.at(point_m), swirl: self.modes.place(point_m) }
    }

    /// The most likely air at some steps, in single precision.
    ///
    /// # Panics
    /// If there are more steps than [`STEPS_AT_ONCE`], or fewer in the air.
    pub fn during(&self, steps: Range<usize>) -> AirSteps<'_> {
        self.during_in(Registers::widest(), steps)
    }

    fn during_in(&self, registers: Registers, steps: Range<usize>) -> AirSteps<'_> {
        let nows: Vec<_> = steps.clone().map(|step| self.now(step)).collect();
        assert!(nows.len() <= STEPS_AT_ONCE, "{} steps, at most {STEPS_AT_ONCE} at once", nows.len());
        let n_parts = nows.iter().map(|now| now.parts.len()).max().unwrap_or(0);
        let row = |number: &dyn Fn(usize) -> f64| -> Row {
            core::array::from_fn(|k| if k < nows.len() { number(k) as f32 } else { 0.0 })
        };
        let vector = |vector: &dyn Fn(usize) -> Vec3| [0, 1, 2].map(|axis| row(&|k| vector(k)[axis]));
        let part = |part: usize| PartSteps {
            wind: vector(&|k| nows[k].parts.get(part).map_or_else(Vec3::zeros, |part| part.wind)),
            // A part that is not there takes nothing, whatever its lee is.
            lee: LeeLanes::of(|k| {
                let parts = &nows.get(k)?.parts;
                Some(&parts.get(part).or(parts.first())?.lee)
            }),
        };
        let states = &self.states[steps];
        let coefficient = |mode: usize| row(&|k| states[k].values[mode] * states[k].swirl_mps);
        let coefficients: Vec<Row> = (0..self.modes.n_modes()).map(coefficient).collect();
        AirSteps {
            modes: &self.modes,
            registers,
            n_steps: nows.len(),
            outside: vector(&|k| nows[k].outside),
            wake: row(&|k| nows[k].wake),
            per_layer: row(&|k| (1.0 - nows[k].slip) / nows[k].layer_m),
            taken: row(&|k| 1.0 - nows[k].slip),
            parts: (0..n_parts).map(part).collect(),
            nodes: registers
                .with_lanes(Precision::Single, Blowing { modes: &self.modes, coefficients: &coefficients }),
        }
    }
}

impl AirSteps<'_> {
    /// The wind at some points: to `put`, point after point and for some of the steps at a time, goes the point's number, the first
    /// of these steps, and x, y and z for each of them, m/s. What is told of more steps than there are means nothing.
    pub fn read(&self, points: &[AirPoint], put: impl FnMut(usize, usize, [&[f32]; 3])) {
        self.registers.with_lanes(Precision::Single, Reading { steps: self, points, put });
    }
}

/// What swirls at the nodes.
struct Blowing<'a> {
    modes: &'a SwirlModes,
    /// By mode.
    coefficients: &'a [Row],
}

impl WithLanes for Blowing<'_> {
    type Output = Vec<Node>;

    fn with<L: Lane>(self) -> Vec<Node> {
        let mut nodes = vec![[[0.0; STEPS_AT_ONCE]; 3]; self.modes.n_nodes()];
        for from in (0..STEPS_AT_ONCE).step_by(L::N) {
            let zero = L::zero();
            let coefficients: Vec<L> =
                self.coefficients.iter().map(|row| zero.of_single(&row[from..from + L::N])).collect();
            L::dispatch(BlowingAt {
                modes: self.modes,
                coefficients: &coefficients,
                zero,
                from,
                nodes: &mut nodes,
            });
        }
        nodes
    }
}

struct BlowingAt<'a, L> {
    modes: &'a SwirlModes,
    coefficients: &'a [L],
    zero: L,
    from: usize,
    nodes: &'a mut [Node],
}

impl<L: Lane> NullaryFnOnce for BlowingAt<'_, L> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { modes, coefficients, zero, from, nodes } = self;
        for (k, node) in nodes.iter_mut().enumerate() {
            let [xs, ys, zs] = modes.at_node(k);
            let mut swirl = Vector::none(zero);
            for (((x, y), z), coefficient) in xs.iter().zip(ys).zip(zs).zip(coefficients) {
                swirl = Vector::same(zero, Vec3::new(*x, *y, *z)).mul_add(*coefficient, swirl);
            }
            swirl.put_single(node, from);
        }
    }
}

/// The wind at points.
struct Reading<'a, F> {
    steps: &'a AirSteps<'a>,
    points: &'a [AirPoint],
    put: F,
}

impl<F: FnMut(usize, usize, [&[f32]; 3])> WithLanes for Reading<'_, F> {
    type Output = ();

    fn with<L: Lane>(self) {
        let Self { steps, points, mut put } = self;
        let zero = L::zero();
        for from in (0..steps.n_steps).step_by(L::N) {
            let row = |row: &Row| zero.of_single(&row[from..from + L::N]);
            let air = AirLanes {
                outside: Vector::of_single(zero, &steps.outside, from),
                wake: row(&steps.wake),
                per_layer: row(&steps.per_layer),
                taken: row(&steps.taken),
                parts: &steps
                    .parts
                    .iter()
                    .map(|part| (Vector::of_single(zero, &part.wind, from), part.lee.lanes(zero, from)))
                    .collect::<Vec<_>>(),
            };
            L::dispatch(ReadingAt { steps, points, from, air, put: &mut put });
        }
    }
}

struct ReadingAt<'a, L, F> {
    steps: &'a AirSteps<'a>,
    points: &'a [AirPoint],
    from: usize,
    air: AirLanes<'a, L>,
    put: F,
}

/// As in [`AirSteps`].
struct AirLanes<'a, L> {
    outside: Vector<L>,
    wake: L,
    per_layer: L,
    taken: L,
    parts: &'a [(Vector<L>, LeeLanes<L>)],
}

impl<L: Lane, F: FnMut(usize, usize, [&[f32]; 3])> NullaryFnOnce for ReadingAt<'_, L, F> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { steps, points, from, air, mut put } = self;
        let like = air.wake;
        let mut rows = [[0.0; STEPS_AT_ONCE]; 3];
        for (k, point) in points.iter().enumerate() {
            let mut wind = turned(&point.stream.potential, air.past(point.stream.near.as_ref()));
            if let Some(place) = &point.swirl {
                let left = point.stream.near.map_or(1.0, |near| near.swirls_left);
                for (node, weight) in steps.modes.corners(place) {
                    let swirl = Vector::of_single(like, &steps.nodes[node], from);
                    wind = swirl.mul_add(like.same(left * weight), wind);
                }
            }
            if let Some(near) = &point.stream.near {
                // 1 − (1 − s) e^(−(1 − s) d/δ) is left at the scalp.
                let fades = fade(like.same(near.distance_m) * air.per_layer);
                wind = wind * (like.same(1.0) - air.taken.mul_add(fades, air.taken));
            }
            wind.put_single(&mut rows, 0);
            put(k, from, [0, 1, 2].map(|axis| &rows[axis][..L::N]));
        }
    }
}

impl<L: Lane> AirLanes<'_, L> {
    /// What the wakes leave of the wind far away.
    #[inline(always)]
    fn past(&self, near: Option<&NearHead>) -> Vector<L> {
        let Some(near) = near else { return self.outside };
        let from_center = Vector::same(self.wake, near.from_center_m);
        let mut past = self.outside;
        for (wind, lee) in self.parts {
            if let Some(share) = lee.share(from_center) {
                past = wind.mul_add(-(share * self.wake), past);
            }
        }
        past
    }
}

/// A matrix times vectors.
#[inline(always)]
fn turned<L: Lane>(matrix: &Matrix3<f64>, v: Vector<L>) -> Vector<L> {
    let row = |r: usize| Vector::same(v.x, Vec3::new(matrix[(r, 0)], matrix[(r, 1)], matrix[(r, 2)])).dot(v);
    Vector::new(row(0), row(1), row(2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AirState, N_STREAM, Stream, SwirlKernel};
    use nalgebra::DVector;
    use tousle_core::{Attachment, Body, Collider, Shape};

    fn air(n_steps: usize) -> AirFlow {
        let shape =
            Shape::Ellipsoid { center_m: Vec3::new(0.0, 0.01, 0.0), half_axes_m: Vec3::new(0.08, 0.1, 0.12) };
        let head = Collider { name: "skull".to_owned(), attachment: Attachment::Head, shape };
        let body = Body { colliders: vec![head], ..Body::none() };
        let points: Vec<Vec3> = (0..8).map(|k| Vec3::new(0.12, 0.03 * f64::from(k), -0.1)).collect();
        let modes = SwirlModes::near(&points, SwirlKernel { length_m: 0.1 }, 12, 0.05);
        let n = modes.n_modes() + N_STREAM;
        let state = |step: usize| {
            let mut values = DVector::from_fn(n, |i, _| libm::sin((i + 3 * step) as f64));
            values.rows_mut(n - N_STREAM, N_STREAM).copy_from_slice(&[
                2.0,
                0.1 * step as f64,
                0.3,
                0.6,
                -4.5,
                0.3,
            ]);
            // Fans come and go, and so do parts.
            let fans = [Vec3::x(), Vec3::new(0.6, 0.8, 0.0)][..step % 3].to_vec();
            AirState { values, covariance: None, swirl_mps: 0.3, fans }
        };
        let states = (0..n_steps).map(state).collect();
        AirFlow { stream: Stream::round(&body), modes, swirl_share: 0.2, rate_hz: 10.0, states }
    }

    /// In all registers, and for any number of steps, it is the air that is told step by step.
    #[test]
    fn it_is_the_air_of_each_step() {
        let air = air(40);
        let places: Vec<Vec3> = (0..400)
            .map(|k| {
                Vec3::new(f64::from(k % 10), f64::from(k / 10 % 8), f64::from(k / 80)) * 0.06
                    - Vec3::repeat(0.25)
            })
            .filter(|p| !air.stream.is_solid(*p))
            .collect();
        let points: Vec<AirPoint> = places.iter().map(|p| air.point(*p)).collect();
        let read = |registers, steps: Range<usize>| {
            let mut all = vec![Vec::new(); points.len()];
            air.during_in(registers, steps).read(&points, |k, from, rows| {
                assert_eq!(all[k].len(), from);
                all[k].extend((0..rows[0].len()).map(|step| rows.map(|row| row[step])));
            });
            all
        };
        for steps in [0..16, 16..21, 39..40] {
            let widest = read(Registers::widest(), steps.clone());
            for (place, told) in places.iter().zip(&widest) {
                for (step, told) in steps.clone().zip(told) {
                    let expected = air.at(step, *place).velocity;
                    let off = Vec3::from(told.map(f64::from)) - expected;
                    assert!(off.norm() < 1e-5, "step {step} at {place}: {told:?}, not {expected}");
                }
            }
            for registers in Registers::here() {
                let n = steps.len();
                let same = read(registers, steps.clone());
                assert!(same.iter().zip(&widest).all(|(a, b)| a[..n] == b[..n]), "{registers:?}");
            }
        }
    }
}

use crate::{Stream, StreamAt, StreamNow, SwirlModes};
use core::ops::Range;
use nalgebra::{DMatrix, DVector, DVectorView, Matrix3};
use tousle_core::Vec3;

/// The air round a head over time: a stream and swirls, with how sure they are.
#[derive(Clone, Debug, PartialEq)]
pub struct AirFlow {
    /// How the wind far away becomes that near the head.
    pub stream: Stream,
    /// The shapes of everything else.
    pub modes: SwirlModes,
    /// How strong swirls are over the stream's speed.
    pub swirl_share: f64,
    /// Time steps a second.
    pub rate_hz: f64,
    /// One state a time step.
    pub states: Vec<AirState>,
}

/// The air at one time step.
#[derive(Clone, Debug, PartialEq)]
pub struct AirState {
    /// The coefficients of the swirl modes, then the wind far away (head axes, m/s), the wake's strength, the logarithm
    /// of the layer's displacement thickness in m, and the share of the stream that slips past the scalp.
    pub values: DVector<f64>,
    /// Their covariance; `None` where nobody asked for it, which counts as if they were known.
    pub covariance: Option<DMatrix<f64>>,
    /// How strong swirls are, m/s: what a coefficient of 1 stands for.
    pub swirl_mps: f64,
    /// Where each fan blows, head axes, unit length; zero for one that is off.
    pub fans: Vec<Vec3>,
}

/// How many numbers of a state are no swirl.
pub const N_STREAM: usize = 6;

/// How far the logarithm of the layer's thickness may move at once.
const LOG_LAYER_STEP: f64 = 0.5;

/// How far the share that slips past the scalp may move at once.
const SLIP_STEP: f64 = 0.2;

impl AirState {
    /// Coefficients of swirls.
    pub fn n_modes(&self) -> usize {
        self.values.len() - N_STREAM
    }

    /// The wind far away, head axes, m/s.
    pub fn outside(&self) -> Vec3 {
        let n = self.n_modes();
        Vec3::new(self.values[n], self.values[n + 1], self.values[n + 2])
    }

    /// The wakes' strength.
    pub fn wake(&self) -> f64 {
        self.values[self.n_modes() + 3]
    }

    /// The displacement thickness of the layer at the scalp, m.
    pub fn layer_m(&self) -> f64 {
        libm::exp(self.values[self.n_modes() + 4])
    }

    /// The share of the stream that slips past the scalp.
    pub fn slip(&self) -> f64 {
        self.values[self.n_modes() + 5]
    }

    /// Takes other values, but those of wake, layer and slip only where they mean something: 0 to 1 of the stream, and 1 to 50 mm.
    ///
    /// Layer and slip go no farther at once than by a factor of 1.6 and by a fifth of the stream: values that were solved
    /// for as if the wind were linear in them are right nearby only, and farther off they would come back and go again.
    pub fn move_to(&mut self, values: DVector<f64>) {
        let n = self.n_modes();
        let was = core::mem::replace(&mut self.values, values);
        let mut keep = |at: usize, step: f64, [least, most]: [f64; 2]| {
            let value = &mut self.values[n + at];
            *value = value.clamp(was[n + at] - step, was[n + at] + step).clamp(least, most);
        };
        keep(3, f64::INFINITY, [0.0, 1.0]);
        keep(4, LOG_LAYER_STEP, [libm::log(1e-3), libm::log(5e-2)]);
        keep(5, SLIP_STEP, [0.0, 1.0]);
    }

    /// Lets a coefficient of 1 stand for another strength of swirls, m/s > 0; the swirls stay.
    pub fn rescale(&mut self, swirl_mps: f64) {
        let n = self.n_modes();
        let share = self.swirl_mps / swirl_mps;
        self.values.rows_mut(0, n).scale_mut(share);
        self.swirl_mps = swirl_mps;
    }

    /// What it is a `share` of the way to another, 0 to 1; its fans are the nearer one's.
    fn towards(&self, other: &Self, share: f64) -> Self {
        let swirl_mps = self.swirl_mps + (other.swirl_mps - self.swirl_mps) * share;
        let [from, to] = [self, other].map(|state| {
            let mut state = state.of_values(state.values.clone());
            state.rescale(swirl_mps);
            state
        });
        let values = from.values.lerp(&to.values, share);
        if share < 0.5 { from.of_values(values) } else { to.of_values(values) }
    }

    /// The same air with other values, or with its own; nothing is known of how sure they are.
    fn of_values(&self, values: DVector<f64>) -> Self {
        Self { values, covariance: None, fans: self.fans.clone(), ..*self }
    }
}

/// The wind at a point and how it changes with the state.
#[derive(Clone, Debug, PartialEq)]
pub struct WindAt {
    /// The velocity of the air, head axes, m/s.
    pub velocity: Vec3,
    /// Its change with each number of the state: x of all, then y, then z.
    pub change: Vec<f64>,
    /// Standard deviation of the swirls that no mode carries, m/s a component.
    pub left_out_mps: f64,
}

/// A point near the head: what the stream and the swirls are there, whatever blows.
#[derive(Clone, Debug, PartialEq)]
pub struct AirPlace {
    stream: StreamAt,
    /// As [`SwirlModes::at`] gives them; `None` where no mode reaches.
    shapes: Option<Vec<f64>>,
}

impl AirFlow {
    /// The same air without how sure it is, which is most of what it holds.
    #[must_use]
    pub fn without_covariances(&self) -> Self {
        let states = self.states.iter().map(|state| state.of_values(state.values.clone())).collect();
        Self { stream: self.stream, modes: self.modes.clone(), states, ..*self }
    }

    /// The same air at other steps of the same time: between two of its own in proportion, after the last as there. Nothing is known
    /// of how sure it is.
    #[must_use]
    pub fn at_rate(&self, rate_hz: f64, n_steps: usize) -> Self {
        let last = self.states.len() - 1;
        let state = |step: usize| {
            let place = step as f64 / rate_hz * self.rate_hz;
            let before = (place as usize).min(last);
            let [from, to] = [before, (before + 1).min(last)].map(|k| &self.states[k]);
            from.towards(to, (place - before as f64).min(1.0))
        };
        let states = (0..n_steps).map(state).collect();
        Self { stream: self.stream, modes: self.modes.clone(), rate_hz, states, ..*self }
    }

    /// The same air as far as other modes can carry it. Nothing is known of how sure it is.
    #[must_use]
    pub fn in_modes(&self, modes: SwirlModes) -> Self {
        let by = modes.from_others(&self.modes);
        let state = |state: &AirState| {
            let n_modes = state.n_modes();
            let swirls = &by * state.values.rows(0, n_modes);
            let others = state.values.rows(n_modes, N_STREAM);
            let n = modes.n_modes() + N_STREAM;
            state.of_values(DVector::from_iterator(n, swirls.iter().chain(others.iter()).copied()))
        };
        let states = self.states.iter().map(state).collect();
        Self { stream: self.stream, modes, states, ..*self }
    }

    /// The wind at a point of head space at a step.
    pub fn at(&self, step: usize, point_m: Vec3) -> WindAt {
        let (stream, now, shapes) = (self.stream.at(point_m), self.now(step), self.shapes(point_m));
        let mut change = vec![0.0; 3 * (self.modes.n_modes() + N_STREAM)];
        let (velocity, strength_mps) = self.wind_of(&stream, &shapes, step, &now, &mut change);
        WindAt { velocity, change, left_out_mps: strength_mps * left_out(&shapes) }
    }

    /// The stream at a step.
    pub fn now(&self, step: usize) -> StreamNow {
        let state = &self.states[step];
        self.stream.now(state.outside(), &state.fans, state.wake(), state.layer_m(), state.slip())
    }

    /// The velocity at a step and a point whose stream is known, as is that of the step. How it changes is written to `change`, as in
    /// [`WindAt`].
    ///
    /// # Panics
    /// If `change` is not three times as long as a state.
    pub fn wind_at(
        &self,
        stream: &StreamAt,
        step: usize,
        now: &StreamNow,
        point_m: Vec3,
        change: &mut [f64],
    ) -> Vec3 {
        self.wind_of(stream, &self.shapes(point_m), step, now, change).0
    }

    fn shapes(&self, point_m: Vec3) -> Vec<f64> {
        let mut shapes = vec![0.0; 3 * self.modes.n_modes()];
        self.modes.at(point_m, &mut shapes);
        shapes
    }

    /// The velocity where stream and shapes are known, and how strong swirls are there, m/s. How the velocity changes is written to
    /// `change`, as in [`WindAt`].
    fn wind_of(
        &self,
        stream: &StreamAt,
        shapes: &[f64],
        step: usize,
        now: &StreamNow,
        change: &mut [f64],
    ) -> (Vec3, f64) {
        let (state, n_modes) = (&self.states[step], self.modes.n_modes());
        let n = n_modes + N_STREAM;
        assert_eq!(change.len(), 3 * n, "a number for each of a state and each component");
        let wind = stream.wind(now);
        let mut velocity = wind.velocity;
        let strength_mps = state.swirl_mps * wind.swirls_left;
        let coefficients = state.values.rows(0, n_modes);
        for axis in 0..3 {
            let shapes = &shapes[axis * n_modes..(axis + 1) * n_modes];
            let row = &mut change[axis * n..(axis + 1) * n];
            row.iter_mut().zip(shapes).for_each(|(change, shape)| *change = strength_mps * shape);
            velocity[axis] += strength_mps * coefficients.dot(&DVectorView::from_slice(shapes, n_modes));
            for c in 0..3 {
                row[n_modes + c] = wind.by_outside[(axis, c)];
            }
            row[n_modes + 3] = wind.by_wake[axis];
            row[n_modes + 4] = wind.by_log_layer[axis];
            row[n_modes + 5] = wind.by_slip[axis];
        }
        (velocity, strength_mps)
    }

    /// The covariance of the wind, (m/s)², at each of many points of one step. All at once is several times as quick as
    /// one after the other.
    pub fn covariances(&self, step: usize, winds: &[WindAt]) -> Vec<Matrix3<f64>> {
        let n = self.modes.n_modes() + N_STREAM;
        let changes = winds.iter().flat_map(|wind| wind.change.iter().copied());
        // A column for each component of each point.
        let changes = DMatrix::from_iterator(n, 3 * winds.len(), changes);
        let spread = self.spread(step, &changes);
        let of_point = |(point, wind): (usize, &WindAt)| {
            let [changes, spread] = [&changes, &spread].map(|all| all.fixed_columns::<3>(3 * point));
            changes.tr_mul(&spread) + Matrix3::identity() * (wind.left_out_mps * wind.left_out_mps)
        };
        winds.iter().enumerate().map(of_point).collect()
    }

    /// The covariance of a step's state times some columns.
    fn spread(&self, step: usize, columns: &DMatrix<f64>) -> DMatrix<f64> {
        match &self.states[step].covariance {
            Some(covariance) => covariance * columns,
            None => DMatrix::zeros(columns.nrows(), columns.ncols()),
        }
    }

    /// A point, ready to be asked for the spread of any step.
    pub fn place(&self, point_m: Vec3) -> AirPlace {
        let shapes = self.modes.place(point_m).map(|_| self.shapes(point_m));
        AirPlace { stream: self.stream.at(point_m), shapes }
    }

    /// How sure the wind is at a step at many places: of each place one.
    pub fn spreads(&self, step: usize, places: &[AirPlace]) -> Vec<AirSpread> {
        let (now, n_modes) = (self.now(step), self.modes.n_modes());
        let n = n_modes + N_STREAM;
        let covariance = self.states[step].covariance.as_ref();
        let reached: Vec<_> =
            places.iter().filter_map(|place| Some((&place.stream, place.shapes.as_ref()?))).collect();
        let mut changes = DMatrix::zeros(n, 3 * reached.len());
        let of_places = reached.iter().zip(changes.as_mut_slice().chunks_exact_mut(3 * n));
        let unasked = |((stream, shapes), change): (&(&StreamAt, &Vec<f64>), &mut [f64])| {
            let strength_mps = self.wind_of(stream, shapes, step, &now, change).1;
            (strength_mps, 3.0 * (strength_mps * left_out(shapes)).powi(2))
        };
        let unasked: Vec<(f64, f64)> = of_places.map(unasked).collect();
        let told = covariance
            .map_or_else(|| vec![[0.0; 2]; changes.ncols()], |spread| forms(spread, &changes, n_modes));
        let mut of_reached = told.chunks_exact(3).zip(&unasked).map(|(told, (strength_mps, left_out))| {
            let [swirls, all] =
                [0, 1].map(|which| told.iter().map(|sums| sums[which]).sum::<f64>() + left_out);
            AirSpread::of(all, swirls, *strength_mps)
        });
        // Where no mode reaches the stream alone is unknown, and all swirls are.
        let of_stream = covariance.map(|spread| spread.fixed_view::<N_STREAM, N_STREAM>(n_modes, n_modes));
        let swirl_mps = self.states[step].swirl_mps;
        let of_place = |place: &AirPlace| {
            if place.shapes.is_some() {
                return of_reached.next().expect("one for each that is reached");
            }
            let wind = place.stream.wind(&now);
            let strength_mps = swirl_mps * wind.swirls_left;
            let told = of_stream.map_or(0.0, |spread| {
                let by = wind.change();
                (by * spread * by.transpose()).trace()
            });
            let swirls = 3.0 * strength_mps * strength_mps;
            AirSpread::of(told + swirls, swirls, strength_mps)
        };
        places.iter().map(of_place).collect()
    }
}

/// How sure the wind is somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirSpread {
    /// Its standard deviation, m/s a component.
    pub deviation_mps: f64,
    /// The variance of its swirls over that before any lock was asked; 1 where there are none.
    pub unknown_swirls: f64,
}

impl AirSpread {
    /// From variances of all three components together, and how strong swirls are there.
    fn of(variance: f64, of_swirls: f64, strength_mps: f64) -> Self {
        let before = 3.0 * strength_mps * strength_mps;
        Self {
            deviation_mps: f64::max(variance / 3.0, 0.0).sqrt(),
            unknown_swirls: if before > 0.0 { of_swirls / before } else { 1.0 },
        }
    }
}

/// The share of swirls that no mode carries at a point of such shapes.
fn left_out(shapes: &[f64]) -> f64 {
    let carried = DVectorView::from_slice(shapes, shapes.len()).norm_squared();
    f64::max(1.0 - carried / 3.0, 0.0).sqrt()
}

/// Rows of a symmetric matrix that are multiplied at once.
const BAND: usize = 32;

/// For each column c of many, cᵀ S c, of a symmetric S, of which half is read: as if c ended after `n_first` numbers, and of all.
fn forms(symmetric: &DMatrix<f64>, columns: &DMatrix<f64>, n_first: usize) -> Vec<[f64; 2]> {
    let n = symmetric.nrows();
    let mut sums = vec![[0.0; 2]; columns.ncols()];
    let mut add = |rows: Range<usize>, beside: Range<usize>, which: usize| {
        let own = columns.rows_range(rows.clone());
        let mut spread = symmetric.view_range(rows.clone(), rows.clone()) * own;
        // What is beside the diagonal counts twice.
        spread.gemm(2.0, &symmetric.view_range(rows, beside.clone()), &columns.rows_range(beside), 1.0);
        for ((sum, own), spread) in sums.iter_mut().zip(own.column_iter()).zip(spread.column_iter()) {
            sum[which] += own.dot(&spread);
        }
    };
    for first in (0..n_first).step_by(BAND) {
        let end = (first + BAND).min(n_first);
        add(first..end, end..n_first, 0);
    }
    add(n_first..n, n..n, 1);
    let others = symmetric.view_range(..n_first, n_first..) * columns.rows_range(n_first..);
    let of_first = columns.rows_range(..n_first);
    for ((sum, first), others) in sums.iter_mut().zip(of_first.column_iter()).zip(others.column_iter()) {
        sum[1] += sum[0] + 2.0 * first.dot(&others);
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SwirlKernel;
    use tousle_core::Body;

    fn air(modes: SwirlModes, states: Vec<AirState>) -> AirFlow {
        AirFlow { stream: Stream::round(&Body::none()), modes, swirl_share: 0.2, rate_hz: 10.0, states }
    }

    /// At other steps the air is what it was; in other modes about the same points it blows the same at these.
    #[test]
    fn it_is_the_same_air_at_other_steps_and_in_other_modes() {
        // On nodes of the lattice, where modes are exact, and far enough apart for each to be told of.
        let points: Vec<Vec3> = (0..8).map(|k| Vec3::new(0.12, 0.084 * f64::from(k), -0.1)).collect();
        let kernel = SwirlKernel { length_m: 0.06 * std::f64::consts::SQRT_2 };
        let modes = SwirlModes::near(&points, kernel, 40, 0.042);
        let n = modes.n_modes();
        let state = |k: f64| AirState {
            values: DVector::from_fn(n + N_STREAM, |i, _| k * 0.1 * (i % 4) as f64 - 0.2),
            covariance: None,
            swirl_mps: 0.3 + 0.1 * k,
            fans: Vec::new(),
        };
        let own = air(modes, (0..4).map(|k| state(f64::from(k))).collect());
        let mut shuffled = points.clone();
        shuffled.rotate_left(3);
        let other = own.in_modes(SwirlModes::near(&shuffled, kernel, 40, 0.042)).at_rate(20.0, 8);
        for point in &points {
            for step in 0..4 {
                let (was, is) = (own.at(step, *point).velocity, other.at(2 * step, *point).velocity);
                assert!((was - is).norm() < 1e-9, "{was} {is}");
            }
        }
        let outside: Vec<f64> = other.states.iter().map(|state| state.outside().x).collect();
        let own: Vec<f64> = own.states.iter().map(|state| state.outside().x).collect();
        assert!((outside[3] - 0.5 * (own[1] + own[2])).abs() < 1e-12 && outside[7] == own[3]);
    }

    /// Many points at once are as sure as each by itself, and that is what the state's covariance says.
    #[test]
    fn spreads_are_the_covariances() {
        let mut points: Vec<Vec3> = (0..8).map(|k| Vec3::new(0.12, 0.03 * f64::from(k), -0.1)).collect();
        let modes = SwirlModes::near(&points, SwirlKernel { length_m: 0.1 }, 12, 0.05);
        // No mode reaches it.
        points.insert(3, Vec3::repeat(0.4));
        let n = modes.n_modes() + N_STREAM;
        let mut values = DVector::from_fn(n, |i, _| 0.1 * i as f64);
        values[n - 2] = -4.0;
        let covariance = DMatrix::from_fn(n, n, |r, c| if r == c { 0.5 } else { 0.01 });
        let state =
            AirState { values, covariance: Some(covariance.clone()), swirl_mps: 0.4, fans: Vec::new() };
        let air = air(modes, vec![state]);
        let places: Vec<_> = points.iter().map(|p| air.place(*p)).collect();
        for (spread, point) in air.spreads(0, &places).iter().zip(&points) {
            let wind = air.at(0, *point);
            let rows = DMatrix::from_row_slice(3, n, &wind.change);
            let known = &rows * &covariance * rows.transpose();
            let deviation = |known: f64| (known / 3.0 + wind.left_out_mps * wind.left_out_mps).sqrt();
            let expected = deviation(known.trace());
            assert!((spread.deviation_mps - expected).abs() < 1e-12, "{spread:?} {expected}");
            let rows = rows.columns(0, n - N_STREAM);
            let of_swirls = rows * covariance.view((0, 0), (n - N_STREAM, n - N_STREAM)) * rows.transpose();
            let expected = (deviation(of_swirls.trace()) / 0.4).powi(2);
            assert!((spread.unknown_swirls - expected).abs() < 1e-12, "{spread:?} {expected}");
            let alone = air.covariances(0, &[wind])[0];
            assert!((0..9).all(|k| (alone[k] - known[k]).abs() < 1e-12 || k % 4 == 0), "{alone} {known}");
        }
    }
}

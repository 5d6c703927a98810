//! What one lock at one step says of the air.

use super::contact;
use super::lock::SeenLock;
use super::moments::{Balance, DragSlope, Imbalance};
use super::noise;
use super::triangle::Triangle;
use nalgebra::{DMatrix, DVector};
use tousle_core::{STANDARD_GRAVITY, Vec3};
use tousle_flow::{AirFlow, Stream, StreamAt, StreamNow};
use tousle_rod::Surface;

/// Freedom of the t distribution that a lock's moments at a step are taken from: small keeps outliers from mattering.
const ROBUST: f64 = 4.0;

/// How far a curve drawn between markers may be from the hair, m: within that and a width of a surface it may touch.
const CURVE_ERROR_M: f64 = 5e-3;

/// What stays the same of one lock at one step whatever the air does.
pub(crate) struct Station {
    /// Places along the lock at which the wind is asked for.
    points_m: Vec<Vec3>,
    streams: Vec<StreamAt>,
    /// Lower factor of the covariance of the lock's moments; `None` if there is none.
    lower: Option<Triangle>,
    /// Where the body may push.
    touches: Vec<contact::Touch>,
    /// Moments of a unit push at each, whitened.
    of_pushes: DMatrix<f64>,
}

impl Station {
    /// A lock at a step. Places that dip into the body are moved out to where the lock's skin clears it, as in the body
    /// no wind is.
    pub(crate) fn new(balance: &Balance<'_>, surfaces: &[Surface], stream: &Stream) -> Self {
        let Balance { seen, step, .. } = *balance;
        let at = &seen.steps[step];
        let (arcs_m, last) = (&seen.lock.arcs_m, seen.lock.n_sticks() - 1);
        let place = |place_m: &f64| {
            let stick = arcs_m.iter().take_while(|arc| **arc < *place_m).count().min(last);
            let before_m = arcs_m[stick] - seen.lock.lengths_m[stick];
            let drawn_m = at.points_m[stick] + at.directions[stick] * (place_m - before_m);
            lifted(drawn_m, surfaces, 0.5 * seen.lock.width_m)
        };
        let points_m: Vec<Vec3> = seen.wind_places_m.iter().map(place).collect();
        let streams = points_m.iter().map(|p| stream.at(*p)).collect();
        let lower = noise::covariance(balance).cholesky().map(|factor| Triangle::of(factor.l_dirty()));
        let touches = contact::Touch::all(seen, at, surfaces, seen.lock.width_m + CURVE_ERROR_M);
        let mut of_pushes = DMatrix::zeros(2 * seen.lock.n_sticks(), touches.len());
        for (mut column, touch) in of_pushes.column_iter_mut().zip(&touches) {
            column.copy_from(&touch.of_push(at));
        }
        if let Some(lower) = &lower {
            of_pushes = lower.solve(&of_pushes);
        }
        Self { points_m, streams, lower, touches, of_pushes }
    }
}

fn lifted(mut point_m: Vec3, surfaces: &[Surface], radius_m: f64) -> Vec3 {
    for surface in surfaces {
        if let Some(gap) = surface.gap_within(point_m, radius_m) {
            point_m += gap.normal * (radius_m - gap.distance_m);
        }
    }
    point_m
}

/// Independent statements of variance 1 about the air and the lock.
pub(crate) struct Evidence {
    /// What is left of the moments in the present state.
    pub(crate) moments: DVector<f64>,
    /// Its change with the wind at the lock's wind places.
    pub(crate) by_wind: DMatrix<f64>,
    /// Its change with the lock's constants.
    pub(crate) by_constants: DMatrix<f64>,
    /// How much it counts: 1, or less for an outlier.
    pub(crate) weight: f64,
    /// Points at which the body pushes.
    pub(crate) n_pushing: usize,
}

impl Station {
    /// What the lock says if the air is about as in `air`, whose stream at the lock's step is `now`; `None` if it can say nothing (a number is not finite).
    /// `friction` is the body's. How the wind at its places changes with the state of the air is written to `winds_by_state`,
    /// component by component, place by place.
    pub(crate) fn evidence(
        &self,
        balance: &Balance<'_>,
        air: &AirFlow,
        now: &StreamNow,
        slope: DragSlope,
        friction: f64,
        winds_by_state: &mut [f64],
    ) -> Option<Evidence> {
        let out = self.imbalance(balance, air, now, slope, winds_by_state);
        let lower = self.lower.as_ref()?;
        let (weight_n, n_winds) = (weight_n(balance.seen), out.by_wind.ncols());
        let mut white = lower.solve(&beside(&out.moments, &out.by_wind, &out.by_constants));
        let at = &balance.seen.steps[balance.step];
        let of_rubs = |pushing: &[usize]| {
            let columns: Vec<_> = pushing.iter().flat_map(|touch| self.touches[*touch].of_rubs(at)).collect();
            lower.solve(&DMatrix::from_columns(&columns))
        };
        let n_pushing = contact::less_body(&mut white, &self.of_pushes, of_rubs, weight_n, friction);
        let moments = white.column(0).into_owned();
        let square = moments.norm_squared();
        let weight = ((ROBUST + moments.len() as f64) / (ROBUST + square)).min(1.0);
        square.is_finite().then_some(Evidence {
            moments,
            by_wind: white.columns_range(1..=n_winds).into_owned(),
            by_constants: white.columns_range(n_winds + 1..).into_owned(),
            weight,
            n_pushing,
        })
    }

    /// What the balance leaves over in the air, whatever the body does: its moments, N·m, two a joint across its
    /// stick.
    pub(crate) fn left_over(
        &self,
        balance: &Balance<'_>,
        air: &AirFlow,
        now: &StreamNow,
    ) -> Option<DVector<f64>> {
        let mut unasked = vec![0.0; 3 * self.points_m.len() * air.states[balance.step].values.len()];
        let out = self.imbalance(balance, air, now, DragSlope::Tangent, &mut unasked);
        let lower = self.lower.as_ref()?;
        let white = lower.solve_column(&out.moments);
        Some(lower.times(&contact::less_pushes(&white, &self.of_pushes, weight_n(balance.seen))))
    }

    /// The imbalance in the air. The change of the wind at its places with that is written to `winds_by_state`.
    fn imbalance(
        &self,
        balance: &Balance<'_>,
        air: &AirFlow,
        now: &StreamNow,
        slope: DragSlope,
        winds_by_state: &mut [f64],
    ) -> Imbalance {
        let seen = balance.seen;
        let winds = self.winds(air, now, balance.step, winds_by_state);
        let at_middles: Vec<Vec3> = (0..seen.lock.n_sticks())
            .map(|stick| {
                let shares = seen.wind_share(seen.lock.arcs_m[stick] - 0.5 * seen.lock.lengths_m[stick]);
                shares.iter().map(|(place, share)| winds[*place] * *share).sum()
            })
            .collect();
        balance.imbalance(&at_middles, slope)
    }

    /// The wind at the places. Its change with the state is written to `by_state`, component by component, place by place.
    fn winds(&self, air: &AirFlow, now: &StreamNow, step: usize, by_state: &mut [f64]) -> Vec<Vec3> {
        let changes = by_state.chunks_exact_mut(3 * air.states[step].values.len());
        let wind = |((point_m, stream), change): ((&Vec3, &StreamAt), &mut [f64])| {
            air.wind_at(stream, step, now, *point_m, change)
        };
        self.points_m.iter().zip(&self.streams).zip(changes).map(wind).collect()
    }
}

/// A column, then those of a matrix, then those of another.
fn beside(first: &DVector<f64>, second: &DMatrix<f64>, third: &DMatrix<f64>) -> DMatrix<f64> {
    let numbers = [first.as_slice(), second.as_slice(), third.as_slice()].concat();
    DMatrix::from_vec(first.len(), 1 + second.ncols() + third.ncols(), numbers)
}

fn weight_n(seen: &SeenLock) -> f64 {
    seen.lock.masses_kg.iter().sum::<f64>() * STANDARD_GRAVITY
}

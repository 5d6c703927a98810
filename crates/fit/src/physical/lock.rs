//! One lock: what it is, and where it is at every time step.

use super::moments;
use super::smooth::Motion;
use super::spline::spline_weights;
use super::tracks::{Clock, MarkerMotion, fixed_motion, marker_motion};
use nalgebra::{DMatrix, UnitQuaternion};
use tousle_core::{Along, HeadCapture, Pose, Sample, Session, Strand, StrandSpec, Vec3, median_high};
use tousle_rod::{Lock, shortest_rotation, shortest_turn};

/// A lock seen over time.
pub(crate) struct SeenLock {
    pub(crate) strand_idx: usize,
    /// What it is as taken for likely, the markers' masses included; a control point at every marker.
    pub(crate) strand: Strand,
    /// The control point of each marker that was used, in the session's order.
    pub(crate) marker_points: Vec<Option<usize>>,
    /// Its mechanics, at rest.
    pub(crate) lock: Lock,
    /// Places along the lock, m, at which its wind is asked for: hats between them.
    pub(crate) wind_places_m: Vec<f64>,
    pub(crate) steps: Vec<LockAt>,
}

/// A lock at a time step, head space, less what the wind does.
pub(crate) struct LockAt {
    /// The root, then the far end of every stick, m.
    pub(crate) points_m: Vec<Vec3>,
    /// Direction of each stick.
    pub(crate) directions: Vec<Vec3>,
    /// Two unit vectors across each stick, which turn with it.
    pub(crate) across: Vec<[Vec3; 2]>,
    /// Velocity over the ground of each stick's middle, head axes, m/s.
    pub(crate) velocities: Vec<Vec3>,
    /// Gravity less acceleration over the ground at the far end of every stick, head axes, m/s².
    pub(crate) pulls: Vec<Vec3>,
    /// Expected error of each far end's place, m.
    pub(crate) errors_m: Vec<f64>,
    /// The turn of each joint since rest, head axes, rad: by which its stick is bent against the one before.
    pub(crate) bends: Vec<Vec3>,
    /// Rotation of the stick before each joint since rest, for what the joint held at rest.
    pub(crate) turned: Vec<UnitQuaternion<f64>>,
}

/// Length of a stick, m, about: a third of the distance of markers, so that what lies between them is drawn out.
const STICK_M: f64 = 0.018;

/// The shortest stick that is worth its joint, m: between markers, and of what hangs beyond the last.
const LEAST_STICK_M: f64 = 3e-3;

/// Distance of the places at which the wind is asked for, m: some swirls are as small as 10 cm across.
const WIND_PLACE_M: f64 = 0.045;

/// What a lock may seem to be longer or shorter by, m: curves drawn between markers cut corners.
const STRETCH_M: f64 = 3e-3;

/// The largest error that is believed, m: a lock is no longer lost than that.
const LARGEST_ERROR_M: f64 = 0.1;

/// Stiffness of one hair over its mass per length, N·m² per kg/m: E d²/16ρ for 70 µm of keratin (3.8e9 Pa, 1320 kg/m³).
const STIFFNESS_PER_DENSITY: f64 = 3.8e9 * 70e-6 * 70e-6 / (16.0 * 1320.0);

/// Internal damping over stiffness, s: a loss tangent of 0.1 at one swing a second.
const DAMPING_SECS: f64 = 0.016;

/// What makes a lock from its markers.
pub(crate) struct Seeing<'a> {
    pub(crate) head: &'a HeadCapture,
    pub(crate) origins: Option<&'a [Vec<Vec<Sample>>]>,
    pub(crate) session: &'a Session,
    pub(crate) clock: &'a Clock,
    pub(crate) still: Option<(usize, usize)>,
    pub(crate) gravity_world: Vec3,
    pub(crate) cutoff_hz: f64,
}

/// The median of positions, axis by axis: where hair hung, even if wind blew in some of the frames.
fn middle(positions_m: &[Vec3]) -> Option<Vec3> {
    let along = |axis: usize| median_high(positions_m.iter().map(|p| p[axis]).collect());
    Some(Vec3::new(along(0)?, along(1)?, along(2)?))
}

impl SeenLock {
    /// `None` if fewer than two markers are of use: seen, at rest too if it is known when hair hung still, and apart.
    pub(crate) fn new(strand_idx: usize, seeing: &Seeing<'_>) -> Option<Self> {
        let spec = &seeing.session.strands[strand_idx];
        let strand = seeing.head.strands.iter().find(|s| s.strand_idx == strand_idx)?;
        let mut knots_m: Vec<f64> = Vec::new();
        let mut markers: Vec<MarkerMotion> = Vec::new();
        let mut rests: Vec<Vec3> = Vec::new();
        let mut used: Vec<usize> = Vec::new();
        for (marker_idx, track) in strand.markers.iter().enumerate() {
            let place_m = spec.marker_distance_m(marker_idx);
            let samples = seeing.origins.map(|o| &o[strand_idx][marker_idx][..]);
            let is_apart = place_m > knots_m.last().copied().unwrap_or(0.0) + LEAST_STICK_M;
            let motion = marker_motion(track, samples, seeing.clock, seeing.cutoff_hz);
            let range = seeing.still.unwrap_or((0, track.n_frames() - 1));
            let seen: Vec<Vec3> = (range.0..=range.1).filter_map(|f| track.at(f)).collect();
            if let (true, Some(motion), Some(rest)) = (is_apart, motion, middle(&seen)) {
                knots_m.push(place_m);
                used.push(marker_idx);
                markers.push(motion);
                rests.push(rest);
            }
        }
        if knots_m.len() < 2 {
            return None;
        }
        let length_m = spec.length_m.max(*knots_m.last()?);
        let (places_m, knot_points) = control_points(&knots_m, length_m);
        let n_sticks = places_m.len();
        let weights = spline_weights(&knots_m, &places_m);
        let leaves = leaving_direction(spec.root_m, &knots_m, &rests);
        let rest_of = |column: usize| match column {
            0 => spec.root_m,
            1 => leaves,
            marker => rests[marker - 2],
        };
        let rest_curve_m: Vec<Vec3> = core::iter::once(spec.root_m)
            .chain((0..n_sticks).map(|row| blend(&weights, row, rest_of)))
            .collect();
        let strand = likely_strand(spec, rest_curve_m, length_m, &places_m);
        let lock = Lock::new(&strand);
        let (clock, cutoff_hz) = (seeing.clock, seeing.cutoff_hz);
        let curve = Curve {
            weights,
            root: fixed_motion(|pose| (pose * nalgebra::Point3::from(spec.root_m)).coords, clock, cutoff_hz),
            leaves: fixed_motion(|pose| pose.rotation * leaves, clock, cutoff_hz),
            markers,
        };
        let steps = (0..clock.n_steps)
            .map(|step| LockAt::new(&lock, &curve, step, clock.pose(step), seeing.gravity_world))
            .collect();
        let n_winds = ((length_m / WIND_PLACE_M).round() as usize).max(2);
        let wind_places_m = (0..n_winds).map(|k| length_m * (k as f64 + 0.5) / n_winds as f64).collect();
        let mut marker_points = vec![None; spec.markers.len()];
        for (marker_idx, point) in used.into_iter().zip(knot_points) {
            marker_points[marker_idx] = Some(point);
        }
        Some(Self { strand_idx, strand, marker_points, lock, wind_places_m, steps })
    }

    /// The share that each wind place has in the wind at a place along the lock: linear in between, even beyond.
    pub(crate) fn wind_share(&self, place_m: f64) -> [(usize, f64); 2] {
        let places = &self.wind_places_m;
        let after = places.iter().take_while(|p| **p < place_m).count().clamp(1, places.len() - 1);
        let (a, b) = (places[after - 1], places[after]);
        let share = ((place_m - a) / (b - a)).clamp(0.0, 1.0);
        [(after - 1, 1.0 - share), (after, share)]
    }
}

/// A lock's curve over time, world space.
struct Curve {
    /// As [`spline_weights`] gives them.
    weights: DMatrix<f64>,
    root: Vec<Motion>,
    leaves: Vec<Motion>,
    markers: Vec<MarkerMotion>,
}

impl Curve {
    /// The motion of the place of a row at a step.
    fn motion(&self, row: usize, step: usize) -> Motion {
        let of = |column: usize| match column {
            0 => &self.root[step],
            1 => &self.leaves[step],
            marker => &self.markers[marker - 2].motions[step],
        };
        Motion {
            position: blend(&self.weights, row, |column| of(column).position),
            velocity: blend(&self.weights, row, |column| of(column).velocity),
            acceleration: blend(&self.weights, row, |column| of(column).acceleration),
        }
    }

    /// Expected error of the place of a row at a step, m: the markers' own, each by its weight.
    fn error_m(&self, row: usize, step: usize) -> f64 {
        let part = |(marker, motion): (usize, &MarkerMotion)| {
            self.weights[(row, marker + 2)] * motion.errors_m[step].min(LARGEST_ERROR_M)
        };
        self.markers.iter().enumerate().map(part).map(|part| part * part).sum::<f64>().sqrt()
    }
}

/// The weighted sum of what a row hangs on.
fn blend(weights: &DMatrix<f64>, row: usize, of: impl Fn(usize) -> Vec3) -> Vec3 {
    (0..weights.ncols()).map(|column| of(column) * weights[(row, column)]).sum()
}

impl LockAt {
    fn new(lock: &Lock, curve: &Curve, step: usize, world: &Pose, gravity_world: Vec3) -> Self {
        let n = lock.n_sticks();
        let to_head = world.rotation.inverse();
        let motions: Vec<Motion> =
            core::iter::once(curve.root[step]).chain((0..n).map(|row| curve.motion(row, step))).collect();
        let points_m: Vec<Vec3> =
            motions.iter().map(|m| world.inverse_transform_point(&m.position.into()).coords).collect();
        let directions: Vec<Vec3> =
            points_m.windows(2).map(|p| (p[1] - p[0]).try_normalize(1e-9).unwrap_or_else(Vec3::z)).collect();
        let Turns { bends, turned, across } = Turns::since_rest(lock, &directions);
        let stretches_m = stretches_m(lock, &points_m);
        Self {
            velocities: motions.windows(2).map(|m| to_head * (m[0].velocity + m[1].velocity) * 0.5).collect(),
            pulls: motions[1..].iter().map(|m| to_head * (gravity_world - m.acceleration)).collect(),
            errors_m: (0..n).map(|row| libm::hypot(curve.error_m(row, step), stretches_m[row])).collect(),
            points_m,
            directions,
            across,
            bends,
            turned,
        }
    }
}

/// How far each stick's end must be from where it was seen, m, since the lock up to there is longer or shorter than it can be:
/// a marker was taken for another, or filled wrongly.
fn stretches_m(lock: &Lock, points_m: &[Vec3]) -> Vec<f64> {
    let lengths_m = points_m.windows(2).map(|p| (p[1] - p[0]).norm());
    let arcs_m = lengths_m.scan(0.0, |arc, length| {
        *arc += length;
        Some(*arc)
    });
    arcs_m.zip(&lock.arcs_m).map(|(seen, own)| f64::max((seen - own).abs() - STRETCH_M, 0.0)).collect()
}

/// How a lock has turned since rest when no stick turns about itself, as in [`LockAt`].
struct Turns {
    bends: Vec<Vec3>,
    turned: Vec<UnitQuaternion<f64>>,
    across: Vec<[Vec3; 2]>,
}

impl Turns {
    fn since_rest(lock: &Lock, directions: &[Vec3]) -> Self {
        let n = directions.len();
        let (mut bends, mut before) = (Vec::with_capacity(n), Vec::with_capacity(n));
        let mut across = Vec::with_capacity(n);
        let mut turned = UnitQuaternion::identity();
        for (direction, rest) in directions.iter().zip(&lock.rest_directions) {
            let carried = turned * rest;
            bends.push(shortest_turn(carried, *direction));
            before.push(turned);
            turned = shortest_rotation(carried, *direction) * turned;
            across.push(moments::across(*rest).map(|axis| turned * axis));
        }
        Self { bends, turned: before, across }
    }
}

/// The direction in which a lock leaves its root: that of the smoothest curve through its markers at rest.
fn leaving_direction(root_m: Vec3, knots_m: &[f64], rests: &[Vec3]) -> Vec3 {
    // Of all directions, the smoothest curve's leaves it unbent at the root: the weights of a natural spline's slope follow
    // from those of the clamped one by asking for no bend there.
    let h = knots_m[0] * 1e-3;
    let weights = spline_weights(knots_m, &[h]);
    let place = |leaves: Vec3| {
        let markers: Vec3 = rests.iter().enumerate().map(|(m, p)| p * weights[(0, m + 2)]).sum();
        root_m * weights[(0, 0)] + leaves * weights[(0, 1)] + markers
    };
    // Twice the bend at the root, and how it changes with the direction: place(h) = root + h·leaves + h²/2·bend.
    let bend = |leaves: Vec3| (place(leaves) - root_m - leaves * h) * (2.0 / (h * h));
    let at_zero = bend(Vec3::zeros());
    let change = bend(Vec3::x()).x - at_zero.x;
    (-at_zero / change).try_normalize(1e-9).unwrap_or_else(Vec3::z)
}

/// Distances of a lock's control points but the root from the root, m: some [`STICK_M`] apart, one at every knot; and which
/// of all control points, the root included, the knots are.
fn control_points(knots_m: &[f64], length_m: f64) -> (Vec<f64>, Vec<usize>) {
    let (mut places_m, mut knot_points) = (Vec::new(), Vec::new());
    let mut before_m = 0.0;
    let last_m = knots_m.last().copied().unwrap_or(0.0);
    let tip = (length_m > last_m + LEAST_STICK_M).then_some(length_m);
    for end_m in knots_m.iter().copied().chain(tip) {
        let n = ((end_m - before_m) / STICK_M).round().max(1.0);
        places_m.extend((1..=n as usize).map(|k| before_m + (end_m - before_m) * k as f64 / n));
        knot_points.push(places_m.len());
        before_m = end_m;
    }
    knot_points.truncate(knots_m.len());
    (places_m, knot_points)
}

/// A lock as its session has it, of hairs of usual stiffness, hanging as it did at rest, with the weight of its markers.
fn likely_strand(spec: &StrandSpec, rest_curve_m: Vec<Vec3>, length_m: f64, places_m: &[f64]) -> Strand {
    let own = spec.linear_density_kg_per_m;
    // A point's density is that of the half sticks about it.
    let n = places_m.len();
    let place = |point: usize| if point == 0 { 0.0 } else { places_m[point - 1] };
    let mut linear_density = vec![1.0; n + 1];
    for (marker_idx, marker) in spec.markers.iter().enumerate() {
        let place_m = spec.marker_distance_m(marker_idx);
        let nearest =
            (1..=n).min_by(|a, b| f64::total_cmp(&(place(*a) - place_m).abs(), &(place(*b) - place_m).abs()));
        let Some(point) = nearest else { continue };
        let about_m = 0.5 * (place((point + 1).min(n)) - place(point - 1));
        linear_density[point] += marker.mass_kg / (own * about_m);
    }
    Strand {
        name: spec.name.clone(),
        rest_curve_m,
        length_m,
        linear_density_kg_per_m: own,
        lock_width_m: spec.lock_width_m,
        bending_stiffness_n_m2: own * STIFFNESS_PER_DENSITY,
        internal_damping_secs: DAMPING_SECS,
        along: Along { linear_density, ..Along::default() },
        holds_style: false,
    }
}

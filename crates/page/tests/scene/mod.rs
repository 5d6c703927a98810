//! A made-up session for tests and the example: a head in a gust, hair that sways by a formula.
//!
//! Nothing here is physics. It has what a real page has: gaps, a head that turns, all three kinds of voxels,
//! names that would be markup if nobody escaped them.

use nalgebra::UnitQuaternion;
use std::f64::consts::TAU;
use tousle_core::{
    Assumption, Attachment, Body, Collider, Fan, Groom, HeadCapture, HeadMarker, HeadPose, Pose, PoseTrack,
    Quantity, Session, Shape, Strand, StrandMarker, StrandMotion, StrandSpec, StrandTracks, Vec3,
};
use tousle_field::{Field, FieldSequence, GridSpec, Scene, VoxelFlag};

/// How long everything lasts, s.
pub const SECS: f64 = 4.0;

/// A name that must come out as text.
pub const NASTY: &str = "</script><img src=x onerror=alert(1)>\"'&";

/// Everything that a page is made from.
pub struct MadeUp {
    pub session: Session,
    pub capture: HeadCapture,
    pub field: FieldSequence,
    pub scene: Scene,
    pub groom: Groom,
    pub motion: StrandMotion,
    pub calm: StrandMotion,
}

/// Half axes of the head, m.
const HEAD: [f64; 3] = [0.095, 0.075, 0.1];

pub fn made_up(n_locks: usize, n_voxels: usize) -> MadeUp {
    let groom = Groom { strands: (0..n_locks).map(|k| strand(k, n_locks)).collect(), assumed: assumed() };
    let session = session(9);
    let capture = capture(&session);
    let field = field(&capture, n_voxels);
    let motion = motion(&groom, 1.0);
    let calm = self::motion(&groom, 0.4);
    MadeUp { scene: scene(&session), session, capture, field, groom, motion, calm }
}

/// A point of the unit sphere's upper part, spread evenly (a golden spiral), face left free.
fn scalp(k: usize, n: usize) -> Vec3 {
    let golden = TAU * 0.381_966;
    let up = 1.0 - 1.25 * (k as f64 + 0.5) / n as f64;
    let out = (1.0 - up * up).max(0.0).sqrt();
    let (sin, cos) = libm::sincos(golden * k as f64);
    let (x, y) = (out * cos, out * sin);
    if x > 0.75 && up < 0.5 { Vec3::new(-x, y, up) } else { Vec3::new(x, y, up) }
}

fn strand(k: usize, n: usize) -> Strand {
    const POINTS: usize = 14;
    let outward = scalp(k, n);
    let root = outward.component_mul(&Vec3::from(HEAD)) * 1.02;
    let length = 0.18 + 0.2 * (0.5 - 0.5 * outward.x) + 0.02 * libm::sin(k as f64);
    let mut curve = vec![root];
    let mut direction = (outward + Vec3::new(-0.4, 0.0, 0.0)).normalize();
    for _ in 1..POINTS {
        direction = (direction * 0.72 + Vec3::new(0.0, 0.0, -0.28)).normalize();
        let next = curve[curve.len() - 1] + direction * (length / (POINTS - 1) as f64);
        curve.push(outside_head(next));
    }
    Strand {
        name: format!("M{k:02}"),
        rest_curve_m: curve,
        length_m: length,
        linear_density_kg_per_m: 1.5e-3,
        lock_width_m: 0.005,
        bending_stiffness_n_m2: 1e-6,
        internal_damping_secs: 0.02,
        along: tousle_core::Along::default(),
        holds_style: false,
    }
}

fn outside_head(p: Vec3) -> Vec3 {
    let half = Vec3::from(HEAD) * 1.04;
    let depth = p.component_div(&half).norm();
    if depth < 1.0 { p / depth } else { p }
}

/// How strong the gust is, 0 to about 1: still for the first second.
fn gust(time_secs: f64) -> f64 {
    let rise = (time_secs - 1.0).clamp(0.0, 1.0);
    rise * (0.65 + 0.35 * libm::sin(TAU * 0.7 * time_secs))
}

const WIND: [f64; 3] = [-0.6, -0.8, 0.0];

fn motion(groom: &Groom, strength: f64) -> StrandMotion {
    let times_secs: Vec<f64> = (0..=(SECS * 60.0) as usize).map(|k| k as f64 / 60.0).collect();
    let mut positions_m = Vec::new();
    for &t in &times_secs {
        for (k, strand) in groom.strands.iter().enumerate() {
            positions_m
                .extend(swayed(&strand.rest_curve_m, t, k as f64, strength).map(|p| p.map(|c| c as f32)));
        }
    }
    StrandMotion { counts: groom.counts(), times_secs, positions_m }
}

/// A rest curve pushed over by the wind, later and more towards the tip.
fn swayed(rest: &[Vec3], t: f64, phase: f64, strength: f64) -> impl Iterator<Item = [f64; 3]> + '_ {
    let last = (rest.len() - 1) as f64;
    rest.iter().enumerate().map(move |(i, &p)| {
        let s = i as f64 / last;
        let late = t - 0.18 * s;
        let push = gust(late) * s * s * 0.24 * strength;
        let flutter = gust(late) * s * 0.012 * libm::sin(TAU * (2.3 * late - 1.2 * s) + phase);
        let lift = push * push * 1.4;
        outside_head(p + Vec3::from(WIND) * push + Vec3::new(-0.4, 0.3, 1.0) * flutter + Vec3::z() * lift)
            .into()
    })
}

fn session(n_locks: usize) -> Session {
    let strands = (0..n_locks).map(|k| {
        let strand = strand(k, n_locks);
        let marker = |m: usize| StrandMarker {
            label: format!("S{k:02}_{m}"),
            distance_from_root_m: Some(strand.length_m * m as f64 / 5.0),
            mass_kg: 2e-5,
        };
        StrandSpec {
            name: if k == 3 { NASTY.to_owned() } else { format!("S{k:02}") },
            length_m: strand.length_m,
            linear_density_kg_per_m: strand.linear_density_kg_per_m,
            lock_width_m: strand.lock_width_m,
            root_m: strand.rest_curve_m[0],
            markers: (1..=5).map(marker).collect(),
        }
    });
    let head_marker =
        |label: &str, at: [f64; 3]| HeadMarker { label: label.into(), position_m: Vec3::from(at) };
    Session {
        rate_hz: Some(120.0),
        still_frames: Some((1, 120)),
        wind_start_frame: Some(121),
        head_markers: vec![
            head_marker("NOSE", [0.113, 0.001, -0.018]),
            head_marker("LFHD", [0.084, 0.029, 0.043]),
            head_marker("RFHD", [0.083, -0.03, 0.042]),
        ],
        body: body(),
        fans: vec![fan(53.0, None, "gusting <about> 0.7 Hz"), fan(-20.0, Some(80.0), "weak, carried round")],
        assumed: assumed(),
        strands: strands.collect(),
        ..Session::unknown(NASTY)
    }
}

fn assumed() -> Vec<Assumption> {
    vec![Assumption { what: "<b>".into(), value: "1 & 2".into(), why: "nobody \"said\"".into() }]
}

fn fan(from_deg: f64, to_deg: Option<f64>, program: &str) -> Fan {
    Fan {
        from_azimuth_rad: from_deg.to_radians(),
        to_azimuth_rad: to_deg.map(f64::to_radians),
        from_elevation_rad: 0.0,
        speed_mps: 2.6,
        blows_towards_world: None,
        program: program.into(),
    }
}

fn body() -> Body {
    let collider = |name: &str, shape, attachment| Collider { name: name.into(), shape, attachment };
    let capsule =
        |a: [f64; 3], b: [f64; 3], radius_m| Shape::Capsule { a_m: a.into(), b_m: b.into(), radius_m };
    let head = Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: HEAD.into() };
    let neck = capsule([-0.015, 0.0, -0.07], [-0.02, 0.0, -0.19], 0.055);
    let shoulders = capsule([-0.02, -0.15, -0.27], [-0.02, 0.15, -0.27], 0.07);
    Body {
        colliders: vec![
            collider("head", head, Attachment::Head),
            collider("neck", neck, Attachment::Torso),
            collider("shoulders", shoulders, Attachment::Torso),
        ],
        pivot_m: Vec3::new(-0.02, 0.0, -0.11),
        friction: 0.25,
    }
}

/// The head looks to and fro a little.
fn pose(time_secs: f64) -> Pose {
    let yaw = 0.25 * libm::sin(TAU * time_secs / SECS);
    Pose::from_parts(Vec3::new(0.1, -0.2, 1.5).into(), UnitQuaternion::from_euler_angles(0.02, -0.04, yaw))
}

fn scene(session: &Session) -> Scene {
    let poses = (0..=(SECS * 120.0) as usize).map(|k| pose(k as f64 / 120.0)).collect();
    Scene {
        poses: PoseTrack { start_secs: 0.0, rate_hz: 120.0, poses },
        rest_pose: pose(0.0),
        gravity_world: Vec3::new(0.0, 0.0, -9.81),
        air_density: 1.2,
        body: session.body.clone(),
    }
}

/// Markers of the session's locks, with gaps that come and go and one pose lost.
fn capture(session: &Session) -> HeadCapture {
    let n_frames = (SECS * 120.0) as usize;
    let tracks = session.strands.iter().enumerate().map(|(k, _)| {
        let rest = strand(k, session.strands.len()).rest_curve_m;
        let marker = |m: usize| {
            (0..n_frames)
                .map(|f| {
                    let hidden = (f / 24 + 7 * k + 3 * m).is_multiple_of(11);
                    let at = swayed(&rest, f as f64 / 120.0, k as f64, 1.0).nth(m * (rest.len() - 1) / 5);
                    at.filter(|_| !hidden).map(Vec3::from)
                })
                .collect()
        };
        StrandTracks { strand_idx: k, markers: (1..=5).map(marker).collect() }
    });
    let pose_at = |f: usize| HeadPose {
        fit_residual_m: 2e-4 + 1e-4 * libm::sin(f as f64 * 0.3).abs(),
        ..HeadPose::exact(pose(f as f64 / 120.0), 3)
    };
    HeadCapture {
        rate_hz: 120.0,
        first_frame: 1,
        poses: (0..n_frames).map(|f| (f != 200).then(|| pose_at(f))).collect(),
        strands: tracks.collect(),
        unlabeled: Vec::new(),
    }
}

/// Wind that goes round the head, slower behind it; measured where the markers are.
fn field(capture: &HeadCapture, n_voxels: usize) -> FieldSequence {
    let grid = GridSpec::cube(0.6, 0.6 / n_voxels as f64).expect("whole voxels");
    let rate_hz = 30.0;
    let steps = (0..(SECS * rate_hz) as usize).map(|k| step(capture, &grid, k as f64 / rate_hz));
    FieldSequence {
        quantity: Quantity::AirVelocity,
        start_secs: 0.0,
        rate_hz,
        steps: steps.collect(),
        layers: Vec::new(),
        grid,
    }
}

fn step(capture: &HeadCapture, grid: &GridSpec, time_secs: f64) -> Field {
    let outside = Vec3::from(WIND) * (3.0 * gust(time_secs));
    let mut field = Field { outside, ..Field::still(grid) };
    let frame = (time_secs * 120.0) as usize;
    let seen: Vec<Vec3> =
        capture.strands.iter().flat_map(|s| &s.markers).filter_map(|m| m.at(frame)).collect();
    for flat in 0..grid.n_voxels() {
        let at = grid.cell_center_m(grid.unflat(flat));
        field.set_vector(flat, flow(at, outside));
        let nearest = seen.iter().map(|p| (p - at).norm()).fold(f64::INFINITY, f64::min);
        if nearest < 0.06 {
            field.flags[flat] = VoxelFlag::Interpolated;
        }
    }
    for voxel in seen.iter().filter_map(|&p| grid.voxel_at(p)) {
        field.flags[grid.flat(voxel)] = VoxelFlag::Measured;
    }
    field
}

/// Potential flow round a sphere of the head's size, and a wake.
fn flow(at: Vec3, outside: Vec3) -> Vec3 {
    let r = at.norm().max(0.09);
    let radial = at / at.norm().max(1e-6);
    let ratio = libm::pow(0.09 / r, 3.0);
    let around = outside - (radial * (1.5 * outside.dot(&radial)) - outside * 0.5) * ratio;
    let behind = radial.dot(&Vec3::from(WIND)).max(0.0);
    around * (1.0 - 0.7 * behind * behind * (1.0 - (r - 0.09) / 0.4).clamp(0.0, 1.0))
}

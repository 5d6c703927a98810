use crate::worlds::{
    DOWN, groom, lock_fan, mannequin, over_the_head, still_air, straight, strand, uniform, vacuum,
};
use nalgebra::UnitQuaternion;
use tousle_core::{Groom, Pose, PoseTrack, Quantity, Strand, Vec3};
use tousle_field::{FieldSequence, GridSpec, Scene};
use tousle_sim::{SimError, SimOptions, TimeMode};

/// A stiff or extreme case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// What is extreme about it.
    pub name: &'static str,
    /// What must hold beside what always must.
    pub(super) asks: Ask,
    world: fn(f64) -> World,
}

/// What a case asks beside finite numbers, constant length and no impossible speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ask {
    Nothing,
    /// In the last third no point jumps: its places in three frames are this near to a line, m.
    Calm(f64),
    /// In the last second no point is farther than this from where it ends, m.
    Settles(f64),
    /// No point is ever farther than this from where it started, m.
    Rests(f64),
    /// Energy of place and motion never exceeds what was there at the start, by this share of weight times length.
    GainsNoEnergy(f64),
}

/// All that a case runs in.
#[derive(Clone, Debug)]
pub struct World {
    /// The wind.
    pub field: FieldSequence,
    /// Head, body, gravity, air.
    pub scene: Scene,
    /// The hair.
    pub groom: Groom,
    /// How long it runs, s.
    pub duration_secs: f64,
    /// Frames of the result a second.
    pub rate_hz: f64,
    /// What the wind does after its last step.
    pub time: TimeMode,
}

/// An input that cannot be simulated.
#[derive(Clone, Debug)]
pub struct BadInput {
    /// What is wrong with it.
    pub what: &'static str,
    /// The world it is in.
    pub world: World,
    /// What it does to the options.
    pub options: fn(SimOptions) -> SimOptions,
    /// Whether an error is the right one.
    pub is_right: fn(&SimError) -> bool,
}

impl Case {
    /// The case's world when it is run with a step, s.
    pub fn world(&self, dt_secs: f64) -> World {
        (self.world)(dt_secs)
    }
}

/// The list.
pub fn cases() -> Vec<Case> {
    let case = |name, asks, world| Case { name, asks, world };
    vec![
        case("no bending stiffness, in 6 m/s", Ask::Nothing, |_| of_stiffness(0.0)),
        case("bending stiffness 1e-9 N·m², in 6 m/s", Ask::Nothing, |_| of_stiffness(1e-9)),
        case("bending stiffness 1e-6 N·m², in 6 m/s", Ask::Nothing, |_| of_stiffness(1e-6)),
        case("bending stiffness 1e-3 N·m², in 6 m/s", Ask::Calm(2e-3), |_| of_stiffness(1e-3)),
        case("bending stiffness 1 N·m², in 6 m/s", Ask::Calm(2e-3), |_| of_stiffness(1.0)),
        case("bending stiffness 1000 N·m², in 6 m/s", Ask::Calm(2e-3), |_| of_stiffness(1e3)),
        case("wind of 100 m/s from the first step", Ask::Nothing, |_| in_wind(&[FAST])),
        case("the same without gravity", Ask::Nothing, |_| {
            let world = in_wind(&[FAST]);
            World { scene: Scene { gravity_world: Vec3::zeros(), ..world.scene }, ..world }
        }),
        case("100 m/s that turns about 30 times a second", Ask::Nothing, |_| turning_about(30.0)),
        case("100 m/s that turns about at every step", Ask::Nothing, |dt_secs| {
            turning_about(f64::min(1.0 / dt_secs, 960.0))
        }),
        case("100 m/s that turns about from voxel to voxel", Ask::Nothing, |_| checkered()),
        case("a push of 1e5 m/s² that turns about 30 times a second", Ask::Nothing, |_| {
            let vectors: Vec<Vec3> = about(30).iter().map(|v| v * 1000.0).collect();
            World { field: uniform(Quantity::ForcePerMass, 30.0, &vectors), ..usual() }
        }),
        case("a storm of 100 m/s ends", Ask::Settles(1e-2), |_| World {
            field: uniform(Quantity::AirVelocity, 30.0, &[Vec3::x() * 100.0; 16]),
            duration_secs: 30.0,
            ..usual()
        }),
        case("a head that turns at 2000°/s", Ask::Nothing, |_| {
            let axis = Vec3::new(0.1, 0.2, 1.0).normalize();
            with_head(|secs| {
                Pose::from_parts(Vec3::zeros().into(), turn(axis * (2000_f64.to_radians() * secs)))
            })
        }),
        case("a head that jumps 1 m and turns by 170° at once", Ask::Nothing, |_| {
            with_head(|secs| {
                let after = f64::from(u8::from(secs >= 0.5));
                Pose::from_parts((Vec3::x() * after).into(), turn(Vec3::z() * (170_f64.to_radians() * after)))
            })
        }),
        case("a thousand sticks", Ask::Nothing, |_| {
            let lock = straight(Vec3::new(0.1, 0.0, 0.0), Vec3::new(1.0, 0.2, -0.3), 0.4, 1000);
            World { duration_secs: 0.125, ..of(vec![lock]) }
        }),
        case("sticks of 10 µm beside 10 cm", Ask::Nothing, |_| {
            let mut points = vec![Vec3::new(0.0, 0.08, 0.0)];
            for length_m in [1e-5, 0.1, 1e-5, 1e-5, 0.1, 1e-5] {
                let last = points[points.len() - 1];
                points.push(last + Vec3::new(0.2, 1.0, -0.5).normalize() * length_m);
            }
            of(vec![strand(points)])
        }),
        case("a lock a million times lighter beside another", Ask::Nothing, |_| {
            let lock = straight(Vec3::new(0.1, 0.0, 0.0), Vec3::new(1.0, 0.2, -0.3), 0.25, 12);
            of(vec![Strand { linear_density_kg_per_m: 1.5e-9, ..lock.clone() }, lock])
        }),
        case("a root inside the head", Ask::Nothing, |_| {
            of(vec![straight(Vec3::new(0.05, 0.0, 0.0), Vec3::x(), 0.2, 8)])
        }),
        case("hair folded back on itself", Ask::Nothing, |_| {
            let at = |x: f64, y: f64| Vec3::new(x, y, 0.0);
            of(vec![strand(vec![at(0.12, 0.0), at(0.2, 0.0), at(0.12, 1e-3), at(0.2, 2e-3)])])
        }),
        case("blown straight up, through 180° from rest", Ask::Nothing, |_| upright(Vec3::z() * 30.0)),
        case("blown straight down", Ask::Nothing, |_| upright(Vec3::z() * -30.0)),
        case("blown level, out of a plane by a hair", Ask::Nothing, |_| upright(Vec3::new(0.0, 1e-9, 20.0))),
        case("limp, let go 120° from rest in a vacuum", Ask::GainsNoEnergy(0.01), |_| swing(0.0)),
        case("soft, let go 120° from rest in a vacuum", Ask::GainsNoEnergy(0.01), |_| swing(1e-6)),
        case("stiff, let go 120° from rest in a vacuum", Ask::GainsNoEnergy(0.01), |_| swing(1e-2)),
        case("at rest on the head for 10 s, in a breath of air", Ask::Rests(1e-4), |_| {
            let hanging = straight(Vec3::new(0.05, 0.08, 0.03), Vec3::new(0.05, 0.05, -1.0), 0.25, 12);
            World {
                // So little that nothing moves, and enough that nothing may sleep.
                field: uniform(Quantity::AirVelocity, 30.0, &[Vec3::x() * 1e-7]),
                groom: groom(vec![over_the_head(), hanging]),
                duration_secs: 10.0,
                time: TimeMode::Hold,
                ..usual()
            }
        }),
    ]
}

/// Inputs that cannot be: NaN, infinite, missing, out of range.
pub fn bad_inputs() -> Vec<BadInput> {
    let keep: fn(SimOptions) -> SimOptions = |options| options;
    let mut list = Vec::new();
    let mut groom_is = |what, change: fn(&mut Groom)| {
        let mut world = usual();
        change(&mut world.groom);
        list.push(BadInput { what, world, options: keep, is_right: |e| matches!(e, SimError::Groom(_)) });
    };
    groom_is("a point that is NaN", |groom| groom.strands[0].rest_curve_m[2].y = f64::NAN);
    groom_is("an infinite stiffness", |groom| groom.strands[0].bending_stiffness_n_m2 = f64::INFINITY);
    groom_is("no strand", |groom| groom.strands.clear());
    let mut field_is = |what, change: fn(&mut FieldSequence)| {
        let mut world = usual();
        change(&mut world.field);
        list.push(BadInput { what, world, options: keep, is_right: |e| matches!(e, SimError::Field(_)) });
    };
    field_is("an infinite wind", |field| field.steps[0].u[3] = f32::INFINITY);
    field_is("no step", |field| field.steps.clear());
    let mut scene_is = |what, change: fn(&mut Scene)| {
        let mut world = usual();
        change(&mut world.scene);
        let is_right = |e: &SimError| matches!(e, SimError::BadScene { .. });
        list.push(BadInput { what, world, options: keep, is_right });
    };
    scene_is("a gravity that is NaN", |scene| scene.gravity_world.y = f64::NAN);
    scene_is("air lighter than nothing", |scene| scene.air_density = -1.0);
    scene_is("no pose", |scene| scene.poses.poses.clear());
    scene_is("poses at no rate", |scene| scene.poses.rate_hz = 0.0);
    let mut option_is = |what, options| {
        let is_right = |e: &SimError| matches!(e, SimError::BadOption { .. });
        list.push(BadInput { what, world: usual(), options, is_right });
    };
    option_is("no frames", |o| SimOptions { rate_hz: 0.0, ..o });
    option_is("a rate that is NaN", |o| SimOptions { rate_hz: f64::NAN, ..o });
    option_is("a step backwards", |o| SimOptions { dt_secs: Some(-0.1), ..o });
    option_is("a step of nothing", |o| SimOptions { dt_secs: Some(1e-30), ..o });
    option_is("for ever", |o| SimOptions { duration_secs: Some(f64::INFINITY), ..o });
    option_is("almost for ever", |o| SimOptions { duration_secs: Some(1e12), ..o });
    option_is("no start", |o| SimOptions { start_secs: Some(f64::NAN), ..o });
    option_is("no tolerance", |o| SimOptions { tolerance_m: 0.0, ..o });
    list
}

/// A wind of 100 m/s.
const FAST: Vec3 = Vec3::new(60.0, -80.0, 0.0);

/// Still air, a mannequin, three locks (over the head, leaning out, and one of a single stick) for a second.
fn usual() -> World {
    World {
        field: still_air(),
        scene: mannequin(),
        groom: groom(lock_fan()),
        duration_secs: 1.0,
        rate_hz: 24.0,
        time: TimeMode::Once,
    }
}

/// Three kinds of internal damping beside one another, in a steady wind.
fn of_stiffness(bending_stiffness_n_m2: f64) -> World {
    let damped = |internal_damping_secs| {
        let lock = move |lock| Strand { bending_stiffness_n_m2, internal_damping_secs, ..lock };
        lock_fan().into_iter().map(lock)
    };
    World { groom: groom([0.0, 0.02, 10.0].into_iter().flat_map(damped).collect()), ..in_wind(&[BREEZE]) }
}

const BREEZE: Vec3 = Vec3::new(-6.0, 2.0, 0.0);

fn in_wind(vectors: &[Vec3]) -> World {
    let field = uniform(Quantity::AirVelocity, 30.0, vectors);
    World { field, duration_secs: 2.0, time: TimeMode::Hold, ..usual() }
}

/// So many vectors as a second has at a rate, 100 m/s one way and the other in turn.
fn about(n: usize) -> Vec<Vec3> {
    (0..=n).map(|k| Vec3::new(if k % 2 == 0 { 100.0 } else { -100.0 }, 20.0, 0.0)).collect()
}

fn turning_about(rate_hz: f64) -> World {
    World { field: uniform(Quantity::AirVelocity, rate_hz, &about(rate_hz.ceil() as usize)), ..usual() }
}

/// Voxels of 2 cm with opposite winds: at 100 m/s a tip crosses all it can reach in one step.
fn checkered() -> World {
    let mut world = in_wind(&[FAST]);
    let grid = GridSpec::cube(0.6, 0.02).expect("a cube of 30 voxels a side");
    let mut step = tousle_field::Field::still(&grid);
    for voxel in 0..grid.n_voxels() {
        let [x, y, z] = grid.unflat(voxel).0;
        step.set_vector(voxel, if (x + y + z) % 2 == 0 { FAST } else { -FAST });
    }
    (world.field.grid, world.field.steps) = (grid, vec![step]);
    world
}

/// Still air and a head that goes as told.
fn with_head(pose_at: impl Fn(f64) -> Pose) -> World {
    let rate_hz = 120.0;
    let poses = (0..180).map(|k| pose_at(f64::from(k) / rate_hz)).collect();
    let scene = Scene { poses: PoseTrack { start_secs: 0.0, rate_hz, poses }, ..mannequin() };
    World { scene, duration_secs: 1.5, ..usual() }
}

/// Odd strands in a wind, each once more without internal damping.
fn of(strands: Vec<Strand>) -> World {
    let undamped = |lock: &Strand| Strand { internal_damping_secs: 0.0, ..lock.clone() };
    let bare: Vec<Strand> = strands.iter().map(undamped).collect();
    World {
        groom: groom([strands, bare].concat()),
        duration_secs: 0.5,
        ..in_wind(&[Vec3::new(-15.0, 8.0, 3.0)])
    }
}

fn upright(wind: Vec3) -> World {
    World {
        scene: Scene { air_density: 1.2, ..vacuum(DOWN) },
        groom: groom(vec![straight(Vec3::new(0.0, 0.0, 0.1), -Vec3::z(), 0.2, 10)]),
        ..in_wind(&[wind])
    }
}

/// A strand that hung straight down, in a head that has been turned since: nothing bends it at the start, so its energy is
/// that of its place.
fn swing(bending_stiffness_n_m2: f64) -> World {
    let lock = straight(Vec3::zeros(), -Vec3::z(), 0.2, 8);
    let pose = Pose::from_parts(Vec3::zeros().into(), turn(Vec3::y() * 120_f64.to_radians()));
    World {
        scene: Scene { poses: PoseTrack::still(pose), ..vacuum(DOWN) },
        groom: groom(vec![Strand { bending_stiffness_n_m2, internal_damping_secs: 0.0, ..lock }]),
        duration_secs: 2.0,
        ..usual()
    }
}

fn turn(scaled_axis: Vec3) -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(scaled_axis)
}

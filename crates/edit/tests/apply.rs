//! Edits on a small field, followed by a free particle instead of a lock.

use tousle_core::{Body, Groom, Pose, PoseTrack, Quantity, Strand, StrandMotion, Vec3};
use tousle_edit::{EditError, EditOptions, Edited, PaperSpan, Unreachable, apply, read_edits};
use tousle_field::{Field, FieldSequence, GridSpec, Scene};
use tousle_rod::DragLaw;

/// Two locks of four sticks of 50 mm that hang side by side, 200 mm apart.
fn groom() -> Groom {
    let strand = |name: &str, y: f64| Strand {
        name: name.into(),
        rest_curve_m: (0..5).map(|k| Vec3::new(0.0, y, -0.05 * f64::from(k))).collect(),
        length_m: 0.2,
        linear_density_kg_per_m: 0.002,
        lock_width_m: 0.005,
        bending_stiffness_n_m2: 1e-6,
        internal_damping_secs: 0.01,
        along: tousle_core::Along::default(),
        holds_style: false,
    };
    Groom { strands: vec![strand("A", 0.0), strand("B", 0.2)], assumed: Vec::new() }
}

/// Nothing moves for 3 s.
fn still_motion() -> StrandMotion {
    let rest: Vec<[f32; 3]> =
        groom().strands.iter().flat_map(|s| &s.rest_curve_m).map(|p| p.map(|c| c as f32).into()).collect();
    StrandMotion {
        counts: vec![5, 5],
        times_secs: (0..181).map(|k| f64::from(k) / 60.0).collect(),
        positions_m: rest.repeat(181),
    }
}

fn uniform(quantity: Quantity, vector: Vec3) -> FieldSequence {
    let grid = GridSpec::cube(0.6, 0.1).expect("six voxels of 100 mm");
    let mut step = Field { outside: vector, ..Field::still(&grid) };
    for voxel in 0..grid.n_voxels() {
        step.set_vector(voxel, vector);
    }
    FieldSequence { grid, quantity, start_secs: 0.0, rate_hz: 30.0, steps: vec![step], layers: Vec::new() }
}

fn scene() -> Scene {
    Scene {
        poses: PoseTrack::still(Pose::identity()),
        rest_pose: Pose::identity(),
        gravity_world: Vec3::new(0.0, 0.0, -9.81),
        air_density: 1.2,
        body: Body::none(),
    }
}

fn edit(field: FieldSequence, toml: &str) -> Result<Edited, EditError> {
    let edits = read_edits(toml.as_bytes())?;
    apply(field, &scene(), &groom(), &still_motion(), &edits, &between_keys())
}

/// E4 to the letter, which free particles can tell right from wrong.
fn between_keys() -> EditOptions {
    let mut options = EditOptions::default();
    options.span = PaperSpan::Keys;
    options
}

const DRAG_TIP: &str = "\
[[edit]]
name = \"to the front\"
strand = \"A\"
control_point = \"tip\"
first_secs = 1.0
second_secs = 1.5
target_m = [0.08, 0.0, -0.17]
ease = { rise = 0.5, fall = 0.5 }
";

/// E4 is made for a particle that nothing holds: there it must be exact, up to what lies between handles.
#[test]
fn a_free_particle_at_the_tip_gets_to_the_target() {
    for ease in ["{ rise = 0.0, fall = 0.0 }", "{ rise = 0.5, fall = 0.5 }", "{ rise = 0.3, fall = 0.2 }"] {
        let toml = DRAG_TIP.replace("{ rise = 0.5, fall = 0.5 }", ease);
        let field = edit(uniform(Quantity::ForcePerMass, Vec3::zeros()), &toml).unwrap().sequence;
        let (mut place, mut velocity) = (Vec3::new(0.0, 0.0, -0.2), Vec3::zeros());
        let (dt, first, n) = (1e-4, 1.0, 5000);
        for k in 0..n {
            velocity += field.at(first + (f64::from(k) + 0.5) * dt).sample(place) * dt;
            place += velocity * dt;
        }
        let missed_mm = (place - Vec3::new(0.08, 0.0, -0.17)).norm() * 1e3;
        assert!(missed_mm < 0.05 * 85.4, "{ease}: missed by {missed_mm} of 85.4 mm");
    }
}

/// 85.44 mm in 0.5 s: 2 · 0.08544 / 0.25 = 0.6835 m/s², twice that for a force that comes and goes by halves.
#[test]
fn the_report_says_what_was_asked_and_what_it_takes() {
    let edited = edit(uniform(Quantity::ForcePerMass, Vec3::x()), DRAG_TIP).unwrap();
    let outcome = &edited.report.edits[0];
    assert_eq!((outcome.layer_id.as_str(), outcome.control_point), ("to-the-front", 4));
    assert!((outcome.asked_mm - 85.44).abs() < 0.01, "{outcome:?}");
    assert!((outcome.acceleration - Vec3::new(1.28, 0.0, 0.48)).norm() < 1e-5, "{outcome:?}");
    assert_eq!(outcome.extra, outcome.acceleration);
    assert_eq!(outcome.unreachable, None);
    assert_eq!(edited.sequence.layers.len(), 1);
}

/// As a pendulum of 0.2 m, by default: 9.81 / 0.2 of (80, 0, 30) mm.
#[test]
fn by_default_a_lock_is_held_where_it_should_be() {
    let edits = read_edits(DRAG_TIP.as_bytes()).unwrap();
    let field = uniform(Quantity::ForcePerMass, Vec3::zeros());
    let options = EditOptions::default();
    let edited = apply(field, &scene(), &groom(), &still_motion(), &edits, &options).unwrap();
    let acceleration = edited.report.edits[0].acceleration;
    assert!((acceleration - Vec3::new(3.924, 0.0, 1.4715)).norm() < 1e-5, "{acceleration}");
}

#[test]
fn outside_the_keys_and_the_reach_the_field_is_the_same_to_the_bit() {
    let before = uniform(Quantity::ForcePerMass, Vec3::new(0.3, -0.1, 0.7));
    let after = edit(before.clone(), DRAG_TIP).unwrap().sequence;
    assert_eq!(after.steps, before.steps);
    let tip = Vec3::new(0.0, 0.0, -0.2);
    for time_secs in [0.0, 0.999, 1.0, 1.5, 1.501, 9.0] {
        assert_eq!(before.at(time_secs).sample(tip), after.at(time_secs).sample(tip), "{time_secs}");
    }
    assert_ne!(before.at(1.25).sample(tip), after.at(1.25).sample(tip));
    for point in &groom().strands[1].rest_curve_m {
        assert_eq!(before.at(1.25).sample(*point), after.at(1.25).sample(*point));
    }
}

/// The pull comes in small steps: from one millisecond to the next never more than 1 % of its peak.
#[test]
fn the_pull_never_jumps() {
    let field = edit(uniform(Quantity::ForcePerMass, Vec3::zeros()), DRAG_TIP).unwrap().sequence;
    let pull = |k: u32| field.at(0.9 + f64::from(k) * 1e-3).sample(Vec3::new(0.0, 0.0, -0.2)).norm();
    let peak = (0..700).map(pull).fold(0.0, f64::max);
    assert!(peak > 1.0);
    for k in 0..700 {
        assert!((pull(k + 1) - pull(k)).abs() < 0.01 * peak, "at {k} ms: {} to {}", pull(k), pull(k + 1));
    }
}

/// In 2 m/s of wind the extra wind at the tip must raise the drag there by the acceleration across the lock.
#[test]
fn in_a_field_of_air_velocity_the_extra_wind_gives_the_acceleration() {
    let wind = Vec3::new(2.0, 0.0, 0.0);
    let edited = edit(uniform(Quantity::AirVelocity, wind), DRAG_TIP).unwrap();
    let outcome = &edited.report.edits[0];
    let law = DragLaw::in_air(1.2);
    let force = |w: Vec3| law.at(0.005, Vec3::z(), w).force / 0.002;
    let gained = force(wind + outcome.extra) - force(wind);
    assert!((gained - Vec3::new(1.28, 0.0, 0.0)).norm() < 1e-4, "{gained}");
    // 0.48 of 1.367 m/s² lie along the hanging lock.
    assert!((outcome.along_lock - 0.351).abs() < 1e-3, "{outcome:?}");
}

#[test]
fn a_target_out_of_reach_is_named_and_the_nearest_place_aimed_at() {
    let toml = DRAG_TIP.replace("[0.08, 0.0, -0.17]", "[0.3, 0.0, 0.0]");
    let edited = edit(uniform(Quantity::ForcePerMass, Vec3::zeros()), &toml).unwrap();
    let outcome = &edited.report.edits[0];
    let Some(Unreachable::TooFar { by_mm }) = outcome.unreachable else { panic!("{outcome:?}") };
    assert!((by_mm - 100.0).abs() < 1e-3);
    // Towards (0.2, 0, 0), not (0.3, 0, 0): from (0, 0, −0.2) in half a second with a gain of one half.
    assert!((outcome.acceleration - Vec3::new(3.2, 0.0, 3.2)).norm() < 1e-4, "{outcome:?}");
}

#[test]
fn a_muted_edit_is_kept_and_does_nothing() {
    let before = uniform(Quantity::ForcePerMass, Vec3::x());
    let after = edit(before.clone(), &format!("{DRAG_TIP}muted = true\n")).unwrap().sequence;
    assert!(after.layers[0].muted);
    let tip = Vec3::new(0.0, 0.0, -0.2);
    assert_eq!(before.at(1.25).sample(tip), after.at(1.25).sample(tip));
}

#[test]
fn the_same_edit_twice_gets_an_id_of_its_own() {
    let once = edit(uniform(Quantity::ForcePerMass, Vec3::x()), DRAG_TIP).unwrap();
    let twice = edit(once.sequence, DRAG_TIP).unwrap();
    let ids: Vec<&str> = twice.sequence.layers.iter().map(|layer| layer.id.as_str()).collect();
    assert_eq!(ids, ["to-the-front", "to-the-front-2"]);
}

#[test]
fn what_is_not_there_is_named() {
    for (from, to, expected) in [
        ("\"A\"", "\"C\"", "edit 1 (`to the front`): found no strand `C`, expected one of: A, B"),
        ("\"tip\"", "5", "edit 1 (`to the front`): strand `A`: found control point 5, expected 1 to 4"),
        (
            "1.5",
            "3.5",
            "edit 1 (`to the front`): found keys at 1 s and 3.5 s, expected both within the motion, 0 s to 3 s",
        ),
    ] {
        let error =
            edit(uniform(Quantity::ForcePerMass, Vec3::x()), &DRAG_TIP.replace(from, to)).unwrap_err();
        assert_eq!(error.to_string(), expected);
    }
    let edits = read_edits(DRAG_TIP.as_bytes()).unwrap();
    let other = StrandMotion { counts: vec![10], ..still_motion() };
    let field = uniform(Quantity::ForcePerMass, Vec3::x());
    let error = apply(field, &scene(), &groom(), &other, &edits, &EditOptions::default()).unwrap_err();
    assert!(matches!(error, EditError::OtherGroom { .. }), "{error}");
}

//! Drags on small worlds: met, smooth, and out of reach.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use tousle_bench::worlds::{groom, mannequin, straight, uniform};
use tousle_core::{Groom, NoProgress, Quantity, StrandMotion, Vec3};
use tousle_direct::{DirectOptions, Directed, Drag, EditMethod, Made, SolvedOutcome, Stage, apply, solve};
use tousle_edit::{
    DEFAULT_REACH_M, EditEffects, FoundKey, Under, Unreachable, find_keys, measure, read_edits,
};
use tousle_field::{FieldSequence, Scene};
use tousle_sim::{Method, SimOptions, Simulator};

/// A breeze that swings for 3 s.
fn breeze(quantity: Quantity) -> FieldSequence {
    let gust = |k: i32| Vec3::new(-2.0, 1.5 * libm::sin(0.2 * f64::from(k)), 0.3);
    uniform(quantity, 30.0, &(0..91).map(gust).collect::<Vec<_>>())
}

/// Locks on the back of a mannequin's head, clear of it.
fn locks() -> Groom {
    let lock = |k: i32| {
        let y = 0.05 * f64::from(k) - 0.05;
        straight(Vec3::new(-0.14, y, 0.02), Vec3::new(-0.3, 0.0, -1.0), 0.22, 12)
    };
    let mut strands: Vec<_> = (0..3).map(lock).collect();
    for (strand, name) in strands.iter_mut().zip(["A", "B", "C"]) {
        strand.name = name.into();
    }
    groom(strands)
}

struct World {
    field: FieldSequence,
    scene: Scene,
    groom: Groom,
    options: SimOptions,
}

impl World {
    fn new(quantity: Quantity) -> Self {
        let options = SimOptions::of(Method::for_quantity(quantity));
        Self { field: breeze(quantity), scene: mannequin(), groom: locks(), options }
    }

    /// The edits by a method, and the motion without and with them.
    fn directed(&self, toml: &str, method: EditMethod) -> (Directed, StrandMotion, StrandMotion) {
        let Self { field, scene, groom, options } = self;
        let simulator = Simulator::new(field, scene, groom, options).unwrap();
        let stage = Stage { simulator: &simulator, field, scene, groom };
        let before = simulator.simulate(&[], &NoProgress).unwrap().motion;
        let edits = read_edits(toml.as_bytes()).unwrap();
        let options = DirectOptions { method, ..DirectOptions::for_quantity(field.quantity) };
        let directed = apply(&stage, &[], &before, &edits, &options).unwrap();
        let after = simulator.simulate(&directed.stack, &NoProgress).unwrap().motion;
        (directed, before, after)
    }
}

/// What edits did to a motion without any.
fn effects_of(
    world: &World,
    before: &StrandMotion,
    directed: &Directed,
    after: &StrandMotion,
) -> EditEffects {
    let before = Under { motion: before, layers: &[] };
    measure(before, Under { motion: after, layers: &directed.stack }, &world.groom).unwrap()
}

fn solved(directed: &Directed) -> &SolvedOutcome {
    let [Made::Physical(outcome)] = &directed.report.edits[..] else { panic!("{:?}", directed.report) };
    outcome
}

const PULL: &str = "\
[[edit]]
name = \"pull\"
strand = \"B\"
control_point = \"tip\"
first_secs = 1.0
second_secs = 1.5
offset_m = [0.0, -0.04, -0.01]
";

/// Met to a millimeter where E4 is centimeters off; the same figures from the motion of all strands.
fn key_is_met(quantity: Quantity) {
    let world = World::new(quantity);
    let (directed, before, after) = world.directed(PULL, EditMethod::Physical);
    let outcome = solved(&directed);
    let key = &outcome.keys[0];
    let is_met = key.residual_mm.after <= 1.0;
    assert!(is_met || key.unreachable.is_some(), "{outcome:#?}");
    assert!(key.residual_mm.after < 5.0, "{outcome:#?}");
    let effects = effects_of(&world, &before, &directed, &after);
    let measured = effects.edits[0].keys[0].residual_mm;
    assert!((measured.after - key.residual_mm.after).abs() < 0.01, "{measured:?}");
    assert!(effects.first_change_secs.is_some_and(|secs| secs > 1.0));
    let (paper, before, after) = world.directed(PULL, EditMethod::Paper);
    let effects = effects_of(&world, &before, &paper, &after);
    eprintln!(
        "{quantity:?}: E4 {:.1} mm, solved {:.3} mm; acceleration x {:.2}, jerk x {:.2}; {} runs, {} handles",
        effects.edits[0].keys[0].residual_mm.after,
        measured.after,
        outcome.acceleration_ratio,
        outcome.jerk_ratio,
        outcome.n_runs,
        outcome.n_handles,
    );
}

#[test]
fn a_key_in_wind_is_met() {
    key_is_met(Quantity::AirVelocity);
}

#[test]
fn a_key_in_the_papers_forces_is_met() {
    key_is_met(Quantity::ForcePerMass);
}

/// A target that is moved on in ten moves: each answer begins from the last, meets it, and takes far fewer runs than the
/// first, from nothing. When the hand lets go nothing is left of where it was.
#[test]
fn a_hand_that_moves_is_followed() {
    let world = World::new(Quantity::AirVelocity);
    let World { field, scene, groom, options } = &world;
    let simulator = Simulator::new(field, scene, groom, options).unwrap();
    let stage = Stage { simulator: &simulator, field, scene, groom };
    let before = simulator.simulate(&[], &NoProgress).unwrap().motion;
    let edits = read_edits(PULL.as_bytes()).unwrap();
    let options = DirectOptions::for_quantity(field.quantity);
    let keys = find_keys(&edits, 1, groom, &before).unwrap();
    let way = keys[0].target_m - keys[0].unedited_m;
    let at = |share: f64| {
        let target_m = keys[0].unedited_m + way * share;
        Drag {
            name: "pull".into(),
            edit_id: "pull".into(),
            muted: false,
            first_secs: 1.0,
            keys: vec![FoundKey { target_m, ..keys[0].clone() }],
            reach_m: DEFAULT_REACH_M,
        }
    };
    let mut last = solve(&stage, &[], &at(0.1), None, &options).unwrap();
    let n_first = last.outcome.n_runs;
    for k in 2..=10 {
        last = solve(&stage, &[], &at(0.1 * f64::from(k)), Some(&last), &options).unwrap();
        let outcome = &last.outcome;
        assert!(
            outcome.keys[0].residual_mm.after <= 1.0 && outcome.n_runs < n_first,
            "{n_first} {outcome:#?}"
        );
    }
    let let_go = solve(&stage, &[], &at(1.0), None, &options).unwrap();
    let (directed, ..) = world.directed(PULL, EditMethod::Physical);
    assert_eq!(solved(&directed).keys[0].residual_mm, let_go.outcome.keys[0].residual_mm);
}

/// Two points of one strand at one time, nearer to each other than they would be and to the root, and another strand later.
#[test]
fn several_keys_are_met_together() {
    let toml = format!(
        "{PULL}
[[edit.also]]
control_point = 6
offset_m = [0.0, -0.015, 0.0]
[[edit.also]]
strand = \"A\"
secs = 1.8
offset_m = [0.02, 0.02, 0.0]
"
    );
    let (directed, ..) = World::new(Quantity::AirVelocity).directed(&toml, EditMethod::Physical);
    all_met(solved(&directed));
}

/// Two locks that feel nothing of one another's layers: each gets those that it would get alone.
#[test]
fn strands_that_hang_apart_are_solved_as_each_alone() {
    let mut world = World::new(Quantity::AirVelocity);
    world.groom.strands.truncate(2);
    for (strand, y) in world.groom.strands.iter_mut().zip([-0.2, 0.2]) {
        strand.rest_curve_m.iter_mut().for_each(|point| point.y = y);
    }
    let other = PULL.replace("\"B\"", "\"A\"").replace("0.04", "0.03");
    let both = format!("{PULL}[[edit.also]]\nstrand = \"A\"\noffset_m = [0.0, -0.03, -0.01]\n");
    let handles = |toml: &str| {
        let (directed, ..) = world.directed(toml, EditMethod::Physical);
        all_met(solved(&directed));
        let layers = directed.added().iter().map(|layer| (layer.first_secs, layer.handles.clone()));
        layers.collect::<Vec<_>>()
    };
    assert_eq!(handles(&both), [handles(&other), handles(PULL)].concat());
}

/// One strand pulled to one side, then to the other, by its tip and by its middle.
#[test]
fn keys_that_follow_one_another_are_met() {
    let toml = format!(
        "{PULL}
[[edit.also]]
secs = 1.8
offset_m = [0.01, 0.03, 0.0]
[[edit.also]]
control_point = 7
secs = 2.1
offset_m = [0.0, -0.02, 0.01]
"
    );
    let (directed, ..) = World::new(Quantity::AirVelocity).directed(&toml, EditMethod::Physical);
    all_met(solved(&directed));
}

fn all_met(outcome: &SolvedOutcome) {
    for key in &outcome.keys {
        assert!(key.residual_mm.after <= 1.0 && key.unreachable.is_none(), "{outcome:#?}");
    }
}

#[test]
fn what_is_out_of_reach_is_said_and_aimed_at() {
    let toml = PULL.replace("offset_m = [0.0, -0.04, -0.01]", "target_m = [-0.14, 0.25, 0.02]");
    let (directed, ..) = World::new(Quantity::AirVelocity).directed(&toml, EditMethod::Physical);
    let key = &solved(&directed).keys[0];
    let Some(Unreachable::TooFar { by_mm }) = key.unreachable else { panic!("{key:?}") };
    // 220 mm of lock from a root 250 mm away.
    assert!((by_mm - 30.0).abs() < 0.1, "{by_mm}");
    assert!(key.residual_mm.after < 0.7 * key.residual_mm.before, "{key:?}");
}

/// A target inside the head is said to be there, and the nearest free place is named and aimed at.
#[test]
fn a_target_inside_the_body_is_said_and_the_nearest_free_place_aimed_at() {
    let toml = PULL.replace("offset_m = [0.0, -0.04, -0.01]", "target_m = [-0.07, 0.0, -0.01]");
    let (directed, ..) = World::new(Quantity::AirVelocity).directed(&toml, EditMethod::Physical);
    let outcome = solved(&directed);
    let key = &outcome.keys[0];
    assert!(matches!(key.unreachable, Some(Unreachable::InsideBody { .. })), "{key:?}");
    assert!((key.aimed_m - key.key.target_m).norm() > 0.005, "{key:?}");
    assert!(key.residual_mm.after <= key.residual_mm.before, "{key:?}");
}

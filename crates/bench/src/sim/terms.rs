use super::Part;
use crate::capture::failed;
use crate::worlds::{gusts, mannequin, push, wig};
use crate::{BenchError, Cell, Section, Table};
use nalgebra::UnitQuaternion;
use std::time::Instant;
use tousle_core::{Body, Groom, NoProgress, Pose, PoseTrack, Progress, Vec3};
use tousle_field::{Ease, FieldLayer, FieldSequence, Handle, Scene};
use tousle_sim::{Method, SimError, SimOptions, SimReport, Simulator};

/// Strands of 16 points, enough to fill registers and few enough to stay in the nearest memory.
const N_STRANDS: usize = 240;
const RATE_HZ: f64 = 120.0;

/// A change of the plain scene.
struct Variant {
    name: &'static str,
    change: fn(&mut World),
}

struct World {
    field: FieldSequence,
    scene: Scene,
    groom: Groom,
}

/// The plain scene has wind, air and weight, and nothing else; each variant has one thing more, or less.
const VARIANTS: [Variant; 12] = [
    Variant { name: "plain: wind, air, weight", change: |_| {} },
    Variant { name: "no weight", change: |w| w.scene.gravity_world = Vec3::zeros() },
    Variant {
        name: "a body out of reach",
        change: |w| {
            w.scene.body = mannequin().body;
            w.scene.body.colliders.truncate(1);
            w.groom.strands.iter_mut().flat_map(|s| &mut s.rest_curve_m).for_each(|p| p.x += 2.0);
        },
    },
    Variant {
        name: "the same hair without the body",
        change: |w| w.groom.strands.iter_mut().flat_map(|s| &mut s.rest_curve_m).for_each(|p| p.x += 2.0),
    },
    Variant { name: "many poses that never change", change: |w| w.scene.poses = track(|_| Vec3::zeros()) },
    Variant { name: "a muted edit", change: |w| w.field.layers.push(layer(true)) },
    Variant {
        name: "head that nods by 0.3 rad",
        change: |w| w.scene.poses = track(|secs| Vec3::y() * (0.3 * libm::sin(6.0 * secs))),
    },
    Variant { name: "an edit", change: |w| w.field.layers.push(layer(false)) },
    Variant {
        name: "head, neck and shoulders, without friction",
        change: |w| w.scene.body = Body { friction: 0.0, ..mannequin().body },
    },
    Variant { name: "head, neck and shoulders, with friction", change: |w| w.scene.body = mannequin().body },
    Variant {
        name: "all of these",
        change: |w| {
            w.scene.body = mannequin().body;
            w.scene.poses = track(|secs| Vec3::y() * (0.3 * libm::sin(6.0 * secs)));
            w.field.layers.push(layer(false));
        },
    },
    Variant {
        name: "no air",
        change: |w| {
            w.scene.air_density = 0.0;
            w.scene.poses = track(|secs| Vec3::y() * (0.3 * libm::sin(6.0 * secs)));
        },
    },
];

/// What each term costs, alone.
pub(super) fn section(progress: &dyn Progress) -> Result<Section, BenchError> {
    let columns = [
        "method",
        "scene",
        "ns a point and step",
        "against plain, %",
        "iterations a step",
        "ns a point and iteration",
        "terms that run",
    ];
    let mut table = Table::new("Cost of each term", &columns);
    let plain_field = gusts();
    let worlds = VARIANTS.map(|variant| {
        let mut world = plain_world(&plain_field);
        (variant.change)(&mut world);
        world
    });
    for (k, method) in [Method::Physical, Method::Paper].into_iter().enumerate() {
        let rounds = Rounds { progress, done: k, of: 2 };
        let costs = costs(&worlds, method, &rounds).map_err(failed("made-up hair", "simulating"))?;
        let plain = costs[0].nanos;
        for (variant, cost) in VARIANTS.iter().zip(costs) {
            table.push(vec![
                Cell::text(method.name()),
                Cell::text(variant.name),
                Cell::number(cost.nanos, 1),
                Cell::number(100.0 * (cost.nanos / plain - 1.0), 0),
                Cell::number(cost.iterations, 2),
                Cell::number(cost.nanos / cost.iterations, 1),
                Cell::text(cost.terms),
            ]);
        }
    }
    Ok(Section {
        name: Part::Terms.stem(),
        title: "What each term costs".to_owned(),
        words: format!(
            "{N_STRANDS} strands of 16 points in gusts of 3 m/s, {RATE_HZ} steps a second for a second, by default \
             integrators, on one thread, prepared before; the least time of {ROUNDS} runs, all scenes in turn. What moves \
             otherwise takes other iterations, so both are shown."
        ),
        tables: vec![(String::new(), table)],
        plots: Vec::new(),
    })
}

fn plain_world(field: &FieldSequence) -> World {
    let scene = Scene { body: Body::none(), ..mannequin() };
    World { field: field.clone(), scene, groom: wig(N_STRANDS, 16) }
}

/// How often each scene runs: the least time of so many is within a few per cent on a machine that does other things too.
const ROUNDS: usize = 24;

/// The rounds of a method as a part of all.
struct Rounds<'a> {
    progress: &'a dyn Progress,
    done: usize,
    of: usize,
}

/// What a scene costs.
struct Cost {
    /// A point and step.
    nanos: f64,
    /// A step.
    iterations: f64,
    /// What runs.
    terms: String,
}

/// What each scene costs. In turn, so that what slows the machine for a while slows all.
fn costs(worlds: &[World], method: Method, rounds: &Rounds<'_>) -> Result<Vec<Cost>, SimError> {
    let options = SimOptions {
        rate_hz: RATE_HZ,
        dt_secs: Some(1.0 / RATE_HZ),
        duration_secs: Some(1.0),
        ..SimOptions::of(method)
    };
    let simulators = worlds.iter().map(|w| Simulator::new(&w.field, &w.scene, &w.groom, &options));
    let simulators: Vec<_> = simulators.collect::<Result<_, _>>()?;
    let mut least_secs = vec![f64::INFINITY; worlds.len()];
    let mut reports = Vec::new();
    for round in 0..ROUNDS {
        rounds.progress.at((rounds.done * ROUNDS + round) as u64, (rounds.of * ROUNDS) as u64);
        reports.clear();
        for ((world, simulator), least_secs) in worlds.iter().zip(&simulators).zip(&mut least_secs) {
            let started = Instant::now();
            let simulation = simulator.simulate(&world.field.layers, &NoProgress)?;
            *least_secs = least_secs.min(started.elapsed().as_secs_f64());
            reports.push(simulation.report);
        }
    }
    let cost = |((world, report), secs): ((&World, &SimReport), f64)| {
        let active = report.plan.iter().filter(|entry| entry.active);
        Cost {
            nanos: 1e9 * secs / (world.groom.n_points() as f64 * RATE_HZ),
            iterations: report.iterations_per_step,
            terms: active.map(|entry| entry.term.as_str()).collect::<Vec<_>>().join(", "),
        }
    };
    Ok(worlds.iter().zip(&reports).zip(least_secs).map(cost).collect())
}

/// Poses of a head that turns about its middle by what is told of each time.
fn track(turn_at: impl Fn(f64) -> Vec3) -> PoseTrack {
    let rate_hz = 120.0;
    let pose = |k: u32| {
        let turn = UnitQuaternion::from_scaled_axis(turn_at(f64::from(k) / rate_hz));
        Pose::from_parts(Vec3::zeros().into(), turn)
    };
    PoseTrack { start_secs: 0.0, rate_hz, poses: (0..240).map(pose).collect() }
}

/// An edit with one handle beside the head, there all the time.
fn layer(muted: bool) -> FieldLayer {
    let handle = Handle { center_m: Vec3::new(0.0, 0.1, -0.1), reach_m: 0.1, extra: Vec3::y() * 2.0 };
    FieldLayer { muted, ease: Ease { rise: 0.1, fall: 0.1 }, ..push(handle, (-1.0, 3.0)) }
}

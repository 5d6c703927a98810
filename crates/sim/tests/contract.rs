//! Frames, times, terms and bytes: what callers rely on.

mod common;

use common::{
    assert_sound, farthest, gusts, lift, mannequin, many, options, over_the_head, run, still_air, straight,
    track, uniform,
};
use std::sync::Mutex;
use tousle_core::{NoProgress, Pose, PoseTrack, Progress, Quantity, Strand, Vec3};
use tousle_field::{FieldLayer, FieldSequence, Reshape};
use tousle_sim::{Integrator, Method, SimError, SimOptions, Simulation, Simulator, TimeMode, simulate};

#[test]
fn the_first_frame_is_the_rest_curve_and_the_last_is_the_fields_end() {
    let motion = run(&gusts(), &mannequin(), many(), &SimOptions::of(Method::Paper)).unwrap().motion;
    assert_eq!(motion.times_secs.len(), 61);
    assert!((motion.times_secs[60] - 1.0).abs() < 1e-12);
    assert_eq!(motion.positions_m.len(), 61 * motion.n_points());
    let rest: Vec<[f32; 3]> =
        many().iter().flat_map(|s| s.rest_curve_m.clone()).map(|p| p.map(|c| c as f32).into()).collect();
    assert_eq!(motion.frame(0), rest);
    // Roots stay.
    assert_eq!(motion.strand(60, 7)[0], motion.strand(0, 7)[0]);
}

/// Some strands simulated by themselves move as beside all others, from which their style is told.
#[test]
fn a_part_moves_as_in_the_whole() {
    let (field, scene) = (gusts(), mannequin());
    let mut whole = tousle_bench::worlds::wig(40, 12);
    // Locks that hang free in a bow tell how this hair falls; without them nobody knows.
    let bow = |k: usize| {
        let point = |j: usize| {
            let share = j as f64 / 11.0;
            Vec3::new(0.2 + 0.01 * k as f64, 0.06 * share * share, -0.22 * share)
        };
        Strand { rest_curve_m: (0..12).map(point).collect(), ..whole.strands[0].clone() }
    };
    let bows: Vec<Strand> = (0..20).map(bow).collect();
    whole.strands.extend(bows);
    let chosen = [3, 17, 31];
    let part = tousle_core::Groom {
        strands: chosen.iter().map(|k| whole.strands[*k].clone()).collect(),
        assumed: Vec::new(),
    };
    let options = SimOptions { duration_secs: Some(0.5), ..SimOptions::of(Method::Physical) };
    let of = |simulator: Simulator<'_>| simulator.simulate(&[], &NoProgress).unwrap().motion;
    let all = of(Simulator::new(&field, &scene, &whole, &options).unwrap());
    let some = of(Simulator::of_part(&field, &scene, &part, &whole, &options).unwrap());
    let alone = of(Simulator::new(&field, &scene, &part, &options).unwrap());
    let frame = all.times_secs.len() - 1;
    for (idx, k) in chosen.into_iter().enumerate() {
        assert_eq!(some.strand(frame, idx), all.strand(frame, k));
    }
    assert_ne!(alone.frame(frame), some.frame(frame), "three strands tell of another style");
}

/// A sink gets the frames of the motion, one after the other, be there few points or so many that the field is laid together.
#[test]
fn a_sink_gets_what_the_motion_holds() {
    let (field, scene) = (gusts(), mannequin());
    for (n_strands, dt_secs) in [(3, 1.0 / 60.0), (3, 1.0 / 240.0), (410, 1.0 / 120.0)] {
        let groom = tousle_bench::worlds::wig(n_strands, 16);
        for method in [Method::Paper, Method::Physical] {
            let options =
                SimOptions { dt_secs: Some(dt_secs), duration_secs: Some(0.3), ..SimOptions::of(method) };
            let simulator = Simulator::new(&field, &scene, &groom, &options).unwrap();
            let Simulation { motion, report } = simulator.simulate(&[], &NoProgress).unwrap();
            let (mut secs, mut positions_m) = (Vec::new(), Vec::new());
            let streamed = simulator.simulate_into(
                &[],
                &mut |frame| {
                    assert_eq!(frame.number, secs.len());
                    secs.push(frame.secs);
                    positions_m.extend_from_slice(frame.positions_m);
                    Ok(())
                },
                &NoProgress,
            );
            assert_eq!(streamed.unwrap(), report, "{method:?}");
            assert_eq!(secs, motion.times_secs, "{method:?}");
            assert!(positions_m == motion.positions_m, "{method:?}, {n_strands} strands");
        }
    }
}

/// A sink that takes no more ends the run.
#[test]
fn a_full_sink_ends_the_run() {
    let (field, scene, options) = (gusts(), mannequin(), SimOptions::of(Method::Physical));
    let groom = common::groom(many());
    let simulator = Simulator::new(&field, &scene, &groom, &options).unwrap();
    let mut taken = 0;
    let run = simulator.simulate_into(
        &[],
        &mut |frame| {
            taken += 1;
            if frame.number < 7 { Ok(()) } else { Err("full".into()) }
        },
        &NoProgress,
    );
    let Err(SimError::Sink(why)) = run else { panic!("{run:?}") };
    assert_eq!((why.to_string().as_str(), taken), ("full", 8));
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let bits = |n_threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().unwrap();
        let simulation =
            pool.install(|| run(&gusts(), &mannequin(), many(), &SimOptions::of(Method::Paper)).unwrap());
        let bits: Vec<u32> = simulation.motion.positions_m.iter().flatten().map(|c| c.to_bits()).collect();
        (bits, simulation.report)
    };
    let one = bits(1);
    assert_eq!(one, bits(3));
    assert_eq!(one, bits(1));
}

/// A strand moves the same alone and among others.
#[test]
fn strands_do_not_know_of_one_another() {
    let together = run(&gusts(), &mannequin(), many(), &SimOptions::of(Method::Paper)).unwrap().motion;
    let alone =
        run(&gusts(), &mannequin(), vec![many()[11].clone()], &SimOptions::of(Method::Paper)).unwrap().motion;
    assert_eq!(together.strand(47, 11), alone.frame(47));
}

#[test]
fn once_loop_and_hold_differ_after_the_end_only() {
    let run_for = |time: TimeMode| {
        let options = SimOptions { time, duration_secs: Some(3.0), ..SimOptions::of(Method::Paper) };
        run(&gusts(), &mannequin(), many(), &options).unwrap().motion
    };
    let [once, again, hold] = [TimeMode::Once, TimeMode::Loop, TimeMode::Hold].map(run_for);
    assert_eq!(once.frame(58), again.frame(58));
    assert_eq!(once.frame(58), hold.frame(58));
    let apart = |a: &tousle_core::StrandMotion, b: &tousle_core::StrandMotion| {
        let pairs = a.frame(150).iter().zip(b.frame(150));
        pairs
            .map(|(a, b)| (Vec3::from(a.map(f64::from)) - Vec3::from(b.map(f64::from))).norm())
            .fold(0.0, f64::max)
    };
    assert!(apart(&once, &again) > 5e-3 && apart(&once, &hold) > 5e-3 && apart(&again, &hold) > 5e-3);
}

#[test]
fn a_shots_own_head_replaces_the_captures() {
    let shake = |k: i32| {
        let turn =
            nalgebra::UnitQuaternion::from_scaled_axis(Vec3::z() * (0.5 * libm::sin(0.1 * f64::from(k))));
        Pose::from_parts(Vec3::zeros().into(), turn)
    };
    let head = PoseTrack { start_secs: 0.0, rate_hz: 120.0, poses: (0..240).map(shake).collect() };
    let options = SimOptions { head: Some(head), duration_secs: Some(1.5), ..SimOptions::of(Method::Paper) };
    let simulation = run(&still_air(), &mannequin(), vec![many()[0].clone()], &options).unwrap();
    assert!(farthest(&simulation.motion) > 0.01);
    let entry = simulation.report.plan.iter().find(|entry| entry.term == "head movement").unwrap();
    assert!(entry.active && entry.why.contains("shot"), "{}", entry.why);
    assert!(simulation.report.assumed.iter().any(|a| a.what == "torso"));
}

/// The plan names every term of E2, and leaves out what the scene does not have.
#[test]
fn the_plan_says_what_runs_and_why_not() {
    let report = run(&still_air(), &mannequin(), vec![over_the_head()], &SimOptions::of(Method::Paper))
        .unwrap()
        .report;
    let active = |term: &str| report.plan.iter().find(|entry| entry.term == term).map(|entry| entry.active);
    assert_eq!(active("gravity"), Some(true));
    assert_eq!(active("wind"), Some(false));
    assert_eq!(active("head movement"), Some(false));
    assert_eq!(active("spring"), Some(true));
    assert_eq!(active("collision"), Some(true));
    assert_eq!(active("edits"), Some(false));
    assert!(report.plan.iter().all(|entry| !entry.why.is_empty()));
}

/// A layer that only reshapes the wind acts; one that is muted, or has nothing to add, does not.
#[test]
fn the_plan_counts_the_layers_that_change_anything() {
    let calm = Some(Reshape { turn: Vec3::zeros(), scale: 0.0 });
    let reshapes = FieldLayer { reshape: calm, ..lift(Vec3::zeros()) };
    let muted = FieldLayer { muted: true, ..lift(Vec3::x()) };
    for (layers, active, why) in [
        (
            vec![reshapes, muted.clone(), lift(Vec3::zeros())],
            true,
            "1 layers, 1 muted, 1 that change nothing",
        ),
        (vec![muted, lift(Vec3::zeros())], false, "(1 muted, 1 that change nothing)"),
        (vec![lift(Vec3::x())], true, "1 layers, 0 muted"),
    ] {
        let field = FieldSequence { layers, ..gusts() };
        let options = SimOptions { duration_secs: Some(0.1), ..SimOptions::of(Method::Paper) };
        let report = run(&field, &mannequin(), vec![over_the_head()], &options).unwrap().report;
        let edits = report.plan.iter().find(|entry| entry.term == "edits").unwrap();
        assert!(edits.active == active && edits.why.ends_with(why), "{edits:?}");
    }
}

/// An edit moves the hair during its span and leaves it alone, to the bit, before.
#[test]
fn an_edit_layer_acts_in_its_span() {
    let mut field = gusts();
    let plain = run(&field, &mannequin(), many(), &SimOptions::of(Method::Paper)).unwrap().motion;
    field.layers.push(lift(Vec3::new(8.0, 0.0, 0.0)));
    let edited = run(&field, &mannequin(), many(), &SimOptions::of(Method::Paper)).unwrap().motion;
    assert_eq!(plain.frame(30), edited.frame(30));
    let moved = (track(&plain, 5)[50] - track(&edited, 5)[50]).norm();
    assert!(moved > 1e-3, "{moved}");
    field.layers[0].muted = true;
    assert_eq!(run(&field, &mannequin(), many(), &SimOptions::of(Method::Paper)).unwrap().motion, plain);
}

/// A force per mass acts on a strand as it is, whatever its width: a wind that pushes as hard does the same.
#[test]
fn a_force_per_mass_is_a_wind_that_pushes_as_hard() {
    let strand = || straight(Vec3::new(0.3, 0.0, 0.2), -Vec3::z(), 0.05, 1);
    let law = tousle_rod::DragLaw::in_air(1.2);
    let speed = 1.5;
    let push = law.across(4e-3, speed) * speed / 1.5e-3;
    let tip = |quantity: Quantity, strength: f64| {
        let field = uniform(quantity, 30.0, &[Vec3::x() * strength]);
        let motion =
            run(&field, &mannequin(), vec![strand()], &options(Integrator::Exponential, 1.0 / 240.0, 0.05))
                .unwrap()
                .motion;
        track(&motion, 1)[3] - track(&motion, 1)[0]
    };
    let (by_force, by_wind) = (tip(Quantity::ForcePerMass, push), tip(Quantity::AirVelocity, speed));
    assert!(by_wind.norm() > 1e-4);
    assert!((by_force - by_wind).norm() < 0.02 * by_wind.norm(), "{by_force} {by_wind}");
}

/// Semi-implicit Euler refuses what it does not stand, and names the limit; within it, it holds.
#[test]
fn an_unstable_step_is_refused_with_its_limit() {
    let stiff = || {
        vec![Strand {
            bending_stiffness_n_m2: 1e-2,
            ..straight(Vec3::new(0.2, 0.0, 0.0), -Vec3::z(), 0.1, 6)
        }]
    };
    let error = run(&still_air(), &mannequin(), stiff(), &options(Integrator::SemiImplicit, 1.0 / 60.0, 0.5))
        .unwrap_err();
    let SimError::Unstable { limit_secs, dt_secs, point, .. } = error else { panic!("{error}") };
    assert!(limit_secs < 1e-3 && dt_secs > limit_secs && point == Some(6), "{error}");
    assert!(error.to_string().contains("semi-implicit"), "{error}");
    let wind = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(30.0, 0.0, 0.0)]);
    // What it chooses by itself is within the limit.
    let by_itself = SimOptions {
        method: Method::Paper,
        integrator: Some(Integrator::SemiImplicit),
        duration_secs: Some(0.5),
        ..SimOptions::default()
    };
    let simulation = run(&wind, &mannequin(), stiff(), &by_itself).unwrap();
    assert!(simulation.report.dt_secs < 1e-3);
    assert_sound(&simulation, "within the limit");
}

struct Watch(Mutex<Vec<(u64, u64)>>);

impl Progress for Watch {
    fn at(&self, done: u64, total: u64) {
        self.0.lock().expect("no other thread has panicked").push((done, total));
    }
}

#[test]
fn progress_ends_at_the_total() {
    let watch = Watch(Mutex::new(Vec::new()));
    simulate(&gusts(), &mannequin(), &common::groom(many()), &SimOptions::of(Method::Paper), &watch).unwrap();
    let seen = watch.0.into_inner().unwrap();
    assert!(seen.len() > 10);
    assert!(seen.iter().any(|(done, total)| done == total));
    assert!(seen.iter().all(|(done, total)| done <= total));
}

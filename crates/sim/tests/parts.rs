//! A run that is stopped and goes on gives the same bytes as one that was never stopped.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

mod common;

use common::{groom, mannequin, options, physical, straight, uniform};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::error::Error;
use std::num::NonZeroUsize;
use tousle_core::{Groom, NoProgress, Quantity, Vec3};
use tousle_field::Scene;
use tousle_sim::{
    Frame, Integrator, Keeper, Part, Precision, SimError, SimOptions, Simulation, Simulator, max_stretch,
    simulate, simulate_kept,
};

/// Keeps parts in memory and stops the run when it has so many.
struct Shelf {
    parts: RefCell<BTreeMap<usize, Part>>,
    most: usize,
}

impl Keeper for Shelf {
    fn strands_per_part(&self) -> Option<NonZeroUsize> {
        NonZeroUsize::new(16)
    }

    fn kept(&self, part: usize) -> Result<Option<Part>, Box<dyn Error + Send + Sync>> {
        Ok(self.parts.borrow().get(&part).cloned())
    }

    fn keep(&self, number: usize, part: &Part) -> Result<(), Box<dyn Error + Send + Sync>> {
        if self.parts.borrow().len() == self.most {
            return Err("the shelf is full".into());
        }
        self.parts.borrow_mut().insert(number, part.clone());
        Ok(())
    }
}

/// Sixty strands of four lengths on the head.
fn sixty() -> Groom {
    groom(
        (0..60)
            .map(|k| {
                let (sin, cos) = libm::sincos(f64::from(k));
                let root = Vec3::new(0.08 * cos, 0.06 * sin, 0.03);
                straight(root, Vec3::new(cos, sin, -1.0), 0.1 + 0.005 * f64::from(k), 3 + k as usize % 4)
            })
            .collect(),
    )
}

fn run(groom: &Groom, options: &SimOptions, keeper: Option<&dyn Keeper>) -> Result<Simulation, SimError> {
    let gusts = [Vec3::zeros(), Vec3::new(-8.0, 3.0, 0.0), Vec3::new(5.0, 0.0, 2.0)];
    let field = uniform(Quantity::AirVelocity, 10.0, &gusts);
    simulate_kept(&field, &mannequin(), groom, options, keeper, &NoProgress)
}

#[test]
fn a_stopped_run_goes_on_to_the_same_bytes() {
    let groom = sixty();
    for options in [
        physical(Integrator::Implicit, 1.0 / 120.0, 0.3),
        physical(Integrator::Adaptive, 1.0 / 120.0, 0.1),
        options(Integrator::Exponential, 1.0 / 120.0, 0.3),
    ] {
        let never_stopped = run(&groom, &options, None).unwrap();
        let shelf = Shelf { parts: RefCell::default(), most: 2 };
        assert!(matches!(run(&groom, &options, Some(&shelf)), Err(SimError::Keeper(_))));
        assert_eq!(shelf.parts.borrow().len(), 2, "what was done is kept");
        let shelf = Shelf { most: 99, ..shelf };
        let stopped = run(&groom, &options, Some(&shelf)).unwrap();
        assert!(stopped == never_stopped, "{:?}", options.integrator);
        assert_eq!(shelf.parts.borrow().len(), 4);
    }
}

/// Of hair that no solver stretches: rounding alone, which is nearly the same whatever the stick is held against.
#[test]
fn the_stretch_that_is_reported_is_that_of_the_frames() {
    for precision in [Precision::Double, Precision::Single] {
        let options = SimOptions { precision, ..physical(Integrator::Implicit, 1.0 / 120.0, 0.3) };
        let Simulation { motion, report } = run(&sixty(), &options, None).unwrap();
        let found = report.max_stretch - max_stretch(&motion);
        assert!(found.abs() < 3e-7 && report.max_stretch > 0.0, "{precision:?}: {found}");
    }
}

/// Numbers that are each possible and too large to compute with.
#[test]
fn a_part_that_gets_nowhere_is_named_and_not_kept() {
    let field = uniform(Quantity::AirVelocity, 10.0, &[Vec3::new(-8.0, 3.0, 0.0); 4]);
    let scene = Scene { air_density: 1e300, ..mannequin() };
    let shelf = Shelf { parts: RefCell::default(), most: 99 };
    for integrator in [Integrator::Implicit, Integrator::ImplicitEuler, Integrator::Adaptive] {
        let options = physical(integrator, 1.0 / 60.0, 0.2);
        let run = simulate_kept(&field, &scene, &sixty(), &options, Some(&shelf), &NoProgress);
        let Err(SimError::Nowhere { strand, secs, .. }) = run else { panic!("{integrator:?}: {run:?}") };
        assert!(!strand.is_empty() && secs > 0.0, "strand {strand:?} at {secs} s");
        assert!(shelf.parts.borrow().is_empty());
        // A sink gets the frames before that one, and hears of the same.
        let groom = sixty();
        let simulator = Simulator::new(&field, &scene, &groom, &options).unwrap();
        let mut last_secs = f64::NEG_INFINITY;
        let mut sink = |frame: Frame<'_>| {
            assert!(frame.positions_m.iter().flatten().all(|c| c.is_finite()), "{integrator:?}");
            last_secs = frame.secs;
            Ok(())
        };
        let run = simulator.simulate_into(&[], &mut sink, &NoProgress);
        let Err(SimError::Nowhere { strand: again, secs: at, .. }) = run else { panic!("{run:?}") };
        assert_eq!((again, at), (strand, secs), "{integrator:?}");
        assert!(last_secs < secs, "{integrator:?}");
    }
}

#[test]
fn a_part_of_another_size_is_refused() {
    let options = physical(Integrator::Implicit, 1.0 / 60.0, 0.1);
    let shelf = Shelf { parts: RefCell::default(), most: 99 };
    run(&sixty(), &options, Some(&shelf)).unwrap();
    let longer = SimOptions { duration_secs: Some(0.2), ..options };
    assert!(matches!(run(&sixty(), &longer, Some(&shelf)), Err(SimError::OtherPart { number: 0 })));
}

/// The style of a strand that nobody gave a stiffness stays up; one that is as soft by word of its groom falls.
#[test]
fn a_style_stays_up() {
    let soft = |holds_style| {
        let mut strand = straight(Vec3::new(0.0, 0.08, 0.0), Vec3::y(), 0.2, 16);
        strand.bending_stiffness_n_m2 = 1e-8;
        strand.holds_style = holds_style;
        groom(vec![strand])
    };
    let still = common::still_air();
    // The air is not quite still, as nowhere.
    let breath = uniform(Quantity::AirVelocity, 30.0, &[Vec3::new(0.01, 0.0, 0.0)]);
    let options = physical(Integrator::Implicit, 1.0 / 120.0, 3.0);
    let moved = |field, holds_style| {
        let simulation = simulate(field, &mannequin(), &soft(holds_style), &options, &NoProgress).unwrap();
        let told = simulation.report.assumed.iter().any(|a| a.what.contains("where they lean out"));
        assert_eq!(told, holds_style, "what was made stiffer is said");
        common::farthest(&simulation.motion)
    };
    assert_eq!(moved(&still, true), 0.0);
    let (held, fallen) = (moved(&breath, true), moved(&breath, false));
    assert!(held < 2e-3 && fallen > 0.1, "{held} m held, {fallen} m not");
}

use super::lock::SeenLock;
use super::prior::is_still;
use super::solve::{Problem, Solved};
use serde::Serialize;
use tousle_core::Vec3;
use tousle_flow::AirState;

/// What the method `physical` found out on the way and what it took for granted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PhysicalReport {
    /// What was taken for granted where the session or the capture said nothing.
    pub warnings: Vec<String>,
    /// Locks that were explained, in the session's order.
    pub locks: Vec<LockFound>,
    /// Modes of swirls that were solved for.
    pub n_modes: usize,
    /// Share of the stream that the wake takes on its axis, mean over the time in which wind may blow.
    pub wake: f64,
    /// Displacement thickness of the slow layer at the scalp, m, mean over the same time.
    pub layer_m: f64,
    /// Share of the stream that slips past the scalp, mean over the same time.
    pub slip: f64,
    /// Speed of the wind far away, m/s, mean over the same time.
    pub outside_mps: f64,
    /// Mean square of what is left of the moments, over what was expected: 1 if the errors were as large as assumed.
    pub left_over: f64,
}

/// What is taken for known of one lock.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LockFound {
    /// Its name.
    pub name: String,
    /// Its bending stiffness, N·m²: as taught by a simulation of the wig, or that of as many hairs as weigh so much.
    pub stiffness_n_m2: f64,
    /// Its drag over that of its measured width; 1 unless a simulation taught it.
    pub drag_scale: f64,
    /// Share of steps in which the body bears it.
    pub touches: f64,
}

/// The report of a solved problem.
pub(crate) fn report(problem: &Problem<'_>, solved: &Solved) -> PhysicalReport {
    let states = &solved.air.states;
    let blows: Vec<usize> = (0..states.len()).filter(|step| !is_still(problem, *step)).collect();
    let mean = |of: &dyn Fn(&AirState) -> f64| {
        blows.iter().map(|step| of(&states[*step])).sum::<f64>() / blows.len().max(1) as f64
    };
    let found = |(lock, seen): (usize, &SeenLock)| LockFound {
        name: problem.session.strands[seen.strand_idx].name.clone(),
        stiffness_n_m2: seen.strand.bending_stiffness_n_m2 * problem.scales(lock).stiffness,
        drag_scale: problem.scales(lock).drag,
        touches: solved.touches[lock],
    };
    PhysicalReport {
        warnings: warnings(problem),
        locks: problem.locks.iter().enumerate().map(found).collect(),
        n_modes: solved.air.modes.n_modes(),
        wake: mean(&AirState::wake),
        layer_m: mean(&AirState::layer_m),
        slip: mean(&AirState::slip),
        outside_mps: mean(&|state| state.outside().norm()),
        left_over: solved.left_over,
    }
}

/// Hair at rest that does not point down.
fn does_not_hang(problem: &Problem<'_>) -> Option<String> {
    problem.still?;
    let direction = |seen: &SeenLock| {
        let points_m = seen.lock.rest_points();
        (points_m.last()? - points_m[0]).try_normalize(0.0)
    };
    let mean = problem.locks.iter().filter_map(direction).sum::<Vec3>();
    let hangs = problem.rest_pose.rotation * mean.try_normalize(0.0)?;
    (hangs.dot(&problem.gravity_world) < 0.5 * problem.gravity_world.norm()).then(|| {
        format!(
            "found locks that point to [{:.1}, {:.1}, {:.1}] (world axes) at rest, expected them to hang down: which axis is up?",
            hangs.x, hangs.y, hangs.z
        )
    })
}

fn warnings(problem: &Problem<'_>) -> Vec<String> {
    let mut warnings = Vec::new();
    if problem.still.is_none() {
        warnings.push(
            "no still frames lie in the capture: the locks' shape without wind is unknown, their bending counts little".into(),
        );
    }
    warnings.extend(does_not_hang(problem));
    if problem.session.fans.is_empty() {
        warnings.push("the session names no fan: the wind outside is told from the locks alone".into());
    } else if problem.session.wind_start_frame.is_none() && problem.still.is_none() {
        warnings.push(
            "the session does not say when the wind starts: the fans are taken to be on throughout".into(),
        );
    }
    warnings
}

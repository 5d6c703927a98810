use super::draw::{Board, Dice};
use super::{Failure, Watched};
use crate::Stopwatch;
use tousle_core::NoProgress;
use tousle_direct::{DirectOptions, Drag, Stage, solve};
use tousle_edit::{DEFAULT_REACH_M, find_keys};

/// How long the answers to a moving hand take: each is the drag solved for again, from the last answer, and the wig run again.
#[derive(Clone, Debug, PartialEq)]
pub struct HandRow {
    /// The capture's name.
    pub capture: String,
    /// Each answer's time, in order of length: to solve for it, s.
    pub solve_secs: Vec<f64>,
    /// To run the strands that feel it, s.
    pub again_secs: Vec<f64>,
    /// Both together, s.
    pub answer_secs: Vec<f64>,
    /// How far the dragged points are from the hand, mm, in order of size.
    pub off_mm: Vec<f64>,
}

/// Drags by hand, and in how many moves each goes to its target.
const N_DRAGS: usize = 4;
const N_MOVES: usize = 10;

/// Pulls some points to where [`Board::drag`] has their targets, move by move, as the studio does. The first answer of each
/// drag, which begins from nothing, is not counted.
pub(super) fn follow(
    capture: &str,
    watched: &Watched<'_>,
    board: &Board<'_>,
    seed: u64,
) -> Result<HandRow, Failure> {
    let (world, simulator) = (watched.world, &watched.simulator);
    let (field, scene, groom) = (&world.field, &world.scene, &world.groom);
    let stage = Stage { simulator, field, scene, groom };
    let options = DirectOptions::for_quantity(field.quantity);
    let mut dice = Dice::new(seed);
    let (mut times, mut off_mm) = (Vec::<[f64; 3]>::new(), Vec::new());
    for k in 0..N_DRAGS {
        let edits = board.drag(&mut dice, k);
        let mut keys = find_keys(&edits, 1, groom, &watched.unedited)?;
        let (from_m, to_m) = (keys[0].unedited_m, keys[0].target_m);
        let mut traced = simulator.trace(&[], &NoProgress)?;
        let mut last = None;
        for share in (1..=N_MOVES).map(|k| k as f64 / N_MOVES as f64) {
            keys[0].target_m = from_m + (to_m - from_m) * share;
            let drag = Drag {
                name: edits.edits[0].name.clone(),
                edit_id: "hand".into(),
                muted: false,
                first_secs: edits.edits[0].first.secs(None).unwrap_or_default(),
                keys: keys.clone(),
                reach_m: DEFAULT_REACH_M,
            };
            let watch = Stopwatch::start();
            let solved = solve(&stage, &[], &drag, last.as_ref(), &options)?;
            let solve_secs = watch.stop().wall_secs;
            let watch = Stopwatch::start();
            traced = simulator.retrace(&traced, &solved.layers, &NoProgress)?;
            let again_secs = watch.stop().wall_secs;
            if last.is_some() {
                times.push([solve_secs, again_secs, solve_secs + again_secs]);
                off_mm.push(solved.outcome.keys[0].residual_mm.after);
            }
            last = Some(solved);
        }
    }
    let column = |k: usize| sorted(times.iter().map(|times| times[k]).collect());
    Ok(HandRow {
        capture: capture.to_owned(),
        solve_secs: column(0),
        again_secs: column(1),
        answer_secs: column(2),
        off_mm: sorted(off_mm),
    })
}

fn sorted(mut numbers: Vec<f64>) -> Vec<f64> {
    numbers.sort_by(f64::total_cmp);
    numbers
}

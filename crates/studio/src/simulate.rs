//! Simulates in the background: the newest request is run, those it overtook never are, and the window keeps drawing.

use crate::edits::{put, without};
use crate::solve::{Solved, Wanted, solve};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tousle_core::{Groom, Progress, StrandMotion};
use tousle_field::{FieldLayer, FieldSequence, Scene};
use tousle_sim::{Method, SimOptions, Traced};

/// What should be simulated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Request {
    /// The layers on the field.
    pub stack: Vec<FieldLayer>,
    /// An edit to be made into layers first.
    pub wanted: Option<Wanted>,
    /// Whether the hand is off the wanted edit. It is then made from nothing, and so is the same whatever was tried on the
    /// way; until then it begins from the last answer, which is sooner there.
    pub is_let_go: bool,
    /// An edit without which the motion is wanted too, by its id; a wanted edit always is one.
    pub without: Option<String>,
}

/// What came of a request.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Which request it answers, as [`Simulator::ask`] numbered them.
    pub number: u64,
    /// How long it took.
    pub took: Duration,
    /// The motion, or why there is none.
    pub result: Result<Simulated, String>,
}

/// A stack with the motion it gives.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// The layers; with the wanted one.
    pub stack: Vec<FieldLayer>,
    /// The motion with all of them.
    pub motion: Arc<StrandMotion>,
    /// The motion without the wanted edit, or the one that the request names.
    pub without: Option<Arc<StrandMotion>>,
    /// What became of the wanted edit.
    pub solved: Option<Solved>,
}

/// A thread that simulates one field and groom with changing layers.
#[derive(Debug)]
pub struct Simulator {
    shared: Arc<Shared>,
    answers: Receiver<Answer>,
    n_asked: u64,
    n_answered: u64,
}

#[derive(Debug, Default)]
struct Shared {
    inbox: Mutex<Inbox>,
    news: Condvar,
    done: AtomicU64,
    total: AtomicU64,
}

#[derive(Debug, Default)]
struct Inbox {
    request: Option<(u64, Request)>,
    quit: bool,
}

impl Simulator {
    /// Starts the thread. `wake` is called from it after each answer.
    pub fn start(
        field: Arc<FieldSequence>,
        scene: Arc<Scene>,
        groom: Arc<Groom>,
        wake: impl Fn() + Send + 'static,
    ) -> Self {
        let shared = Arc::new(Shared::default());
        let (sender, answers) = channel();
        let inbox = shared.clone();
        std::thread::spawn(move || {
            let options = SimOptions::of(Method::for_quantity(field.quantity));
            let ready = tousle_sim::Simulator::new(&field, &scene, &groom, &options).map_err(in_words);
            let (kept, shared) = (Vec::new(), &*inbox);
            Stage { ready, field: &field, scene: &scene, groom: &groom, warm: None, kept, shared }
                .run(&sender, wake);
        });
        Self { shared, answers, n_asked: 0, n_answered: 0 }
    }

    /// Asks for a simulation, in place of any that has not begun, and gives its number.
    pub fn ask(&mut self, request: Request) -> u64 {
        self.n_asked += 1;
        let mut inbox = self.shared.inbox.lock().unwrap_or_else(PoisonError::into_inner);
        inbox.request = Some((self.n_asked, request));
        self.shared.news.notify_one();
        self.n_asked
    }

    /// The newest answer since the last call.
    pub fn poll(&mut self) -> Option<Answer> {
        let mut newest = None;
        let ended = loop {
            match self.answers.try_recv() {
                Ok(answer) => newest = Some(answer),
                Err(ended) => break ended,
            }
        };
        // The thread ends before this does only if it panicked.
        if newest.is_none() && ended == TryRecvError::Disconnected && self.is_busy() {
            let result = Err(BROKE_DOWN.to_owned());
            newest = Some(Answer { number: self.n_asked, took: Duration::ZERO, result });
        }
        self.n_answered = newest.as_ref().map_or(self.n_answered, |answer| answer.number);
        newest
    }

    /// Whether the newest request is still to be answered.
    pub fn is_busy(&self) -> bool {
        self.n_answered < self.n_asked
    }

    /// The share of the running simulation that is done, 0 to 1.
    pub fn progress(&self) -> f32 {
        let total = self.shared.total.load(Ordering::Relaxed);
        if total == 0 { 0.0 } else { self.shared.done.load(Ordering::Relaxed) as f32 / total as f32 }
    }
}

impl Drop for Simulator {
    fn drop(&mut self) {
        self.shared.inbox.lock().unwrap_or_else(PoisonError::into_inner).quit = true;
        self.shared.news.notify_one();
    }
}

impl Progress for Shared {
    fn at(&self, done: u64, total: u64) {
        self.total.store(total, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
    }
}

/// What the thread works on.
struct Stage<'a> {
    /// The simulation that stays prepared, or why there can be none.
    ready: Result<tousle_sim::Simulator<'a>, String>,
    field: &'a FieldSequence,
    scene: &'a Scene,
    groom: &'a Groom,
    /// The last answer to a wanted edit, from which the next begins.
    warm: Option<tousle_direct::Solved>,
    /// Motions of some stacks, the newest last.
    kept: Vec<Traced>,
    shared: &'a Shared,
}

/// What is said of a thread that panicked; what it printed says where.
const BROKE_DOWN: &str =
    "the simulation broke down, by a fault of this program: save your edits and open the studio again";

/// How many motions are kept: with an edit and without it, before and after.
const N_KEPT: usize = 4;

impl Stage<'_> {
    fn run(mut self, answers: &Sender<Answer>, wake: impl Fn()) {
        while let Some((number, request)) = self.next() {
            let start = Instant::now();
            let result = self.answer(&request);
            // The window is gone when nobody listens.
            if answers.send(Answer { number, took: start.elapsed(), result }).is_err() {
                return;
            }
            wake();
        }
    }

    /// The newest request, once there is one; `None` if there will be no more.
    fn next(&self) -> Option<(u64, Request)> {
        let mut inbox = self.shared.inbox.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if inbox.quit {
                return None;
            }
            if let Some(request) = inbox.request.take() {
                return Some(request);
            }
            inbox = self.shared.news.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn answer(&mut self, request: &Request) -> Result<Simulated, String> {
        let stack = &request.stack;
        let Some(wanted) = &request.wanted else {
            let motion = self.motion(stack)?;
            let without = match &request.without {
                Some(id) => Some(self.motion(&without(stack, id))?),
                None => None,
            };
            return Ok(Simulated { stack: stack.clone(), motion, without, solved: None });
        };
        let replaced = wanted.replaces.as_deref();
        let others = replaced.map_or_else(|| stack.clone(), |id| without(stack, id));
        let before = self.motion(&others)?;
        let simulator = self.ready.as_ref().map_err(Clone::clone)?;
        let stage =
            tousle_direct::Stage { simulator, field: self.field, scene: self.scene, groom: self.groom };
        if request.is_let_go {
            self.warm = None;
        }
        let solved = solve(&stage, &others, &before, wanted, &mut self.warm).map_err(in_words)?;
        let stack = put(stack, replaced, solved.layers.clone());
        let motion = self.motion(&stack)?;
        Ok(Simulated { stack, motion, without: Some(before), solved: Some(solved) })
    }

    /// The groom's motion with these layers: a kept one, of which those strands are run again that feel the difference.
    fn motion(&mut self, stack: &[FieldLayer]) -> Result<Arc<StrandMotion>, String> {
        let ready = self.ready.as_ref().map_err(Clone::clone)?;
        let felt_by = self.kept.iter().map(|kept| kept.felt_by(stack).len());
        let traced = match felt_by.enumerate().min_by_key(|(_, n_strands)| *n_strands) {
            None => ready.trace(stack, self.shared).map_err(in_words)?,
            Some((at, 0)) => self.kept.remove(at),
            Some((at, _)) => ready.retrace(&self.kept[at], stack, self.shared).map_err(in_words)?,
        };
        let motion = traced.motion().clone();
        self.kept.push(traced);
        if self.kept.len() > N_KEPT {
            self.kept.remove(0);
        }
        Ok(motion)
    }
}

/// An error with all its causes, in one line.
fn in_words(error: impl std::error::Error + Send + Sync + 'static) -> String {
    format!("{:#}", anyhow::Error::new(error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::Asked;
    use crate::testing;
    use tousle_core::Vec3;
    use tousle_edit::{
        Action, ControlPoint, DEFAULT_EASE, Drag, Edit, KeyTime, Target, WindChange, WindEdit,
    };

    fn simulator() -> Simulator {
        let (scene, groom) = (Arc::new(testing::scene()), Arc::new(testing::groom()));
        Simulator::start(Arc::new(testing::field()), scene, groom, || ())
    }

    fn answer(simulator: &mut Simulator, number: u64) -> Answer {
        let end = Instant::now() + Duration::from_secs(60);
        while Instant::now() < end {
            match simulator.poll() {
                Some(answer) if answer.number == number => return answer,
                _ => std::thread::sleep(Duration::from_millis(1)),
            }
        }
        panic!("no answer in a minute");
    }

    fn lift() -> Wanted {
        let drag = Drag {
            strand: "A".into(),
            control_point: ControlPoint::Tip,
            target: Target::Offset(Vec3::new(0.03, 0.0, 0.01)),
            reach_m: 0.06,
            also: Vec::new(),
        };
        let edit = Edit {
            name: "lift".into(),
            first: KeyTime::Secs(0.2),
            second: KeyTime::Secs(0.7),
            ease: DEFAULT_EASE,
            muted: false,
            action: Action::Drag(drag),
        };
        Wanted { asked: Asked::Pull(edit), replaces: None }
    }

    #[test]
    fn only_the_newest_request_must_be_run() {
        let mut simulator = simulator();
        for _ in 0..50 {
            simulator.ask(Request::default());
        }
        assert!(simulator.is_busy());
        let last = answer(&mut simulator, 50);
        assert!(last.result.unwrap().without.is_none() && !simulator.is_busy());
    }

    #[test]
    fn a_wanted_edit_becomes_a_layer_and_moves_its_strand() {
        let mut simulator = simulator();
        let number = simulator.ask(Request { wanted: Some(lift()), ..Request::default() });
        let first = answer(&mut simulator, number).result.unwrap();
        let id = first.solved.unwrap().id;
        assert!(!first.stack.is_empty() && first.stack.iter().all(|layer| layer.edit_id() == id));
        let before = first.without.unwrap();
        let moved = |motion: &StrandMotion| (motion.strand(42, 0)[4][0] - before.strand(42, 0)[4][0]) * 1e3;
        assert!(moved(&first.motion) > 5.0, "{} mm", moved(&first.motion));

        let wanted = Wanted { replaces: Some(id.clone()), ..lift() };
        let request = Request { stack: first.stack, wanted: Some(wanted), ..Request::default() };
        let number = simulator.ask(request);
        let again = answer(&mut simulator, number).result.unwrap();
        assert!(again.stack.iter().all(|layer| layer.edit_id() == id));
        // The key is met to a millimeter both times; what the last answer was may show within that.
        let (cold_mm, warm_mm) = (moved(&first.motion), moved(&again.motion));
        assert!((cold_mm - warm_mm).abs() < 2.0, "{cold_mm} mm, then {warm_mm} mm");
        let request = Request { wanted: Some(lift()), is_let_go: true, ..Request::default() };
        let number = simulator.ask(request);
        let let_go = answer(&mut simulator, number).result.unwrap();
        assert_eq!(let_go.motion, first.motion);

        let mut muted = again.stack;
        muted.iter_mut().for_each(|layer| layer.muted = true);
        let number = simulator.ask(Request { stack: muted, without: Some(id), ..Request::default() });
        let quiet = answer(&mut simulator, number).result.unwrap();
        assert!(Arc::ptr_eq(&quiet.motion, &quiet.without.unwrap()));
        assert_eq!(quiet.motion, before);
    }

    #[test]
    fn a_gust_becomes_a_layer_and_blows() {
        let mut simulator = simulator();
        let gust = WindEdit {
            name: "gust".into(),
            first: KeyTime::Secs(0.2),
            last: KeyTime::Secs(0.9),
            ease: DEFAULT_EASE,
            muted: false,
            center_m: Vec3::new(0.1, 0.0, -0.08),
            reach_m: 0.2,
            change: WindChange::Gust { vector: 3.0 * Vec3::x() },
        };
        let wanted = Wanted { asked: Asked::Wind(gust), replaces: None };
        let number = simulator.ask(Request { wanted: Some(wanted), ..Request::default() });
        let simulated = answer(&mut simulator, number).result.unwrap();
        assert!(simulated.solved.unwrap().outcome.is_none() && simulated.stack.len() == 1);
        let tip = |motion: &StrandMotion| motion.strand(42, 0)[4][0];
        assert!(tip(&simulated.motion) > tip(&simulated.without.unwrap()) + 0.005);
    }

    /// A thread that panicked answers no more; whoever waits for it is told.
    #[test]
    fn a_simulator_that_broke_down_says_so() {
        let mut simulator = simulator();
        let (_, gone) = channel();
        simulator.answers = gone;
        let number = simulator.ask(Request::default());
        let error = answer(&mut simulator, number).result.unwrap_err();
        assert!(error.starts_with("the simulation broke down") && !simulator.is_busy(), "{error}");
    }

    #[test]
    fn what_cannot_be_done_is_said() {
        let mut simulator = simulator();
        let mut wanted = lift();
        let Asked::Pull(Edit { action: Action::Drag(drag), .. }) = &mut wanted.asked else {
            panic!("no drag")
        };
        drag.strand = "Z".into();
        let number = simulator.ask(Request { wanted: Some(wanted), ..Request::default() });
        let error = answer(&mut simulator, number).result.unwrap_err();
        assert!(error.contains("found no strand `Z`"), "{error}");
    }
}

//! Asking for simulations, and taking in what they give.

use super::Studio;
use crate::files;
use crate::simulate::{Answer, Request, Simulated, Simulator};
use crate::solve::Wanted;

/// What was asked of the simulator and not yet taken in.
#[derive(Debug)]
pub(super) struct Work {
    simulator: Simulator,
    /// The stack's revision and the chosen edit of the newest request that was about what is shown.
    asked: Option<(u64, Option<String>)>,
    /// The edit that is being made or changed.
    pending: Option<Wanted>,
    /// The request after whose answer the stack is taken into the document, and what undo will call it.
    commit: Option<(u64, String)>,
}

impl Work {
    pub(super) fn new(simulator: Simulator) -> Self {
        Self { simulator, asked: None, pending: None, commit: None }
    }

    pub(super) fn is_busy(&self) -> bool {
        self.simulator.is_busy() || self.commit.is_some()
    }

    pub(super) fn pending(&self) -> Option<&Wanted> {
        self.pending.as_ref()
    }
}

impl Studio {
    /// The share of the running simulation that is done, 0 to 1.
    pub(crate) fn progress(&self) -> f32 {
        self.work.simulator.progress()
    }

    /// Asks for an edit to be made, or made again. With a label it is taken into the document when it is there.
    pub(crate) fn want(&mut self, wanted: Wanted, label: Option<String>) {
        let number = self.work.simulator.ask(Request {
            stack: self.document.stack().to_vec(),
            wanted: Some(wanted.clone()),
            is_let_go: label.is_some(),
            without: None,
        });
        self.work.pending = Some(wanted);
        self.work.commit = label.map(|label| (number, label));
    }

    /// Forgets an edit that is being made.
    pub(crate) fn drop_pending(&mut self) {
        self.work.pending = None;
        self.work.commit = None;
        self.work.asked = None;
    }

    /// Takes in the newest answer.
    pub(super) fn work(&mut self) {
        let Some(Answer { number, took, result }) = self.work.simulator.poll() else { return };
        let commit = self.work.commit.take_if(|(awaited, _)| *awaited == number);
        match result {
            Ok(simulated) => {
                self.shown.took_secs = took.as_secs_f64();
                self.take_in(simulated, commit.map(|(_, label)| label));
            }
            Err(problem) => {
                self.complain(problem);
                self.drop_pending();
            }
        }
    }

    fn take_in(&mut self, simulated: Simulated, commit: Option<String>) {
        let Simulated { stack, motion, without, solved } = simulated;
        self.player.span(&motion.times_secs);
        self.shown.motion = Some(motion);
        self.shown.without = without;
        if let Some(solved) = solved {
            self.chosen_edit = Some(solved.id.clone());
            if let Some(outcome) = solved.outcome {
                self.shown.outcomes.insert(solved.id, outcome);
            }
        }
        self.shown.stack = stack;
        if let Some(label) = commit {
            self.work.pending = None;
            self.document.commit(&label, self.shown.stack.clone());
            // What was said on the way there holds no longer.
            self.notice = None;
            if let Some(mm) = self.chosen_edit.as_deref().and_then(|id| self.residual_mm(id)) {
                self.say(format!("{label}: {mm:.1} mm from its target"));
            }
            self.changed();
        }
    }

    /// Keeps what was changed beside the file, until it is saved.
    pub(crate) fn changed(&mut self) {
        let kept = if self.document.is_dirty() {
            files::autosave(&self.document)
        } else {
            files::discard_autosave(&self.document);
            Ok(())
        };
        if let Err(error) = kept {
            self.complain(format!("cannot autosave: {error:#}"));
        }
    }

    /// Asks for the motion of the stack as it is, unless that is what is shown or an edit is being made.
    pub(super) fn ask_for_what_is_shown(&mut self) {
        if self.work.pending.is_some() {
            return;
        }
        if self.chosen_edit.as_ref().is_some_and(|id| self.document.edit(id).is_none()) {
            self.chosen_edit = None;
        }
        let now = (self.document.revision(), self.chosen_edit.clone());
        if self.work.asked.as_ref() == Some(&now) {
            return;
        }
        self.work.simulator.ask(Request {
            stack: self.document.stack().to_vec(),
            without: self.chosen_edit.clone(),
            ..Request::default()
        });
        self.work.asked = Some(now);
    }
}

//! What a person sees while a command runs: bars on stderr, an error in words, an exit code.

use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt;
use std::process::ExitCode;
use tousle_core::Progress;
use tousle_pipeline::Watch;

/// How a command that did not fail ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All is well.
    Fine,
    /// The work is done and the answer is no: a file is not sound.
    Invalid,
    /// The work is done, and something that was asked for is missing from the result.
    WithLoss,
    /// Another program did the work and ended with this code.
    Ended(u8),
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        match outcome {
            Outcome::Fine => Self::SUCCESS,
            Outcome::Invalid => Self::from(1),
            Outcome::WithLoss => Self::from(3),
            Outcome::Ended(code) => Self::from(code),
        }
    }
}

/// Says on stderr what failed and, line by line, why.
pub fn print_error(error: &anyhow::Error) {
    eprintln!("error: {error}");
    for cause in error.chain().skip(1) {
        eprintln!("  because {cause}");
    }
}

/// Progress bars on stderr, one a stage; nothing where stderr is no terminal.
#[derive(Clone, Copy, Debug)]
pub struct Bars {
    /// Show nothing at all.
    pub quiet: bool,
}

impl Watch for Bars {
    fn stage(&self, name: &'static str) -> Box<dyn Progress + '_> {
        let bar = ProgressBar::with_draw_target(
            None,
            if self.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() },
        );
        let style = ProgressStyle::with_template(
            "{prefix:>10} {wide_bar:.cyan/dim} {percent:>3} % {rate:>18} {elapsed:>4} left {eta:>4}",
        );
        let unit = unit_of(name);
        let style = style.map(|style| {
            style.with_key("rate", move |state: &ProgressState, out: &mut dyn fmt::Write| {
                let _ = write!(out, "{} {unit}/s", HumanCount(state.per_sec() as u64));
            })
        });
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_prefix(name);
        Box::new(Bar(bar))
    }
}

/// What a stage counts, for its rate.
fn unit_of(stage: &str) -> &'static str {
    match stage {
        // A step of one strand.
        "simulate" | "check" => "steps",
        "follow" => "frames",
        _ => "",
    }
}

struct Bar(ProgressBar);

impl Progress for Bar {
    fn at(&self, done: u64, total: u64) {
        self.0.set_length(total);
        self.0.set_position(done);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

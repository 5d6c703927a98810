//! What a person sees while a command runs: bars on stderr, an error in words, an exit code.

use anyhow::Context;
use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;
use std::sync::OnceLock;
use tousle_core::Progress;
use tousle_fit::FitError;
use tousle_groom::GroomReadError;
use tousle_pipeline::{ConvertError, Watch};
use tousle_sim::SimError;

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

/// An argument that is wrong by itself or beside others, where the parser of the command line cannot know it.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct WrongArgument(pub String);

/// `bail!` with a [`WrongArgument`].
macro_rules! wrong {
    ($($words:tt)*) => { return Err($crate::ui::WrongArgument(format!($($words)*)).into()) };
}

/// Whether a command failed for its arguments alone.
pub fn is_wrong_argument(error: &anyhow::Error) -> bool {
    use SimError::{BadOption, OtherMethod, TooShort, Unstable};
    error.chain().any(|cause| {
        cause.is::<WrongArgument>()
            || matches!(cause.downcast_ref(), Some(ConvertError::Grid(_)))
            || matches!(cause.downcast_ref(), Some(GroomReadError::SameAxis { .. }))
            || matches!(
                cause.downcast_ref(),
                Some(BadOption { .. } | OtherMethod { .. } | TooShort { .. } | Unstable { .. })
            )
            || matches!(cause.downcast_ref(), Some(FitError::NotPositive { .. } | FitError::TooFast { .. }))
    })
}

/// What kept something from being said on stdout, first.
static UNSAID: OnceLock<io::Error> = OnceLock::new();

/// Says something on stdout. If nobody listens the command goes on: what it makes is made, and [`all_said`] tells at the end.
pub fn say(words: fmt::Arguments<'_>) {
    let mut out = io::stdout().lock();
    if UNSAID.get().is_none()
        && let Err(error) = out.write_fmt(words).and_then(|()| out.flush())
    {
        let _ = UNSAID.set(error);
    }
}

/// `print!` with [`say`].
macro_rules! say {
    ($($words:tt)*) => { $crate::ui::say(format_args!($($words)*)) };
}

/// `println!` with [`say`].
macro_rules! sayln {
    ($($words:tt)*) => { $crate::ui::say(format_args!("{}\n", format_args!($($words)*))) };
}

/// An outcome, if all could be said. A reader that has heard enough (`head`) is no failure.
pub fn all_said(outcome: Outcome) -> anyhow::Result<Outcome> {
    match UNSAID.get() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(anyhow::anyhow!("{error}")).context("cannot write to the standard output")
        }
        _ => Ok(outcome),
    }
}

/// Says a line on stderr. If nobody listens there, nobody can be told of it either: the command goes on.
pub fn note(words: fmt::Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{words}");
}

/// `eprintln!` with [`note`].
macro_rules! note {
    ($($words:tt)*) => { $crate::ui::note(format_args!($($words)*)) };
}

/// Says on stderr what failed and why.
pub fn print_error(error: &anyhow::Error) {
    note!("error: {}", error_lines(error));
}

/// What failed and, line by line, why.
pub fn error_lines(error: &anyhow::Error) -> String {
    let causes = error.chain().skip(1).map(|cause| format!("\n  because {cause}"));
    std::iter::once(error.to_string()).chain(causes).collect()
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

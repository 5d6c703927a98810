//! Accuracy scores against truth, and error against run time.
//!
//! [`score_motion`] and [`score_field`] are the figures that others use; [`Truth`] reads what they compare with.
//! [`sim_in_true_wind`] and [`sim::run`] judge the simulator alone, [`paper::run`] the whole 2008 method, [`measure::run`] the
//! measured wind. [`WorkPrecision`] shows what accuracy costs, [`mod@file`] what a file does, [`Table`] everything else. What a
//! part found is a [`Report`]: text, files and a page; [`index_html`] is the page over all of them.

pub mod direct;
pub mod extremes;
pub mod file;
pub mod paper;
pub mod sim;
pub mod worlds;

mod baselines;
mod capture;
mod clock;
mod index;
mod machine;
pub mod measure;
mod motion;
mod precision;
mod report;
mod stats;
mod table;
mod true_wind;
mod truth;
mod way;
mod wind;

pub(crate) use baselines::baselines_beside;
pub use baselines::{Baseline, never_moves, read_baselines};
pub use capture::{BenchError, CaptureFolder};
pub use clock::{Cost, Stopwatch};
pub use index::{Ending, PartRun, index_html};
pub use machine::when_and_where;
pub use motion::{
    LockScore, MotionScore, PointScore, SCORED_FROM_SECS, ScoreError, TrueMotion, score_motion,
};
pub use precision::{Curve, CurvePoint, WorkPrecision};
pub use report::{Report, Section};
pub use table::{Cell, Table};
pub(crate) use true_wind::sim_to_the_end;
pub use true_wind::{Judged, sim_in_field, sim_in_true_wind};
pub use truth::{Truth, TruthError};
pub use way::Way;
pub use wind::{
    FieldScore, FieldScoreError, ReferenceLock, TrueWind, VectorScore, resample_to_truth, score_field,
};

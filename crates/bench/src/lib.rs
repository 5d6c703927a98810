//! Accuracy scores against truth, and error against run time.
//!
//! [`score_motion`] and [`score_field`] are the figures that others use; [`Truth`] reads what they compare with.
//! [`WorkPrecision`] shows what accuracy costs, [`Table`] everything else.

mod baselines;
mod clock;
mod motion;
mod npy;
mod precision;
mod stats;
mod table;
mod truth;
mod wind;

pub use baselines::{Baseline, never_moves, read_baselines};
pub use clock::{Cost, Stopwatch};
pub use motion::{
    LockScore, MotionScore, PointScore, SCORED_FROM_SECS, ScoreError, TrueMotion, score_motion,
};
pub use npy::NpyError;
pub use precision::{Curve, CurvePoint, WorkPrecision};
pub use table::{Cell, Table};
pub use truth::{Truth, TruthError};
pub use wind::{
    FieldScore, FieldScoreError, ReferenceLock, TrueWind, VectorScore, resample_to_truth, score_field,
};

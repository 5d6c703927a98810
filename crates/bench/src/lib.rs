//! Accuracy scores against truth, and error against run time.
//!
//! [`score_motion`] and [`score_field`] are the figures that others use; [`Truth`] reads what they compare with.
//! [`WorkPrecision`] shows what accuracy costs, [`Table`] everything else.

mod clock;
mod motion;
mod precision;
mod stats;
mod table;
mod wind;

pub use clock::{Cost, Stopwatch};
pub use motion::{
    LockScore, MotionScore, PointScore, SCORED_FROM_SECS, ScoreError, TrueMotion, score_motion,
};
pub use precision::{Curve, CurvePoint, WorkPrecision};
pub use table::{Cell, Table};
pub use wind::{
    FieldScore, FieldScoreError, ReferenceLock, TrueWind, VectorScore, resample_to_truth, score_field,
};

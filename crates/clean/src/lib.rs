//! Cleans the locks' tracks: what is too far off to be hair refused, spikes cut, swapped labels mended, nameless pieces given back, ghosts refused,
//! gaps filled from the lock's own shape. Nothing is changed in silence: the report lists every change, and
//! every sample says whether a camera saw it.
//!
//! Every scale is estimated from the capture itself (how far its markers move between frames, how well a
//! lock's markers tell where a hidden one is), so that the same code serves quiet and violent hair.

mod clean;
mod counter;
mod far;
mod gaps;
mod interpolate;
mod learned;
mod lock;
mod motion;
mod pieces;
mod report;
mod shape;
mod spikes;
mod swaps;

pub use clean::{CleanError, CleanOptions, Cleaned, clean};
pub use report::{
    CleanReport, FarRefused, FillMethod, GapFilled, GhostRefused, MarkerTimeline, PieceGivenBack, SpikeCut,
    SwapMended, Unfilled,
};

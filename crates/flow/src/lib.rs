//! Air round a head: what flow is like before any hair was asked, and the modes in which it may differ.
//!
//! [`Stream`] turns the wind far away into the wind at a point: [`PotentialFlow`] round the head, slowed by the
//! layer at the scalp and by wakes. [`SwirlModes`] are the shapes of everything else. [`AirFlow`] is both over time, with how sure they are:
//! what `fit` finds and `raster` lays on a grid.
//!
//! *Invariant:* nothing here knows hair, markers or a grid of voxels.

mod air;
mod during;
mod exponential;
mod potential;
mod shelter;
mod stream;
mod swirl;

pub use air::{AirFlow, AirPlace, AirSpread, AirState, N_STREAM, WindAt};
pub use during::{AirPoint, AirSteps, STEPS_AT_ONCE};
pub use potential::PotentialFlow;
pub use stream::{Stream, StreamAt, StreamNow, StreamPart, StreamWind, stream_parts};
pub use swirl::{SwirlKernel, SwirlModes, SwirlPlace};

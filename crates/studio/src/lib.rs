//! The interactive editor: pull hair to where it should be at a key frame, and watch the motion answer.
//!
//! [`files::open`] gives a [`Document`](document::Document): a field, a groom, the stack of edits with undo.
//! [`Studio`] shows it. Between the two: [`camera`], [`player`], [`pick`], [`drag`], [`gust`]; [`simulate`] runs in a thread of
//! its own, and what makes a layer of a wanted edit stands alone in [`solve`].
//!
//! *Invariant:* all but `app`, `panels`, `shortcuts`, `theme` and `view` knows no window; all but `files` knows no
//! disk.

mod app;
pub mod camera;
pub mod document;
pub mod drag;
pub mod edits;
pub mod files;
pub mod gust;
pub mod history;
pub mod instant;
mod panels;
pub mod pick;
pub mod player;
pub mod shortcuts;
pub mod simulate;
pub mod solve;
#[cfg(test)]
mod testing;
mod theme;
pub mod view;

pub use app::{Look, Studio};

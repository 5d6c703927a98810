//! Self-contained pages: a capture, its field and the hair moving in it; how good a capture is.
//!
//! [`demo_page`] makes the page that `tousle demo` opens with. It needs no network and no other file: data,
//! style and script are inside, and its own content policy forbids the browser to load anything else.
//! [`quality_page`] shows what is missing in a capture, what cleaning changed, and how well the head was found.
//!
//! The building blocks are there for other pages (bench plots): [`Shell`] puts a page
//! together, [`figure_cards`] and [`Table`] show numbers, [`Timeline`] shows many tracks over time,
//! [`Plot`] draws curves as SVG that follows the
//! reader's light or dark theme, and [`Packed`] carries arrays of numbers into the page.
//!
//! *Invariant:* whatever text comes in (labels, names, notes) goes through one escape on its way out; no
//! string of a session or a groom can become markup or script.

mod demo;
mod figure;
mod html;
mod pack;
mod plot;
mod quality;
mod shell;
mod table;
mod timeline;

pub use demo::{Compared, DemoPage, FileEntry, HairView, PageError, StageLine, demo_page};
pub use figure::{Figure, figure_cards};
pub use html::{bytes_text, decimals, escape, json_for_script, short};
pub use pack::Packed;
pub use plot::{Axis, PLOT_STYLE, Plot, Scale, Series, SeriesStyle};
pub use quality::{QualityPage, quality_page};
pub use shell::Shell;
pub use table::{Cell, Column, Table};
pub use timeline::{Mark, Timeline, TimelineEvent, TimelineGroup, TimelineRow};

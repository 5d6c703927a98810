//! Groom files to a [`Groom`](tousle_core::Groom): one curve a strand, in head space, with what each is made of.
//!
//! [`read_groom`] tells the format from the bytes, reads curves, places them on the head as [`GroomOptions`] say
//! and fills in what the file does not know. Placement is explicit: a format that states no unit or up axis is
//! refused until the caller gives one. Every value that nobody gave is listed in `Groom::assumed`, everything
//! that was left out or changed in [`ReadGroom::warnings`].
//!
//! | format | states | |
//! |---|---|---|
//! | JSON | meters, head axes, properties | only `rest_curve_m` must be there |
//! | `.hair` (Cem Yuksel) | neither unit nor up axis | |
//! | `.data`, `.bin` (USC-HairSalon) | neither | |
//! | `.ply` with strands (`CT2Hair`) | neither | |
//! | USD text (`.usda`) with `BasisCurves` | both | transforms resolved, references and variants not |
//! | Alembic (`.abc`, Ogawa) with curves | neither | transforms resolved |
//!
//! A property may be missing (`defaults` says what stands for it), one number a strand, or, except for the damping, one
//! for each of its points (`along` says what then becomes of the others): a list in JSON; a primvar of the same name in
//! USD, `constant`, `uniform`, `vertex` or `varying`. Drawn widths by the point count as well: the thickness array of
//! `.hair`, `widths` of USD (before it a primvar of that name) and Alembic.
//!
//! ```
//! let json = br#"{"note": "any text", "strands": [
//!     {"name": "B01", "length_m": 0.11, "linear_density_kg_per_m": 0.0012, "lock_width_m": 0.0044,
//!      "bending_stiffness_N_m2": 7.5e-07, "internal_damping_time_s": 0.016,
//!      "rest_curve_m": [[0.01, 0.02, 0.09], [0.02, 0.03, 0.05], [0.02, 0.03, -0.01]]}]}"#;
//! let read = tousle_groom::read_groom(json, &tousle_groom::GroomOptions::default())?;
//! assert_eq!(read.groom.counts(), [3]);
//! assert!(read.groom.assumed.is_empty() && read.warnings.is_empty());
//! # Ok::<(), tousle_groom::GroomReadError>(())
//! ```
//!
//! *Invariant:* stages see bytes and values; nothing here opens a file.

mod along;
mod defaults;
mod error;
mod format;
mod options;
mod placement;
mod raw;
mod read;
mod summary;

pub use error::GroomReadError;
pub use format::GroomFormat;
pub use options::{GroomOptions, HeadShape, Placement};
pub use read::{ReadGroom, read_groom};
pub use summary::{GroomSummary, inspect_groom};

//! USD's text form: prims, their transforms over time, and a head's poses.
//!
//! An own parser of the text form. The one crate that reads USD (`openusd`) needs a newer compiler than this
//! workspace promises and brings composition and the binary form along; one layer needs a page of grammar. Not
//! followed: references, payloads, sublayers, inherits, variants; where a layer has them, [`Layer::warnings`] says
//! so. [`read_poses`] reads a head's motion; `tousle-groom` reads curves.
//!
//! Source: Pixar, "Usda file format specification"; `UsdGeomXformable` for the meaning of transforms.
//!
//! *Invariant:* any bytes give an answer; nothing here opens a file.

mod error;
mod layer;
mod lexer;
mod parser;
mod poses;
mod scale;
mod xform;

pub use error::UsdaError;
pub use layer::{Layer, Prim, Property, Specifier, Value};
pub use parser::parse;
pub use poses::{PoseOptions, ReadPoses, read_poses};
pub use scale::{meters_per_unit, time_codes_per_second, up_axis};
pub use xform::{Local, is_animated, local};

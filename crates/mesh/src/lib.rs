//! A shot's own body: a triangle mesh becomes a solid that hair can touch.
//!
//! [`read_mesh`] gives the triangles in head space, [`enclose`] the [`Solid`](tousle_core::Solid) that the simulator asks for gaps.
//!
//! *Invariant:* the simulator does not depend on this crate: what it takes to measure a mesh is only built where
//! meshes are read.

mod enclose;
mod error;
mod read;

pub use enclose::{EDGE_M, Enclosed, Region, enclose};
pub use error::MeshError;
pub use read::{Mesh, MeshOptions, read_mesh};

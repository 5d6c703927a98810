//! Many strands follow the motion of a few.
//!
//! Where a groom is dense, a strand moves nearly as its neighbors do. [`choose`] picks guides among the strands and
//! says how much each of the others listens to which; somebody simulates [`Guides::groom`]; [`follow`] gives the
//! motion of all. [`Guides::sample`] and [`compare`] tell how far that is from simulating them.
//!
//! A strand that follows keeps its root, the length of every stick, and at rest its own rest shape: guides give it
//! turns, not places. A guide gets its own motion, to the bit.
//!
//! *Invariant:* this crate has never heard of wind; it sees a groom and a motion.
//!
//! ```
//! # use tousle_core::{Along, Groom, NoProgress, Strand, StrandMotion, Vec3};
//! # let strand = |x: f64| Strand {
//! #     name: x.to_string(), rest_curve_m: vec![Vec3::new(x, 0.0, 0.0), Vec3::new(x, 0.0, -0.1)], length_m: 0.1,
//! #     linear_density_kg_per_m: 1e-3, lock_width_m: 4e-3, bending_stiffness_n_m2: 1e-6, internal_damping_secs: 0.0,
//! #     along: Along::default(), holds_style: false };
//! # let groom = Groom { strands: vec![strand(0.0), strand(0.01), strand(0.02)], assumed: Vec::new() };
//! let guides = tousle_guide::choose(&groom, 1)?;
//! assert_eq!(guides.strands(), [1]);
//! // The guide's tip goes forward; so do the others'.
//! let motion = StrandMotion {
//!     counts: guides.groom(&groom).counts(),
//!     times_secs: vec![0.0],
//!     positions_m: vec![[0.01, 0.0, 0.0], [0.11, 0.0, 0.0]],
//! };
//! let all = tousle_guide::follow(&groom, &guides, &motion, &NoProgress)?;
//! assert!((all.strand(0, 2)[1][0] - 0.12).abs() < 1e-7);
//! # Ok::<(), tousle_guide::GuideError>(())
//! ```

mod alike;
mod check;
mod choose;
mod error;
mod follow;
mod guides;
mod keep_out;
mod nearest;
mod outline;
mod put;
mod turns;
mod weights;

pub use check::{FollowError, compare};
pub use choose::choose;
pub use error::GuideError;
pub use follow::follow;
pub use guides::Guides;
pub use keep_out::keep_out;

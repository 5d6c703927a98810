//! The mechanics of one lock: its shape at rest, bending, drag, contact. Measuring and simulating share it.
//!
//! [`Lock`] is a strand as a chain of sticks with its mass and its joints; [`rest_state`] says how it carries
//! its weight when it hangs still, judged by its [`Style`], and [`hold_rest`] makes it stay there; [`DragLaw`] is what the air
//! does to it, [`Surface`] what it can touch.
//!
//! *Invariant:* nothing here steps through time or knows a grid.

mod contact;
mod drag;
mod hold;
mod likely;
mod lock;
mod natural;
mod nnls;
mod rest;
mod touching;
mod turn;

pub use contact::{Gap, Surface, SurfaceShape};
pub use drag::{Drag, DragLaw};
pub use hold::{Support, hold_rest};
pub use likely::{Bears, Likely, Style, Touch, Twist};
pub use lock::Lock;
pub use natural::{Fall, Natural};
pub use nnls::nonnegative_least_squares;
pub use rest::{Bearing, Rest, joint_torques, rest_state};
pub use turn::{ANGLE_OVER_SINE, shortest_rotation, shortest_turn, torque_to_load, turned};

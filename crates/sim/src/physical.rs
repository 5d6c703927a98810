//! The method `physical`: an inextensible elastic rod a strand, all its joints solved at once (`docs/equations.md`).
//!
//! A strand is a chain of rigid sticks. Each joint bends and twists towards its natural turn; mass sits at the points.
//! An implicit step asks for the turns of all sticks at which the forces at its end balance the inertia. What everything
//! further out does to a stick is a quadratic form of its near end's displacement and of its own turn, so a sweep from the tip
//! inwards and one back solve all joints exactly, at a cost that grows with the number of sticks and no faster.
//!
//! Strands are prepared and put side by side ([`build`], [`batch`]) and stepped ([`implicit`], [`explicit`], [`adaptive`])
//! by the sweeps of [`newton`].

mod adaptive;
mod batch;
mod build;
mod contact;
mod drag;
mod explicit;
mod implicit;
mod link;
mod mechanics;
mod newton;
mod scene;
mod stability;

pub(crate) use drag::STILL2;
pub(crate) use mechanics::Physical;

//! Mechanics of one lock: shape, bending, drag, contact; the same for measuring and for simulating.

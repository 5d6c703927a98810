use tousle_core::Quantity;

/// Which terms of the equations a run has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    pub quantity: Quantity,
    pub head_movement: bool,
}

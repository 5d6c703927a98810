use tousle_core::Quantity;
use tousle_field::{FieldLayer, GridSpec, Scene};

/// A field that is to be merged: all but its steps.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// What it is called in messages: its file.
    pub name: &'a str,
    /// What its vectors are.
    pub quantity: Quantity,
    /// Where its voxels are.
    pub grid: GridSpec,
    /// Time of its first step on its own clock, s.
    pub start_secs: f64,
    /// Steps a second.
    pub rate_hz: f64,
    /// How many steps it has, at least one. A single one stands for all times.
    pub n_steps: u64,
    /// Its edits.
    pub layers: &'a [FieldLayer],
    /// What a simulator needs besides.
    pub scene: &'a Scene,
    /// What is added to its times to have them on the common clock, s.
    pub offset_secs: f64,
}

/// How fields are merged.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MergeOptions {
    /// From when to when the merged field goes.
    pub span: Span,
    /// Steps a second; the highest rate of the inputs if `None`.
    pub rate_hz: Option<f64>,
    /// How far heads may be from one another in their path since the still pose, and bodies in their shapes, m.
    /// The larger it is, the more a voxel of one capture is another place of the body than the same voxel of another.
    pub tolerance_m: f64,
    /// How far heads may be turned from one another, rad: wind is kept in head axes, so 1 degree turns it by 2 %.
    pub tolerance_rad: f64,
}

impl Default for MergeOptions {
    fn default() -> Self {
        Self { span: Span::All, rate_hz: None, tolerance_m: 0.01, tolerance_rad: 2_f64.to_radians() }
    }
}

/// From when to when a merged field goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Span {
    /// From the first step of any input to the last of any.
    #[default]
    All,
    /// Only while all inputs have steps.
    Common,
}

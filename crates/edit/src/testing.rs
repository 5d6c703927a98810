//! What the tests of several files need.

use tousle_core::Vec3;
use tousle_field::{Ease, FieldLayer, LayerOrigin};

/// A layer of the first second that a drag left, without handles.
pub(crate) fn layer(id: &str) -> FieldLayer {
    FieldLayer {
        id: id.into(),
        name: id.to_uppercase(),
        muted: false,
        first_secs: 0.0,
        last_secs: 1.0,
        ease: Ease { rise: 0.5, fall: 0.5 },
        handles: Vec::new(),
        reshape: None,
        origin: LayerOrigin::Drag {
            strand: "A".into(),
            control_point: 1,
            target_m: Vec3::zeros(),
            method: "paper".into(),
        },
    }
}

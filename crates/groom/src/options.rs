use tousle_core::{Attachment, Axis, Body, LengthUnit, Shape, Vec3};

/// What a groom file may not say, and where its hair goes.
///
/// Axes and unit come first, [`Placement`] after them: positions are turned so that up is up and forward is
/// forward, made meters, then placed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct GroomOptions {
    /// The unit of the file's positions. Needed where the file states none, unless the groom is fitted to the
    /// head; overrules the file, with a warning, where it states another.
    pub unit: Option<LengthUnit>,
    /// The file's up axis. Needed where the file states none; overrules the file, with a warning.
    pub up_axis: Option<Axis>,
    /// The file's axis along which the nose points. No file states it. Without it x is forward where z is up (as
    /// in head space), z where y is up (as in most character tools), y where x is up; and the groom says so.
    pub forward: Option<Axis>,
    /// Where the hair goes.
    pub placement: Placement,
}

/// Where a groom's hair goes, once its axes are the head's and its unit is the meter.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Placement {
    /// Where it is: the file's origin is the head's center.
    #[default]
    AsIs,
    /// Where its roots lie on a head: the one scale and shift that bring them closest to the ellipsoid. The
    /// file's own unit no longer matters.
    FitToHead(HeadShape),
}

/// An ellipsoid that stands for a head, axes along the head's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadShape {
    /// Its center, head space, m.
    pub center_m: Vec3,
    /// Half the length of each axis, m, > 0.
    pub half_axes_m: Vec3,
}

impl HeadShape {
    /// The head that a groom can be fitted to: a body's first ellipsoid that moves with it.
    pub fn of_body(body: &Body) -> Option<Self> {
        let of_head = body.colliders.iter().filter(|c| c.attachment == Attachment::Head);
        let mut ellipsoids = of_head.filter_map(|c| match &c.shape {
            Shape::Ellipsoid { center_m, half_axes_m } => {
                Some(Self { center_m: *center_m, half_axes_m: *half_axes_m })
            }
            Shape::Capsule { .. } | Shape::Mesh(_) => None,
        });
        ellipsoids.next()
    }
}

use tousle_core::UpAxis;
use tousle_field::Scene;

/// How a motion becomes USD.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct UsdOptions<'a> {
    /// What the hair is made of.
    pub geometry: HairGeometry,
    /// How curves run between control points.
    pub curve_type: CurveType,
    /// Widths are the groom's times this. 1 by default.
    pub width_scale: f64,
    /// How the head moves and what hair can touch; `None` for the hair alone, in head space.
    pub scene: Option<&'a Scene>,
    /// Whether the hair is carried by the scene's head poses into the world, or stays in head space.
    pub in_world: bool,
    /// Which axis of that world is up; USD knows y and z. In head space z is up. Z by default.
    pub world_up: UpAxis,
    /// Whether the scene's colliders are drawn, as guides.
    pub with_body: bool,
    /// Frames of the motion a second, which become time codes: as exact as they were asked for. `None`: what the frames' times
    /// say, and 24 of a motion of one frame.
    pub rate_hz: Option<f64>,
}

/// What strands are drawn as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HairGeometry {
    /// `BasisCurves`, one a strand.
    #[default]
    Curves,
    /// One mesh of reed-shaped ribbons, as the paper drew them: narrow at the root, pointed at the tip, with
    /// texture coordinates.
    Reeds,
    /// Both, side by side.
    Both,
}

/// How a curve runs between control points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CurveType {
    /// Straight segments: what was simulated, and nothing else.
    #[default]
    Linear,
    /// Through every control point smoothly; ends are pinned.
    CatmullRom,
}

impl Default for UsdOptions<'_> {
    fn default() -> Self {
        Self {
            geometry: HairGeometry::default(),
            curve_type: CurveType::default(),
            width_scale: 1.0,
            scene: None,
            in_world: false,
            world_up: UpAxis::Z,
            with_body: false,
            rate_hz: None,
        }
    }
}

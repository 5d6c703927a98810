//! What stands for what a session does not say, and why.
//!
//! None of these comes from a capture: they are what hair, heads and rooms are like. Each value that is used is
//! listed in [`tousle_core::Session::assumed`].

use tousle_core::{Assumption, Attachment, Collider, Fan, Shape, StrandSpec, Vec3, median_high};

/// A marker's mass, mg: a retro-reflective half sphere of 3 to 4 mm with its tape.
pub(super) const MARKER_MASS_MG: f64 = 20.0;

pub(super) const MARKER_MASS: (&str, &str) = ("20 mg", "a reflecting ball of 3 mm and its glue");

/// Mass per length of a lock, kg/m: about 400 hairs of 70 µm, keratin being 1.3 g/cm³ (5 mg/m a hair).
const LOCK_DENSITY_KG_PER_M: f64 = 2.0e-3;

pub(super) const DENSITY: (&str, &str) =
    ("2 g/m at 5 mm width, as the width squared", "some 400 hairs of 70 µm, 5 mg/m each");

/// Width of such a lock, m: hair fills about 8 % of a loose lock.
const LOCK_WIDTH_M: f64 = 5.0e-3;

pub(super) const WIDTH: (&str, &str) =
    ("5 mm at 2 g/m, as the root of the density", "hair fills about 8 % of a loose lock");

pub(super) fn assumption(what: &str, value: &str, why: &str) -> Assumption {
    Assumption { what: what.into(), value: value.into(), why: why.into() }
}

/// Density, kg/m, and width, m, of a lock of which one or neither is known: equally loose whatever its size.
pub(super) fn lock(density: Option<f64>, width: Option<f64>) -> (f64, f64) {
    let density_of = |width: f64| LOCK_DENSITY_KG_PER_M * (width / LOCK_WIDTH_M) * (width / LOCK_WIDTH_M);
    let width_of = |density: f64| LOCK_WIDTH_M * (density / LOCK_DENSITY_KG_PER_M).sqrt();
    match (density, width) {
        (Some(density), Some(width)) => (density, width),
        (Some(density), None) => (density, width_of(density)),
        (None, Some(width)) => (density_of(width), width),
        (None, None) => (LOCK_DENSITY_KG_PER_M, LOCK_WIDTH_M),
    }
}

/// A lock whose last marker was measured past its tip.
pub(super) fn longer_lock(path: &str, last_m: f64) -> Assumption {
    let value = format!("{:.1} mm", last_m * 1e3);
    assumption(path, &value, "the last marker was measured there: the lock reaches at least so far")
}

pub(super) fn name() -> (String, Assumption) {
    ("session".into(), assumption("name", "session", "a name for reports"))
}

/// Dry air at 20 °C and 1013 hPa, kg/m³.
pub(super) fn air_density() -> (f64, Assumption) {
    (1.2, assumption("air_density_kg_m3", "1.2 kg/m³", "dry air at 20 °C and 1013 hPa"))
}

/// Hair along skin or hair.
pub(super) fn friction() -> (f64, Assumption) {
    (
        0.25,
        assumption("friction", "0.25", "measured coefficients of hair on skin and on hair lie at 0.1 to 0.4"),
    )
}

pub(super) fn fans() -> (Vec<Fan>, Assumption) {
    (
        Vec::new(),
        assumption("fans", "none", "the session names no fan: the air far from hair is taken to be still"),
    )
}

pub(super) fn elevation(fan_idx: usize) -> (f64, Assumption) {
    let what = format!("fans[{fan_idx}].from_elevation_deg");
    (0.0, assumption(&what, "0°", "a fan is mostly set to blow level"))
}

/// An adult's head, neck and shoulders, the head scaled to the roots.
///
/// Head 194 by 151 mm (ANSUR II, men and women averaged), 220 mm from crown to chin; neck girth 350 mm;
/// acromion to acromion 390 mm, about 210 mm below the head's center.
pub(super) fn colliders(strands: &[StrandSpec]) -> (Vec<Collider>, Assumption) {
    let half_axes = Vec3::new(0.097, 0.0755, 0.11);
    let scale = scale_to_roots(strands, half_axes);
    let shape = |shape, name: &str, attachment| Collider { name: name.into(), shape, attachment };
    let capsule =
        |a: [f64; 3], b: [f64; 3], radius_m: f64| Shape::Capsule { a_m: a.into(), b_m: b.into(), radius_m };
    let head = Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: half_axes * scale };
    let neck = capsule([-0.015, 0.0, -0.07], [-0.02, 0.0, -0.19], 0.056);
    let shoulders = capsule([-0.02, -0.14, -0.28], [-0.02, 0.14, -0.28], 0.07);
    let [x, y, z] = (half_axes * (2e3 * scale)).into();
    let value = format!("head {x:.0} x {y:.0} x {z:.0} mm, neck of radius 56 mm, shoulders of radius 70 mm");
    (
        vec![
            shape(head, "head", Attachment::Head),
            shape(neck, "neck", Attachment::Head),
            shape(shoulders, "shoulders", Attachment::Torso),
        ],
        assumption(
            "colliders",
            &value,
            "an adult's mean measures, the head scaled so that the roots lie on it",
        ),
    )
}

/// How much larger a head is than the mean one: its roots lie on the scalp.
fn scale_to_roots(strands: &[StrandSpec], half_axes: Vec3) -> f64 {
    let scales = strands.iter().map(|s| s.root_m.component_div(&half_axes).norm()).collect();
    // Heads of adults vary by a tenth; roots that say otherwise are not where hair grows.
    median_high(scales).map_or(1.0, |scale| scale.clamp(0.8, 1.25))
}

/// The point about which the head turns: between the first two vertebrae, where it turns and nods most.
///
/// They lie about 15 mm below the skull's base, and the base is where the neck's axis leaves the head.
pub(super) fn pivot(colliders: &[Collider]) -> (Vec3, Assumption) {
    const BELOW_SKULL_M: f64 = 0.015;
    let neck = colliders.iter().find_map(|c| match (&*c.name, &c.shape) {
        ("neck", Shape::Capsule { a_m, b_m, .. }) => Some((*a_m, (b_m - a_m).try_normalize(1e-6)?)),
        _ => None,
    });
    let half_axes = colliders.iter().find_map(|c| match &c.shape {
        Shape::Ellipsoid { half_axes_m, .. } => Some(*half_axes_m),
        Shape::Capsule { .. } | Shape::Mesh(_) => None,
    });
    let half_axes = half_axes.unwrap_or(Vec3::new(0.097, 0.0755, 0.11));
    let (start, along) = neck.unwrap_or((Vec3::new(-0.015, 0.0, 0.0), -Vec3::z()));
    let pivot_m = start + along * (exit_distance(start, along, half_axes) + BELOW_SKULL_M);
    let [x, y, z] = (pivot_m * 1e3).into();
    let value = format!("[{x:.1}, {y:.1}, {z:.1}] mm");
    let why = "on the neck's axis, 15 mm below where it leaves the head: between the first two vertebrae";
    (pivot_m, assumption("head_pivot_mm", &value, why))
}

/// How far along a ray the surface of an ellipsoid about the origin is last met; 0 if it never is.
fn exit_distance(start: Vec3, along: Vec3, half_axes: Vec3) -> f64 {
    let (s, d) = (start.component_div(&half_axes), along.component_div(&half_axes));
    let (a, b, c) = (d.dot(&d), s.dot(&d), s.dot(&s) - 1.0);
    let discriminant = b * b - a * c;
    if discriminant < 0.0 { 0.0 } else { ((discriminant.sqrt() - b) / a).max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_is_equally_loose_whatever_its_size() {
        assert_eq!(lock(None, None), (2.0e-3, 5.0e-3));
        assert_eq!(lock(Some(8.0e-3), None), (8.0e-3, 10.0e-3));
        assert!((lock(None, Some(10.0e-3)).0 - 8.0e-3).abs() < 1e-15);
        assert_eq!(lock(Some(1.0), Some(2.0)), (1.0, 2.0));
    }

    #[test]
    fn the_pivot_lies_below_the_skull() {
        let head = Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: Vec3::repeat(0.1) };
        let neck = Shape::Capsule {
            a_m: Vec3::new(0.0, 0.0, -0.05),
            b_m: Vec3::new(0.0, 0.0, -0.2),
            radius_m: 0.05,
        };
        let collider =
            |name: &str, shape| Collider { name: name.into(), shape, attachment: Attachment::Head };
        let (pivot_m, _) = pivot(&[collider("head", head), collider("neck", neck)]);
        assert!((pivot_m - Vec3::new(0.0, 0.0, -0.115)).norm() < 1e-12);
    }
}

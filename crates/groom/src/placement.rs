//! From the file's axes and unit to head space and meters.

use nalgebra::{Matrix3, Matrix4, Vector4};
use tousle_core::{Assumption, Axis, HeadAxes, LengthUnit, Vec3};

use crate::error::GroomReadError;
use crate::format::GroomFormat;
use crate::options::{GroomOptions, HeadShape, Placement};
use crate::raw::RawGroom;

/// Strands in head space, and what was assumed to get there. Points, lengths and drawn widths are meters.
pub(crate) struct Placed {
    pub(crate) raw: RawGroom,
    pub(crate) assumed: Vec<Assumption>,
}

/// Turns, scales and shifts a groom to where the options want it.
pub(crate) fn place(
    mut raw: RawGroom,
    format: GroomFormat,
    options: &GroomOptions,
    warnings: &mut Vec<String>,
) -> Result<Placed, GroomReadError> {
    let mut assumed = Vec::new();
    let head_from_file = axes(&raw, format, options, &mut assumed, warnings)?;
    transform(&mut raw, |p| head_from_file * p, 1.0);
    match options.placement {
        Placement::AsIs => {
            let unit_m = unit(&raw, format, options, warnings)?;
            transform(&mut raw, |p| p * unit_m, unit_m);
        }
        Placement::FitToHead(head) => {
            let fit = fit_to_head(&raw, &head)?;
            transform(&mut raw, |p| p * fit.scale + fit.shift_m, fit.scale);
            warnings.push(format!(
                "fitted to the head: 1 in the file is {:.6} m, shifted by {:.4?} m; roots lie {:.1} mm from it (rms)",
                fit.scale,
                fit.shift_m.as_slice(),
                fit.rms_m * 1e3
            ));
        }
    }
    Ok(Placed { raw, assumed })
}

fn transform(raw: &mut RawGroom, of_point: impl Fn(Vec3) -> Vec3, scale: f64) {
    for strand in &mut raw.strands {
        strand.points.iter_mut().for_each(|p| *p = of_point(*p));
        strand.length = strand.length.map(|l| l * scale);
        strand.drawn_width = strand.drawn_width.map(|w| w * scale);
    }
}

/// Meters in the file's unit.
fn unit(
    raw: &RawGroom,
    format: GroomFormat,
    options: &GroomOptions,
    warnings: &mut Vec<String>,
) -> Result<f64, GroomReadError> {
    match (raw.unit_m, options.unit.map(LengthUnit::meters)) {
        (None, None) => {
            let pass = "a unit (mm, cm, m or in), or fit the groom to the head";
            Err(GroomReadError::NotStated { format, what: "unit", pass })
        }
        (Some(stated), None) => Ok(stated),
        (None, Some(given)) => Ok(given),
        (Some(stated), Some(given)) => {
            if (stated - given).abs() > 1e-9 * given {
                warnings.push(format!("the file's unit is {stated} m; the given {given} m holds"));
            }
            Ok(given)
        }
    }
}

/// The rotation from the file's axes to the head's.
fn axes(
    raw: &RawGroom,
    format: GroomFormat,
    options: &GroomOptions,
    assumed: &mut Vec<Assumption>,
    warnings: &mut Vec<String>,
) -> Result<Matrix3<f64>, GroomReadError> {
    let stated = raw.up_axis.map(Axis::from);
    let Some(up) = options.up_axis.or(stated) else {
        let pass = "the file's up axis (x, y, z, -x, -y or -z)";
        return Err(GroomReadError::NotStated { format, what: "up axis", pass });
    };
    if let Some(stated) = stated.filter(|stated| *stated != up) {
        warnings.push(format!("the file's up axis is {stated}; the given {up} holds"));
    }
    let mut axes = HeadAxes::usual(up);
    match options.forward {
        Some(forward) => axes.forward = forward,
        None if raw.is_head_space => {}
        None => assumed.push(Assumption {
            what: "forward axis".to_owned(),
            value: axes.forward.to_string(),
            why: format!("no groom file states it; this is the usual one where {up} is up"),
        }),
    }
    axes.head_from_file().ok_or(GroomReadError::SameAxis { up, forward: axes.forward })
}

/// One scale and one shift, and how far from the head the roots then are.
struct HeadFit {
    scale: f64,
    shift_m: Vec3,
    rms_m: f64,
}

/// The scale and shift that bring the roots closest to an ellipsoid.
///
/// Divided by the ellipsoid's half axes, the head is a unit sphere and the roots lie on a sphere of unknown
/// center c and radius r, so that |q|² = 2 c·q + (r² − |c|²): linear in four unknowns (Kåsa 1976). A few steps of
/// Gauss-Newton on the distances |q − c| − r then take away that method's pull towards small spheres where roots
/// cover only a cap.
fn fit_to_head(raw: &RawGroom, head: &HeadShape) -> Result<HeadFit, GroomReadError> {
    let bad = |found: String, expected| Err(GroomReadError::Placement { found, expected });
    if !head.half_axes_m.iter().all(|a| a.is_finite() && *a > 0.0) {
        return bad(format!("half axes of {:?} m", head.half_axes_m.as_slice()), "numbers above 0");
    }
    let roots = raw.strands.iter().filter_map(|s| s.points.first());
    let mut q: Vec<Vec3> = roots.map(|p| p.component_div(&head.half_axes_m)).collect();
    let n = q.len() as f64;
    let mean = q.iter().sum::<Vec3>() / n;
    let size = q.iter().map(|p| (p - mean).norm()).fold(0.0, f64::max);
    let apart = size.is_finite() && size > 0.0;
    q.iter_mut().for_each(|p| *p = (*p - mean) / size);
    let sphere = if apart { fit_sphere(&q) } else { None };
    let Some((center, radius)) = sphere else {
        let found = format!("{} roots that lie on no sphere (too few, or in one plane)", q.len());
        return bad(found, "roots all over a scalp");
    };
    let rms = libm::sqrt(q.iter().map(|p| distance(p, &center, radius)).map(|d| d * d).sum::<f64>() / n);
    let scale = 1.0 / (radius * size);
    let shift = -(center * size + mean) * scale;
    Ok(HeadFit {
        scale,
        shift_m: head.center_m + shift.component_mul(&head.half_axes_m),
        rms_m: rms / radius * head.half_axes_m.mean(),
    })
}

fn distance(p: &Vec3, center: &Vec3, radius: f64) -> f64 {
    (p - center).norm() - radius
}

/// Center and radius of the sphere closest to points that lie about the origin, within 1 of it. `None` where they
/// do not settle one: the plane of a nearly flat patch is a sphere larger than this bound.
fn fit_sphere(q: &[Vec3]) -> Option<(Vec3, f64)> {
    const LARGEST: f64 = 20.0;
    let row = |p: &Vec3| Vector4::new(2.0 * p.x, 2.0 * p.y, 2.0 * p.z, 1.0);
    let solution = least_squares(q.iter().map(|p| (row(p), p.norm_squared())))?;
    let mut center = solution.xyz();
    let mut radius = libm::sqrt(f64::max(solution.w + center.norm_squared(), 0.0));
    for _ in 0..10 {
        let slope = |p: &Vec3| (center - p).try_normalize(1e-9).unwrap_or_else(Vec3::x);
        let rows = q.iter().map(|p| (slope(p).push(-1.0), -distance(p, &center, radius)));
        let step = least_squares(rows)?;
        center += step.xyz();
        radius += step.w;
    }
    (radius.is_finite() && radius > 1e-3 && radius < LARGEST).then_some((center, radius))
}

/// The solution of many equations in four unknowns; `None` where they do not settle it.
fn least_squares(rows: impl Iterator<Item = (Vector4<f64>, f64)>) -> Option<Vector4<f64>> {
    let (normal, right) = rows.fold((Matrix4::zeros(), Vector4::zeros()), |(normal, right), (row, value)| {
        (normal + row * row.transpose(), right + row * value)
    });
    let scale = normal.trace() / 4.0;
    let well_posed = normal.symmetric_eigenvalues().min() > 1e-9 * scale;
    if well_posed { normal.cholesky().map(|c| c.solve(&right)) } else { None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::UpAxis;

    fn groom(roots: &[Vec3]) -> RawGroom {
        RawGroom::of_curves(roots.iter().map(|r| vec![*r, r * 2.0]).collect())
    }

    /// Roots on the upper half of an ellipsoid, in a spiral.
    fn scalp(half_axes: Vec3) -> Vec<Vec3> {
        let root = |k: u32| {
            let height = f64::from(k) / 40.0;
            let (sin, cos) = libm::sincos(f64::from(k) * 2.4);
            let ring = libm::sqrt(1.0 - height * height);
            Vec3::new(ring * cos, ring * sin, height).component_mul(&half_axes)
        };
        (0..40).map(root).collect()
    }

    #[test]
    fn a_scaled_and_shifted_scalp_finds_its_head() {
        let head =
            HeadShape { center_m: Vec3::new(0.0, 0.0, 0.01), half_axes_m: Vec3::new(0.095, 0.075, 0.1) };
        let away: Vec<Vec3> =
            scalp(head.half_axes_m).iter().map(|p| p * 250.0 + Vec3::new(1.0, 2.0, 160.0)).collect();
        let fit = fit_to_head(&groom(&away), &head).unwrap();
        assert!((fit.scale - 1.0 / 250.0).abs() < 1e-9, "{}", fit.scale);
        for (found, expected) in away.iter().zip(scalp(head.half_axes_m)) {
            let placed = found * fit.scale + fit.shift_m;
            assert!((placed - expected - head.center_m).norm() < 1e-9);
        }
        assert!(fit.rms_m < 1e-9);
    }

    #[test]
    fn roots_that_lie_on_no_sphere_are_refused() {
        let head = HeadShape { center_m: Vec3::zeros(), half_axes_m: Vec3::repeat(0.1) };
        let flat: Vec<Vec3> = scalp(Vec3::new(1.0, 1.0, 0.0));
        for roots in [&flat[..], &flat[..1], &[Vec3::zeros(); 5]] {
            assert!(matches!(fit_to_head(&groom(roots), &head), Err(GroomReadError::Placement { .. })));
        }
    }

    #[test]
    fn axes_are_assumed_or_given() {
        let mut options = GroomOptions { up_axis: Some(Axis::PlusY), ..GroomOptions::default() };
        let mut assumed = Vec::new();
        let raw = RawGroom { up_axis: Some(UpAxis::Y), ..groom(&[]) };
        let mut warnings = Vec::new();
        let turn = axes(&raw, GroomFormat::Hair, &options, &mut assumed, &mut warnings).unwrap();
        assert_eq!(turn * Vec3::z(), Vec3::x(), "the nose points along z");
        assert_eq!((assumed.len(), warnings.len()), (1, 0));
        options.forward = Some(Axis::MinusZ);
        options.up_axis = Some(Axis::MinusY);
        let turn = axes(&raw, GroomFormat::Hair, &options, &mut assumed, &mut warnings).unwrap();
        assert_eq!((turn * -Vec3::z(), turn * -Vec3::y()), (Vec3::x(), Vec3::z()));
        assert_eq!((assumed.len(), warnings.len()), (1, 1), "{warnings:?}");
        assert_eq!(warnings, ["the file's up axis is y; the given -y holds"]);
        options.forward = Some(Axis::PlusY);
        assert!(axes(&raw, GroomFormat::Hair, &options, &mut assumed, &mut warnings).is_err());
    }

    #[test]
    fn what_is_not_stated_must_be_given() {
        let raw = groom(&[Vec3::zeros()]);
        let mut options = GroomOptions::default();
        let mut warnings = Vec::new();
        let error = axes(&raw, GroomFormat::Hair, &options, &mut Vec::new(), &mut warnings).unwrap_err();
        assert_eq!(
            error.to_string(),
            "a groom in .hair states no up axis: pass the file's up axis (x, y, z, -x, -y or -z)"
        );
        let error = unit(&raw, GroomFormat::Hair, &options, &mut warnings).unwrap_err();
        assert!(error.to_string().starts_with("a groom in .hair states no unit: pass a unit (mm"), "{error}");
        options.unit = Some(LengthUnit::Millimeter);
        let stated = RawGroom { unit_m: Some(0.01), ..raw };
        assert_eq!(unit(&stated, GroomFormat::Usda, &options, &mut warnings).unwrap(), 0.001);
        assert_eq!(warnings, ["the file's unit is 0.01 m; the given 0.001 m holds"]);
    }
}

//! One curves object: its strands in the archive's own space.

use super::bad;
use super::ogawa::Archive;
use super::properties::Compound;
use crate::error::GroomReadError;
use crate::format::GroomFormat;
use crate::format::curve::Basis;
use crate::format::curves::{Control, Curves, Kind, Place};

/// Takes in the curves of a `.geom` at a place; other kinds of geometry are passed over.
pub(super) fn take(
    archive: &Archive<'_>,
    geometry: &Compound,
    path: &str,
    place: &Place,
    curves: &mut Curves,
) -> Result<(), GroomReadError> {
    let numbers = |name: &str| geometry.numbers(archive, name, path);
    let (Some(counts), Some(kind)) = (numbers("nVertices")?, numbers("curveBasisAndType")?) else {
        return Ok(());
    };
    let Some(points) = numbers("P")? else { return Ok(()) };
    let widths = numbers("width")?;
    let control = Control {
        format: GroomFormat::Alembic,
        path,
        kind: self::kind(&kind.numbers, path)?,
        counts: &counts.numbers,
        points: &points.numbers,
        widths: widths.as_ref().map(|w| w.numbers.as_slice()),
        is_animated: points.changes,
    };
    curves.take(&control, place)
}

/// How control points make a curve: type, periodicity, basis, each a byte.
fn kind(bytes: &[f64], path: &str) -> Result<Kind, GroomReadError> {
    let byte = |k: usize| bytes.get(k).copied().unwrap_or(f64::NAN);
    if byte(1) != 0.0 {
        return Err(bad(path, "closed curves", "open ones: strands have a root and a tip"));
    }
    let cubic = |basis| Ok(Kind::Cubic { basis, pinned: false });
    match (byte(0) as u8, byte(2) as u8) {
        (1, _) => Ok(Kind::Polyline),
        (0, 1) => cubic(Basis::Bezier),
        (0, 2) => cubic(Basis::Bspline),
        (0, 3) => cubic(Basis::CatmullRom),
        (0, other) => {
            Err(bad(path, &format!("cubic curves of basis {other}"), "Bézier, B-spline or Catmull-Rom"))
        }
        (other, _) => Err(bad(path, &format!("curves of type {other}"), "linear or cubic")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds() {
        assert_eq!(kind(&[1.0, 0.0, 0.0, 0.0], "/").unwrap(), Kind::Polyline);
        let spline = Kind::Cubic { basis: Basis::Bspline, pinned: false };
        assert_eq!(kind(&[0.0, 0.0, 2.0, 2.0], "/").unwrap(), spline);
        for bytes in [&[][..], &[1.0, 1.0, 0.0, 0.0], &[2.0, 0.0, 2.0, 2.0], &[0.0, 0.0, 4.0, 4.0]] {
            assert!(kind(bytes, "/").is_err(), "{bytes:?}");
        }
    }
}

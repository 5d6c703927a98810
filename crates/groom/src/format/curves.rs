//! Curves of USD and Alembic, which hold them the same way: one array of control points for many curves, and how
//! many each one has.

use nalgebra::{Matrix4, Point3};
use tousle_core::Vec3;

use super::GroomFormat;
use super::curve::{Basis, evenly};
use crate::along::{mean_and_shares, spread};
use crate::error::GroomReadError;
use crate::raw::{RawGroom, RawStrand};

/// How control points make a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// The control points are on the curve.
    Polyline,
    /// They are not, or not all.
    Cubic {
        /// How four of them make a segment.
        basis: Basis,
        /// Whether the curve runs from the first to the last.
        pinned: bool,
    },
}

/// The curves of one object, as its file has them.
pub(super) struct Control<'a> {
    pub(super) format: GroomFormat,
    pub(super) path: &'a str,
    pub(super) kind: Kind,
    /// Control points of each curve.
    pub(super) counts: &'a [f64],
    /// x, y, z of each control point, object space.
    pub(super) points: &'a [f64],
    /// One width for all, for each curve or for each control point.
    pub(super) widths: Option<&'a [f64]>,
    /// Whether the points change over time.
    pub(super) is_animated: bool,
}

/// Of each curve that has any: its mean width, and how many times it the width is at each point.
type Widths = Option<Vec<Option<(f64, Vec<f64>)>>>;

/// The strands of all objects of a file.
#[derive(Default)]
pub(super) struct Curves {
    pub(super) raw: RawGroom,
    n_objects: usize,
    n_cubic: usize,
    n_animated: usize,
    n_moving: usize,
}

/// Where an object is.
#[derive(Clone, Copy)]
pub(super) struct Place {
    world_from_object: Matrix4<f64>,
    /// Whether its transform, or one above it, changes over time.
    moves: bool,
}

impl Place {
    /// Of objects under no other.
    pub(super) fn top() -> Self {
        Self { world_from_object: Matrix4::identity(), moves: false }
    }

    /// Of an object under one that is here, by its own transform.
    pub(super) fn then(self, local: &Matrix4<f64>, moves: bool) -> Self {
        Self { world_from_object: self.world_from_object * local, moves: self.moves || moves }
    }
}

impl Curves {
    /// Takes in an object's curves, in the file's own space.
    pub(super) fn take(&mut self, control: &Control<'_>, place: &Place) -> Result<(), GroomReadError> {
        let counts = control.counts()?;
        let points = control.points(counts.iter().sum(), &place.world_from_object)?;
        let scale = mean_scale(&place.world_from_object);
        let mut widths = control.widths(&counts, scale, &mut self.raw.warnings);
        let mut n_without_curve = 0;
        let mut first = 0;
        for (k, n) in counts.iter().enumerate() {
            let these = &points[first..first + n];
            first += n;
            let on_curve = match control.kind {
                Kind::Polyline => Some(these.to_vec()),
                Kind::Cubic { basis, pinned } => evenly(basis, pinned, these, *n),
            };
            n_without_curve += usize::from(on_curve.is_none());
            let mut strand = RawStrand::of_points(on_curve.unwrap_or_default());
            strand.name = Some(format!("{}[{k}]", control.path));
            if let Some((mean, shares)) = widths.as_mut().and_then(|w| w[k].take()) {
                strand.drawn_width = Some(mean);
                strand.along.width = shares;
            }
            self.raw.strands.push(strand);
        }
        if n_without_curve > 0 {
            let note =
                format!("{}: {n_without_curve} curves have too few control points to be drawn", control.path);
            self.raw.warnings.push(note);
        }
        self.n_objects += 1;
        self.n_cubic += usize::from(control.kind != Kind::Polyline);
        self.n_animated += usize::from(control.is_animated);
        self.n_moving += usize::from(place.moves);
        Ok(())
    }

    /// The groom, with a word on what was exchanged; `None` if there were no curves.
    pub(super) fn finish(mut self) -> Option<RawGroom> {
        for (n, what) in [
            (
                self.n_cubic,
                "cubic curves: control points are not on the curve; as many points, evenly along it, stand for them",
            ),
            (self.n_animated, "animated curves: the first sample is the rest pose"),
            (self.n_moving, "animated transforms: the first sample of each is where the curves are"),
        ] {
            if n > 0 {
                self.raw.warnings.push(format!("{what} (objects: {n})"));
            }
        }
        // With one object of curves, its strands are known by their numbers alone.
        if self.n_objects == 1 {
            self.raw.strands.iter_mut().for_each(|s| s.name = None);
        }
        (self.n_objects > 0).then_some(self.raw)
    }
}

impl Control<'_> {
    fn bad(&self, found: String, expected: impl Into<String>) -> GroomReadError {
        let (format, place) = (self.format, self.path.to_owned());
        GroomReadError::Malformed { format, place, found, expected: expected.into() }
    }

    fn counts(&self) -> Result<Vec<usize>, GroomReadError> {
        let count = |x: &f64| (x.fract() == 0.0 && (0.0..=1e9).contains(x)).then_some(*x as usize);
        let counts: Option<Vec<usize>> = self.counts.iter().map(count).collect();
        counts.ok_or_else(|| self.bad("curve vertex counts that are no counts".to_owned(), "whole numbers"))
    }

    /// Control points in the file's own space.
    fn points(&self, n: usize, world_from_object: &Matrix4<f64>) -> Result<Vec<Vec3>, GroomReadError> {
        if n.checked_mul(3) != Some(self.points.len()) {
            let found = format!("{} coordinates of control points", self.points.len());
            return Err(self.bad(found, format!("three for each of {n}, the sum of the curve vertex counts")));
        }
        let place = |p: &[f64]| world_from_object.transform_point(&Point3::new(p[0], p[1], p[2])).coords;
        Ok(self.points.chunks_exact(3).map(place).collect())
    }

    /// The mean width of each curve, in the file's own space, and how many times it the width is at each point. How
    /// many widths there are tells what they belong to.
    fn widths(&self, counts: &[usize], scale: f64, warnings: &mut Vec<String>) -> Widths {
        let widths = self.widths.filter(|w| !w.is_empty())?;
        let at_ends: Vec<usize> = counts.iter().map(|n| self.kind.n_ends(*n)).collect();
        let of_curves = if widths.len() == 1 {
            Some(vec![widths; counts.len()])
        } else {
            [&vec![1; counts.len()], counts, &at_ends].into_iter().find_map(|n| split(widths, n))
        };
        let Some(of_curves) = of_curves else {
            let found = widths.len();
            let note =
                format!("{}: {found} widths, neither one, nor one a curve or a point: not used", self.path);
            warnings.push(note);
            return None;
        };
        let of_curve = |(widths, n_points): (&[f64], &usize)| {
            (!widths.is_empty()).then(|| {
                let (mean, shares) = mean_and_shares(&spread(widths, *n_points));
                (mean * scale, shares)
            })
        };
        Some(of_curves.into_iter().zip(counts).map(of_curve).collect())
    }
}

impl Kind {
    /// Ends of segments of a curve of so many control points, its own two included: what `varying` values belong to.
    fn n_ends(self, n_points: usize) -> usize {
        match self {
            Self::Cubic { basis: Basis::Bezier, .. } => n_points.saturating_sub(1) / 3 + 1,
            Self::Cubic { pinned: false, .. } => n_points.saturating_sub(2),
            Self::Polyline | Self::Cubic { .. } => n_points,
        }
    }
}

/// Each curve's own of the values of all; `None` if they are not as many.
fn split<'a>(values: &'a [f64], n_each: &[usize]) -> Option<Vec<&'a [f64]>> {
    let mut rest = values;
    let each = n_each.iter().map(|n| {
        let (own, others) = rest.split_at_checked(*n)?;
        rest = others;
        Some(own)
    });
    let each: Option<Vec<_>> = each.collect();
    each.filter(|_| rest.is_empty())
}

/// How much longer things get on average: the cube root of how much more room they take.
fn mean_scale(matrix: &Matrix4<f64>) -> f64 {
    libm::cbrt(matrix.fixed_view::<3, 3>(0, 0).determinant().abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [f64; 15] = [0., 0., 0., 0., 0., 1., 1., 0., 0., 1., 0., 1., 1., 0., 2.];

    fn control<'a>(kind: Kind, counts: &'a [f64], widths: Option<&'a [f64]>) -> Control<'a> {
        let format = GroomFormat::Usda;
        Control { format, path: "/c", kind, counts, points: &POINTS, widths, is_animated: false }
    }

    #[test]
    fn points_are_moved_and_widths_scaled() {
        for (widths, expected) in [
            (None, None),
            (Some(&[0.5][..]), Some([1.0, 1.0])),
            (Some(&[1.0, 2.0]), Some([2.0, 4.0])),
            (Some(&[1.0, 2.0, 1.0, 1.0, 4.0]), Some([3.0, 4.0])),
            (Some(&[1.0, 2.0, 3.0]), None),
        ] {
            let mut curves = Curves::default();
            let place = Place::top().then(&Matrix4::new_scaling(2.0), false);
            curves.take(&control(Kind::Polyline, &[2.0, 3.0], widths), &place).unwrap();
            let raw = curves.finish().unwrap();
            assert_eq!(raw.strands[1].points[2], Vec3::new(2.0, 0.0, 4.0));
            let found: Vec<_> = raw.strands.iter().map(|s| s.drawn_width).collect();
            assert_eq!(found, expected.map_or(vec![None, None], |e| e.map(Some).to_vec()));
            assert_eq!(raw.warnings.len(), usize::from(widths.is_some_and(|w| w.len() == 3)));
        }
    }

    /// Two curves of four and five points: `vertex` widths are one a point, `varying` ones one an end of a segment.
    #[test]
    fn widths_along_a_curve() {
        let points: Vec<f64> = (0..9).flat_map(|k| [0.0, 0.0, f64::from(k)]).collect();
        let bspline = Kind::Cubic { basis: Basis::Bspline, pinned: false };
        let vertex = [1.0, 1.0, 1.0, 1.0, 3.0, 2.0, 2.0, 2.0, 1.0];
        let varying = [4.0, 2.0, 3.0, 2.0, 1.0];
        for (kind, widths, expected) in [
            (Kind::Polyline, &vertex[..], [1.5, 1.0, 1.0, 1.0, 0.5]),
            (bspline, &varying, [1.5, 1.25, 1.0, 0.75, 0.5]),
        ] {
            let mut curves = Curves::default();
            let control = Control { points: &points, ..control(kind, &[4.0, 5.0], Some(widths)) };
            curves.take(&control, &Place::top()).unwrap();
            let raw = curves.finish().unwrap();
            assert_eq!(raw.strands[1].along.width, expected);
            assert_eq!(raw.strands[1].drawn_width, Some(2.0));
        }
    }

    #[test]
    fn strands_of_several_objects_carry_their_path() {
        let mut curves = Curves::default();
        for _ in 0..2 {
            curves.take(&control(Kind::Polyline, &[2.0, 3.0], None), &Place::top()).unwrap();
        }
        assert_eq!(curves.finish().unwrap().strands[1].name.as_deref(), Some("/c[1]"));
        assert!(Curves::default().finish().is_none());
    }

    #[test]
    fn counts_that_do_not_fit() {
        for (counts, says) in [
            (&[1.5][..], "no counts"),
            (&[-1.0], "no counts"),
            (&[1e9, 1e9], "found 15 coordinates of control points, expected three for each of 2000000000"),
        ] {
            let taken = Curves::default().take(&control(Kind::Polyline, counts, None), &Place::top());
            let error = taken.unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
        let spline = Kind::Cubic { basis: Basis::Bspline, pinned: false };
        let mut curves = Curves::default();
        curves.take(&control(spline, &[2.0, 3.0], None), &Place::top()).unwrap();
        let warnings = curves.finish().unwrap().warnings;
        assert_eq!(warnings[0], "/c: 2 curves have too few control points to be drawn");
    }
}

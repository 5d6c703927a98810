//! What a format reader gives: curves as the file has them, and what the file says about them.

use tousle_core::{Along, UpAxis, Vec3};

/// A groom in the file's own axes and unit.
#[derive(Debug, Default)]
pub(crate) struct RawGroom {
    /// Meters in one of the file's units, if it states them.
    pub(crate) unit_m: Option<f64>,
    /// The up axis the file states.
    pub(crate) up_axis: Option<UpAxis>,
    /// Whether the file's axes are the head's by definition of the format.
    pub(crate) is_head_space: bool,
    pub(crate) strands: Vec<RawStrand>,
    pub(crate) warnings: Vec<String>,
}

/// A strand as the file has it.
#[derive(Debug, Default)]
pub(crate) struct RawStrand {
    /// Its number in the file, from 0, once strands have been left out.
    pub(crate) number: Option<usize>,
    /// `None` where the format names none.
    pub(crate) name: Option<String>,
    /// Control points, root first, file axes and unit.
    pub(crate) points: Vec<Vec3>,
    /// How wide it is drawn, file unit.
    pub(crate) drawn_width: Option<f64>,
    /// Length along the curve, file unit.
    pub(crate) length: Option<f64>,
    pub(crate) linear_density_kg_per_m: Option<f64>,
    pub(crate) lock_width_m: Option<f64>,
    pub(crate) bending_stiffness_n_m2: Option<f64>,
    pub(crate) internal_damping_secs: Option<f64>,
    /// What the file gives by the point, over its mean, which stands above; empty lists for the rest.
    pub(crate) along: Along,
}

impl RawStrand {
    /// A strand of which only the curve is known.
    pub(crate) fn of_points(points: Vec<Vec3>) -> Self {
        Self { points, ..Self::default() }
    }

    /// Leaves out points that lie on the one before, with all that belongs to them. Out: how many.
    pub(crate) fn drop_coincident(&mut self, within: f64) -> usize {
        let mut last: Option<Vec3> = None;
        let is_apart = |p: &Vec3| {
            let apart = last.is_none_or(|last| (p - last).norm() > within);
            last = if apart { Some(*p) } else { last };
            apart
        };
        let keep: Vec<bool> = self.points.iter().map(is_apart).collect();
        let Along { width, linear_density, bending_stiffness } = &mut self.along;
        for list in [width, linear_density, bending_stiffness] {
            let mut kept = keep.iter();
            list.retain(|_| kept.next().copied().unwrap_or(true));
        }
        let before = keep.len();
        let mut kept = keep.into_iter();
        self.points.retain(|_| kept.next().unwrap_or(true));
        before - self.points.len()
    }
}

impl RawGroom {
    /// A groom of which only the curves are known.
    pub(crate) fn of_curves(curves: Vec<Vec<Vec3>>) -> Self {
        Self { strands: curves.into_iter().map(RawStrand::of_points).collect(), ..Self::default() }
    }

    /// Smallest and largest coordinates, file axes and unit; `None` without points.
    pub(crate) fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        bounds(self.strands.iter().flat_map(|s| s.points.iter()))
    }
}

/// Smallest and largest coordinates; `None` without points.
pub(crate) fn bounds<'a>(points: impl Iterator<Item = &'a Vec3>) -> Option<[[f64; 3]; 2]> {
    let mut all = points.map(|p| [*p, *p]);
    let first = all.next()?;
    let [low, high] = all.fold(first, |[low, high], [p, _]| [low.inf(&p), high.sup(&p)]);
    Some([low.into(), high.into()])
}

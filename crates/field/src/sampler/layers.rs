//! What layers do to the vectors at many points.

use super::{WIDTH, smaller};
use crate::{FieldLayer, Handle, Reshape};
use core::iter::zip;
use tousle_core::Vec3;

/// A component of [`WIDTH`] points, or a number of each.
type Row = [f32; WIDTH];

/// A layer, or the layers of variants that differ in nothing but their handles' vectors, as many points ask for it at once.
#[derive(Clone, Debug)]
pub(super) struct Placed<'a> {
    /// The layer, or one of them.
    layer: &'a FieldLayer,
    /// Whose points it acts on.
    acts: [bool; WIDTH],
    /// Opposite corners of a box that holds all it does, head space, m.
    corners_m: [[f32; 3]; 2],
    spots: Vec<Spot>,
}

/// A [`Handle`].
#[derive(Clone, Debug)]
struct Spot {
    center_m: [f32; 3],
    /// One over the square of its reach.
    per_reach2: f32,
    /// What it adds to each point, by components.
    extra: [Row; 3],
}

impl<'a> Placed<'a> {
    /// Layers as everybody sees them, without those that never do anything.
    pub fn common(layers: &'a [FieldLayer]) -> Vec<Self> {
        layers.iter().filter_map(|layer| Self::new(&[Some(layer)])).collect()
    }

    /// Layers of variants whose points are asked for in turn.
    pub fn in_turn(variants: &[&'a [FieldLayer]]) -> Vec<Self> {
        let most = variants.iter().map(|layers| layers.len()).max().unwrap_or(0);
        let mut placed = Vec::new();
        for k in 0..most {
            let mut left: Vec<Option<&FieldLayer>> = variants.iter().map(|layers| layers.get(k)).collect();
            while let Some(first) = left.iter().copied().find_map(|layer| layer) {
                let is_like = |layer: &&FieldLayer| layer.acts_with(first);
                let alike: Vec<_> = left.iter_mut().map(|layer| layer.take_if(|l| is_like(l))).collect();
                placed.extend(Self::new(&alike));
            }
        }
        placed
    }

    /// Layers at the same places and times, one a turn or none; `None` if they never do anything.
    fn new(turns: &[Option<&'a FieldLayer>]) -> Option<Self> {
        let doing = |layer: &Option<&'a FieldLayer>| layer.filter(|layer| !layer.does_nothing());
        let turns: Vec<Option<&FieldLayer>> = turns.iter().map(doing).collect();
        let layer = turns.iter().copied().find_map(|layer| layer)?;
        let (low, high) = layer.corners_m()?;
        // Wider than single precision takes away.
        let slack_m = Vec3::repeat(1e-4);
        let corners_m = [low - slack_m, high + slack_m].map(|corner| corner.map(|c| c as f32).into());
        let spot = |(h, handle): (usize, &Handle)| {
            let mut extra = [[0.0; WIDTH]; 3];
            for (turn, layer) in turns.iter().enumerate() {
                let own = layer.map_or_else(Vec3::zeros, |layer| layer.handles[h].extra);
                for (extra, own) in zip(&mut extra, own.iter()) {
                    extra[turn..].iter_mut().step_by(turns.len()).for_each(|extra| *extra = *own as f32);
                }
            }
            let per_reach2 = (1.0 / (handle.reach_m * handle.reach_m)) as f32;
            Spot { center_m: handle.center_m.map(|c| c as f32).into(), per_reach2, extra }
        };
        Some(Self {
            layer,
            acts: core::array::from_fn(|k| turns[k % turns.len()].is_some()),
            corners_m,
            spots: layer.handles.iter().enumerate().map(spot).collect(),
        })
    }

    /// [`FieldLayer::presence`].
    pub fn presence(&self, time_secs: f64) -> f64 {
        self.layer.presence(time_secs)
    }

    /// [`FieldLayer::apply`], in single precision.
    #[inline(always)]
    pub fn apply(&self, points_m: &[Row; 3], presence: f32, vectors: &mut [Row; 3]) {
        if !self.is_near(points_m) {
            return;
        }
        let mut sums = [[0.0; WIDTH]; 3];
        let mut weights = [0.0; WIDTH];
        for spot in &self.spots {
            spot.gather(points_m, &mut sums, &mut weights);
        }
        if let Some(reshape) = &self.layer.reshape {
            self.reshape(reshape, presence, &weights, vectors);
        }
        for (vectors, sums) in zip(vectors, &sums) {
            for k in 0..WIDTH {
                let most = if weights[k] > 1.0 { weights[k] } else { 1.0 };
                vectors[k] += sums[k] / most * presence;
            }
        }
    }

    /// Whether any of the points may be in reach.
    #[inline(always)]
    fn is_near(&self, points_m: &[Row; 3]) -> bool {
        let [low, high] = &self.corners_m;
        let mut is_inside = [true; WIDTH];
        for axis in 0..3 {
            for k in 0..WIDTH {
                let at = points_m[axis][k];
                is_inside[k] &= (low[axis] <= at) & (at <= high[axis]);
            }
        }
        is_inside.contains(&true)
    }

    #[inline(never)]
    fn reshape(&self, reshape: &Reshape, presence: f32, weights: &Row, vectors: &mut [Row; 3]) {
        for k in (0..WIDTH).filter(|k| self.acts[*k] && weights[*k] > 0.0) {
            let weight = f64::from(smaller(weights[k], 1.0) * presence);
            let before = Vec3::from([0, 1, 2].map(|axis| f64::from(vectors[axis][k])));
            let after = reshape.apply(weight, before);
            (0..3).for_each(|axis| vectors[axis][k] = after[axis] as f32);
        }
    }
}

impl Spot {
    /// Adds the weights ([`Handle::weight`]) and the weighted vectors of some points.
    #[inline(always)]
    fn gather(&self, points_m: &[Row; 3], sums: &mut [Row; 3], weights: &mut Row) {
        let mut share2 = [0.0; WIDTH];
        for (points_m, center_m) in zip(points_m, self.center_m) {
            for k in 0..WIDTH {
                let away = points_m[k] - center_m;
                share2[k] += away * away * self.per_reach2;
            }
        }
        // Most handles of a long way are out of reach of all points: they cost neither root nor product.
        let mut is_any_near = false;
        for share2 in share2 {
            is_any_near |= share2 < 1.0;
        }
        if !is_any_near {
            return;
        }
        let mut weight = [0.0; WIDTH];
        for k in 0..WIDTH {
            let share = smaller(share2[k], 1.0).sqrt();
            let left2 = (1.0 - share) * (1.0 - share);
            weight[k] = left2 * left2 * (4.0 * share + 1.0);
            weights[k] += weight[k];
        }
        for (sums, extra) in zip(sums, &self.extra) {
            for k in 0..WIDTH {
                sums[k] += extra[k] * weight[k];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ease, LayerOrigin};

    fn layer(places: u32, vectors: u32, reshape: Option<Reshape>) -> FieldLayer {
        let dice = |k: u32| f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5;
        let some = |k: u32| Vec3::new(dice(3 * k), dice(3 * k + 1), dice(3 * k + 2));
        let handle = |k: u32| Handle {
            center_m: some(100 * places + k) * 0.2,
            reach_m: 0.08 + 0.04 * dice(k),
            extra: some(1000 + 100 * vectors + k) * 50.0,
        };
        FieldLayer {
            id: "1".into(),
            name: "1".into(),
            muted: false,
            first_secs: 0.0,
            last_secs: 2.0,
            ease: Ease { rise: 0.5, fall: 0.5 },
            handles: (0..12).map(handle).collect(),
            reshape,
            origin: LayerOrigin::Wind { action: "gust".into() },
        }
    }

    /// Points all over the handles, some out of reach.
    fn points() -> [Row; 3] {
        [0.031, 0.017, 0.023]
            .map(|step| core::array::from_fn(|k| ((k as f32 * step * 7.0) % 0.3 - 0.15) * 1.2))
    }

    /// What all points see is what [`FieldLayer::apply`] makes at each.
    fn check(placed: &[Placed<'_>], secs: f64, of: impl Fn(usize) -> Vec<FieldLayer>) {
        let points = points();
        let mut found = [[3.0; WIDTH], [-2.0; WIDTH], [1.0; WIDTH]];
        let before = Vec3::new(3.0, -2.0, 1.0);
        for placed in placed {
            placed.apply(&points, placed.presence(secs) as f32, &mut found);
        }
        for k in 0..WIDTH {
            let point = Vec3::from(points.map(|row| f64::from(row[k])));
            let expected = of(k).iter().fold(before, |v, layer| layer.apply(point, layer.presence(secs), v));
            let found = Vec3::from(found.map(|row| f64::from(row[k])));
            assert!((found - expected).norm() < 1e-4, "{k}: {found} {expected}");
        }
    }

    #[test]
    fn many_points_see_what_one_does() {
        let turned = Reshape { turn: Vec3::new(0.3, -0.2, 0.9), scale: 0.4 };
        let layers = [layer(0, 0, None), layer(1, 1, Some(turned))];
        for secs in [0.3, 1.0, 1.9] {
            check(&Placed::common(&layers), secs, |_| layers.to_vec());
        }
    }

    /// Of four variants two have their layers at the same places, one has none, and one has its own.
    #[test]
    fn variants_see_their_own_layers() {
        let turned = Reshape { turn: Vec3::x(), scale: 2.0 };
        let variants = [
            vec![layer(0, 0, None), layer(1, 1, None)],
            vec![layer(0, 2, None)],
            vec![],
            vec![layer(3, 3, Some(turned)), layer(1, 4, None)],
        ];
        let placed = Placed::in_turn(&variants.each_ref().map(Vec::as_slice));
        assert_eq!(placed.len(), 3, "layers at the same places are gone through together");
        check(&placed, 0.7, |k| variants[k % 4].clone());
    }
}

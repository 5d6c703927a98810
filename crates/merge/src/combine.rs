use crate::Tally;
use tousle_core::Vec3;
use tousle_field::{Field, VoxelFlag};

/// Puts together what several inputs say of one time, all on one grid, and counts how well they agree.
///
/// In each voxel only the inputs of the best flag there speak: measured before interpolated before outside. Among
/// them vector i weighs 1 / σᵢ²; where nobody knows a σ, all weigh the same, and where some do, the others are not
/// heard. One voice is passed on bit for bit. The mean's standard deviation is (Σ 1/σᵢ²)^-½ where they agree, and
/// larger by the Birge ratio where they do not (`docs/design.md`, "Merging").
///
/// # Panics
/// If `views` is empty or their arrays differ in length.
pub fn combine(views: &[&Field], tally: &mut Tally) -> Field {
    let n_voxels = views[0].flags.len();
    let mut field = Field {
        u: vec![0.0; 3 * n_voxels],
        flags: vec![VoxelFlag::Outside; n_voxels],
        sd: None,
        outside: views.iter().map(|v| v.outside).sum::<Vec3>() / views.len() as f64,
    };
    let mut sd = vec![f32::INFINITY; n_voxels];
    let mut voices = Vec::with_capacity(views.len());
    for (voxel, voxel_sd) in sd.iter_mut().enumerate() {
        let best = views.iter().map(|v| v.flags[voxel]).max_by_key(|flag| *flag as u8).unwrap_or_default();
        voices.clear();
        voices.extend(views.iter().enumerate().filter(|(_, v)| v.flags[voxel] == best).map(|(k, view)| {
            Voice {
                view: k,
                u: view.vector(voxel),
                sd: view.sd.as_ref().map_or(f64::INFINITY, |sd| f64::from(sd[voxel])),
            }
        }));
        field.flags[voxel] = best;
        if let [only] = voices[..] {
            let view = views[only.view];
            for axis in 0..3 {
                field.u[axis * n_voxels + voxel] = view.u[axis * n_voxels + voxel];
            }
            *voxel_sd = only.sd as f32;
        } else {
            let heard = Heard::of(&voices);
            field.set_vector(voxel, heard.mean);
            *voxel_sd = heard.sd(best) as f32;
            tally.meet(best, &heard);
        }
        tally.count(best, &voices);
    }
    tally.outside(views);
    field.sd = sd.iter().any(|sd| sd.is_finite()).then_some(sd);
    field
}

/// What an input says of a voxel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Voice {
    /// Which view it is.
    pub view: usize,
    pub u: Vec3,
    /// Standard deviation of each component; infinite where unknown.
    pub sd: f64,
}

/// The weighted mean of several voices.
#[derive(Debug)]
pub(crate) struct Heard {
    pub mean: Vec3,
    /// Mean squared distance of a component from the mean, each voice the same.
    pub spread: f64,
    /// Those that were heard, with their weights; relative ones where no absolute ones are known.
    weighed: Vec<(Voice, f64)>,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Nobody knows a standard deviation.
    Unknown,
    /// Some know theirs, and weigh by it.
    Known,
    /// Some say that they are exact.
    Exact,
}

impl Heard {
    fn of(voices: &[Voice]) -> Self {
        let kind = if voices.iter().any(|v| v.sd == 0.0) {
            Kind::Exact
        } else if voices.iter().any(|v| v.sd.is_finite()) {
            Kind::Known
        } else {
            Kind::Unknown
        };
        let weight = |v: &Voice| match kind {
            Kind::Exact => f64::from(u8::from(v.sd == 0.0)),
            // 1 / infinity is 0: whoever does not know is not heard where others do.
            Kind::Known => 1.0 / (v.sd * v.sd),
            Kind::Unknown => 1.0,
        };
        let weighed: Vec<_> = voices.iter().map(|v| (*v, weight(v))).filter(|(_, w)| *w > 0.0).collect();
        let total: f64 = weighed.iter().map(|(_, w)| w).sum();
        let mean = weighed.iter().map(|(v, w)| v.u * *w).sum::<Vec3>() / total;
        let spread =
            voices.iter().map(|v| (v.u - mean).norm_squared()).sum::<f64>() / (3 * voices.len()) as f64;
        Self { mean, spread, weighed, kind }
    }

    /// χ² of each component over its degrees of freedom: 1 where the voices differ as much as they say they may.
    pub fn birge_squared(&self) -> Option<f64> {
        let n = self.weighed.len();
        (self.kind == Kind::Known && n > 1).then(|| {
            let chi_squared =
                self.weighed.iter().map(|(v, w)| w * (v.u - self.mean).norm_squared()).sum::<f64>();
            chi_squared / (3 * (n - 1)) as f64
        })
    }

    /// The standard deviation of each component of the mean.
    fn sd(&self, flag: VoxelFlag) -> f64 {
        let total: f64 = self.weighed.iter().map(|(_, w)| w).sum();
        match (self.kind, flag) {
            (Kind::Unknown, _) => f64::INFINITY,
            // What is taken from outside is one assumption, not several measurements: it gets no surer.
            (_, VoxelFlag::Outside) => self.weighed.iter().map(|(v, w)| v.sd * w).sum::<f64>() / total,
            (Kind::Known, _) => (self.birge_squared().map_or(1.0, |r| r.max(1.0)) / total).sqrt(),
            // Exact and yet not the same: the mean's standard error, from how much they differ.
            (Kind::Exact, _) => {
                let n = self.weighed.len();
                let squares = self.weighed.iter().map(|(v, _)| (v.u - self.mean).norm_squared()).sum::<f64>();
                if n > 1 { (squares / (3 * n * (n - 1)) as f64).sqrt() } else { 0.0 }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of one voxel.
    fn one(x: f32, flag: VoxelFlag, sd: Option<f32>) -> Field {
        let outside = Vec3::new(f64::from(x), 0.0, 0.0);
        Field { u: vec![x, 0.0, 0.0], flags: vec![flag], sd: sd.map(|sd| vec![sd]), outside }
    }

    fn merged(views: &[Field]) -> (f32, VoxelFlag, Option<f32>) {
        let field = combine(&views.iter().collect::<Vec<_>>(), &mut Tally::new(views.len()));
        (field.u[0], field.flags[0], field.sd.map(|sd| sd[0]))
    }

    use VoxelFlag::{Interpolated, Measured, Outside};

    #[test]
    fn what_was_measured_goes_before_what_was_not() {
        let views =
            [one(5.0, Interpolated, Some(0.01)), one(2.0, Measured, Some(9.0)), one(7.0, Outside, None)];
        assert_eq!(merged(&views), (2.0, Measured, Some(9.0)));
        assert_eq!(merged(&views[..1]), (5.0, Interpolated, Some(0.01)));
    }

    #[test]
    fn the_surer_weighs_more() {
        // 1/σ² are 4 and 1: (4 · 1 + 1 · 2) / 5, and 5^-½. They differ by 1, less than σ says: no more than that.
        let (u, _, sd) = merged(&[one(1.0, Measured, Some(0.5)), one(2.0, Measured, Some(1.0))]);
        assert!((u - 1.2).abs() < 1e-6 && (sd.unwrap() - 0.2_f32.sqrt()).abs() < 1e-6, "{u} {sd:?}");
    }

    #[test]
    fn who_disagrees_is_less_sure() {
        // χ² = 2 · 10² / 1² over 3 components: the Birge ratio is (200 / 3)^½, the mean's own σ is 2^-½.
        let (u, _, sd) = merged(&[one(0.0, Measured, Some(1.0)), one(20.0, Measured, Some(1.0))]);
        assert!((f64::from(u) - 10.0).abs() < 1e-6);
        assert!((f64::from(sd.unwrap()) - (200.0_f64 / 3.0 / 2.0).sqrt()).abs() < 1e-5, "{sd:?}");
    }

    #[test]
    fn who_does_not_know_is_heard_only_among_their_like() {
        let unknown = one(9.0, Measured, Some(f32::INFINITY));
        assert_eq!(merged(&[one(1.0, Measured, Some(0.5)), unknown.clone()]), (1.0, Measured, Some(0.5)));
        assert_eq!(merged(&[one(1.0, Measured, None), unknown]), (5.0, Measured, None));
    }

    #[test]
    fn an_assumption_made_twice_is_no_surer() {
        let (_, _, sd) = merged(&[one(1.0, Outside, Some(2.0)), one(1.0, Outside, Some(2.0))]);
        assert_eq!(sd, Some(2.0));
    }

    #[test]
    fn exact_is_exact() {
        let exact = |x| one(x, Measured, Some(0.0));
        assert_eq!(merged(&[exact(1.0), one(9.0, Measured, Some(0.1))]), (1.0, Measured, Some(0.0)));
        let (u, _, sd) = merged(&[exact(1.0), exact(3.0)]);
        assert!(u == 2.0 && (f64::from(sd.unwrap()) - (2.0_f64 / 6.0).sqrt()).abs() < 1e-6);
    }
}

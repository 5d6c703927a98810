use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use tousle_core::{Pose, Vec3};

/// One marker in one frame: its place on the head and where it was seen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// Index of the marker among the head's.
    pub marker: usize,
    /// Its place, head space, m.
    pub place_m: Vec3,
    /// Where it was seen, world space, m.
    pub seen_m: Vec3,
}

/// A pose and the markers that agree with it.
#[derive(Clone, Debug)]
pub(crate) struct Registration {
    pub world_from_head: Pose,
    /// Indices into the pairs.
    pub used: Vec<usize>,
    /// Root mean square distance of the used pairs, m.
    pub residual_m: f64,
}

/// The rigid transform that carries most weight of markers to where they were seen, outliers refused.
///
/// Triples of markers propose poses; each is judged by the truncated squared distances of all markers,
/// weighted by how far each marker is to be trusted; the best is refined by least squares over the markers that
/// agree, until those no longer change. With at most a dozen head markers trying all triples (220) costs less
/// than drawing them at random, and gives the same answer each time; of more markers [`tried`] are some of them.
///
/// `None` with fewer than three markers, or when all lie on a line (the turn about it is unknown).
/// Source: the judging is MSAC (Torr and Zisserman 2000, eq. 10) with exhaustive or even sampling.
pub(crate) fn register(pairs: &[Pair], trust: &[f64], tolerance_m: f64) -> Option<Registration> {
    let cost = |pose: &Pose| -> f64 {
        let truncated = |p: &Pair| distance2(pose, p).min(tolerance_m * tolerance_m);
        pairs.iter().map(|p| trust[p.marker] * truncated(p)).sum()
    };
    let mut best: Option<(f64, Pose)> = None;
    for triple in tried(pairs.len()) {
        let Some(pose) = least_squares(&triple.map(|k| pairs[k])) else { continue };
        let cost = cost(&pose);
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, pose));
        }
    }
    let (_, mut pose) = best?;
    let mut used = Vec::new();
    for _ in 0..8 {
        let agreeing = agreeing(pairs, &pose, tolerance_m);
        if agreeing == used {
            break;
        }
        let kept: Vec<Pair> = agreeing.iter().map(|&k| pairs[k]).collect();
        pose = least_squares(&kept)?;
        used = agreeing;
    }
    if used.len() < 3 {
        return None;
    }
    let sum: f64 = used.iter().map(|&k| distance2(&pose, &pairs[k])).sum();
    Some(Registration { world_from_head: pose, residual_m: (sum / used.len() as f64).sqrt(), used })
}

/// The most triples that are tried. If two of three markers of a face set go their own way, ten of so many triples are still of
/// markers that follow the head, and any of those finds the others. All triples of 64 markers would be 41,664.
const MOST_TRIPLES: usize = 300;

/// The triples of so many markers in order; of more than [`MOST_TRIPLES`] those on which multiples of the golden section fall, which
/// beat in time with nothing: so all markers are in nearly as many.
fn tried(n: usize) -> impl Iterator<Item = [usize; 3]> {
    let all = (0..n).flat_map(move |i| (i + 1..n).flat_map(move |j| (j + 1..n).map(move |k| [i, j, k])));
    let n_all = n * n.saturating_sub(1) * n.saturating_sub(2) / 6;
    let share = MOST_TRIPLES as f64 / n_all as f64;
    let golden = |idx: usize| (idx as f64 * 0.618_033_988_749_894_9).fract();
    all.enumerate().filter(move |(idx, _)| golden(*idx) < share).map(|(_, triple)| triple).take(MOST_TRIPLES)
}

fn agreeing(pairs: &[Pair], pose: &Pose, tolerance_m: f64) -> Vec<usize> {
    (0..pairs.len()).filter(|&k| distance2(pose, &pairs[k]) < tolerance_m * tolerance_m).collect()
}

fn distance2(pose: &Pose, pair: &Pair) -> f64 {
    (pose.rotation * pair.place_m + pose.translation.vector - pair.seen_m).norm_squared()
}

/// The rigid transform with the least sum of squared distances; `None` if the places lie on a line.
///
/// Source: Kabsch 1976, with the sign of the last singular direction chosen so that no reflection comes out.
pub(crate) fn least_squares(pairs: &[Pair]) -> Option<Pose> {
    if pairs.len() < 3 {
        return None;
    }
    let n = pairs.len() as f64;
    let place_mean = pairs.iter().map(|p| p.place_m).sum::<Vec3>() / n;
    let seen_mean = pairs.iter().map(|p| p.seen_m).sum::<Vec3>() / n;
    let covariance: Matrix3<f64> =
        pairs.iter().map(|p| (p.seen_m - seen_mean) * (p.place_m - place_mean).transpose()).sum();
    let svd = covariance.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
    // Two directions with spread settle a rotation. 1e-6 m² is a spread of 1 mm: less is a line of markers.
    if svd.singular_values[order[1]] / n < 1e-6 {
        return None;
    }
    let mut sign = Matrix3::identity();
    sign[(order[2], order[2])] = (u * v_t).determinant().signum();
    let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(u * sign * v_t));
    Some(Pose::from_parts((seen_mean - rotation * place_mean).into(), rotation))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head() -> Vec<Vec3> {
        [
            [84., 29., 43.],
            [83., -30., 42.],
            [113., 1., -18.],
            [74., 47., -33.],
            [73., -46., -34.],
            [64., 0., -91.],
        ]
        .map(|p: [f64; 3]| Vec3::from(p) * 1e-3)
        .to_vec()
    }

    fn pairs(pose: &Pose) -> Vec<Pair> {
        let seen = |p: &Vec3| pose.rotation * p + pose.translation.vector;
        head().iter().enumerate().map(|(marker, p)| Pair { marker, place_m: *p, seen_m: seen(p) }).collect()
    }

    #[test]
    fn an_exact_pose_is_found_exactly() {
        let pose = Pose::new(Vec3::new(1.0, -2.0, 1.4), Vec3::new(0.3, 2.0, -1.0));
        let found = register(&pairs(&pose), &[1.0; 6], 1e-3).unwrap();
        assert_eq!(found.used.len(), 6);
        assert!(found.world_from_head.rotation.angle_to(&pose.rotation) < 1e-7);
        assert!((found.world_from_head.translation.vector - pose.translation.vector).norm() < 1e-12);
    }

    #[test]
    fn two_swapped_markers_are_left_out() {
        let pose = Pose::new(Vec3::new(0.1, 0.0, 1.4), Vec3::new(0.0, 0.2, 0.5));
        let mut pairs = pairs(&pose);
        let seen = pairs[0].seen_m;
        pairs[0].seen_m = pairs[3].seen_m;
        pairs[3].seen_m = seen;
        let found = register(&pairs, &[1.0; 6], 2e-3).unwrap();
        assert_eq!(found.used, [1, 2, 4, 5]);
        assert!(found.world_from_head.rotation.angle_to(&pose.rotation) < 1e-7);
    }

    #[test]
    fn many_markers_are_not_tried_in_every_triple() {
        assert_eq!(tried(2).count(), 0);
        assert_eq!(tried(12).count(), 220, "all");
        for n in [14, 16, 24, 40, 64, 100] {
            let triples: Vec<[usize; 3]> = tried(n).collect();
            assert!((150..=MOST_TRIPLES).contains(&triples.len()), "{n} markers: {}", triples.len());
            let n_of = |k: usize| triples.iter().flatten().filter(|&&of| of == k).count();
            let (least, most) = ((0..n).map(n_of).min(), (0..n).map(n_of).max());
            assert!(least >= Some(3) && most <= least.map(|n| 4 * n), "{n} markers: {least:?} to {most:?}");
        }
    }

    /// A face set of 64, of which two thirds are somewhere else, each by itself.
    #[test]
    fn a_third_of_many_markers_is_enough() {
        let pose = Pose::new(Vec3::new(1.0, -2.0, 1.4), Vec3::new(0.3, 2.0, -1.0));
        let on_head = |k: usize| {
            let (turn, z) = (2.4 * k as f64, 1.0 - k as f64 / 32.0);
            Vec3::new(libm::cos(turn), libm::sin(turn), z) * 0.1
        };
        let off = |k: usize| Vec3::new((k % 5) as f64 - 2.0, (k % 7) as f64 - 3.0, 1.0) * 0.02;
        let pair = |k: usize| {
            let seen_m = pose.rotation * on_head(k) + pose.translation.vector;
            Pair {
                marker: k,
                place_m: on_head(k),
                seen_m: if k.is_multiple_of(3) { seen_m } else { seen_m + off(k) },
            }
        };
        let pairs: Vec<Pair> = (0..64).map(pair).collect();
        let found = register(&pairs, &[1.0; 64], 2e-3).unwrap();
        assert_eq!(found.used, (0..64).step_by(3).collect::<Vec<_>>());
        assert!(found.world_from_head.rotation.angle_to(&pose.rotation) < 1e-7);
    }

    #[test]
    fn markers_on_a_line_give_no_pose() {
        let on_line = |k: usize| Vec3::new(k as f64 * 0.05, 0.0, 0.0);
        let pairs: Vec<Pair> =
            (0..4).map(|k| Pair { marker: k, place_m: on_line(k), seen_m: on_line(k) }).collect();
        assert!(register(&pairs, &[1.0; 4], 1e-3).is_none());
    }
}

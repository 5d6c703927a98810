//! How alike two strands are: the distance of two places in a space made for it.

use tousle_core::{Groom, Strand, Vec3};

/// Places along a strand at which shapes are compared.
const N_SHARES: usize = 6;

/// Numbers that stand for a strand: its root, its shape, how it answers the wind.
pub(crate) const N: usize = 3 + 3 * N_SHARES + 1;

/// Where a strand is among all; the distance of two such places, m, says how little they are alike.
///
/// The squared distance is that of the roots, plus the mean squared distance of the shapes (points at the same
/// shares of the length, seen from the root), plus the square of half a mean strand's length times the difference
/// of ln(mass per length / width): a strand twice as heavy for its width is taken to move as differently as one
/// whose shape is off by a third of its length.
pub(crate) type Place = [f64; N];

/// The places of all strands.
pub(crate) fn places(groom: &Groom) -> Vec<Place> {
    let mean_length_m =
        groom.strands.iter().map(|s| lengths(&s.rest_curve_m).1).sum::<f64>() / groom.strands.len() as f64;
    groom.strands.iter().map(|strand| place(strand, mean_length_m)).collect()
}

pub(crate) fn squared_distance(a: &Place, b: &Place) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

fn place(strand: &Strand, mean_length_m: f64) -> Place {
    let mut place = [0.0; N];
    let root = strand.rest_curve_m[0];
    place[..3].copy_from_slice(root.as_slice());
    for (k, point) in at_even_shares(&strand.rest_curve_m).into_iter().enumerate() {
        let shape = (point - root) / (N_SHARES as f64).sqrt();
        place[3 + 3 * k..][..3].copy_from_slice(shape.as_slice());
    }
    let heaviness = libm::log(strand.linear_density_kg_per_m / strand.lock_width_m);
    place[N - 1] = 0.5 * mean_length_m * heaviness;
    place
}

/// Distance from the root along a polyline at each of its points, and its length.
pub(crate) fn lengths(curve: &[Vec3]) -> (Vec<f64>, f64) {
    let mut along = vec![0.0];
    let mut length = 0.0;
    for pair in curve.windows(2) {
        length += (pair[1] - pair[0]).norm();
        along.push(length);
    }
    (along, length)
}

/// Points at shares 1/n, 2/n, … 1 of a polyline's length.
fn at_even_shares(curve: &[Vec3]) -> [Vec3; N_SHARES] {
    let (along, length) = lengths(curve);
    std::array::from_fn(|k| {
        let wanted = length * (k + 1) as f64 / N_SHARES as f64;
        let end = along.partition_point(|a| *a < wanted).clamp(1, curve.len() - 1);
        let span = along[end] - along[end - 1];
        curve[end - 1].lerp(&curve[end], ((wanted - along[end - 1]) / span).clamp(0.0, 1.0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_do_not_depend_on_the_number_of_points() {
        let coarse = [Vec3::zeros(), Vec3::new(0.0, 0.0, -0.6)];
        let fine: Vec<Vec3> = [0.0, 0.05, 0.4, 0.6].map(|z| Vec3::new(0.0, 0.0, -z)).to_vec();
        for (a, b) in at_even_shares(&coarse).iter().zip(&at_even_shares(&fine)) {
            assert!((a - b).norm() < 1e-12);
        }
        assert!((at_even_shares(&fine)[0] - Vec3::new(0.0, 0.0, -0.1)).norm() < 1e-12);
    }
}

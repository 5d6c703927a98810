use tousle_core::{Along, Strand, Vec3};

/// One lock as a chain of straight sticks joined at its control points: where it is at rest, what it weighs and
/// how it resists bending.
///
/// Stick `j` (from 0) runs from point `j` to point `j + 1`. Arrays are one entry a stick; what belongs to a
/// point is stored with the stick that ends there, so that the root, which never moves, has no entry.
#[derive(Clone, Debug, PartialEq)]
pub struct Lock {
    /// Where it grows, head space, m.
    pub root_m: Vec3,
    /// Direction of each stick at rest, head axes, unit length.
    pub rest_directions: Vec<Vec3>,
    /// Length of each stick between its control points, m.
    pub lengths_m: Vec<f64>,
    /// Length of hair on each stick, m: the strand's own length shared out, since sticks cut its corners.
    pub hair_lengths_m: Vec<f64>,
    /// Distance of each point from the root, along the sticks, m.
    pub arcs_m: Vec<f64>,
    /// Mass at each point, kg: half of each stick that meets there.
    pub masses_kg: Vec<f64>,
    /// Resistance to bending of the joint at the root's end of each stick, N·m (per radian).
    pub joint_stiffness: Vec<f64>,
    /// Internal damping over stiffness, s.
    pub damping_secs: f64,
    /// Mass per length of hair, kg/m: the strand's own.
    pub linear_density_kg_per_m: f64,
    /// Mass per length of each stick's hair, kg/m.
    pub linear_densities_kg_per_m: Vec<f64>,
    /// Width across the wind, m: the strand's own.
    pub width_m: f64,
    /// Width across the wind of each stick, m.
    pub widths_m: Vec<f64>,
}

impl Lock {
    /// The lock of a strand that [`tousle_core::Groom::check`] has passed.
    ///
    /// Where a property changes along the strand a stick has the mean of what its two points say, and a joint what
    /// its own point says.
    ///
    /// A joint between two sticks stands for the bending of half of each, so its stiffness is the rod's over
    /// their mean length; the root is clamped and stands for half a stick, so its joint is twice as stiff as
    /// its stick alone. With these the tip of a chain under a load meets the rod's as the square of the length
    /// of a stick.
    pub fn new(strand: &Strand) -> Self {
        let points = &strand.rest_curve_m;
        let edges: Vec<Vec3> = points.windows(2).map(|p| p[1] - p[0]).collect();
        let lengths_m: Vec<f64> = edges.iter().map(Vec3::norm).collect();
        let polyline_m: f64 = lengths_m.iter().sum();
        let hair_per_stick = strand.length_m / polyline_m;
        let hair_lengths_m: Vec<f64> = lengths_m.iter().map(|l| l * hair_per_stick).collect();
        let n = lengths_m.len();
        let per_stick = |own: f64, along: &[f64]| -> Vec<f64> {
            (0..n).map(|j| own * (0.5 * (Along::at(along, j) + Along::at(along, j + 1)))).collect()
        };
        let linear_densities_kg_per_m =
            per_stick(strand.linear_density_kg_per_m, &strand.along.linear_density);
        let half_mass = |j: usize| 0.5 * linear_densities_kg_per_m[j] * hair_lengths_m[j];
        let masses_kg =
            (0..n).map(|j| half_mass(j) + if j + 1 < n { half_mass(j + 1) } else { 0.0 }).collect();
        let joint_stiffness = (0..n)
            .map(|j| {
                let bends_over =
                    if j == 0 { 0.5 * lengths_m[0] } else { 0.5 * (lengths_m[j - 1] + lengths_m[j]) };
                strand.bending_stiffness_n_m2 * Along::at(&strand.along.bending_stiffness, j) / bends_over
            })
            .collect();
        let arcs_m = lengths_m
            .iter()
            .scan(0.0, |arc, l| {
                *arc += l;
                Some(*arc)
            })
            .collect();
        Self {
            root_m: points[0],
            rest_directions: edges.iter().zip(&lengths_m).map(|(e, l)| e / *l).collect(),
            lengths_m,
            hair_lengths_m,
            arcs_m,
            masses_kg,
            joint_stiffness,
            damping_secs: strand.internal_damping_secs,
            linear_density_kg_per_m: strand.linear_density_kg_per_m,
            linear_densities_kg_per_m,
            width_m: strand.lock_width_m,
            widths_m: per_stick(strand.lock_width_m, &strand.along.width),
        }
    }

    /// How many sticks it has, at least one.
    pub fn n_sticks(&self) -> usize {
        self.lengths_m.len()
    }

    /// Length along the sticks, m: how far from its root the tip can get.
    pub fn reach_m(&self) -> f64 {
        self.arcs_m.last().copied().unwrap_or(0.0)
    }

    /// Whether all its joints resist bending: then it has a shape without load.
    pub(crate) fn is_stiff(&self) -> bool {
        self.joint_stiffness.iter().all(|k| *k > 0.0)
    }

    /// Its points at rest, from the root, head space, m.
    pub fn rest_points(&self) -> Vec<Vec3> {
        let mut points_m = vec![self.root_m; self.n_sticks() + 1];
        self.place(&self.rest_directions, &mut points_m[1..]);
        points_m
    }

    /// The far end of every stick when the sticks point along `directions`, head space, m.
    pub fn place(&self, directions: &[Vec3], ends_m: &mut [Vec3]) {
        let mut end = self.root_m;
        for ((direction, length), slot) in directions.iter().zip(&self.lengths_m).zip(ends_m) {
            end += direction * *length;
            *slot = end;
        }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A straight strand along a direction: 1 g/m, 4 mm wide, 1e-6 N·m².
    pub fn straight(root_m: Vec3, direction: Vec3, length_m: f64, n_sticks: usize) -> Strand {
        Strand {
            name: "straight".into(),
            rest_curve_m: (0..=n_sticks)
                .map(|k| root_m + direction * (length_m * k as f64 / n_sticks as f64))
                .collect(),
            length_m,
            linear_density_kg_per_m: 1e-3,
            lock_width_m: 4e-3,
            bending_stiffness_n_m2: 1e-6,
            internal_damping_secs: 0.02,
            along: Along::default(),
            holds_style: false,
        }
    }

    /// Two sticks of 10 cm at 1 g/m: the middle point carries 0.1 g, the tip 0.05 g; joints EI/5 cm and EI/10 cm.
    #[test]
    fn two_sticks_by_hand() {
        let lock = Lock::new(&straight(Vec3::zeros(), Vec3::x(), 0.2, 2));
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * b.abs());
        assert!(close(&lock.masses_kg, &[1e-4, 0.5e-4]), "{:?}", lock.masses_kg);
        assert!(close(&lock.joint_stiffness, &[2e-5, 1e-5]), "{:?}", lock.joint_stiffness);
        assert!(close(&lock.arcs_m, &[0.1, 0.2]));
    }

    /// The same, three times as heavy at its tip as at its root, half as wide and half as stiff.
    #[test]
    fn what_changes_along_a_lock() {
        let mut strand = straight(Vec3::zeros(), Vec3::x(), 0.2, 2);
        strand.along = Along {
            linear_density: vec![0.5, 1.0, 1.5],
            width: vec![1.5, 1.0, 0.5],
            bending_stiffness: vec![1.5, 1.0, 0.5],
        };
        let lock = Lock::new(&strand);
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12 * b.abs());
        assert!(close(&lock.linear_densities_kg_per_m, &[0.75e-3, 1.25e-3]));
        assert!(close(&lock.masses_kg, &[1e-4, 0.625e-4]), "{:?}", lock.masses_kg);
        assert!(close(&lock.widths_m, &[5e-3, 3e-3]), "{:?}", lock.widths_m);
        assert!(close(&lock.joint_stiffness, &[3e-5, 1e-5]), "{:?}", lock.joint_stiffness);
    }

    /// A clamped rod under a weak load across its tip bends by FL³/3EI.
    #[test]
    fn static_deflection_of_a_clamped_rod() {
        let (n, force) = (40, 1e-8);
        let lock = Lock::new(&straight(Vec3::zeros(), Vec3::x(), 0.2, n));
        let mut angle = 0.0;
        let mut deflection = 0.0;
        for j in 0..n {
            let near_end = lock.arcs_m[j] - lock.lengths_m[j];
            angle += force * (0.2 - near_end) / lock.joint_stiffness[j];
            deflection += angle * lock.lengths_m[j];
        }
        let expected = force * 0.2_f64.powi(3) / (3.0 * 1e-6);
        assert!((deflection / expected - 1.0).abs() < 1e-3, "{deflection} against {expected}");
    }
}

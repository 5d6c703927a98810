//! What each curve is made of, where a prim says so: primvars named as in JSON, SI whatever the stage's unit.

use tousle_usda::Prim;

use crate::along::mean_and_shares;
use crate::raw::RawStrand;

type Field = fn(&mut RawStrand) -> &mut Option<f64>;
type Shares = fn(&mut RawStrand) -> &mut Vec<f64>;

/// One value for all curves of a prim (`constant`) or one for each (`uniform`), and for some one for each point
/// (`vertex`, `varying`).
const PROPERTIES: [(&str, Field, Option<Shares>); 4] = [
    (
        "primvars:linear_density_kg_per_m",
        |s| &mut s.linear_density_kg_per_m,
        Some(|s| &mut s.along.linear_density),
    ),
    ("primvars:lock_width_m", |s| &mut s.lock_width_m, Some(|s| &mut s.along.width)),
    (
        "primvars:bending_stiffness_N_m2",
        |s| &mut s.bending_stiffness_n_m2,
        Some(|s| &mut s.along.bending_stiffness),
    ),
    ("primvars:internal_damping_time_s", |s| &mut s.internal_damping_secs, None),
];

/// Gives a prim's strands the properties it has.
pub(super) fn apply(prim: &Prim, path: &str, strands: &mut [RawStrand], warnings: &mut Vec<String>) {
    let n_points: usize = strands.iter().map(|s| s.points.len()).sum();
    for (name, field, shares) in PROPERTIES {
        let Some(values) = prim.numbers(name) else { continue };
        let is_indexed = prim.properties.contains_key(&format!("{name}:indices"));
        let by_point = shares.filter(|_| values.len() == n_points);
        let by_curve = values.len() == 1 || values.len() == strands.len();
        if is_indexed || !(by_curve || by_point.is_some()) {
            let n = values.len();
            let found = if is_indexed { "indices".to_owned() } else { format!("{n} values") };
            let expected = if shares.is_some() {
                "one value, or one a curve or a point"
            } else {
                "one value or one a curve"
            };
            warnings.push(format!("{path}.{name}: found {found}, expected {expected}: not used"));
            continue;
        }
        let mut rest = values;
        for (k, strand) in strands.iter_mut().enumerate() {
            if by_curve {
                *field(strand) = Some(values[if values.len() == 1 { 0 } else { k }]);
            } else if let Some(shares) = by_point {
                let (own, others) = rest.split_at(strand.points.len());
                rest = others;
                let (mean, along) = mean_and_shares(own);
                *field(strand) = Some(mean);
                *shares(strand) = along;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::read;

    #[test]
    fn properties_by_the_prim_and_by_the_curve() {
        let layer = b"#usda 1.0\n(metersPerUnit = 0.01 upAxis = \"Z\")\ndef BasisCurves \"c\" {
            uniform token type = \"linear\" int[] curveVertexCounts = [2, 2]
            point3f[] points = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (1, 0, 1)]
            float primvars:lock_width_m = 0.004 (interpolation = \"constant\")
            float[] primvars:linear_density_kg_per_m = [0.001, 0.002] (interpolation = \"uniform\")
            float[] primvars:bending_stiffness_N_m2 = [1, 3, 5, 5] (interpolation = \"vertex\")
            float[] primvars:internal_damping_time_s = [1, 2] (interpolation = \"uniform\")
            int[] primvars:internal_damping_time_s:indices = [1, 0] }";
        let raw = read(layer).unwrap();
        let [first, second] = &raw.strands[..] else { panic!("two strands") };
        assert_eq!(
            (first.lock_width_m, second.lock_width_m),
            (Some(0.004), Some(0.004)),
            "meters, not units"
        );
        assert_eq!(first.linear_density_kg_per_m, Some(0.001));
        assert_eq!(second.linear_density_kg_per_m, Some(0.002));
        assert_eq!((second.bending_stiffness_n_m2, second.internal_damping_secs), (Some(5.0), None));
        assert_eq!(first.bending_stiffness_n_m2, Some(2.0));
        assert_eq!(first.along.bending_stiffness, [0.5, 1.5]);
        assert_eq!(
            raw.warnings,
            [
                "/c.primvars:internal_damping_time_s: found indices, expected one value or one a curve: not used"
            ]
        );
    }
}

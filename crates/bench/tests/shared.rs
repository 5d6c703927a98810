//! The scores against the figures of the scoring programs, on the captures with truth beside them.
//!
//! Expected figures: `score.py` and `score_field.py`, run on predictions made of the truth by the formulas that
//! `perturbed` and `bent` repeat. The field's program draws 1,500 voxels of a region and step; for the figures
//! here that number was raised above all of them. With its own draw `nearby` and `elsewhere` differ by 1 % of
//! a median angle and by less than 0.005 in the rest.

use std::path::{Path, PathBuf};
use tousle_bench::{
    MotionScore, TrueMotion, Truth, VectorScore, never_moves, read_baselines, score_field, score_motion,
};
use tousle_core::{Quantity, StrandMotion, Vec3};

fn captures() -> Option<PathBuf> {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        eprintln!("skipped: TOUSLE_SHARED is not set");
        return None;
    };
    Some(Path::new(&shared).join("captures"))
}

/// The truth, each coordinate off by ((7 frame + 13 point + 5 axis) mod 11 − 5) · 4 mm.
fn perturbed(truth: &TrueMotion) -> StrandMotion {
    let n = truth.n_points();
    let mut positions_m = truth.positions_m.clone();
    for (i, position) in positions_m.iter_mut().enumerate() {
        for (axis, coordinate) in position.iter_mut().enumerate() {
            let step = ((7 * (i / n) + 13 * (i % n) + 5 * axis) % 11) as f64 - 5.0;
            *coordinate = (f64::from(*coordinate) + step * 0.004) as f32;
        }
    }
    let counts = truth.locks.iter().map(|(_, n)| *n).collect();
    StrandMotion { counts, times_secs: truth.times_secs.clone(), positions_m }
}

/// Every second frame, three fewer at the end.
fn halved(motion: &StrandMotion, rate_hz: f64) -> StrandMotion {
    let kept = motion.times_secs.len().div_ceil(2) - 3;
    StrandMotion {
        counts: motion.counts.clone(),
        times_secs: (0..kept).map(|k| k as f64 / rate_hz).collect(),
        positions_m: (0..kept).flat_map(|k| motion.frame(2 * k).to_vec()).collect(),
    }
}

fn check(score: &MotionScore, points: [f64; 6], tips: [f64; 6], locks: [f64; 4], beyond: usize) {
    for (found, expected) in [(&score.points, points), (&score.tips, tips)] {
        let found = [
            found.mean_mm,
            found.p95_mm,
            found.rms_mm,
            found.disp_rms_mm,
            found.explained_motion,
            found.explained_fluctuation,
        ];
        assert_close(&found, &expected, 1e-5);
    }
    let found = score.locks.as_ref().expect("locks that moved");
    assert_eq!(found.moved_over_10mm as f64, locks[0]);
    assert_close(&[found.explained_median, found.explained_10pct, found.share_over_half], &locks[1..], 1e-5);
    assert_eq!(score.frames_beyond_prediction, beyond);
    assert_eq!(score.missing_fraction, 0.0);
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance * e.abs().max(1.0), "found {found:?}, expected {expected:?}");
    }
}

#[test]
fn motions_score_as_the_program_scores_them() {
    let Some(captures) = captures() else { return };
    let truth = Truth::open(&captures.join("gusts_left")).unwrap().style_b().unwrap();
    let motion = perturbed(&truth);
    let score = score_motion(&motion, &truth).unwrap();
    check(
        &score,
        [21.653_451_95, 28.284_158_35, 21.908_934_92, 135.539_675_8, 0.838_357_774, 0.646_935_140_8],
        [21.654_941, 28.284_162_89, 21.910_301_48, 196.220_860_3, 0.888_338_571_9, 0.768_088_905_8],
        [59.0, 0.741_266_439_3, -0.266_340_927_8, 0.728_813_559_3],
        0,
    );
    let worst: Vec<String> = score.locks.unwrap().worst.into_iter().map(|(name, _)| name).collect();
    assert_eq!(worst, ["B27", "B12", "B21", "B04", "B09"]);
    check(
        &score_motion(&halved(&motion, 30.0), &truth).unwrap(),
        [17.619_081_54, 28.284_164_26, 20.141_574_76, 135.539_675_8, 0.851_397_204_3, 0.676_198_082_2],
        [18.378_908_91, 28.284_194_71, 23.341_992_45, 196.220_860_3, 0.881_042_248, 0.754_115_178_7],
        [59.0, 0.767_280_298_7, -0.067_096_122_1, 0.762_711_864_4],
        6,
    );
}

#[test]
fn markers_score_as_the_program_scores_them() {
    let Some(captures) = captures() else { return };
    let truth = Truth::open(&captures.join("two_fans")).unwrap().markers().unwrap();
    let motion = perturbed(&truth);
    check(
        &score_motion(&motion, &truth).unwrap(),
        [21.653_094_08, 28.284_040_37, 21.908_574_45, 75.896_743_39, 0.711_337_094_7, 0.607_537_172],
        [21.652_860_65, 28.284_048_14, 21.908_517_23, 114.567_131_3, 0.808_771_355_5, 0.746_534_466_3],
        [26.0, 0.660_814_799_1, 0.376_052_956_3, 0.807_692_307_7],
        0,
    );
    check(
        &score_motion(&halved(&motion, 60.0), &truth).unwrap(),
        [17.045_036_3, 25.925_386_05, 18.448_464_77, 75.896_743_39, 0.756_926_793_7, 0.669_595_061_9],
        [17.109_219_64, 28.283_843_29, 18.556_274_97, 114.567_131_3, 0.838_031_425_3, 0.785_378_226_4],
        [26.0, 0.714_636_814_8, 0.475_511_013_9, 0.846_153_846_2],
        6,
    );
}

/// The row of the baselines that needs no model: rest against truth, on every capture.
#[test]
fn never_moving_scores_as_the_baselines_say() {
    let Some(captures) = captures() else { return };
    let baselines = read_baselines(&std::fs::read_to_string(captures.join("BASELINES.md")).unwrap());
    assert_eq!(baselines.len(), 6 * 5);
    for row in baselines.iter().filter(|row| row.predictor == "never moves") {
        let truth = Truth::open(&captures.join(&row.capture)).unwrap().style_b().unwrap();
        let score = score_motion(&never_moves(&truth), &truth).unwrap();
        assert!((score.points.mean_mm - row.mean_mm).abs() <= 0.0501, "{row:?}: {score:?}");
        assert!((score.points.p95_mm - row.p95_mm).abs() <= 0.0501, "{row:?}: {score:?}");
        assert!(score.points.explained_motion.abs() < 1e-6);
        assert!(score.locks.unwrap().explained_median.abs() < 1e-6);
    }
}

/// Cosine, median angle, share within 30°, magnitude error, vector error, best scale, error at it.
type Figures = [f64; 7];

fn check_region(found: Option<VectorScore>, samples: Option<usize>, expected: Figures, tolerance: f64) {
    let found = found.expect("a region with voxels");
    assert!(samples.is_none_or(|n| n == found.samples), "{found:?}");
    let figures = [
        found.cos_mean,
        found.angle_median_deg / 10.0,
        found.within_30deg,
        found.magnitude_error_median,
        found.vector_error,
        found.best_scale,
        found.vector_error_best_scale,
    ];
    let expected = [0, 1, 2, 3, 4, 5, 6].map(|i| if i == 1 { expected[i] / 10.0 } else { expected[i] });
    assert_close(&figures, &expected, tolerance);
}

#[test]
fn fields_score_as_the_program_scores_them() {
    let Some(captures) = captures() else { return };
    let truth = Truth::open(&captures.join("gusts_left")).unwrap().wind().unwrap();
    let bent = |factor: f64, quantity: Quantity| {
        let mut field = truth.to_sequence();
        field.quantity = quantity;
        for step in &mut field.steps {
            for voxel in 0..truth.grid.n_voxels() {
                step.set_vector(voxel, step.vector(voxel) * factor + Vec3::new(0.3, -0.2, 0.1));
            }
        }
        field
    };
    let velocity = score_field(&bent(0.8, Quantity::AirVelocity), &truth).unwrap();
    check_region(
        velocity.hair,
        Some(39_250),
        [0.961_768_687, 11.482_024, 0.953_910_828, 0.156_934_083, 0.231_360_942, 1.171_314_24, 0.181_215_107],
        1e-5,
    );
    check_region(
        velocity.nearby,
        Some(268_063),
        [0.971_521_32, 10.843_316_08, 0.982_533_96, 0.159_221_05, 0.225_860_52, 1.180_078_98, 0.168_485_97],
        1e-5,
    );
    check_region(
        velocity.elsewhere,
        Some(2_619_318),
        [0.979_032_64, 9.755_137_44, 0.998_432_8, 0.164_506_38, 0.221_133_37, 1.186_848_16, 0.157_251_22],
        1e-5,
    );
    let force = score_field(&bent(1.7, Quantity::ForcePerMass), &truth).unwrap();
    check_region(
        force.hair,
        Some(39_250),
        [0.989_948_63, 5.578_507, 0.994_573_248, 0.537_672_639, 0.683_809_996, 2.839_668_036, 0.287_279_516],
        1e-5,
    );
    check_region(
        force.nearby,
        Some(268_063),
        [0.992_656_23, 5.252_214_43, 0.998_970_39, 0.556_540_85, 0.697_852_61, 3.006_861_93, 0.273_691_42],
        1e-5,
    );
    check_region(
        force.elsewhere,
        Some(2_619_318),
        [0.994_910_72, 4.702_487_95, 0.999_964_49, 0.599_732_64, 0.701_579_33, 3.099_820_14, 0.248_224_91],
        1e-5,
    );
}

#[test]
fn the_true_head_is_read() {
    let Some(captures) = captures() else { return };
    let still = Truth::open(&captures.join("gusts_left")).unwrap().head().unwrap();
    assert!((still.rate_hz - 120.0).abs() < 1e-3);
    assert!(still.is_still());
    let turning = Truth::open(&captures.join("nod_turn")).unwrap().head().unwrap();
    assert!(!turning.is_still());
}

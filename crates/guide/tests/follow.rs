//! Strands that follow: what they keep, and what they do as their guides do.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use nalgebra::Rotation3;
use tousle_core::{Groom, NoProgress, Strand, StrandMotion, Vec3};
use tousle_guide::{GuideError, Guides, choose, follow};

fn strand(rest_curve_m: Vec<Vec3>) -> Strand {
    let length_m = rest_curve_m.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    Strand {
        name: String::new(),
        rest_curve_m,
        length_m,
        linear_density_kg_per_m: 1e-3,
        lock_width_m: 4e-3,
        bending_stiffness_n_m2: 1e-6,
        internal_damping_secs: 0.016,
        along: tousle_core::Along::default(),
        holds_style: false,
    }
}

/// Noise without a library: a digit hash to [-1, 1).
fn noise(k: usize) -> f64 {
    let mut x = (k as u64).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A curl of `n` points that hangs from a place on the head.
fn curl(k: usize, n: usize) -> Strand {
    let root = Vec3::new(0.08 * noise(5 * k), 0.08 * noise(5 * k + 1), 0.1);
    let (length, radius) = (0.2 + 0.1 * noise(5 * k + 2), 0.01 * (1.0 + noise(5 * k + 3)));
    let phase = 3.0 * noise(5 * k + 4);
    let point = |i: usize| {
        let share = i as f64 / (n - 1) as f64;
        let (sin, cos) = libm::sincos(8.0 * share + phase);
        root + Vec3::new(
            radius * (cos - libm::cos(phase)),
            radius * (sin - libm::sin(phase)),
            -length * share,
        )
    };
    strand((0..n).map(point).collect())
}

fn curls(n: usize) -> Groom {
    Groom { strands: (0..n).map(|k| curl(k, 6 + k % 11)).collect(), assumed: Vec::new() }
}

/// A motion of a groom in which every stick is turned by what `turn` says for its strand, frame and share.
fn moved(
    groom: &Groom,
    n_frames: usize,
    turn: impl Fn(&Strand, usize, f64) -> Rotation3<f64>,
) -> StrandMotion {
    let mut positions_m = Vec::new();
    for frame in 0..n_frames {
        for strand in &groom.strands {
            let curve = &strand.rest_curve_m;
            let mut point = curve[0];
            positions_m.push(point.map(|c| c as f32).into());
            for (k, pair) in curve.windows(2).enumerate() {
                point +=
                    turn(strand, frame, (k as f64 + 0.5) / (curve.len() - 1) as f64) * (pair[1] - pair[0]);
                positions_m.push(point.map(|c| c as f32).into());
            }
        }
    }
    let times_secs = (0..n_frames).map(|k| k as f64 / 60.0).collect();
    StrandMotion { counts: groom.counts(), times_secs, positions_m }
}

/// A gust that bends hair about the y axis, more towards the tip and on the left.
fn gust(strand: &Strand, frame: usize, share: f64) -> Rotation3<f64> {
    let strength = 1.0 + 5.0 * strand.rest_curve_m[0].y;
    Rotation3::from_axis_angle(&Vec3::y_axis(), -0.12 * frame as f64 * share * strength)
}

fn point(p: [f32; 3]) -> Vec3 {
    Vec3::from(p.map(f64::from))
}

/// Every strand there twice, and a guide for each pair.
#[test]
fn a_guide_and_its_twin_move_alike() {
    let mut groom = curls(20);
    groom.strands.extend(curls(20).strands);
    let guides = choose(&groom, 20).unwrap();
    let motion = moved(&guides.groom(&groom), 20, gust);
    let all = follow(&groom, &guides, &motion, &NoProgress).unwrap();
    for (k, guide) in guides.strands().iter().enumerate() {
        let twin = (guide + 20) % 40;
        assert_eq!(guides.weights(twin), [(*guide, 1.0)], "it follows its twin alone");
        for frame in 0..20 {
            assert_eq!(all.strand(frame, *guide), motion.strand(frame, k), "guides move as simulated");
            let pairs = all.strand(frame, twin).iter().zip(all.strand(frame, *guide));
            assert!(pairs.clone().all(|(a, b)| (point(*a) - point(*b)).norm() < 2e-7), "frame {frame}");
        }
    }
}

/// A strand alike in shape, elsewhere, with one guide: the same motion, carried along.
#[test]
fn a_strand_of_the_same_shape_makes_the_same_motion() {
    let first = curl(1, 12);
    let shift = Vec3::new(0.01, -0.02, 0.003);
    let second = strand(first.rest_curve_m.iter().map(|p| p + shift).collect());
    let groom = Groom { strands: vec![first, second], assumed: Vec::new() };
    let guides = choose(&groom, 1).unwrap();
    let motion = moved(&guides.groom(&groom), 30, gust);
    let all = follow(&groom, &guides, &motion, &NoProgress).unwrap();
    for frame in 0..30 {
        for (a, b) in all.strand(frame, 0).iter().zip(all.strand(frame, 1)) {
            assert!((point(*b) - point(*a) - shift).norm() < 2e-7, "frame {frame}");
        }
    }
}

#[test]
fn lengths_and_roots_are_kept_and_rest_is_exact() {
    let groom = curls(200);
    let guides = choose(&groom, 20).unwrap();
    let motion = moved(&guides.groom(&groom), 40, gust);
    let all = follow(&groom, &guides, &motion, &NoProgress).unwrap();
    let mut at_rest = all.frame(0).iter();
    for (k, strand) in groom.strands.iter().enumerate() {
        for p in &strand.rest_curve_m {
            assert_eq!(at_rest.next().unwrap(), &<[f32; 3]>::from(p.map(|c| c as f32)), "strand {k} at rest");
        }
        for frame in 0..40 {
            let now = all.strand(frame, k);
            assert_eq!(now[0], all.strand(0, k)[0], "the root stays");
            for (pair, rest) in now.windows(2).zip(strand.rest_curve_m.windows(2)) {
                let (length, at_rest) =
                    ((point(pair[1]) - point(pair[0])).norm(), (rest[1] - rest[0]).norm());
                assert!(
                    (length / at_rest - 1.0).abs() < 1e-4,
                    "strand {k}, frame {frame}: {length} {at_rest}"
                );
            }
        }
    }
}

/// What follows is near to what the same gust does to it: the guides' turns are worth something.
#[test]
fn what_follows_moves_as_it_would_by_itself() {
    let groom = curls(400);
    let all = moved(&groom, 15, gust);
    let mut last = f64::INFINITY;
    for n in [10, 40, 160] {
        let guides = choose(&groom, n).unwrap();
        assert_eq!(guides.strands().len(), n);
        let sample = guides.sample(100);
        let followed = follow(&groom, &guides, &moved(&guides.groom(&groom), 15, gust), &NoProgress).unwrap();
        let truth = moved(&Guides::groom_of(&groom, &sample), 15, gust);
        let error = tousle_guide::compare(&followed, &truth, &sample).unwrap();
        println!("{n} guides: {error:?}");
        assert!(error.mean_mm < 0.9 * last, "{n} guides: {error:?}");
        last = error.mean_mm;
        let everyone: Vec<usize> = (0..400).collect();
        assert!(tousle_guide::compare(&all, &all, &everyone).unwrap().max_mm == 0.0);
    }
    assert!(last < 6.0, "{last} mm");
}

/// The order of strands and the number of threads change nothing.
#[test]
fn order_and_threads_do_not_matter() {
    let groom = curls(120);
    let order: Vec<usize> = (0..120).map(|k| (k * 77 + 13) % 120).collect();
    let shuffled = Guides::groom_of(&groom, &order);
    let run = |groom: &Groom| {
        let guides = choose(groom, 15).unwrap();
        let all = follow(groom, &guides, &moved(&guides.groom(groom), 10, gust), &NoProgress).unwrap();
        (guides, all)
    };
    let on =
        |n: usize| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(|| run(&groom));
    let (guides, all) = on(1);
    assert!((guides.clone(), all.clone()) == on(3));
    let (other_guides, other) = run(&shuffled);
    let mut chosen: Vec<usize> = other_guides.strands().iter().map(|k| order[*k]).collect();
    chosen.sort_unstable();
    assert_eq!(chosen, guides.strands());
    for (k, original) in order.iter().enumerate() {
        for frame in 0..10 {
            let pairs = other.strand(frame, k).iter().zip(all.strand(frame, *original));
            assert!(pairs.clone().all(|(a, b)| (point(*a) - point(*b)).norm() < 1e-6));
        }
    }
}

/// Two guides swing apart until they point against one another, and over; what hangs between them never jumps.
#[test]
fn nothing_pops_between_guides_that_swing_apart() {
    let straight = |x: f64, y: f64, n: usize| {
        let root = Vec3::new(x, y, 0.1);
        strand((0..n).map(|k| root - Vec3::z() * (0.2 * k as f64 / (n - 1) as f64)).collect())
    };
    let mut strands = vec![straight(-0.05, 0.0, 9), straight(0.05, 0.0, 9)];
    strands.extend((0..21).map(|k| straight(0.001 * f64::from(k) - 0.01, 0.0, 5 + k as usize % 9)));
    let groom = Groom { strands, assumed: Vec::new() };
    let guides = choose(&groom, 3).unwrap();
    let n_frames = 720;
    let swing = |strand: &Strand, frame: usize, share: f64| {
        let angle = frame as f64 * 0.5_f64.to_radians() * (0.3 + 0.7 * share);
        let side = strand.rest_curve_m[0].x.signum();
        // A little off one plane, as real wind is.
        Rotation3::from_axis_angle(&Vec3::y_axis(), -side * angle)
            * Rotation3::from_axis_angle(&Vec3::x_axis(), 0.1 * side * libm::sin(angle))
    };
    let motion = moved(&guides.groom(&groom), n_frames, swing);
    let all = follow(&groom, &guides, &motion, &NoProgress).unwrap();
    let mut worst = 0.0_f64;
    for k in 0..groom.strands.len() {
        for frame in 1..n_frames {
            let pairs = all.strand(frame, k).windows(2).zip(all.strand(frame - 1, k).windows(2));
            for (now, before) in pairs {
                let [now, before] = [now, before].map(|p| (point(p[1]) - point(p[0])).normalize());
                worst = worst.max(now.angle(&before));
            }
        }
    }
    println!("the fastest turn of a stick: {:.2} degrees a frame, the guides' 0.5", worst.to_degrees());
    assert!(worst.to_degrees() < 6.0, "{}", worst.to_degrees());
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let groom = curls(10);
    assert!(matches!(choose(&groom, 0), Err(GuideError::NoGuides)));
    let guides = choose(&groom, 99).unwrap();
    assert_eq!(guides.strands().len(), 10, "no more guides than strands");
    assert!(guides.sample(5).is_empty());
    let guides = choose(&groom, 3).unwrap();
    let motion = moved(&guides.groom(&groom), 2, gust);
    let all = moved(&groom, 2, gust);
    assert!(matches!(follow(&groom, &guides, &all, &NoProgress), Err(GuideError::BadMotion { .. })));
    let fewer = StrandMotion { times_secs: vec![0.0], ..motion.clone() };
    assert!(matches!(follow(&groom, &guides, &fewer, &NoProgress), Err(GuideError::BadMotion { .. })));
    assert!(matches!(follow(&curls(9), &guides, &motion, &NoProgress), Err(GuideError::OtherGroom { .. })));
    let same = Groom { strands: vec![curl(0, 5); 4], assumed: Vec::new() };
    assert_eq!(choose(&same, 3).unwrap().strands().len(), 1, "twins need one guide");
    for k in 0..10 {
        let weights = guides.weights(k);
        assert!((weights.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(weights[0].1 >= 0.55);
    }
}

//! The public door: a swinging wig of three locks, spoiled in every way, and mended.

#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::sync::Mutex;
use tousle_clean::{CleanError, CleanOptions, Cleaned, clean};
use tousle_core::{
    HeadCapture, HeadPose, NoProgress, Pose, Progress, SampleKind, Session, StrandMarker, StrandSpec,
    StrandTracks, Track, UnlabeledTrack, Vec3,
};

const N_FRAMES: usize = 360;
const N_MARKERS: usize = 4;

/// Three locks, 3 cm apart, four markers each, 3 cm apart.
fn session() -> Session {
    let marker = |k: usize, m: usize| StrandMarker {
        label: format!("S{k}_{m}"),
        distance_from_root_m: Some(0.03 * m as f64),
        mass_kg: 1e-5,
    };
    let strand = |k: usize| StrandSpec {
        name: format!("S{k}"),
        length_m: 0.13,
        linear_density_kg_per_m: 3e-3,
        lock_width_m: 7e-3,
        root_m: Vec3::new(0.0, 0.03 * k as f64, 0.0),
        markers: (1..=N_MARKERS).map(|m| marker(k, m)).collect(),
    };
    Session {
        rate_hz: Some(120.0),
        still_frames: Some((1, 100)),
        wind_start_frame: Some(101),
        strands: (0..3).map(strand).collect(),
        ..Session::unknown("three locks")
    }
}

/// A lock that hangs still for 100 frames, then swings and bends, with 0.1 mm of noise.
fn position(k: usize, m: usize, frame: usize) -> Vec3 {
    let secs = (frame.max(100) - 100) as f64 / 120.0;
    let ramp = (secs * 4.0).min(1.0);
    let mut p = Vec3::new(0.0, 0.03 * k as f64, 0.0);
    for j in 1..=m {
        let bend = j as f64 * 0.15;
        let phase = 9.0 * secs + 0.8 * k as f64 - bend;
        let (sin, cos) = libm::sincos(ramp * (0.4 * libm::sin(phase) + 0.2 * libm::sin(1.7 * phase + bend)));
        p += 0.03 * Vec3::new(sin, 0.0, -cos);
    }
    let noise = |axis: usize| {
        let seed = ((frame * 31 + k * 7 + m) * 3 + axis) as u64;
        let mixed = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let hash = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        ((hash >> 40) as f64 / (1u64 << 24) as f64 - 0.5) * 3.5e-4
    };
    p + Vec3::new(noise(0), noise(1), noise(2))
}

fn capture() -> HeadCapture {
    capture_of(N_FRAMES)
}

fn capture_of(n_frames: usize) -> HeadCapture {
    let track = |k: usize, m: usize| (0..n_frames).map(|f| Some(position(k, m, f))).collect();
    let strand =
        |k: usize| StrandTracks { strand_idx: k, markers: (1..=N_MARKERS).map(|m| track(k, m)).collect() };
    let pose = HeadPose::exact(Pose::identity(), 8);
    HeadCapture {
        rate_hz: 120.0,
        first_frame: 1,
        poses: vec![Some(pose); n_frames],
        strands: (0..3).map(strand).collect(),
        unlabeled: Vec::new(),
    }
}

/// Root mean square distance from what was there before it was spoiled, m.
fn error(head: &HeadCapture, k: usize, m: usize, frames: std::ops::Range<usize>) -> f64 {
    let n = frames.len() as f64;
    let track = &head.strands[k].markers[m - 1];
    (frames.map(|f| (track.at(f).unwrap() - position(k, m, f)).norm_squared()).sum::<f64>() / n).sqrt()
}

#[test]
fn what_is_clean_is_left_alone() {
    let head = capture();
    let cleaned = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    assert_eq!(cleaned.head, head);
    let report = &cleaned.report;
    assert!(report.swaps.is_empty() && report.spikes.is_empty() && report.gaps.is_empty());
    assert!(
        cleaned.samples.iter().flatten().flatten().all(|s| s.kind == SampleKind::Seen && s.error_m < 4e-4)
    );
    // Uniform noise 0.35 mm wide has a deviation of 0.1 mm.
    let noise_m = report.markers[0].noise_m.unwrap();
    assert!((noise_m - 1e-4).abs() < 4e-5, "{noise_m}");
}

#[test]
fn a_swap_is_mended_and_named() {
    let mut head = capture();
    for f in 200..260 {
        let a = head.strands[0].markers[2].at(f);
        let b = head.strands[1].markers[2].at(f);
        head.strands[0].markers[2].set(f, b);
        head.strands[1].markers[2].set(f, a);
    }
    let cleaned = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    assert_eq!(cleaned.head, capture());
    let [swap] = &cleaned.report.swaps[..] else { panic!("{:?}", cleaned.report.swaps) };
    assert_eq!(swap.markers, ["S0_3", "S1_3"]);
    assert_eq!((swap.span.first_frame, swap.span.last_frame), (201, 260));
    assert_eq!(cleaned.samples[0][2][230].kind, SampleKind::Mended);
    assert_eq!(cleaned.samples[0][2][260].kind, SampleKind::Seen);
}

/// Both are out of sight where the exchange begins, for so long that any motion would do: only its end shows.
#[test]
fn a_swap_that_begins_in_a_gap_is_told_by_the_lock() {
    let mut head = capture();
    for f in 200..260 {
        let a = head.strands[0].markers[2].at(f);
        let b = head.strands[1].markers[1].at(f);
        head.strands[0].markers[2].set(f, b);
        head.strands[1].markers[1].set(f, a);
    }
    (190..214).for_each(|f| head.strands[0].markers[2].set(f, None));
    (184..210).for_each(|f| head.strands[1].markers[1].set(f, None));
    let cleaned = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    assert!(error(&cleaned.head, 0, 3, 0..N_FRAMES) < 2e-3, "{}", error(&cleaned.head, 0, 3, 0..N_FRAMES));
    assert!(error(&cleaned.head, 1, 2, 0..N_FRAMES) < 2e-3, "{}", error(&cleaned.head, 1, 2, 0..N_FRAMES));
    let [swap] = &cleaned.report.swaps[..] else { panic!("{:?}", cleaned.report.swaps) };
    assert_eq!((swap.span.first_frame, swap.span.last_frame), (211, 260));
}

#[test]
fn a_swap_from_the_first_frame_is_told_by_the_lock() {
    let mut head = capture();
    for f in 0..150 {
        let a = head.strands[0].markers[0].at(f);
        let b = head.strands[2].markers[3].at(f);
        head.strands[0].markers[0].set(f, b);
        head.strands[2].markers[3].set(f, a);
    }
    let cleaned = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    assert_eq!(cleaned.head, capture());
    assert_eq!(cleaned.report.swaps[0].span.first_frame, 1);
    assert_eq!(cleaned.report.swaps[0].span.last_frame, 150);
}

#[test]
fn a_spike_is_cut_and_a_gap_filled_with_the_error_it_has() {
    let mut head = capture();
    let spiked = head.strands[1].markers[1].at(220).map(|p| p + Vec3::new(0.0, 0.0, 0.03));
    head.strands[1].markers[1].set(220, spiked);
    (240..285).for_each(|f| head.strands[2].markers[2].set(f, None));
    (320..N_FRAMES).for_each(|f| head.strands[0].markers[3].set(f, None));
    let cleaned = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    let report = &cleaned.report;
    assert_eq!(report.spikes.len(), 1);
    assert_eq!((report.spikes[0].marker.as_str(), report.spikes[0].span.first_frame), ("S1_2", 221));
    assert_eq!(report.gaps.len(), 3);
    for (k, m, frames) in [(1, 2, 220..221), (2, 3, 240..285), (0, 4, 320..N_FRAMES)] {
        let found = error(&cleaned.head, k, m, frames.clone());
        let gap = report.gaps.iter().find(|g| g.marker == format!("S{k}_{m}")).unwrap();
        assert!(found < 3e-3 && found < 3.0 * gap.expected_error_m + 2e-4, "{found}: {gap:?}");
        assert!(frames.clone().all(|f| cleaned.samples[k][m - 1][f].kind == SampleKind::Filled));
    }
}

/// Of any length, at either end of the capture, and so far off that a square overflows: none is learned from.
#[test]
fn what_is_too_far_from_its_lock_is_refused() {
    let mut head = capture();
    let away_m = Vec3::new(3.0, 3.0, 2.0);
    for (k, m, frames, times) in [(0, 2, 200..210, 1.0), (1, 3, 0..1, 1.0), (2, 4, 300..N_FRAMES, 1e200)] {
        for f in frames {
            let place_m = head.strands[k].markers[m - 1].at(f).map(|p| p + away_m * times);
            head.strands[k].markers[m - 1].set(f, place_m);
        }
    }
    let mut missing = head.clone();
    let missed = [(0, 2, 200..210), (1, 3, 0..1), (2, 4, 300..N_FRAMES)];
    for (k, m, frames) in missed.clone() {
        frames.for_each(|f| missing.strands[k].markers[m - 1].set(f, None));
    }
    let cleaned = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    let as_if_missing = clean(&missing, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    assert_eq!((&cleaned.head, &cleaned.samples), (&as_if_missing.head, &as_if_missing.samples));
    let far = &cleaned.report.far;
    let found: Vec<(&str, i64, i64)> =
        far.iter().map(|f| (&*f.marker, f.span.first_frame, f.span.last_frame)).collect();
    assert_eq!(found, [("S0_2", 201, 210), ("S1_3", 1, 1), ("S2_4", 301, 360)]);
    assert!((far[0].distance_m - 4.69).abs() < 0.05 && (far[0].reach_m - 0.125).abs() < 1e-9, "{:?}", far[0]);
    let warnings = cleaned.report.warnings();
    assert_eq!(warnings.len(), 3);
    assert_eq!(
        warnings[1],
        "lock S1: found markers farther from its root than hair lets them be, and left them out: \
         S1_3 up to 4.65 m, expected at most 0.16 m (frames 1 to 1, 1 in all)"
    );
    assert_eq!(as_if_missing.report.warnings(), [""; 0]);
}

/// A tip of one lock under the label of another's first marker is out of its reach, and still somebody's.
#[test]
fn what_an_exchange_explains_is_not_refused() {
    let mut session = session();
    session.strands[2].root_m.y = 0.3;
    let aside_m = Vec3::y() * 0.24;
    let mut spoiled = capture();
    for marker in &mut spoiled.strands[2].markers {
        *marker = marker.map(|_, p| Some(p + aside_m));
    }
    let right = spoiled.clone();
    for f in 200..260 {
        let a = spoiled.strands[0].markers[0].at(f);
        let b = spoiled.strands[2].markers[3].at(f);
        spoiled.strands[0].markers[0].set(f, b);
        spoiled.strands[2].markers[3].set(f, a);
    }
    let cleaned = clean(&spoiled, &session, &CleanOptions::default(), &NoProgress).unwrap();
    assert_eq!(cleaned.head, right);
    assert_eq!((cleaned.report.swaps.len(), &cleaned.report.far[..]), (1, &[][..]));
}

/// Or cleaning an hour would take the square of what a minute takes.
#[test]
fn a_gap_is_filled_from_what_is_near_in_time() {
    let mut long = capture_of(2000);
    (200..220).for_each(|f| long.strands[1].markers[1].set(f, None));
    let mut lost_later = long.clone();
    let later = lost_later.strands[1].markers.iter_mut().skip(1);
    later.for_each(|marker| (1500..2000).for_each(|f| marker.set(f, None)));
    let [long, lost_later] = [long, lost_later]
        .map(|head| clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap());
    let filled = |cleaned: &Cleaned| -> Vec<_> {
        (200..220).map(|f| (cleaned.head.strands[1].markers[1].at(f), cleaned.samples[1][1][f])).collect()
    };
    assert_eq!(filled(&long), filled(&lost_later));
    assert!(error(&long.head, 1, 2, 200..220) < 3e-3);
}

/// Who watches hears of every piece and every gap, to the last.
#[test]
fn progress_is_told() {
    #[derive(Default)]
    struct Heard(Mutex<Vec<(u64, u64)>>);
    impl Progress for Heard {
        fn at(&self, done: u64, total: u64) {
            self.0.lock().unwrap().push((done, total));
        }
    }
    let heard = Heard::default();
    clean(&with_piece_and_ghost(), &session(), &CleanOptions::default(), &heard).unwrap();
    let mut heard = heard.0.into_inner().unwrap();
    // Two pieces; then what is left of the gap on either side of the one that is given back.
    heard.sort_unstable();
    assert_eq!(heard, [(1, 2), (1, 2), (2, 2), (2, 2)]);
}

/// A capture with a piece of `S1_3` in a gap of its own, and a ghost beside it.
fn with_piece_and_ghost() -> HeadCapture {
    let mut head = capture();
    let mut piece = Track::missing(N_FRAMES);
    for f in 150..230 {
        head.strands[1].markers[2].set(f, None);
        if (170..200).contains(&f) {
            piece.set(f, Some(position(1, 3, f)));
        }
    }
    let mut ghost = Track::missing(N_FRAMES);
    (160..190).for_each(|f| ghost.set(f, Some(Vec3::new(0.04, 0.05, 0.03))));
    head.unlabeled.push(UnlabeledTrack { label: "*1".to_owned(), track: ghost });
    head.unlabeled.push(UnlabeledTrack { label: "*2".to_owned(), track: piece });
    head
}

/// A ghost is as likely as hair is where hair can be, however far off something else was seen.
#[test]
fn a_sample_at_the_end_of_the_world_makes_no_hair_of_a_ghost() {
    let mut head = with_piece_and_ghost();
    head.strands[0].markers[0].set(0, Some(Vec3::repeat(1e27)));
    let report = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap().report;
    assert_eq!((report.far.len(), report.ghosts.len(), report.given_back.len()), (1, 1, 1));
    assert_eq!(report.ghosts[0].piece, "*1");
}

#[test]
fn a_piece_is_given_back_and_a_ghost_refused() {
    let head = with_piece_and_ghost();
    let cleaned = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    let [given] = &cleaned.report.given_back[..] else { panic!("{:?}", cleaned.report.given_back) };
    assert_eq!((given.piece.as_str(), given.marker.as_str()), ("*2", "S1_3"));
    assert_eq!((given.span.first_frame, given.span.last_frame), (171, 200));
    assert_eq!(cleaned.report.ghosts.len(), 1);
    assert_eq!(cleaned.report.ghosts[0].piece, "*1");
    assert_eq!(cleaned.head.unlabeled.len(), 1, "only the ghost is left");
    assert_eq!(cleaned.samples[1][2][180].kind, SampleKind::GivenBack);
    assert!(error(&cleaned.head, 1, 3, 170..200) < 1e-12);
}

#[test]
fn a_marker_never_seen_stays_missing_and_is_named() {
    let mut head = capture();
    head.strands[0].markers[1] = Track::missing(N_FRAMES);
    let cleaned = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap();
    assert_eq!(cleaned.report.unfilled.len(), 1);
    assert_eq!(cleaned.report.unfilled[0].marker, "S0_2");
    assert_eq!(cleaned.samples[0][1][7].kind, SampleKind::Missing);
    assert!(cleaned.samples[0][1][7].error_m.is_infinite());
}

#[test]
fn another_sessions_locks_are_an_error() {
    let mut head = capture();
    head.strands[1].markers.pop();
    let error = clean(&head, &session(), &CleanOptions::default(), &NoProgress).unwrap_err();
    assert!(matches!(error, CleanError::Markers { strand_idx: 1, found: 3, expected: 4 }));
    assert_eq!(error.to_string(), "lock 1 of the capture: found 3 markers, expected 4 as in the session");
    head.strands.pop();
    assert!(matches!(
        clean(&head, &session(), &CleanOptions::default(), &NoProgress),
        Err(CleanError::Locks { .. })
    ));
}

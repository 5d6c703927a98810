//! Cleaning against the truth of captures that a stranger does not have (`TOUSLE_SHARED`).

#![allow(clippy::unwrap_used, reason = "a test that cannot read its data has failed")]

use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::sync::LazyLock;
use tousle_bench::Truth;
use tousle_clean::{CleanOptions, CleanReport, Cleaned, clean};
use tousle_core::{HeadCapture, NoProgress, Sample, SampleKind, Session, Track, Vec3};
use tousle_head::{HeadOptions, locate_head};
use tousle_ingest::{IngestOptions, read_capture, read_session};
use tousle_tests::{name, shared_captures};

/// Gaps by length: the last frame count of each class.
const CLASSES: [usize; 5] = [10, 20, 40, 80, usize::MAX];

/// The captures, each cleaned once for all tests.
static CASES: LazyLock<Vec<Case>> =
    LazyLock::new(|| shared_captures().iter().map(|folder| Case::open(folder)).collect());

/// A cleaned capture and what really was.
struct Case {
    session: Session,
    raw: HeadCapture,
    cleaned: Cleaned,
    /// True positions, head space, m, `[marker][frame]`, markers in the session's order.
    truth: Vec<Vec<Vec3>>,
    events: Value,
}

impl Case {
    fn open(folder: &Path) -> Self {
        let name = name(folder);
        let session = read_session(&fs::read(folder.join("session.json")).unwrap()).unwrap();
        let bytes = fs::read(folder.join(format!("{name}.csv"))).unwrap();
        let capture = read_capture(&bytes, &IngestOptions::from_session(&session)).unwrap().capture;
        let raw = locate_head(&capture, &session, &HeadOptions::default()).unwrap().head;
        let begin = std::time::Instant::now();
        let cleaned = clean(&raw, &session, &CleanOptions::default(), &NoProgress).unwrap();
        println!("{name}: cleaned in {:.1} s", begin.elapsed().as_secs_f64());
        let motion = Truth::open(folder).unwrap().markers().unwrap();
        let n = session.strands.iter().map(|s| s.markers.len()).sum();
        let track = |m: usize| {
            let of_marker = motion.positions_m.iter().skip(m).step_by(n);
            of_marker.map(|p| Vec3::from(p.map(f64::from))).collect()
        };
        let truth = (0..n).map(track).collect();
        let facts = fs::read(folder.join("truth").join("truth.json")).unwrap();
        let events = serde_json::from_slice::<Value>(&facts).unwrap()["events"].clone();
        Self { session, raw, cleaned, truth, events }
    }

    fn report(&self) -> &CleanReport {
        &self.cleaned.report
    }

    fn swaps(&self) -> &Vec<Value> {
        self.events["label_swaps"].as_array().unwrap()
    }

    fn nameless(&self, kind: &str) -> Vec<&Value> {
        self.events["ghosts"].as_array().unwrap().iter().filter(|g| g["kind"] == kind).collect()
    }

    /// Cleaned tracks, marker after marker, with where each sample comes from.
    fn tracks(&self) -> impl Iterator<Item = (&Track, &Vec<Sample>)> {
        let tracks = self.cleaned.head.strands.iter().flat_map(|s| &s.markers);
        tracks.zip(self.cleaned.samples.iter().flatten())
    }
}

fn frames(event: &Value) -> (i64, i64) {
    (event["first_frame"].as_i64().unwrap(), event["last_frame"].as_i64().unwrap())
}

/// Swaps with the right pair and, within two frames, the right span.
fn swaps_found(case: &Case) -> usize {
    let found = |event: &&Value| {
        let (first, last) = frames(event);
        let pair = BTreeSet::from([event["a"].as_str().unwrap(), event["b"].as_str().unwrap()]);
        case.report().swaps.iter().any(|s| {
            BTreeSet::from([s.markers[0].as_str(), s.markers[1].as_str()]) == pair
                && s.span.first_frame.abs_diff(first) <= 2
                && s.span.last_frame.abs_diff(last) <= 2
        })
    };
    case.swaps().iter().filter(found).count()
}

/// Pieces given to the marker they are of.
fn pieces_given_back(case: &Case) -> usize {
    let given = |event: &&&Value| {
        let (first, last) = frames(event);
        case.report().given_back.iter().any(|g| {
            g.marker == event["of"].as_str().unwrap()
                && g.span.first_frame.abs_diff(first) <= 2
                && g.span.last_frame.abs_diff(last) <= 2
        })
    };
    case.nameless("unlabelled piece").iter().filter(given).count()
}

/// Ghosts that no marker got.
fn ghosts_refused(case: &Case) -> usize {
    let refused = |event: &&&Value| {
        let (first, _) = frames(event);
        case.report().ghosts.iter().any(|g| g.span.first_frame.abs_diff(first) <= 2)
    };
    case.nameless("ghost").iter().filter(refused).count()
}

#[test]
fn swaps_are_found_pieces_given_back_and_ghosts_refused() {
    for case in &*CASES {
        let report = case.report();
        let (swaps, pieces, ghosts) =
            (case.swaps().len(), case.nameless("unlabelled piece").len(), case.nameless("ghost").len());
        let (found, given, refused) = (swaps_found(case), pieces_given_back(case), ghosts_refused(case));
        println!(
            "  swaps {found}/{swaps} ({} claimed), pieces {given}/{pieces} ({} given), ghosts {refused}/{ghosts}, spikes {}",
            report.swaps.len(),
            report.given_back.len(),
            report.spikes.len(),
        );
        for swap in &report.swaps {
            println!("    {swap:?}");
        }
        for piece in &report.given_back {
            println!("    {piece:?}");
        }
        for ghost in &report.ghosts {
            println!("    {ghost:?}");
        }
        assert_eq!(report.swaps.len(), found, "false alarms among {:?}", report.swaps);
        assert_eq!(found, swaps, "of {:?}", case.swaps());
        assert_eq!(refused, ghosts);
        assert_eq!(report.given_back.len(), given, "wrongly given: {:?}", report.given_back);
        assert_eq!(report.spikes, [], "the captures have none");
        // A piece in the middle of a long gap may be told from nothing: refusing is no lie.
        assert!(3 * given >= 2 * pieces, "given {given} of {pieces}");
    }
}

/// Squared errors of several ways to fill, by gap length.
#[derive(Default)]
struct Errors {
    n: usize,
    squares: [f64; 5],
}

#[test]
fn gaps_are_filled_nearer_than_by_lines_and_splines() {
    for case in &*CASES {
        let mut classes: [Errors; 5] = Default::default();
        for (marker, (track, samples)) in case.tracks().enumerate() {
            add_errors(case, marker, track, samples, &mut classes);
        }
        println!("  gap frames |     n |   ours | expected | line | spline in head | in world   (rms, mm)");
        let mut total = Errors::default();
        for (class, most) in classes.iter().zip(CLASSES) {
            let what = if most == usize::MAX { "more".to_owned() } else { format!("to {most}") };
            print_row(&what, class);
            total.n += class.n;
            (0..5).for_each(|k| total.squares[k] += class.squares[k]);
        }
        print_row("all", &total);
        let [ours, expected, line, spline, world] = total.squares.map(|s| (s / total.n as f64).sqrt());
        assert!(
            ours < 0.7 * line && ours < 0.7 * spline && ours < 0.7 * world,
            "{ours} {line} {spline} {world}"
        );
        assert!(expected > 0.33 * ours && expected < 3.0 * ours, "expected {expected}, found {ours}");
    }
}

fn print_row(what: &str, errors: &Errors) {
    let rms = errors.squares.map(|s| format!("{:6.2}", 1e3 * (s / errors.n.max(1) as f64).sqrt()));
    println!("  {what:>10} | {:5} | {}", errors.n, rms.join(" | "));
}

fn add_errors(case: &Case, marker: usize, track: &Track, samples: &[Sample], classes: &mut [Errors; 5]) {
    let filled = |f: usize| samples[f].kind == SampleKind::Filled;
    let seen: Track = track.iter().enumerate().map(|(f, p)| p.filter(|_| !filled(f))).collect();
    // The session's places of the head markers carry a hand's error, which moves the whole head's axes: what
    // is the same in all seen frames is none of the fill's.
    let truth = &case.truth[marker];
    let bias = (0..seen.n_frames()).filter_map(|f| Some(seen.at(f)? - truth[f])).sum::<Vec3>()
        / seen.n_valid().max(1) as f64;
    let pose = |f: usize| case.raw.poses[f].as_ref().map(|p| p.world_from_head);
    let in_world = seen.map(|f, p| Some(pose(f)?.transform_point(&p.into()).coords));
    let world_spline = spline(&in_world).map(|f, p| Some(pose(f)?.inverse_transform_point(&p.into()).coords));
    let others = [line(&seen), spline(&seen), world_spline];
    let mut start = 0;
    while let Some(first) = (start..seen.n_frames()).find(|f| filled(*f)) {
        let end = (first..seen.n_frames()).find(|f| !filled(*f)).unwrap_or(seen.n_frames());
        let class = &mut classes[CLASSES.iter().position(|most| end - first <= *most).unwrap()];
        for f in first..end {
            let error = |t: &Track| t.at(f).map_or(0.0, |p| (p - truth[f] - bias).norm_squared());
            class.n += 1;
            class.squares[0] += error(track);
            class.squares[1] += samples[f].error_m * samples[f].error_m;
            (0..3).for_each(|k| class.squares[2 + k] += error(&others[k]));
        }
        start = end;
    }
}

/// Labels exchanged by us in captures that have none, near neighbors in space, at the edge of gaps too: the
/// six captures have five swaps, too few to tell a share from.
#[test]
fn exchanges_made_by_us_are_found() {
    for case in CASES.iter().filter(|case| case.swaps().is_empty()) {
        let session = &case.session;
        let labels: Vec<&str> =
            session.strands.iter().flat_map(|s| &s.markers).map(|m| m.label.as_str()).collect();
        let (mut made, mut found, mut claimed) = (0, 0, 0);
        for seed in 0..4u64 {
            let mut dirty = case.raw.clone();
            let exchanged = exchange_some(&mut dirty, seed);
            let report = clean(&dirty, session, &CleanOptions::default(), &NoProgress).unwrap().report;
            let is_found = |(pair, first, last): &&([usize; 2], i64, i64)| {
                let right = |s: &tousle_clean::SwapMended| {
                    BTreeSet::from(s.markers.each_ref().map(String::as_str))
                        == BTreeSet::from(pair.map(|m| labels[m]))
                        && s.span.first_frame.abs_diff(*first) <= 2
                        && s.span.last_frame.abs_diff(*last) <= 2
                };
                report.swaps.iter().any(right)
            };
            made += exchanged.len();
            claimed += report.swaps.len();
            found += exchanged.iter().filter(is_found).count();
            for lost in exchanged.iter().filter(|e| !is_found(e)) {
                println!("    not found: {:?} {lost:?}", lost.0.map(|m| labels[m]));
            }
        }
        println!("  found {found} of {made} exchanges, {claimed} claimed");
        assert!(10 * found >= 9 * made, "found {found} of {made}");
        assert!(20 * (claimed - found) <= made, "{claimed} claimed, {found} right");
    }
}

/// Exchanges the labels of six pairs that are 8 to 40 mm apart, each marker once; the last pair to the end.
fn exchange_some(head: &mut HeadCapture, seed: u64) -> Vec<([usize; 2], i64, i64)> {
    let mut tracks: Vec<Track> = head.strands.iter().flat_map(|s| s.markers.clone()).collect();
    let n_frames = head.n_frames();
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1);
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let (mut done, mut used) = (Vec::new(), BTreeSet::new());
    while done.len() < 6 {
        let (a, b) = (random(tracks.len()), random(tracks.len()));
        let first = 20 + random(n_frames - 100);
        let end = if done.len() == 5 { n_frames } else { (first + 10 + random(100)).min(n_frames) };
        let near = tracks[a].at(first).zip(tracks[b].at(first)).map(|(p, q)| (p - q).norm());
        let seen = |m: usize, f: usize| {
            f >= n_frames || (tracks[m].at(f).is_some() && tracks[m].at(f - 1).is_some())
        };
        // One of the two may come out of a gap, or go into one, as its label is exchanged.
        let clear =
            near.is_some_and(|d| (0.008..0.04).contains(&d)) && [first, end].iter().all(|f| seen(a, *f));
        let is_new = a != b && !used.contains(&a) && !used.contains(&b);
        if !(clear && is_new && tracks[b].at(end - 1).is_some()) {
            continue;
        }
        used.extend([a, b]);
        for f in first..end {
            let (p, q) = (tracks[a].at(f), tracks[b].at(f));
            tracks[a].set(f, q);
            tracks[b].set(f, p);
        }
        done.push(([a, b], head.first_frame + first as i64, head.first_frame + end as i64 - 1));
    }
    let mut tracks = tracks.into_iter();
    head.strands.iter_mut().flat_map(|s| &mut s.markers).for_each(|t| *t = tracks.next().unwrap());
    done
}

fn knots(track: &Track) -> Vec<(usize, Vec3)> {
    track.iter().enumerate().filter_map(|(f, p)| Some((f, p?))).collect()
}

/// The knots round a frame: the last before or at it and the first after it, held at the ends.
fn around(knots: &[(usize, Vec3)], frame: usize) -> Option<(usize, usize)> {
    let after = knots.partition_point(|(f, _)| *f <= frame);
    let last = knots.len().checked_sub(1)?;
    Some((after.saturating_sub(1), after.min(last)))
}

fn line(track: &Track) -> Track {
    let knots = knots(track);
    let at = |f: usize| {
        let (a, b) = around(&knots, f)?;
        let ((fa, pa), (fb, pb)) = (knots[a], knots[b]);
        Some(if fa < fb && fa <= f { pa + (pb - pa) * ((f - fa) as f64 / (fb - fa) as f64) } else { pb })
    };
    (0..track.n_frames()).map(at).collect()
}

/// The natural cubic spline through all samples; held before the first and after the last.
fn spline(track: &Track) -> Track {
    let knots = knots(track);
    let n = knots.len();
    // Second derivatives at the knots, by elimination of the tridiagonal system.
    let mut second = vec![Vec3::zeros(); n];
    let mut upper = vec![0.0; n];
    let h = |k: usize| (knots[k + 1].0 - knots[k].0) as f64;
    let slope = |k: usize| (knots[k + 1].1 - knots[k].1) / h(k);
    for k in 1..n.saturating_sub(1) {
        let diagonal = 2.0 * (h(k - 1) + h(k)) - h(k - 1) * upper[k - 1];
        upper[k] = h(k) / diagonal;
        second[k] = (6.0 * (slope(k) - slope(k - 1)) - h(k - 1) * second[k - 1]) / diagonal;
    }
    for k in (1..n.saturating_sub(1)).rev() {
        second[k] = second[k] - upper[k] * second[k + 1];
    }
    let at = |f: usize| {
        let (a, b) = around(&knots, f)?;
        let ((fa, pa), (fb, pb)) = (knots[a], knots[b]);
        if fa >= fb || f < fa {
            return Some(pb);
        }
        let (h, u) = ((fb - fa) as f64, (f - fa) as f64 / (fb - fa) as f64);
        let cubic = |u: f64| u * u * u - u;
        Some(pa * (1.0 - u) + pb * u + (second[a] * cubic(1.0 - u) + second[b] * cubic(u)) * (h * h / 6.0))
    };
    (0..track.n_frames()).map(at).collect()
}

#[test]
fn a_spline_keeps_a_straight_line() {
    let track: Track = (0..9).map(|f| (!(3..7).contains(&f)).then(|| Vec3::x() * f64::from(f))).collect();
    assert!((spline(&track).at(5).unwrap().x - 5.0).abs() < 1e-12);
    assert!((line(&track).at(5).unwrap().x - 5.0).abs() < 1e-12);
}

use tousle_core::{Capture, Session, StrandSpec};

/// Why a session does not go with a capture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckError {
    /// The session names markers that the capture does not have.
    #[error("the session names markers that are not in the capture: {}", list(missing))]
    MissingMarkers {
        /// The markers, in the session's order.
        missing: Vec<MissingMarker>,
    },
    /// Several subjects of the capture wear markers of the session's names.
    #[error("marker {label}: found it on the subjects {subjects}, expected one: pass the subject")]
    SeveralSubjects {
        /// The first such marker.
        label: String,
        /// Who wears it.
        subjects: String,
    },
}

/// A marker that a session names and a capture does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingMarker {
    /// The marker.
    pub label: String,
    /// A label of the capture that is spelled nearly so.
    pub nearest: Option<String>,
}

/// Checks that the session's markers are in the capture; gives warnings for what is odd but can be used.
///
/// Programs leave out markers that were never labeled in a trial: what is not there counts as never seen, and is warned of, as long as
/// the rest can be used.
///
/// # Errors
/// [`CheckError`] if more than half of all markers are missing (then the session is of something else), if fewer than three of the
/// head's are there, or none of any lock; or if it is not clear whose a marker is.
pub fn check_against(capture: &Capture, session: &Session) -> Result<Vec<String>, CheckError> {
    let missing: Vec<MissingMarker> = session_labels(session)
        .filter(|label| capture.trajectory(label).is_none())
        .map(|label| MissingMarker { label: label.to_owned(), nearest: nearest(label, capture, session) })
        .collect();
    if !missing.is_empty() && !is_enough(capture, session, missing.len()) {
        return Err(CheckError::MissingMarkers { missing });
    }
    session_labels(session).try_for_each(|label| check_subject(label, capture))?;
    let mut warnings = absences(&missing, capture, session);
    warnings.extend(oddities(capture, session));
    Ok(warnings)
}

/// Whether a head and hair are left without the markers that are missing.
fn is_enough(capture: &Capture, session: &Session, n_missing: usize) -> bool {
    const LEAST_OF_HEAD: usize = 3;
    let is_there = |label: &str| capture.trajectory(label).is_some();
    let of_head = session.head_markers.iter().filter(|m| is_there(&m.label)).count();
    let some_lock = session.strands.iter().flat_map(|s| &s.markers).any(|m| is_there(&m.label));
    2 * n_missing <= session_labels(session).count() && of_head >= LEAST_OF_HEAD && some_lock
}

fn absences(missing: &[MissingMarker], capture: &Capture, session: &Session) -> Vec<String> {
    let mut warnings = Vec::new();
    if !missing.is_empty() {
        warnings.push(format!(
            "markers of the session that are not in the capture count as never seen: {}",
            list(missing)
        ));
    }
    let is_there =
        |strand: &StrandSpec| strand.markers.iter().any(|m| capture.trajectory(&m.label).is_some());
    let without: Vec<&str> =
        session.strands.iter().filter(|s| !is_there(s)).map(|s| s.name.as_str()).collect();
    if !without.is_empty() {
        warnings.push(format!("locks without a marker in the capture are left out: {}", without.join(", ")));
    }
    warnings
}

fn session_labels(session: &Session) -> impl Iterator<Item = &str> {
    let head = session.head_markers.iter().map(|m| m.label.as_str());
    head.chain(session.strands.iter().flat_map(|s| s.markers.iter().map(|m| m.label.as_str())))
}

fn check_subject(label: &str, capture: &Capture) -> Result<(), CheckError> {
    let mut subjects: Vec<&str> = capture
        .trajectories
        .iter()
        .filter(|t| t.label == label)
        .map(|t| t.subject.as_deref().unwrap_or("(none)"))
        .collect();
    subjects.sort_unstable();
    subjects.dedup();
    if subjects.len() > 1 {
        return Err(CheckError::SeveralSubjects { label: label.to_owned(), subjects: subjects.join(", ") });
    }
    Ok(())
}

fn oddities(capture: &Capture, session: &Session) -> Vec<String> {
    let mut warnings = Vec::new();
    let mut warn = |text: String| warnings.push(text);
    if let Some(rate) = session.rate_hz
        && (rate - capture.rate_hz).abs() > 1e-3 * capture.rate_hz
    {
        warn(format!("the session says {rate} frames a second, the capture {}", capture.rate_hz));
    }
    let last_frame = capture.first_frame.saturating_add_unsigned(capture.n_frames as u64).saturating_sub(1);
    let inside = |frame: i64| (capture.first_frame..=last_frame).contains(&frame);
    if let Some((first, last)) =
        session.still_frames.filter(|(first, last)| !inside(*first) || !inside(*last))
    {
        let all =
            if session.still_range(capture.first_frame, capture.n_frames).is_some() { " all" } else { "" };
        warn(format!(
            "still frames {first} to {last} are not{all} in the capture (frames {} to {last_frame})",
            capture.first_frame
        ));
    }
    if let Some(start) = session.wind_start_frame.filter(|&start| start > last_frame) {
        warn(format!(
            "the wind starts about frame {start}, by the session; the capture ends with frame {last_frame}"
        ));
    }
    if let (Some(file), Some(session)) = (capture.up_axis, session.up_axis)
        && file != session
    {
        warn(format!("the capture says {file:?} is up, the session {session:?}"));
    }
    for label in session_labels(session) {
        let n_tracks = capture.trajectories.iter().filter(|t| t.label == label).count();
        if n_tracks > 1 {
            warn(format!("marker {label} is in the capture {n_tracks} times; the first is taken"));
        }
        if capture.trajectory(label).is_some_and(|t| t.track.n_valid() == 0) {
            warn(format!("marker {label} was never seen"));
        }
    }
    warnings
}

/// The label of the capture that is fewest typing errors away, if they are few enough to be that; of several,
/// the one that begins like it for longest. None that the session names itself.
fn nearest(label: &str, capture: &Capture, session: &Session) -> Option<String> {
    let is_taken = |other: &str| session_labels(session).any(|own| own == other);
    let candidates = capture.trajectories.iter().filter(|t| !t.is_unlabeled() && !is_taken(&t.label));
    let rank = |other: &str| {
        let n_alike = label.chars().zip(other.chars()).take_while(|(a, b)| a == b).count();
        (distance(&fold(label), &fold(other)), std::cmp::Reverse(n_alike))
    };
    let ((errors, _), best) = candidates.map(|t| (rank(&t.label), &t.label)).min_by_key(|(rank, _)| *rank)?;
    (errors <= 1 + label.chars().count() / 4).then(|| best.clone())
}

/// Case and the marks people put between words say little.
fn fold(label: &str) -> Vec<char> {
    label.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// Levenshtein's distance: letters to insert, drop or change.
pub(crate) fn distance(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, from) in a.iter().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, to) in b.iter().enumerate() {
            let change = diagonal + usize::from(from != to);
            diagonal = row[j + 1];
            row[j + 1] = change.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

fn list(missing: &[MissingMarker]) -> String {
    const LONGEST: usize = 8;
    let one = |m: &MissingMarker| match &m.nearest {
        Some(nearest) => format!("{} (the capture has {nearest})", m.label),
        None => m.label.clone(),
    };
    let mut text: Vec<String> = missing.iter().take(LONGEST).map(one).collect();
    if missing.len() > LONGEST {
        text.push(format!("and {} more", missing.len() - LONGEST));
    }
    text.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{IngestOptions, read_capture, read_session};

    const SESSION: &str = r#"{"rate_hz": 100, "up_axis": "Z", "still_frames": [1, 50],
        "head_markers_mm_in_head_frame": {"A": [100, 0, 0], "B": [0, 80, 0], "C": [-100, 0, 0]},
        "strands": [{"strand": "S01", "length_mm": 200, "root_mm": [0, 0, 100], "markers": ["S01_1", "S01_2"]}]}"#;

    /// A capture of one frame in which these markers are seen.
    fn capture(labels: &[&str]) -> Capture {
        let names: String = labels.iter().map(|label| format!(",{label},,")).collect();
        let (axes, cells) = (",X,Y,Z".repeat(labels.len()), ",1.5,2,3".repeat(labels.len()));
        let units = ",mm".repeat(3 * labels.len());
        let text = format!("Trajectories\n120\n,{names}\nFrame,Sub Frame{axes}\n,{units}\n1,0{cells}\n");
        read_capture(text.as_bytes(), &IngestOptions::default()).unwrap().capture
    }

    fn check(labels: &[&str]) -> Result<Vec<String>, CheckError> {
        check_against(&capture(labels), &read_session(SESSION.as_bytes()).unwrap())
    }

    #[test]
    fn too_few_markers_come_with_their_nearest_labels() {
        let error = check(&["A", "B", "S01_1", "s012", "*1"]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "the session names markers that are not in the capture: C, S01_2 (the capture has s012)"
        );
        for too_few in [&["B", "C", "S01_1", "S01_2"][..], &["A", "B", "C", "D"], &["D", "E"]] {
            assert!(matches!(check(too_few), Err(CheckError::MissingMarkers { .. })), "{too_few:?}");
        }
    }

    /// Half of ten are missing, a lock's only one among them.
    #[test]
    fn a_missing_marker_counts_as_never_seen() {
        let lock = |name: &str, markers: &str| {
            format!(
                r#"{{"strand": "{name}", "length_mm": 200, "root_mm": [0, 0, 100], "markers": [{markers}]}}"#
            )
        };
        let strands = [lock("S01", r#""a", "b""#), lock("S02", r#""c", "d", "e""#), lock("S03", r#""f""#)];
        let text = format!(
            r#"{{"head_markers_mm_in_head_frame": {{"A": [100, 0, 0], "B": [0, 80, 0], "C": [-100, 0, 0], "D": [0, 0, 9]}},
                "strands": [{}]}}"#,
            strands.join(", ")
        );
        let session = read_session(text.as_bytes()).unwrap();
        assert_eq!(
            check_against(&capture(&["A", "B", "C", "b", "e"]), &session).unwrap(),
            [
                "markers of the session that are not in the capture count as never seen: D, a, c, d, f",
                "locks without a marker in the capture are left out: S03",
            ],
        );
    }

    #[test]
    fn one_label_on_two_subjects_is_ambiguous() {
        let error = check(&["X:A", "Y:A", "B", "C", "S01_1", "S01_2"]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "marker A: found it on the subjects X, Y, expected one: pass the subject"
        );
    }

    #[test]
    fn contradictions_are_warned_of() {
        assert_eq!(
            check(&["A", "B", "C", "S01_1", "S01_2", "S01_2"]).unwrap(),
            [
                "the session says 100 frames a second, the capture 120",
                "still frames 1 to 50 are not all in the capture (frames 1 to 1)",
                "marker S01_2 is in the capture 2 times; the first is taken",
            ]
        );
    }

    #[test]
    fn frames_that_are_not_there_are_warned_of() {
        let frames = r#""still_frames": [0, 0], "wind_starts_about_frame": 2"#;
        let session = SESSION
            .replace("\"rate_hz\": 100", "\"rate_hz\": 120")
            .replace("\"still_frames\": [1, 50]", frames);
        let session = read_session(session.as_bytes()).unwrap();
        assert_eq!(
            check_against(&capture(&["A", "B", "C", "S01_1", "S01_2"]), &session).unwrap(),
            [
                "still frames 0 to 0 are not in the capture (frames 1 to 1)",
                "the wind starts about frame 2, by the session; the capture ends with frame 1",
            ]
        );
    }

    #[test]
    fn distances_are_typing_errors() {
        let letters = |word: &str| word.chars().collect::<Vec<_>>();
        for (a, b, errors) in
            [("LFHD", "LFHD", 0), ("LFHD", "LHFD", 2), ("", "abc", 3), ("widht", "width", 2)]
        {
            assert_eq!(distance(&letters(a), &letters(b)), errors, "{a} {b}");
        }
    }
}

//! When hair hung still: as the session says, as the start of the wind tells, as the capture shows.

use tousle_core::{Assumption, Capture, FrameSpan, HeadCapture, Session};
use tousle_head::StillFound;

/// Fewer frames before the wind tell nothing of how the head and the hair rest: noise and a wrong label need some to be told by.
const LEAST_FRAMES: i64 = 5;

/// Leaves a session with still frames that the capture has, or with none.
///
/// Those that it names and that are not there at all are dropped (`check_against` warns of them). Where none are left, those before
/// the wind are taken, if the session says when it starts.
pub(crate) fn settle(session: &mut Session, capture: &Capture) {
    if session.still_range(capture.first_frame, capture.n_frames).is_none() {
        session.still_frames = None;
        if let Some((still, assumption)) = before_the_wind(session, capture) {
            session.still_frames = Some((still.first_frame, still.last_frame));
            session.assumed.push(assumption);
        }
    }
}

/// The capture's frames before the wind starts, but for the last tenth, as nobody knows to the frame when it does.
fn before_the_wind(session: &Session, capture: &Capture) -> Option<(FrameSpan, Assumption)> {
    let start = session.wind_start_frame?;
    let n_before = start.saturating_sub(capture.first_frame);
    let n_still = n_before.saturating_sub(n_before / 10);
    // A wind that starts when the capture is over is a slip of the pen, and says nothing of when hair was still.
    if n_still < LEAST_FRAMES || usize::try_from(n_before).is_ok_and(|n| n > capture.n_frames) {
        return None;
    }
    let still = FrameSpan::of(capture.first_frame, &(0..usize::try_from(n_still).ok()?));
    let assumption = Assumption {
        what: "still_frames".to_owned(),
        value: format!("[{}, {}]", still.first_frame, still.last_frame),
        why: format!("hair hangs still until the wind starts, about frame {start}"),
    };
    Some((still, assumption))
}

/// Looks for still frames in a capture of which nobody says any; says whether there are some.
pub(crate) fn find(session: &mut Session, head: &HeadCapture) -> bool {
    if session.still_frames.is_some() {
        return false;
    }
    let Some(still) = tousle_head::find_still(head) else { return false };
    session.still_frames = Some((still.span.first_frame, still.span.last_frame));
    session.assumed.push(hangs_still(&still));
    true
}

/// What is said of still frames that nobody named.
fn hangs_still(still: &StillFound) -> Assumption {
    Assumption {
        what: "still_frames".to_owned(),
        value: format!("[{}, {}]", still.span.first_frame, still.span.last_frame),
        // Rounded up, to a tenth of a millimeter.
        why: format!(
            "within a quarter of a second the locks move by less than {:.1} mm there, and by {:.0} mm where they move most",
            ((still.moves_m * 1e4).floor() + 1.0) / 10.0,
            still.moves_else_m * 1e3
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SESSION: &str = r#"{
        "head_markers_mm_in_head_frame": {"A": [100, 0, 0], "B": [0, 80, 0], "C": [-100, 0, 0]},
        "strands": [{"strand": "S01", "length_mm": 200, "root_mm": [0, 0, 100], "markers": ["S01_1"]}], "more": 0}"#;

    /// The still frames of a session with these fields, in a capture of 1000 frames from 5000 on, and how many assumptions tell of
    /// them.
    fn settled(fields: &str) -> (Option<(i64, i64)>, usize) {
        let mut session =
            tousle_ingest::read_session(SESSION.replace("\"more\": 0", fields).as_bytes()).unwrap();
        let (rate_hz, file_unit, up_axis) = (100.0, None, None);
        let (first_frame, n_frames, trajectories) = (5000, 1000, Vec::new());
        settle(&mut session, &Capture { rate_hz, first_frame, n_frames, file_unit, up_axis, trajectories });
        let n_said = session.assumed.iter().filter(|assumed| assumed.what == "still_frames").count();
        (session.still_frames, n_said)
    }

    #[test]
    fn hair_is_still_before_the_wind() {
        assert_eq!(settled("\"wind_starts_about_frame\": 5120"), (Some((5000, 5107)), 1));
        for not_in_the_capture in [5002, 5000, 121, 0, 7000, i64::MIN, i64::MAX] {
            let fields = format!("\"wind_starts_about_frame\": {not_in_the_capture}");
            assert_eq!(settled(&fields), (None, 0), "{fields}");
        }
    }

    #[test]
    fn what_is_named_is_taken_if_it_is_there() {
        let wind = "\"wind_starts_about_frame\": 5120";
        assert_eq!(settled(&format!("\"still_frames\": [5010, 5099], {wind}")), (Some((5010, 5099)), 0));
        assert_eq!(settled(&format!("\"still_frames\": [1, 5099], {wind}")), (Some((1, 5099)), 0));
        assert_eq!(settled(&format!("\"still_frames\": [1, 120], {wind}")), (Some((5000, 5107)), 1));
        assert_eq!(settled("\"still_frames\": [1, 120]"), (None, 0));
    }
}

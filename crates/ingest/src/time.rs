use crate::IngestError;
use crate::recording::Frames;

/// How many positions may stand, seen or not, for each byte of a file. Written out, a position takes 10 to 30 bytes:
/// files that keep one frame in fifty pass, and memory stays within a hundred times the file.
const MOST_POSITIONS_A_BYTE: usize = 4;

/// Where each row of a file goes in time.
#[derive(Debug)]
pub(crate) struct Rows {
    /// Frames from the first row's to the last row's, both included.
    pub n_frames: usize,
    /// The frame (from 0) of each row; the row's own index if absent.
    frame_of_row: Option<Vec<usize>>,
}

impl Rows {
    /// Rows by their frame numbers, which must rise; frames that they skip stay empty.
    pub fn of(
        frames: &Frames,
        n_points: usize,
        file_len: usize,
        warnings: &mut Vec<String>,
    ) -> Result<Self, IngestError> {
        let listed = match frames {
            Frames::From { n_rows, .. } => return Ok(Self { n_frames: *n_rows, frame_of_row: None }),
            Frames::Listed(listed) => listed,
        };
        if let Some(pair) = listed.windows(2).find(|pair| pair[1] <= pair[0]) {
            return Err(IngestError::FramesNotRising { frame: pair[1], previous: pair[0] });
        }
        let (first, last, rows) = (frames.first(), frames.last(), listed.len());
        let span = last.checked_sub(first).and_then(|span| usize::try_from(span).ok()?.checked_add(1));
        let most_frames = file_len.saturating_mul(MOST_POSITIONS_A_BYTE) / n_points.max(1);
        let Some(n_frames) = span.filter(|&n_frames| n_frames <= most_frames) else {
            return Err(IngestError::FramesTooFarApart { first, last, rows });
        };
        let n_skipped = n_frames - rows;
        warnings.push(format!(
            "the file skips {n_skipped} of the frames {first} to {last}; they count as not seen"
        ));
        // The frames rise from `first` to `last`: each lies within the span that was just checked.
        let frame_of_row = listed.iter().map(|frame| (frame - first) as usize).collect();
        Ok(Self { n_frames, frame_of_row: Some(frame_of_row) })
    }

    /// The frame (from 0) of a row (from 0).
    pub fn frame(&self, row: usize) -> usize {
        self.frame_of_row.as_ref().map_or(row, |frames| frames[row])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn skipped_frames_leave_room() {
        let mut warnings = Vec::new();
        let rows = Rows::of(&Frames::listed(vec![7, 8, 11]), 2, 30, &mut warnings).unwrap();
        assert_eq!(rows.n_frames, 5);
        assert_eq!([0, 1, 2].map(|row| rows.frame(row)), [0, 1, 4]);
        assert_eq!(warnings, ["the file skips 2 of the frames 7 to 11; they count as not seen"]);
    }

    #[test]
    fn frames_that_go_back_or_far_away_are_refused() {
        let error = |frames: Vec<i64>| {
            Rows::of(&Frames::listed(frames), 2, 30, &mut Vec::new()).unwrap_err().to_string()
        };
        assert_eq!(error(vec![1, 2, 2]), "frame 2 comes after frame 2, expected rising frame numbers");
        assert_eq!(
            error(vec![i64::MIN, i64::MAX]),
            "found frames -9223372036854775808 to 9223372036854775807 in 2 rows, expected frames nearer to one another"
        );
        // Two points in 30 bytes: 60 frames could be there, 61 could not.
        assert!(Rows::of(&Frames::listed(vec![1, 60]), 2, 30, &mut Vec::new()).is_ok());
        assert!(Rows::of(&Frames::listed(vec![1, 61]), 2, 30, &mut Vec::new()).is_err());
    }
}

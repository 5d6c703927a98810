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
        let (listed, lines) = match frames {
            Frames::From { n_rows, .. } => return Ok(Self { n_frames: *n_rows, frame_of_row: None }),
            Frames::Listed { frames, lines } => (frames, lines),
        };
        check_steps(listed, lines)?;
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

/// Frame numbers rise, and no gap among them is longer than all rows together.
///
/// Every frame between is computed with, so one digit too many in one number would cost minutes and gigabytes for nothing. Who cuts
/// a piece out of a capture leaves more than is missing. Rows are counted as far apart as most are: a file may keep one frame in ten.
fn check_steps(frames: &[i64], lines: &[u64]) -> Result<(), IngestError> {
    let rows = frames.len();
    let pairs = || frames.windows(2).zip(&lines[1..]).map(|(pair, &line)| (line, pair[0], pair[1]));
    if let Some((line, previous, frame)) = pairs().find(|(_, previous, frame)| frame <= previous) {
        return Err(IngestError::FramesNotRising { line, frame, previous });
    }
    let mut steps: Vec<u64> = frames.windows(2).map(|pair| pair[1].abs_diff(pair[0])).collect();
    steps.sort_unstable();
    let usual = steps[(steps.len() - 1) / 2];
    let is_long = |(_, previous, frame): &(u64, i64, i64)| frame.abs_diff(*previous) / usual > rows as u64;
    match pairs().find(is_long) {
        Some((line, previous, frame)) => Err(IngestError::LongGap { line, frame, previous, rows }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of these frames below five lines of header, of two points in a file of 30 bytes.
    fn rows(frames: Vec<i64>, warnings: &mut Vec<String>) -> Result<Rows, IngestError> {
        let lines = (6..6 + frames.len() as u64).collect();
        Rows::of(&Frames::listed(frames, lines), 2, 30, warnings)
    }

    #[test]
    fn skipped_frames_leave_room() {
        let mut warnings = Vec::new();
        let rows = rows(vec![7, 8, 11], &mut warnings).unwrap();
        assert_eq!(rows.n_frames, 5);
        assert_eq!([0, 1, 2].map(|row| rows.frame(row)), [0, 1, 4]);
        assert_eq!(warnings, ["the file skips 2 of the frames 7 to 11; they count as not seen"]);
    }

    #[test]
    fn frames_that_go_back_or_far_away_are_refused() {
        let error = |frames: Vec<i64>| rows(frames, &mut Vec::new()).unwrap_err().to_string();
        assert_eq!(
            error(vec![1, 2, 2]),
            "line 8: found frame 2 after frame 2, expected rising frame numbers"
        );
        assert_eq!(
            error(vec![i64::MIN, i64::MAX]),
            "found frames -9223372036854775808 to 9223372036854775807 in 2 rows, expected frames nearer to one another"
        );
        // Two points in 30 bytes: 60 frames could be there, 61 could not.
        assert!(rows(vec![1, 60], &mut Vec::new()).is_ok());
        assert!(rows(vec![1, 61], &mut Vec::new()).is_err());
    }

    #[test]
    fn a_gap_longer_than_all_rows_is_a_slip() {
        let check = |frames: Vec<i64>| rows(frames, &mut Vec::new()).map(|rows| rows.n_frames);
        assert_eq!(
            check(vec![1, 2, 3, 40]).unwrap_err().to_string(),
            "line 9: found frame 40 after frame 3, expected no gap longer than the 4 rows of the file together"
        );
        assert!(check(vec![-9, 1, 2, 3]).is_err() && check(vec![1, 2, 30, 31]).is_err());
        assert_eq!(check(vec![1, 2, 3, 7]).unwrap(), 7, "as long as all rows");
        assert_eq!(check(vec![0, 10, 20, 30]).unwrap(), 31, "one frame in ten");
        assert_eq!(check(vec![0, 10, 20, 50]).unwrap(), 51);
    }
}

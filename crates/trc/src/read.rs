use crate::line::{Line, Lines, Separator, filled_len};
use crate::{Header, TrcError, header};
use tousle_cells::{Decimals, Numbers, half_positions, lost_digits, plain, text, whole};

/// A TRC file.
#[derive(Clone, Debug, PartialEq)]
pub struct Trc {
    /// What the header says.
    pub header: Header,
    /// The frame number of each row, as the file counts.
    pub frames: Vec<i64>,
    /// The line of each row in the file, from 1.
    pub lines: Vec<u64>,
    /// The time of each row, s, where the file gives it.
    pub times_secs: Vec<Option<f64>>,
    /// The markers that have a label, in the file's order.
    pub markers: Vec<Marker>,
    /// Frames that the header claims and whole rows that are there, of a file with fewer rows that has no end of its last line.
    pub cut: Option<(u64, u64)>,
    /// What was odd but could be read.
    pub warnings: Vec<String>,
}

/// One marker of a TRC.
#[derive(Clone, Debug, PartialEq)]
pub struct Marker {
    /// The label, blanks around it cut off.
    pub label: String,
    /// The position in each row, in the file's own unit; `None` where a cell is blank, not there, or NaN.
    pub positions: Vec<Option<[f64; 3]>>,
}

/// Reads a TRC.
///
/// # Errors
/// [`TrcError`] if the header breaks off, if a row does not begin with a frame number and a time, if a cell of a
/// marker holds anything but a number, or if a line separated by commas has more cells than there are labels for.
pub fn read(bytes: &[u8]) -> Result<Trc, TrcError> {
    let bytes = &*plain(bytes);
    let mut lines = Lines::new(bytes);
    let (header, separator) = header::read(&mut lines)?;
    let label_line = header::next(&mut lines, 4, "a line that begins with `Frame#`")?;
    let labels = labels(separator, &label_line)?;
    let mut body = Body::new(labels, separator, bytes.len());
    while let Some(line) = lines.next() {
        let cells = body.separator.split(line.bytes);
        if body.frames.is_empty() && is_component_line(&cells) {
            body.place_labels(&cells);
            continue;
        }
        body.push(&line, &cells, lines.is_open(&line))?;
    }
    body.finish(header)
}

/// The label line's cells from the third on, and whether blanks among them hold places.
fn labels(separator: Separator, line: &Line<'_>) -> Result<Vec<String>, TrcError> {
    let cells = separator.split(line.bytes);
    if !cells.first().is_some_and(|cell| cell.to_ascii_lowercase().starts_with(b"frame")) {
        let found = cells.first().map(|cell| text(cell)).unwrap_or_default();
        return Err(TrcError::line(line.number, format!("{found:?}"), "a line that begins with `Frame#`"));
    }
    Ok(cells.iter().skip(2).map(|cell| text(cell)).collect())
}

/// `X1 Y1 Z1 X2 …`: letters, where data has numbers.
fn is_component_line(cells: &[&[u8]]) -> bool {
    let first = cells.iter().find(|cell| !cell.is_empty());
    first.is_some_and(|cell| cell[0].eq_ignore_ascii_case(&b'x'))
}

/// The rows of positions as they come in.
struct Body {
    separator: Separator,
    /// The cells of the label line, from the first marker's on.
    label_cells: Vec<String>,
    /// The label of each triple of columns; empty where it has none.
    labels: Vec<String>,
    /// A full table has at least three bytes a position; far more positions than bytes mean that most are not there.
    most_positions: usize,
    numbers: Numbers,
    /// Those of the last marker's last coordinate.
    last_decimals: Decimals,
    /// Line and whole rows where the file ends without the end of a line.
    open_at: Option<(u64, u64)>,
    lost_digits: bool,
    frames: Vec<i64>,
    lines: Vec<u64>,
    times_secs: Vec<Option<f64>>,
    positions: Vec<Vec<Option<[f64; 3]>>>,
    short_rows: Tally,
    unnamed_rows: Tally,
    half_positions: usize,
}

/// How often something happened, and where first.
#[derive(Default)]
struct Tally {
    n: usize,
    first_line: u64,
}

impl Tally {
    fn count(&mut self, line: u64) {
        self.n += 1;
        if self.n == 1 {
            self.first_line = line;
        }
    }
}

impl Body {
    fn new(label_cells: Vec<String>, separator: Separator, file_len: usize) -> Self {
        let labels: Vec<String> = label_cells.iter().filter(|label| !label.is_empty()).cloned().collect();
        Self {
            separator,
            positions: vec![Vec::new(); labels.len()],
            label_cells,
            labels,
            most_positions: file_len.saturating_mul(2),
            numbers: Numbers::default(),
            last_decimals: Decimals::default(),
            open_at: None,
            lost_digits: false,
            frames: Vec::new(),
            lines: Vec::new(),
            times_secs: Vec::new(),
            short_rows: Tally::default(),
            unnamed_rows: Tally::default(),
            half_positions: 0,
        }
    }

    /// Labels stand above their X, or simply one after the other. If there are fewer labels than triples, the
    /// places tell which triple has none: provided that every label does stand above an X.
    fn place_labels(&mut self, components: &[&[u8]]) {
        let n_triples =
            components.iter().filter(|c| c.first().is_some_and(|b| b.eq_ignore_ascii_case(&b'x'))).count();
        let above_x = self.label_cells.iter().enumerate().all(|(i, label)| label.is_empty() || i % 3 == 0);
        if self.labels.len() < n_triples && above_x {
            let label = |k: usize| self.label_cells.get(3 * k).cloned().unwrap_or_default();
            self.labels = (0..n_triples).map(label).collect();
            let last = self.labels.iter().rposition(|label| !label.is_empty()).map_or(0, |k| k + 1);
            self.labels.truncate(last);
            self.positions = vec![Vec::new(); self.labels.len()];
        }
    }

    fn push(&mut self, line: &Line<'_>, cells: &[&[u8]], open: bool) -> Result<(), TrcError> {
        let cell = |idx: usize| cells.get(idx).copied().unwrap_or_default();
        let bad = |idx: usize, expected| TrcError::cell(line.number, idx, cell(idx), expected);
        let frame = whole(cell(0)).ok_or_else(|| bad(0, "a frame number (a whole number)"))?;
        let width = 2 + 3 * self.labels.len();
        self.check_width(line, cells, width)?;
        self.frames.push(frame);
        self.lines.push(line.number);
        if self.frames.len().saturating_mul(self.labels.len()) > self.most_positions {
            let found = format!("{} cells, as in most lines before", cells.len());
            return Err(TrcError::line(line.number, found, format!("{width} cells")));
        }
        self.times_secs.push(self.numbers.read(cell(1)).map_err(|expected| bad(1, expected))?);
        let complete = self.complete(line, cells, width, open);
        for (k, positions) in self.positions.iter_mut().enumerate() {
            let mut xyz = [None; 3];
            for (axis, value) in xyz.iter_mut().enumerate() {
                let idx = 2 + 3 * k + axis;
                let read = self.numbers.read(cell(idx)).map_err(|expected| bad(idx, expected))?;
                *value = read.filter(|_| idx < complete);
            }
            positions.push(match xyz {
                [Some(x), Some(y), Some(z)] => Some([x, y, z]),
                _ => None,
            });
            self.half_positions += usize::from(xyz.iter().flatten().count() % 3 != 0);
        }
        Ok(())
    }

    /// How many cells of a row are there as they were written.
    fn complete(&mut self, line: &Line<'_>, cells: &[&[u8]], width: usize, open: bool) -> usize {
        let last = cells.get(width - 1).copied().unwrap_or_default();
        // The last number of a line that was cut off may have lost digits without showing it.
        let is_short = cells.len() < width;
        self.lost_digits = open && cells.len() == width && self.last_decimals.lost_some(last);
        self.last_decimals.see(last);
        if open {
            let n_whole = self.frames.len() - usize::from(is_short || self.lost_digits);
            self.open_at = Some((line.number, n_whole as u64));
        }
        match (open && is_short, self.lost_digits) {
            (true, _) => cells.len() - 1,
            (false, true) => width - 1,
            (false, false) => usize::MAX,
        }
    }

    fn check_width(&mut self, line: &Line<'_>, cells: &[&[u8]], width: usize) -> Result<(), TrcError> {
        let filled = filled_len(cells);
        if filled > width {
            // Between commas these may be the halves of numbers with decimal commas.
            if self.separator == Separator::Byte(b',') {
                let expected = format!("at most {width} cells, with decimal points");
                return Err(TrcError::line(line.number, format!("{filled} cells"), expected));
            }
            self.unnamed_rows.count(line.number);
        }
        if self.separator == Separator::Blanks && filled != width {
            let expected = format!("{width} cells: between blanks, nothing shows which one is missing");
            return Err(TrcError::line(line.number, format!("{filled} cells"), expected));
        }
        if cells.len() < width {
            self.short_rows.count(line.number);
        }
        Ok(())
    }

    fn finish(self, header: Header) -> Result<Trc, TrcError> {
        if self.separator == Separator::Byte(b',') && self.short_rows.n > 0 && !self.numbers.saw_a_point() {
            let found = "a short line, and no decimal point in the file";
            return Err(TrcError::line(self.short_rows.first_line, found, "numbers with a decimal point"));
        }
        let mut warnings = self.oddities();
        let triples = self.labels.into_iter().zip(self.positions);
        let (named, unnamed): (Vec<_>, Vec<_>) = triples.partition(|(label, _)| !label.is_empty());
        if !unnamed.is_empty() {
            warnings.push(format!("{} markers without a label are left out", unnamed.len()));
        }
        let n_markers = named.len();
        if let Some(claimed) = header.n_markers.filter(|&n| usize::try_from(n) != Ok(n_markers)) {
            warnings.push(format!("NumMarkers is {claimed}, {n_markers} labels are there"));
        }
        let n_frames = self.frames.len();
        if let Some(claimed) = header.n_frames.filter(|&n| usize::try_from(n) != Ok(n_frames)) {
            warnings.push(format!("NumFrames is {claimed}, {n_frames} rows are there"));
        }
        // A wrong count alone says nothing, nor does a line without an end: many programs write either.
        let claimed = header.n_frames.and_then(|n| u64::try_from(n).ok());
        let cut = claimed.zip(self.open_at).filter(|(n, _)| *n > n_frames as u64);
        let cut = cut.map(|(claimed, (_, n_whole))| (claimed, n_whole));
        let markers = named.into_iter().map(|(label, positions)| Marker { label, positions }).collect();
        let (frames, lines, times_secs) = (self.frames, self.lines, self.times_secs);
        Ok(Trc { header, frames, lines, times_secs, markers, cut, warnings })
    }

    fn oddities(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let Tally { n, first_line } = self.short_rows;
        if n > 0 {
            warnings.push(format!(
                "{n} lines, the first of them line {first_line}, are short; missing cells count as blank"
            ));
        }
        let Tally { n, first_line } = self.unnamed_rows;
        if n > 0 {
            warnings.push(format!(
                "{n} lines, the first of them line {first_line}, hold coordinates without a label; they are left out"
            ));
        }
        warnings.extend(self.open_at.filter(|_| self.lost_digits).map(|(line, _)| lost_digits(line)));
        warnings.extend(half_positions(self.half_positions));
        warnings
    }
}

#[cfg(test)]
mod tests;

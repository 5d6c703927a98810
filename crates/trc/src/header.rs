use crate::TrcError;
use crate::line::{Line, Lines, Separator, filled_len};
use tousle_cells::{Numbers, shorten, text, whole};

/// What the header says. Its counts can be wrong: the body is what is there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Header {
    /// `DataRate`: frames a second.
    pub data_rate_hz: Option<f64>,
    /// `CameraRate`: frames a second of the cameras.
    pub camera_rate_hz: Option<f64>,
    /// `NumFrames`.
    pub n_frames: Option<i64>,
    /// `NumMarkers`.
    pub n_markers: Option<i64>,
    /// `Units`, as the file names it.
    pub unit: Option<String>,
    /// `OrigDataStartFrame`.
    pub original_start_frame: Option<i64>,
    /// `OrigNumFrames`.
    pub original_n_frames: Option<i64>,
}

const KEYS: &str = "a line with `DataRate`, `NumFrames`, `Units`";

/// Reads the lines of keys and of values, and finds what separates cells.
pub(crate) fn read(lines: &mut Lines<'_>) -> Result<(Header, Separator), TrcError> {
    let mut keys = next(lines, 1, KEYS)?;
    if keys.bytes.trim_ascii().to_ascii_lowercase().starts_with(b"pathfiletype") {
        keys = next(lines, keys.number + 1, KEYS)?;
    }
    let separator = Separator::of(keys.bytes);
    if !separator.split(keys.bytes).iter().any(|key| key.eq_ignore_ascii_case(b"datarate")) {
        return Err(TrcError::line(keys.number, format!("{:?}", shorten(&text(keys.bytes))), KEYS));
    }
    let values = next(lines, keys.number + 1, "the values of these keys")?;
    Ok((pair(separator, &keys, &values)?, separator))
}

/// The next line that is not blank.
pub(crate) fn next<'a>(lines: &mut Lines<'a>, number: u64, expected: &str) -> Result<Line<'a>, TrcError> {
    lines.next().ok_or_else(|| TrcError::line(number, "the end of the file", expected))
}

fn pair(separator: Separator, keys: &Line<'_>, values: &Line<'_>) -> Result<Header, TrcError> {
    let keys = filled(separator.split(keys.bytes));
    let cells = separator.split(values.bytes);
    // Some programs pad values with empty cells; then the order is all that is left.
    let cells = if filled_len(&cells) <= keys.len() { cells } else { filled(cells) };
    if filled_len(&cells) > keys.len() && separator == Separator::Byte(b',') {
        let expected = format!("{} cells, with decimal points", keys.len());
        return Err(TrcError::line(values.number, format!("{} cells", cells.len()), expected));
    }
    let mut header = Header::default();
    let mut numbers = Numbers::default();
    for (idx, (key, &cell)) in keys.iter().zip(&cells).enumerate() {
        let bad = |expected| TrcError::cell(values.number, idx, cell, expected);
        let count = || if cell.is_empty() { Ok(None) } else { whole(cell).map(Some).ok_or("a whole number") };
        match key.to_ascii_lowercase().as_slice() {
            b"datarate" => header.data_rate_hz = numbers.read(cell).map_err(bad)?,
            b"camerarate" => header.camera_rate_hz = numbers.read(cell).map_err(bad)?,
            b"numframes" => header.n_frames = count().map_err(bad)?,
            b"nummarkers" => header.n_markers = count().map_err(bad)?,
            b"units" => header.unit = Some(text(cell)).filter(|unit| !unit.is_empty()),
            b"origdatastartframe" => header.original_start_frame = whole(cell),
            b"orignumframes" => header.original_n_frames = whole(cell),
            _ => {}
        }
    }
    Ok(header)
}

fn filled(mut cells: Vec<&[u8]>) -> Vec<&[u8]> {
    cells.retain(|cell| !cell.is_empty());
    cells
}

use crate::CsvError;
use crate::rows::{Row, Rows, is_column_key};
use tousle_cells::{Numbers, text};

/// What stands above a section's table.
#[derive(Debug)]
pub(crate) struct Heading {
    /// The title, empty where there is none.
    pub title: String,
    /// Its line, or that of the first line that is there.
    pub line: u64,
    /// Rows a second.
    pub rate_hz: Option<f64>,
    /// The line of labels, if it was passed on the way.
    pub labels: Option<Row>,
}

/// Finds the next section: a title and a rate, or, where these are missing, the lines that name columns.
///
/// Leaves `rows` at the line after the rate, or at the line that heads the columns.
///
/// # Errors
/// If a rate has a decimal comma where commas separate cells.
pub(crate) fn next(rows: &mut Rows, delimiter: u8) -> Result<Option<Heading>, CsvError> {
    let mut last: Option<Row> = None;
    loop {
        if rows.peek().is_some_and(|row| is_column_key(row.cell(0))) {
            let key_line = rows.peek().map_or(1, |row| row.line);
            let line = last.as_ref().map_or(key_line, |row| row.line);
            return Ok(Some(Heading { title: String::new(), line, rate_hz: None, labels: last }));
        }
        let Some(row) = rows.next() else { return Ok(None) };
        if let Some(rate_hz) = rate(&row, delimiter) {
            let title = last.as_ref().and_then(Row::only_cell).map(text).unwrap_or_default();
            let line = last.filter(|_| !title.is_empty()).map_or(row.line, |row| row.line);
            return Ok(Some(Heading { title, line, rate_hz: Some(rate_hz), labels: None }));
        }
        refuse_decimal_comma(&row, delimiter)?;
        last = Some(row);
    }
}

/// The rate of a line like `100`, `100,,,` or `100,Hz`.
fn rate(row: &Row, delimiter: u8) -> Option<f64> {
    let unit = row.cell(1);
    let alone = row.filled_len() <= 1 || row.filled_len() == 2 && unit.eq_ignore_ascii_case(b"hz");
    let number = Numbers::between(delimiter).read(row.cell(0)).ok().flatten();
    number.filter(|rate| alone && *rate > 0.0)
}

/// `119,88` as all of a line, in quotes or not: a rate, which would be lost with the title above it.
fn refuse_decimal_comma(row: &Row, delimiter: u8) -> Result<(), CsvError> {
    let cells: Vec<&[u8]> = row.cells().take(row.filled_len()).collect();
    let line = cells.join(&b',');
    let is_number = line.contains(&b',') && matches!(Numbers::default().read(&line), Ok(Some(_)));
    if delimiter == b',' && is_number {
        return Err(CsvError::line(row.line, text(&line), "a rate with a decimal point"));
    }
    Ok(())
}

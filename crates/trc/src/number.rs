/// Reads the numbers of one file, which must all be written the same way.
///
/// A comma is a decimal mark only where it cannot be a separator, and only as long as no number of the file
/// uses a point: `1,508` beside `0.5` is a thousand and not one and a half.
#[derive(Debug, Default)]
pub(crate) struct Numbers {
    points_seen: bool,
    commas_seen: bool,
}

impl Numbers {
    /// The number in a cell, `None` where the cell is blank or says that there is none.
    ///
    /// # Errors
    /// What was expected.
    pub fn read(&mut self, cell: &[u8]) -> Result<Option<f64>, &'static str> {
        if says_nothing(cell) {
            return Ok(None);
        }
        let number = match cell.iter().filter(|b| **b == b',').count() {
            0 => parse(cell)?,
            1 => parse(&cell.iter().map(|b| if *b == b',' { b'.' } else { *b }).collect::<Vec<_>>())?,
            _ => return Err("a number without thousands separators"),
        };
        self.points_seen |= cell.contains(&b'.');
        self.commas_seen |= cell.contains(&b',');
        if self.points_seen && self.commas_seen {
            return Err("a number with the decimal mark that the rest of the file uses");
        }
        Ok(Some(number))
    }

    /// Whether any number so far had a decimal point.
    pub fn saw_a_point(&self) -> bool {
        self.points_seen
    }
}

/// A whole number, as frame numbers and counts are; `12.0` is one.
pub(crate) fn whole(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?;
    text.parse().ok().or_else(|| {
        let number: f64 = text.parse().ok()?;
        // Beyond 2^53 a double does not hold every whole number.
        (number == number.trunc() && number.abs() < 9e15).then_some(number as i64)
    })
}

fn parse(cell: &[u8]) -> Result<f64, &'static str> {
    let text = std::str::from_utf8(cell).ok().filter(|text| text.bytes().any(|b| b.is_ascii_digit()));
    let number = text.and_then(|text| text.parse::<f64>().ok());
    number.filter(|number| number.is_finite()).ok_or("a number")
}

/// Whether a cell is blank or holds one of the words that programs write for a number that is not there.
fn says_nothing(cell: &[u8]) -> bool {
    let word =
        cell.strip_prefix(b"-").or_else(|| cell.strip_prefix(b"+")).unwrap_or(cell).to_ascii_lowercase();
    matches!(&*word, b"" | b"nan" | b"#n/a" | b"n/a" | b"na")
        || [&b"nan("[..], b"1.#qnan", b"1.#ind"].iter().any(|start| word.starts_with(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_their_absence() {
        let mut numbers = Numbers::default();
        for (cell, expected) in
            [("-2.73E-01", Some(-0.273)), ("7", Some(7.0)), ("", None), ("NAN", None), ("nan", None)]
        {
            assert_eq!(numbers.read(cell.as_bytes()), Ok(expected), "{cell}");
        }
        for cell in ["x", "inf", "1e999", "1,508", "1,5,0"] {
            assert!(numbers.read(cell.as_bytes()).is_err(), "{cell}");
        }
        assert_eq!(Numbers::default().read(b"165,151"), Ok(Some(165.151)));
    }
}

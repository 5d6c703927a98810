/// Reads the numbers of one file, which must all be written the same way.
///
/// A comma is a decimal mark only where it cannot be a separator, and only as long as no number of the file
/// uses a point: `1,508` beside `0.5` is a thousand and not one and a half.
#[derive(Debug)]
pub(crate) struct Numbers {
    comma_separates: bool,
    points_seen: bool,
    commas_seen: bool,
}

const ONE_MARK: &str =
    "a number with the decimal mark that the rest of the file uses, without thousands separators";

impl Numbers {
    pub fn new(delimiter: u8) -> Self {
        Self { comma_separates: delimiter == b',', points_seen: false, commas_seen: false }
    }

    /// Whether any number so far had a decimal point.
    pub fn saw_a_point(&self) -> bool {
        self.points_seen
    }

    /// The number in a cell, `None` where the cell is blank or says that there is none.
    ///
    /// # Errors
    /// What was expected.
    pub fn read(&mut self, cell: &[u8]) -> Result<Option<f64>, &'static str> {
        if cell.is_empty() || says_nothing(cell) {
            return Ok(None);
        }
        let commas = cell.iter().filter(|b| **b == b',').count();
        let number = match commas {
            0 => parse(cell)?,
            1 if !self.comma_separates => {
                self.commas_seen = true;
                parse(&cell.iter().map(|b| if *b == b',' { b'.' } else { *b }).collect::<Vec<_>>())?
            }
            _ => return Err("a number with a decimal point, without thousands separators"),
        };
        self.points_seen |= cell.contains(&b'.');
        if self.points_seen && self.commas_seen { Err(ONE_MARK) } else { Ok(Some(number)) }
    }
}

/// A whole number, as frame numbers are; `12.0` is one.
pub(crate) fn whole(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?;
    text.parse().ok().or_else(|| {
        let number: f64 = text.parse().ok()?;
        // Beyond 2^53 a double does not hold every whole number.
        (number == number.trunc() && number.abs() < 9e15).then_some(number as i64)
    })
}

fn parse(cell: &[u8]) -> Result<f64, &'static str> {
    let starts_like_a_number = cell.iter().any(u8::is_ascii_digit);
    std::str::from_utf8(cell)
        .ok()
        .filter(|_| starts_like_a_number)
        .and_then(|text| text.parse::<f64>().ok())
        .filter(|number| number.is_finite())
        .ok_or("a number")
}

/// Whether a cell holds one of the words that programs write for a number that is not there.
fn says_nothing(cell: &[u8]) -> bool {
    let word =
        cell.strip_prefix(b"-").or_else(|| cell.strip_prefix(b"+")).unwrap_or(cell).to_ascii_lowercase();
    // `1.#QNAN0`, `nan(ind)`: how some runtimes print it.
    word.starts_with(b"nan(")
        || word.starts_with(b"1.#qnan")
        || word.starts_with(b"1.#ind")
        || matches!(&*word, b"nan" | b"#n/a" | b"n/a" | b"na")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_numbers_and_their_absence() {
        let mut numbers = Numbers::new(b',');
        for (cell, expected) in [
            ("1.5", Some(1.5)),
            ("-2.61E-05", Some(-2.61e-5)),
            ("7", Some(7.0)),
            (".5", Some(0.5)),
            ("", None),
            ("NaN", None),
            ("-nan(ind)", None),
        ] {
            assert_eq!(numbers.read(cell.as_bytes()), Ok(expected), "{cell}");
        }
        for cell in ["x", "inf", "infinity", "1e999", "1.2.3", "0x1", "1 2", "\u{b5}"] {
            assert!(numbers.read(cell.as_bytes()).is_err(), "{cell}");
        }
    }

    #[test]
    fn a_decimal_comma_is_read_where_commas_do_not_separate() {
        let mut numbers = Numbers::new(b';');
        assert_eq!(numbers.read(b"165,151"), Ok(Some(165.151)));
        assert_eq!(numbers.read(b"7"), Ok(Some(7.0)));
        assert!(numbers.read(b"1.508").is_err(), "a thousands separator, or another locale");
        assert!(Numbers::new(b';').read(b"1.508,13").is_err());
        assert!(Numbers::new(b',').read(b"1,508").is_err());
        let mut pointed = Numbers::new(b'\t');
        assert_eq!(pointed.read(b"0.5"), Ok(Some(0.5)));
        assert!(pointed.read(b"1,508").is_err());
    }

    #[test]
    fn whole_numbers() {
        assert_eq!(whole(b"695"), Some(695));
        assert_eq!(whole(b"-3"), Some(-3));
        assert_eq!(whole(b"12.0"), Some(12));
        assert_eq!(whole(b"12.5"), None);
        assert_eq!(whole(b"1e300"), None);
        assert_eq!(whole(b""), None);
    }
}

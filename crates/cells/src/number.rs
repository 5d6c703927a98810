/// Reads the numbers of one file, which must all be written the same way.
///
/// A comma is a decimal mark only where it cannot be a separator, and only as long as no number of the file
/// uses a point: `1,508` beside `0.5` is a thousand and not one and a half.
#[derive(Clone, Debug, Default)]
pub struct Numbers {
    comma_separates: bool,
    points_seen: bool,
    commas_seen: bool,
}

const ONE_MARK: &str =
    "a number with the decimal mark that the rest of the file uses, without thousands separators";
const NO_THOUSANDS: &str = "a number with a decimal point, without thousands separators";

impl Numbers {
    /// For a file whose cells are separated by this byte; the default is for cells that a comma cannot separate.
    pub fn between(delimiter: u8) -> Self {
        Self { comma_separates: delimiter == b',', ..Self::default() }
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
        if cell.is_empty() {
            return Ok(None);
        }
        let number = match cell.iter().filter(|b| **b == b',').count() {
            0 => parse(cell),
            1 if !self.comma_separates => parse(&with_point(cell)),
            _ => return Err(NO_THOUSANDS),
        };
        let Some(number) = number else {
            return if says_nothing(cell) { Ok(None) } else { Err("a number") };
        };
        self.commas_seen |= cell.contains(&b',');
        self.points_seen |= cell.contains(&b'.');
        if self.points_seen && self.commas_seen { Err(ONE_MARK) } else { Ok(Some(number)) }
    }
}

/// How many decimals the numbers of a column have, to tell one that lost some where its file was cut off.
#[derive(Clone, Debug, Default)]
pub struct Decimals {
    n_seen: usize,
    least: usize,
}

impl Decimals {
    /// So many numbers must have their decimals before one with fewer is odd. Programs that drop zeros at the end write one in ten with
    /// fewer than the most, one in a hundred with two fewer: after some dozen the fewest have been seen.
    const ENOUGH: usize = 30;

    /// Takes a cell of the column; one without a number says nothing.
    pub fn see(&mut self, cell: &[u8]) {
        if let Some(n) = n_decimals(cell) {
            self.least = if self.n_seen == 0 { n } else { self.least.min(n) };
            self.n_seen += 1;
        }
    }

    /// Whether a number at the very end of a file has fewer decimals than all before it in its column: it lost some.
    pub fn lost_some(&self, cell: &[u8]) -> bool {
        self.n_seen >= Self::ENOUGH && n_decimals(cell).is_some_and(|n| n < self.least)
    }
}

/// Digits behind the decimal mark; `None` where there is no digit at all, or an exponent, which makes them say nothing.
fn n_decimals(cell: &[u8]) -> Option<usize> {
    let is_plain = |b: &u8| b.is_ascii_digit() || matches!(b, b'+' | b'-' | b'.' | b',');
    if !cell.iter().all(is_plain) || !cell.iter().any(u8::is_ascii_digit) {
        return None;
    }
    let mark = cell.iter().position(|b| matches!(b, b'.' | b','));
    Some(mark.map_or(0, |at| cell.len() - at - 1))
}

/// A whole number, as frame numbers and counts are; `12.0` is one.
pub fn whole(cell: &[u8]) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?;
    text.parse().ok().or_else(|| {
        let number: f64 = text.parse().ok()?;
        // Beyond 2^53 a double does not hold every whole number.
        (number == number.trunc() && number.abs() < 9e15).then_some(number as i64)
    })
}

fn with_point(cell: &[u8]) -> Vec<u8> {
    cell.iter().map(|b| if *b == b',' { b'.' } else { *b }).collect()
}

/// A finite number with a digit in it: `inf` and `nan` are words.
fn parse(cell: &[u8]) -> Option<f64> {
    let number = std::str::from_utf8(cell).ok()?.parse::<f64>().ok()?;
    (number.is_finite() && cell.iter().any(u8::is_ascii_digit)).then_some(number)
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
    fn a_number_that_lost_decimals() {
        let seen = |cells: &[&str], n: usize| {
            let mut decimals = Decimals::default();
            (0..n).for_each(|k| decimals.see(cells[k % cells.len()].as_bytes()));
            decimals
        };
        let fixed = seen(&["1345.14", "-2.50", "", "nan"], 80);
        for (cell, lost) in
            [("1345.14", false), ("1345.1", true), ("1345.", true), ("134", true), ("1,1", true)]
        {
            assert_eq!(fixed.lost_some(cell.as_bytes()), lost, "{cell}");
        }
        assert!(!fixed.lost_some(b"") && !fixed.lost_some(b"-") && !fixed.lost_some(b"1e-5"));
        assert!(!seen(&["1345.14"], 29).lost_some(b"134"), "too few to tell");
        let short = seen(&["1345.14", "1345.1", "1345"], 90);
        assert!(!short.lost_some(b"134"), "zeros at the end are left out");
    }

    #[test]
    fn plain_numbers_and_their_absence() {
        let mut numbers = Numbers::between(b',');
        for (cell, expected) in [
            ("1.5", Some(1.5)),
            ("-2.61E-05", Some(-2.61e-5)),
            ("7", Some(7.0)),
            (".5", Some(0.5)),
            ("", None),
            ("NaN", None),
            ("-nan(ind)", None),
            ("1.#QNAN0", None),
            ("NAN", None),
        ] {
            assert_eq!(numbers.read(cell.as_bytes()), Ok(expected), "{cell}");
        }
        for cell in ["x", "inf", "infinity", "1e999", "1.2.3", "0x1", "1 2", "\u{b5}"] {
            assert!(numbers.read(cell.as_bytes()).is_err(), "{cell}");
        }
    }

    #[test]
    fn a_decimal_comma_is_read_where_commas_do_not_separate() {
        let mut numbers = Numbers::between(b';');
        assert_eq!(numbers.read(b"165,151"), Ok(Some(165.151)));
        assert_eq!(numbers.read(b"7"), Ok(Some(7.0)));
        assert!(numbers.read(b"1.508").is_err(), "a thousands separator, or another locale");
        assert!(Numbers::between(b';').read(b"1.508,13").is_err());
        assert!(Numbers::between(b',').read(b"1,508").is_err());
        let mut pointed = Numbers::between(b'\t');
        assert_eq!(pointed.read(b"0.5"), Ok(Some(0.5)));
        assert!(pointed.read(b"1,508").is_err());
        let mut of_trc = Numbers::default();
        assert_eq!(of_trc.read(b"165,151"), Ok(Some(165.151)));
        assert!(of_trc.read(b"1,5,0").is_err());
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

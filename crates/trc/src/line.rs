/// One line with something in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line<'a> {
    /// Line in the file, from 1.
    pub number: u64,
    /// Its bytes without the end of the line.
    pub bytes: &'a [u8],
}

/// The lines of a file that have something in them, in order.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    end: u8,
    number: u64,
}

/// What separates cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Separator {
    /// One byte; two in a row enclose an empty cell.
    Byte(u8),
    /// Any number of blanks; no cell is empty.
    Blanks,
}

impl<'a> Lines<'a> {
    /// The lines of plain text, whether they end in LF, CR LF, CR CR LF, or, without any LF, in CR.
    pub fn new(bytes: &'a [u8]) -> Self {
        let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
        Self { rest: bytes, end, number: 0 }
    }

    /// Whether the line given last is the file's last and has no end.
    pub fn is_open(&self, line: &Line<'_>) -> bool {
        self.rest.is_empty() && line.bytes.as_ptr_range().end == self.rest.as_ptr()
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        while !self.rest.is_empty() {
            let length = self.rest.iter().position(|b| *b == self.end).unwrap_or(self.rest.len());
            let (bytes, rest) = self.rest.split_at(length);
            self.rest = rest.get(1..).unwrap_or(rest);
            self.number += 1;
            let bytes = match bytes.iter().rposition(|b| *b != b'\r') {
                Some(last) if last + 1 < bytes.len() => &bytes[..=last],
                _ => bytes,
            };
            if bytes.iter().any(|b| !matches!(b, b' ' | b'\t' | b',' | b';' | b'\r')) {
                return Some(Line { number: self.number, bytes });
            }
        }
        None
    }
}

impl Separator {
    /// The separator of a line of words, or of its absence: a line in one piece is separated by blanks.
    pub fn of(line: &[u8]) -> Self {
        [b'\t', b';', b','].into_iter().find(|b| line.contains(b)).map_or(Self::Blanks, Self::Byte)
    }

    /// The cells of a line, blanks around them cut off.
    pub fn split(self, line: &[u8]) -> Vec<&[u8]> {
        match self {
            Self::Byte(byte) => line.split(|b| *b == byte).map(<[u8]>::trim_ascii).collect(),
            Self::Blanks => line.split(u8::is_ascii_whitespace).filter(|cell| !cell.is_empty()).collect(),
        }
    }
}

/// How many cells there are up to the last one with something in it.
pub(crate) fn filled_len(cells: &[&[u8]]) -> usize {
    cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |idx| idx + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_end_of_line() {
        for (text, numbers) in [
            (&b"a\nb\n\t\nc"[..], [1, 2, 4]),
            (b"a\r\nb\r\n\t\r\nc", [1, 2, 4]),
            (b"a\r\r\nb\r\r\n\t\r\r\nc", [1, 2, 4]),
            (b"a\rb\r\t\rc", [1, 2, 4]),
        ] {
            let lines: Vec<Line> = Lines::new(text).collect();
            assert_eq!(lines.iter().map(|l| l.number).collect::<Vec<_>>(), numbers);
            assert_eq!(lines.iter().map(|l| l.bytes).collect::<Vec<_>>(), [b"a", b"b", b"c"]);
        }
    }

    #[test]
    fn a_line_without_an_end_is_open() {
        for (text, open) in [(&b"a\nb"[..], true), (b"a\nb\n", false), (b"a\nb\r\n", false)] {
            let mut lines = Lines::new(text);
            let first = lines.next().unwrap();
            assert!(!lines.is_open(&first));
            let last = lines.next().unwrap();
            assert_eq!(lines.is_open(&last), open, "{text:?}");
        }
    }
}

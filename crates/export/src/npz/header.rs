//! The header of a `.npy` array: magic, version, and a Python dictionary of type, order and shape.
//!
//! Source: NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays".

use std::io::{self, Read, Write};

use super::dtype::Dtype;

const MAGIC: &[u8; 6] = b"\x93NUMPY";

/// The most bytes of dictionary that are read: shapes of 32 axes fit many times over.
const MAX_DICTIONARY: usize = 1 << 16;

/// NumPy's own limit is 64; the arrays read here have at most 5.
const MAX_AXES: usize = 64;

/// What an array holds and how it lies in the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    /// Type of one value.
    pub(crate) dtype: Dtype,
    /// Whether the first axis is the fastest.
    pub(crate) fortran_order: bool,
    /// Values along each axis; empty for a single value.
    pub(crate) shape: Vec<usize>,
}

/// What is wrong with a header.
#[derive(Debug, thiserror::Error)]
pub(crate) enum HeaderError {
    /// The bytes end, or the archive cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Something is there that should not be.
    #[error("found {found}, expected {expected}")]
    Bad {
        /// What is there.
        found: String,
        /// What should be.
        expected: &'static str,
    },
}

fn bad(found: impl Into<String>, expected: &'static str) -> HeaderError {
    HeaderError::Bad { found: found.into(), expected }
}

impl Header {
    /// Values in the array; `None` if there are more than a `usize` counts.
    pub(crate) fn n_values(&self) -> Option<usize> {
        self.shape.iter().try_fold(1_usize, |n, axis| n.checked_mul(*axis))
    }

    /// Reads a header and leaves `source` at the first value.
    pub(crate) fn read(source: &mut impl Read) -> Result<Self, HeaderError> {
        let mut start = [0; 8];
        source.read_exact(&mut start)?;
        if !start.starts_with(MAGIC) {
            return Err(bad("no .npy magic", "bytes 93 4E 55 4D 50 59"));
        }
        let len = match start[6] {
            1 => {
                let mut bytes = [0; 2];
                source.read_exact(&mut bytes)?;
                usize::from(u16::from_le_bytes(bytes))
            }
            2 | 3 => {
                let mut bytes = [0; 4];
                source.read_exact(&mut bytes)?;
                u32::from_le_bytes(bytes) as usize
            }
            other => return Err(bad(format!("version {other}.{}", start[7]), "version 1.0, 2.0 or 3.0")),
        };
        if len > MAX_DICTIONARY {
            return Err(bad(format!("a header of {len} bytes"), "at most 65536"));
        }
        let mut dictionary = vec![0; len];
        source.read_exact(&mut dictionary)?;
        let text = str::from_utf8(&dictionary).map_err(|_| bad("bytes that are not text", "a dictionary"))?;
        Literal::new(text).dictionary()
    }

    /// Writes the header, padded with blanks so that the values start at a multiple of 64 bytes.
    pub(crate) fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let shape = match self.shape.as_slice() {
            [one] => format!("({one},)"),
            axes => format!("({})", axes.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
        };
        let order = if self.fortran_order { "True" } else { "False" };
        let mut text = format!("{{'descr': '{}', 'fortran_order': {order}, 'shape': {shape}, }}", self.dtype);
        while !(MAGIC.len() + 4 + text.len() + 1).is_multiple_of(64) {
            text.push(' ');
        }
        text.push('\n');
        let len = u16::try_from(text.len()).map_err(|_| io::Error::from(io::ErrorKind::InvalidInput))?;
        out.write_all(MAGIC)?;
        out.write_all(&[1, 0])?;
        out.write_all(&len.to_le_bytes())?;
        out.write_all(text.as_bytes())
    }
}

/// As much of Python's literals as headers are made of.
struct Literal<'a> {
    rest: &'a str,
}

impl<'a> Literal<'a> {
    fn new(text: &'a str) -> Self {
        Self { rest: text }
    }

    fn dictionary(mut self) -> Result<Header, HeaderError> {
        let (mut descr, mut order, mut shape) = (None, None, None);
        self.expect('{', "a dictionary")?;
        while !self.eat('}') {
            let key = self.quoted("a key in quotes")?;
            self.expect(':', "a colon behind the key")?;
            match key {
                "descr" => descr = Some(self.descr()?),
                "fortran_order" => order = Some(self.boolean()?),
                "shape" => shape = Some(self.tuple()?),
                other => return Err(bad(format!("key {other:?}"), "descr, fortran_order, shape")),
            }
            if !self.eat(',') {
                self.expect('}', "a comma or the dictionary's end")?;
                break;
            }
        }
        Ok(Header {
            dtype: descr.ok_or_else(|| bad("no descr", "descr, fortran_order, shape"))?,
            fortran_order: order.ok_or_else(|| bad("no fortran_order", "descr, fortran_order, shape"))?,
            shape: shape.ok_or_else(|| bad("no shape", "descr, fortran_order, shape"))?,
        })
    }

    fn descr(&mut self) -> Result<Dtype, HeaderError> {
        let name = self.quoted("one plain type, not a record of fields")?;
        Dtype::from_name(name)
            .ok_or_else(|| bad(format!("type {name:?}"), "f2, f4, f8, i1 to i8, u1 to u8, b1, U or S"))
    }

    fn boolean(&mut self) -> Result<bool, HeaderError> {
        match self.word() {
            "True" => Ok(true),
            "False" => Ok(false),
            other => Err(bad(format!("fortran_order {other:?}"), "True or False")),
        }
    }

    fn tuple(&mut self) -> Result<Vec<usize>, HeaderError> {
        let mut axes = Vec::new();
        self.expect('(', "a shape in parentheses")?;
        while !self.eat(')') {
            // Python 2 wrote long integers with an L.
            let word = self.word().trim_end_matches('L');
            axes.push(word.parse().map_err(|_| bad(format!("shape entry {word:?}"), "a whole number"))?);
            if axes.len() > MAX_AXES {
                return Err(bad("more than 64 axes", "at most 64"));
            }
            if !self.eat(',') {
                self.expect(')', "a comma or the shape's end")?;
                break;
            }
        }
        Ok(axes)
    }

    fn eat(&mut self, wanted: char) -> bool {
        self.rest = self.rest.trim_start();
        match self.rest.strip_prefix(wanted) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn expect(&mut self, wanted: char, what: &'static str) -> Result<(), HeaderError> {
        if self.eat(wanted) { Ok(()) } else { Err(bad(self.excerpt(), what)) }
    }

    fn quoted(&mut self, what: &'static str) -> Result<&'a str, HeaderError> {
        self.rest = self.rest.trim_start();
        let quote = self.rest.chars().next().filter(|c| matches!(c, '\'' | '"'));
        let Some(quote) = quote else { return Err(bad(self.excerpt(), what)) };
        let inner = &self.rest[1..];
        let end = inner.find(quote).ok_or_else(|| bad("an open quote", what))?;
        self.rest = &inner[end + 1..];
        Ok(&inner[..end])
    }

    fn word(&mut self) -> &'a str {
        self.rest = self.rest.trim_start();
        let end = self.rest.find(|c: char| !c.is_ascii_alphanumeric()).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word
    }

    fn excerpt(&self) -> String {
        let start: String = self.rest.chars().take(16).collect();
        format!("{start:?}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(version: u8, text: &str) -> Result<Header, HeaderError> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend([version, 0]);
        match version {
            1 => bytes.extend((text.len() as u16).to_le_bytes()),
            _ => bytes.extend((text.len() as u32).to_le_bytes()),
        }
        bytes.extend(text.as_bytes());
        Header::read(&mut bytes.as_slice())
    }

    #[test]
    fn what_is_written_is_read_and_aligned() {
        for shape in [vec![], vec![7], vec![600, 3, 30, 30, 30]] {
            let header = Header { dtype: Dtype::F4, fortran_order: false, shape };
            let mut bytes = Vec::new();
            header.write(&mut bytes).unwrap();
            assert_eq!(bytes.len() % 64, 0);
            assert_eq!(Header::read(&mut bytes.as_slice()).unwrap(), header);
        }
    }

    #[test]
    fn other_writers_are_understood() {
        let header = read(2, "{\"shape\":(2L,3L),'fortran_order':True,'descr':'>i2'}").unwrap();
        assert_eq!(header.shape, [2, 3]);
        assert!(header.fortran_order);
        assert_eq!(header.dtype.to_string(), ">i2");
        assert_eq!(read(1, "{'descr': '|u1', 'fortran_order': False, 'shape': (), }").unwrap().shape, []);
    }

    #[test]
    fn what_cannot_be_read_says_why() {
        for (text, says) in [
            ("", "a dictionary"),
            ("{'descr': [('x', '<f4')], 'fortran_order': False, 'shape': (3,)}", "not a record"),
            ("{'descr': '|O', 'fortran_order': False, 'shape': (3,)}", "\"|O\""),
            ("{'descr': '<f4', 'fortran_order': False}", "no shape"),
            ("{'descr': '<f4', 'fortran_order': 1, 'shape': (3,)}", "True or False"),
            ("{'descr': '<f4', 'fortran_order': False, 'shape': (-3,)}", "a whole number"),
            ("{'descr': '<f4", "one plain type"),
        ] {
            let error = read(1, text).unwrap_err().to_string();
            assert!(error.contains(says), "{text}: {error}");
        }
        assert!(read(9, "{}").unwrap_err().to_string().contains("version 9.0"));
        assert!(matches!(Header::read(&mut &b"\x93NUM"[..]), Err(HeaderError::Io(_))));
    }
}

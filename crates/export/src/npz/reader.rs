//! Arrays out of a `.npz`, with every count in the file held against the bytes that are there.

use std::io::{Cursor, Read};

use zip::ZipArchive;
use zip::result::ZipError;

use super::dtype::Dtype;
use super::error::NpzError;
use super::header::{Header, HeaderError};

/// A `.npz` in memory.
pub(crate) struct NpzReader<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
    limit: u64,
}

/// One array of a `.npz`, its header read, its values not yet.
pub(crate) struct ArrayReader<R> {
    pub(crate) key: &'static str,
    pub(crate) header: Header,
    n_values: usize,
    n_read: usize,
    source: R,
}

/// How many values are decoded at a time. Bounds what is allocated ahead of the bytes that prove a count.
const BATCH: usize = 1 << 14;

impl<'a> NpzReader<'a> {
    /// Opens an archive from which no array of more than `limit` bytes will be read.
    pub(crate) fn open(bytes: &'a [u8], limit: u64) -> Result<Self, NpzError> {
        let archive = ZipArchive::new(Cursor::new(bytes))?;
        if archive.has_duplicate_names() {
            return Err(NpzError::TwiceTheSame);
        }
        Ok(Self { archive, limit })
    }

    /// Names of the arrays, in the archive's order.
    pub(crate) fn keys(&self) -> Vec<String> {
        let names = self.archive.file_names().flatten();
        names.map(|name| name.strip_suffix(".npy").unwrap_or(&name).to_owned()).collect()
    }

    pub(crate) fn has(&self, key: &str) -> bool {
        self.archive.index_for_name(&format!("{key}.npy")).is_some()
    }

    /// Opens an array that must be there.
    pub(crate) fn array(&mut self, key: &'static str) -> Result<ArrayReader<impl Read + '_>, NpzError> {
        if !self.has(key) {
            return Err(NpzError::MissingKey { key, found: self.keys() });
        }
        let mut source = self.archive.by_name(&format!("{key}.npy"))?;
        let header = Header::read(&mut source).map_err(|error| match error {
            HeaderError::Io(source) => NpzError::Zip(ZipError::Io(source)),
            problem @ HeaderError::Bad { .. } => {
                NpzError::Header { key: key.to_owned(), problem: problem.to_string() }
            }
        })?;
        let n_bytes = header.n_values().and_then(|n| n.checked_mul(header.dtype.size().max(1)));
        match (header.n_values(), n_bytes) {
            (Some(n_values), Some(bytes)) if bytes as u64 <= self.limit => {
                Ok(ArrayReader { key, header, n_values, n_read: 0, source })
            }
            _ => Err(NpzError::TooLarge { key: key.to_owned(), shape: header.shape, limit: self.limit }),
        }
    }

    /// A whole array of finite numbers, first axis slowest.
    pub(crate) fn numbers(&mut self, key: &'static str) -> Result<(Header, Vec<f64>), NpzError> {
        let mut array = self.array(key)?;
        let values = array.all(FINITE, finite)?;
        Ok((array.header, values))
    }

    /// The one number that an array holds.
    pub(crate) fn number(&mut self, key: &'static str) -> Result<f64, NpzError> {
        let (header, values) = self.numbers(key)?;
        match values.as_slice() {
            [one] => Ok(*one),
            _ => Err(bad_shape(key, &header.shape, "() or (1,)")),
        }
    }

    /// The one text that an array holds.
    pub(crate) fn text(&mut self, key: &'static str) -> Result<String, NpzError> {
        let mut array = self.array(key)?;
        let dtype = array.header.dtype;
        if dtype.is_number() {
            return Err(array.bad_type("text (U or S)"));
        }
        if array.n_values != 1 {
            return Err(bad_shape(key, &array.header.shape, "() or (1,)"));
        }
        let mut bytes = vec![0; dtype.size()];
        array.read_exact(&mut bytes)?;
        array.finish()?;
        dtype.string(&bytes).ok_or_else(|| array.bad_type("text that is text"))
    }
}

impl<R: Read> ArrayReader<R> {
    /// Every value as `convert` makes it, first axis slowest whatever the order in the file. A value of which it makes
    /// nothing is refused: it is not what was `expected`.
    pub(crate) fn all<T: Copy>(
        &mut self,
        expected: &str,
        convert: impl Fn(f64) -> Option<T>,
    ) -> Result<Vec<T>, NpzError> {
        let mut values = Vec::new();
        self.next(self.n_values, &mut values, expected, convert)?;
        if self.header.fortran_order && self.header.shape.len() > 1 {
            values = first_axis_slowest(&values, &self.header.shape);
        }
        Ok(values)
    }

    /// Appends the next `n` values in the file's own order, made and refused as in [`ArrayReader::all`].
    pub(crate) fn next<T: Copy>(
        &mut self,
        n: usize,
        values: &mut Vec<T>,
        expected: &str,
        convert: impl Fn(f64) -> Option<T>,
    ) -> Result<(), NpzError> {
        let dtype = self.header.dtype;
        if !dtype.is_number() {
            return Err(self.bad_type("numbers"));
        }
        let size = dtype.size();
        let mut bytes = vec![0; size * BATCH.min(n)];
        let mut left = n;
        while left > 0 {
            let batch = left.min(BATCH);
            let chunk = &mut bytes[..size * batch];
            self.read_exact(chunk)?;
            for (k, value) in chunk.chunks_exact(size).enumerate() {
                let found = dtype.number(value);
                let Some(converted) = convert(found) else {
                    let (key, index) = (self.key.to_owned(), self.place_of(self.n_read + k));
                    return Err(NpzError::BadValue { key, index, found, expected: expected.to_owned() });
                };
                values.push(converted);
            }
            self.n_read += batch;
            left -= batch;
        }
        if self.n_read == self.n_values { self.finish() } else { Ok(()) }
    }

    fn read_exact(&mut self, bytes: &mut [u8]) -> Result<(), NpzError> {
        self.source.read_exact(bytes).map_err(|source| self.cut(source))
    }

    /// Insists that the array ends here. The archive holds its checksum against the bytes only when it comes to
    /// their end, so a flipped bit would go unnoticed without this.
    fn finish(&mut self) -> Result<(), NpzError> {
        let n_over = std::io::copy(&mut self.source.by_ref().take(1), &mut std::io::sink());
        match n_over.map_err(|source| self.cut(source))? {
            0 => Ok(()),
            _ => Err(bad_shape(
                self.key,
                &self.header.shape,
                "as many values as there are bytes for, found more",
            )),
        }
    }

    fn cut(&self, source: std::io::Error) -> NpzError {
        NpzError::Cut { key: self.key.to_owned(), value: self.n_read, expected: self.n_values, source }
    }

    /// Place along each axis of the value that is `at` in file order.
    fn place_of(&self, mut at: usize) -> Vec<usize> {
        let shape = &self.header.shape;
        let mut place = vec![0; shape.len()];
        let mut step = |axis: usize| {
            place[axis] = at % shape[axis];
            at /= shape[axis];
        };
        if self.header.fortran_order {
            (0..shape.len()).for_each(&mut step);
        } else {
            (0..shape.len()).rev().for_each(&mut step);
        }
        place
    }

    pub(crate) fn bad_type(&self, expected: &'static str) -> NpzError {
        NpzError::BadType { key: self.key.to_owned(), found: self.header.dtype.to_string(), expected }
    }
}

/// What [`finite`] and [`finite_f32`] expect.
pub(crate) const FINITE: &str = "a finite number";

/// A number that is neither NaN nor infinite.
pub(crate) fn finite(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}

/// The same in single precision, in which it may not be infinite either.
pub(crate) fn finite_f32(number: f64) -> Option<f32> {
    Some(number as f32).filter(|single| single.is_finite())
}

pub(crate) fn bad_shape(key: &str, found: &[usize], expected: impl Into<String>) -> NpzError {
    NpzError::BadShape { key: key.to_owned(), found: found.to_vec(), expected: expected.into() }
}

/// Values that lie first axis fastest, put first axis slowest.
fn first_axis_slowest<T: Copy>(values: &[T], shape: &[usize]) -> Vec<T> {
    let mut strides = vec![1; shape.len()];
    for axis in 1..shape.len() {
        strides[axis] = strides[axis - 1] * shape[axis - 1];
    }
    let mut place = vec![0; shape.len()];
    let mut from = 0;
    let mut out = Vec::with_capacity(values.len());
    for _ in 0..values.len() {
        out.push(values[from]);
        for axis in (0..shape.len()).rev() {
            place[axis] += 1;
            from += strides[axis];
            if place[axis] < shape[axis] {
                break;
            }
            from -= place[axis] * strides[axis];
            place[axis] = 0;
        }
    }
    out
}

/// Whether a type's rounding alone can explain the distance of a number from another.
pub(crate) fn is_rounded(dtype: Dtype, number: f64, from: f64) -> bool {
    (number - from).abs() <= dtype.rounding() * from.abs() + f64::EPSILON * from.abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_axis_becomes_the_slowest() {
        // [[1, 2, 3], [4, 5, 6]] with the first axis fastest is 1 4 2 5 3 6.
        assert_eq!(first_axis_slowest(&[1, 4, 2, 5, 3, 6], &[2, 3]), [1, 2, 3, 4, 5, 6]);
        assert_eq!(first_axis_slowest::<u8>(&[], &[0, 3]), []);
    }
}

//! A file's bytes, taken one thing after the other.

use crate::vdb::VdbError;

/// Bytes and a place in them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    pub at: usize,
}

impl<'a> Bytes<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The next `n` bytes.
    pub fn take(&mut self, n: usize) -> Result<&'a [u8], VdbError> {
        let rest = self.bytes.get(self.at..).unwrap_or_default();
        let Some(taken) = rest.get(..n) else {
            return Err(VdbError::Cut { at: self.at, left: rest.len(), expected: n });
        };
        self.at += n;
        Ok(taken)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], VdbError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    pub fn u8(&mut self) -> Result<u8, VdbError> {
        Ok(self.array::<1>()?[0])
    }

    pub fn u32(&mut self) -> Result<u32, VdbError> {
        self.array().map(u32::from_le_bytes)
    }

    pub fn i32(&mut self) -> Result<i32, VdbError> {
        self.array().map(i32::from_le_bytes)
    }

    pub fn i64(&mut self) -> Result<i64, VdbError> {
        self.array().map(i64::from_le_bytes)
    }

    pub fn f64(&mut self) -> Result<f64, VdbError> {
        self.array().map(f64::from_le_bytes)
    }

    /// A corner of something in index space.
    pub fn index(&mut self) -> Result<[i32; 3], VdbError> {
        Ok([self.i32()?, self.i32()?, self.i32()?])
    }

    /// A string: its length in 32 bits, then its bytes.
    pub fn text(&mut self) -> Result<String, VdbError> {
        let n = self.u32()? as usize;
        Ok(String::from_utf8_lossy(self.take(n)?).into_owned())
    }

    /// An error at this place.
    pub fn bad(&self, found: impl Into<String>, expected: impl Into<String>) -> VdbError {
        VdbError::Bad { at: self.at, found: found.into(), expected: expected.into() }
    }
}

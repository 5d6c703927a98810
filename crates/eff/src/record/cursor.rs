use std::collections::BTreeMap;

/// A record's content does not hold what its kind has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Short {
    /// The field that could not be read.
    pub field: &'static str,
    /// What it needs.
    pub expected: &'static str,
}

/// Takes one field after the other off a record's content.
pub(super) struct Cursor<'a> {
    left: &'a [u8],
}

impl<'a> Cursor<'a> {
    pub fn new(body: &'a [u8]) -> Self {
        Self { left: body }
    }

    /// What has not been read yet.
    pub fn left(&self) -> &'a [u8] {
        self.left
    }

    /// All that has not been read yet, taken.
    pub fn rest(&mut self) -> &'a [u8] {
        std::mem::take(&mut self.left)
    }

    pub fn end(&self) -> Result<(), Short> {
        if self.left.is_empty() { Ok(()) } else { Err(Short { field: "end", expected: "no more bytes" }) }
    }

    pub fn u8(&mut self, field: &'static str) -> Result<u8, Short> {
        self.number(field).map(u8::from_le_bytes)
    }

    pub fn u16(&mut self, field: &'static str) -> Result<u16, Short> {
        self.number(field).map(u16::from_le_bytes)
    }

    pub fn u32(&mut self, field: &'static str) -> Result<u32, Short> {
        self.number(field).map(u32::from_le_bytes)
    }

    pub fn u64(&mut self, field: &'static str) -> Result<u64, Short> {
        self.number(field).map(u64::from_le_bytes)
    }

    fn number<const N: usize>(&mut self, field: &'static str) -> Result<[u8; N], Short> {
        let short = Short { field, expected: "more bytes" };
        let (number, left) = self.left.split_first_chunk().ok_or(short)?;
        self.left = left;
        Ok(*number)
    }

    /// Bytes after their length in 4 bytes.
    pub fn bytes32(&mut self, field: &'static str) -> Result<&'a [u8], Short> {
        let n = self.u32(field)?;
        self.take(field, u64::from(n))
    }

    /// Bytes after their length in 8 bytes.
    pub fn bytes64(&mut self, field: &'static str) -> Result<&'a [u8], Short> {
        let n = self.u64(field)?;
        self.take(field, n)
    }

    fn take(&mut self, field: &'static str, n: u64) -> Result<&'a [u8], Short> {
        let short = Short { field, expected: "more bytes" };
        let n = usize::try_from(n).map_err(|_| short)?;
        let (taken, left) = self.left.split_at_checked(n).ok_or(short)?;
        self.left = left;
        Ok(taken)
    }

    /// A text after its length in 4 bytes.
    pub fn text(&mut self, field: &'static str) -> Result<&'a str, Short> {
        let bytes = self.bytes32(field)?;
        std::str::from_utf8(bytes).map_err(|_| Short { field, expected: "UTF-8" })
    }

    /// Entries after their length in bytes, in 4 bytes.
    pub fn list<T>(
        &mut self,
        field: &'static str,
        entry: impl Fn(&mut Self) -> Result<T, Short>,
    ) -> Result<Vec<T>, Short> {
        let mut entries = Self::new(self.bytes32(field)?);
        let mut list = Vec::new();
        while !entries.left.is_empty() {
            list.push(entry(&mut entries)?);
        }
        Ok(list)
    }

    /// Keys and values, no key twice.
    pub fn map<K: Ord, V>(
        &mut self,
        field: &'static str,
        key: impl Fn(&mut Self) -> Result<K, Short>,
        value: impl Fn(&mut Self) -> Result<V, Short>,
    ) -> Result<BTreeMap<K, V>, Short> {
        let entries = self.list(field, |c| Ok((key(c)?, value(c)?)))?;
        let n = entries.len();
        let map: BTreeMap<K, V> = entries.into_iter().collect();
        if map.len() == n { Ok(map) } else { Err(Short { field, expected: "each key once" }) }
    }
}

//! Arrays into a `.npz` whose bytes depend on the arrays alone.

use std::io::{self, Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use super::dtype::Dtype;
use super::header::Header;

/// Arrays at least this long are written with 64-bit sizes; some room is left for what deflate may add.
const LARGE: u64 = 0xf000_0000;

/// How many bytes are gathered before they go to the compressor.
const BATCH: usize = 1 << 16;

/// A `.npz` being written, one array after the other.
pub(crate) struct NpzWriter<W: Write + Seek> {
    zip: ZipWriter<W>,
    packing: CompressionMethod,
}

/// A number as it lies in the file.
pub(crate) trait Value: Copy {
    /// Its type in the header.
    const DTYPE: Dtype;
    /// Appends its bytes.
    fn put(self, bytes: &mut Vec<u8>);
}

macro_rules! value {
    ($type:ty, $dtype:ident) => {
        impl Value for $type {
            const DTYPE: Dtype = Dtype::$dtype;
            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend_from_slice(&self.to_le_bytes());
            }
        }
    };
}

value!(f32, F4);
value!(f64, F8);
value!(i64, I8);
value!(u8, U1);

impl<W: Write + Seek> NpzWriter<W> {
    /// For arrays that deflate makes smaller. Level 1 is what pays for floating-point numbers: level 6 takes three times
    /// as long for a tenth less (`tests/timing.rs`).
    pub(crate) fn packed(out: W) -> Self {
        Self { zip: ZipWriter::new(out), packing: CompressionMethod::Deflated }
    }

    /// For arrays that it does not: places of hair become 3 % smaller, for as much time as the hair took to simulate.
    pub(crate) fn plain(out: W) -> Self {
        Self { zip: ZipWriter::new(out), packing: CompressionMethod::Stored }
    }

    /// Adds an array, first axis slowest. `values` gives as many as the shape has.
    pub(crate) fn array<T: Value>(
        &mut self,
        key: &str,
        shape: &[usize],
        values: impl Iterator<Item = T>,
    ) -> io::Result<()> {
        self.start(key, T::DTYPE, shape)?;
        let mut bytes = Vec::with_capacity(BATCH + 8);
        let mut n_values = 0;
        for value in values {
            value.put(&mut bytes);
            n_values += 1;
            if bytes.len() >= BATCH {
                self.zip.write_all(&bytes)?;
                bytes.clear();
            }
        }
        debug_assert_eq!(n_values, shape.iter().product::<usize>(), "values do not fill the shape of {key}");
        self.zip.write_all(&bytes)
    }

    /// Adds one text.
    pub(crate) fn text(&mut self, key: &str, text: &str) -> io::Result<()> {
        self.start(key, Dtype::text(text.chars().count()), &[])?;
        let bytes: Vec<u8> = text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        self.zip.write_all(&bytes)
    }

    /// Writes the archive's directory and gives the sink back.
    pub(crate) fn finish(self) -> io::Result<W> {
        let mut out = self.zip.finish()?;
        out.flush()?;
        Ok(out)
    }

    fn start(&mut self, key: &str, dtype: Dtype, shape: &[usize]) -> io::Result<()> {
        let n_bytes = shape.iter().fold(dtype.size() as u64, |n, axis| n.saturating_mul(*axis as u64));
        // No clock, no system, no user: the archive is a function of the arrays.
        let options = SimpleFileOptions::default()
            .compression_method(self.packing)
            .compression_level((self.packing == CompressionMethod::Deflated).then_some(1))
            .last_modified_time(DateTime::default())
            .unix_permissions(0o644)
            .system(System::Unix)
            .large_file(n_bytes >= LARGE);
        self.zip.start_file(format!("{key}.npy"), options)?;
        Header { dtype, fortran_order: false, shape: shape.to_vec() }.write(&mut self.zip)
    }
}

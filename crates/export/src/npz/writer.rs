//! Arrays into a `.npz` whose bytes depend on the arrays alone.

use std::io::{self, ErrorKind, Seek, SeekFrom, Write};

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
    zip: ZipWriter<Sink<W>>,
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
        Self { zip: ZipWriter::new(Sink::new(out)), packing: CompressionMethod::Deflated }
    }

    /// For arrays that it does not: places of hair become 3 % smaller, for as much time as the hair took to simulate.
    pub(crate) fn plain(out: W) -> Self {
        Self { zip: ZipWriter::new(Sink::new(out)), packing: CompressionMethod::Stored }
    }

    /// Adds an array, first axis slowest. `values` gives as many as the shape has.
    pub(crate) fn array<T: Value>(
        &mut self,
        key: &str,
        shape: &[usize],
        values: impl Iterator<Item = T>,
    ) -> io::Result<()> {
        self.begin::<T>(key, shape)?;
        let n_values = self.go_on(values)?;
        debug_assert_eq!(n_values, shape.iter().product::<usize>(), "values do not fill the shape of {key}");
        Ok(())
    }

    /// Begins an array, first axis slowest, whose values come next, some at a time.
    pub(crate) fn begin<T: Value>(&mut self, key: &str, shape: &[usize]) -> io::Result<()> {
        self.start(key, T::DTYPE, shape)
    }

    /// The next values of the array that was begun last. Out: how many.
    pub(crate) fn go_on<T: Value>(&mut self, values: impl Iterator<Item = T>) -> io::Result<usize> {
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
        self.zip.write_all(&bytes)?;
        Ok(n_values)
    }

    /// Adds one text.
    pub(crate) fn text(&mut self, key: &str, text: &str) -> io::Result<()> {
        self.start(key, Dtype::text(text.chars().count()), &[])?;
        let bytes: Vec<u8> = text.chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
        self.zip.write_all(&bytes)
    }

    /// Writes the archive's directory and gives the sink back.
    pub(crate) fn finish(self) -> io::Result<W> {
        let mut sink = self.zip.finish()?;
        sink.flush()?;
        sink.failed.map_or(Ok(sink.out), |kind| Err(kind.into()))
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

/// Where an archive goes. Once that takes no more it is told so, and from then on all is taken and forgotten: a
/// `ZipWriter` that is dropped tries to end its archive, and where that fails writes of it to the standard error itself,
/// before and without a line's end to what the caller says.
struct Sink<W> {
    out: W,
    failed: Option<ErrorKind>,
    /// Where the next byte goes, or would go.
    at: u64,
}

impl<W> Sink<W> {
    fn new(out: W) -> Self {
        Self { out, failed: None, at: 0 }
    }

    /// An answer of what is behind it; the first failure is kept. One that only asks to try again is none.
    fn heard<T>(&mut self, answer: io::Result<T>) -> io::Result<T> {
        let failure = answer.as_ref().err().map(io::Error::kind);
        self.failed = self.failed.or(failure.filter(|kind| *kind != ErrorKind::Interrupted));
        answer
    }
}

impl<W: Write> Write for Sink<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let answer = if self.failed.is_some() { Ok(bytes.len()) } else { self.out.write(bytes) };
        let n = self.heard(answer)?;
        self.at += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        let answer = if self.failed.is_some() { Ok(()) } else { self.out.flush() };
        self.heard(answer)
    }
}

impl<W: Seek> Seek for Sink<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let answer = match to {
            _ if self.failed.is_none() => self.out.seek(to),
            SeekFrom::Start(at) => Ok(at),
            SeekFrom::Current(by) | SeekFrom::End(by) => Ok(self.at.saturating_add_signed(by)),
        };
        self.at = self.heard(answer)?;
        Ok(self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;

    /// A disk with room for so many bytes.
    struct Full {
        disk: Cursor<Vec<u8>>,
        room: u64,
    }

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let room = self.room.saturating_sub(self.disk.position()).min(bytes.len() as u64);
            if room == 0 && !bytes.is_empty() {
                return Err(ErrorKind::StorageFull.into());
            }
            self.disk.write(&bytes[..room as usize])
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Seek for Full {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.disk.seek(to)
        }
    }

    fn put<W: Write + Seek>(npz: &mut NpzWriter<W>) -> io::Result<()> {
        npz.array("t", &[3], [0.0, 0.5, 1.0].into_iter())?;
        npz.text("quantity", "wind")?;
        npz.array("pos", &[40], (0..40).map(|k| k as f32))
    }

    /// The failure is told once, by whoever wrote; what is dropped then has nothing to say.
    #[test]
    fn a_full_disk_is_told_of_once() {
        for new in [NpzWriter::plain as fn(Full) -> NpzWriter<Full>, NpzWriter::packed] {
            let mut whole = NpzWriter::plain(Cursor::new(Vec::new()));
            put(&mut whole).unwrap();
            let whole = whole.finish().unwrap().into_inner();
            let mut n_failed = 0;
            for room in 0..whole.len() as u64 {
                let mut npz = new(Full { disk: Cursor::default(), room });
                if let Err(error) = put(&mut npz) {
                    assert_eq!(error.kind(), ErrorKind::StorageFull, "{room}");
                    // What a drop does too, unless the archive is closed.
                    let dropped = npz.zip.finish().err().map(|error| error.to_string());
                    assert!(dropped.is_none_or(|error| error.ends_with("already closed")), "{room}");
                    n_failed += 1;
                } else if let Err(error) = npz.finish() {
                    assert_eq!(error.kind(), ErrorKind::StorageFull, "{room}");
                    n_failed += 1;
                }
            }
            assert!(n_failed > 100, "{n_failed}");
        }
    }
}

use crate::record::PREFIX;
use std::io::{self, Read};

/// Bytes read in order, with their place and their checksum.
pub(crate) struct Source<R> {
    input: R,
    offset: u64,
    crc: crc32fast::Hasher,
    /// The checksum up to where the last record begins.
    crc_before: crc32fast::Hasher,
}

/// What comes next in a file. The content is in the buffer that was passed.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Next {
    /// A whole record.
    Record { opcode: u8, offset: u64 },
    /// The file ends where a record should begin, or within one.
    End { offset: u64, found: String },
}

impl<R: Read> Source<R> {
    pub fn new(input: R) -> Self {
        Self { input, offset: 0, crc: crc32fast::Hasher::new(), crc_before: crc32fast::Hasher::new() }
    }

    /// How many bytes were read.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// The checksum of all bytes from the last [`Source::restart_crc`] to where the last record begins.
    pub fn crc_before(&self) -> u32 {
        self.crc_before.clone().finalize()
    }

    /// The same checksum, continued over the last record's prefix and the first `n` bytes of its content.
    pub fn crc_through(&self, opcode: u8, body: &[u8], n: usize) -> u32 {
        let mut crc = self.crc_before.clone();
        crc.update(&[opcode]);
        crc.update(&(body.len() as u64).to_le_bytes());
        crc.update(&body[..n.min(body.len())]);
        crc.finalize()
    }

    /// Counts the checksum from here on.
    pub fn restart_crc(&mut self) {
        self.crc.reset();
    }

    /// Reads up to `bytes.len()` bytes; fewer only at the end of the file.
    pub fn fill(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let mut n = 0;
        while n < bytes.len() {
            match self.input.read(&mut bytes[n..]) {
                Ok(0) => break,
                Ok(more) => n += more,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.crc.update(&bytes[..n]);
        self.offset += n as u64;
        Ok(n)
    }

    /// Reads the next record's content into `body`, which never grows beyond what the file really holds.
    pub fn next(&mut self, body: &mut Vec<u8>) -> io::Result<Next> {
        let offset = self.offset;
        self.crc_before = self.crc.clone();
        let mut prefix = [0; PREFIX as usize];
        let n = self.fill(&mut prefix)?;
        if n < prefix.len() {
            let found = if n == 0 { "nothing".into() } else { format!("{n} bytes of a record's prefix") };
            return Ok(Next::End { offset, found });
        }
        let [opcode, length @ ..] = prefix;
        let length = u64::from_le_bytes(length);
        body.clear();
        self.input.by_ref().take(length).read_to_end(body)?;
        self.crc.update(body);
        self.offset += body.len() as u64;
        if (body.len() as u64) < length {
            let found = format!("{} bytes of a record of {length}", body.len());
            return Ok(Next::End { offset, found });
        }
        Ok(Next::Record { opcode, offset })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_beyond_the_file_takes_no_memory() {
        let mut file = vec![5];
        file.extend(u64::MAX.to_le_bytes());
        file.extend([1, 2, 3]);
        let mut body = Vec::new();
        let next = Source::new(&file[..]).next(&mut body).unwrap();
        let found = format!("3 bytes of a record of {}", u64::MAX);
        assert_eq!(next, Next::End { offset: 0, found });
        assert!(body.capacity() < 1 << 16);
    }

    #[test]
    fn checksums_stop_where_they_should() {
        let mut file = b"head".to_vec();
        file.extend([7, 2, 0, 0, 0, 0, 0, 0, 0, b'a', b'b']);
        let mut source = Source::new(&file[..]);
        source.fill(&mut [0; 4]).unwrap();
        let mut body = Vec::new();
        assert_eq!(source.next(&mut body).unwrap(), Next::Record { opcode: 7, offset: 4 });
        assert_eq!(source.crc_before(), crc32fast::hash(b"head"));
        assert_eq!(source.crc_through(7, &body, 1), crc32fast::hash(&file[..14]));
    }
}

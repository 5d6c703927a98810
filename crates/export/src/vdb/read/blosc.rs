//! A buffer of Blosc 1, unpacked. OpenVDB packs with it (LZ4 inside, bytes shuffled) wherever it was built with it,
//! as in most programs for pictures. Format: `README_CHUNK_FORMAT.rst` of c-blosc 1.21, and `blosc.c` for what that
//! leaves out (which blocks are split).

use super::lz4;
use std::io::Read;

/// Bytes of the header.
const HEADER: usize = 16;
/// Splits are made of blocks with at least so many elements, of at most so many bytes.
const MIN_ELEMENTS: usize = 128;
const MAX_SPLITS: usize = 16;

/// Unpacks a buffer to exactly `n` bytes.
///
/// # Errors
/// In words, what cannot be read.
pub(super) fn unpack(bytes: &[u8], n: usize) -> Result<Vec<u8>, String> {
    let cut = || "a Blosc buffer that ends early".to_owned();
    let header = bytes.get(..HEADER).ok_or_else(cut)?;
    let word = |at: usize| -> Result<usize, String> {
        let word = bytes.get(at..at + 4).and_then(|b| b.first_chunk::<4>()).ok_or_else(cut)?;
        Ok(u32::from_le_bytes(*word) as usize)
    };
    let (flags, type_size) = (header[2], usize::from(header[3]));
    let (n_bytes, block_size) = (word(4)?, word(8)?);
    if n_bytes != n {
        return Err(format!("a Blosc buffer of {n_bytes} bytes where {n} are expected"));
    }
    if flags & 2 != 0 {
        return bytes.get(HEADER..HEADER + n).map(<[u8]>::to_vec).ok_or_else(cut);
    }
    if flags & 4 != 0 {
        return Err("Blosc with shuffled bits".to_owned());
    }
    if block_size == 0 || type_size == 0 {
        return Err("a Blosc buffer without blocks".to_owned());
    }
    let codec = match flags >> 5 {
        1 => Codec::Lz4,
        3 => Codec::Zlib,
        other => {
            let name = ["BloscLZ", "LZ4", "Snappy", "Zlib", "Zstandard"].get(usize::from(other));
            return Err(format!("Blosc with the codec {}", name.unwrap_or(&"of an unknown number")));
        }
    };
    let mut out = Vec::new();
    for (k, start) in (0..n).step_by(block_size).enumerate() {
        let size = block_size.min(n - start);
        let is_split = flags & 0x10 == 0
            && type_size <= MAX_SPLITS
            && block_size / type_size >= MIN_ELEMENTS
            && size == block_size;
        let n_splits = if is_split { type_size } else { 1 };
        let mut at = word(HEADER + 4 * k)?;
        let mut block = Vec::with_capacity(size);
        for _ in 0..n_splits {
            let packed = word(at)?;
            let data = bytes.get(at + 4..).and_then(|rest| rest.get(..packed)).ok_or_else(cut)?;
            at += 4 + packed;
            let part = size / n_splits;
            if packed == part {
                block.extend_from_slice(data);
            } else {
                block.extend(codec.unpack(data, part).ok_or("a block that Blosc did not pack")?);
            }
        }
        if block.len() != size {
            return Err("a Blosc block of another size".to_owned());
        }
        if flags & 1 != 0 && type_size > 1 {
            unshuffle(&block, type_size, &mut out);
        } else {
            out.extend(block);
        }
    }
    Ok(out)
}

#[derive(Clone, Copy)]
enum Codec {
    Lz4,
    Zlib,
}

impl Codec {
    fn unpack(self, data: &[u8], n: usize) -> Option<Vec<u8>> {
        match self {
            Self::Lz4 => lz4::unpack(data, n),
            Self::Zlib => inflate(data, n),
        }
    }
}

/// Unpacks zlib to exactly `n` bytes.
pub(super) fn inflate(data: &[u8], n: usize) -> Option<Vec<u8>> {
    let mut out = Vec::new();
    // One byte more, so that what is longer is seen to be.
    flate2::read::ZlibDecoder::new(data).take(n as u64 + 1).read_to_end(&mut out).ok()?;
    (out.len() == n).then_some(out)
}

/// Undoes the shuffle of a block: first bytes of all elements, then all second ones; what is left over stays.
fn unshuffle(block: &[u8], type_size: usize, out: &mut Vec<u8>) {
    let n = block.len() / type_size;
    for element in 0..n {
        out.extend((0..type_size).map(|byte| block[byte * n + element]));
    }
    out.extend_from_slice(&block[n * type_size..]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_by_hand() {
        // Two elements of two bytes, shuffled, not packed because that would not make them shorter.
        let mut buffer = vec![2, 1, 0x21, 2, 4, 0, 0, 0, 4, 0, 0, 0, 28, 0, 0, 0];
        buffer.extend([20, 0, 0, 0, 4, 0, 0, 0, b'a', b'c', b'b', b'd']);
        assert_eq!(unpack(&buffer, 4).unwrap(), b"abcd");
        assert!(unpack(&buffer, 5).is_err());
        assert!(unpack(&buffer[..27], 4).is_err());
        buffer[2] = 0x81;
        assert_eq!(unpack(&buffer, 4).unwrap_err(), "Blosc with the codec Zstandard");
    }
}

use crate::parameter::trimmed_text;
use crate::{BLOCK, Header, Processor, ReadError, Warning};
use std::io::{Read, Seek, SeekFrom};

/// The second byte of every C3D file.
const KEY: u8 = 0x50;
/// Zeros before the header that are skipped at most.
const MAX_LEADING_ZEROS: u64 = 4096;
/// The header, and the first four bytes of the parameter section behind it.
const MIN_BYTES: u64 = BLOCK + 4;

/// What the first blocks tell.
#[derive(Debug)]
pub(super) struct Start {
    pub header: Header,
    pub processor: Processor,
    /// Bytes before the header; all block numbers count from here.
    pub base: u64,
    /// Where the parameter section starts.
    pub section_start: u64,
    /// Blocks of the parameter section by its own count, which wraps beyond 255.
    pub section_blocks: u8,
    /// Bytes in the file.
    pub file_bytes: u64,
}

impl Start {
    /// Where a block (counted from 1) starts; block 0 is none.
    pub fn block_start(&self, block: u64) -> Option<u64> {
        Some(self.base + block.checked_sub(1)?.checked_mul(BLOCK)?)
    }
}

/// Reads the header, finds the parameter section and the processor that wrote both.
pub(super) fn read_start<R: Read + Seek>(
    inner: &mut R,
    warnings: &mut Vec<Warning>,
) -> Result<Start, ReadError> {
    let file_bytes = inner.seek(SeekFrom::End(0))?;
    let (base, head) = read_head(inner, file_bytes, warnings)?;
    let (Some((block, _)), true) = (head.split_first_chunk(), head.len() as u64 == MIN_BYTES) else {
        return Err(ReadError::TooShort { found: file_bytes, expected: base + MIN_BYTES });
    };
    if block[1] != KEY {
        return Err(ReadError::NotC3d { offset: base + 1, found: block[1] });
    }
    let (section_start, prefix) = find_section(inner, base, &head, warnings)?;
    let number = prefix[3];
    let processor = match Processor::from_number(number) {
        Some(processor) => processor,
        None => assume_processor(block, section_start + 3, number, warnings)?,
    };
    let header = parse_header(block, processor);
    Ok(Start { header, processor, base, section_start, section_blocks: prefix[2], file_bytes })
}

/// Reads the parameter section, without its first four bytes: up to the data or as many blocks as it counts,
/// whichever is more, for either number can be too small.
pub(super) fn read_parameter_section<R: Read + Seek>(
    inner: &mut R,
    start: &Start,
) -> Result<Vec<u8>, ReadError> {
    let by_count = start.section_start + u64::from(start.section_blocks) * BLOCK;
    let by_data = start.block_start(u64::from(start.header.data_block)).unwrap_or(0);
    let begin = start.section_start + 4;
    let n_bytes = by_count.max(by_data).min(start.file_bytes).saturating_sub(begin);
    Ok(read_at(inner, begin, n_bytes, start.file_bytes)?)
}

/// The header and the first four bytes of the parameter section where it usually is, and the bytes before them.
fn read_head<R: Read + Seek>(
    inner: &mut R,
    file_bytes: u64,
    warnings: &mut Vec<Warning>,
) -> Result<(u64, Vec<u8>), ReadError> {
    let mut head = read_at(inner, 0, MIN_BYTES, file_bytes)?;
    if head.first() != Some(&0) {
        return Ok((0, head));
    }
    let zeros = read_at(inner, 0, MAX_LEADING_ZEROS, file_bytes)?;
    // Nothing but zeros is left to the checks that follow, which say what is wrong.
    let Some(n_zeros) = zeros.iter().position(|&b| b != 0) else { return Ok((0, head)) };
    let base = n_zeros as u64;
    head = read_at(inner, base, MIN_BYTES, file_bytes)?;
    if head.get(1) == Some(&KEY) {
        warnings.push(Warning::LeadingZeros { n_bytes: base });
    }
    Ok((base, head))
}

/// As many bytes as are there; counts in a file are no reason to make room.
fn read_at<R: Read + Seek>(
    inner: &mut R,
    start: u64,
    n_bytes: u64,
    file_bytes: u64,
) -> std::io::Result<Vec<u8>> {
    let n_bytes = n_bytes.min(file_bytes.saturating_sub(start));
    let mut bytes = Vec::with_capacity(n_bytes as usize);
    inner.seek(SeekFrom::Start(start))?;
    inner.take(n_bytes).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The parameter section's place and first four bytes: where the header says, or else in the usual block 2.
fn find_section<R: Read + Seek>(
    inner: &mut R,
    base: u64,
    head: &[u8],
    warnings: &mut Vec<Warning>,
) -> Result<(u64, [u8; 4]), ReadError> {
    let usual = (base + BLOCK, *head.last_chunk().unwrap_or(&[0; 4]));
    let stated_block = head[0];
    if stated_block == 2 {
        return Ok(usual);
    }
    let start = base + u64::from(stated_block.max(1) - 1) * BLOCK;
    let mut prefix = [0; 4];
    inner.seek(SeekFrom::Start(start))?;
    match inner.read_exact(&mut prefix) {
        Err(e) if e.kind() != std::io::ErrorKind::UnexpectedEof => return Err(e.into()),
        // What is not there is no parameter section.
        Ok(()) | Err(_) => {}
    }
    if stated_block > 1 && Processor::from_number(prefix[3]).is_some() {
        return Ok((start, prefix));
    }
    if Processor::from_number(usual.1[3]).is_some() {
        warnings.push(Warning::ParameterBlock { found: stated_block, used: 2 });
    }
    Ok(usual)
}

/// The one processor for which the header makes sense.
fn assume_processor(
    block: &[u8; BLOCK as usize],
    offset: u64,
    found: u8,
    warnings: &mut Vec<Warning>,
) -> Result<Processor, ReadError> {
    let all = [Processor::Intel, Processor::Dec, Processor::Mips];
    let mut sensible = all.into_iter().filter(|&p| makes_sense(&parse_header(block, p)));
    match (sensible.next(), sensible.next()) {
        (Some(processor), None) => {
            warnings.push(Warning::ProcessorAssumed { offset, found, assumed: processor.number() });
            Ok(processor)
        }
        _ => Err(ReadError::Processor { offset, found }),
    }
}

/// Rates and scales that a file can have: one in the other's encoding is far outside.
fn makes_sense(header: &Header) -> bool {
    (1.0..1e5).contains(&header.rate_hz)
        && (1e-6..1e3).contains(&header.scale.abs())
        && header.data_block > 1
        && header.first_frame <= header.last_frame
}

/// Source: Motion Lab Systems, "The C3D File Format: A Technical User Guide", "Header Section" and "Header Events".
fn parse_header(block: &[u8; BLOCK as usize], processor: Processor) -> Header {
    // Words are counted from 1 in every description of the format.
    let word = |n: usize| processor.read_u16([block[2 * n - 2], block[2 * n - 1]]);
    let float =
        |n: usize| processor.read_f32([block[2 * n - 2], block[2 * n - 1], block[2 * n], block[2 * n + 1]]);
    Header {
        parameter_block: block[0],
        n_points: word(2),
        analog_words: word(3),
        first_frame: word(4),
        last_frame: word(5),
        max_gap: word(6),
        scale: float(7),
        data_block: word(9),
        analog_samples: word(10),
        rate_hz: float(11),
        events: (0..event_count(word(150), word(151)))
            .map(|i| (trimmed_text(&block[396 + 4 * i..400 + 4 * i]), float(153 + 2 * i)))
            .collect(),
    }
}

/// Word 150 is 12345 if the header has events, 18 at most.
fn event_count(key: u16, count: u16) -> usize {
    if key == 12345 { usize::from(count).min(18) } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A header with the numbers of its places: 39 points, 4 analog words, frames 3 to 1094, floats, data in block 8.
    fn block() -> [u8; BLOCK as usize] {
        let mut block = [0; BLOCK as usize];
        block[..24].copy_from_slice(&[
            2, 0x50, 39, 0, 4, 0, 3, 0, 0x46, 0x04, 10, 0, // up to the longest gap that was filled
            0, 0, 0x80, 0xbf, 8, 0, 2, 0, 0, 0, 0x48, 0x42, // scale -1, data, analog samples, rate 50
        ]);
        block
    }

    #[test]
    fn words_are_where_the_guide_puts_them() {
        let expected = Header {
            parameter_block: 2,
            n_points: 39,
            analog_words: 4,
            first_frame: 3,
            last_frame: 1094,
            max_gap: 10,
            scale: -1.0,
            data_block: 8,
            analog_samples: 2,
            rate_hz: 50.0,
            events: Vec::new(),
        };
        assert_eq!(parse_header(&block(), Processor::Intel), expected);
    }

    #[test]
    fn header_events() {
        let mut block = block();
        block[298..302].copy_from_slice(&[0x39, 0x30, 2, 0]); // 12345 and two events
        block[304..312].copy_from_slice(&[0, 0, 0, 0x3f, 0, 0, 0x80, 0x3f]); // at 0.5 and 1 s
        block[396..404].copy_from_slice(b"LHS RTO\0");
        let events = parse_header(&block, Processor::Intel).events;
        assert_eq!(events, [("LHS".to_owned(), 0.5), ("RTO".to_owned(), 1.0)]);
        block[298] = 0;
        assert!(parse_header(&block, Processor::Intel).events.is_empty());
    }

    #[test]
    fn a_header_makes_sense_for_one_processor() {
        assert!(makes_sense(&parse_header(&block(), Processor::Intel)));
        assert!(!makes_sense(&parse_header(&block(), Processor::Dec)));
        assert!(!makes_sense(&parse_header(&block(), Processor::Mips)));
    }
}

//! A block of LZ4, unpacked: what Blosc packs with unless it is told otherwise. Format: `lz4_Block_format.md` of the
//! LZ4 project, of 2022.

/// Unpacks a block to exactly `n` bytes; `None` if it is no such block.
pub(super) fn unpack(mut block: &[u8], n: usize) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(n);
    while let Some((token, rest)) = block.split_first() {
        block = rest;
        let literals = length(usize::from(token >> 4), &mut block)?;
        out.extend_from_slice(block.get(..literals)?);
        block = &block[literals..];
        if block.is_empty() {
            // The last sequence has literals only.
            break;
        }
        let (distance, rest) = block.split_first_chunk::<2>()?;
        block = rest;
        let distance = usize::from(u16::from_le_bytes(*distance));
        let matched = length(usize::from(token & 15), &mut block)? + 4;
        if distance == 0 || distance > out.len() || out.len() + matched > n {
            return None;
        }
        // What is copied may overlap what it makes.
        for _ in 0..matched {
            out.push(out[out.len() - distance]);
        }
    }
    (out.len() == n).then_some(out)
}

/// A length of which the token has four bits: 15 is followed by bytes that add to it, the last below 255.
fn length(token: usize, block: &mut &[u8]) -> Option<usize> {
    let mut length = token;
    if token == 15 {
        loop {
            let (more, rest) = block.split_first()?;
            *block = rest;
            length = length.checked_add(usize::from(*more))?;
            if *more < 255 {
                break;
            }
        }
    }
    Some(length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_by_hand() {
        // Three literals, then 4 + 5 from three back; then one literal.
        let block = [0x35, b'a', b'b', b'c', 3, 0, 0x10, b'd'];
        assert_eq!(unpack(&block, 13).unwrap(), b"abcabcabcabcd");
        assert_eq!(unpack(&block, 12), None);
        assert_eq!(unpack(&block[..5], 13), None);
        // From before the beginning.
        assert_eq!(unpack(&[0x10, b'a', 2, 0, 0], 5), None);
        // 15 + 255 + 3 literals.
        let mut long = vec![0xf0, 255, 3];
        long.extend([7; 273]);
        assert_eq!(unpack(&long, 273).unwrap(), [7; 273]);
    }
}

//! Numbers by their bytes: all first bytes, then all second bytes, and so on.
//!
//! Each width has its own lines, as iterators side by side: only of these the compiler makes vector instructions, and
//! they are five times as fast as a loop over places.

/// The bytes of numbers of two bytes.
pub(super) fn split_16<T: Copy>(numbers: &[T], bits: impl Fn(T) -> u16) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(2 * numbers.len());
    for shift in [0, 8] {
        bytes.extend(numbers.iter().map(|number| (bits(*number) >> shift) as u8));
    }
    bytes
}

/// The bytes of numbers of four bytes.
pub(super) fn split_32<T: Copy>(numbers: &[T], bits: impl Fn(T) -> u32) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(4 * numbers.len());
    for shift in [0, 8, 16, 24] {
        bytes.extend(numbers.iter().map(|number| (bits(*number) >> shift) as u8));
    }
    bytes
}

/// The numbers that [`split_16`] took apart; what is left over at the end is ignored.
pub(super) fn join_16(planes: &[u8]) -> impl Iterator<Item = u16> {
    let [low, high] = planes_of(planes);
    low.iter().zip(high).map(|(low, high)| u16::from_le_bytes([*low, *high]))
}

/// The numbers that [`split_32`] took apart; what is left over at the end is ignored.
pub(super) fn join_32(planes: &[u8]) -> impl Iterator<Item = u32> {
    let [a, b, c, d] = planes_of(planes);
    a.iter().zip(b).zip(c).zip(d).map(|(((a, b), c), d)| u32::from_le_bytes([*a, *b, *c, *d]))
}

fn planes_of<const W: usize>(planes: &[u8]) -> [&[u8]; W] {
    let n = planes.len() / W;
    std::array::from_fn(|byte| &planes[byte * n..][..n])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_bytes_come_first() {
        let narrow = [0x201, 0x403, 0x605];
        let planes = split_16(&narrow, |number: u16| number);
        assert_eq!(planes, [1, 3, 5, 2, 4, 6]);
        assert!(join_16(&planes).eq(narrow));
        let wide = [0x4030201, 0x8070605];
        let planes = split_32(&wide, |number: u32| number);
        assert_eq!(planes, [1, 5, 2, 6, 3, 7, 4, 8]);
        assert!(join_32(&planes).eq(wide));
        assert!(split_32(&[], f32::to_bits).is_empty() && join_32(&[1, 2, 3]).next().is_none());
    }
}

// Plane by plane rather than number by number: each pass is a plain copy with a stride, which compilers
// vectorize, and a step's planes fit the cache.

/// All first bytes, then all second bytes, and so on.
pub(super) fn split<const W: usize>(numbers: &[[u8; W]]) -> Vec<u8> {
    let mut planes = Vec::with_capacity(W * numbers.len());
    for byte in 0..W {
        planes.extend(numbers.iter().map(|number| number[byte]));
    }
    planes
}

/// The numbers that [`split`] took apart; what is left over at the end is ignored.
pub(super) fn join<const W: usize>(planes: &[u8]) -> Vec<[u8; W]> {
    let n = planes.len() / W;
    let mut numbers = vec![[0; W]; n];
    for (byte, plane) in planes.chunks_exact(n.max(1)).take(W).enumerate() {
        for (number, value) in numbers.iter_mut().zip(plane) {
            number[byte] = *value;
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_bytes_come_first() {
        let planes = split(&[[1, 2], [3, 4], [5, 6]]);
        assert_eq!(planes, [1, 3, 5, 2, 4, 6]);
        assert_eq!(join::<2>(&planes), [[1, 2], [3, 4], [5, 6]]);
        assert!(split(&[[0u8; 4]; 0]).is_empty() && join::<4>(&[]).is_empty());
    }
}

/// All first bytes, then all second bytes, and so on, of `n` numbers of `W` bytes.
pub(super) fn split<const W: usize>(numbers: impl Iterator<Item = [u8; W]>, n: usize) -> Vec<u8> {
    let mut planes = vec![0; W * n];
    for (k, number) in numbers.enumerate() {
        for (byte, plane) in number.into_iter().zip(planes.chunks_exact_mut(n.max(1))) {
            plane[k] = byte;
        }
    }
    planes
}

/// The numbers that [`split`] took apart; what is left over at the end is ignored.
pub(super) fn join<const W: usize>(planes: &[u8]) -> impl Iterator<Item = [u8; W]> + '_ {
    let n = planes.len() / W;
    (0..n).map(move |k| std::array::from_fn(|byte| planes[byte * n + k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_bytes_come_first() {
        let planes = split([[1, 2], [3, 4], [5, 6]].into_iter(), 3);
        assert_eq!(planes, [1, 3, 5, 2, 4, 6]);
        assert_eq!(join::<2>(&planes).collect::<Vec<_>>(), [[1, 2], [3, 4], [5, 6]]);
        assert!(split([[0u8; 4]; 0].into_iter(), 0).is_empty());
    }
}

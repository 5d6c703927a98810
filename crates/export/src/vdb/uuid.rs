//! A file's UUID, from its contents.

/// A UUID of version 8 (RFC 9562, 5.8: made as its maker likes) of the 128-bit FNV-1a hash of all bytes.
///
/// OpenVDB asks for one to tell a file from another of the same name; a random one would make the same field
/// give other bytes each time.
pub(super) fn from_contents<'a>(parts: impl Iterator<Item = &'a Vec<u8>>) -> String {
    const OFFSET: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let hash = parts.flatten().fold(OFFSET, |hash, byte| (hash ^ u128::from(*byte)).wrapping_mul(PRIME));
    let version = hash & !(0xf << 76) | 8 << 76;
    let variant = version & !(0b11 << 62) | 0b10 << 62;
    let digits = format!("{variant:032x}");
    [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]].join("-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uuid_of_version_8() {
        let uuid = from_contents([vec![1, 2, 3]].iter());
        assert_eq!(uuid.len(), 36);
        assert_eq!(uuid.as_bytes()[14], b'8');
        assert!(matches!(uuid.as_bytes()[19], b'8' | b'9' | b'a' | b'b'));
        assert_ne!(uuid, from_contents([vec![1, 2, 4]].iter()));
        assert_eq!(uuid, from_contents([vec![1], vec![2, 3]].iter()));
    }

    /// The hash's published test vector: FNV-1a 128 of "a" is d228cb696f1a8caf78912b704e4a8964.
    #[test]
    fn the_hash_is_fnv_1a() {
        let uuid = from_contents([b"a".to_vec()].iter());
        assert_eq!(uuid, "d228cb69-6f1a-8caf-b891-2b704e4a8964");
    }
}

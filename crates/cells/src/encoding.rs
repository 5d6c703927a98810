use std::borrow::Cow;

/// The bytes as UTF-8 or a one-byte encoding, without a byte order mark; UTF-16 with its mark is converted.
pub fn plain(bytes: &[u8]) -> Cow<'_, [u8]> {
    let unit = |pair: &[u8], big: bool| {
        if big { u16::from_be_bytes([pair[0], pair[1]]) } else { u16::from_le_bytes([pair[0], pair[1]]) }
    };
    match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => Cow::Borrowed(rest),
        [first @ (0xFF | 0xFE), second, rest @ ..] if *first ^ *second == 1 => {
            let units = rest.chunks_exact(2).map(|pair| unit(pair, *first == 0xFE));
            let text: String =
                char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
            Cow::Owned(text.into_bytes())
        }
        _ => Cow::Borrowed(bytes),
    }
}

/// A cell as text: UTF-8 if it is that, otherwise Latin-1, which gives every byte a character.
pub fn text(cell: &[u8]) -> String {
    match std::str::from_utf8(cell) {
        Ok(text) => text.trim().to_owned(),
        Err(_) => cell.iter().map(|b| char::from(*b)).collect::<String>().trim().to_owned(),
    }
}

/// A text cut to what fits into a message.
pub fn shorten(text: &str) -> String {
    const LONGEST: usize = 60;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodings() {
        assert_eq!(&*plain(b"\xEF\xBB\xBFab"), b"ab");
        assert_eq!(&*plain(b"\xFF\xFEa\0b\0"), b"ab");
        assert_eq!(&*plain(b"\xFE\xFF\0a\0b"), b"ab");
        assert_eq!(text(b"\xE9paule"), "épaule");
        assert_eq!(text("épaule".as_bytes()), "épaule");
    }

    #[test]
    fn long_texts_are_cut_between_characters() {
        assert_eq!(shorten("épaule"), "épaule");
        assert_eq!(shorten(&"é".repeat(99)), format!("{}…", "é".repeat(60)));
    }
}

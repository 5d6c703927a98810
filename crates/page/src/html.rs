use serde::Serialize;

/// Text made safe for HTML, as element content and inside quoted attributes.
///
/// NUL, which HTML cannot hold, becomes the replacement character.
pub fn escape(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\0' => safe.push('\u{fffd}'),
            c => safe.push(c),
        }
    }
    safe
}

/// A value as JSON that may stand inside a `<script type="application/json">`.
///
/// Such an element ends at the first `</script`, wherever it stands, and `<!--` changes how it is read: no `<`
/// may be in it. JSON has `<` in strings only, where `\u003c` says the same.
///
/// # Errors
/// If the value cannot be written as JSON (a map whose keys are no strings).
pub fn json_for_script<T: Serialize>(value: &T) -> Result<String, serde_json::Error> {
    Ok(serde_json::to_string(value)?.replace('<', "\\u003c"))
}

/// A number with a fixed count of decimals, a true minus sign, and a dash where there is no number.
pub fn decimals(value: f64, n_decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{value:.n_decimals$}");
    match text.strip_prefix('-') {
        // -0.00 is 0.00 to a reader.
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.to_owned(),
        Some(digits) => format!("−{digits}"),
        None => text,
    }
}

/// A number with at most a count of decimals: no zeros at its end.
pub fn short(value: f64, max_decimals: usize) -> String {
    let text = decimals(value, max_decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A file size for people: `812 B`, `3.4 kB`, `12 MB`.
pub fn bytes_text(bytes: u64) -> String {
    let mut size = bytes as f64;
    let mut unit = "B";
    for next in ["kB", "MB", "GB", "TB"] {
        if size < 999.5 {
            break;
        }
        size /= 1000.0;
        unit = next;
    }
    if unit == "B" || size >= 99.5 { format!("{size:.0} {unit}") } else { format!("{size:.1} {unit}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_in_text_stays_text() {
        assert_eq!(escape("<b a='1' c=\"&\">\0"), "&lt;b a=&#39;1&#39; c=&quot;&amp;&quot;&gt;\u{fffd}");
    }

    #[test]
    fn json_cannot_close_its_script() {
        let json = json_for_script(&["</script><!--"]).unwrap();
        assert_eq!(json, r#"["\u003c/script>\u003c!--"]"#);
        assert_eq!(serde_json::from_str::<Vec<String>>(&json).unwrap(), ["</script><!--"]);
    }

    #[test]
    fn numbers_read_as_people_write_them() {
        assert_eq!(decimals(-1.25, 1), "−1.2");
        assert_eq!(decimals(-0.001, 2), "0.00");
        assert_eq!(decimals(f64::NAN, 2), "–");
        assert_eq!(
            (short(20.0, 1), short(0.25, 3), short(100.0, 0)),
            ("20".into(), "0.25".into(), "100".into())
        );
        assert_eq!(bytes_text(812), "812 B");
        assert_eq!(bytes_text(3_440), "3.4 kB");
        assert_eq!(bytes_text(999_950), "1.0 MB");
        assert_eq!(bytes_text(412_000_000), "412 MB");
    }
}

use crate::Input;
use serde::Serialize;
use tousle_eff::Attachment;

/// What travels in a field file beside the field: the session as it was given, byte for byte and under the name
/// that its format asks for, and the report of how the field came about.
///
/// # Errors
/// If the report cannot be written as JSON.
pub fn attachments(
    session: Input<'_>,
    report: &impl Serialize,
) -> Result<Vec<Attachment>, serde_json::Error> {
    let is_toml = !session.bytes.trim_ascii_start().starts_with(b"{");
    let (name, media_type) =
        if is_toml { ("session.toml", "application/toml") } else { ("session.json", "application/json") };
    let attachment = |name: &str, media_type: &str, bytes: Vec<u8>| Attachment {
        name: name.to_owned(),
        media_type: media_type.to_owned(),
        bytes,
    };
    Ok(vec![
        attachment(name, media_type, session.bytes.to_vec()),
        attachment("report.json", "application/json", serde_json::to_vec(report)?),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_keeps_its_format() {
        let of = |bytes: &[u8]| {
            let attached = attachments(Input { name: "s", bytes }, &7).unwrap();
            (attached[0].name.clone(), attached[0].bytes.clone(), attached[1].bytes.clone())
        };
        assert_eq!(of(b" {}"), ("session.json".to_owned(), b" {}".to_vec(), b"7".to_vec()));
        assert_eq!(of(b"name = 1").0, "session.toml");
    }
}

//! What has to hold for any bytes, whoever made them up: `tests/all/fuzz.rs` and the targets in `fuzz/` ask the same.
#![allow(dead_code, clippy::unwrap_used)]

use std::io::Cursor;
use tousle_core::{NoProgress, Vec3};
use tousle_eff::{EffError, Part, ReadOptions, Reader, read, recover, validate};

/// Makes the checksums right, as far as there is a structure to make them right for.
pub fn refit(bytes: &mut [u8]) {
    let mut at = 8;
    let mut data_end = None;
    while let Some((prefix, _)) = bytes.get(at..).and_then(|rest| rest.split_first_chunk::<9>()) {
        let length = u64::from_le_bytes(prefix[1..].try_into().unwrap());
        let content = at + 9;
        let Some(end) =
            usize::try_from(length).ok().and_then(|n| content.checked_add(n)).filter(|e| *e <= bytes.len())
        else {
            return;
        };
        match prefix[0] {
            // An unpacked chunk: 28 bytes, an empty name, the length, the records.
            0x06 if length >= 40 && bytes[content + 28..content + 32] == [0; 4] => {
                let crc = crc32fast::hash(&bytes[content + 40..end]);
                bytes[content + 24..content + 28].copy_from_slice(&crc.to_le_bytes());
            }
            0x09 if length >= 4 => {
                let crc = crc32fast::hash(&bytes[content..end - 4]);
                bytes[end - 4..end].copy_from_slice(&crc.to_le_bytes());
            }
            0x0f if length == 4 => {
                let crc = crc32fast::hash(&bytes[..at]);
                bytes[content..end].copy_from_slice(&crc.to_le_bytes());
                data_end = Some(end);
            }
            0x02 if length == 20 => {
                if let Some(start) = data_end {
                    let crc = crc32fast::hash(&bytes[start..end - 4]);
                    bytes[end - 4..end].copy_from_slice(&crc.to_le_bytes());
                }
                return;
            }
            _ => {}
        }
        at = end;
    }
}

/// Whether a file is sound, after everybody was asked.
pub fn all_agree(bytes: &[u8]) -> bool {
    let options = little_memory();
    let is_sound = validate(bytes).unwrap().is_sound;
    let eff = match read(bytes, &options) {
        Ok(eff) => Some(eff),
        Err(EffError::TooLarge { .. }) => return is_sound,
        Err(_) => None,
    };
    assert_eq!(is_sound, eff.is_some());
    let reader = Reader::open(Cursor::new(bytes));
    if let Some(eff) = &eff {
        let mut reader = reader.unwrap();
        let last = eff.field.steps.len() - 1;
        assert_eq!(reader.step(last as u64).unwrap().unwrap(), eff.field.steps[last]);
    } else if let Ok(mut reader) = reader {
        // Not sound, but perhaps elsewhere; reading must end one way or the other.
        let _ = (reader.step(0), reader.poses(), reader.samples());
    }
    let mut out = Vec::new();
    if let Ok(recovery) = recover(Cursor::new(bytes), &mut out, &NoProgress) {
        let validation = validate(&out[..]).unwrap();
        assert!(validation.is_sound, "{:#?}", validation.findings);
        // What has its place in our messages for others is left out.
        let left_out = ["fields from number 1000", "metadata of the channel"];
        let is_left_out = |what: &str| left_out.iter().any(|start| what.starts_with(start));
        let is_skipped = recovery.losses.iter().all(|loss| is_left_out(&loss.what));
        assert!(!is_sound || is_skipped, "{:?}", recovery.losses);
    } else {
        assert!(!is_sound);
    }
    is_sound
}

/// The reader of single steps and of parts, on its own: it looks at less of a file, and what it gives is what the
/// whole has.
pub fn read_in_parts(bytes: &[u8]) {
    let Ok(mut reader) = Reader::open(Cursor::new(bytes)) else { return };
    let n_steps = reader.n_steps();
    let steps: Vec<_> = [0, 1, n_steps / 2, n_steps.wrapping_sub(1)].map(|k| reader.step(k)).into();
    let _ = (reader.poses(), reader.samples(), reader.attachments());
    let half = Part::default().within_secs(0.01, 0.05).within_box_m(Vec3::repeat(-0.1), Vec3::zeros());
    let part = reader.part(&half, &little_memory());
    if let Ok(eff) = read(bytes, &little_memory()) {
        assert_eq!(steps[0].as_ref().unwrap().as_ref(), eff.field.steps.first());
        part.unwrap().field.check().unwrap();
    }
}

fn little_memory() -> ReadOptions {
    let mut options = ReadOptions::default();
    options.max_memory = 1 << 26;
    options
}

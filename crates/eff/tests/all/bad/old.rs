//! Bad files of version 0.

use super::Case;
use crate::forge::{FIELD, POSE, Pieces, pieces};
use crate::good;
use serde_json::json;

pub fn cases() -> Vec<Case> {
    let case = |name, what, findings, change: fn(&mut Pieces)| {
        let make = Box::new(move || {
            let mut pieces = good::old::pieces(&good::old::cases()[0].eff);
            change(&mut pieces);
            pieces.forge()
        });
        Case { name, what, findings, make }
    };
    vec![
        case("newer-member", "a member that version 1 brought", &["json-schema"], |p| {
            p.json(1, |m| m["requires"] = json!([]));
        }),
        case("outside-two", "a wind outside of two components", &["size"], |p| {
            // Field 5, 8 bytes: one number.
            p.message(FIELD, 1).payload = [&[0x08, 1, 0x2a, 8][..], &[0; 8]].concat();
        }),
        case("pose-six", "a pose of one number", &["size"], |p| {
            p.message(POSE, 1).payload = [&[0x08, 1, 0x1a, 8][..], &[0; 8]].concat();
        }),
        case(
            "mixed",
            "steps of version 1 under a manifest of version 0",
            &["channel", "unknown-field", "unknown-field"],
            |p| {
                let newer = pieces(&super::sound());
                let schema = newer.schemas.iter().find(|s| s.0 == FIELD).unwrap();
                p.schemas.iter_mut().filter(|s| s.0 == FIELD).for_each(|s| *s = schema.clone());
                let steps = newer.chunks.into_iter().filter(|chunk| chunk[0].channel_id == FIELD);
                p.chunks.truncate(2);
                p.chunks.extend(steps);
            },
        ),
    ]
}

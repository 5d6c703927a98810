//! Whatever happens to a file, every whole step of it is saved.

use crate::arbitrary::{self, small, small_file, written};
use crate::forge::{self, EDITS, FIELD, MANIFEST, POSE, Piece, Pieces, SAMPLES, pieces, set};
use protox::prost_reflect::Value;
use std::io::Cursor;
use tousle_core::NoProgress;
use tousle_eff::{Eff, Encoding, ReadOptions, Recovery, WriteOptions, read, recover, validate};
use tousle_field::VoxelFlag;

/// What is saved of some bytes, in a file that is sound.
fn saved(bytes: &[u8]) -> Option<(Recovery, Vec<u8>)> {
    let mut out = Vec::new();
    let recovery = recover(Cursor::new(bytes), &mut out, &NoProgress).ok()?;
    let validation = validate(&out[..]).unwrap();
    assert!(validation.is_sound, "{:#?}", validation.findings);
    Some((recovery, out))
}

fn content(bytes: &[u8]) -> Eff {
    read(bytes, &ReadOptions::default()).unwrap()
}

/// Opcode and end of each record of the data section, by the record structure: opcode, length, content.
fn records(bytes: &[u8]) -> Vec<(u8, usize)> {
    let mut records = Vec::new();
    let mut at = 8;
    while records.last().is_none_or(|(opcode, _)| *opcode != 0x0f) {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        records.push((bytes[at], at + 9 + length));
        at += 9 + length;
    }
    records
}

/// Where the chunks of steps end. Manifest with edits, poses and samples have one each; the rest are steps.
fn ends_of_steps(bytes: &[u8]) -> Vec<usize> {
    records(bytes).into_iter().filter(|(opcode, _)| *opcode == 0x06).skip(3).map(|(_, end)| end).collect()
}

#[test]
fn a_whole_file_is_saved_whole() {
    for encoding in [Encoding::F32, Encoding::F16, Encoding::Fixed { max_error: 1e-3 }] {
        let bytes = written(&small(), &WriteOptions::with_encoding(encoding));
        let (recovery, out) = saved(&bytes).unwrap();
        assert!(recovery.is_complete(), "{:?}", recovery.losses);
        assert_eq!(out, bytes, "{encoding:?}");
    }
}

/// Every cut among the steps, and some elsewhere.
#[test]
fn cuts_save_every_whole_step() {
    let bytes = small_file();
    let ends = ends_of_steps(&bytes);
    let among_steps = ends[0] - 300..ends[4] + 20;
    cuts_save(&bytes, (0..bytes.len()).filter(|cut| cut % 41 == 0 || among_steps.contains(cut)));
}

#[test]
#[ignore = "takes a minute; the test above takes all cuts that matter"]
fn every_cut_saves_every_whole_step() {
    let bytes = small_file();
    cuts_save(&bytes, 0..bytes.len());
}

fn cuts_save(bytes: &[u8], cuts: impl Iterator<Item = usize>) {
    let ends = ends_of_steps(bytes);
    assert_eq!(ends.len(), 5);
    for length in cuts {
        let n_whole = ends.iter().filter(|end| **end <= length).count();
        let Some((recovery, out)) = saved(&bytes[..length]) else {
            assert_eq!(n_whole, 0, "{length}");
            continue;
        };
        assert_eq!(recovery.n_steps, n_whole as u64, "{length}");
        assert_eq!(recovery.n_steps_expected, Some(5));
        // A cut in the summary, which only repeats, loses nothing.
        let loses_data = length < records(bytes).last().unwrap().1;
        assert_eq!(recovery.is_complete(), !loses_data, "{length} {recovery:?}");
        assert!(recovery.bridged.is_empty());
        // Reading it again at every cut would only take time.
        if ends.contains(&length) {
            let (found, whole) = (content(&out), small());
            assert_eq!(found.field.steps, whole.field.steps[..n_whole]);
            assert_eq!((found.scene, found.samples), (whole.scene, whole.samples));
            assert_eq!(found.attachments, whole.attachments);
        }
    }
}

#[test]
fn a_step_lost_in_the_middle_is_bridged_and_named() {
    let mut bytes = small_file();
    let ends = ends_of_steps(&bytes);
    bytes[ends[2] - 10] ^= 1;
    let (recovery, out) = saved(&bytes).unwrap();
    assert_eq!(recovery.bridged, [2]);
    assert_eq!(recovery.n_steps, 5);
    assert!(recovery.losses[0].why.contains("chunk-crc") || recovery.losses[0].why.contains("compression"));
    let (found, whole) = (content(&out).field, small().field);
    for k in [0, 1, 3, 4] {
        assert_eq!(found.steps[k], whole.steps[k]);
    }
    assert!((found.steps[2].vector(5) - whole.steps[2].vector(5)).norm() < 1e-6);
    assert!(!found.steps[2].flags.contains(&VoxelFlag::Measured));
}

#[test]
fn steps_lost_at_the_start_move_the_start() {
    let mut bytes = small_file();
    let first_end = ends_of_steps(&bytes)[0];
    bytes[first_end - 10] ^= 1;
    let (recovery, out) = saved(&bytes).unwrap();
    assert_eq!((recovery.first_step, recovery.n_steps), (1, 4));
    let found = content(&out).field;
    assert_eq!(found.start_secs, 1.0 / 30.0);
    assert_eq!(found.steps, small().field.steps[1..]);
}

/// A length that leads astray costs one record: the chunk index at the end leads back.
#[test]
fn a_lost_thread_is_taken_up_again() {
    let mut bytes = small_file();
    let ends = ends_of_steps(&bytes);
    let chunk_2 = (ends[1]..ends[2]).find(|at| bytes[*at] == 0x06).unwrap();
    bytes[chunk_2 + 3] ^= 0x40;
    let (recovery, _) = saved(&bytes).unwrap();
    assert_eq!((recovery.n_steps, &recovery.bridged[..]), (5, &[2][..]));
}

#[test]
fn without_a_manifest_nothing_can_be_saved() {
    let bytes = small_file();
    let mut damaged = bytes.clone();
    damaged[200] ^= 1;
    let error = recover(Cursor::new(&damaged), Vec::new(), &NoProgress).unwrap_err().to_string();
    assert!(error.starts_with("missing: manifest: found none (the chunk at byte"), "{error}");
    for bytes in [&b""[..], b"\x89MCAP0\r\n", b"nothing like it, and a little longer"] {
        assert!(recover(Cursor::new(bytes), Vec::new(), &NoProgress).is_err());
    }
}

/// Puts a message there twice and changes the second.
fn twice(pieces: &mut Pieces, channel_id: u16, k: usize) {
    let again = pieces.message(channel_id, k).clone();
    let chunk = pieces.chunks.iter_mut().find(|chunk| chunk.contains(&again)).unwrap();
    let at = chunk.iter().position(|piece| *piece == again).unwrap();
    chunk.insert(at + 1, again);
    match channel_id {
        MANIFEST | EDITS => {
            let text = String::from_utf8(pieces.message(channel_id, k + 1).payload.clone()).unwrap();
            let other = text.replace("small", "other").replace("\"muted\":false", "\"muted\":true");
            assert_ne!(other, text);
            pieces.message(channel_id, k + 1).payload = other.into_bytes();
        }
        POSE => pieces.proto(POSE, k + 1, |m| set(m, "translation_m.x", Value::F64(9.0))),
        SAMPLES => pieces.proto(SAMPLES, k + 1, |m| forge::put_float(m, "value", 0, 9.0)),
        _ => pieces.proto(FIELD, k + 1, |m| set(m, "outside.x", Value::F64(9.0))),
    }
}

/// What makes a file another one.
type Change = fn(&mut Pieces);

/// Whoever wrote such a file meant one of the two, and the first is the one that readers come to first.
#[test]
fn of_what_is_there_twice_the_first_is_kept_and_the_other_named() {
    let whole = small_file();
    let attachment: Change =
        |p| p.attachments.push(("session.json".into(), "text/plain".into(), b"other".to_vec()));
    let cases: [(Change, &str); 6] = [
        (attachment, "attachment.name: found \"session.json\""),
        (|p| twice(p, MANIFEST, 0), "message: found a second one"),
        (|p| twice(p, EDITS, 0), "message: found a second one"),
        (|p| twice(p, POSE, 2), "index: found 2 again"),
        (|p| twice(p, SAMPLES, 2), "index: found 2 again"),
        (|p| twice(p, FIELD, 2), "index: found 2 again"),
    ];
    for (change, why) in cases {
        let mut forged = pieces(&whole);
        change(&mut forged);
        let (recovery, out) = saved(&forged.forge()).unwrap();
        assert_eq!(recovery.losses.len(), 1, "{why} {:?}", recovery.losses);
        assert!(recovery.losses[0].why.contains(why), "{why} {:?}", recovery.losses);
        assert_eq!(content(&out), small(), "{why}");
    }
}

#[test]
fn a_flipped_bit_does_not_stop_it_from_saving_the_rest() {
    let mut bytes = small_file();
    let ends = ends_of_steps(&bytes);
    let after_manifest = records(&bytes).into_iter().find(|(opcode, _)| *opcode == 0x06).unwrap().1;
    for at in (after_manifest..ends[4]).step_by(5) {
        bytes[at] ^= 1 << (at % 8);
        if let Some((recovery, _)) = saved(&bytes) {
            assert!(recovery.n_steps >= 4, "{at}: {recovery:?}");
        }
        bytes[at] ^= 1 << (at % 8);
    }
}

/// A message index whose opcode became that of the data's end.
#[test]
fn an_end_in_the_middle_is_none() {
    let mut bytes = small_file();
    let ends = ends_of_steps(&bytes);
    assert_eq!(bytes[ends[0]], 0x07);
    bytes[ends[0]] = 0x0f;
    let (recovery, out) = saved(&bytes).unwrap();
    assert_eq!((recovery.n_steps, recovery.bridged.len()), (5, 0));
    assert_eq!(content(&out), small());
}

/// An attachment whose opcode became another one, that of a private record too.
#[test]
fn an_attachment_that_is_none_any_more_is_named() {
    let sound = small_file();
    let at = forge::record(&sound, 0x09, 0).offset;
    for bit in 0..8 {
        let mut bytes = sound.clone();
        bytes[at] ^= 1 << bit;
        let (recovery, out) = saved(&bytes).unwrap();
        assert!(content(&out).attachments.is_empty());
        let what = format!("the attachment at byte {at}");
        assert!(recovery.losses.iter().any(|loss| loss.what == what), "{bit} {:?}", recovery.losses);
        // Without the summary nobody knows what it was.
        if let Some((recovery, _)) = saved(&bytes[..bytes.len() - 1]) {
            assert!(!recovery.is_complete(), "{bit}");
        }
    }
}

/// A header of which any bit is another: the file's end says where all else is.
#[test]
fn without_a_header_all_is_saved() {
    let sound = small_file();
    for at in 0..forge::record(&sound, 0x01, 0).end() {
        let mut bytes = sound.clone();
        bytes[at] ^= 1 << (at % 8);
        let (recovery, out) = saved(&bytes).unwrap();
        assert!(recovery.is_complete(), "{at} {:?}", recovery.losses);
        assert!(out == sound, "{at}");
    }
}

/// Topics, metadata and private records of other programs come along; the first time as they are, and then for ever.
#[test]
fn what_other_programs_wrote_is_copied() {
    let mut forged = pieces(&small_file());
    forged.schemas.push((40, "com.example.Lens".into(), "jsonschema".into(), b"{}".to_vec()));
    forged.channels.push((1000, 40, "/camera/lens".into(), "json".into()));
    forged.channels.push((9, 0, "/note".into(), "json".into()));
    let message = |channel_id, k: u32| Piece {
        channel_id,
        sequence: 7 + k,
        log_time: 5 * u64::from(k),
        publish_time: 6,
        payload: format!("{{\"mm\": {k}}}").into_bytes(),
    };
    forged.chunks.insert(2, vec![message(1000, 0), message(9, 1)]);
    forged.chunks.push(vec![message(1000, 2)]);
    forged.metadata = vec!["com.example".into(), "private".into()];
    let mut bytes = forged.forge();
    let private = forge::record(&bytes, 0x0c, 1);
    bytes[private.offset] = 0x85;
    // After the counts of messages, schemas, channels and attachments, that of metadata.
    let statistics = forge::record(&bytes, 0x0b, 0);
    forge::patch(&mut bytes, statistics, 18, &1u32.to_le_bytes());
    let (recovery, out) = saved(&bytes).unwrap();
    assert!(recovery.is_complete(), "{:?}", recovery.losses);
    assert_eq!(content(&out), small());
    let copy = pieces(&out);
    let lens = copy.channels.iter().find(|(_, _, topic, _)| topic == "/camera/lens").unwrap();
    let schema = copy.schemas.iter().find(|(id, ..)| *id == lens.1).unwrap();
    assert_eq!(schema.1, "com.example.Lens");
    let lenses = copy.chunks.iter().flatten().filter(|piece| piece.channel_id == lens.0);
    let expected = [0, 2].map(|k| Piece { channel_id: lens.0, ..message(1000, k) });
    assert!(lenses.eq(&expected));
    let note = copy.channels.iter().find(|(_, _, topic, _)| topic == "/note").unwrap();
    assert!(copy.chunks.iter().flatten().any(|p| *p == Piece { channel_id: note.0, ..message(9, 1) }));
    for opcode in [0x0c, 0x85] {
        let record = |bytes: &[u8]| {
            let at = forge::record(bytes, opcode, 0);
            bytes[at.offset..at.end()].to_vec()
        };
        assert_eq!(record(&out), record(&bytes));
    }
    assert!(saved(&out).unwrap().1 == out);
    // Whether a private record is one only the checksum of all data says.
    let end_of_header = forge::record(&bytes, 0x01, 0).end();
    bytes[end_of_header - 1] ^= 1;
    let (recovery, out) = saved(&bytes).unwrap();
    assert!(recovery.losses.iter().any(|loss| loss.what == "1 private records"), "{:?}", recovery.losses);
    assert!(forge::records(&out).iter().all(|at| at.opcode < 0x80));
}

/// Fields that are other people's are in no message that is written.
#[test]
fn fields_that_are_skipped_are_named() {
    let mut forged = pieces(&small_file());
    forged.message(POSE, 3).payload.extend([0xc2, 0x3e, 2, 7, 7]);
    forged.message(FIELD, 1).payload.extend([0xc2, 0x3e, 2, 7, 7]);
    let (recovery, out) = saved(&forged.forge()).unwrap();
    let named: Vec<_> = recovery.losses.iter().map(|loss| &*loss.what).collect();
    let in_topic = |topic: &str| format!("fields from number 1000 on, in 1 messages of {topic}");
    assert_eq!(named, [in_topic("/eff/field"), in_topic("/eff/pose")]);
    assert_eq!(content(&out), small());
}

/// A file whose records are all outside chunks.
fn outside_chunks() -> (Pieces, Vec<u8>) {
    let mut forged = pieces(&small_file());
    forged.options = forged.options.clone().use_chunks(false);
    let bytes = forged.forge();
    (forged, bytes)
}

/// Of a message outside chunks there is no checksum of its own: in a damaged file it may be another one.
#[test]
fn what_nothing_vouches_for_is_named() {
    let (forged, sound) = outside_chunks();
    assert!(saved(&sound).unwrap().0.is_complete());
    let first_step = forged.chunks.iter().flatten().position(|p| p.channel_id == FIELD).unwrap();
    let step = forge::record(&sound, 0x05, first_step + 2);
    // A number in it, and its length.
    for at in [step.end() - 200, step.offset + 3] {
        let mut bytes = sound.clone();
        bytes[at] ^= 0x10;
        let (recovery, _) = saved(&bytes).unwrap();
        let n = forge::records(&sound).into_iter().filter(|at| at.opcode == 0x05).count();
        let named = |what: &str| recovery.losses.iter().any(|loss| loss.what == what);
        assert!(named(&format!("{n} records outside chunks")) || named("3 of 5 steps of the field"), "{at}");
    }
}

/// The edits' channel is another by a bit; the summary has it whole.
#[test]
fn edits_whose_channel_is_damaged_are_saved_or_named() {
    let (_, mut bytes) = outside_chunks();
    let at = bytes.windows(14).position(|bytes| bytes == b"\x0a\0\0\0/eff/edits").unwrap();
    bytes[at + 10] ^= 1;
    assert_eq!(content(&saved(&bytes).unwrap().1), small());
    bytes.pop();
    let (recovery, out) = saved(&bytes).unwrap();
    assert!(content(&out).field.layers.is_empty());
    assert!(!recovery.is_complete());
}

/// Samples come among the steps: wherever a long file is cut, it has whole steps and the samples of their times.
#[test]
fn a_file_cut_in_its_first_tenth_has_steps_and_their_samples() {
    let mut eff = small();
    let grid = tousle_field::GridSpec { dims: [12, 12, 12], ..eff.field.grid };
    eff.field.grid = grid;
    eff.field.steps = (0..60).map(|k| arbitrary::step(&grid, f64::from(k))).collect();
    let samples = eff.samples.as_mut().unwrap();
    let step = samples.steps[4].clone();
    // As much in samples as in voxels, all in voxels that are flagged.
    samples.steps = vec![std::iter::repeat_n(step, 300).flatten().collect(); 60];
    let bytes = written(&eff, &WriteOptions::default());
    let mut out = Vec::new();
    let recovery = recover(Cursor::new(&bytes[..bytes.len() / 10]), &mut out, &NoProgress).unwrap();
    let saved = read(&out[..], &ReadOptions::default()).unwrap();
    let n_steps = recovery.n_steps as usize;
    assert!(n_steps >= 3, "{n_steps}");
    assert_eq!(saved.field.steps[..], eff.field.steps[..n_steps]);
    let n_samples = saved.samples.unwrap().steps.len();
    assert!((n_steps..=n_steps + 16).contains(&n_samples), "{n_samples} for {n_steps}");
}

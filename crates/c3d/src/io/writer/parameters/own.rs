use crate::io::writer::header::signed_scale;
use crate::trial::Trial;
use crate::{Group, Parameter, Value, WriteError};

/// Entries that one array holds.
const MAX_ENTRIES: usize = 255;
/// A whole number of frames that a 32-bit float holds exactly.
const MAX_EXACT: usize = 1 << 24;

pub(super) fn n_points(trial: &Trial) -> Result<u16, WriteError> {
    let n_points = trial.labels.len();
    u16::try_from(n_points).map_err(|_| WriteError::TooLarge {
        what: "the points",
        found: n_points as u64,
        limit: 0xffff,
    })
}

/// The trial's groups with the parameters that its fields stand for put in front of the others.
pub(super) fn groups(trial: &Trial, n_points: u16, data_block: u16) -> Result<Vec<Group>, WriteError> {
    let mut groups = trial.parameters.groups.clone();
    put_in_front(&mut groups, "TRIAL", frame_numbers(trial)?);
    put_in_front(&mut groups, "ANALOG", vec![integer("USED", 0)]);
    put_in_front(&mut groups, "POINT", point_parameters(trial, n_points, data_block)?);
    Ok(groups)
}

fn put_in_front(groups: &mut Vec<Group>, name: &str, mut own: Vec<Parameter>) {
    match groups.iter_mut().find(|g| g.name.eq_ignore_ascii_case(name)) {
        Some(group) => {
            own.append(&mut group.parameters);
            group.parameters = own;
        }
        None => groups.insert(0, Group { name: name.into(), parameters: own, ..Group::default() }),
    }
}

fn point_parameters(trial: &Trial, n_points: u16, data_block: u16) -> Result<Vec<Parameter>, WriteError> {
    let frames = trial.n_frames.min(0xffff) as u16;
    let mut parameters = vec![
        integer("USED", n_points),
        float("SCALE", signed_scale(trial)),
        float("RATE", trial.rate_hz),
        integer("DATA_START", data_block),
        integer("FRAMES", frames),
    ];
    if trial.n_frames > 0xffff && trial.n_frames <= MAX_EXACT {
        parameters.push(float("LONG_FRAMES", trial.n_frames as f32));
    }
    if let Some(unit) = &trial.unit {
        parameters.push(texts("UNITS", std::slice::from_ref(unit))?);
    }
    for (part, labels) in trial.labels.chunks(MAX_ENTRIES).enumerate() {
        let name = if part == 0 { "LABELS".to_owned() } else { format!("LABELS{}", part + 1) };
        parameters.push(texts(&name, labels)?);
    }
    Ok(parameters)
}

/// First and last frame, each as two words, the lower first.
fn frame_numbers(trial: &Trial) -> Result<Vec<Parameter>, WriteError> {
    let last = u64::from(trial.first_frame) + trial.n_frames as u64 - 1;
    let last = u32::try_from(last).map_err(|_| WriteError::TooLarge {
        what: "the last frame's number",
        found: last,
        limit: u64::from(u32::MAX),
    })?;
    let words = |number: u32| [number as u16, (number >> 16) as u16].map(u16::cast_signed).to_vec();
    let parameter = |name: &str, number| parameter(name, vec![2], Value::Integers(words(number)));
    Ok(vec![parameter("ACTUAL_START_FIELD", trial.first_frame), parameter("ACTUAL_END_FIELD", last)])
}

fn integer(name: &str, value: u16) -> Parameter {
    parameter(name, Vec::new(), Value::Integers(vec![value.cast_signed()]))
}

fn float(name: &str, value: f32) -> Parameter {
    parameter(name, Vec::new(), Value::Floats(vec![value]))
}

fn texts(name: &str, texts: &[String]) -> Result<Parameter, WriteError> {
    let coded: Vec<Vec<u8>> =
        texts.iter().map(|text| super::record::latin1(text)).collect::<Result<_, _>>()?;
    let length = coded.iter().map(Vec::len).max().unwrap_or(0).max(1);
    let longest = u8::try_from(length).map_err(|_| WriteError::TooLarge {
        what: "a text",
        found: length as u64,
        limit: 255,
    })?;
    let padded = coded.into_iter().flat_map(|mut text| {
        text.resize(length, b' ');
        text
    });
    let value = Value::Text(padded.collect());
    // Never more than MAX_ENTRIES.
    Ok(parameter(name, vec![longest, texts.len() as u8], value))
}

fn parameter(name: &str, dimensions: Vec<u8>, value: Value) -> Parameter {
    Parameter { name: name.into(), description: String::new(), locked: false, dimensions, value }
}

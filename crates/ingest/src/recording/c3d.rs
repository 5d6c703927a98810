use super::{Frames, Point, Positions, Recording, Role};
use crate::{CaptureFormat, IngestError, OtherContent};
use tousle_c3d::{Info, Quantity, Reader, Warning};
use tousle_core::UpAxis;

/// The points of a C3D; analog channels, events and rotations are named.
pub(super) fn read(bytes: &[u8]) -> Result<Recording<'_>, IngestError> {
    let reader = Reader::from_bytes(bytes)?;
    let info = reader.info();
    Ok(Recording {
        format: CaptureFormat::C3d,
        rate_hz: info.rate_hz,
        other_rate_hz: reader.warnings().iter().find_map(other_rate_hz),
        frames: Frames::From { first: i64::from(info.first_frame), n_rows: info.n_frames },
        unit: info.unit.clone(),
        up_axis: info.y_screen.as_deref().and_then(UpAxis::from_name),
        points: (0..info.n_points).map(|idx| point(info, idx)).collect(),
        other: other(info),
        warnings: reader.warnings().iter().map(ToString::to_string).collect(),
        cut: reader.warnings().iter().find_map(cut),
        positions: Positions::C3d(Box::new(reader)),
    })
}

fn cut(warning: &Warning) -> Option<(u64, u64)> {
    match warning {
        Warning::CutShort { claimed, found } => Some((*claimed, *found)),
        _ => None,
    }
}

/// What POINT:RATE says, where the header says otherwise and is believed.
fn other_rate_hz(warning: &Warning) -> Option<f64> {
    match warning {
        Warning::Contradiction { quantity: Quantity::Rate, stated, .. } => Some(*stated),
        _ => None,
    }
}

fn point(info: &Info, idx: usize) -> Point {
    let role = if info.kinds[idx].is_marker() { Role::Marker } else { Role::Computed };
    Point { label: info.label(idx).map(str::to_owned), role }
}

fn other(info: &Info) -> Vec<OtherContent> {
    let analog_rate_hz = info.rate_hz.map(|rate| rate * info.analog.n_samples_per_frame as f64);
    let event = |e: &tousle_c3d::Event| {
        let time = e.time_secs.map(|secs| format!(" at {secs} s")).unwrap_or_default();
        format!("{} {}{time}", e.context, e.label).trim().to_owned()
    };
    let all = [
        OtherContent {
            what: "analog channels".into(),
            count: info.analog.n_channels,
            names: info.analog.labels.clone(),
            rate_hz: analog_rate_hz,
        },
        OtherContent {
            what: "events".into(),
            count: info.events.len(),
            names: info.events.iter().map(event).collect(),
            rate_hz: None,
        },
        OtherContent {
            what: "rotations".into(),
            count: info.rotations.n_rotations,
            names: info.rotations.labels.clone(),
            rate_hz: info.rate_hz,
        },
    ];
    all.into_iter().filter(|content| content.count > 0).collect()
}

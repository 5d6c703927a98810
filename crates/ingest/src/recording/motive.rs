use super::trc::rate_of_times;
use super::{Frames, Point, Positions, Recording, Role};
use crate::{CaptureFormat, IngestError, OtherContent};

/// The positions of a Motive CSV: markers, where bodies say their markers are, and bodies.
pub(super) fn read(bytes: &[u8]) -> Result<Recording<'_>, IngestError> {
    let file = tousle_csv::motive::read(bytes)?;
    let mut warnings = file.warnings;
    let of_header = file.rate_hz.filter(|rate| *rate > 0.0);
    let rate_hz = of_header.or_else(|| rate_of_times(&file.times_secs, &file.table.frames, &mut warnings));
    let rotations = OtherContent {
        what: "rotations".into(),
        count: file.rotations.len(),
        names: file.rotations,
        rate_hz,
    };
    let points = file.table.points.iter().map(|p| Point::new(p.label.clone(), role(&p.kind))).collect();
    Ok(Recording {
        format: CaptureFormat::MotiveCsv,
        rate_hz,
        other_rate_hz: None,
        frames: Frames::listed(file.table.frames, file.table.lines),
        unit: file.unit,
        up_axis: None,
        points,
        positions: Positions::Table(file.table.points.into_iter().map(|p| p.positions).collect()),
        other: if rotations.count > 0 { vec![rotations] } else { Vec::new() },
        warnings,
        cut: None,
    })
}

/// `Marker` is what the cameras saw; `Rigid Body Marker` and `Bone Marker` are where the solved body has it.
fn role(kind: &str) -> Role {
    let kind = kind.to_ascii_lowercase();
    match kind.as_str() {
        "marker" | "" => Role::Marker,
        solved if solved.ends_with("marker") => Role::Solved,
        _ => Role::Computed,
    }
}

use super::{Frames, Positions, Recording, markers};
use crate::{CaptureFormat, IngestError, OtherContent};
use tousle_csv::vicon::{Layout, Section, SectionKind, ViconFile};

/// The trajectories of a Vicon CSV; other sections are named.
///
/// A file without trajectories gives the frames of its first section and no points.
pub(super) fn read(bytes: &[u8]) -> Result<Recording<'_>, IngestError> {
    let ViconFile { layout, mut sections, mut warnings } = tousle_csv::vicon::read(bytes)?;
    let idx = sections.iter().position(|s| s.kind == SectionKind::Trajectories);
    let mut main = sections.remove(idx.unwrap_or(0));
    let mut other: Vec<OtherContent> = sections.iter().map(describe).collect();
    if idx.is_none() {
        other.insert(0, describe(&main));
        warnings.push("the file has no section of trajectories".into());
    }
    if sections.iter().any(|s| s.kind == SectionKind::Trajectories) {
        warnings.push("the file has more than one section of trajectories; the first is taken".into());
    }
    let unit = unit(&main, &mut warnings);
    let table = std::mem::take(&mut main.table);
    let frames = match idx {
        Some(_) => Frames::listed(table.frames, table.lines),
        None => Frames::From { first: main.first_frame.unwrap_or(1), n_rows: main.n_rows },
    };
    let format = match layout {
        Layout::Nexus => CaptureFormat::ViconCsv,
        Layout::Workstation => CaptureFormat::ViconWorkstationCsv,
    };
    Ok(Recording {
        format,
        rate_hz: main.rate_hz,
        other_rate_hz: None,
        frames,
        unit,
        up_axis: None,
        points: markers(table.points.iter().map(|p| p.label.clone())),
        positions: Positions::Table(table.points.into_iter().map(|p| p.positions).collect()),
        other,
        warnings,
        cut: None,
    })
}

fn describe(section: &Section) -> OtherContent {
    OtherContent {
        what: if section.title.is_empty() { "untitled section".into() } else { section.title.clone() },
        count: if section.names.is_empty() { section.n_rows } else { section.names.len() },
        names: section.names.clone(),
        rate_hz: section.rate_hz,
    }
}

/// The one unit that all trajectories name.
fn unit(section: &Section, warnings: &mut Vec<String>) -> Option<String> {
    let mut units: Vec<&str> = section.table.points.iter().filter_map(|p| p.unit.as_deref()).collect();
    units.sort_unstable();
    units.dedup();
    if units.len() > 1 {
        warnings.push(format!("trajectories in different units: {}", units.join(", ")));
        return Some(units.join(" and "));
    }
    units.first().map(|&unit| unit.to_owned())
}

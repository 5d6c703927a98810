//! Names and times of an edit, held against the groom and the motion it is made for.

use crate::e4::of_edit;
use crate::path::{StrandPath, check_motion};
use crate::{Action, ControlPoint, Drag, EditError, EditList, Key, Target};
use tousle_core::{Groom, Strand, StrandMotion, Vec3};

/// A key of a drag, found in a groom and a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundKey {
    /// Index of the strand in the groom.
    pub strand_idx: usize,
    /// The control point, from the root, at least 1.
    pub control_point: usize,
    /// When, s.
    pub secs: f64,
    /// Where the point should be, head space, m.
    pub target_m: Vec3,
    /// Where the given motion has it, head space, m.
    pub unedited_m: Vec3,
}

/// Finds all keys of the drag with this number (from 1) in a list, in order of time.
///
/// # Errors
/// [`EditError`] if the motion is not of this groom, or the drag names what is not there.
pub fn find_keys(
    list: &EditList,
    number: usize,
    groom: &Groom,
    motion: &StrandMotion,
) -> Result<Vec<FoundKey>, EditError> {
    check_motion(motion, groom)?;
    let edit = &list.edits[number - 1];
    let Action::Drag(drag) = &edit.action;
    let bad = of_edit(number, &edit.name);
    let (first_secs, second_secs) = list.keys_secs(number)?;
    let mut found = Vec::new();
    let own = (&drag.strand, drag.control_point, second_secs, drag.target);
    let also = |key: &Key| {
        let secs = key.time.secs(list.rate_hz).ok_or("found keys given as frames, expected a `rate_hz`")?;
        if secs > first_secs {
            return Ok(secs);
        }
        Err(format!("found a key at {secs} s, expected one after the first, {first_secs} s"))
    };
    for (strand, point, secs, target) in std::iter::once(Ok(own))
        .chain(drag.also.iter().map(|key| Ok((&key.strand, key.control_point, also(key)?, key.target))))
        .collect::<Result<Vec<_>, String>>()
        .map_err(&bad)?
    {
        let (strand_idx, control_point) = find_point(groom, strand, point).map_err(&bad)?;
        check_within(motion, first_secs, secs).map_err(&bad)?;
        let unedited_m = StrandPath::new(motion, strand_idx).points_at(secs)[control_point];
        let target_m = match target {
            Target::At(at) => at,
            Target::Offset(offset) => unedited_m + offset,
        };
        found.push(FoundKey { strand_idx, control_point, secs, target_m, unedited_m });
    }
    found.sort_by(|a, b| a.secs.total_cmp(&b.secs));
    Ok(found)
}

/// A drag whose strand, point and keys were found.
pub(crate) struct Resolved<'a> {
    pub(crate) number: usize,
    pub(crate) drag: &'a Drag,
    pub(crate) strand: &'a Strand,
    pub(crate) path: StrandPath<'a>,
    /// The dragged control point, from the root, at least 1.
    pub(crate) dragged: usize,
    pub(crate) first_secs: f64,
    pub(crate) second_secs: f64,
    /// The strand's control points at the second key, unedited, m.
    pub(crate) unedited_m: Vec<Vec3>,
}

/// Finds what the edit with this number (from 1) drags, and when.
pub(crate) fn resolve<'a>(
    list: &EditList,
    number: usize,
    drag: &'a Drag,
    groom: &'a Groom,
    motion: &'a StrandMotion,
) -> Result<Resolved<'a>, EditError> {
    let bad = of_edit(number, &list.edits[number - 1].name);
    let (first_secs, second_secs) = list.keys_secs(number)?;
    let (strand_idx, dragged) = find_point(groom, &drag.strand, drag.control_point).map_err(&bad)?;
    let strand = &groom.strands[strand_idx];
    check_within(motion, first_secs, second_secs).map_err(&bad)?;
    let path = StrandPath::new(motion, strand_idx);
    let unedited_m = path.points_at(second_secs);
    Ok(Resolved { number, drag, strand, path, dragged, first_secs, second_secs, unedited_m })
}

/// A strand's index, and the control point's.
fn find_point(groom: &Groom, strand: &str, point: ControlPoint) -> Result<(usize, usize), String> {
    let strand_idx = find_strand(groom, strand)?;
    let strand = &groom.strands[strand_idx];
    let last = strand.rest_curve_m.len() - 1;
    let point = match point {
        ControlPoint::Tip => last,
        ControlPoint::Index(index) => index as usize,
    };
    if point == 0 || point > last {
        return Err(format!("strand `{}`: found control point {point}, expected 1 to {last}", strand.name));
    }
    Ok((strand_idx, point))
}

fn check_within(motion: &StrandMotion, first_secs: f64, second_secs: f64) -> Result<(), String> {
    let (start, end) = (motion.times_secs[0], motion.times_secs[motion.times_secs.len() - 1]);
    // A key on the last frame may round to just after it.
    let slack = 1e-9 * end.abs().max(1.0);
    if first_secs < start - slack || second_secs > end + slack {
        return Err(format!(
            "found keys at {first_secs} s and {second_secs} s, expected both within the motion, {start} s to {end} s"
        ));
    }
    Ok(())
}

fn find_strand(groom: &Groom, name: &str) -> Result<usize, String> {
    let mut found =
        groom.strands.iter().enumerate().filter(|(_, strand)| strand.name == name).map(|(k, _)| k);
    match (found.next(), found.count()) {
        (Some(strand_idx), 0) => Ok(strand_idx),
        (Some(_), more) => Err(format!("found {} strands called `{name}`, expected one", more + 1)),
        (None, _) => {
            let names: Vec<&str> = groom.strands.iter().map(|strand| strand.name.as_str()).collect();
            let known = match names.as_slice() {
                [first, .., last] if names.len() > 8 => {
                    format!("one of the groom's {}, `{first}` to `{last}`", names.len())
                }
                _ => format!("one of: {}", names.join(", ")),
            };
            Err(format!("found no strand `{name}`, expected {known}"))
        }
    }
}

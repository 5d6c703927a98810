//! Names and times of an edit, held against the groom and the motion it is made for.

use crate::e4::of_edit;
use crate::path::StrandPath;
use crate::{ControlPoint, Drag, EditError, EditList};
use tousle_core::{Groom, Strand, StrandMotion, Vec3};

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
    let strand_idx = find_strand(groom, &drag.strand).map_err(&bad)?;
    let strand = &groom.strands[strand_idx];
    let last = strand.rest_curve_m.len() - 1;
    let dragged = match drag.control_point {
        ControlPoint::Tip => last,
        ControlPoint::Index(index) => index as usize,
    };
    if dragged == 0 || dragged > last {
        return Err(bad(format!(
            "strand `{}`: found control point {dragged}, expected 1 to {last}",
            strand.name
        )));
    }
    let (start, end) = (motion.times_secs[0], motion.times_secs[motion.times_secs.len() - 1]);
    // A key on the last frame may round to just after it.
    let slack = 1e-9 * end.abs().max(1.0);
    if first_secs < start - slack || second_secs > end + slack {
        return Err(bad(format!(
            "found keys at {first_secs} s and {second_secs} s, expected both within the motion, {start} s to {end} s"
        )));
    }
    let path = StrandPath::new(motion, strand_idx);
    let unedited_m = path.points_at(second_secs);
    Ok(Resolved { number, drag, strand, path, dragged, first_secs, second_secs, unedited_m })
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

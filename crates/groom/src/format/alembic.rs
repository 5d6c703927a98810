//! Alembic: every curves object under its transforms, in one groom.
//!
//! An own reader of the Ogawa container and of the little that curves need. The crates that read Alembic leave
//! bounds to their callers; the container is a tree of groups and data, and this is all of it. Archives in HDF5,
//! which Alembic wrote before 2013, are not read. Alembic states neither unit nor up axis. Where values change
//! over time the first sample is taken for the rest pose, with a warning.
//!
//! Source: Alembic's own library is its only specification (`lib/Alembic/Ogawa`, `AbcCoreOgawa/ReadUtil.cpp`,
//! `AbcGeom/ICurves.cpp`, `AbcGeom/XformOp.h`).

mod curves;
mod ogawa;
mod properties;
mod xform;

use super::GroomFormat;
use super::curves::{Curves, Place};
use crate::error::GroomReadError;
use crate::raw::RawGroom;
use ogawa::{Archive, Group};
use properties::{Compound, object_names};

/// How deep objects may be in one another.
const MAX_DEPTH: usize = 128;

/// Place of the top object among the root group's children.
const TOP_OBJECT: usize = 2;

pub(super) fn read(bytes: &[u8]) -> Result<RawGroom, GroomReadError> {
    let archive = Archive::open(bytes)?;
    let top = archive.root()?.group(&archive, TOP_OBJECT)?;
    let mut walk = Walk { archive, curves: Curves::default() };
    walk.visit(&top, "", Place::top(), 0)?;
    walk.curves.finish().ok_or_else(|| bad("the archive", "no curves", "some"))
}

/// The way through the objects, and what it comes across.
struct Walk<'a> {
    archive: Archive<'a>,
    curves: Curves,
}

impl Walk<'_> {
    /// Takes in an object's curves and those below it. An object is a group of its properties, its children, and
    /// last their names.
    fn visit(
        &mut self,
        object: &Group,
        path: &str,
        above: Place,
        depth: usize,
    ) -> Result<(), GroomReadError> {
        if depth > MAX_DEPTH {
            return Err(bad(path, "an object in over 128 others", "fewer"));
        }
        let mut place = above;
        if object.has_group(0) {
            let properties = Compound::read(&self.archive, object, 0, path)?;
            if let Some(xform) = properties.compound(&self.archive, ".xform", path)? {
                let local = xform::read(&self.archive, &xform, path)?;
                let above = if local.inherits { above } else { Place::top() };
                place = above.then(&local.matrix, local.changes);
            }
            if let Some(geometry) = properties.compound(&self.archive, ".geom", path)? {
                curves::take(&self.archive, &geometry, path, &place, &mut self.curves)?;
            }
        }
        for (k, name) in object_names(&self.archive, object, path)?.into_iter().enumerate() {
            let child = object.group(&self.archive, k + 1)?;
            self.visit(&child, &format!("{path}/{name}"), place, depth + 1)?;
        }
        Ok(())
    }
}

fn bad(place: &str, found: &str, expected: &str) -> GroomReadError {
    GroomReadError::Malformed {
        format: GroomFormat::Alembic,
        place: if place.is_empty() { "/".to_owned() } else { place.to_owned() },
        found: found.to_owned(),
        expected: expected.to_owned(),
    }
}

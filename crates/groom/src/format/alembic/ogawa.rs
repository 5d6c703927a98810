//! Ogawa: a tree of groups and data, each known by its offset.

use std::cell::Cell;

use super::bad;
use crate::error::GroomReadError;

/// Magic, whether the file was finished, version, offset of the root group.
const HEADER_BYTES: usize = 16;

/// Set in a child's offset if the child is data.
const IS_DATA: u64 = 1 << 63;

/// Groups and data may be shared by many parents, as equal samples are. All that is read counts against this many
/// times the file's size, so that no small file is a large groom.
const MOST_READ: usize = 64;

/// The bytes of an archive.
pub(super) struct Archive<'a> {
    bytes: &'a [u8],
    n_left: Cell<usize>,
}

/// A group: the offsets of its children.
pub(super) struct Group {
    children: Vec<u64>,
}

impl<'a> Archive<'a> {
    pub(super) fn open(bytes: &'a [u8]) -> Result<Self, GroomReadError> {
        if bytes.len() < HEADER_BYTES {
            return Err(bad("the header", &format!("{} bytes", bytes.len()), "16 bytes"));
        }
        if bytes[5] != 0xff {
            return Err(bad("byte 5", &format!("{:#04x}", bytes[5]), "0xff, which a finished archive has"));
        }
        Ok(Self { bytes, n_left: Cell::new(bytes.len().saturating_mul(MOST_READ)) })
    }

    pub(super) fn root(&self) -> Result<Group, GroomReadError> {
        self.group_at(self.u64_at(8)?)
    }

    fn group_at(&self, offset: u64) -> Result<Group, GroomReadError> {
        if offset == 0 {
            return Ok(Group { children: Vec::new() });
        }
        let place = usize::try_from(offset).unwrap_or(usize::MAX);
        let children = self.counted(place, 8)?;
        let offset = |b: &[u8]| u64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]);
        Ok(Group { children: children.chunks_exact(8).map(offset).collect() })
    }

    /// What stands behind a count of things of `size` bytes.
    fn counted(&self, place: usize, size: usize) -> Result<&'a [u8], GroomReadError> {
        let count = self.u64_at(place)?;
        let start = place + 8;
        let left = self.bytes.len() - start;
        let n_bytes = usize::try_from(count).ok().and_then(|n| n.checked_mul(size)).filter(|n| *n <= left);
        let Some(n_bytes) = n_bytes else {
            let found = format!("{count} times {size} bytes");
            return Err(bad(
                &format!("byte {place}"),
                &found,
                &format!("at most the {left} bytes that are left"),
            ));
        };
        match self.n_left.get().checked_sub(n_bytes + 8) {
            Some(n_left) => self.n_left.set(n_left),
            None => {
                return Err(bad("the archive", "the same bytes over and over", "at most 64 times its size"));
            }
        }
        Ok(&self.bytes[start..start + n_bytes])
    }

    fn u64_at(&self, place: usize) -> Result<u64, GroomReadError> {
        let bytes = place.checked_add(8).and_then(|end| self.bytes.get(place..end));
        let Some(bytes) = bytes else {
            return Err(bad(&format!("byte {place}"), "the end of the file", "eight bytes"));
        };
        let mut word = [0; 8];
        word.copy_from_slice(bytes);
        Ok(u64::from_le_bytes(word))
    }
}

impl Group {
    pub(super) fn n_children(&self) -> usize {
        self.children.len()
    }

    pub(super) fn has_group(&self, index: usize) -> bool {
        self.children.get(index).is_some_and(|offset| offset & IS_DATA == 0)
    }

    /// A child that is a group.
    pub(super) fn group(&self, archive: &Archive<'_>, index: usize) -> Result<Self, GroomReadError> {
        match self.children.get(index) {
            Some(offset) if offset & IS_DATA == 0 => archive.group_at(*offset),
            Some(_) => Err(bad(&format!("child {index} of a group"), "data", "a group")),
            None => Err(bad(&format!("child {index} of a group"), "the group's end", "a group")),
        }
    }

    /// A child that is data; nothing where there is none.
    pub(super) fn data<'a>(&self, archive: &Archive<'a>, index: usize) -> Result<&'a [u8], GroomReadError> {
        match self.children.get(index) {
            Some(&IS_DATA) | None => Ok(&[]),
            Some(offset) if offset & IS_DATA != 0 => {
                archive.counted(usize::try_from(offset & !IS_DATA).unwrap_or(usize::MAX), 1)
            }
            Some(_) => Err(bad(&format!("child {index} of a group"), "a group", "data")),
        }
    }
}

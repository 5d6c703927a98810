mod record;

use crate::parameter::{Group, Parameter, Parameters};
use crate::{Processor, Warning};
use record::{Content, Record};
use std::collections::{BTreeMap, BTreeSet};

/// Reads the records of a parameter section, as far as they can be followed.
///
/// `bytes` starts behind the section's first four bytes, `section_start` is the place of these in the file.
///
/// Each record tells twice where the next one is: by its contents and by a pointer. Either can be wrong in real
/// files (no length of the description, the other byte order, a pointer that overflows), so the pointer is followed
/// if a record stands there, and else the contents.
pub(super) fn read_parameters(
    bytes: &[u8],
    processor: Processor,
    section_start: u64,
    warnings: &mut Vec<Warning>,
) -> Parameters {
    let section = Section { bytes, processor, offset: section_start + 4 };
    let groups = grouped(section.contents(warnings));
    if groups.iter().all(|(_, g)| g.parameters.is_empty()) {
        warnings.push(Warning::NoParameters);
    }
    for (group_id, group) in &groups {
        report(*group_id, group, warnings);
    }
    Parameters { groups: groups.into_iter().map(|(_, group)| group).collect() }
}

/// Real files have some hundreds; far more than any could want.
const MAX_RECORDS: usize = 0xffff;

/// The bytes of a parameter section.
#[derive(Clone, Copy)]
struct Section<'a> {
    bytes: &'a [u8],
    processor: Processor,
    /// Place of the first byte in the file, for messages.
    offset: u64,
}

impl Section<'_> {
    /// What the records hold, in order.
    fn contents(self, warnings: &mut Vec<Warning>) -> Vec<Content> {
        let mut contents = Vec::new();
        let mut at = 0;
        for _ in 0..MAX_RECORDS {
            let record = match record::read(self.bytes, at, self.processor) {
                Ok(Some(record)) => record,
                Ok(None) => return contents,
                Err(reason) => {
                    warnings.push(Warning::BrokenParameters { offset: self.place(at), reason });
                    return contents;
                }
            };
            let next = self.next(at, &record, warnings);
            contents.push(record.content);
            match next {
                Some(next) => at = next,
                None => return contents,
            }
        }
        let reason = "more than 65535 records";
        warnings.push(Warning::BrokenParameters { offset: self.place(at), reason });
        contents
    }

    /// Where the record after this one starts; `None` if this is the last.
    fn next(self, at: usize, record: &Record, warnings: &mut Vec<Warning>) -> Option<usize> {
        let pointer = self.processor.read_u16(record.pointer);
        if pointer == 0 {
            return None;
        }
        let stated = record.pointer_at + usize::from(pointer);
        if stated == record.end {
            return Some(stated);
        }
        let swapped = record.pointer_at + usize::from(pointer.swap_bytes());
        // No record starts inside the values of the one before: reading comes to an end, and what is read is not
        // more than what is there.
        let places = [stated, record.end, swapped].map(|place| place.max(record.values_end));
        let is_record =
            |place: &usize| matches!(record::read(self.bytes, *place, self.processor), Ok(Some(_)));
        let is_end = |place: &usize| matches!(record::read(self.bytes, *place, self.processor), Ok(None));
        let found = places.into_iter().find(is_record).or_else(|| places.into_iter().find(is_end));
        // If there is nothing anywhere, the place that the pointer names will say what is wrong there.
        let used = found.unwrap_or(places[0]);
        if used != stated {
            warnings.push(Warning::BadOffset {
                offset: self.place(at),
                name: record.content.name().to_owned(),
                found: self.place(stated),
                used: self.place(used),
            });
        }
        Some(used)
    }

    fn place(self, at: usize) -> u64 {
        self.offset + at as u64
    }
}

/// Puts parameters into their groups, which may be named before or after them.
fn grouped(contents: Vec<Content>) -> Vec<(u8, Group)> {
    let mut groups: Vec<(u8, Group)> = Vec::new();
    let mut place_of = BTreeMap::new();
    for content in contents {
        let (Content::Group(id, _) | Content::Parameter(id, _)) = content;
        let place = *place_of.entry(id).or_insert_with(|| {
            groups.push((id, Group::default()));
            groups.len() - 1
        });
        let group = &mut groups[place].1;
        match content {
            // A group that is named twice keeps its first name.
            Content::Group(_, named) if group.name.is_empty() => {
                *group = Group { parameters: std::mem::take(&mut group.parameters), ..named };
            }
            Content::Group(..) => {}
            Content::Parameter(_, parameter) => group.parameters.push(parameter),
        }
    }
    groups
}

fn report(group_id: u8, group: &Group, warnings: &mut Vec<Warning>) {
    let n_repeats = n_repeats(&group.parameters);
    if n_repeats > 0 {
        warnings.push(Warning::DuplicateParameters { group: group.name.clone(), n_parameters: n_repeats });
    }
    if group.name.is_empty() {
        warnings.push(Warning::UnnamedGroup { group_id, n_parameters: group.parameters.len() });
    }
}

fn n_repeats(parameters: &[Parameter]) -> usize {
    let mut names = BTreeSet::new();
    parameters.iter().filter(|p| !names.insert(p.name.to_ascii_uppercase())).count()
}

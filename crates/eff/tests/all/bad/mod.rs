//! Bad files, each broken in one way.

mod container;
mod content;
pub mod old;

use crate::arbitrary::tiny;
use crate::forge::{Pieces, pieces};
use tousle_core::NoProgress;
use tousle_eff::{Encoding, WriteOptions, write};

pub struct Case {
    pub name: &'static str,
    pub what: &'static str,
    /// The codes that validation must give, all of them, in order.
    pub findings: &'static [&'static str],
    pub make: Box<dyn Fn() -> Vec<u8>>,
}

pub fn cases() -> Vec<Case> {
    let mut cases = container::cases();
    cases.extend(content::cases());
    cases
}

fn sound() -> Vec<u8> {
    packed(Encoding::F32)
}

fn packed(encoding: Encoding) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(&tiny(), &mut bytes, &WriteOptions::with_encoding(encoding), &NoProgress).unwrap();
    bytes
}

/// A file whose bytes were changed.
fn patched(
    name: &'static str,
    what: &'static str,
    findings: &'static [&'static str],
    change: fn(&mut Vec<u8>),
) -> Case {
    let make = Box::new(move || {
        let mut bytes = sound();
        change(&mut bytes);
        bytes
    });
    Case { name, what, findings, make }
}

/// A file that was put together otherwise.
fn forged(
    name: &'static str,
    what: &'static str,
    findings: &'static [&'static str],
    change: fn(&mut Pieces),
) -> Case {
    forged_from(Encoding::F32, name, what, findings, change)
}

/// A file with previews that was put together otherwise.
fn forged_preview(
    name: &'static str,
    what: &'static str,
    findings: &'static [&'static str],
    change: fn(&mut Pieces),
) -> Case {
    let make = Box::new(move || {
        let mut bytes = Vec::new();
        write(&tiny(), &mut bytes, &WriteOptions::default().with_preview(), &NoProgress).unwrap();
        let mut pieces = pieces(&bytes);
        change(&mut pieces);
        pieces.forge()
    });
    Case { name, what, findings, make }
}

fn forged_from(
    encoding: Encoding,
    name: &'static str,
    what: &'static str,
    findings: &'static [&'static str],
    change: fn(&mut Pieces),
) -> Case {
    let make = Box::new(move || {
        let mut pieces = pieces(&packed(encoding));
        change(&mut pieces);
        pieces.forge()
    });
    Case { name, what, findings, make }
}

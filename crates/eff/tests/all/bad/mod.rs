//! Bad files, each broken in one way.

mod container;
mod content;
pub mod old;

use crate::arbitrary::{tiny, tiny_file, written};
use crate::forge::{Pieces, pieces};
use tousle_eff::{Encoding, WriteOptions};

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
    tiny_file(Encoding::F32)
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
    forged_as(WriteOptions::default().with_preview(), name, what, findings, change)
}

fn forged_from(
    encoding: Encoding,
    name: &'static str,
    what: &'static str,
    findings: &'static [&'static str],
    change: fn(&mut Pieces),
) -> Case {
    forged_as(WriteOptions::with_encoding(encoding), name, what, findings, change)
}

fn forged_as(
    options: WriteOptions,
    name: &'static str,
    what: &'static str,
    findings: &'static [&'static str],
    change: fn(&mut Pieces),
) -> Case {
    let make = Box::new(move || {
        let mut pieces = pieces(&written(&tiny(), &options));
        change(&mut pieces);
        pieces.forge()
    });
    Case { name, what, findings, make }
}

pub mod by_hand;

use super::{for_other_tools, is_damage, print_json};
use crate::args::ValidateArgs;
use crate::ui::Outcome;
use by_hand::ByHand;
use serde::Serialize;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;
use tousle_eff::Validation;
use tousle_groom::{GroomOptions, GroomReadError};
use tousle_pipeline::Watch;

/// What is said of one file.
#[derive(Serialize)]
struct Verdict {
    file: String,
    /// Set when the file cannot be read at all.
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
    #[serde(flatten)]
    found: Option<Found>,
}

/// What was found in one file.
#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum Found {
    Field(Validation),
    /// It says its kind itself.
    #[serde(untagged)]
    ByHand(ByHand),
}

impl Verdict {
    fn is_sound(&self) -> bool {
        match &self.found {
            Some(Found::Field(validation)) => validation.is_sound,
            Some(Found::ByHand(by_hand)) => by_hand.is_sound,
            None => false,
        }
    }
}

/// `tousle validate`
pub fn run(args: &ValidateArgs, watch: &dyn Watch) -> anyhow::Result<Outcome> {
    let stage = watch.stage("validate");
    let mut verdicts = Vec::with_capacity(args.files.len());
    for (k, file) in args.files.iter().enumerate() {
        verdicts.push(validate(file));
        stage.at(k as u64 + 1, args.files.len() as u64);
    }
    drop(stage);
    if args.json {
        print_json(&verdicts)?;
    } else {
        verdicts.iter().for_each(print);
    }
    Ok(if verdicts.iter().all(Verdict::is_sound) { Outcome::Fine } else { Outcome::Invalid })
}

fn validate(path: &Path) -> Verdict {
    let file = path.display().to_string();
    match look_at(path) {
        Ok(found) => Verdict { file, error: None, found: Some(found) },
        Err(error) => Verdict { file, error: Some(format!("{error:#}")), found: None },
    }
}

/// The most bytes of a file that people write.
const MAX_BY_HAND: u64 = 1 << 30;

/// A field is read as a stream, whatever its length; all else is small. No byte is read twice, as it cannot be from a pipe.
fn look_at(path: &Path) -> anyhow::Result<Found> {
    let mut file = File::open(path)?;
    let mut bytes = Vec::new();
    file.by_ref().take(8).read_to_end(&mut bytes)?;
    if !bytes.starts_with(b"\x89MCAP") && file.metadata()?.len() <= MAX_BY_HAND {
        file.by_ref().take(MAX_BY_HAND).read_to_end(&mut bytes)?;
        let by_hand = by_hand::validate(&bytes).or_else(|| exported(&bytes)).or_else(|| groom(&bytes));
        if let Some(told) = by_hand.or_else(|| capture(&bytes)) {
            return Ok(Found::ByHand(told));
        }
    }
    Ok(Found::Field(tousle_eff::validate(BufReader::new(bytes.chain(file)))?))
}

/// A file for other tools, in which there is nothing to check.
fn exported(bytes: &[u8]) -> Option<ByHand> {
    let (kind, found) = for_other_tools(bytes)?;
    Some(ByHand::of_no_use(kind, found, "`tousle import` makes a field of wind in them"))
}

/// A groom in a format that no person writes: its reader's answer. Unit and axes are for the command that uses it.
fn groom(bytes: &[u8]) -> Option<ByHand> {
    match tousle_groom::inspect_groom(bytes, &GroomOptions::default()) {
        Ok(_) => Some(ByHand::groom(None)),
        Err(GroomReadError::UnknownFormat { .. }) => None,
        Err(error) => Some(ByHand::groom(Some(format!("{:#}", anyhow::Error::from(error))))),
    }
}

/// A capture: what is wrong with it shows beside its session.
fn capture(bytes: &[u8]) -> Option<ByHand> {
    let format = tousle_ingest::guess_format(bytes)?;
    let advice = "`tousle inspect` tells what is in it, with its --session how good it is";
    Some(ByHand::of_no_use("capture", &format!("a capture ({format})"), advice))
}

fn print(verdict: &Verdict) {
    if let Some(error) = &verdict.error {
        sayln!("{}: {error}", verdict.file);
    }
    let (findings, n_more): (Vec<String>, usize) = match &verdict.found {
        Some(Found::Field(v)) => (v.findings.iter().map(ToString::to_string).collect(), v.n_more),
        Some(Found::ByHand(b)) => (b.findings.iter().map(ToString::to_string).collect(), b.n_more),
        None => return,
    };
    let (n, sound) = (findings.len(), if verdict.is_sound() { "sound" } else { "NOT SOUND" });
    sayln!(
        "{}: {sound}{}",
        verdict.file,
        if n == 0 { String::new() } else { format!(", {n} finding{}", if n == 1 { "" } else { "s" }) }
    );
    for finding in findings {
        sayln!("  {finding}");
    }
    if n_more > 0 {
        sayln!("  … and {n_more} more");
    }
    if let Some(Found::Field(validation)) = &verdict.found
        && validation.errors().any(|finding| is_damage(finding.code))
    {
        sayln!("  (`tousle recover` saves the whole steps)");
    }
}

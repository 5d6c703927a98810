//! Wind from elsewhere: which files, in which order, of which kind.

use crate::args::ImportArgs;
use crate::commands::{ending, name};
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};
use tousle_core::{Progress, Quantity};
use tousle_export::{FieldNpzOptions, ReadField, VdbOptions, VdbStep};
use tousle_pipeline::read_file;

/// Reads the wind that was named.
pub fn read(args: &ImportArgs, progress: &dyn Progress) -> anyhow::Result<ReadField> {
    match &args.wind[..] {
        _ if is_vdb(args) => vdbs(args, progress),
        [path] => npz(path, args),
        _ => wrong!("found {} files, expected one .npz, or .vdb files only", args.wind.len()),
    }
}

/// Whether it is OpenVDB.
pub fn is_vdb(args: &ImportArgs) -> bool {
    args.wind.iter().all(|path| ending(path) == "vdb")
}

fn npz(path: &Path, args: &ImportArgs) -> anyhow::Result<ReadField> {
    let mut options = FieldNpzOptions::default();
    options.extent_m = Some(args.extent_mm.unwrap_or(600.0) * 1e-3);
    options.quantity = Some(Quantity::AirVelocity);
    let read = tousle_export::read_field_npz_with(&read_file(path)?, &options)
        .with_context(|| format!("cannot read the wind {}", name(path)))?;
    if args.extent_mm.is_some() && read.assumed.iter().all(|assumption| assumption.what != "origin, edge") {
        let found = name(path);
        wrong!(
            "--extent-mm: found with {found}, which has `origin` and `edge`, expected where it has neither"
        );
    }
    Ok(read)
}

fn vdbs(args: &ImportArgs, progress: &dyn Progress) -> anyhow::Result<ReadField> {
    let mut options = VdbOptions::default();
    options.wind.clone_from(&args.grid);
    options.rate_hz = args.rate_hz;
    let paths = match &args.wind[..] {
        [path] if !path.exists() => numbered(path)?,
        paths => paths.to_vec(),
    };
    let mut steps = Vec::new();
    for (k, path) in (0..).zip(&paths) {
        progress.at(k, paths.len() as u64);
        let step = tousle_export::read_step_vdb(&read_file(path)?, &options)
            .with_context(|| format!("cannot read the wind {}", name(path)))?;
        steps.push((path, step));
    }
    if args.rate_hz.is_some() && steps.iter().all(|(_, step)| step.time_secs().is_some()) {
        wrong!("--rate-hz: found with .vdb files that say when they are, expected where they do not");
    }
    in_order(&mut steps);
    let steps: Vec<VdbStep> = steps.into_iter().map(|(_, step)| step).collect();
    let all = || if paths.len() == 1 { name(&paths[0]) } else { format!("{} and on", name(&paths[0])) };
    tousle_export::join_steps_vdb(&steps, &options).with_context(|| format!("cannot read the wind {}", all()))
}

/// Orders steps by their times, or where files do not say them by the numbers in their names.
fn in_order(steps: &mut [(&PathBuf, VdbStep)]) {
    if steps.iter().all(|(_, step)| step.time_secs().is_some()) {
        let secs = |step: &VdbStep| step.time_secs().unwrap_or_default();
        steps.sort_by(|(_, a), (_, b)| secs(a).total_cmp(&secs(b)));
    } else {
        steps.sort_by_key(|(path, _)| number(path));
    }
}

/// The last number in a file's name: 12 of `smoke_v2.0012.vdb`.
fn number(path: &Path) -> Option<u64> {
    let stem = path.file_stem()?.to_string_lossy().into_owned();
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = stem[..end].rfind(|c: char| !c.is_ascii_digit()).map_or(0, |k| k + 1);
    stem[start..end].parse().ok()
}

/// The files that `export -o` of this name has written: `OUT.0000.vdb` and on for `OUT.vdb`.
fn numbered(path: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let stem = path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."));
    let entries = std::fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
    let mut found: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|p| ending(p) == "vdb")
        .filter(|p| {
            let name = p.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
            let digits = name.strip_prefix(&stem).and_then(|rest| rest.strip_prefix('.'));
            digits.is_some_and(|d| !d.is_empty() && d.bytes().all(|b| b.is_ascii_digit()))
        })
        .collect();
    if found.is_empty() {
        bail!("cannot read {}: there is no such file, and no {stem}.0000.vdb", path.display());
    }
    found.sort();
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_number_counts() {
        for (name, expected) in [
            ("smoke_v2.0012.vdb", Some(12)),
            ("wind9.vdb", Some(9)),
            ("10_wind.vdb", Some(10)),
            ("wind.vdb", None),
        ] {
            assert_eq!(number(Path::new(name)), expected, "{name}");
        }
    }
}

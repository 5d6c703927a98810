//! The shot's own head motion: `.npz`, or a transform in USD text.

use crate::args::SimulateArgs;
use anyhow::Context;
use std::path::{Path, PathBuf};
use tousle_core::{Assumption, PoseTrack, Vec3};
use tousle_eff::Eff;
use tousle_pipeline::read_file;
use tousle_usda::PoseOptions;

/// A head's motion on the field's clock, and what was assumed to get it there.
pub struct ShotHead {
    /// The motion.
    pub poses: PoseTrack,
    /// How time codes and axes were taken.
    pub assumed: Vec<Assumption>,
}

/// Reads what `--head` names; `None` without it.
pub fn read_head(args: &SimulateArgs, eff: &Eff) -> anyhow::Result<Option<ShotHead>> {
    let Some(name) = &args.head else { return Ok(None) };
    let (path, prim) = split(name);
    let bytes = read_file(&path)?;
    let says = || format!("cannot read the head's poses {}", path.display());
    if is_usd(&path) {
        return read_usda(&bytes, prim, args, eff, &path).with_context(says).map(Some);
    }
    let poses = tousle_export::read_poses_npz(&bytes).with_context(says)?;
    Ok(Some(ShotHead { poses, assumed: Vec::new() }))
}

fn read_usda(
    bytes: &[u8],
    prim: Option<String>,
    args: &SimulateArgs,
    eff: &Eff,
    path: &Path,
) -> anyhow::Result<ShotHead> {
    let mut options = PoseOptions::default();
    options.prim = prim;
    options.axes = args.head_axes;
    options.start_code = args.head_start;
    options.start_secs = eff.field.start_secs;
    options.world_up = (-eff.scene.gravity_world).try_normalize(1e-9).unwrap_or_else(Vec3::z);
    let read = tousle_usda::read_poses(bytes, &options)?;
    for warning in &read.warnings {
        note!("warning: {}: {warning}", path.display());
    }
    let mut assumed = Vec::new();
    let mut assume = |what: &str, value: String, why: &str| {
        assumed.push(Assumption { what: what.to_owned(), value, why: why.to_owned() });
    };
    if args.head_start.is_none() {
        let value = format!("time code {} of {} at {} s", read.start_code, read.prim, options.start_secs);
        assume(
            "head: start",
            value,
            "the stage's first time code meets the field's first step; --head-start",
        );
    }
    if args.head_axes.is_none() {
        let value = "up as the stage; nose along x where z is up, along z where y is up".to_owned();
        assume("head: axes", value, "no USD file states them; --head-axes");
    }
    Ok(ShotHead { poses: read.poses, assumed })
}

/// Whether poses are those of a USD transform.
pub fn is_usd(path: &Path) -> bool {
    super::ending(path).starts_with("usd")
}

/// `FILE.usda:/World/Head` as file and prim. The file's name may be any that the system has, the prim's is text.
pub fn split(name: &Path) -> (PathBuf, Option<String>) {
    let file = name.ancestors().skip(1).find_map(|place| {
        let ending = place.extension()?.to_str()?.strip_suffix(':')?;
        ending.eq_ignore_ascii_case("usda").then(|| (place, place.with_extension(ending)))
    });
    let Some((place, file)) = file else { return (name.to_owned(), None) };
    let prim = name.strip_prefix(place).ok().map(|prim| format!("/{}", prim.display()));
    (file, prim)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_and_prim() {
        for (name, file, prim) in [
            ("a.npz", "a.npz", None),
            ("C:/a.usda", "C:/a.usda", None),
            ("C:/A.USDA:/World/Head", "C:/A.USDA", Some("/World/Head")),
            ("a.usda:/b/c.usda:/Head", "a.usda:/b/c.usda", Some("/Head")),
        ] {
            assert_eq!(split(Path::new(name)), (PathBuf::from(file), prim.map(str::to_owned)));
        }
    }
}

use std::io::{self, Write};

use tousle_core::{Groom, StrandMotion, UpAxis};
use tousle_field::Scene;

use super::body::write_body;
use super::curves::write_curves;
use super::hair::Hair;
use super::options::{HairGeometry, UsdOptions};
use super::reeds::write_reeds;
use super::text::Text;
use super::transform::write_transforms;
use crate::ExportError;

/// Writes a motion as a `.usda` layer: meters, one time code a frame, the hair under one `Xform` called `Hair`.
///
/// Curves are `/Hair/Curves`, ribbons `/Hair/Reeds`, colliders `/Hair/Body` with purpose `guide`; strands keep
/// the groom's order, and `primvars:id` tells it to faces and curves. Widths are diameters. In the world,
/// `/Hair` carries the head's pose over time; in head space it carries nothing.
///
/// Streams: what is held beside the motion does not grow with its length. A [`std::io::BufWriter`] is not needed.
///
/// # Errors
/// [`ExportError::BadGroom`], [`ExportError::BadMotion`] if either is unusable or they do not fit together,
/// [`ExportError::BadOptions`] if the options ask for a scene and bring none, [`ExportError::Io`] if `out` takes
/// no more.
pub fn write_motion_usda(
    motion: &StrandMotion,
    groom: &Groom,
    options: &UsdOptions<'_>,
    out: impl Write,
) -> Result<(), ExportError> {
    let hair = Hair::new(motion, groom, options)?;
    check(options)?;
    let mut text = Text::new(out);
    write_header(&mut text, &hair, options)?;
    text.line(format_args!("def Xform \"Hair\" ("))?;
    text.line(format_args!("    kind = \"component\""))?;
    text.line(format_args!(")"))?;
    text.open(format_args!("{{"))?;
    if let Some(scene) = options.scene.filter(|_| options.in_world) {
        write_head(&mut text, &hair, scene)?;
    }
    if options.geometry != HairGeometry::Reeds {
        write_curves(&mut text, &hair, options.curve_type)?;
    }
    if options.geometry != HairGeometry::Curves {
        write_reeds(&mut text, &hair)?;
    }
    if let Some(scene) = options.scene.filter(|_| options.with_body) {
        write_body(&mut text, &hair, scene)?;
    }
    text.close("}")?;
    text.finish()?;
    Ok(())
}

fn check(options: &UsdOptions<'_>) -> Result<(), ExportError> {
    let bad = |found: &str, expected: &str| {
        Err(ExportError::BadOptions { found: found.to_owned(), expected: expected.to_owned() })
    };
    if !(options.width_scale.is_finite() && options.width_scale > 0.0) {
        return bad(&format!("a width scale of {}", options.width_scale), "a number above 0");
    }
    if (options.in_world || options.with_body) && options.scene.is_none_or(|s| s.poses.poses.is_empty()) {
        return bad("no scene", "one with a head pose, for a motion in the world or with a body");
    }
    if options.in_world && options.world_up == UpAxis::X {
        return bad("a world with x up", "y or z, which USD knows");
    }
    Ok(())
}

fn write_header<W: Write>(text: &mut Text<W>, hair: &Hair<'_>, options: &UsdOptions<'_>) -> io::Result<()> {
    let up = if options.in_world && options.world_up == UpAxis::Y { "Y" } else { "Z" };
    let space = if options.in_world { "world" } else { "head: x forward, y to the subject's left, z up" };
    let (first, last) = (hair.codes[0], hair.codes[hair.codes.len() - 1]);
    text.line(format_args!("#usda 1.0"))?;
    text.open(format_args!("("))?;
    text.line(format_args!("defaultPrim = \"Hair\""))?;
    text.line(format_args!("doc = \"hair in wind, by tousle; space: {space}\""))?;
    text.line(format_args!("startTimeCode = {first}"))?;
    text.line(format_args!("endTimeCode = {last}"))?;
    text.line(format_args!("timeCodesPerSecond = {}", hair.rate_hz))?;
    text.line(format_args!("framesPerSecond = {}", hair.rate_hz))?;
    text.line(format_args!("metersPerUnit = 1"))?;
    text.line(format_args!("upAxis = \"{up}\""))?;
    text.close(")")?;
    text.line(format_args!(""))
}

fn write_head<W: Write>(text: &mut Text<W>, hair: &Hair<'_>, scene: &Scene) -> io::Result<()> {
    let pose = |t: f64| scene.poses.motion_at(t).world_from_head;
    write_transforms(text, hair, scene.poses.is_still(), pose)
}

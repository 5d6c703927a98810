//! Hair as thin `BasisCurves`.

use std::io::{self, Write};

use super::hair::{Hair, write_color, write_extents};
use super::options::CurveType;
use super::text::Text;
use tousle_core::Along;

pub(super) fn write_curves<W: Write>(text: &mut Text<W>, hair: &Hair<'_>, kind: CurveType) -> io::Result<()> {
    text.open_prim("BasisCurves", "Curves")?;
    match kind {
        CurveType::Linear => text.line(format_args!("uniform token type = \"linear\""))?,
        CurveType::CatmullRom => {
            text.line(format_args!("uniform token type = \"cubic\""))?;
            text.line(format_args!("uniform token basis = \"catmullRom\""))?;
            // Without this the first and the last segment of each strand would not be drawn.
            text.line(format_args!("uniform token wrap = \"pinned\""))?;
        }
    }
    let counts = &hair.motion.counts;
    text.array("int[] curveVertexCounts", counts, |text, n| text.usize(*n), "")?;
    // One width a point, even where all of a strand are the same: Blender 5.0 takes widths by the curve for widths of
    // the first points and makes balloons of them.
    let widths = hair.groom.strands.iter().zip(&hair.widths_m).flat_map(|(strand, width)| {
        (0..strand.rest_curve_m.len()).map(move |k| width * Along::at(&strand.along.width, k) as f32)
    });
    let widest = widths.clone().fold(0.0, f32::max);
    text.array("float[] widths", widths, Text::f32, " (interpolation = \"vertex\")")?;
    text.array("int[] primvars:id", 0..counts.len(), Text::usize, " (interpolation = \"uniform\")")?;
    write_color(text)?;
    write_extents(text, &hair.codes, |frame, bounds| {
        hair.motion.frame(frame).iter().for_each(|p| bounds.add(*p));
        bounds.grow(widest / 2.0);
    })?;
    text.samples("point3f[] points", &hair.codes, |text, frame| {
        text.list(hair.motion.frame(frame), |text, p| text.tuple(*p))
    })?;
    text.close("}")
}

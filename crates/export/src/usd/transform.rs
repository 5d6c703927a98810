//! Rigid and scaled transforms as USD has them: row vectors, so the matrix is the transpose of ours.

use std::io::{self, Write};

use nalgebra::Matrix4;
use tousle_core::Pose;

use super::hair::Hair;
use super::text::Text;

const DECLARATION: &str = "matrix4d xformOp:transform";

/// A pose over time, or one value where it never changes.
pub(super) fn write_transforms<W: Write>(
    text: &mut Text<W>,
    hair: &Hair<'_>,
    is_still: bool,
    pose: impl Fn(f64) -> Pose,
) -> io::Result<()> {
    if is_still {
        return write_transform(text, &pose(0.0).to_homogeneous());
    }
    text.samples(DECLARATION, &hair.codes, |text, frame| {
        put_matrix(text, &pose(hair.motion.times_secs[frame]).to_homogeneous());
        Ok(())
    })?;
    write_order(text)
}

/// A transform that does not change.
pub(super) fn write_transform<W: Write>(text: &mut Text<W>, matrix: &Matrix4<f64>) -> io::Result<()> {
    text.value(DECLARATION, |text| put_matrix(text, matrix))?;
    write_order(text)
}

fn write_order<W: Write>(text: &mut Text<W>) -> io::Result<()> {
    text.line(format_args!("uniform token[] xformOpOrder = [\"xformOp:transform\"]"))
}

fn put_matrix<W: Write>(text: &mut Text<W>, matrix: &Matrix4<f64>) {
    for (column, open) in ["( (", ", (", ", (", ", ("].into_iter().enumerate() {
        text.put(format_args!("{open}"));
        for row in 0..4 {
            if row > 0 {
                text.put(format_args!(", "));
            }
            text.f64(matrix[(row, column)]);
        }
        text.put(format_args!(")"));
    }
    text.put(format_args!(" )"));
}

use crate::MeshError;
use crate::error::bad;
use std::io::{self, BufRead, Read};
use tousle_core::{HeadAxes, LengthUnit, Vec3};

/// What an OBJ file does not say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOptions {
    /// The unit of its positions.
    pub unit: LengthUnit,
    /// How the head's axes lie in the file's. The file's origin is the head's center.
    pub axes: HeadAxes,
}

/// Triangles in head space.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// The corners, head space, m.
    pub points_m: Vec<Vec3>,
    /// Three corners each, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The longest side of the upright box around it, m.
    pub fn across_m(&self) -> f64 {
        let low = self.points_m.iter().fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
        let high = self.points_m.iter().fold(Vec3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
        (high - low).max()
    }
}

/// Reads all the faces of an OBJ file as one mesh; faces of more than three corners are cut into triangles.
///
/// # Errors
/// [`MeshError`] if the bytes are no OBJ file, a position is not a finite number, there is no triangle, or the axes are
/// not two different ones.
pub fn read_mesh(bytes: &[u8], options: &MeshOptions) -> Result<Mesh, MeshError> {
    let Some(head_from_file) = options.axes.head_from_file() else {
        return Err(bad("the head's axes", "one axis both up and forward", "two different ones"));
    };
    let load = tobj::LoadOptions { triangulate: true, ..tobj::LoadOptions::default() };
    let mut lines = Lines { rest: bytes, n: 0 };
    // Materials change nothing for a body: a file that names some is read without them.
    let read = tobj::load_obj_buf(&mut lines, &load, |_| Err(tobj::LoadError::OpenFileFailed));
    let (models, _) = read.map_err(|source| MeshError::Obj { line: lines.n, source })?;
    let mut mesh = Mesh { points_m: Vec::new(), triangles: Vec::new() };
    for model in models {
        if let Some(found) = model.mesh.positions.iter().find(|c| !c.is_finite()) {
            return Err(bad("positions", found, "finite numbers"));
        }
        let first = mesh.points_m.len() as u32;
        let points = model.mesh.positions.as_chunks().0.iter();
        let to_head = |p: &[f64; 3]| head_from_file * Vec3::from(*p) * options.unit.meters();
        mesh.points_m.extend(points.map(to_head));
        let corners = model.mesh.indices.as_chunks().0.iter();
        mesh.triangles.extend(corners.map(|c: &[u32; 3]| c.map(|corner| first + corner)));
    }
    check(&mesh)?;
    Ok(mesh)
}

fn check(mesh: &Mesh) -> Result<(), MeshError> {
    if mesh.triangles.is_empty() {
        return Err(bad("faces", "none", "at least one"));
    }
    // Six times the volume about the middle, so that what an open mesh lacks counts little.
    let middle = mesh.points_m.iter().sum::<Vec3>() / mesh.points_m.len() as f64;
    let volume6 = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| mesh.points_m[corner as usize] - middle);
        a.dot(&b.cross(&c))
    };
    if mesh.triangles.iter().map(volume6).sum::<f64>() <= 0.0 {
        let expected = "counter-clockwise seen from outside, round a volume";
        return Err(bad("faces", "corners that run clockwise seen from outside, or a flat sheet", expected));
    }
    Ok(())
}

/// Bytes that are read line by line, and how many lines were.
struct Lines<'a> {
    rest: &'a [u8],
    n: usize,
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let n = self.rest.len().min(buffer.len());
        buffer[..n].copy_from_slice(&self.rest[..n]);
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, n: usize) {
        self.n += self.rest[..n].iter().filter(|byte| **byte == b'\n').count();
        self.rest = &self.rest[n..];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::UpAxis;

    /// A pyramid on a square, in centimeters with y up: quads, a group, a comment, a material nobody has.
    const PYRAMID: &str = "# a hat\nmtllib none.mtl\nv -10 0 -10\nv -10 0 10\nv 10 0 10\nv 10 0 -10\nv 0 15 0\n\
        g base\nusemtl felt\nf 4 3 2 1\ng sides\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

    fn options() -> MeshOptions {
        MeshOptions { unit: LengthUnit::Centimeter, axes: HeadAxes::usual(UpAxis::Y) }
    }

    #[test]
    fn faces_become_triangles_of_head_space() {
        let mesh = read_mesh(PYRAMID.as_bytes(), &options()).unwrap();
        assert_eq!(mesh.triangles.len(), 6);
        let highest = mesh.points_m.iter().map(|p| p.z).fold(f64::MIN, f64::max);
        assert!((highest - 0.15).abs() < 1e-12, "{highest}");
    }

    #[test]
    fn what_is_no_body_is_refused_with_a_reason() {
        let says = |text: &str| {
            let error = read_mesh(text.as_bytes(), &options()).unwrap_err();
            let source = std::error::Error::source(&error).map(ToString::to_string).unwrap_or_default();
            format!("{error}: {source}")
        };
        let inside_out =
            PYRAMID.replace("4 3 2 1", "1 2 3 4").replace("f 1 2 5", "f 2 1 5").replace("f 2 3 5", "f 3 2 5");
        let inside_out = inside_out.replace("f 3 4 5", "f 4 3 5").replace("f 4 1 5", "f 1 4 5");
        for (text, part) in [
            (String::new(), "faces: found none"),
            (PYRAMID.replace("15", "fifteen"), "line 7"),
            (PYRAMID.replace("15", "inf"), "positions: found inf"),
            (PYRAMID.replace("f 1 2 5", "f 1 2 9"), "OBJ"),
            (inside_out, "clockwise"),
        ] {
            assert!(says(&text).contains(part), "{part}: {}", says(&text));
        }
    }
}

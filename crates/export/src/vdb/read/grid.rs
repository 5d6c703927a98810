//! The grids of a file: what they are called, where they are, what is in them.

use super::bytes::Bytes;
use super::tree::Tree;
use super::values::{self, Kind};
use crate::vdb::VdbError;
use std::collections::BTreeMap;
use tousle_core::Vec3;

const MAGIC: i64 = 0x5644_4220;
const FILE_VERSIONS: std::ops::RangeInclusive<u32> = 222..=224;

/// A file taken apart, but for what is in its grids.
#[derive(Debug)]
pub(super) struct File<'a> {
    pub metadata: BTreeMap<String, Value>,
    pub grids: Vec<Entry<'a>>,
}

/// A grid that was found and not yet read.
#[derive(Debug)]
pub(super) struct Entry<'a> {
    pub name: String,
    pub tree_type: String,
    shares_tree_of: String,
    body: Bytes<'a>,
}

/// A grid that was read.
#[derive(Debug)]
pub(super) struct Grid {
    pub name: String,
    pub kind: Kind,
    pub metadata: BTreeMap<String, Value>,
    pub transform: Transform,
    pub tree: Tree,
}

/// A named value, of the types that are of use here.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Text(String),
    Vector([f64; 3]),
}

/// From index to the file's own space: evenly, without a turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Transform {
    pub edge: f64,
    /// Where index (0, 0, 0) is.
    pub translation: Vec3,
}

impl<'a> File<'a> {
    /// Finds all grids of a file.
    pub fn open(all: &'a [u8]) -> Result<Self, VdbError> {
        let mut bytes = Bytes::new(all);
        let not_vdb = || VdbError::NotVdb { found: all[..all.len().min(8)].to_vec() };
        if bytes.i64().map_err(|_| not_vdb())? != MAGIC {
            return Err(not_vdb());
        }
        let version = bytes.u32()?;
        if !FILE_VERSIONS.contains(&version) {
            return Err(VdbError::Version { found: version });
        }
        bytes.take(2 * 4)?; // the library's version
        let has_offsets = bytes.u8()? != 0;
        bytes.take(36)?; // a UUID in text
        let metadata = metadata(&mut bytes)?;
        let n_grids = bytes.u32()?;
        if !has_offsets && n_grids > 1 {
            return Err(bytes.bad("grids without offsets", "a file that says where its grids are"));
        }
        let mut grids = Vec::new();
        for _ in 0..n_grids {
            let name = bytes.text()?;
            // Grids of one name are told apart by what follows a separator.
            let name = name.split('\u{1e}').next().unwrap_or_default().to_owned();
            let (tree_type, shares_tree_of) = (bytes.text()?, bytes.text()?);
            let at = bytes;
            let [start, _values, end] = [bytes.i64()?, bytes.i64()?, bytes.i64()?];
            let mut body = bytes;
            if has_offsets {
                let place = |offset: i64| {
                    usize::try_from(offset).ok().filter(|o| *o <= all.len()).ok_or_else(|| {
                        at.bad(
                            format!("an offset of {offset}"),
                            format!("one within the file's {} bytes", all.len()),
                        )
                    })
                };
                body.at = place(start)?;
                bytes.at = place(end)?;
            }
            grids.push(Entry { name, tree_type, shares_tree_of, body });
        }
        Ok(Self { metadata, grids })
    }
}

impl Entry<'_> {
    /// Reads the grid.
    pub fn read(&self) -> Result<Grid, VdbError> {
        let bad = |found: String, expected: &str| VdbError::BadGrid {
            grid: self.name.clone(),
            found,
            expected: expected.to_owned(),
        };
        let kind = Kind::from_tree(&self.tree_type).ok_or_else(|| {
            bad(format!("type {}", self.tree_type), "vec3s, vec3d, float or double, in a tree of 5, 4, 3")
        })?;
        if !self.shares_tree_of.is_empty() {
            return Err(bad(format!("the tree of grid {:?}", self.shares_tree_of), "a tree of its own"));
        }
        let mut bytes = self.body;
        let compression = bytes.u32()?;
        if !values::is_known(compression) {
            return Err(
                bytes.bad(format!("the compression flags {compression:#x}"), "zip, Blosc, active mask")
            );
        }
        let metadata = metadata(&mut bytes)?;
        let transform = transform(&mut bytes, &self.name)?;
        let tree = Tree::read(&mut bytes, kind, compression)?;
        Ok(Grid { name: self.name.clone(), kind, metadata, transform, tree })
    }
}

fn metadata(bytes: &mut Bytes<'_>) -> Result<BTreeMap<String, Value>, VdbError> {
    let mut all = BTreeMap::new();
    for _ in 0..bytes.u32()? {
        let (name, kind) = (bytes.text()?, bytes.text()?);
        let n = bytes.u32()? as usize;
        let content = bytes.take(n)?;
        let mut value = Bytes::new(content);
        let value = match kind.as_str() {
            "string" => Some(Value::Text(String::from_utf8_lossy(content).into_owned())),
            "double" => value.f64().ok().map(Value::Number),
            "float" => value.u32().ok().map(|bits| Value::Number(f64::from(f32::from_bits(bits)))),
            "int32" => value.i32().ok().map(|n| Value::Number(f64::from(n))),
            "int64" => value.i64().ok().map(|n| Value::Number(n as f64)),
            "vec3d" => match [value.f64(), value.f64(), value.f64()] {
                [Ok(x), Ok(y), Ok(z)] => Some(Value::Vector([x, y, z])),
                _ => None,
            },
            _ => None,
        };
        all.extend(value.map(|value| (name, value)));
    }
    Ok(all)
}

fn transform(bytes: &mut Bytes<'_>, grid: &str) -> Result<Transform, VdbError> {
    let map = bytes.text()?;
    let mut vector = || -> Result<Vec3, VdbError> { Ok(Vec3::new(bytes.f64()?, bytes.f64()?, bytes.f64()?)) };
    let bad = |found: String| VdbError::BadGrid {
        grid: grid.to_owned(),
        found,
        expected: "voxels that are cubes, neither turned nor sheared".to_owned(),
    };
    let (scale, translation) = match map.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            let scale = vector()?;
            for _ in 0..4 {
                vector()?; // the same in other words
            }
            (scale, Vec3::zeros())
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let (translation, scale) = (vector()?, vector()?);
            for _ in 0..4 {
                vector()?;
            }
            (scale, translation)
        }
        "TranslationMap" => (Vec3::repeat(1.0), vector()?),
        "AffineMap" | "UnitaryMap" => {
            // Rows of a matrix that is multiplied by a row vector from the left.
            let mut m = [0.0; 16];
            for number in &mut m {
                *number = bytes.f64()?;
            }
            let is_plain = (0..3).all(|row| (0..3).all(|column| row == column || m[4 * row + column] == 0.0));
            if !is_plain {
                return Err(bad(format!("the matrix {m:?}")));
            }
            (Vec3::new(m[0], m[5], m[10]), Vec3::new(m[12], m[13], m[14]))
        }
        other => return Err(bad(format!("a {other}"))),
    };
    let edge = scale.x;
    let is_cube = (scale.y - edge).abs().max((scale.z - edge).abs()) <= 1e-6 * edge;
    if !(edge.is_finite() && edge > 0.0 && is_cube && translation.iter().all(|x| x.is_finite())) {
        return Err(bad(format!("voxels of {:?} at {:?}", scale.as_slice(), translation.as_slice())));
    }
    Ok(Transform { edge, translation })
}

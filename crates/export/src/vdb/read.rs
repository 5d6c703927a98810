//! Wind from OpenVDB files: ours, and other programs'.
//!
//! An own reader: the one crate there is gives empty grids for vectors. It reads the trees of 5, 4 and 3 that all
//! programs write, whatever packs them: zlib, Blosc (LZ4), active masks, half precision.

mod blosc;
mod bytes;
mod grid;
mod lz4;
mod tree;
mod values;

use super::VdbError;
use crate::ReadField;
use grid::{File, Grid, Transform, Value};
use std::collections::BTreeMap;
use tousle_core::{Assumption, Quantity, Vec3};
use tousle_field::{Field, FieldSequence, GridError, GridSpec, MAX_VOXELS, VoxelFlag};

/// What a `.vdb` may leave out, and what stands for it.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct VdbOptions {
    /// The grid that is the wind; if `None` the one called `wind`, `velocity`, `vel` or `v`, or the only vectors.
    pub wind: Option<String>,
    /// Where the grid does not say what its vectors are.
    pub quantity: Option<Quantity>,
    /// Steps a second, where the files do not say when they are.
    pub rate_hz: Option<f64>,
}

/// The names that other programs give to the velocity of the air.
const WIND_NAMES: [&str; 5] = ["wind", "velocity", "vel", "v", "Velocity"];

/// One time step, as its file has it.
#[derive(Clone, Debug, PartialEq)]
pub struct VdbStep {
    transform: Transform,
    /// The lowest index of the box of active voxels, and the box's size.
    low: [i32; 3],
    dims: [usize; 3],
    /// Vectors, value after value, in the order of a planar array.
    wind: Vec<f32>,
    background: Vec<f32>,
    flags: Vec<VoxelFlag>,
    sd: Option<Vec<f32>>,
    has_flags: bool,
    outside: Option<Vec3>,
    origin_m: Option<Vec3>,
    quantity: Option<Quantity>,
    time_secs: Option<f64>,
    rate_hz: Option<f64>,
}

impl VdbStep {
    /// When it is, s, if the file says so.
    pub fn time_secs(&self) -> Option<f64> {
        self.time_secs
    }
}

/// Reads one time step.
///
/// The box is that of the active voxels and tiles of the wind. What is not active in it keeps its value and is
/// flagged as from outside; what is active is flagged as the file's grid `flag` says, or as interpolated.
///
/// # Errors
/// [`VdbError`] with the byte or the grid: bytes that are no OpenVDB file, a cut or damaged one, codecs and trees that
/// are not read, no vectors, a grid that is turned, no active voxel, too many of them.
pub fn read_step_vdb(bytes: &[u8], options: &VdbOptions) -> Result<VdbStep, VdbError> {
    let file = File::open(bytes)?;
    let wind = find_wind(&file, options)?;
    let (low, dims) = bounds(&wind)?;
    let boxed = |grid: &Grid| dense(grid, low, dims);
    let (values, active) = boxed(&wind);
    let scalar = |name: &str| -> Result<Option<Vec<f32>>, VdbError> {
        let Some(entry) = file.grids.iter().find(|g| g.name == name && wind.name != name) else {
            return Ok(None);
        };
        let grid = entry.read()?;
        let is_same = grid.kind.n == 1 && grid.transform == wind.transform;
        Ok(is_same.then(|| boxed(&grid).0))
    };
    let flags = scalar("flag")?;
    let has_flags = flags.is_some();
    let flags = match flags {
        Some(values) => values.into_iter().map(flag).collect::<Result<_, _>>()?,
        None => active
            .iter()
            .map(|is_active| if *is_active { VoxelFlag::Interpolated } else { VoxelFlag::Outside })
            .collect(),
    };
    let vector = |name: &str| match file.metadata.get(name) {
        Some(Value::Vector(v)) => Some(Vec3::from(*v)),
        _ => None,
    };
    let number = |name: &str| match file.metadata.get(name) {
        Some(Value::Number(x)) => Some(*x),
        _ => None,
    };
    Ok(VdbStep {
        transform: wind.transform,
        low,
        dims,
        wind: values,
        background: wind.tree.background.clone(),
        flags,
        sd: scalar("sd")?,
        has_flags,
        outside: vector("outside"),
        origin_m: vector("origin_m"),
        quantity: quantity(&wind.metadata)?,
        time_secs: number("time_secs"),
        rate_hz: number("rate_hz"),
    })
}

fn flag(value: f32) -> Result<VoxelFlag, VdbError> {
    let byte = (value.fract() == 0.0 && (0.0..=255.0).contains(&value)).then_some(value as u8);
    byte.and_then(VoxelFlag::from_byte).ok_or_else(|| VdbError::BadGrid {
        grid: "flag".to_owned(),
        found: value.to_string(),
        expected: "0 (outside), 1 (interpolated) or 2 (measured)".to_owned(),
    })
}

fn quantity(metadata: &BTreeMap<String, Value>) -> Result<Option<Quantity>, VdbError> {
    let Some(Value::Text(name)) = metadata.get("quantity") else { return Ok(None) };
    Quantity::from_name(name).map(Some).ok_or_else(|| VdbError::BadGrid {
        grid: "wind".to_owned(),
        found: format!("quantity {name:?}"),
        expected: "\"air_velocity\" or \"force_per_mass\"".to_owned(),
    })
}

/// The grid that is the wind.
fn find_wind(file: &File<'_>, options: &VdbOptions) -> Result<Grid, VdbError> {
    let is_vectors = |name: &str| name.starts_with("Tree_vec3");
    let vectors = || file.grids.iter().filter(|g| is_vectors(&g.tree_type));
    let found = match &options.wind {
        Some(name) => vectors().find(|g| g.name == *name),
        None => {
            let named = WIND_NAMES.iter().find_map(|name| vectors().find(|g| g.name == *name));
            named.or_else(|| vectors().next().filter(|_| vectors().count() == 1))
        }
    };
    let expected = || match &options.wind {
        Some(name) => format!("one of vectors called {name:?}"),
        None => format!("one of vectors, called one of {WIND_NAMES:?} if there are several"),
    };
    let names = || file.grids.iter().map(|g| format!("{} ({})", g.name, g.tree_type)).collect();
    found.ok_or_else(|| VdbError::NoWind { found: names(), expected: expected() })?.read()
}

/// The box of active voxels: lowest index and size.
fn bounds(grid: &Grid) -> Result<([i32; 3], [usize; 3]), VdbError> {
    let (mut low, mut high) = ([i64::MAX; 3], [i64::MIN; 3]);
    let mut take = |at: [i64; 3], edge: i64| {
        for axis in 0..3 {
            low[axis] = low[axis].min(at[axis]);
            high[axis] = high[axis].max(at[axis] + edge);
        }
    };
    for tile in &grid.tree.tiles {
        take(tile.origin.map(i64::from), i64::from(tile.edge));
    }
    for leaf in &grid.tree.leaves {
        for bit in (0..512).filter(|bit| values::is_on(&leaf.active, *bit)) {
            take(within(leaf.origin, bit), 1);
        }
    }
    if low[0] > high[0] {
        return Err(VdbError::BadGrid {
            grid: grid.name.clone(),
            found: "no active voxel".to_owned(),
            expected: "some".to_owned(),
        });
    }
    let dims = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let n: f64 = dims.iter().map(|d| *d as f64).product();
    if n > MAX_VOXELS as f64 {
        return Err(GridError::TooMany { found: n }.into());
    }
    Ok((low.map(|i| i as i32), dims.map(|d| d as usize)))
}

/// Where a voxel of a leaf is.
fn within(origin: [i32; 3], bit: usize) -> [i64; 3] {
    let place = [bit / 64, bit / 8 % 8, bit % 8];
    [0, 1, 2].map(|axis| i64::from(origin[axis]) + place[axis] as i64)
}

/// The values of a box, value after value, and which are active.
fn dense(grid: &Grid, low: [i32; 3], dims: [usize; 3]) -> (Vec<f32>, Vec<bool>) {
    let n = grid.kind.n;
    let n_voxels: usize = dims.iter().product();
    let mut values = grid.tree.background.repeat(n_voxels);
    let mut active = vec![false; n_voxels];
    let flat = |at: [i64; 3]| {
        let mut flat = 0;
        for axis in 0..3 {
            let place = usize::try_from(at[axis] - i64::from(low[axis])).ok().filter(|p| *p < dims[axis])?;
            flat = flat * dims[axis] + place;
        }
        Some(flat)
    };
    for tile in &grid.tree.tiles {
        // The part of the tile that is in the box.
        let range = |axis: usize| {
            let (from, to) =
                (i64::from(tile.origin[axis]), i64::from(tile.origin[axis]) + i64::from(tile.edge));
            let start = i64::from(low[axis]);
            from.max(start)..to.min(start + dims[axis] as i64)
        };
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    if let Some(k) = flat([x, y, z]) {
                        values[n * k..n * (k + 1)].copy_from_slice(&tile.value);
                        active[k] = true;
                    }
                }
            }
        }
    }
    for leaf in &grid.tree.leaves {
        for bit in 0..512 {
            if let Some(k) = flat(within(leaf.origin, bit)) {
                values[n * k..n * (k + 1)].copy_from_slice(&leaf.values[n * bit..n * (bit + 1)]);
                active[k] = values::is_on(&leaf.active, bit);
            }
        }
    }
    (values, active)
}

/// Joins time steps, in order, to a field.
///
/// Steps may have different boxes: the field's holds all. Times are those the files give, which must be even to 2 %
/// of a step, or those of `options`.
///
/// # Errors
/// [`VdbError::BadStep`] for steps that do not belong together, [`VdbError::BadGrid`] for values that are not finite.
pub fn join_steps_vdb(steps: &[VdbStep], options: &VdbOptions) -> Result<ReadField, VdbError> {
    let mut assumed = Vec::new();
    let mut assume = |what: &str, value: String, why: &str| {
        assumed.push(Assumption { what: what.to_owned(), value, why: why.to_owned() });
    };
    let bad = |step: usize, found: String, expected: String| VdbError::BadStep { step, found, expected };
    let Some(first) = steps.first() else {
        return Err(bad(0, "no file".to_owned(), "one or more".to_owned()));
    };
    for (k, step) in steps.iter().enumerate() {
        if step.transform != first.transform {
            return Err(bad(
                k,
                format!("{:?}", step.transform),
                format!("{:?} as in step 0", first.transform),
            ));
        }
        if step.quantity != first.quantity {
            return Err(bad(k, format!("{:?}", step.quantity), format!("{:?} as in step 0", first.quantity)));
        }
    }
    let low = [0, 1, 2].map(|a| steps.iter().map(|s| s.low[a]).min().unwrap_or(0));
    let high = |a: usize| steps.iter().map(|s| i64::from(s.low[a]) + s.dims[a] as i64).max().unwrap_or(0);
    let dims = [0, 1, 2].map(|a| (high(a) - i64::from(low[a])) as usize);
    if dims.iter().map(|d| *d as f64).product::<f64>() > MAX_VOXELS as f64 {
        return Err(GridError::TooMany { found: dims.iter().map(|d| *d as f64).product() }.into());
    }
    let edge_m = first.transform.edge;
    let corner = first.transform.translation + (Vec3::from(low.map(f64::from)) - Vec3::repeat(0.5)) * edge_m;
    // Our own files say it in full: adding half an edge and taking it away again can turn the last digit.
    let same = |said: &Vec3| (said - corner).amax() <= 1e-9 * edge_m;
    let grid = GridSpec { origin_m: first.origin_m.filter(same).unwrap_or(corner), edge_m, dims };
    let quantity = first.quantity.or(options.quantity).unwrap_or(Quantity::AirVelocity);
    if first.quantity.is_none() {
        assume("quantity", quantity.name().to_owned(), "the file's grid does not say what its vectors are");
    }
    let (start_secs, rate_hz) = times(steps, options, &mut assume)?;
    if steps.iter().any(|s| !s.has_flags) {
        let why = "the file has no grid `flag`; no marker of a capture measured these voxels";
        assume("flag", "interpolated where active, outside elsewhere".to_owned(), why);
    }
    if steps.iter().any(|s| s.outside.is_none()) {
        assume(
            "outside",
            "the mean of the outermost voxels, step by step".to_owned(),
            "the file does not say it",
        );
    }
    let fields = steps.iter().map(|step| field(step, low, &grid)).collect();
    let field = FieldSequence { grid, quantity, start_secs, rate_hz, steps: fields, layers: Vec::new() };
    if let Err(error) = field.check() {
        return Err(VdbError::BadGrid {
            grid: "wind".to_owned(),
            found: error.to_string(),
            expected: "finite numbers".to_owned(),
        });
    }
    Ok(ReadField { field, assumed })
}

fn times(
    steps: &[VdbStep],
    options: &VdbOptions,
    assume: &mut impl FnMut(&str, String, &str),
) -> Result<(f64, f64), VdbError> {
    let said: Option<Vec<f64>> = steps.iter().map(|s| s.time_secs).collect();
    let Some(times) = said else {
        let rate_hz = match (options.rate_hz, steps.len()) {
            (Some(rate_hz), _) => rate_hz,
            (None, 1) => 1.0,
            (None, _) => {
                let found = "no time in the file and no rate from the caller".to_owned();
                let expected = "metadata `time_secs`, or a rate".to_owned();
                return Err(VdbError::BadStep { step: 0, found, expected });
            }
        };
        assume("start_secs", "0 s".to_owned(), "the files do not say when they are");
        return Ok((0.0, rate_hz));
    };
    let (n, first) = (times.len(), times[0]);
    let step = (times[n - 1] - first) / (n - 1).max(1) as f64;
    for (k, found) in times.iter().enumerate().skip(1) {
        let expected = first + step * k as f64;
        if !(step > 0.0 && (found - expected).abs() <= 0.02 * step) {
            let (found, expected) = (format!("time {found} s"), format!("{expected} s as of even steps"));
            return Err(VdbError::BadStep { step: k, found, expected });
        }
    }
    // A rate that is said, and that explains the times, has more digits than their differences.
    let said = steps[0].rate_hz.filter(|r| *r > 0.0 && (n == 1 || (r * step - 1.0).abs() < 1e-6));
    Ok((first, said.unwrap_or(if n == 1 { 1.0 } else { 1.0 / step })))
}

/// A step on the field's grid.
fn field(step: &VdbStep, low: [i32; 3], grid: &GridSpec) -> Field {
    let n = grid.n_voxels();
    let [_, ny, nz] = step.dims;
    let shift = [0, 1, 2].map(|a| (i64::from(step.low[a]) - i64::from(low[a])) as usize);
    let mut field = Field::still(grid);
    for (axis, plane) in field.u.chunks_exact_mut(n).enumerate() {
        plane.fill(step.background[axis]);
    }
    let mut sd = step.sd.as_ref().map(|_| vec![f32::INFINITY; n]);
    for k in 0..step.flags.len() {
        let place = [k / (ny * nz) + shift[0], k / nz % ny + shift[1], k % nz + shift[2]];
        let flat = (place[0] * grid.dims[1] + place[1]) * grid.dims[2] + place[2];
        for axis in 0..3 {
            field.u[axis * n + flat] = step.wind[3 * k + axis];
        }
        field.flags[flat] = step.flags[k];
        if let (Some(sd), Some(theirs)) = (&mut sd, &step.sd) {
            sd[flat] = theirs[k];
        }
    }
    field.sd = sd;
    field.outside = step.outside.unwrap_or_else(|| crate::npz::mean_of_faces(&field.u, grid.dims));
    field
}

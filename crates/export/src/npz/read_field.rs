use std::io::Read;

use tousle_core::{Assumption, Quantity, Vec3};
use tousle_field::{Field, FieldSequence, GridError, GridSpec, MAX_VOXELS, VoxelFlag};

use super::error::NpzError;
use super::header::Header;
use super::reader::{ArrayReader, FINITE, NpzReader, bad_shape, finite_f32, is_rounded};

/// What a field `.npz` may leave out, and what stands for it. By default nothing: what is missing is an error.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FieldNpzOptions {
    /// Where `origin` and `edge` are missing: the grid is a cube of this extent, m, centered on the head.
    pub extent_m: Option<f64>,
    /// Where `quantity` is missing.
    pub quantity: Option<Quantity>,
    /// The most bytes one array may have, 4 GiB by default.
    pub max_bytes: u64,
}

impl Default for FieldNpzOptions {
    fn default() -> Self {
        Self { extent_m: None, quantity: None, max_bytes: 1 << 32 }
    }
}

/// A field and what was put in for what its file left out.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadField {
    /// The field, without layers.
    pub field: FieldSequence,
    /// Everything that the file did not say.
    pub assumed: Vec<Assumption>,
}

/// Reads a field from the arrays that [`crate::write_field_npz`] lists; `flag`, `outside` and `sd` may be missing.
///
/// # Errors
/// As [`read_field_npz_with`].
pub fn read_field_npz(bytes: &[u8]) -> Result<FieldSequence, NpzError> {
    read_field_npz_with(bytes, &FieldNpzOptions::default()).map(|read| read.field)
}

/// Reads a field, with something to stand for what the file leaves out.
///
/// Numbers may be of any type (f2, f4, f8, integers), of either byte order, in C or Fortran order. Instead of
/// `u` there may be `u_q` with one `scale`: vectors are `u_q * scale`. Steps must be even to 2 % of one; the
/// rate is their mean, or the whole number next to it if that gives every time to the last digit stored.
///
/// # Errors
/// [`NpzError`] with the array and the place of what is wrong: for missing arrays, shapes that do not fit one
/// another, NaN, what is infinite and no standard deviation, uneven steps, more voxels a step than [`MAX_VOXELS`], and bytes that are no `.npz`.
pub fn read_field_npz_with(bytes: &[u8], options: &FieldNpzOptions) -> Result<ReadField, NpzError> {
    let mut npz = NpzReader::open(bytes, options.max_bytes)?;
    let mut assumed = Vec::new();
    let (start_secs, rate_hz, n_steps) = read_times(&mut npz, &mut assumed)?;
    let quantity = read_quantity(&mut npz, options, &mut assumed)?;
    let (key, scale) = find_vectors(&mut npz)?;
    let mut array = npz.array(key)?;
    let dims = grid_dims(&array, n_steps)?;
    let vectors = read_steps(&mut array, n_steps, FINITE, |x| finite_f32(x * scale))?;
    drop(array);
    let grid = read_grid(&mut npz, dims, options, &mut assumed)?;
    let flags = read_flags(&mut npz, n_steps, dims, &mut assumed)?;
    let sd = read_sd(&mut npz, n_steps, dims)?;
    let outside = read_outside(&mut npz, &vectors, dims, &mut assumed)?;
    let steps = vectors
        .into_iter()
        .zip(flags)
        .zip(sd)
        .zip(outside)
        .map(|(((u, flags), sd), outside)| Field { u, flags, sd, outside })
        .collect();
    let field = FieldSequence { grid, quantity, start_secs, rate_hz, steps, layers: Vec::new() };
    Ok(ReadField { field, assumed })
}

fn assume(assumed: &mut Vec<Assumption>, what: &str, value: impl Into<String>, why: &str) {
    assumed.push(Assumption { what: what.to_owned(), value: value.into(), why: why.to_owned() });
}

/// Start, rate and number of steps.
fn read_times(npz: &mut NpzReader<'_>, assumed: &mut Vec<Assumption>) -> Result<(f64, f64, usize), NpzError> {
    let (header, times) = npz.numbers("t")?;
    let (&[n_steps], &[first, ..]) = (header.shape.as_slice(), times.as_slice()) else {
        return Err(bad_shape("t", &header.shape, "(T,) with at least one step"));
    };
    if n_steps == 1 {
        assume(assumed, "rate_hz", "1 Hz", "a single step has no rate and stands for all times");
        return Ok((first, 1.0, 1));
    }
    if let Some(index) = (1..n_steps).find(|k| times[*k] <= times[k - 1]) {
        return Err(NpzError::FallingTime { index, found: times[index], before: times[index - 1] });
    }
    let step = (times[n_steps - 1] - first) / (n_steps - 1) as f64;
    for (index, found) in times.iter().copied().enumerate() {
        let expected = first + step * index as f64;
        if !(step > 0.0 && (found - expected).abs() <= 0.02 * step) {
            return Err(NpzError::UnevenTime { index, found, expected });
        }
    }
    Ok((first, nice_rate(&header, &times, 1.0 / step), n_steps))
}

/// The whole number next to a rate, if it explains every time to the rounding of the type it is stored in.
fn nice_rate(header: &Header, times: &[f64], rate_hz: f64) -> f64 {
    let whole = rate_hz.round();
    let explains = |(k, t): (usize, &f64)| is_rounded(header.dtype, *t, times[0] + k as f64 / whole);
    if whole >= 1.0 && times.iter().enumerate().all(explains) { whole } else { rate_hz }
}

fn read_quantity(
    npz: &mut NpzReader<'_>,
    options: &FieldNpzOptions,
    assumed: &mut Vec<Assumption>,
) -> Result<Quantity, NpzError> {
    if let (false, Some(quantity)) = (npz.has("quantity"), options.quantity) {
        assume(assumed, "quantity", quantity.name(), "the file has no `quantity`; the caller named it");
        return Ok(quantity);
    }
    let name = npz.text("quantity")?;
    Quantity::from_name(&name).ok_or(NpzError::BadQuantity { found: name })
}

/// The array that holds the vectors, and what its values are times.
fn find_vectors(npz: &mut NpzReader<'_>) -> Result<(&'static str, f64), NpzError> {
    if !npz.has("u") && npz.has("u_q") {
        return Ok(("u_q", npz.number("scale")?));
    }
    Ok(("u", 1.0))
}

fn grid_dims<R>(array: &ArrayReader<R>, n_steps: usize) -> Result<[usize; 3], NpzError> {
    let shape = array.header.shape.as_slice();
    let &[steps, 3, x, y, z] = shape else {
        return Err(bad_shape(array.key, shape, format!("({n_steps}, 3, X, Y, Z)")));
    };
    if steps != n_steps || x.min(y).min(z) == 0 {
        return Err(bad_shape(array.key, shape, format!("({n_steps}, 3, X, Y, Z), none of them 0")));
    }
    match x.checked_mul(y).and_then(|n| n.checked_mul(z)) {
        Some(n) if n <= MAX_VOXELS => Ok([x, y, z]),
        _ => Err(GridError::TooMany { found: x as f64 * y as f64 * z as f64 }.into()),
    }
}

/// One vector of values for each step, an array in C order a step at a time.
fn read_steps<R: Read>(
    array: &mut ArrayReader<R>,
    n_steps: usize,
    expected: &str,
    convert: impl Fn(f64) -> Option<f32>,
) -> Result<Vec<Vec<f32>>, NpzError> {
    let n_values: usize = array.header.shape[1..].iter().product();
    if array.header.fortran_order {
        let all = array.all(expected, convert)?;
        return Ok(all.chunks_exact(n_values).map(<[f32]>::to_vec).collect());
    }
    (0..n_steps)
        .map(|_| {
            let mut values = Vec::new();
            array.next(n_values, &mut values, expected, &convert)?;
            Ok(values)
        })
        .collect()
}

fn read_grid(
    npz: &mut NpzReader<'_>,
    dims: [usize; 3],
    options: &FieldNpzOptions,
    assumed: &mut Vec<Assumption>,
) -> Result<GridSpec, NpzError> {
    if let (false, false, Some(extent_m)) = (npz.has("origin"), npz.has("edge"), options.extent_m) {
        let grid = GridSpec::cube(extent_m, extent_m / dims[0] as f64)?;
        if grid.dims != dims {
            return Err(bad_shape("u", &dims, "as many voxels along x, y and z, as a cube has"));
        }
        let why = "the file has neither `origin` nor `edge`; the caller gave the extent";
        assume(assumed, "origin, edge", format!("a cube of {extent_m} m about the head"), why);
        return Ok(grid);
    }
    let (header, origin) = npz.numbers("origin")?;
    let &[x, y, z] = origin.as_slice() else { return Err(bad_shape("origin", &header.shape, "(3,)")) };
    let edge_m = npz.number("edge")?;
    if edge_m <= 0.0 {
        return Err(GridError::NotPositive { what: "voxel edge", found: edge_m * 1e3 }.into());
    }
    Ok(GridSpec { origin_m: Vec3::new(x, y, z), edge_m, dims })
}

fn read_flags(
    npz: &mut NpzReader<'_>,
    n_steps: usize,
    dims: [usize; 3],
    assumed: &mut Vec<Assumption>,
) -> Result<Vec<Vec<VoxelFlag>>, NpzError> {
    if !npz.has("flag") {
        let why = "the file has no `flag`; no marker of a capture measured these voxels";
        assume(assumed, "flag", "interpolated, everywhere", why);
        let n_voxels = dims.iter().product();
        return Ok(vec![vec![VoxelFlag::Interpolated; n_voxels]; n_steps]);
    }
    let steps = read_scalars(npz, "flag", n_steps, dims, FINITE, finite_f32)?;
    let flag = |step: usize, flat: usize, value: f32| {
        let byte = (value.fract() == 0.0 && (0.0..=255.0).contains(&value)).then_some(value as u8);
        byte.and_then(VoxelFlag::from_byte).ok_or_else(|| NpzError::BadValue {
            key: "flag".to_owned(),
            index: place(step, dims, flat),
            found: f64::from(value),
            expected: "0 (outside), 1 (interpolated) or 2 (measured)".to_owned(),
        })
    };
    let of_step = |(step, values): (usize, Vec<f32>)| {
        values.into_iter().enumerate().map(|(flat, value)| flag(step, flat, value)).collect()
    };
    steps.into_iter().enumerate().map(of_step).collect()
}

fn read_sd(
    npz: &mut NpzReader<'_>,
    n_steps: usize,
    dims: [usize; 3],
) -> Result<Vec<Option<Vec<f32>>>, NpzError> {
    if !npz.has("sd") {
        return Ok(vec![None; n_steps]);
    }
    let expected = "0 or a number above, infinite where nobody knows";
    let sd = |x: f64| Some(x as f32).filter(|sd| x >= 0.0 && sd.is_finite() == x.is_finite());
    let steps = read_scalars(npz, "sd", n_steps, dims, expected, sd)?;
    Ok(steps.into_iter().map(Some).collect())
}

/// One number for each voxel of each step.
fn read_scalars(
    npz: &mut NpzReader<'_>,
    key: &'static str,
    n_steps: usize,
    dims: [usize; 3],
    expected: &str,
    convert: impl Fn(f64) -> Option<f32>,
) -> Result<Vec<Vec<f32>>, NpzError> {
    let mut array = npz.array(key)?;
    let [x, y, z] = dims;
    if array.header.shape != [n_steps, x, y, z] {
        return Err(bad_shape(key, &array.header.shape, format!("({n_steps}, {x}, {y}, {z}) as of `u`")));
    }
    read_steps(&mut array, n_steps, expected, convert)
}

fn place(step: usize, dims: [usize; 3], flat: usize) -> Vec<usize> {
    let [_, y, z] = dims;
    vec![step, flat / (y * z), flat / z % y, flat % z]
}

/// The wind outside the grid: as the file has it, or the mean over the grid's outermost voxels.
fn read_outside(
    npz: &mut NpzReader<'_>,
    vectors: &[Vec<f32>],
    dims: [usize; 3],
    assumed: &mut Vec<Assumption>,
) -> Result<Vec<Vec3>, NpzError> {
    if !npz.has("outside") {
        let why = "the file has no `outside`";
        assume(assumed, "outside", "the mean of the outermost voxels, step by step", why);
        return Ok(vectors.iter().map(|u| mean_of_faces(u, dims)).collect());
    }
    let (header, values) = npz.numbers("outside")?;
    if header.shape != [vectors.len(), 3] {
        return Err(bad_shape("outside", &header.shape, format!("({}, 3)", vectors.len())));
    }
    Ok(values.chunks_exact(3).map(Vec3::from_column_slice).collect())
}

/// The mean vector of the outermost voxels.
pub(crate) fn mean_of_faces(u: &[f32], dims: [usize; 3]) -> Vec3 {
    let n_voxels: usize = dims.iter().product();
    let on_face = |flat: &usize| {
        let place = place(0, dims, *flat);
        (0..3).any(|axis| place[axis + 1] == 0 || place[axis + 1] + 1 == dims[axis])
    };
    let mut sum = Vec3::zeros();
    let mut n = 0.0;
    for flat in (0..n_voxels).filter(on_face) {
        sum += Vec3::from([0, 1, 2].map(|axis| f64::from(u[axis * n_voxels + flat])));
        n += 1.0;
    }
    sum / n
}

use super::error::NpzError;
use super::reader::{NpzReader, bad_shape};

/// The most bytes of one array: 1 GiB.
const MAX_BYTES: u64 = 1 << 30;

/// Reads one array of finite numbers of any type, first axis slowest.
///
/// `shape` gives the lengths that its axes must have, 0 standing for any.
///
/// # Errors
/// [`NpzError`] with the array and the place: it is not there, it is of another shape, it is no number.
pub fn read_numbers_npz(bytes: &[u8], key: &'static str, shape: &[usize]) -> Result<Vec<f64>, NpzError> {
    let (header, values) = NpzReader::open(bytes, MAX_BYTES)?.numbers(key)?;
    let fits = header.shape.len() == shape.len()
        && header.shape.iter().zip(shape).all(|(found, expected)| *expected == 0 || found == expected);
    if fits { Ok(values) } else { Err(bad_shape(key, &header.shape, format!("{shape:?}, 0 for any"))) }
}

//! Cells of text tables, as the text formats of motion capture share them.
//!
//! - [`plain`] takes a file's bytes to UTF-8 (or a one-byte encoding) without a byte order mark.
//! - [`text`] and [`shorten`] make a cell readable, whatever its bytes.
//! - [`Numbers`] reads the numbers of one file, decimal commas among them, and refuses what can be read in two
//!   ways; [`whole`] reads frame numbers and counts; [`Decimals`] tells a number that lost digits where a file was cut off.
//! - [`lost_digits`] and [`half_positions`] warn of what then counts as missing.

mod encoding;
mod number;
mod warning;

pub use encoding::{plain, shorten, text};
pub use number::{Decimals, Numbers, whole};
pub use warning::{half_positions, lost_digits};

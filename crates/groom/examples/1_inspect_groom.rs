//! What is in a groom file, as JSON: `cargo run -p tousle-groom --example 1_inspect_groom -- FILE [UNIT UP]`.

use std::io::Error;

use tousle_core::{Axis, LengthUnit};
use tousle_groom::{GroomOptions, inspect_groom};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let (file, unit, up) = match words.as_slice() {
        [file] => (file, None, None),
        [file, unit, up] => (file, LengthUnit::from_name(unit), Axis::from_name(up)),
        _ => return Err(Error::other("expected FILE, or FILE UNIT UP").into()),
    };
    let mut options = GroomOptions::default();
    options.unit = unit;
    options.up_axis = up;
    let summary = inspect_groom(&std::fs::read(file)?, &options)?;
    println!("{}", serde_json::to_string_pretty(&summary)?);
    Ok(())
}

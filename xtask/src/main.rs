//! Regenerates what is generated: `cargo run -p xtask -- demo-fixture CAPTURE_FOLDER`.

mod demo_fixture;

use anyhow::{Result, bail};

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["demo-fixture", capture] => demo_fixture::make(capture.as_ref()),
        _ => bail!("expected: demo-fixture CAPTURE_FOLDER"),
    }
}

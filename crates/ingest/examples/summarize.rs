//! Prints what is in capture files, one JSON object a line: `cargo run --example summarize -- FILE...`.

use std::error::Error;
use tousle_ingest::summarize;

fn main() -> Result<(), Box<dyn Error>> {
    for path in std::env::args_os().skip(1) {
        let bytes = std::fs::read(&path)?;
        match summarize(&bytes) {
            Ok(summary) => println!("{}", serde_json::to_string(&summary)?),
            Err(error) => {
                let cause = error.source().map(|cause| format!(": {cause}")).unwrap_or_default();
                eprintln!("{}: {error}{cause}", path.display());
            }
        }
    }
    Ok(())
}

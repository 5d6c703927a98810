//! What can be known to be wrong with an output before any work is done for it.

use anyhow::bail;
use std::path::{Path, PathBuf};

/// A path's ending, lower case, without the dot.
pub fn ending(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default()
}

/// Refuses an output whose ending is none of these, that is a file which is read or a folder, or that lies in a folder which is not
/// there. Every command that writes asks this first, so that nobody waits for work that cannot be kept.
pub fn check_output(output: &Path, endings: &[&str], inputs: &[&Path]) -> anyhow::Result<()> {
    check_ending(output, endings)?;
    check_apart(output, inputs)?;
    if output.is_dir() {
        wrong!("output {}: found a folder of that name, expected a file or nothing", output.display());
    }
    check_folder(output)
}

/// The same of several outputs, of which each is named once.
pub fn check_outputs(outputs: &[PathBuf], endings: &[&str], inputs: &[&Path]) -> anyhow::Result<()> {
    for (k, output) in outputs.iter().enumerate() {
        check_output(output, endings, inputs)?;
        if let Some(other) = outputs[..k].iter().find(|other| place(other) == place(output)) {
            let called = if other == output { String::new() } else { format!(" (as {})", other.display()) };
            wrong!("output {}: found it twice{called}, expected each once", output.display());
        }
    }
    Ok(())
}

/// Where a path leads, however it is spelled: also that of a file which is not there yet.
fn place(path: &Path) -> PathBuf {
    let of_folder = || {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        Some(folder.canonicalize().ok()?.join(path.file_name()?))
    };
    path.canonicalize().ok().or_else(of_folder).unwrap_or_else(|| path.to_owned())
}

fn check_ending(path: &Path, endings: &[&str]) -> anyhow::Result<()> {
    if endings.contains(&ending(path).as_str()) {
        return Ok(());
    }
    let list = endings.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(" or ");
    wrong!("output {}: found the ending {:?}, expected {list}", path.display(), ending(path))
}

fn check_apart(output: &Path, inputs: &[&Path]) -> anyhow::Result<()> {
    let file = |path: &Path| path.canonicalize().ok();
    if let Some(place) = file(output)
        && inputs.iter().any(|input| file(input).as_ref() == Some(&place))
    {
        wrong!("output {}: found a file that is read, expected another one", output.display());
    }
    Ok(())
}

fn check_folder(output: &Path) -> anyhow::Result<()> {
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => {
            bail!("output {}: found no folder {}, expected one", output.display(), folder.display())
        }
        _ => Ok(()),
    }
}

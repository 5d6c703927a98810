//! Several files that appear together or not at all.

use anyhow::{Context, anyhow};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::{NamedTempFile, TempPath};

/// Files that are written and do not have their names yet.
#[derive(Default)]
pub struct Outputs {
    staged: Vec<(PathBuf, NamedTempFile)>,
}

/// A file that has got its name, and what had it before.
struct Placed {
    path: PathBuf,
    before: Option<TempPath>,
}

impl Outputs {
    /// Writes a file beside where it will appear. All that can go wrong with a disk or a value does so here.
    pub fn add<E>(
        &mut self,
        path: &Path,
        write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
    ) -> anyhow::Result<()>
    where
        E: Into<Box<dyn std::error::Error + Send + Sync>>,
    {
        let staged = stage(path, write).map_err(|e| anyhow!(e)).with_context(|| cannot_write(path))?;
        self.staged.push((path.to_owned(), staged));
        Ok(())
    }

    /// Gives all files their names. If one cannot have its name, all are gone and what was there before is back.
    ///
    /// No system call names several files at once: only a program killed between two of them leaves some.
    pub fn appear(self) -> anyhow::Result<()> {
        let mut placed: Vec<Placed> = Vec::new();
        for (path, staged) in self.staged {
            match place(&path, staged) {
                Ok(file) => placed.push(file),
                Err(error) => {
                    placed.into_iter().rev().for_each(take_back);
                    return Err(error).with_context(|| cannot_write(&path));
                }
            }
        }
        Ok(())
    }
}

fn cannot_write(path: &Path) -> String {
    format!("cannot write {} (nothing was written)", path.display())
}

fn stage<E>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<NamedTempFile, Box<dyn std::error::Error + Send + Sync>>
where
    E: Into<Box<dyn std::error::Error + Send + Sync>>,
{
    let name = path.file_name().ok_or("the path names no file")?.to_string_lossy();
    let temporary = tempfile::Builder::new()
        .prefix(&format!(".{name}."))
        .suffix(".partial")
        // Temporary files are private to their owner by default; this becomes an ordinary one.
        .make_in(folder(path), |path| File::options().read(true).write(true).create_new(true).open(path))?;
    let mut out = BufWriter::with_capacity(1 << 18, temporary.as_file());
    write(&mut out).map_err(Into::into)?;
    out.flush()?;
    drop(out);
    temporary.as_file().sync_all()?;
    Ok(temporary)
}

/// The folder of a path; an empty parent is the current folder.
fn folder(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// Gives a file its name. What had the name gets another one, until all is done.
fn place(path: &Path, staged: NamedTempFile) -> io::Result<Placed> {
    let before = if path.is_file() {
        let aside = NamedTempFile::with_prefix_in(".before.", folder(path))?.into_temp_path();
        fs::rename(path, &aside)?;
        Some(aside)
    } else {
        None
    };
    match staged.persist(path) {
        Ok(_) => Ok(Placed { path: path.to_owned(), before }),
        Err(error) => {
            put_back(path, before);
            Err(error.error)
        }
    }
}

/// Undoes [`place`]. What fails here fails for a cause that the user is told of already.
fn take_back(placed: Placed) {
    let _ = fs::remove_file(&placed.path);
    put_back(&placed.path, placed.before);
}

fn put_back(path: &Path, before: Option<TempPath>) {
    // On failure the old file keeps its other name rather than be lost.
    if let Some(Err(error)) = before.map(|b| b.persist(path)) {
        let _ = error.path.keep();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn add(outputs: &mut Outputs, path: &Path, text: &str) -> anyhow::Result<()> {
        outputs.add(path, |out| out.write_all(text.as_bytes()))
    }

    #[test]
    fn all_or_none() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b, c] = ["a", "b", "c"].map(|name| folder.path().join(name));
        let names = || fs::read_dir(folder.path()).unwrap().count();
        fs::write(&a, "old").unwrap();
        let mut outputs = Outputs::default();
        add(&mut outputs, &a, "new").unwrap();
        add(&mut outputs, &b, "new").unwrap();
        assert!(outputs.add(&c, |_| Err(io::Error::other("the disk is on fire"))).is_err());
        drop(outputs);
        assert_eq!((fs::read(&a).unwrap().as_slice(), names()), (&b"old"[..], 1), "not all could be written");
        // The last cannot have its name: a folder with something in it has it.
        fs::create_dir_all(c.join("d")).unwrap();
        let mut outputs = Outputs::default();
        for path in [&a, &b, &c] {
            add(&mut outputs, path, "new").unwrap();
        }
        let error = outputs.appear().unwrap_err().to_string();
        assert!(error.contains("nothing was written"), "{error}");
        assert_eq!((fs::read(&a).unwrap().as_slice(), names()), (&b"old"[..], 2), "what was there is back");
        let mut outputs = Outputs::default();
        for path in [&a, &b] {
            add(&mut outputs, path, "new").unwrap();
        }
        outputs.appear().unwrap();
        assert_eq!((fs::read(&a).unwrap(), fs::read(&b).unwrap()), (b"new".to_vec(), b"new".to_vec()));
        assert_eq!(names(), 3);
    }
}

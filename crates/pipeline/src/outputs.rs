//! Several files that appear together or not at all.

use crate::files::{FileError, folder, stage};
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use tempfile::TempPath;

/// Files that are written and do not have their names yet.
#[derive(Debug, Default)]
pub struct Outputs {
    /// Closed: a sequence may have more files than a process may hold open.
    staged: Vec<(PathBuf, TempPath)>,
}

/// A file that has got its name, and what had it before.
struct Placed {
    path: PathBuf,
    before: Option<TempPath>,
}

impl Outputs {
    /// Writes a file beside where it will appear, and gives what `write` does. All that can go wrong with a disk or a value does so
    /// here.
    ///
    /// # Errors
    /// [`FileError::Write`] with the path and the cause, be it the disk's or `write`'s own.
    pub fn add<T, E>(
        &mut self,
        path: &Path,
        write: impl FnOnce(&mut BufWriter<&File>) -> Result<T, E>,
    ) -> Result<T, FileError>
    where
        E: Into<Box<dyn std::error::Error + Send + Sync>>,
    {
        let (value, staged) = stage(path, write).map_err(|source| cannot_write(path, source))?;
        self.staged.push((path.to_owned(), staged.into_temp_path()));
        Ok(value)
    }

    /// Gives all files their names. If one cannot have its name, all are gone and what was there before is back.
    ///
    /// No system call names several files at once: a program killed between two of them leaves some new and some old.
    ///
    /// # Errors
    /// [`FileError::Write`] with the path that could not be had.
    pub fn appear(self) -> Result<(), FileError> {
        let mut placed: Vec<Placed> = Vec::new();
        for (path, staged) in self.staged {
            match place(&path, staged) {
                Ok(file) => placed.push(file),
                Err(error) => {
                    placed.into_iter().rev().for_each(take_back);
                    return Err(cannot_write(&path, error.into()));
                }
            }
        }
        Ok(())
    }
}

fn cannot_write(path: &Path, source: Box<dyn std::error::Error + Send + Sync>) -> FileError {
    FileError::Write { path: path.to_owned(), source }
}

/// Gives a file its name in one step. What had the name has another one beside it, until all is done.
fn place(path: &Path, staged: TempPath) -> io::Result<Placed> {
    let before = path.is_file().then(|| put_aside(path)).transpose()?;
    match staged.persist(path) {
        Ok(()) => Ok(Placed { path: path.to_owned(), before }),
        Err(error) => {
            put_back(path, before);
            Err(error.error)
        }
    }
}

/// Gives a file a second name; where the disk knows one name for a file only, that one.
fn put_aside(path: &Path) -> io::Result<TempPath> {
    let mut names = tempfile::Builder::new();
    let linked = names.prefix(".before.").make_in(folder(path), |aside| fs::hard_link(path, aside));
    let aside = linked.or_else(|_| names.make_in(folder(path), |aside| fs::rename(path, aside)))?;
    Ok(aside.into_temp_path())
}

/// Undoes [`place`]. What fails here fails for a cause that the user is told of already.
fn take_back(placed: Placed) {
    if placed.before.is_none() {
        let _ = fs::remove_file(&placed.path);
    }
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
    use std::io::Write;

    fn add(outputs: &mut Outputs, path: &Path, text: &str) -> Result<(), FileError> {
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
        assert!(outputs.add(&c, |_| Err::<(), _>(io::Error::other("the disk is on fire"))).is_err());
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

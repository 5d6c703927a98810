use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// What went wrong with a file, and which.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError {
    /// The file cannot be read.
    #[error("cannot read {}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The file cannot be written; nothing was left behind, and what was there before is untouched.
    #[error("cannot write {} (nothing was written)", path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

/// All bytes of a file.
///
/// # Errors
/// [`FileError::Read`] with the path.
pub fn read_file(path: &Path) -> Result<Vec<u8>, FileError> {
    fs::read(path).map_err(|source| FileError::Read { path: path.to_owned(), source })
}

/// Writes a file so that it appears whole or not at all.
///
/// `write` fills a temporary file in the same folder, which is brought to the disk and then takes the name in
/// one step. If anything fails the temporary file is gone and what was there under the name stays.
///
/// # Errors
/// [`FileError::Write`] with the path and the cause, be it the disk's or `write`'s own.
pub fn write_whole<T, E>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<T, E>,
) -> Result<T, FileError>
where
    E: Into<Box<dyn std::error::Error + Send + Sync>>,
{
    let cannot = |source| FileError::Write { path: path.to_owned(), source };
    let (value, staged) = stage(path, write).map_err(cannot)?;
    staged.persist(path).map_err(|error| cannot(error.error.into()))?;
    Ok(value)
}

/// Writes a file beside where it will appear, and brings it to the disk.
pub(crate) fn stage<T, E>(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<T, E>,
) -> Result<(T, NamedTempFile), Box<dyn std::error::Error + Send + Sync>>
where
    E: Into<Box<dyn std::error::Error + Send + Sync>>,
{
    let name = path.file_name().ok_or("the path names no file")?.to_string_lossy();
    let temporary = tempfile::Builder::new()
        .prefix(&format!(".{name}."))
        .suffix(".partial")
        .make_in(folder(path), open_like_any_other)?;
    let mut out = BufWriter::with_capacity(1 << 18, temporary.as_file());
    let value = write(&mut out).map_err(Into::into)?;
    out.flush()?;
    drop(out);
    temporary.as_file().sync_all()?;
    Ok((value, temporary))
}

/// The folder of a path; an empty parent is the current folder.
pub(crate) fn folder(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// Temporary files are private to their owner by default; ours becomes an ordinary file, so it is opened as one.
fn open_like_any_other(path: &Path) -> io::Result<File> {
    File::options().read(true).write(true).create_new(true).open(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, |out| out.write_all(b"old")).unwrap();
        let error = write_whole(&path, |out| {
            out.write_all(b"half of the n")?;
            Err::<(), _>(io::Error::other("the disk is on fire"))
        });
        assert!(error.unwrap_err().to_string().contains("a.txt"));
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        write_whole(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
    }
}

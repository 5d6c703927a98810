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
/// one step. If anything fails the temporary file is gone and what was there under the name stays. One that a killed
/// program left is taken away by whoever writes a file of that name next.
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
    let prefix = prefix(&name);
    remove_abandoned(folder(path), &prefix);
    let temporary = tempfile::Builder::new()
        .prefix(&prefix)
        .rand_bytes(N_RANDOM)
        .suffix(SUFFIX)
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

/// Temporary files are private to their owner by default; ours becomes an ordinary file, so it is opened as one. The lock
/// says that somebody writes it: the system takes it off a program that is killed.
fn open_like_any_other(path: &Path) -> io::Result<File> {
    let file = File::options().read(true).write(true).create_new(true).open(path)?;
    // Where a disk knows no locks nothing is taken for abandoned either.
    if file.lock().is_ok() && !path.exists() {
        // Taken away between its opening and its lock: another name is tried.
        return Err(io::ErrorKind::AlreadyExists.into());
    }
    Ok(file)
}

/// Random letters of a temporary file's name, and its end.
const N_RANDOM: usize = 6;
const SUFFIX: &str = ".partial";

/// The most bytes that a file's name may have on the usual disks.
const MAX_NAME: usize = 255;

/// How the temporary files of a name begin. A name that leaves no room for the rest is cut.
fn prefix(name: &str) -> String {
    let mut end = name.len().min(MAX_NAME - "..".len() - N_RANDOM - SUFFIX.len());
    while !name.is_char_boundary(end) {
        end -= 1;
    }
    format!(".{}.", &name[..end])
}

/// Removes what killed programs left of a file: temporary files of its name that nobody writes. What cannot be looked at stays,
/// as it is in nobody's way.
fn remove_abandoned(folder: &Path, prefix: &str) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let random = name.to_str().and_then(|name| name.strip_prefix(prefix)?.strip_suffix(SUFFIX));
        if random.is_some_and(|letters| {
            letters.len() == N_RANDOM && letters.bytes().all(|b| b.is_ascii_alphanumeric())
        }) && let Ok(file) = File::options().write(true).open(entry.path())
            && file.try_lock().is_ok()
        {
            let _ = fs::remove_file(entry.path());
        }
    }
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

    /// As long as a name may be; 238 letters of one byte, and the two bytes of a ü where it is cut.
    #[test]
    fn a_file_may_have_the_longest_name() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a".repeat(MAX_NAME), format!("{}{}", "a".repeat(238), "ü".repeat(8))] {
            let path = folder.path().join(name);
            write_whole(&path, |out| out.write_all(b"new")).unwrap();
            assert_eq!(fs::read(&path).unwrap(), b"new");
        }
    }

    #[test]
    fn what_a_killed_writer_left_goes_and_what_is_written_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let names = || {
            let entries = fs::read_dir(folder.path()).unwrap();
            let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
            names.sort();
            names
        };
        // Others' files, and one that somebody is writing.
        let others = [".a.txt.b.aaaaaa.partial", ".a.txt.notes.partial", ".b.txt.aaaaaa.partial"];
        for name in others {
            fs::write(folder.path().join(name), "").unwrap();
        }
        fs::write(folder.path().join(".a.txt.Abc123.partial"), "half of the n").unwrap();
        write_whole(&path, |out| {
            assert!(!names().contains(&".a.txt.Abc123.partial".to_owned()), "{:?}", names());
            // Another writer meanwhile.
            write_whole(&path, |out| out.write_all(b"other"))?;
            out.write_all(b"new").map_err(Box::<dyn std::error::Error + Send + Sync>::from)
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        let mut left: Vec<_> = others.iter().map(ToString::to_string).chain(["a.txt".to_owned()]).collect();
        left.sort();
        assert_eq!(names(), left);
    }
}

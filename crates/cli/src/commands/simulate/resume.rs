//! What is kept beside the output so that a long run that was stopped can go on.
//!
//! A folder `.NAME.resume` holds `run.json`, which says what run it is, and a file for each part of the groom that is
//! done. Every file appears whole or not at all, and the folder goes when the output is there.

use crate::args::SimulateArgs;
use anyhow::{Context, bail};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::error::Error;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use tousle_pipeline::write_whole;
use tousle_sim::{Count, Keeper, Part, SimOptions};

/// A run that keeps what is done.
pub struct Resumable {
    folder: PathBuf,
    strands_per_part: Option<NonZeroUsize>,
}

/// One of the run's simulations: that of the guides, that of the check.
pub struct Stage<'a> {
    run: &'a Resumable,
    name: &'static str,
}

/// All that a run's bytes depend on.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Inputs {
    program: String,
    field: String,
    groom: String,
    head: Option<String>,
    body: Vec<Option<String>>,
    options: String,
}

impl Resumable {
    /// Opens what was kept beside the output, or begins to keep; `None` unless the arguments ask for it.
    pub fn open(args: &SimulateArgs, options: &SimOptions) -> anyhow::Result<Option<Self>> {
        let Some(strands) = args.resume else { return Ok(None) };
        let output = &args.output[0];
        let name =
            output.file_name().with_context(|| format!("output {}: names no file", output.display()))?;
        let folder = output.with_file_name(format!(".{}.resume", name.to_string_lossy()));
        let inputs = Inputs::of(args, options)?;
        let strands_per_part = strands.and_then(|strands| NonZeroUsize::new(strands as usize));
        let run = Self { folder, strands_per_part };
        run.check_or_begin(&inputs)?;
        Ok(Some(run))
    }

    fn check_or_begin(&self, inputs: &Inputs) -> anyhow::Result<()> {
        let file = self.folder.join("run.json");
        let text = match fs::read(&file) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                self.begin()?;
                write_whole(&file, |out| serde_json::to_writer_pretty(out, inputs))?;
                return Ok(());
            }
            Err(error) => return Err(error).with_context(|| format!("cannot read {}", file.display())),
        };
        let kept: Inputs = serde_json::from_slice(&text)
            .with_context(|| format!("{}: found no run that this program kept", file.display()))?;
        let differs = kept.differs_from(inputs);
        if !differs.is_empty() {
            bail!(
                "--resume: found parts of another run in {} (other {}), expected the same command on the same files; \
                 remove that folder or name another output",
                self.folder.display(),
                differs.join(", ")
            );
        }
        Ok(())
    }

    /// Makes the folder. Parts in it that no `run.json` speaks for are of a run that was half removed.
    fn begin(&self) -> anyhow::Result<()> {
        let make = || {
            fs::create_dir_all(&self.folder)?;
            remove_parts(&self.folder)
        };
        make().with_context(|| format!("cannot make the folder {} anew", self.folder.display()))
    }

    /// What keeps the parts of one simulation.
    pub fn stage(&self, name: &'static str) -> Stage<'_> {
        Stage { run: self, name }
    }

    /// Removes what was kept, once the output is there.
    pub fn remove(self) -> anyhow::Result<()> {
        let remove = || {
            remove_parts(&self.folder)?;
            fs::remove_file(self.folder.join("run.json"))?;
            // What somebody else put there stays.
            match fs::remove_dir(&self.folder) {
                Err(error) if error.kind() == ErrorKind::DirectoryNotEmpty => Ok(()),
                result => result,
            }
        };
        remove().with_context(|| format!("cannot remove the folder {}", self.folder.display()))
    }
}

impl Inputs {
    fn of(args: &SimulateArgs, options: &SimOptions) -> anyhow::Result<Self> {
        // The shot's poses are known by their file.
        let options = SimOptions { head: None, ..options.clone() };
        let head = args.head.as_ref().map(|name| super::head::split(name));
        Ok(Self {
            program: format!("{} {PARTS}", env!("CARGO_PKG_VERSION")),
            field: hash(&args.field)?,
            groom: hash(&args.groom)?,
            head: head.as_ref().map(|(path, _)| hash(path)).transpose()?,
            body: [&args.body_args.head_mesh, &args.body_args.torso_mesh]
                .into_iter()
                .map(|path| path.as_ref().map(|path| hash(path)).transpose())
                .collect::<Result<_, _>>()?,
            options: format!(
                "{options:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?}",
                args.guides,
                args.guides_check,
                args.resume,
                head.and_then(|(_, prim)| prim),
                args.head_axes,
                args.head_start,
                args.groom_args,
                args.body_args
            ),
        })
    }

    fn differs_from(&self, other: &Self) -> Vec<&'static str> {
        let pairs = [
            ("program version", self.program != other.program),
            ("field", self.field != other.field),
            ("groom", self.groom != other.groom),
            ("head motion", self.head != other.head),
            ("body", self.body != other.body),
            ("options", self.options != other.options),
        ];
        pairs.into_iter().filter(|(_, differs)| *differs).map(|(what, _)| what).collect()
    }
}

/// Removes the parts of a folder, whole ones and begun ones.
fn remove_parts(folder: &Path) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        // A program that is killed while it writes a part leaves that under a hidden name.
        if path.extension().is_some_and(|ending| ending == "part" || ending == "partial") {
            fs::remove_file(path)?;
        }
    }
    Ok(())
}

/// SHA-256 of a file, as `sha256sum` prints it.
fn hash(path: &Path) -> anyhow::Result<String> {
    let cannot = || format!("cannot read {}", path.display());
    let mut file = fs::File::open(path).with_context(cannot)?;
    let mut hasher = Sha256::new();
    io::copy(&mut file, &mut hasher).with_context(cannot)?;
    Ok(hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
}

impl Stage<'_> {
    fn path(&self, part: usize) -> PathBuf {
        self.run.folder.join(format!("{}-{part:06}.part", self.name))
    }
}

impl Keeper for Stage<'_> {
    fn strands_per_part(&self) -> Option<NonZeroUsize> {
        self.run.strands_per_part
    }

    fn kept(&self, part: usize) -> Result<Option<Part>, Box<dyn Error + Send + Sync>> {
        let path = self.path(part);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(format!("cannot read {}: {error}", path.display()).into()),
        };
        let part = from_bytes(&bytes);
        part.map(Some).ok_or_else(|| {
            format!("{}: found bytes that were not written so, expected a part; remove it", path.display())
                .into()
        })
    }

    fn keep(&self, number: usize, part: &Part) -> Result<(), Box<dyn Error + Send + Sync>> {
        write_whole(&self.path(number), |out| out.write_all(&to_bytes(part)))?;
        Ok(())
    }
}

/// How parts are cut and written. It changes with the order of strands and with [`to_bytes`].
const PARTS: &str = "parts 2";

const DIGEST_BYTES: usize = 32;
const COUNT_BYTES: usize = 6 * 8;

/// A part as a file: SHA-256 of the rest, six counts, positions; little endian.
fn to_bytes(part: &Part) -> Vec<u8> {
    let Count { steps, iterations, slept, unsettled, unsettled_m, max_stretch } = part.count;
    let mut bytes = vec![0; DIGEST_BYTES];
    for count in [steps, iterations, slept, unsettled, unsettled_m.to_bits(), max_stretch.to_bits()] {
        bytes.extend(count.to_le_bytes());
    }
    bytes.extend(part.positions_m.iter().flatten().flat_map(|c| c.to_le_bytes()));
    let digest = Sha256::digest(&bytes[DIGEST_BYTES..]);
    bytes[..DIGEST_BYTES].copy_from_slice(&digest);
    bytes
}

/// The inverse of [`to_bytes`]; `None` for any other bytes.
fn from_bytes(bytes: &[u8]) -> Option<Part> {
    let (digest, rest) = bytes.split_at_checked(DIGEST_BYTES)?;
    let (counts, positions) = rest.split_at_checked(COUNT_BYTES)?;
    if Sha256::digest(rest)[..] != *digest {
        return None;
    }
    let (counts, _) = counts.as_chunks::<8>();
    let [steps, iterations, slept, unsettled, unsettled_m, max_stretch] = counts else { return None };
    let count = Count {
        steps: u64::from_le_bytes(*steps),
        iterations: u64::from_le_bytes(*iterations),
        slept: u64::from_le_bytes(*slept),
        unsettled: u64::from_le_bytes(*unsettled),
        unsettled_m: f64::from_bits(u64::from_le_bytes(*unsettled_m)),
        max_stretch: f64::from_bits(u64::from_le_bytes(*max_stretch)),
    };
    let (numbers, _) = positions.as_chunks::<4>();
    let (points, _) = numbers.as_chunks::<3>();
    let positions_m = points.iter().map(|p| p.map(f32::from_le_bytes)).collect();
    Some(Part { positions_m, count })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_comes_back_and_a_flipped_bit_is_noticed() {
        let count =
            Count { steps: 1, iterations: 2, slept: 3, unsettled: 4, unsettled_m: 0.5, max_stretch: 0.25 };
        let part = Part { positions_m: vec![[1.0, -2.5, 3.0], [0.1, 0.2, 0.3]], count };
        let bytes = to_bytes(&part);
        assert_eq!(from_bytes(&bytes), Some(part));
        for at in 0..bytes.len() {
            let mut bad = bytes.clone();
            bad[at] ^= 1;
            assert_eq!(from_bytes(&bad), None, "{at}");
            assert_eq!(from_bytes(&bytes[..at]), None, "{at}");
        }
    }
}

//! Runs the program as a user would, in a folder of its own.
#![allow(dead_code, reason = "each test file uses its part")]
#![allow(clippy::unwrap_used, reason = "a test may panic")]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;

/// A folder with the demo's capture, session and groom in it.
pub struct Room {
    folder: tempfile::TempDir,
}

/// How a run ended.
pub struct Run {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

impl Room {
    pub fn new() -> Self {
        let room = Self { folder: tempfile::tempdir().unwrap() };
        for file in ["gusts.c3d", "session.json", "bob.json", "lift.toml"] {
            std::fs::copy(fixture(file), room.path(file)).unwrap();
        }
        room
    }

    /// The same with a field in it, `f.eff.mcap`: the capture by the method `paper` in voxels of 50 mm, converted once for
    /// all tests of a file.
    pub fn with_field() -> Self {
        static FIELD: LazyLock<Vec<u8>> = LazyLock::new(|| {
            let room = Room::new();
            let convert = "convert gusts.c3d --method paper --session session.json --voxel-mm 50";
            room.run(&format!("{convert} -o f.eff.mcap")).ended(0);
            room.read("f.eff.mcap")
        });
        let room = Self::new();
        room.write("f.eff.mcap", &*FIELD);
        room
    }

    pub fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    pub fn read(&self, file: &str) -> Vec<u8> {
        std::fs::read(self.path(file)).unwrap()
    }

    pub fn write(&self, file: &str, bytes: impl AsRef<[u8]>) {
        std::fs::write(self.path(file), bytes).unwrap();
    }

    pub fn remove(&self, file: &str) {
        std::fs::remove_file(self.path(file)).unwrap();
    }

    /// Every file in the folder, hidden ones too, in order.
    pub fn files(&self) -> Vec<String> {
        self.files_in("")
    }

    /// The same of a folder in it.
    pub fn files_in(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(folder)).unwrap();
        let mut files: Vec<String> =
            entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        files.sort();
        files
    }

    /// Runs `tousle` with these words, split at blanks, in the folder.
    pub fn run(&self, words: &str) -> Run {
        self.output(Command::new(env!("CARGO_BIN_EXE_tousle")).args(words.split_whitespace()))
    }

    /// Runs a line of shell in the folder, with `tousle` as `$TOUSLE`.
    pub fn shell(&self, line: &str) -> Run {
        self.output(Command::new("bash").args(["-c", line]).env("TOUSLE", env!("CARGO_BIN_EXE_tousle")))
    }

    fn output(&self, command: &mut Command) -> Run {
        let Output { status, stdout, stderr } = command.current_dir(self.folder.path()).output().unwrap();
        Run {
            code: status.code(),
            out: String::from_utf8(stdout).unwrap(),
            err: String::from_utf8(stderr).unwrap(),
        }
    }
}

impl Run {
    /// The run, if it ended with this code.
    #[track_caller]
    pub fn ended(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "stdout: {}\nstderr: {}", self.out, self.err);
        self
    }

    /// The run, if stderr says all of these.
    #[track_caller]
    pub fn says(self, words: &[&str]) -> Self {
        for word in words {
            assert!(self.err.contains(word), "expected {word:?} in: {}", self.err);
        }
        self
    }
}

fn fixture(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/demo").join(file)
}

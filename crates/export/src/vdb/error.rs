use tousle_field::GridError;

/// What makes a `.vdb` unusable.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VdbError {
    /// The bytes are no OpenVDB file.
    #[error("found the bytes {found:?} at the beginning, expected those of an OpenVDB file")]
    NotVdb {
        /// The first eight bytes, or as many as there are.
        found: Vec<u8>,
    },
    /// The file is of a version that is not read.
    #[error("found file version {found}, expected 222 to 224 (OpenVDB 3 and later)")]
    Version {
        /// The version.
        found: u32,
    },
    /// The file ends too early, or a length in it is wrong.
    #[error("byte {at}: found {left} bytes left, expected {expected}")]
    Cut {
        /// Where.
        at: usize,
        /// How many bytes there are.
        left: usize,
        /// How many are needed.
        expected: usize,
    },
    /// Something is not as the format has it.
    #[error("byte {at}: found {found}, expected {expected}")]
    Bad {
        /// Where.
        at: usize,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// No grid can be taken for the wind.
    #[error("found the grids {found:?}, expected {expected}")]
    NoWind {
        /// Name and type of each grid.
        found: Vec<String>,
        /// What would do.
        expected: String,
    },
    /// A grid of the file does not fit the wind.
    #[error("grid {grid:?}: found {found}, expected {expected}")]
    BadGrid {
        /// The grid's name.
        grid: String,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// The steps of a sequence do not belong together.
    #[error("step {step}: found {found}, expected {expected}")]
    BadStep {
        /// Which step, from 0.
        step: usize,
        /// What is there.
        found: String,
        /// What should be.
        expected: String,
    },
    /// The grid is impossible.
    #[error(transparent)]
    Grid(#[from] GridError),
}

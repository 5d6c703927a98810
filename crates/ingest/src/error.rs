/// Why bytes do not become a capture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IngestError {
    /// There are no bytes.
    #[error("the file is empty, expected a capture: C3D, Vicon CSV, Motive CSV or TRC")]
    Empty,
    /// The bytes look like nothing we know.
    #[error("found bytes that begin with {found}, expected a capture: C3D, Vicon CSV, Motive CSV or TRC")]
    UnknownFormat {
        /// The first bytes, as text.
        found: String,
    },
    /// A C3D could not be read.
    #[error("not a readable C3D")]
    C3d(#[from] tousle_c3d::ReadError),
    /// A TRC could not be read.
    #[error("not a readable TRC")]
    Trc(#[from] tousle_trc::TrcError),
    /// A CSV could not be read.
    #[error("not a readable CSV capture")]
    Csv(#[from] tousle_csv::CsvError),
    /// The file has no table of marker positions.
    #[error("found {found}, expected marker trajectories")]
    NoTrajectories {
        /// What the file holds instead.
        found: String,
    },
    /// The file was longer once: what is missing could be anything.
    #[error(
        "the file is cut off: found {found} frames, expected {claimed} as it says of itself; with `allow-cut` what is there is taken"
    )]
    CutShort {
        /// Frames that the file claims.
        claimed: u64,
        /// Whole frames that are there.
        found: u64,
    },
    /// Nobody said what the numbers are in.
    #[error("found no unit of length in the file, expected one: pass it (mm, cm, m or in)")]
    NoUnit,
    /// The unit is not one of length, or none we know.
    #[error("found the unit {found:?}, expected one of length: pass it (mm, cm, m or in)")]
    UnknownUnit {
        /// The unit as the file names it.
        found: String,
    },
    /// Nobody said how many frames a second has.
    #[error("found no frame rate in the file, expected one: pass it")]
    NoRate,
    /// The frame rate is none.
    #[error("found the frame rate {found}, expected a number > 0")]
    BadRate {
        /// What the file or the options say.
        found: f64,
    },
    /// Nobody in the file has the subject's name.
    #[error("found no markers of subject {wanted:?}, expected some: the file has {found}")]
    NoSuchSubject {
        /// The subject asked for.
        wanted: String,
        /// The subjects there are.
        found: String,
    },
    /// Rows are not in the order of their frames.
    #[error("line {line}: found frame {frame} after frame {previous}, expected rising frame numbers")]
    FramesNotRising {
        /// Its line in the file, from 1.
        line: u64,
        /// The frame.
        frame: i64,
        /// The frame in the row before.
        previous: i64,
    },
    /// One frame number is far from the one before, as a slip of the pen makes it.
    #[error(
        "line {line}: found frame {frame} after frame {previous}, expected no gap longer than the {rows} rows of the file together"
    )]
    LongGap {
        /// Its line in the file, from 1.
        line: u64,
        /// The frame.
        frame: i64,
        /// The frame in the row before.
        previous: i64,
        /// Rows in the file.
        rows: usize,
    },
    /// The frame numbers jump so far that the file holds next to nothing.
    #[error("found frames {first} to {last} in {rows} rows, expected frames nearer to one another")]
    FramesTooFarApart {
        /// The first frame.
        first: i64,
        /// The last frame.
        last: i64,
        /// Rows in the file.
        rows: usize,
    },
}

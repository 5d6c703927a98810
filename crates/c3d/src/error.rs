/// Why a file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The source failed.
    #[error("cannot read the C3D data")]
    Io(#[from] std::io::Error),
    /// There is no room for a header and a parameter section.
    #[error("the file ends after {found} bytes, a C3D header and parameter section need {expected}")]
    TooShort {
        /// Bytes that are there.
        found: u64,
        /// Bytes needed at least.
        expected: u64,
    },
    /// The second byte of a C3D file is 0x50.
    #[error("not a C3D file: the key byte at offset {offset} is {found:#04x}, expected 0x50")]
    NotC3d {
        /// Where the key byte should be.
        offset: u64,
        /// What is there.
        found: u8,
    },
    /// The processor is unknown and the header makes no sense for any.
    #[error(
        "processor number {found} at offset {offset} is none of 84, 85, 86, and the header does not tell"
    )]
    Processor {
        /// Where the number is.
        offset: u64,
        /// What is there.
        found: u8,
    },
    /// Points or analog samples are announced, but not one frame of them fits in the file.
    #[error(
        "{n_points} points and {n_frames} frames are announced, but no frame fits in the {found} bytes of the file"
    )]
    NoData {
        /// Points a frame.
        n_points: usize,
        /// Frames that the file claims.
        n_frames: u64,
        /// Bytes in the file.
        found: u64,
    },
    /// A point was asked for that the file does not have.
    #[error("point {asked} was asked for, the file has {n_points}")]
    NoSuchPoint {
        /// Index of the point, from 0.
        asked: usize,
        /// Points a frame.
        n_points: usize,
    },
    /// Frames were asked for that the file does not have.
    #[error("frames {start} to {end} were asked for, the file has {n_frames}")]
    NoSuchFrames {
        /// First frame asked for, from 0.
        start: usize,
        /// End of the frames asked for, excluded.
        end: usize,
        /// Frames in the file.
        n_frames: usize,
    },
}

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// Writing failed.
    #[error("cannot write the C3D data")]
    Io(#[from] std::io::Error),
    /// The format has no way to say that there are no frames.
    #[error("a C3D file has one frame at least")]
    NoFrames,
    /// Another number of frames was written than the trial has.
    #[error("frame {found} was written or is missing, the trial has {expected} frames")]
    FrameCount {
        /// Frames that were written, or would have been.
        found: usize,
        /// Frames of the trial.
        expected: usize,
    },
    /// A frame has another number of points than the trial has labels.
    #[error("frame {frame} has {found} points, the trial has {expected} labels")]
    PointCount {
        /// Index of the frame, from 0.
        frame: usize,
        /// Points in the frame.
        found: usize,
        /// Labels of the trial.
        expected: usize,
    },
    /// A point cannot be stored.
    #[error("point {point_idx} of frame {frame} cannot be stored: {reason}")]
    Point {
        /// Index of the frame, from 0.
        frame: usize,
        /// Index of the point, from 0.
        point_idx: usize,
        /// Why.
        reason: &'static str,
    },
    /// A number cannot be stored.
    #[error("{name} is {value}, which the file's floats cannot hold or which makes no sense there")]
    Number {
        /// What it is.
        name: String,
        /// The number.
        value: f32,
    },
    /// A text cannot be stored.
    #[error("the text {text:?} cannot be stored: {reason}")]
    Text {
        /// The text.
        text: String,
        /// Why.
        reason: &'static str,
    },
    /// Something is larger than the format allows.
    #[error("{what} would be {found}, the format allows {limit}")]
    TooLarge {
        /// What.
        what: &'static str,
        /// How much or many.
        found: u64,
        /// How much or many may be.
        limit: u64,
    },
    /// A parameter has another number of values than its dimensions say.
    #[error("parameter {name} has {found} values, its dimensions make {expected}")]
    Shape {
        /// Group and name.
        name: String,
        /// Values.
        found: usize,
        /// Product of the dimensions.
        expected: usize,
    },
    /// A parameter that the writer makes itself was given.
    #[error("parameter {name} follows from the trial or belongs to data that is not written")]
    Reserved {
        /// Group and name.
        name: String,
    },
}

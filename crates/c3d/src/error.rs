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

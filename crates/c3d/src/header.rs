/// The header block as the file has it, before anything is reconciled.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Header {
    /// Block in which the parameter section starts, counted from 1.
    pub parameter_block: u8,
    /// Points a frame.
    pub n_points: u16,
    /// Analog words a frame: channels times samples a frame.
    pub analog_words: u16,
    /// Number of the first frame.
    pub first_frame: u16,
    /// Number of the last frame; 65535 also stands for more.
    pub last_frame: u16,
    /// The longest gap that was filled, frames.
    pub max_gap: u16,
    /// Scale of integer coordinates; negative says that coordinates are floats.
    pub scale: f32,
    /// Block in which the data starts, counted from 1.
    pub data_block: u16,
    /// Analog samples of a channel a frame.
    pub analog_samples: u16,
    /// Frames a second.
    pub rate_hz: f32,
    /// Events of the header's own kind (18 at most, names of four letters): label and time in seconds.
    pub events: Vec<(String, f32)>,
}

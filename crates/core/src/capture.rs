use crate::{LengthUnit, Track, UpAxis};

/// One trial as the cameras saw it: labeled marker positions over time, world space, meters.
#[derive(Clone, Debug, PartialEq)]
pub struct Capture {
    /// Frames a second, > 0.
    pub rate_hz: f64,
    /// The number the file gives its first frame; trials cut out of longer ones rarely start at 1.
    pub first_frame: i64,
    /// Frames in every trajectory.
    pub n_frames: usize,
    /// The unit the file was written in, if it says so. Positions here are meters all the same.
    pub file_unit: Option<LengthUnit>,
    /// The up axis the file names, if it names one.
    pub up_axis: Option<UpAxis>,
    /// The markers, in the file's order.
    pub trajectories: Vec<Trajectory>,
}

/// One marker of a [`Capture`].
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// The subject's prefix (`Wig` of `Wig:S01_1`), if the label carries one.
    pub subject: Option<String>,
    /// The marker's name without prefix; `*12` and the like for trajectories nobody labeled.
    pub label: String,
    /// Positions, world space, m.
    pub track: Track,
}

impl Trajectory {
    /// Whether the capture system numbered this trajectory because nobody labeled it.
    pub fn is_unlabeled(&self) -> bool {
        self.label.starts_with('*')
    }
}

impl Capture {
    /// The first trajectory with this label, whatever its subject.
    pub fn trajectory(&self, label: &str) -> Option<&Trajectory> {
        self.trajectories.iter().find(|t| t.label == label)
    }

    /// The time of a frame (from 0) after the first one, s.
    pub fn time_secs(&self, frame: usize) -> f64 {
        frame as f64 / self.rate_hz
    }

    /// How long the capture lasts, s.
    pub fn duration_secs(&self) -> f64 {
        self.n_frames as f64 / self.rate_hz
    }
}

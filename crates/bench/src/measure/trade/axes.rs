use crate::Cost;
use crate::measure::MeasureRow;

/// What an error is of.
#[derive(Clone, Copy)]
pub(super) enum Off {
    /// The other hairstyle's motion.
    Motion,
    /// The wind itself.
    Wind,
}

/// Which clock a cost is read from.
#[derive(Clone, Copy)]
pub(super) enum Clock {
    Cpu,
    Wall,
}

impl Off {
    pub fn of(self, row: &MeasureRow) -> f64 {
        match self {
            Self::Motion => 1.0 - row.motion.points.explained_motion,
            Self::Wind => row.field.hair.map_or(f64::NAN, |score| score.vector_error),
        }
    }

    pub fn title(self) -> &'static str {
        match self {
            Self::Motion => "style B in the measured wind",
            Self::Wind => "the measured wind, or force, where hair was",
        }
    }

    pub fn label(self) -> &'static str {
        match self {
            Self::Motion => "unexplained motion",
            Self::Wind => "rms error over rms of the truth",
        }
    }
}

impl Clock {
    pub fn secs(self, cost: &Cost) -> f64 {
        match self {
            Self::Cpu => cost.secs(),
            Self::Wall => cost.wall_secs,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "processor time",
            Self::Wall => "the wall's time",
        }
    }

    pub fn label(self) -> &'static str {
        match self {
            Self::Cpu => "CPU s a capture",
            Self::Wall => "wall s a capture",
        }
    }
}

use std::fmt;

/// Something in a file that is wrong or missing, and what was done about it.
///
/// Offsets are bytes from the file's start.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// Zeros stand before the header; all places are counted from after them.
    #[error("{n_bytes} zero bytes before the header were skipped")]
    LeadingZeros {
        /// How many.
        n_bytes: u64,
    },
    /// The parameter section is not where the header says.
    #[error("no parameter section at block {found} as the header says, read at block {used}")]
    ParameterBlock {
        /// The block of the header.
        found: u8,
        /// The block that was read.
        used: u8,
    },
    /// The processor number is none of 84, 85, 86; the header makes sense for one of them only.
    #[error("processor number {found} at offset {offset} is unknown, {assumed} was assumed from the header")]
    ProcessorAssumed {
        /// Where the number is.
        offset: u64,
        /// What is there.
        found: u8,
        /// The number of the processor that was assumed.
        assumed: u8,
    },
    /// The parameter section has no parameter.
    #[error("there are no parameters: counts are the header's, labels and unit are unknown")]
    NoParameters,
    /// A parameter's pointer to the next one leads nowhere sensible; reading went on elsewhere.
    #[error(
        "parameter {name} at offset {offset} points to offset {found} for the next one, read on at {used}"
    )]
    BadOffset {
        /// Where the parameter is.
        offset: u64,
        /// Its name.
        name: String,
        /// Where it points.
        found: u64,
        /// Where the next one was read.
        used: u64,
    },
    /// The parameter section breaks off; what stands behind is lost.
    #[error("the parameter section is broken at offset {offset} ({reason}), parameters behind it are lost")]
    BrokenParameters {
        /// Where reading stopped.
        offset: u64,
        /// What was found there.
        reason: &'static str,
    },
    /// One parameter was skipped.
    #[error("parameter {name} at offset {offset} was skipped: {reason}")]
    SkippedParameter {
        /// Where the parameter is.
        offset: u64,
        /// Its name.
        name: String,
        /// Why.
        reason: &'static str,
    },
    /// A group has parameters of the same name; the first of each counts.
    #[error(
        "group {group} has {n_parameters} parameters whose name it had before, the first of a name counts"
    )]
    DuplicateParameters {
        /// The group's name.
        group: String,
        /// How many are repeats.
        n_parameters: usize,
    },
    /// Parameters name a group that is nowhere defined.
    #[error("{n_parameters} parameters belong to group {group_id}, which has no name")]
    UnnamedGroup {
        /// The number of the group.
        group_id: u8,
        /// How many parameters it has.
        n_parameters: usize,
    },
    /// Header and parameters disagree.
    #[error(
        "{quantity}: the header says {}, {parameter} says {}, {} is used",
        short(.header), short(.stated), short(.used)
    )]
    Contradiction {
        /// What they disagree on.
        quantity: Quantity,
        /// The header's statement.
        header: f64,
        /// The parameter that says otherwise.
        parameter: &'static str,
        /// Its statement.
        stated: f64,
        /// What fits the file's size, or else the header's.
        used: f64,
    },
    /// A number was found by what fits the file's size, because nothing in the file says it rightly.
    #[error(
        "{quantity}: {} is used because it fits the file's size, the header says {}",
        short(.used), short(.header)
    )]
    Fitted {
        /// Which number.
        quantity: Quantity,
        /// The header's statement.
        header: f64,
        /// What is used.
        used: f64,
    },
    /// The file ends before its last frame.
    #[error("the file is cut: {claimed} frames are announced, {found} are there")]
    CutShort {
        /// Frames that the file claims.
        claimed: u64,
        /// Frames that are there.
        found: u64,
    },
    /// There is more data than the announced frames need, by a block or more.
    #[error("{n_bytes} bytes behind the last frame were not read")]
    TrailingBytes {
        /// How many.
        n_bytes: u64,
    },
    /// Neither header nor parameters give a usable scale.
    #[error("no usable scale in the file, {assumed} was assumed")]
    NoScale {
        /// The scale that was assumed.
        assumed: f32,
    },
    /// Neither header nor parameters give a usable frame rate.
    #[error("no usable frame rate in the file")]
    NoRate,
    /// The file does not name the unit of its positions.
    #[error("POINT:UNITS is absent or blank: the unit of positions is unknown")]
    NoUnit,
    /// There are fewer labels than points.
    #[error("there are {n_labels} labels for {n_points} points, the others have no name")]
    MissingLabels {
        /// Labels in the file.
        n_labels: usize,
        /// Points a frame.
        n_points: usize,
    },
    /// Several points have one label.
    #[error("label {label} is given to {n_points} points")]
    DuplicateLabel {
        /// The label.
        label: String,
        /// How many points have it.
        n_points: usize,
    },
}

/// What header and parameters both state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Quantity {
    /// Points a frame.
    Points,
    /// Analog words a frame.
    AnalogWords,
    /// Frames.
    Frames,
    /// Number of the first frame.
    FirstFrame,
    /// Scale of coordinates; its sign tells floats from integers.
    Scale,
    /// Frames a second.
    Rate,
    /// Block in which the data starts.
    DataStart,
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Points => "points",
            Self::AnalogWords => "analog words a frame",
            Self::Frames => "frames",
            Self::FirstFrame => "first frame",
            Self::Scale => "scale",
            Self::Rate => "rate",
            Self::DataStart => "data start block",
        })
    }
}

/// As few digits as tell a number of the file, mostly a 32-bit float, from its neighbors.
fn short(number: &f64) -> String {
    let single = *number as f32;
    if f64::from(single) == *number { single.to_string() } else { number.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_contradiction_reads_like() {
        let warning = |quantity, header, stated| Warning::Contradiction {
            quantity,
            header,
            parameter: "POINT:X",
            stated,
            used: header,
        };
        let scale = warning(Quantity::Scale, -1.0, f64::from(-0.01_f32)).to_string();
        assert_eq!(scale, "scale: the header says -1, POINT:X says -0.01, -1 is used");
        let frames = warning(Quantity::Frames, 65535.0, 16_777_217.0).to_string();
        assert_eq!(frames, "frames: the header says 65535, POINT:X says 16777217, 65535 is used");
    }
}

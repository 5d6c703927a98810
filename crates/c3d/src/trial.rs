use crate::parameter::{Group, Parameters};
use crate::{Info, Processor, Storage};

/// What a C3D file of points says, apart from the points: enough to write one.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// The machine whose numbers to write.
    pub processor: Processor,
    /// How to store samples.
    pub storage: Storage,
    /// One step of an integer coordinate, and of a residual, in the file's unit; finite, > 0.
    pub scale: f32,
    /// Frames a second; 0 if unknown.
    pub rate_hz: f32,
    /// The number of the first frame.
    pub first_frame: u32,
    /// Frames. More than 65,535 are fine.
    pub n_frames: usize,
    /// The unit of positions, such as `mm`.
    pub unit: Option<String>,
    /// One label a point, in order, without blanks around it; an unnamed point has an empty one.
    pub labels: Vec<String>,
    /// All other parameters. Those that the fields above stand for, and the groups of data that is not written
    /// (`ANALOG`, `FORCE_PLATFORM`, `ROTATION`), must not be among them.
    pub parameters: Parameters,
}

impl Default for Trial {
    /// No points, floats for Intel.
    fn default() -> Self {
        Self {
            processor: Processor::Intel,
            storage: Storage::Float32,
            scale: 1.0,
            rate_hz: 0.0,
            first_frame: 1,
            n_frames: 0,
            unit: None,
            labels: Vec::new(),
            parameters: Parameters::default(),
        }
    }
}

/// Groups that describe data other than points.
const DATA_GROUPS: [&str; 3] = ["ANALOG", "FORCE_PLATFORM", "ROTATION"];
/// Parameters that repeat what [`Trial`] says in its fields, by group.
const OWN: [(&str, &[&str]); 2] = [
    ("POINT", &["USED", "SCALE", "RATE", "FRAMES", "LONG_FRAMES", "DATA_START", "UNITS"]),
    ("TRIAL", &["ACTUAL_START_FIELD", "ACTUAL_END_FIELD"]),
];

/// Whether a parameter stands for a field of [`Trial`] or for data that is not written.
pub(crate) fn is_reserved(group: &str, name: &str) -> bool {
    let (group, name) = (group.to_ascii_uppercase(), name.to_ascii_uppercase());
    let is_own = OWN.iter().any(|(own, names)| *own == group && names.contains(&name.as_str()));
    is_own || DATA_GROUPS.contains(&group.as_str()) || (group == "POINT" && is_labels(&name))
}

/// `LABELS`, `LABELS2`, `LABELS3`…
fn is_labels(name: &str) -> bool {
    name.strip_prefix("LABELS").is_some_and(|part| part.bytes().all(|b| b.is_ascii_digit()))
}

/// What a file that was read would need to be written again, without its analog samples and rotations.
pub(crate) fn of(info: &Info, parameters: &Parameters) -> Trial {
    let mut labels = info.labels.clone();
    labels.resize(info.n_points, String::new());
    Trial {
        processor: info.processor,
        storage: info.storage,
        scale: info.scale,
        rate_hz: info.rate_hz.unwrap_or(0.0) as f32,
        first_frame: info.first_frame,
        n_frames: info.n_frames,
        unit: info.unit.clone(),
        labels,
        parameters: Parameters { groups: parameters.groups.iter().filter_map(others).collect() },
    }
}

/// The part of a group that no field of [`Trial`] stands for; `None` if that is all of it.
fn others(group: &Group) -> Option<Group> {
    let mut others = group.clone();
    others.parameters.retain(|p| !is_reserved(&group.name, &p.name));
    let name = group.name.to_ascii_uppercase();
    let is_ours = DATA_GROUPS.contains(&name.as_str()) || OWN.iter().any(|(own, _)| *own == name);
    (!others.parameters.is_empty() || !is_ours).then_some(others)
}

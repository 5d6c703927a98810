use crate::label::{self, PointKind};
use crate::parameter::Parameters;
use crate::{Processor, Storage};

/// What a file holds, after header and parameters have been reconciled with its size.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Info {
    /// The machine whose numbers the file is written in.
    pub processor: Processor,
    /// How samples are stored.
    pub storage: Storage,
    /// One step of an integer coordinate, and of a residual, in the file's unit, > 0.
    pub scale: f32,
    /// Frames a second, > 0; `None` if neither header nor parameters say.
    pub rate_hz: Option<f64>,
    /// The number of the first frame; 0 occurs, and trials cut out of longer ones start anywhere.
    pub first_frame: u32,
    /// Frames that are there.
    pub n_frames: usize,
    /// Points a frame: markers, and whatever else the system stores as points.
    pub n_points: usize,
    /// The unit of positions as the file spells it (`mm`, `m`, `mete`); `None` if absent or blank.
    pub unit: Option<String>,
    /// The labels the file has, in order, cut to `n_points`, without blanks and NULs around them; an unnamed point is
    /// an empty text. **Shorter than `n_points` if the file has fewer**: [`Info::label`] is `None` for the rest.
    pub labels: Vec<String>,
    /// What each point is, as far as the parameters say: `n_points` entries.
    pub kinds: Vec<PointKind>,
    /// The subjects the system knew.
    pub subjects: Vec<Subject>,
    /// `POINT:X_SCREEN`: the world axis towards the right of the system's screen, such as `+X`.
    pub x_screen: Option<String>,
    /// `POINT:Y_SCREEN`: the world axis towards the top of the screen, mostly the up axis.
    pub y_screen: Option<String>,
    /// `MANUFACTURER:COMPANY` and `SOFTWARE`: who wrote the file, if it says so.
    pub manufacturer: Option<String>,
    /// The analog channels, counted and named, not loaded.
    pub analog: Analog,
    /// Events of the `EVENT` group; older ones can stand in [`Header::events`](crate::Header::events).
    pub events: Vec<Event>,
    /// Rigid segments stored as rotations, counted and named, not loaded.
    pub rotations: Rotations,
}

/// The analog channels of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Analog {
    /// Channels.
    pub n_channels: usize,
    /// Samples of each channel in a frame.
    pub n_samples_per_frame: usize,
    /// Names, at most one a channel.
    pub labels: Vec<String>,
}

/// Something that happened at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// What, such as `Foot Strike`.
    pub label: String,
    /// To whom or which side, such as `Left`; empty if the file does not say.
    pub context: String,
    /// When, s, on the clock of the file; `None` if the file does not say.
    pub time_secs: Option<f64>,
}

/// Rigid segments stored as rotations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rotations {
    /// How many segments.
    pub n_rotations: usize,
    /// Names, at most one a segment.
    pub labels: Vec<String>,
}

/// A subject of the `SUBJECTS` group.
#[derive(Clone, Debug, PartialEq)]
pub struct Subject {
    /// The subject's name.
    pub name: String,
    /// What labels of this subject start with, such as `Wig:`; empty if the file does not say.
    pub label_prefix: String,
}

impl Info {
    /// The label of a point, or `None` where the file has none for it.
    pub fn label(&self, point_idx: usize) -> Option<&str> {
        self.labels.get(point_idx).map(String::as_str)
    }
}

pub(crate) fn unit(parameters: &Parameters) -> Option<String> {
    first_text(parameters, "POINT", "UNITS")
}

pub(crate) fn first_text(parameters: &Parameters, group: &str, name: &str) -> Option<String> {
    parameters.texts(group, name).into_iter().next().filter(|text| !text.is_empty())
}

pub(crate) fn manufacturer(parameters: &Parameters) -> Option<String> {
    let parts = ["COMPANY", "SOFTWARE"].map(|name| first_text(parameters, "MANUFACTURER", name));
    let parts: Vec<String> = parts.into_iter().flatten().collect();
    (!parts.is_empty()).then(|| parts.join(" "))
}

pub(crate) fn subjects(parameters: &Parameters) -> Vec<Subject> {
    let prefixes = parameters.long_texts("SUBJECTS", "LABEL_PREFIXES");
    let used = parameters.count("SUBJECTS", "USED").map_or(usize::MAX, |n| n as usize);
    let names = parameters.long_texts("SUBJECTS", "NAMES").into_iter().take(used).enumerate();
    names
        .filter(|(_, name)| !name.is_empty())
        .map(|(i, name)| Subject { name, label_prefix: prefixes.get(i).cloned().unwrap_or_default() })
        .collect()
}

pub(crate) fn events(parameters: &Parameters) -> Vec<Event> {
    let labels = parameters.long_texts("EVENT", "LABELS");
    let contexts = parameters.long_texts("EVENT", "CONTEXTS");
    let times = parameters.get("EVENT", "TIMES");
    let n_described = labels.len().max(contexts.len());
    let n_events = parameters.count("EVENT", "USED").map_or(n_described, |n| n_described.min(n as usize));
    let text = |texts: &[String], i: usize| texts.get(i).cloned().unwrap_or_default();
    // TIMES is a table of two rows: minutes and seconds.
    let time_secs = |i: usize| Some(times?.number(2 * i)? * 60.0 + times?.number(2 * i + 1)?);
    (0..n_events)
        .map(|i| Event { label: text(&labels, i), context: text(&contexts, i), time_secs: time_secs(i) })
        .collect()
}

/// Channels are what `ANALOG:USED` says if that divides the words of a frame, or else what the header's samples do.
pub(crate) fn analog(parameters: &Parameters, analog_words: u64, header_samples: u16) -> Analog {
    let used = parameters.count("ANALOG", "USED").filter(|&n| n > 0 && analog_words.is_multiple_of(n));
    let n_channels = used.unwrap_or(analog_words / u64::from(header_samples.max(1)));
    let n_samples_per_frame = analog_words.checked_div(n_channels).unwrap_or(0) as usize;
    let n_channels = if analog_words == 0 { 0 } else { n_channels as usize };
    let mut labels = parameters.long_texts("ANALOG", "LABELS");
    labels.truncate(n_channels);
    Analog { n_channels, n_samples_per_frame, labels }
}

pub(crate) fn rotations(parameters: &Parameters) -> Rotations {
    let n_rotations = parameters.count("ROTATION", "USED").unwrap_or(0) as usize;
    let mut labels = parameters.long_texts("ROTATION", "LABELS");
    labels.truncate(n_rotations);
    Rotations { n_rotations, labels }
}

pub(crate) fn labels_and_kinds(parameters: &Parameters, n_points: usize) -> (Vec<String>, Vec<PointKind>) {
    let mut labels = parameters.long_texts("POINT", "LABELS");
    labels.truncate(n_points);
    let kinds = label::kinds(parameters, &labels, n_points);
    (labels, kinds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Group, Parameter, Value};

    fn group(name: &str, parameters: &[(&str, &[u8], Value)]) -> Parameters {
        let parameter = |(name, dimensions, value): &(&str, &[u8], Value)| Parameter {
            name: (*name).into(),
            description: String::new(),
            locked: false,
            dimensions: dimensions.to_vec(),
            value: value.clone(),
        };
        let parameters = parameters.iter().map(parameter).collect();
        Parameters { groups: vec![Group { name: name.into(), parameters, ..Group::default() }] }
    }

    fn text(letters: &str) -> Value {
        Value::Text(letters.as_bytes().to_vec())
    }

    #[test]
    fn events_are_as_many_as_are_described() {
        let found = events(&group(
            "EVENT",
            &[
                ("USED", &[], Value::Integers(vec![9])),
                ("LABELS", &[4, 2], text("Off On  ")),
                ("CONTEXTS", &[5, 1], text("Left ")),
                ("TIMES", &[2, 1], Value::Floats(vec![1.0, 2.5])),
            ],
        ));
        let event = |label: &str, context: &str, time_secs| Event {
            label: label.into(),
            context: context.into(),
            time_secs,
        };
        assert_eq!(found, [event("Off", "Left", Some(62.5)), event("On", "", None)]);
    }

    #[test]
    fn channels_by_what_divides_the_words() {
        let used = |n| group("ANALOG", &[("USED", &[], Value::Integers(vec![n]))]);
        let channels = |found: Analog| (found.n_channels, found.n_samples_per_frame);
        assert_eq!(channels(analog(&used(16), 112, 1)), (16, 7));
        assert_eq!(channels(analog(&used(15), 112, 7)), (16, 7));
        assert_eq!(channels(analog(&Parameters::default(), 6, 0)), (6, 1));
        assert_eq!(channels(analog(&used(3), 0, 5)), (0, 0));
    }

    #[test]
    fn who_wrote_the_file() {
        let both =
            group("MANUFACTURER", &[("COMPANY", &[5], text("Vicon")), ("SOFTWARE", &[6], text("Nexus "))]);
        assert_eq!(manufacturer(&both).as_deref(), Some("Vicon Nexus"));
        assert_eq!(manufacturer(&Parameters::default()), None);
    }
}

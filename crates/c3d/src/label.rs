use crate::parameter::Parameters;
use std::collections::BTreeMap;

/// What a point is, as far as the parameters say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PointKind {
    /// A marker, or something that no parameter names.
    Marker,
    /// A marker that the system computed (`POINT:MODELED_MARKERS`).
    ModeledMarker,
    /// Joint angles (`POINT:ANGLES`).
    Angle,
    /// A force (`POINT:FORCES`).
    Force,
    /// A moment (`POINT:MOMENTS`).
    Moment,
    /// A power (`POINT:POWERS`).
    Power,
    /// A single number (`POINT:SCALARS`).
    Scalar,
    /// Force, moment and point of application (`POINT:REACTIONS`).
    Reaction,
    /// Of a group that the file itself adds to its `POINT:TYPE_GROUPS`.
    Other,
}

impl PointKind {
    /// Whether it can be a position in space.
    pub fn is_marker(self) -> bool {
        matches!(self, Self::Marker | Self::ModeledMarker)
    }
}

/// The parameters of `POINT` that list points of one kind.
const KINDS: [(&str, PointKind); 7] = [
    ("MODELED_MARKERS", PointKind::ModeledMarker),
    ("ANGLES", PointKind::Angle),
    ("FORCES", PointKind::Force),
    ("MOMENTS", PointKind::Moment),
    ("POWERS", PointKind::Power),
    ("SCALARS", PointKind::Scalar),
    ("REACTIONS", PointKind::Reaction),
];

/// The kind of each of `n_points` points.
pub(crate) fn kinds(parameters: &Parameters, labels: &[String], n_points: usize) -> Vec<PointKind> {
    let mut kind_by_label: BTreeMap<&str, Option<PointKind>> =
        labels.iter().map(|l| (l.as_str(), None)).collect();
    let known = KINDS.map(|(name, kind)| (name.to_owned(), kind));
    for (name, kind) in known.into_iter().chain(own_kinds(parameters)) {
        for label in parameters.long_texts("POINT", &name) {
            // A blank entry names no point, least of all those without a label.
            if let Some(found) = kind_by_label.get_mut(label.as_str()).filter(|_| !label.is_empty()) {
                found.get_or_insert(kind);
            }
        }
    }
    let kind = |i: usize| labels.get(i).and_then(|l| kind_by_label[l.as_str()]).unwrap_or(PointKind::Marker);
    (0..n_points).map(kind).collect()
}

/// Kinds that the file invents: `POINT:TYPE_GROUPS` lists pairs of parameter name and title.
fn own_kinds(parameters: &Parameters) -> impl Iterator<Item = (String, PointKind)> {
    let names = parameters.texts("POINT", "TYPE_GROUPS").into_iter().step_by(2).take(MAX_OWN_KINDS);
    names
        .filter(|name| !NOT_A_KIND.contains(&name.to_ascii_uppercase().as_str()))
        .map(|n| (n, PointKind::Other))
}

/// Parameters of `POINT` that list labels of every kind.
const NOT_A_KIND: [&str; 3] = ["", "LABELS", "DESCRIPTIONS"];
/// Entries of one array; more would be no table of pairs.
const MAX_OWN_KINDS: usize = 255;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Group, Parameter, Value};

    #[test]
    fn a_point_is_what_the_first_list_that_has_it_says() {
        let list = |name: &str, labels: &str| Parameter {
            name: name.into(),
            description: String::new(),
            locked: false,
            dimensions: vec![4, (labels.len() / 4) as u8],
            value: Value::Text(labels.as_bytes().to_vec()),
        };
        let lists = vec![
            list("TYPE_GROUPS", "ODD Odd "),
            list("ODD", "CoM Hip "),
            list("ANGLES", "Hip     "),
            list("ANGLES2", "KneeLFHD"),
        ];
        let group = Group { name: "POINT".into(), parameters: lists, ..Group::default() };
        let labels = ["LFHX", "Hip", "Knee", "CoM", ""].map(str::to_owned);
        let found = kinds(&Parameters { groups: vec![group] }, &labels, 6);
        use PointKind::{Angle, Marker, Other};
        let expected = [Marker, Angle, Angle, Other, Marker, Marker];
        assert_eq!(found, expected);
    }
}

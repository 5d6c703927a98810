/// A marker's label, taken apart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Label {
    /// The subject's prefix, if it has one.
    pub subject: Option<String>,
    /// The marker's name; begins with `*` where nobody named it.
    pub name: String,
}

impl Label {
    /// Takes the label of a point apart; a point without one gets a name from its index.
    ///
    /// `Wig:LFHD` is the subject's `LFHD`. `Unlabeled 2278` is nobody's, `*2278` in the manner of C3D.
    pub fn of(point_idx: usize, label: Option<&str>) -> Self {
        let label = label.unwrap_or_default().trim();
        if label.is_empty() {
            return Self { subject: None, name: format!("*unnamed {}", point_idx + 1) };
        }
        if let Some(number) = unlabeled_number(label) {
            return Self { subject: None, name: format!("*{number}") };
        }
        match label.split_once(':') {
            Some((subject, name)) if !subject.trim().is_empty() && !name.trim().is_empty() => {
                Self { subject: Some(subject.trim().to_owned()), name: name.trim().to_owned() }
            }
            _ => Self { subject: None, name: label.to_owned() },
        }
    }

    /// Whether nobody named the marker.
    pub fn is_unlabeled(&self) -> bool {
        self.name.starts_with('*')
    }
}

/// The number of `Unlabeled 2278`, `Unlabeled:105`, `unlabelled_3`.
fn unlabeled_number(label: &str) -> Option<&str> {
    const WORDS: [&str; 2] = ["unlabelled", "unlabeled"];
    let start = |word: &&str| label.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
    let word = WORDS.into_iter().find(start)?;
    let number = label[word.len()..].trim_start_matches([' ', ':', '_', '-']);
    (!number.is_empty() && number.bytes().all(|b| b.is_ascii_digit())).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_of_every_system() {
        let check = |label: &str, subject: Option<&str>, name: &str| {
            let found = Label::of(4, Some(label));
            assert_eq!((found.subject.as_deref(), found.name.as_str()), (subject, name), "{label}");
        };
        check("Wig:S01_1", Some("Wig"), "S01_1");
        check(" Rigid Body 1:Marker3 ", Some("Rigid Body 1"), "Marker3");
        check("R.Heel", None, "R.Heel");
        check("*12", None, "*12");
        check("Wig:*12", Some("Wig"), "*12");
        check("Unlabeled 2278", None, "*2278");
        check("Unlabeled:105", None, "*105");
        check("Unlabeled thing", None, "Unlabeled thing");
        check(":odd", None, ":odd");
        check("", None, "*unnamed 5");
    }
}

use crate::escape;

/// One number worth a card: what it is, how much, and how it came about.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// What the number is.
    pub label: String,
    /// The number, ready to read.
    pub value: String,
    /// Its unit; empty for none.
    pub unit: String,
    /// How it came about or what to compare it with; empty for none.
    pub note: String,
}

/// The figures as a row of cards.
pub fn figure_cards(figures: &[Figure]) -> String {
    let cards: String = figures.iter().map(card).collect();
    format!("<dl class=\"figures\">\n{cards}</dl>\n")
}

fn card(figure: &Figure) -> String {
    let unit = match figure.unit.as_str() {
        "" => String::new(),
        unit => format!("<span class=\"unit\">{}</span>", escape(unit)),
    };
    let note = match figure.note.as_str() {
        "" => String::new(),
        note => format!("<dd class=\"note\">{}</dd>", escape(note)),
    };
    format!(
        "<div class=\"figure\"><dt>{}</dt><dd class=\"value\">{}{unit}</dd>{note}</div>\n",
        escape(&figure.label),
        escape(&figure.value)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_card_says_what_how_much_and_why() {
        let figure =
            Figure { label: "error".into(), value: "3.2".into(), unit: "mm".into(), note: "<5".into() };
        assert_eq!(
            card(&figure),
            "<div class=\"figure\"><dt>error</dt><dd class=\"value\">3.2<span class=\"unit\">mm</span></dd>\
             <dd class=\"note\">&lt;5</dd></div>\n"
        );
        assert!(!card(&Figure::default()).contains("note"));
    }
}

//! Figures in rows and columns, for the terminal, spreadsheets, programs and pages.

use serde::Serialize;
use std::fmt::Write as _;

/// Rows of figures under named columns.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// What the table shows.
    pub title: String,
    /// The columns' names, with units.
    pub columns: Vec<String>,
    /// The rows, each as long as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

/// One cell of a [`Table`].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A figure.
    Number {
        /// The figure itself.
        value: f64,
        /// How many decimals people are shown; files get every digit.
        #[serde(skip)]
        decimals: usize,
    },
    /// Not measured.
    Missing,
}

impl Table {
    /// An empty table.
    pub fn new(title: &str, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|c| (*c).to_owned()).collect();
        Self { title: title.to_owned(), columns, rows: Vec::new() }
    }

    /// Appends a row.
    ///
    /// # Panics
    /// If the row is not as long as there are columns.
    pub fn push(&mut self, row: Vec<Cell>) {
        assert_eq!(row.len(), self.columns.len(), "a row of `{}`", self.title);
        self.rows.push(row);
    }

    /// Aligned columns under the title: words to the left, figures to the right.
    pub fn to_text(&self) -> String {
        let widths = self.widths();
        let mut text = format!("{}\n", self.title);
        let mut line = |cells: &[(String, bool)]| {
            let mut row = String::new();
            for ((cell, left), width) in cells.iter().zip(&widths) {
                let pad = " ".repeat(width - cell.chars().count());
                let _ = if *left { write!(row, "  {cell}{pad}") } else { write!(row, "  {pad}{cell}") };
            }
            text.push_str(row.trim_end());
            text.push('\n');
        };
        line(
            &self
                .columns
                .iter()
                .enumerate()
                .map(|(c, name)| (name.clone(), self.is_words(c)))
                .collect::<Vec<_>>(),
        );
        for row in &self.rows {
            line(
                &row.iter().map(|cell| (cell.to_string(), matches!(cell, Cell::Text(_)))).collect::<Vec<_>>(),
            );
        }
        text
    }

    /// A row of names and one line a row, comma separated, quoted where need be; figures with every digit.
    pub fn to_csv(&self) -> String {
        let mut csv = String::new();
        let mut line = |cells: Vec<String>| {
            csv.push_str(&cells.join(","));
            csv.push('\n');
        };
        line(self.columns.iter().map(|c| csv_field(c)).collect());
        for row in &self.rows {
            line(row.iter().map(Cell::to_csv).collect());
        }
        csv
    }

    /// A `<table>` with the title as its caption.
    pub fn to_html(&self) -> String {
        let mut html = format!("<table>\n<caption>{}</caption>\n<thead><tr>", escape(&self.title));
        for (c, name) in self.columns.iter().enumerate() {
            let class = if self.is_words(c) { "" } else { " class=\"n\"" };
            let _ = write!(html, "<th{class}>{}</th>", escape(name));
        }
        html.push_str("</tr></thead>\n<tbody>\n");
        for row in &self.rows {
            html.push_str("<tr>");
            for cell in row {
                let class = if matches!(cell, Cell::Text(_)) { "" } else { " class=\"n\"" };
                let _ = write!(html, "<td{class}>{}</td>", escape(&cell.to_string()));
            }
            html.push_str("</tr>\n");
        }
        html.push_str("</tbody>\n</table>\n");
        html
    }

    fn is_words(&self, column: usize) -> bool {
        self.rows.iter().any(|row| matches!(row[column], Cell::Text(_)))
    }

    fn widths(&self) -> Vec<usize> {
        let width = |(c, name): (usize, &String)| {
            let cells = self.rows.iter().map(|row| row[c].to_string().chars().count());
            cells.chain([name.chars().count()]).max().unwrap_or(0)
        };
        self.columns.iter().enumerate().map(width).collect()
    }
}

impl Cell {
    /// Words.
    pub fn text(words: impl Into<String>) -> Self {
        Self::Text(words.into())
    }

    /// A figure and how many decimals people are shown; what is not finite was not measured.
    pub fn number(value: f64, decimals: usize) -> Self {
        if value.is_finite() { Self::Number { value, decimals } } else { Self::Missing }
    }

    /// A figure if there is one.
    pub fn maybe(value: Option<f64>, decimals: usize) -> Self {
        value.map_or(Self::Missing, |value| Self::number(value, decimals))
    }

    fn to_csv(&self) -> String {
        match self {
            Self::Text(words) => csv_field(words),
            Self::Number { value, .. } => value.to_string(),
            Self::Missing => String::new(),
        }
    }
}

impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text(words) => f.write_str(words),
            Self::Number { value, decimals } => write!(f, "{value:.decimals$}"),
            Self::Missing => f.write_str("–"),
        }
    }
}

fn csv_field(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}

/// Text made fit to stand in HTML and SVG.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new("error", &["method, name", "mean mm"]);
        table.push(vec![Cell::text("paper"), Cell::number(25.64, 1)]);
        table.push(vec![Cell::text("a \"new\" <one>"), Cell::maybe(None, 1)]);
        table
    }

    #[test]
    fn people_see_aligned_columns() {
        let expected =
            "error\n  method, name   mean mm\n  paper             25.6\n  a \"new\" <one>        –\n";
        assert_eq!(table().to_text(), expected);
    }

    #[test]
    fn files_get_every_digit() {
        assert_eq!(table().to_csv(), "\"method, name\",mean mm\npaper,25.64\n\"a \"\"new\"\" <one>\",\n");
    }

    #[test]
    fn pages_get_escaped_words() {
        let html = table().to_html();
        assert!(html.contains("<td>a &quot;new&quot; &lt;one&gt;</td><td class=\"n\">–</td>"), "{html}");
    }

    #[test]
    fn what_is_not_a_number_was_not_measured() {
        assert_eq!(Cell::number(f64::NAN, 2), Cell::Missing);
    }
}

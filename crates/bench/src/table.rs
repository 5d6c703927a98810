//! Figures in rows and columns, for the terminal, spreadsheets, programs and pages.

use serde::Serialize;

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
                let (before, after) = if *left { ("", pad.as_str()) } else { (pad.as_str(), "") };
                row.extend(["  ", before, cell, after]);
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

    /// The table for a page.
    pub fn to_page(&self) -> tousle_page::Table {
        let column = |(c, name): (usize, &String)| match self.is_words(c) {
            true => tousle_page::Column::text(name),
            false => tousle_page::Column::number(name, ""),
        };
        tousle_page::Table {
            caption: self.title.clone(),
            columns: self.columns.iter().enumerate().map(column).collect(),
            rows: self.rows.iter().map(|row| row.iter().map(Cell::to_page).collect()).collect(),
        }
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

    fn to_page(&self) -> tousle_page::Cell {
        match self {
            Self::Text(words) => tousle_page::Cell::Text(words.clone()),
            Self::Number { value, decimals } => {
                tousle_page::Cell::Number(tousle_page::decimals(*value, *decimals))
            }
            Self::Missing => tousle_page::Cell::Number(self.to_string()),
        }
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
    fn pages_get_words_to_the_left_and_figures_to_the_right() {
        let page = table().to_page();
        assert_eq!(page.columns.iter().map(|c| c.numeric).collect::<Vec<_>>(), [false, true]);
        assert_eq!(page.rows[0][1], tousle_page::Cell::Number("25.6".into()));
    }

    #[test]
    fn what_is_not_a_number_was_not_measured() {
        assert_eq!(Cell::number(f64::NAN, 2), Cell::Missing);
    }
}

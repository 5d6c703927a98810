use crate::escape;

/// A table of a page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// What the table shows, above it; empty for none.
    pub caption: String,
    /// The columns.
    pub columns: Vec<Column>,
    /// The rows; each has as many cells as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

/// A column's heading.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// What is in the column.
    pub title: String,
    /// The unit of its numbers; empty for none.
    pub unit: String,
    /// Whether numbers stand in it, which are set to the right.
    pub numeric: bool,
}

/// What a cell holds.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A name in a file: a path, a label.
    Code(String),
    /// A number, ready to read.
    Number(String),
    /// A share of 1, drawn as a bar with its percentage.
    Share(f64),
}

impl Column {
    /// A column of words.
    pub fn text(title: &str) -> Self {
        Self { title: title.to_owned(), ..Self::default() }
    }

    /// A column of numbers.
    pub fn number(title: &str, unit: &str) -> Self {
        Self { title: title.to_owned(), unit: unit.to_owned(), numeric: true }
    }
}

impl Table {
    /// The table as HTML, in a frame that scrolls sideways where the page is too narrow for it.
    pub fn html(&self) -> String {
        let caption = match self.caption.as_str() {
            "" => String::new(),
            caption => format!("<caption>{}</caption>\n", escape(caption)),
        };
        let head: String = self.columns.iter().map(heading).collect();
        let rows: String = self.rows.iter().map(|row| self.row(row)).collect();
        format!(
            "<div class=\"table\"><table>\n{caption}<thead><tr>{head}</tr></thead>\n<tbody>\n{rows}</tbody>\n\
             </table></div>\n"
        )
    }

    fn row(&self, row: &[Cell]) -> String {
        let cells: String = row.iter().map(Cell::html).collect();
        format!("<tr>{cells}</tr>\n")
    }
}

fn heading(column: &Column) -> String {
    let class = if column.numeric { " class=\"number\"" } else { "" };
    let unit = match column.unit.as_str() {
        "" => String::new(),
        unit => format!(" <span class=\"unit\">{}</span>", escape(unit)),
    };
    format!("<th scope=\"col\"{class}>{}{unit}</th>", escape(&column.title))
}

impl Cell {
    fn html(&self) -> String {
        match self {
            Self::Text(text) => format!("<td>{}</td>", escape(text)),
            Self::Code(text) => format!("<td><code>{}</code></td>", escape(text)),
            Self::Number(text) => format!("<td class=\"number\">{}</td>", escape(text)),
            Self::Share(share) => {
                let percent = 100.0 * share.clamp(0.0, 1.0);
                format!(
                    "<td class=\"number share\"><span class=\"bar\" style=\"--share:{percent:.1}%\"></span>\
                     {percent:.1} %</td>"
                )
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_keep_their_kind_and_are_escaped() {
        let table = Table {
            caption: String::new(),
            columns: vec![Column::text("lock"), Column::number("length", "mm")],
            rows: vec![vec![Cell::Code("<S01>".into()), Cell::Number("175".into())]],
        };
        let html = table.html();
        assert!(
            html.contains("<th scope=\"col\" class=\"number\">length <span class=\"unit\">mm</span></th>")
        );
        assert!(html.contains("<tr><td><code>&lt;S01&gt;</code></td><td class=\"number\">175</td></tr>"));
    }

    #[test]
    fn a_share_beyond_one_does_not_leave_its_cell() {
        assert!(Cell::Share(1.7).html().contains("--share:100.0%"));
    }
}

//! What a part of the bench found, as text, as files and as a page: the same for all parts.

use crate::Table;
use tousle_page::{PLOT_STYLE, Plot, Shell, escape};

/// What a part of the bench found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The name of its page, without an ending.
    pub name: &'static str,
    /// Its title.
    pub title: String,
    /// What it is about, and words to read it by.
    pub words: String,
    /// What it found, part by part.
    pub sections: Vec<Section>,
    /// All figures for programs, as JSON, where there are such.
    pub json: Option<String>,
}

/// Tables and plots of one thing that was measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Section {
    /// What its files begin with.
    pub name: String,
    /// Its title; empty where the report's says it.
    pub title: String,
    /// What was measured, and how.
    pub words: String,
    /// Tables, each with a name within the section; empty for the only or first one.
    pub tables: Vec<(String, Table)>,
    /// Plots, likewise.
    pub plots: Vec<(String, Plot)>,
}

/// Headings, and pictures with room around them.
pub(crate) const STYLES: [&str; 2] = [PLOT_STYLE, "h2 { margin: 48px 0 8px; }\n.plot { margin: 24px 0; }\n"];

impl Report {
    /// All tables but empty ones, as a terminal shows them; what is nothing but plots is left out.
    pub fn to_text(&self) -> String {
        let is_to_be_read = |section: &&Section| !section.tables.is_empty() || section.plots.is_empty();
        self.sections.iter().filter(is_to_be_read).map(Section::to_text).collect::<Vec<_>>().join("\n")
    }

    /// Every table as CSV and every plot as SVG, the figures for programs, and the page, each with its file's name.
    /// `measured` says on what machine and when.
    pub fn files(&self, measured: &str) -> Vec<(String, String)> {
        let mut files: Vec<(String, String)> = self.sections.iter().flat_map(Section::files).collect();
        files.extend(self.json.iter().map(|json| (format!("{}.json", self.name), json.clone())));
        files.push((self.page_name(), self.to_html(measured)));
        files
    }

    /// The name of the page's file.
    pub fn page_name(&self) -> String {
        format!("{}.html", self.name)
    }

    /// The file and the title of every table.
    pub(crate) fn tables(&self) -> impl Iterator<Item = (String, &str)> {
        self.sections.iter().flat_map(|section| {
            section.tables.iter().map(|(name, table)| (section.file_name(name, "csv"), table.title.as_str()))
        })
    }

    fn to_html(&self, measured: &str) -> String {
        let sections: String = self.sections.iter().map(Section::html).collect();
        let body = format!(
            "<main>\n<h1>{}</h1>\n<p>{} {}</p>\n{sections}</main>\n",
            escape(&self.title),
            escape(&self.words),
            escape(measured)
        );
        let title = format!("tousle bench: {}", self.title);
        Shell { title: &title, styles: &STYLES, body, ..Shell::default() }.html()
    }
}

impl Section {
    /// The file of a table or plot: the section's name, its own within it, an ending.
    fn file_name(&self, name: &str, ending: &str) -> String {
        let dash = if name.is_empty() { "" } else { "-" };
        format!("{}{dash}{name}.{ending}", self.name)
    }

    /// The plots as a page has them, each under its title.
    pub(crate) fn plots_html(&self) -> String {
        let plot = |(_, plot): &(String, Plot)| format!("<h3>{}</h3>\n{}", escape(&plot.title), plot.svg());
        self.plots.iter().map(plot).collect()
    }

    fn to_text(&self) -> String {
        let words = [&self.title, &self.words].into_iter().filter(|words| !words.is_empty());
        let words: String = words.map(|words| format!("{words}\n")).collect();
        let tables = self.tables.iter().filter(|(_, table)| !table.rows.is_empty());
        let tables: Vec<String> = tables.map(|(_, table)| table.to_text()).collect();
        let gap = if words.is_empty() || tables.is_empty() { "" } else { "\n" };
        format!("{words}{gap}{}", tables.join("\n"))
    }

    fn files(&self) -> Vec<(String, String)> {
        let tables = self.tables.iter().map(|(name, table)| (self.file_name(name, "csv"), table.to_csv()));
        let plots =
            self.plots.iter().map(|(name, plot)| (self.file_name(name, "svg"), plot.standalone_svg()));
        tables.chain(plots).collect()
    }

    fn html(&self) -> String {
        let title = match self.title.as_str() {
            "" => String::new(),
            title => format!("<h2>{}</h2>\n", escape(title)),
        };
        let words = match self.words.as_str() {
            "" => String::new(),
            words => format!("<p>{}</p>\n", escape(words)),
        };
        let tables: String = self.tables.iter().map(|(_, table)| table.to_page().html()).collect();
        format!("{title}{words}{}{tables}", self.plots_html())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cell;

    fn report() -> Report {
        let mut table = Table::new("errors", &["mm"]);
        table.push(vec![Cell::number(1.0, 1)]);
        let empty = Table::new("nothing", &["mm"]);
        let plot = Plot { title: "a<b".into(), ..Plot::default() };
        let section = Section {
            name: "sim-truth".into(),
            title: "Truth".into(),
            words: "In its wind.".into(),
            tables: vec![(String::new(), table), ("more".into(), empty)],
            plots: vec![("gusts".into(), plot)],
        };
        let sections = vec![
            section.clone(),
            Section { name: "sim-order".into(), title: "Order".into(), tables: Vec::new(), ..section },
        ];
        let json = Some("{}".to_owned());
        Report { name: "sim", title: "Judged".into(), sections, json, ..Report::default() }
    }

    #[test]
    fn everything_has_its_file() {
        let files = report().files("on 2 cores");
        let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names,
            [
                "sim-truth.csv",
                "sim-truth-more.csv",
                "sim-truth-gusts.svg",
                "sim-order-gusts.svg",
                "sim.json",
                "sim.html"
            ]
        );
        let page = &files[5].1;
        assert!(page.contains("a&lt;b") && page.contains("on 2 cores") && page.contains("<svg"), "{page}");
    }

    #[test]
    fn a_terminal_is_spared_empty_tables_and_plots() {
        assert_eq!(report().to_text(), "Truth\nIn its wind.\n\nerrors\n   mm\n  1.0\n");
    }
}

use crate::{Table, WorkPrecision};
use tousle_page::{PLOT_STYLE, Shell, escape};

/// What the bench found, part by part.
#[derive(Clone, Debug, PartialEq)]
pub struct SimBenchReport {
    /// One a part.
    pub sections: Vec<Section>,
}

/// What a part found.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// The part's name, which its files begin with.
    pub name: &'static str,
    /// Its title.
    pub title: String,
    /// What was measured, and how.
    pub words: String,
    /// Tables, each with a name within the part; empty for the only or first one.
    pub tables: Vec<(String, Table)>,
    /// Diagrams, likewise.
    pub diagrams: Vec<(String, WorkPrecision)>,
}

impl SimBenchReport {
    /// All tables, as a terminal shows them.
    pub fn to_text(&self) -> String {
        let of = |section: &Section| {
            let tables = section.tables.iter().map(|(_, table)| table.to_text());
            let diagrams = section.diagrams.iter().map(|(_, diagram)| diagram.to_table().to_text());
            let figures: Vec<String> = match section.tables.is_empty() {
                true => diagrams.collect(),
                false => tables.collect(),
            };
            format!("{}\n{}\n\n{}", section.title, section.words, figures.join("\n"))
        };
        self.sections.iter().map(of).collect::<Vec<_>>().join("\n")
    }

    /// Every table as CSV and every diagram as SVG and CSV, each with its file's name: `sim-PART[-NAME].csv`.
    pub fn files(&self) -> Vec<(String, String)> {
        let mut files = Vec::new();
        for section in &self.sections {
            let file = |name: &str, end: &str| {
                let dash = if name.is_empty() { "" } else { "-" };
                format!("sim-{}{dash}{name}.{end}", section.name)
            };
            for (name, table) in &section.tables {
                files.push((file(name, "csv"), table.to_csv()));
            }
            for (name, diagram) in &section.diagrams {
                files.push((file(name, "svg"), diagram.to_plot().standalone_svg()));
                // Where a part has tables, they hold what its diagrams show.
                if section.tables.is_empty() {
                    files.push((file(name, "csv"), diagram.to_table().to_csv()));
                }
            }
        }
        files
    }

    /// A page of its own with all of it. `measured` says on what machine and when.
    pub fn to_html(&self, measured: &str) -> String {
        let sections: String = self.sections.iter().map(Section::html).collect();
        let body = format!(
            "<main>\n<h1>The simulator, judged</h1>\n<p>Every integrator that it offers, each by its name; those of the \
             paper's method begin with <i>paper</i>. {}</p>\n{sections}</main>\n",
            escape(measured)
        );
        Shell { title: "tousle bench sim", styles: &[PLOT_STYLE, STYLE], body, ..Shell::default() }.html()
    }
}

/// Headings, and pictures with room around them.
const STYLE: &str = "h2 { margin: 48px 0 8px; }\n.plot { margin: 24px 0; }\n";

impl Section {
    fn html(&self) -> String {
        let plots: String = self
            .diagrams
            .iter()
            .map(|(_, diagram)| format!("<h3>{}</h3>\n{}", escape(&diagram.title), diagram.to_plot().svg()))
            .collect();
        let tables = self.tables.iter().map(|(_, table)| table.to_page().html());
        let of_diagrams = self.diagrams.iter().map(|(_, diagram)| diagram.to_table().to_page().html());
        let tables: String = if self.tables.is_empty() { of_diagrams.collect() } else { tables.collect() };
        format!("<h2>{}</h2>\n<p>{}</p>\n{plots}{tables}", escape(&self.title), escape(&self.words))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, Curve, CurvePoint};

    #[test]
    fn every_table_and_diagram_has_its_file() {
        let mut table = Table::new("errors", &["mm"]);
        table.push(vec![Cell::number(1.0, 1)]);
        let diagram = WorkPrecision {
            title: "trade".into(),
            cost: "s".into(),
            error: "mm".into(),
            curves: vec![Curve {
                points: vec![CurvePoint { setting: "60/s".into(), cost: 1.0, error: 1.0 }],
                ..Curve::named("a<b".into())
            }],
        };
        let section = |tables| Section {
            name: "truth",
            title: "Truth".into(),
            words: String::new(),
            tables,
            diagrams: vec![("gusts".into(), diagram.clone())],
        };
        let report =
            SimBenchReport { sections: vec![section(vec![(String::new(), table)]), section(Vec::new())] };
        let names: Vec<String> = report.files().into_iter().map(|(name, _)| name).collect();
        assert_eq!(
            names,
            ["sim-truth.csv", "sim-truth-gusts.svg", "sim-truth-gusts.svg", "sim-truth-gusts.csv"]
        );
        let page = report.to_html("on 2 cores");
        assert!(page.contains("a&lt;b") && page.contains("on 2 cores") && page.contains("<svg"));
    }
}

//! One page over all parts of the bench: what became of each, its plots, and the way to its page and tables.

use crate::report::STYLES;
use crate::{Cell, Report, Section, Table};
use tousle_page::{Shell, escape};

/// A part of the bench, and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct PartRun {
    /// The part's name: `wind`.
    pub name: &'static str,
    /// How long it took, s.
    pub wall_secs: f64,
    /// How it ended.
    pub ending: Ending,
}

/// How a part ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// With what it found.
    Done(Report),
    /// Not: what failed and, line by line, why.
    Failed(String),
    /// It could not be run with what was given, and what it needs.
    Skipped(String),
}

/// The page. Pages and tables that it leads to are beside it, as [`Report::files`] names them; plots are in it.
///
/// `measured` says on what machine and when.
pub fn index_html(parts: &[PartRun], measured: &str) -> String {
    let sections: String = parts.iter().map(PartRun::html).collect();
    let body = format!(
        "<main>\n<h1>Error against run time</h1>\n<p>{}</p>\n{}{sections}</main>\n",
        escape(measured),
        overview(parts).to_page().html(),
    );
    Shell { title: "tousle bench", styles: &STYLES, body, ..Shell::default() }.html()
}

fn overview(parts: &[PartRun]) -> Table {
    let mut table = Table::new("The parts", &["part", "", "wall s"]);
    for part in parts {
        let (state, secs) = match &part.ending {
            Ending::Done(_) => ("done", part.wall_secs),
            Ending::Failed(_) => ("failed", part.wall_secs),
            Ending::Skipped(_) => ("skipped", f64::NAN),
        };
        table.push(vec![Cell::text(part.name), Cell::text(state), Cell::number(secs, 1)]);
    }
    table
}

impl PartRun {
    fn html(&self) -> String {
        let without = |state: &str, why: &str| {
            format!(
                "<h2>{}: {state}</h2>\n<p>{}</p>\n",
                escape(self.name),
                escape(why).replace('\n', "<br>\n")
            )
        };
        match &self.ending {
            Ending::Done(report) => done(report),
            Ending::Failed(why) => without("failed", why),
            Ending::Skipped(why) => without("skipped", why),
        }
    }
}

/// A part's title, which leads to its page; its words, its tables as files, what of it there is not, and its plots.
fn done(report: &Report) -> String {
    let is_missing = |section: &&Section| section.tables.is_empty() && section.plots.is_empty();
    let told = |section: &Section| format!("<p>{}: {}</p>\n", escape(&section.title), escape(&section.words));
    let missing: String = report.sections.iter().filter(is_missing).map(told).collect();
    let plots: String = report.sections.iter().map(Section::plots_html).collect();
    let tables: Vec<String> = report.tables().map(|(file, title)| link(&file, title)).collect();
    format!(
        "<h2>{}</h2>\n<p>{}</p>\n<p>Tables: {}.</p>\n{missing}{plots}",
        link(&report.page_name(), &report.title),
        escape(&report.words),
        tables.join(", ")
    )
}

fn link(file: &str, words: &str) -> String {
    format!("<a href=\"{}\">{}</a>", escape(file), escape(words))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_page::Plot;

    fn parts() -> Vec<PartRun> {
        let section = Section {
            name: "wind".into(),
            tables: vec![(String::new(), Table::new("every run", &["mm"]))],
            plots: vec![(String::new(), Plot { title: "a<b".into(), ..Plot::default() })],
            ..Section::default()
        };
        let missing =
            Section { title: "Truth".into(), words: "skipped, <alas>".into(), ..Section::default() };
        let sections = vec![section, missing];
        let report = Report { name: "wind", title: "The wind".into(), sections, ..Report::default() };
        let part = |name, ending| PartRun { name, wall_secs: 1.25, ending };
        vec![
            part("wind", Ending::Done(report)),
            part("file", Ending::Failed("cannot read <f>\nbecause it is not there".into())),
            part("paper", Ending::Skipped("needs --captures".into())),
        ]
    }

    /// Every link leads to a file that the part writes, plots are in the page, and what is not there is named.
    #[test]
    fn all_parts_are_on_the_page() {
        let page = index_html(&parts(), "on 2 cores");
        let Ending::Done(report) = &parts()[0].ending else { panic!("expected a report") };
        let files: Vec<String> = report.files("").into_iter().map(|(name, _)| name).collect();
        let links: Vec<&str> =
            page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        assert_eq!(links, ["wind.html", "wind.csv"]);
        assert!(links.iter().all(|link| files.iter().any(|file| file == link)), "{files:?}");
        assert!(page.contains("on 2 cores") && page.contains("a&lt;b") && page.contains("<svg"));
        assert!(page.contains("<p>Truth: skipped, &lt;alas&gt;</p>"), "{page}");
        assert!(page.contains("cannot read &lt;f&gt;<br>") && page.contains("needs --captures"));
    }
}

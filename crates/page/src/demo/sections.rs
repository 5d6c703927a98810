use super::{DemoPage, FileEntry, PageData, StageLine, captured};
use crate::{Cell, Column, Table, bytes_text, decimals, escape, figure_cards, short};
use std::fmt::Write;
use tousle_core::Assumption;

const HERO: &str = include_str!("../../assets/html/hero.html");
const FIELD: &str = include_str!("../../assets/html/field.html");
const PLAYER: &str = include_str!("../../assets/html/player.html");

/// The body of the page, without data and script.
pub(super) fn body_html(page: &DemoPage<'_>, data: &PageData, notes: &[String]) -> String {
    [
        hero(page),
        "<main>\n".to_owned(),
        figures(page),
        field(page, data),
        captured::section(page),
        made(page, notes),
        "</main>\n".to_owned(),
        PLAYER.to_owned(),
    ]
    .concat()
}

/// Fills `{name}` places of a template. What is put in is HTML already and is not searched again.
fn filled(template: &str, values: &[(&str, &str)]) -> String {
    let mut html = String::with_capacity(template.len());
    let mut rest = template;
    while let Some(start) = rest.find('{') {
        let (before, from) = rest.split_at(start);
        html.push_str(before);
        let end = from.find('}').map_or(from.len(), |end| end + 1);
        let name = from[..end].trim_matches(['{', '}']);
        match values.iter().find(|(known, _)| *known == name) {
            Some((_, value)) => html.push_str(value),
            None => html.push_str(&from[..end]),
        }
        rest = &from[end..];
    }
    html + rest
}

fn hero(page: &DemoPage<'_>) -> String {
    let intro: String = page.intro.iter().map(|line| format!("<p>{}</p>\n", escape(line))).collect();
    filled(HERO, &[("title", &escape(page.title)), ("intro", &intro)])
}

fn figures(page: &DemoPage<'_>) -> String {
    if page.figures.is_empty() {
        return String::new();
    }
    let cards = figure_cards(page.figures);
    format!(
        "<section id=\"numbers\">\n<p class=\"eyebrow\">Result</p>\n<h2>The numbers</h2>\n{cards}</section>\n"
    )
}

fn field(page: &DemoPage<'_>, data: &PageData) -> String {
    let grid = &page.field.grid;
    let [x, y, z] = grid.dims;
    let [outside, interpolated, measured] = data.wind.shares.map(|s| format!("{} %", decimals(100.0 * s, 1)));
    let facts = format!(
        "{x} × {y} × {z} voxels of {} mm, {} steps a second for {} s; {} in {}, head axes.",
        short(grid.edge_m * 1e3, 2),
        short(page.field.rate_hz, 2),
        decimals(page.field.end_secs() - page.field.start_secs, 2),
        page.field.quantity.name().replace('_', " "),
        page.field.quantity.unit(),
    );
    filled(
        FIELD,
        &[
            ("facts", &escape(&facts)),
            ("unit", page.field.quantity.unit()),
            ("outside", &outside),
            ("interpolated", &interpolated),
            ("measured", &measured),
            ("origins", origins(page.method)),
        ],
    )
}

/// What the flags of voxels without a marker mean, by the method that made the field (`docs/glossary.md`, "Flag").
fn origins(method: &str) -> &'static str {
    if method == "physical" {
        "Interpolated: no marker was in it, but the locks around narrowed down the air there. From outside: all else, \
         where the locks tell little of the air."
    } else {
        "Interpolated: from measured voxels around it. From outside: the fan's wind, perhaps bent towards what was \
         measured nearest."
    }
}

/// What was done, the files, and what a reader should know.
fn made(page: &DemoPage<'_>, notes: &[String]) -> String {
    let mut html =
        String::from("<section id=\"made\">\n<p class=\"eyebrow\">Run</p>\n<h2>What was done</h2>\n");
    html.push_str(&stages(page.stages));
    if !page.files.is_empty() {
        let folder = escape(page.folder);
        let _ = writeln!(html, "<h3>Files</h3>\n<p class=\"note\">In <code>{folder}</code></p>");
        html.push_str(&files(page.files).html());
    }
    if !notes.is_empty() {
        html.push_str("<h3>Worth knowing</h3>\n<ul class=\"notes\">\n");
        for note in notes {
            let _ = writeln!(html, "<li>{}</li>", escape(note));
        }
        html.push_str("</ul>\n");
    }
    html.push_str(&assumed(page));
    html.push_str("</section>\n");
    html
}

fn stages(stages: &[StageLine]) -> String {
    let slowest = stages.iter().filter_map(|s| s.secs).fold(0.0, f64::max);
    let mut html = String::from("<ol class=\"stages\">\n");
    for stage in stages {
        let _ = write!(html, "<li><b>{}</b><span>{}", escape(&stage.name), escape(&stage.text));
        if !stage.command.is_empty() {
            let _ = write!(html, "<code>{}</code>", escape(&stage.command));
        }
        html.push_str("</span>");
        if let Some(secs) = stage.secs {
            let share = if slowest > 0.0 { (100.0 * secs / slowest).clamp(0.0, 100.0) } else { 0.0 };
            let _ = write!(
                html,
                "<span class=\"secs\"><span class=\"bar\" style=\"--share:{share:.1}%\"></span>{} s</span>",
                decimals(secs, 2)
            );
        }
        html.push_str("</li>\n");
    }
    html.push_str("</ol>\n");
    html
}

fn files(files: &[FileEntry]) -> Table {
    let row = |file: &FileEntry| {
        vec![
            Cell::Code(file.name.clone()),
            Cell::Text(file.what.clone()),
            Cell::Number(bytes_text(file.bytes)),
        ]
    };
    Table {
        caption: String::new(),
        columns: vec![Column::text("file"), Column::text("what is in it"), Column::number("size", "")],
        rows: files.iter().map(row).collect(),
    }
}

/// Values that nobody gave, of the session and of every groom.
fn assumed(page: &DemoPage<'_>) -> String {
    let row = |of: &str, a: &Assumption| {
        vec![
            Cell::Text(of.to_owned()),
            Cell::Code(a.what.clone()),
            Cell::Text(a.value.clone()),
            Cell::Text(a.why.clone()),
        ]
    };
    let session = page.session.assumed.iter().map(|a| row("session", a));
    let grooms = page.hair.iter().flat_map(|h| h.groom.assumed.iter().map(move |a| row(h.name, a)));
    let rows: Vec<_> = session.chain(grooms).collect();
    if rows.is_empty() {
        return String::new();
    }
    let columns = ["of", "value", "taken as", "because"].map(Column::text).to_vec();
    let summary = match rows.len() {
        1 => "1 value was assumed".to_owned(),
        n => format!("{n} values were assumed"),
    };
    let table = Table { caption: String::new(), columns, rows }.html();
    format!("<details class=\"card\"><summary>{summary}</summary>\n{table}</details>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_that_looks_like_a_place_is_not_filled_again() {
        assert_eq!(filled("<b>{a}</b> {b} {c", &[("a", "{b}"), ("b", "2")]), "<b>{b}</b> 2 {c");
    }
}

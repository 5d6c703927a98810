use super::{DragEffect, HandRow, LiveRow, SeveralRow};
use crate::{Cell, Report, Section, Table};
use tousle_edit::KeyEffect;

/// Drags that were drawn, and what became of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DirectBenchReport {
    /// One row a drag with one key.
    pub rows: Vec<DragRow>,
    /// One row a drag with several.
    pub several: Vec<SeveralRow>,
    /// What it costs to run a hairstyle again.
    pub live: Vec<LiveRow>,
    /// How long the answers to a moving hand take.
    pub hands: Vec<HandRow>,
}

/// One drag by both methods.
#[derive(Clone, Debug, PartialEq)]
pub struct DragRow {
    /// The capture's name.
    pub capture: String,
    /// The drag's.
    pub edit: String,
    /// By E4.
    pub paper: MethodRow,
    /// Solved for.
    pub solved: MethodRow,
}

/// One drag by one method.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodRow {
    /// What is dragged and when, in words.
    pub what: String,
    /// Distance from the target without and with the edit, mm.
    pub residual_mm: (f64, f64),
    /// Why it was not met, if it was not and the method knows.
    pub unreachable: Option<String>,
    /// What it did to the strands.
    pub effect: DragEffect,
    /// How far the nearest strand of the other hairstyle goes along, as a share of what was asked.
    pub follows: Option<f64>,
}

impl MethodRow {
    /// A row of what an edit did from its first key on.
    pub(super) fn new(key: &KeyEffect, first_secs: f64, effect: DragEffect) -> Self {
        Self {
            what: what(key, first_secs),
            residual_mm: (key.residual_mm.before, key.residual_mm.after),
            unreachable: None,
            effect,
            follows: None,
        }
    }
}

/// What is dragged and when, in words.
pub(super) fn what(KeyEffect { key, .. }: &KeyEffect, first_secs: f64) -> String {
    format!("{} point {}, {first_secs:.2} to {:.2} s", key.strand, key.control_point, key.secs)
}

impl DirectBenchReport {
    /// How many drags were made.
    pub(super) fn n_drags(&self) -> u64 {
        (self.rows.len() + self.several.len()) as u64
    }

    /// Median and worst distance from the key, and what else must hold, by capture.
    pub fn summary(&self) -> Table {
        let columns = [
            &[
                "capture",
                "drags",
                "asked mm",
                "E4 median mm",
                "E4 worst",
                "solved median mm",
                "solved worst",
                "within 1 mm",
                "named unreachable",
            ][..],
            &DragEffect::SUMMARY,
            &["style B follows, median share", "of", "CPU s each"],
        ]
        .concat();
        let mut table = Table::new("Drags", &columns);
        let mut captures: Vec<&str> = self.rows.iter().map(|row| row.capture.as_str()).collect();
        captures.dedup();
        for capture in captures.iter().copied().map(Some).chain([None]) {
            let rows: Vec<&DragRow> =
                self.rows.iter().filter(|row| capture.is_none_or(|name| name == row.capture)).collect();
            let of = |value: &dyn Fn(&DragRow) -> f64| {
                let mut values: Vec<f64> = rows.iter().map(|row| value(row)).collect();
                values.sort_by(f64::total_cmp);
                values
            };
            let median = |values: &[f64]| values.get(values.len() / 2).copied();
            let worst = |values: &[f64]| values.last().copied();
            let count = |is_so: &dyn Fn(&DragRow) -> bool| {
                Cell::number(rows.iter().filter(|row| is_so(row)).count() as f64, 0)
            };
            let paper = of(&|row| row.paper.residual_mm.1);
            let solved = of(&|row| row.solved.residual_mm.1);
            let mut follows: Vec<f64> = rows.iter().filter_map(|row| row.solved.follows).collect();
            follows.sort_by(f64::total_cmp);
            let mut cells = vec![
                Cell::text(capture.unwrap_or("all")),
                Cell::number(rows.len() as f64, 0),
                Cell::maybe(median(&of(&|row| row.solved.residual_mm.0)), 1),
                Cell::maybe(median(&paper), 1),
                Cell::maybe(worst(&paper), 1),
                Cell::maybe(median(&solved), 3),
                Cell::maybe(worst(&solved), 2),
                count(&|row| row.solved.residual_mm.1 <= 1.0),
                count(&|row| row.solved.unreachable.is_some()),
            ];
            let effects: Vec<&DragEffect> = rows.iter().map(|row| &row.solved.effect).collect();
            cells.extend(DragEffect::summary(&effects));
            cells.extend([
                Cell::maybe(median(&follows), 2),
                Cell::number(follows.len() as f64, 0),
                Cell::maybe(median(&of(&|row| row.solved.effect.cost.cpu_secs.unwrap_or_default())), 2),
            ]);
            table.push(cells);
        }
        table
    }

    /// Every drag.
    pub fn drags(&self) -> Table {
        let columns = [
            &["capture", "drag", "what", "asked mm", "E4 mm", "solved mm", "unreachable"][..],
            &DragEffect::COLUMNS,
            &["style B follows", "wall s", "CPU s"],
        ]
        .concat();
        let mut table = Table::new("Each drag", &columns);
        for row in &self.rows {
            let solved = &row.solved;
            let mut cells = vec![
                Cell::text(&row.capture),
                Cell::text(&row.edit),
                Cell::text(&solved.what),
                Cell::number(solved.residual_mm.0, 1),
                Cell::number(row.paper.residual_mm.1, 1),
                Cell::number(solved.residual_mm.1, 3),
                Cell::text(solved.unreachable.clone().unwrap_or_default()),
            ];
            cells.extend(solved.effect.cells());
            cells.extend([
                Cell::maybe(solved.follows, 2),
                Cell::number(solved.effect.cost.wall_secs, 3),
                Cell::maybe(solved.effect.cost.cpu_secs, 3),
            ]);
            table.push(cells);
        }
        table
    }

    /// What it costs to run a hairstyle again.
    pub fn live_table(&self) -> Table {
        let columns = [
            "capture",
            "method",
            "strands",
            "points",
            "seconds",
            "prepare ms",
            "again ms",
            "again CPU ms",
            "from the middle ms",
            "edit changed ms",
            "strands that feel it",
        ];
        let mut table = Table::new("A resident simulation", &columns);
        for row in &self.live {
            table.push(vec![
                Cell::text(&row.capture),
                Cell::text(row.method),
                Cell::number(row.size.0 as f64, 0),
                Cell::number(row.size.1 as f64, 0),
                Cell::number(row.simulated_secs, 1),
                Cell::number(row.prepare.wall_secs * 1e3, 1),
                Cell::number(row.again.wall_secs * 1e3, 1),
                Cell::maybe(row.again.cpu_secs.map(|secs| secs * 1e3), 1),
                Cell::number(row.later.wall_secs * 1e3, 1),
                Cell::number(row.changed.wall_secs * 1e3, 1),
                Cell::number(row.n_felt as f64, 0),
            ]);
        }
        table
    }

    /// One row a capture: the answers to a moving hand, the median one and the slowest.
    pub fn hand_table(&self) -> Table {
        let columns = [
            "capture",
            "answers",
            "solve ms, median",
            "again ms, median",
            "answer ms, median",
            "answer ms, most",
            "mm off, median",
            "mm off, most",
        ];
        let mut table = Table::new("A hand that pulls", &columns);
        for row in &self.hands {
            let median = |numbers: &[f64], times: f64| {
                Cell::maybe(numbers.get(numbers.len() / 2).map(|number| number * times), 1)
            };
            let most =
                |numbers: &[f64], times: f64| Cell::maybe(numbers.last().map(|number| number * times), 1);
            table.push(vec![
                Cell::text(&row.capture),
                Cell::number(row.answer_secs.len() as f64, 0),
                median(&row.solve_secs, 1e3),
                median(&row.again_secs, 1e3),
                median(&row.answer_secs, 1e3),
                most(&row.answer_secs, 1e3),
                median(&row.off_mm, 1.0),
                most(&row.off_mm, 1.0),
            ]);
        }
        table
    }

    /// All of it.
    pub fn report(&self) -> Report {
        let tables = [
            ("", self.summary()),
            ("drags", self.drags()),
            ("several", self.several_summary()),
            ("several-keys", self.several_keys()),
            ("live", self.live_table()),
            ("hand", self.hand_table()),
        ];
        let tables = tables.map(|(name, table)| (name.to_owned(), table)).into();
        Report {
            name: "direct",
            title: "Directing, judged".to_owned(),
            words: "Drags drawn at random on captured wigs, within what their locks can reach: by the paper's E4, and solved for."
                .to_owned(),
            sections: vec![Section { name: "direct".to_owned(), tables, ..Section::default() }],
            json: None,
        }
    }
}

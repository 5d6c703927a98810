//! Drags with several keys.

use super::report::what;
use super::{DirectBenchReport, DragEffect, Several};
use crate::stats::median;
use crate::{Cell, Table};
use tousle_direct::{KeyOutcome, SolvedOutcome};
use tousle_edit::KeyEffect;

/// One drag with several keys, solved for.
#[derive(Clone, Debug, PartialEq)]
pub struct SeveralRow {
    /// The capture's name.
    pub capture: String,
    /// How the drag has its keys.
    pub kind: Several,
    /// The drag's name.
    pub edit: String,
    /// Its keys, in order of time.
    pub keys: Vec<KeyRow>,
    /// What it did to the strands.
    pub effect: DragEffect,
    /// How often strands were simulated for it.
    pub n_runs: usize,
}

/// One of its keys.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyRow {
    /// What is dragged and when, in words.
    pub what: String,
    /// Distance from the target without and with the edit, mm.
    pub residual_mm: (f64, f64),
    /// Why it was not met, and by how much, if it was not.
    pub unreachable: Option<String>,
}

impl SeveralRow {
    /// A row of what a drag became and did.
    pub(super) fn new(
        capture: &str,
        kind: Several,
        outcome: &SolvedOutcome,
        keys: &[KeyEffect],
        effect: DragEffect,
    ) -> Self {
        let first_secs = outcome.first_secs;
        let key = |(effect, outcome): (&KeyEffect, &KeyOutcome)| KeyRow {
            what: what(effect, first_secs),
            residual_mm: (effect.residual_mm.before, effect.residual_mm.after),
            unreachable: outcome.unreachable.as_ref().map(ToString::to_string),
        };
        Self {
            capture: capture.to_owned(),
            kind,
            edit: outcome.name.clone(),
            keys: keys.iter().zip(&outcome.keys).map(key).collect(),
            effect,
            n_runs: outcome.n_runs,
        }
    }
}

impl KeyRow {
    /// Whether it is met to a millimeter.
    pub fn is_met(&self) -> bool {
        self.residual_mm.1 <= 1.0
    }
}

impl DirectBenchReport {
    /// How well several keys are met together, and what else must hold, by kind and capture.
    pub fn several_summary(&self) -> Table {
        let columns = [
            &[
                "keys",
                "capture",
                "drags",
                "keys of these",
                "asked mm",
                "median mm",
                "worst mm",
                "within 1 mm",
                "named unreachable",
                "drags met",
            ][..],
            &DragEffect::SUMMARY,
            &["wall s, median", "wall s, worst", "CPU s, median"],
        ]
        .concat();
        let mut table = Table::new("Drags with several keys", &columns);
        for kind in Several::ALL {
            let of_kind: Vec<&SeveralRow> = self.several.iter().filter(|row| row.kind == kind).collect();
            let mut captures: Vec<&str> = of_kind.iter().map(|row| row.capture.as_str()).collect();
            captures.dedup();
            for capture in captures.iter().copied() {
                let rows: Vec<&SeveralRow> =
                    of_kind.iter().copied().filter(|row| row.capture == capture).collect();
                table.push(summary_row(kind.name(), capture, &rows));
            }
            if !of_kind.is_empty() {
                table.push(summary_row(kind.name(), "all", &of_kind));
            }
        }
        table
    }

    /// Every key of every drag with several.
    pub fn several_keys(&self) -> Table {
        let columns = [
            &["capture", "keys", "drag", "what", "asked mm", "solved mm", "unreachable"][..],
            &DragEffect::COLUMNS,
            &["runs", "wall s", "CPU s"],
        ]
        .concat();
        let mut table = Table::new("Each of several keys", &columns);
        for row in &self.several {
            for key in &row.keys {
                let mut cells = vec![
                    Cell::text(&row.capture),
                    Cell::text(row.kind.name()),
                    Cell::text(&row.edit),
                    Cell::text(&key.what),
                    Cell::number(key.residual_mm.0, 1),
                    Cell::number(key.residual_mm.1, 3),
                    Cell::text(key.unreachable.clone().unwrap_or_default()),
                ];
                cells.extend(row.effect.cells());
                cells.extend([
                    Cell::number(row.n_runs as f64, 0),
                    Cell::number(row.effect.cost.wall_secs, 3),
                    Cell::maybe(row.effect.cost.cpu_secs, 3),
                ]);
                table.push(cells);
            }
        }
        table
    }
}

fn summary_row(kind: &str, capture: &str, rows: &[&SeveralRow]) -> Vec<Cell> {
    let keys: Vec<&KeyRow> = rows.iter().flat_map(|row| &row.keys).collect();
    let of_keys = |value: &dyn Fn(&KeyRow) -> f64| keys.iter().map(|key| value(key)).collect::<Vec<f64>>();
    let of_drags =
        |value: &dyn Fn(&SeveralRow) -> f64| rows.iter().map(|row| value(row)).collect::<Vec<f64>>();
    let middle = |mut values: Vec<f64>, decimals| Cell::number(median(&mut values), decimals);
    let worst = |values: Vec<f64>, decimals| Cell::number(values.into_iter().fold(0.0, f64::max), decimals);
    let count = |n: usize| Cell::number(n as f64, 0);
    let mut cells = vec![
        Cell::text(kind),
        Cell::text(capture),
        count(rows.len()),
        count(keys.len()),
        middle(of_keys(&|key| key.residual_mm.0), 1),
        middle(of_keys(&|key| key.residual_mm.1), 3),
        worst(of_keys(&|key| key.residual_mm.1), 2),
        count(keys.iter().filter(|key| key.is_met()).count()),
        count(keys.iter().filter(|key| key.unreachable.is_some()).count()),
        count(rows.iter().filter(|row| row.keys.iter().all(KeyRow::is_met)).count()),
    ];
    let effects: Vec<&DragEffect> = rows.iter().map(|row| &row.effect).collect();
    cells.extend(DragEffect::summary(&effects));
    cells.extend([
        middle(of_drags(&|row| row.effect.cost.wall_secs), 2),
        worst(of_drags(&|row| row.effect.cost.wall_secs), 2),
        middle(of_drags(&|row| row.effect.cost.cpu_secs.unwrap_or_default()), 2),
    ]);
    cells
}

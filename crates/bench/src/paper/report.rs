//! The paper's figures as tables and a page.

use super::{PaperReport, PaperRow, TRUE_WIND};
use crate::{Baseline, Cell, FieldScore, MotionScore, Report, Section, Table, VectorScore};

/// Trivial predictors, and what exact hair gets, as the baselines name them.
const QUOTED: [&str; 3] = ["never moves", "pendulum", Baseline::CEILING];

impl PaperReport {
    /// Style B against its truth: every run beside what the baselines give for the same capture.
    pub fn motion_table(&self) -> Table {
        let columns = [
            "capture",
            "wind",
            "explained motion",
            "median lock",
            "explained fluctuation",
            "mean mm",
            "95 % mm",
            "tip mean mm",
            "beats pendulum",
        ];
        let mut table = Table::new("Style B, simulated by the 2008 method, against its truth", &columns);
        for capture in self.captures() {
            for name in QUOTED {
                let quoted = self.baseline(capture, name);
                table.rows.extend(quoted.map(quoted_row));
            }
            for row in self.rows.iter().filter(|row| row.capture == capture) {
                let pendulum = self.baseline(capture, "pendulum");
                table.push(motion_row(row, pendulum));
            }
        }
        table
    }

    /// The fields against the true wind's force on the reference lock.
    pub fn field_table(&self) -> Table {
        let columns = [
            "capture",
            "wind",
            "region",
            "cosine",
            "median angle °",
            "within 30° %",
            "vector error %",
            "best scale",
        ];
        let mut table =
            Table::new("The fields, against the drag of the reference lock in the true wind", &columns);
        for row in &self.rows {
            let Some(FieldScore { hair, nearby, elsewhere }) = row.field else { continue };
            for (region, score) in [("hair", hair), ("nearby", nearby), ("elsewhere", elsewhere)] {
                let of =
                    |figure: &dyn Fn(VectorScore) -> f64, decimals| Cell::maybe(score.map(figure), decimals);
                table.push(vec![
                    Cell::text(&row.capture),
                    Cell::text(&row.wind),
                    Cell::text(region),
                    of(&|s| s.cos_mean, 3),
                    of(&|s| s.angle_median_deg, 1),
                    of(&|s| 100.0 * s.within_30deg, 0),
                    of(&|s| 100.0 * s.vector_error, 0),
                    of(&|s| s.best_scale, 2),
                ]);
            }
        }
        table
    }

    /// What each run cost, against how long the capture lasts.
    pub fn cost_table(&self) -> Table {
        let columns = [
            "capture",
            "wind",
            "captured s",
            "convert, wall s",
            "convert, CPU s",
            "simulate, wall s",
            "simulate, CPU s per s",
            "largest stretch %",
        ];
        let mut table = Table::new("What it cost on this machine", &columns);
        for row in &self.rows {
            table.push(vec![
                Cell::text(&row.capture),
                Cell::text(&row.wind),
                Cell::number(row.captured_secs, 2),
                Cell::maybe(row.convert.map(|cost| cost.wall_secs), 2),
                Cell::maybe(row.convert.and_then(|cost| cost.cpu_secs), 2),
                Cell::number(row.simulate.wall_secs, 2),
                Cell::maybe(row.simulate.cpu_secs.map(|cpu| cpu / row.captured_secs), 3),
                Cell::number(100.0 * row.max_stretch, 4),
            ]);
        }
        table
    }

    /// One line a wind: means over the captures, and on how many it beats the pendulum.
    pub fn summary_table(&self) -> Table {
        let columns = ["wind", "captures", "explained motion", "median lock", "mean mm", "beats pendulum on"];
        let mut table = Table::new("Means over the captures", &columns);
        for wind in self.winds() {
            let rows: Vec<&PaperRow> = self.rows.iter().filter(|row| row.wind == wind).collect();
            let mean = |of: &dyn Fn(&MotionScore) -> f64| {
                rows.iter().map(|row| of(&row.motion)).sum::<f64>() / rows.len() as f64
            };
            let judged: Vec<bool> = rows.iter().filter_map(|row| self.beats_pendulum(row)).collect();
            let wins = judged.iter().filter(|wins| **wins).count();
            table.push(vec![
                Cell::text(wind),
                Cell::number(rows.len() as f64, 0),
                Cell::number(mean(&|m| m.points.explained_motion), 3),
                Cell::number(mean(&median_lock), 3),
                Cell::number(mean(&|m| m.points.mean_mm), 1),
                if judged.is_empty() {
                    Cell::Missing
                } else {
                    Cell::text(format!("{wins} of {}", judged.len()))
                },
            ]);
        }
        table
    }

    /// All of it: the tables in the order motion, field, cost, and the summary, which stays in sight on a terminal.
    pub fn report(&self) -> Report {
        let tables = [
            ("motion", self.motion_table()),
            ("field", self.field_table()),
            ("cost", self.cost_table()),
            ("summary", self.summary_table()),
        ];
        let tables = tables.map(|(name, table)| (name.to_owned(), table)).into();
        Report {
            name: "paper",
            title: "The 2008 method, judged".to_owned(),
            words: "Style B is a hairstyle that nobody captured. It was simulated in the field made of each capture by each \
                    reading of E3, and in the true wind. Explained motion: 1 − rms error / rms displacement from rest; 0 is \
                    as good as never moving, 1 exact."
                .to_owned(),
            sections: vec![Section { name: "paper".to_owned(), tables, ..Section::default() }],
            json: Some(self.to_json()),
        }
    }

    /// All figures, for programs.
    ///
    /// # Panics
    /// Never: a report is made of strings, numbers and lists.
    fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).expect("a report is made of strings, numbers and lists")
    }

    fn captures(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.rows.iter().map(|row| row.capture.as_str()).collect();
        names.dedup();
        names
    }

    /// The winds in the order of the first capture's runs.
    fn winds(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for row in &self.rows {
            if !names.contains(&row.wind.as_str()) {
                names.push(&row.wind);
            }
        }
        names
    }

    fn baseline(&self, capture: &str, predictor: &str) -> Option<&Baseline> {
        self.baselines.iter().find(|b| b.capture == capture && b.predictor == predictor)
    }

    /// Whether a run explains more motion than the pendulum does on the same capture.
    fn beats_pendulum(&self, row: &PaperRow) -> Option<bool> {
        let pendulum = self.baseline(&row.capture, "pendulum")?;
        Some(row.motion.points.explained_motion > pendulum.explained_motion)
    }
}

fn quoted_row(quoted: &Baseline) -> Vec<Cell> {
    let exact = if quoted.predictor == Baseline::CEILING { "exact hair in the " } else { "" };
    let name = format!("({exact}{})", quoted.predictor.replace(Baseline::CEILING, TRUE_WIND));
    vec![
        Cell::text(&quoted.capture),
        Cell::text(name),
        Cell::number(quoted.explained_motion, 3),
        Cell::number(quoted.median_lock, 3),
        Cell::number(quoted.explained_fluctuation, 3),
        Cell::number(quoted.mean_mm, 1),
        Cell::number(quoted.p95_mm, 1),
        Cell::Missing,
        Cell::Missing,
    ]
}

fn motion_row(row: &PaperRow, pendulum: Option<&Baseline>) -> Vec<Cell> {
    let points = &row.motion.points;
    let beats = pendulum.map(|p| points.explained_motion > p.explained_motion);
    vec![
        Cell::text(&row.capture),
        Cell::text(&row.wind),
        Cell::number(points.explained_motion, 3),
        Cell::number(median_lock(&row.motion), 3),
        Cell::number(points.explained_fluctuation, 3),
        Cell::number(points.mean_mm, 1),
        Cell::number(points.p95_mm, 1),
        Cell::number(row.motion.tips.mean_mm, 1),
        beats.map_or(Cell::Missing, |beats| Cell::text(if beats { "yes" } else { "no" })),
    ]
}

fn median_lock(motion: &MotionScore) -> f64 {
    motion.locks.as_ref().map_or(f64::NAN, |locks| locks.explained_median)
}

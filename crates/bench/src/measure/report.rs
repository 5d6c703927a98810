use super::trade::Trade;
use super::{Calibration, MeasureRow};
use crate::{Baseline, Cell, Report, Section, Table, WorkPrecision};
use tousle_page::{Axis, Plot, Series};

/// What the bench found.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureReport {
    /// One a capture and setting.
    pub rows: Vec<MeasureRow>,
    /// What `BASELINES.md` beside the captures says; empty if it is not there.
    pub baselines: Vec<Baseline>,
}

const ABOUT: &str = "The wind of captures by the 2008 method and by ours, against the true one, and another hairstyle, style \
                     B, simulated in it, against where that really went. Explained motion: 1 − rms error / rms displacement \
                     from rest; 0 is as good as never moving, 1 exact.";

const CHOICES: &str = "The cost is that of cleaning, fit, closed loop and grid, on all cores; reading the capture and simulating \
                       style B are not in it. Each curve varies one thing of one method and passes through the method as it is by \
                       default. Unexplained motion is rms error over rms displacement from rest; its ceiling is what the engine \
                       that made the captures leaves in its own wind. The method paper measures a force, which is compared with \
                       the true drag of a reference lock.";

const WORSE: &str = "Fewer markers or locks, more noise or gaps, locks that nobody saw at rest; no dirt: every marker where it \
                     really was, in every frame. The cost is a result here and no choice.";

const CALIBRATION: &str = "Above the bell's curve the stated standard deviations are larger than need be. A voxel's is of each \
                           component.";

impl MeasureReport {
    /// Every run as a row.
    pub fn table(&self) -> Table {
        let columns = [
            "capture",
            "varied",
            "setting",
            "explained motion",
            "median lock",
            "explained fluctuation",
            "mean mm",
            "captured wig",
            "its median lock",
            "its fluctuation",
            "wig before, mm",
            "after, mm",
            "rounds kept",
            "vector error, hair",
            "median angle, hair",
            "vector error, nearby",
            "vector error, elsewhere",
            "within 2 sd, hair",
            "nearby",
            "elsewhere",
            "CPU s",
            "wall s",
        ];
        let mut table = Table::new("The wind, measured", &columns);
        for row in &self.rows {
            let points = &row.motion.points;
            let refined = row.refined.as_ref();
            let within = row.calibration.as_ref().map(Calibration::within_two);
            table.push(vec![
                Cell::text(&row.capture),
                Cell::text(row.varied),
                Cell::text(&row.setting),
                Cell::number(points.explained_motion, 3),
                Cell::maybe(row.motion.locks.as_ref().map(|locks| locks.explained_median), 3),
                Cell::number(points.explained_fluctuation, 3),
                Cell::number(points.mean_mm, 1),
                Cell::maybe(row.wig.as_ref().map(|wig| wig.points.explained_motion), 3),
                Cell::maybe(
                    row.wig.as_ref().and_then(|wig| wig.locks.as_ref()).map(|l| l.explained_median),
                    3,
                ),
                Cell::maybe(row.wig.as_ref().map(|wig| wig.points.explained_fluctuation), 3),
                Cell::maybe(refined.map(|r| r.rounds[0].judged_m() * 1e3), 2),
                Cell::maybe(refined.map(|r| r.rounds[r.kept].judged_m() * 1e3), 2),
                Cell::maybe(refined.map(|r| r.kept as f64), 0),
                Cell::maybe(row.field.hair.map(|s| s.vector_error), 3),
                Cell::maybe(row.field.hair.map(|s| s.angle_median_deg), 1),
                Cell::maybe(row.field.nearby.map(|s| s.vector_error), 3),
                Cell::maybe(row.field.elsewhere.map(|s| s.vector_error), 3),
                Cell::maybe(within.map(|w| w[0]), 3),
                Cell::maybe(within.map(|w| w[1]), 3),
                Cell::maybe(within.map(|w| w[2]), 3),
                Cell::maybe(row.cost.cpu_secs, 1),
                Cell::number(row.cost.wall_secs, 1),
            ]);
        }
        table
    }

    /// What would be chosen for each capture if only the others had been looked at: the choice with the best mean over them of
    /// the median lock's explained motion, what it scores on the capture left out, and what the default scores there.
    pub fn leave_one_out(&self) -> Table {
        let columns = ["capture left out", "chosen from the others", "median lock", "as it is"];
        let mut table = Table::new("Leave one out", &columns);
        let mut captures: Vec<&str> = self.rows.iter().map(|row| row.capture.as_str()).collect();
        captures.dedup();
        let choices: Vec<&MeasureRow> = self.rows.iter().filter(|row| row.varied == "choice").collect();
        let median =
            |row: &&&MeasureRow| row.motion.locks.as_ref().map_or(0.0, |locks| locks.explained_median);
        for capture in captures {
            let here: Vec<&&MeasureRow> = choices.iter().filter(|row| row.capture == capture).collect();
            let elsewhere = |row: &&&MeasureRow| -> f64 {
                let others = choices.iter().filter(|o| o.setting == row.setting && o.capture != capture);
                others.map(|other| median(&other)).sum()
            };
            let best = here.iter().copied().reduce(|a, b| if elsewhere(&b) > elsewhere(&a) { b } else { a });
            if let (Some(best), Some(default)) = (best, here.first()) {
                table.push(vec![
                    Cell::text(capture),
                    Cell::text(&best.setting),
                    Cell::number(median(&best), 3),
                    Cell::number(median(default), 3),
                ]);
            }
        }
        table
    }

    /// All of it: what the wind's accuracy costs, by what may be chosen, by how good the capture is, and capture by capture; how
    /// honest its standard deviations are; every run.
    pub fn report(&self) -> Report {
        let trade = Trade::new(&self.rows, &self.baselines);
        let plots = |diagrams: Vec<(String, WorkPrecision)>| {
            diagrams.into_iter().map(|(name, diagram)| (name, diagram.to_plot())).collect::<Vec<_>>()
        };
        let section = |name: &str, title: &str, words: &str| Section {
            name: name.to_owned(),
            title: title.to_owned(),
            words: words.to_owned(),
            ..Section::default()
        };
        let sections = vec![
            Section {
                tables: vec![(String::new(), trade.table())],
                plots: plots(trade.choices()),
                ..section("wind-trade", "Error against run time", CHOICES)
            },
            Section {
                plots: plots(trade.worse()),
                ..section("wind-worse", "Of captures made worse, and better", WORSE)
            },
            Section {
                plots: plots(trade.captures()),
                ..section(
                    "wind-captures",
                    "Capture by capture",
                    "Both methods as they are by default, and the closed loop.",
                )
            },
            Section {
                plots: vec![(String::new(), self.calibration_plot())],
                ..section("wind-calibration", "Stated against found uncertainty", CALIBRATION)
            },
            Section { tables: vec![(String::new(), self.table())], ..section("wind", "Every run", "") },
        ];
        Report {
            name: "wind",
            title: "The wind, measured".to_owned(),
            words: ABOUT.to_owned(),
            sections: sections.into_iter().filter(|s| !(s.plots.is_empty() && s.tables.is_empty())).collect(),
            json: None,
        }
    }

    /// What `--leave-one-out` asks for: every run, and what would have been chosen.
    pub fn leave_one_out_report(&self) -> Report {
        let section = |name: &str, table: Table| Section {
            name: name.to_owned(),
            tables: vec![(String::new(), table)],
            ..Section::default()
        };
        Report {
            name: "wind-leave-one-out",
            title: "The wind, measured: one capture left out".to_owned(),
            words: ABOUT.to_owned(),
            sections: vec![
                section("wind-choices", self.table()),
                section("wind-leave-one-out", self.leave_one_out()),
            ],
            json: None,
        }
    }

    /// Stated against found uncertainty where hair was: one curve a capture, by the default, and the bell that would be right.
    pub fn calibration_plot(&self) -> Plot {
        let series = |name: &str, shares: &[f64]| Series {
            points: Calibration::TIMES.iter().zip(shares).map(|(z, share)| [*z, *share]).collect(),
            name: name.to_owned(),
            ..Series::default()
        };
        let of_row = |row: &MeasureRow| {
            let calibration = row.calibration.as_ref().filter(|_| row.varied == "method")?;
            (row.setting == "physical").then(|| series(&row.capture, &calibration.within[0]))
        };
        let bell = series("a bell", &Calibration::of_a_bell());
        let axis = |label: &str| Axis { label: label.to_owned(), ..Axis::default() };
        Plot {
            title: "Share of the true wind within so many stated standard deviations, where hair was".into(),
            x: axis("standard deviations"),
            y: axis("share of components"),
            series: core::iter::once(bell).chain(self.rows.iter().filter_map(of_row)).collect(),
            size_px: [860.0, 520.0],
        }
    }
}

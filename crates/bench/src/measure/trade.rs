//! Error against run time of the measured wind: curves through the settings that vary one thing of one method.

mod axes;

use super::{MeasureRow, Setting};
use crate::stats::mean;
use crate::{Baseline, Cell, Cost, Curve, CurvePoint, Table, WorkPrecision};
use axes::{Clock, Off};

/// What may be varied, as tables and as curves call it.
type Kind = (&'static str, &'static str);

/// What whoever measures may choose.
const CHOSEN: [Kind; 4] = [
    ("reading", "readings of E3"),
    ("voxel", "voxels"),
    ("rate", "steps a second"),
    ("refine", "closed loop"),
];

/// How good the capture is.
const WORSE: [Kind; 6] = [
    ("markers", "markers of a lock"),
    ("locks", "locks"),
    ("noise", "noise"),
    ("gaps", "gaps"),
    ("rest", "rest never seen"),
    ("dirt", "dirt"),
];

/// One setting on all captures.
struct Mean<'a> {
    /// Its row on the first of them.
    row: &'a MeasureRow,
    n_captures: usize,
    cost: Cost,
    /// 1 − explained motion.
    motion: f64,
    wind: f64,
}

/// What every setting costs and is off by in the mean of all captures, and how that looks.
pub(super) struct Trade<'a> {
    rows: &'a [MeasureRow],
    baselines: &'a [Baseline],
    means: Vec<Mean<'a>>,
}

impl<'a> Trade<'a> {
    /// Of all rows but those of `--leave-one-out`.
    pub fn new(rows: &'a [MeasureRow], baselines: &'a [Baseline]) -> Self {
        let mut means: Vec<Mean<'_>> = Vec::new();
        for row in rows.iter().filter(|row| row.varied != "choice") {
            if !means.iter().any(|mean| mean.row.is_set_as(row)) {
                means.push(Mean::of(row, rows));
            }
        }
        Self { rows, baselines, means }
    }

    /// A row a setting.
    pub fn table(&self) -> Table {
        let columns = [
            "method",
            "varied",
            "setting",
            "captures",
            "CPU s a capture",
            "wall s a capture",
            "unexplained motion",
            "vector error, hair",
        ];
        let mut table = Table::new("Error against run time, means over the captures", &columns);
        for mean in &self.means {
            table.push(vec![
                Cell::text(mean.row.method),
                Cell::text(mean.row.varied),
                Cell::text(&mean.row.setting),
                Cell::number(mean.n_captures as f64, 0),
                Cell::maybe(mean.cost.cpu_secs, 2),
                Cell::number(mean.cost.wall_secs, 2),
                Cell::number(mean.motion, 3),
                Cell::number(mean.wind, 3),
            ]);
        }
        table
    }

    /// What may be chosen, by method, in both clocks; each diagram with a name.
    pub fn choices(&self) -> Vec<(String, WorkPrecision)> {
        let diagram = |off, clock| self.diagram("by choices", off, clock, self.curves(&CHOSEN, off, clock));
        vec![
            ("motion".to_owned(), diagram(Off::Motion, Clock::Cpu)),
            ("motion-wall".to_owned(), diagram(Off::Motion, Clock::Wall)),
            ("air".to_owned(), diagram(Off::Wind, Clock::Cpu)),
            ("air-wall".to_owned(), diagram(Off::Wind, Clock::Wall)),
        ]
    }

    /// Captures made worse, or better; no diagram where none was.
    pub fn worse(&self) -> Vec<(String, WorkPrecision)> {
        let is_worse = |mean: &Mean<'_>| WORSE.iter().any(|kind| kind.0 == mean.row.varied);
        if !self.means.iter().any(is_worse) {
            return Vec::new();
        }
        let diagram = |off| {
            let mut curves = self.curves(&WORSE, off, Clock::Cpu);
            // A method of which nothing was made worse would only take the others' room.
            curves.retain(|curve| curve.points.len() > 1);
            self.diagram("made worse", off, Clock::Cpu, curves)
        };
        vec![("motion".to_owned(), diagram(Off::Motion)), ("air".to_owned(), diagram(Off::Wind))]
    }

    /// Each capture a point of its own, by the methods as they are; no diagram of a single capture.
    pub fn captures(&self) -> Vec<(String, WorkPrecision)> {
        if self.means.iter().all(|mean| mean.n_captures < 2) {
            return Vec::new();
        }
        let curves =
            |off| self.means.iter().filter(|mean| mean.row.is_default()).map(move |m| self.each(m, off));
        let diagram = |off| self.diagram("one by one", off, Clock::Cpu, curves(off).collect());
        vec![("motion".to_owned(), diagram(Off::Motion)), ("air".to_owned(), diagram(Off::Wind))]
    }

    fn diagram(&self, how: &str, off: Off, clock: Clock, curves: Vec<Curve>) -> WorkPrecision {
        let mut captures: Vec<&str> = self.rows.iter().map(|row| row.capture.as_str()).collect();
        captures.dedup();
        let of = match captures.as_slice() {
            [one] => (*one).to_owned(),
            all => format!("{} captures", all.len()),
        };
        let diagram = WorkPrecision {
            title: format!("{of}, {how}: {} against {}", off.title(), clock.name()),
            cost: clock.label().to_owned(),
            error: off.label().to_owned(),
            curves,
        };
        match off {
            Off::Motion => diagram.with_level("ceiling", self.ceiling(&captures)),
            Off::Wind => diagram,
        }
    }

    /// What the engine that made the captures leaves unexplained itself; `None` if it is not told of all of them.
    fn ceiling(&self, captures: &[&str]) -> Option<f64> {
        let told = self.baselines.iter().filter(|b| b.predictor == Baseline::CEILING);
        let of = |name: &&str| Some(1.0 - told.clone().find(|b| b.capture == **name)?.explained_motion);
        let unexplained: Option<Vec<f64>> = captures.iter().map(of).collect();
        unexplained.filter(|unexplained| !unexplained.is_empty()).map(|unexplained| mean(&unexplained))
    }

    /// One curve a method and kind; a method of which nothing was varied is a point.
    fn curves(&self, kinds: &[Kind], off: Off, clock: Clock) -> Vec<Curve> {
        let curve = |name: String, means: &[&Mean<'_>]| Curve {
            points: means.iter().map(|mean| mean.point(off, clock)).collect(),
            is_labeled: true,
            ..Curve::named(name)
        };
        let mut curves = Vec::new();
        for default in self.means.iter().filter(|mean| mean.row.is_default()) {
            let method = default.row.method;
            let n_before = curves.len();
            for (varied, words) in kinds {
                let through = self.through(default, varied);
                curves.extend(through.map(|means| curve(format!("{method}: {words}"), &means)));
            }
            if curves.len() == n_before {
                curves.push(curve(method.to_owned(), &[default]));
            }
        }
        curves
    }

    /// The settings in which one thing of a method is varied, its default in its place; `None` if nothing was.
    fn through<'b>(&'b self, default: &'b Mean<'a>, varied: &str) -> Option<Vec<&'b Mean<'a>>> {
        let method = default.row.method;
        let is_of = |mean: &&Mean<'_>| mean.row.method == method && mean.row.varied == varied;
        let mut means: Vec<(f64, &Mean<'a>)> =
            self.means.iter().filter(is_of).map(|mean| (mean.row.level, mean)).collect();
        if means.is_empty() {
            return None;
        }
        means.push((Setting::usual_level(method, varied), default));
        means.sort_by(|a, b| a.0.total_cmp(&b.0));
        Some(means.into_iter().map(|(_, mean)| mean).collect())
    }

    /// Each capture in a setting, by processor time.
    fn each(&self, mean: &Mean<'_>, off: Off) -> Curve {
        let rows = self.rows.iter().filter(|row| row.is_set_as(mean.row));
        let point = |row: &MeasureRow| CurvePoint {
            setting: row.capture.clone(),
            cost: Clock::Cpu.secs(&row.cost),
            error: off.of(row),
        };
        Curve {
            points: rows.map(point).collect(),
            is_labeled: true,
            is_joined: false,
            ..Curve::named(mean.row.method.to_owned())
        }
    }
}

impl<'a> Mean<'a> {
    fn of(row: &'a MeasureRow, rows: &[MeasureRow]) -> Self {
        let alike: Vec<&MeasureRow> = rows.iter().filter(|other| other.is_set_as(row)).collect();
        let of =
            |figure: &dyn Fn(&MeasureRow) -> f64| mean(&alike.iter().map(|r| figure(r)).collect::<Vec<_>>());
        // Where one capture has no time of processors, the mean has none.
        let cpu = of(&|row| row.cost.cpu_secs.unwrap_or(f64::NAN));
        Self {
            row,
            n_captures: alike.len(),
            cost: Cost {
                wall_secs: of(&|row| row.cost.wall_secs),
                cpu_secs: Some(cpu).filter(|cpu| cpu.is_finite()),
            },
            motion: of(&|row| Off::Motion.of(row)),
            wind: of(&|row| Off::Wind.of(row)),
        }
    }

    fn point(&self, off: Off, clock: Clock) -> CurvePoint {
        let error = match off {
            Off::Motion => self.motion,
            Off::Wind => self.wind,
        };
        CurvePoint { setting: self.row.setting.clone(), cost: clock.secs(&self.cost), error }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FieldScore, MotionScore, PointScore, VectorScore};
    use std::collections::BTreeSet;

    /// A run that costs so many seconds of a processor and half of that of the wall's, with an explained motion.
    fn row(
        capture: &str,
        method: &'static str,
        varied: &'static str,
        level: f64,
        secs: f64,
        explained: f64,
    ) -> MeasureRow {
        let points = PointScore {
            mean_mm: 1.0,
            p95_mm: 1.0,
            rms_mm: 1.0,
            disp_rms_mm: 1.0,
            explained_motion: explained,
            explained_fluctuation: 0.0,
        };
        let hair = VectorScore {
            samples: 1,
            cos_mean: 1.0,
            angle_median_deg: 0.0,
            within_30deg: 1.0,
            magnitude_error_median: 0.0,
            vector_error: 0.5 * (1.0 - explained),
            best_scale: 1.0,
            vector_error_best_scale: 0.0,
        };
        MeasureRow {
            capture: capture.into(),
            method,
            varied,
            setting: format!("{varied} {level}"),
            level,
            cost: Cost { wall_secs: 0.5 * secs, cpu_secs: Some(secs) },
            motion: MotionScore {
                points,
                tips: points,
                locks: None,
                missing_fraction: 0.0,
                frames_beyond_prediction: 0,
            },
            wig: None,
            field: FieldScore { hair: Some(hair), nearby: None, elsewhere: None },
            refined: None,
            calibration: None,
        }
    }

    fn rows() -> Vec<MeasureRow> {
        let of = |capture: &str, more: f64| {
            vec![
                row(capture, "paper", "method", 0.0, 1.0 + more, 0.5),
                row(capture, "physical", "method", 0.0, 4.0 + more, 0.9),
                row(capture, "physical", "voxel", 60.0, 2.0 + more, 0.8),
                row(capture, "physical", "voxel", 10.0, 8.0 + more, 0.95),
                row(capture, "physical", "noise", 1.0, 4.0 + more, 0.7),
                row(capture, "physical", "choice", 0.0, 4.0 + more, 0.7),
            ]
        };
        [of("calm", 0.0), of("gusty", 2.0)].concat()
    }

    fn curve(diagram: &WorkPrecision, name: &str) -> Vec<[f64; 2]> {
        let curve = diagram.curves.iter().find(|curve| curve.name == name);
        let points = curve.unwrap_or_else(|| panic!("{diagram:?}")).points.iter();
        points.map(|p| [p.cost, (1e3 * p.error).round()]).collect()
    }

    /// Points are means over both captures, from the smallest voxel up, with the default (20 mm) in its place.
    #[test]
    fn a_curve_goes_through_the_default() {
        let rows = rows();
        let trade = Trade::new(&rows, &[]);
        let named: Vec<(String, WorkPrecision)> = trade.choices();
        assert_eq!(
            named.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(),
            ["motion", "motion-wall", "air", "air-wall"]
        );
        assert_eq!(curve(&named[0].1, "physical: voxels"), [[9.0, 50.0], [5.0, 100.0], [3.0, 200.0]]);
        assert_eq!(curve(&named[0].1, "paper"), [[2.0, 500.0]]);
        assert_eq!(curve(&named[3].1, "physical: voxels"), [[4.5, 25.0], [2.5, 50.0], [1.5, 100.0]]);
        assert_eq!(named[0].1.curves.len(), 2, "noise is no choice");
        let [(_, motion), _] = &trade.worse()[..] else { panic!("expected two diagrams") };
        assert_eq!(motion.curves.len(), 1, "nothing of the paper's was made worse");
        assert_eq!(curve(motion, "physical: noise"), [[5.0, 100.0], [5.0, 300.0]]);
        assert_eq!(trade.table().rows.len(), 5);
        let titles = [trade.choices(), trade.worse(), trade.captures()].concat();
        let titles: BTreeSet<String> = titles.into_iter().map(|(_, diagram)| diagram.title).collect();
        assert_eq!(titles.len(), 8, "{titles:?}");
    }

    #[test]
    fn captures_are_points_of_their_own_and_the_ceiling_a_line() {
        let rows = rows();
        let ceiling = |capture: &str, explained_motion| Baseline {
            capture: capture.into(),
            predictor: Baseline::CEILING.into(),
            mean_mm: 1.0,
            p95_mm: 1.0,
            explained_motion,
            explained_fluctuation: 1.0,
            median_lock: 1.0,
        };
        let told = [ceiling("calm", 0.99), ceiling("gusty", 0.97), ceiling("elsewhere", 0.5)];
        let diagrams = Trade::new(&rows, &told).captures();
        assert_eq!(curve(&diagrams[0].1, "physical"), [[4.0, 100.0], [6.0, 100.0]]);
        assert_eq!(curve(&diagrams[0].1, "ceiling"), [[1.0, 20.0], [6.0, 20.0]]);
        assert!(Trade::new(&rows[..6], &[]).captures().is_empty(), "one capture is no spread");
        assert!(Trade::new(&rows[..2], &[]).worse().is_empty(), "nothing was made worse");
    }
}

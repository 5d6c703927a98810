//! Error against run time: one curve a method, one point a setting.

use crate::table::{Cell, Table, escape};
use serde::Serialize;
use std::fmt::Write as _;

/// A work-precision diagram: what a method's accuracy costs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WorkPrecision {
    /// What was run.
    pub title: String,
    /// What the cost is, with its unit: `CPU s per simulated s`.
    pub cost: String,
    /// What the error is, with its unit, and against which reference.
    pub error: String,
    /// The methods.
    pub curves: Vec<Curve>,
}

/// One method of a [`WorkPrecision`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// The method's name.
    pub name: String,
    /// Its settings, in the order in which they are joined.
    pub points: Vec<CurvePoint>,
}

/// One setting of a [`Curve`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurvePoint {
    /// The setting: `dt 1/240 s`.
    pub setting: String,
    /// What it costs.
    pub cost: f64,
    /// How far off it is.
    pub error: f64,
}

const WIDTH: f64 = 720.0;
const HEIGHT: f64 = 440.0;
const LEFT: f64 = 80.0;
const RIGHT: f64 = 190.0;
const TOP: f64 = 40.0;
const BOTTOM: f64 = 60.0;

/// Okabe and Ito's palette, which people with any color vision can tell apart, without its yellow and black.
const COLORS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

impl WorkPrecision {
    /// Every point as a row.
    pub fn to_table(&self) -> Table {
        let mut table = Table::new(&self.title, &["method", "setting", &self.cost, &self.error]);
        for curve in &self.curves {
            for point in &curve.points {
                table.push(vec![
                    Cell::text(&curve.name),
                    Cell::text(&point.setting),
                    Cell::number(point.cost, 4),
                    Cell::number(point.error, 4),
                ]);
            }
        }
        table
    }

    /// The diagram as an SVG of its own, cost across and error up, both logarithmic.
    ///
    /// Points whose cost or error is not above 0 have no place on it; they are in the table all the same. A
    /// pointer held over a point shows its setting.
    pub fn to_svg(&self) -> String {
        let drawn = || self.curves.iter().flat_map(|c| &c.points).filter(|p| p.is_drawn());
        let x = Axis::over(drawn().map(|p| p.cost), LEFT, WIDTH - RIGHT);
        let y = Axis::over(drawn().map(|p| p.error), HEIGHT - BOTTOM, TOP);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" \
             font-family=\"sans-serif\" font-size=\"12\" fill=\"#222\">\n\
             <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n\
             <text x=\"{LEFT}\" y=\"22\" font-size=\"15\">{}</text>\n",
            escape(&self.title)
        );
        self.draw_axes(&mut svg, &x, &y);
        for (k, curve) in self.curves.iter().enumerate() {
            let color = COLORS[k % COLORS.len()];
            curve.draw(&mut svg, &x, &y, color);
            let (lx, ly) = (WIDTH - RIGHT + 16.0, TOP + 10.0 + 20.0 * k as f64);
            let _ = writeln!(
                svg,
                "<circle cx=\"{lx:.1}\" cy=\"{ly:.1}\" r=\"4\" fill=\"{color}\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                lx + 10.0,
                ly + 4.0,
                escape(&curve.name)
            );
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn draw_axes(&self, svg: &mut String, x: &Axis, y: &Axis) {
        let (right, bottom) = (WIDTH - RIGHT, HEIGHT - BOTTOM);
        for tick in x.ticks() {
            let at = x.place(tick);
            let _ = writeln!(
                svg,
                "<path d=\"M{at:.1} {TOP}V{bottom}\" stroke=\"#ddd\"/>\
                 <text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{tick}</text>",
                bottom + 18.0
            );
        }
        for tick in y.ticks() {
            let at = y.place(tick);
            let _ = writeln!(
                svg,
                "<path d=\"M{LEFT} {at:.1}H{right}\" stroke=\"#ddd\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{tick}</text>",
                LEFT - 8.0,
                at + 4.0
            );
        }
        let (middle_x, middle_y) = ((LEFT + right) / 2.0, (TOP + bottom) / 2.0);
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {TOP}V{bottom}H{right}\" fill=\"none\" stroke=\"#222\"/>\n\
             <text x=\"{middle_x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(18 {middle_y:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            HEIGHT - 14.0,
            escape(&self.cost),
            escape(&self.error)
        );
    }
}

impl Curve {
    fn draw(&self, svg: &mut String, x: &Axis, y: &Axis, color: &str) {
        let mut line = String::new();
        let mut dots = String::new();
        for point in self.points.iter().filter(|p| p.is_drawn()) {
            let (px, py) = (x.place(point.cost), y.place(point.error));
            let _ = write!(line, "{}{px:.1} {py:.1}", if line.is_empty() { "M" } else { "L" });
            let _ = writeln!(
                dots,
                "<circle cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"4\" fill=\"{color}\"><title>{}</title></circle>",
                escape(&format!("{}, {}: {} at {}", self.name, point.setting, point.error, point.cost))
            );
        }
        let _ = writeln!(svg, "<path d=\"{line}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.5\"/>");
        svg.push_str(&dots);
    }
}

impl CurvePoint {
    fn is_drawn(&self) -> bool {
        [self.cost, self.error].iter().all(|v| v.is_finite() && *v > 0.0)
    }
}

/// A logarithmic axis from one side of the picture to the other.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    /// An axis that holds all values, widened to whole steps of 1, 2, 5.
    fn over(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let (low, high) = values.fold((f64::INFINITY, 0.0), |(l, h), v| (f64::min(l, v), f64::max(h, v)));
        if high == 0.0 {
            return Self { low: 0.1, high: 10.0, from, to };
        }
        let below = steps(low / 10.0, low).last().copied().unwrap_or(low / 2.0);
        let above = steps(high, high * 10.0).first().copied().unwrap_or(high * 2.0);
        Self { low: below, high: above, from, to }
    }

    fn place(&self, value: f64) -> f64 {
        self.from + (self.to - self.from) * libm::log(value / self.low) / libm::log(self.high / self.low)
    }

    /// Decades, and 2 and 5 between them where the axis is short.
    fn ticks(&self) -> Vec<f64> {
        let all = steps(self.low * 0.999, self.high * 1.001);
        if all.len() <= 10 {
            return all;
        }
        all.into_iter().filter(|t| libm::log10(*t).fract().abs() < 1e-9).collect()
    }
}

/// The values 1, 2, 5 times a power of ten that lie between two bounds.
fn steps(low: f64, high: f64) -> Vec<f64> {
    let first = libm::log10(low).floor() as i32;
    let last = libm::log10(high).ceil() as i32;
    let decade = |k: i32| {
        // 1e-3 written as a quotient prints as 0.001; as a product of powers it may not.
        let scaled = move |m: f64| {
            if k < 0 { m / libm::pow(10.0, f64::from(-k)) } else { m * libm::pow(10.0, f64::from(k)) }
        };
        [1.0, 2.0, 5.0].map(scaled)
    };
    (first..=last).flat_map(decade).filter(|v| *v >= low && *v <= high).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagram() -> WorkPrecision {
        let point =
            |setting: &str, cost: f64, error: f64| CurvePoint { setting: setting.into(), cost, error };
        WorkPrecision {
            title: "style B & the wind".into(),
            cost: "CPU s per simulated s".into(),
            error: "mean error, mm".into(),
            curves: vec![
                Curve {
                    name: "paper".into(),
                    points: vec![point("1/60", 0.04, 25.6), point("1/240", 0.1, 23.5)],
                },
                Curve { name: "broken".into(), points: vec![point("1/60", 0.1, f64::NAN)] },
            ],
        }
    }

    #[test]
    fn an_axis_runs_from_side_to_side() {
        let axis = Axis::over([0.04, 3.0].into_iter(), 100.0, 400.0);
        assert_eq!((axis.low, axis.high), (0.02, 5.0));
        assert_eq!(axis.place(0.02), 100.0);
        assert!((axis.place(5.0) - 400.0).abs() < 1e-9);
        assert_eq!(axis.ticks(), [0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0]);
        assert_eq!(Axis::over([1e-6, 1e3].into_iter(), 0.0, 1.0).ticks().len(), 10);
    }

    #[test]
    fn every_point_that_has_a_place_is_drawn() {
        let svg = diagram().to_svg();
        assert_eq!(svg.matches("<title>").count(), 2);
        assert!(svg.contains("style B &amp; the wind"));
        assert!(!svg.contains("NaN"));
        assert_eq!(diagram().to_table().rows.len(), 3);
    }

    #[test]
    fn a_diagram_without_points_is_still_a_picture() {
        let empty = WorkPrecision { curves: Vec::new(), ..diagram() };
        assert!(empty.to_svg().ends_with("</svg>\n"));
    }
}

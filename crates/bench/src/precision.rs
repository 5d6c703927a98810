//! Error against run time: one curve a method, one point a setting.

use crate::{Cell, Table};
use serde::Serialize;
use tousle_page::{Axis, Plot, Scale, Series, SeriesStyle};

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
    /// Whether the diagram names each setting beside its point; the table always does.
    pub is_labeled: bool,
    /// Whether the diagram joins its points: not where they are no settings of one thing.
    pub is_joined: bool,
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

    /// The same with a line across all of it at an error that costs nothing to know, if there is one.
    pub fn with_level(mut self, name: &str, error: Option<f64>) -> Self {
        let costs = || self.curves.iter().flat_map(|curve| curve.points.iter().map(|point| point.cost));
        let ends = [costs().reduce(f64::min), costs().reduce(f64::max)];
        if let (Some(error), [Some(first), Some(last)]) = (error, ends) {
            let at = |cost| CurvePoint { setting: String::new(), cost, error };
            self.curves.push(Curve { points: vec![at(first), at(last)], ..Curve::named(name.to_owned()) });
        }
        self
    }

    /// The diagram, cost across and error up, both logarithmic.
    ///
    /// Points whose cost or error is not above 0 have no place on it; they are in the table all the same. A setting that
    /// several curves go through is named once, and where there is no room for a name it is in the table alone.
    pub fn to_plot(&self) -> Plot {
        let axis = |label: &str| Axis { label: label.to_owned(), scale: Scale::Log10, ..Axis::default() };
        Plot {
            title: self.title.clone(),
            x: axis(&self.cost),
            y: axis(&self.error),
            series: named_once(
                self.curves.iter().filter(|c| !c.points.is_empty()).map(Curve::to_series).collect(),
            ),
            size_px: [860.0, 520.0],
        }
    }
}

impl Curve {
    /// A method without points.
    pub fn named(name: String) -> Self {
        Self { name, points: Vec::new(), is_labeled: false, is_joined: true }
    }

    fn to_series(&self) -> Series {
        Series {
            name: self.name.clone(),
            points: self.points.iter().map(|p| [p.cost, p.error]).collect(),
            labels: self.points.iter().filter(|_| self.is_labeled).map(|p| p.setting.clone()).collect(),
            style: if self.is_joined { SeriesStyle::LineAndPoints } else { SeriesStyle::Points },
        }
    }
}

/// The series without the labels of points that are where an earlier one has the same.
fn named_once(mut series: Vec<Series>) -> Vec<Series> {
    let mut named: Vec<([f64; 2], String)> = Vec::new();
    for series in &mut series {
        for (point, label) in series.points.iter().zip(&mut series.labels) {
            if named.iter().any(|(at, name)| (at, name) == (point, label)) {
                label.clear();
            } else {
                named.push((*point, label.clone()));
            }
        }
    }
    series
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
                    is_labeled: true,
                    is_joined: true,
                },
                Curve { points: vec![point("1/60", 0.1, f64::NAN)], ..Curve::named("broken".into()) },
            ],
        }
    }

    #[test]
    fn every_point_that_has_a_place_is_drawn_and_all_are_in_the_table() {
        let svg = diagram().to_plot().standalone_svg();
        assert_eq!(svg.matches("<circle").count(), 2, "{svg}");
        assert!(svg.contains("style B &amp; the wind") && !svg.contains("NaN"));
        assert!(svg.contains("1/240"), "{svg}");
        let table = diagram().to_table();
        assert_eq!(table.rows.len(), 3);
        assert_eq!(table.rows[2][3], Cell::Missing);
    }

    /// A setting that two curves share is named once, a level is drawn across all costs and not named.
    #[test]
    fn what_curves_share_is_named_once() {
        let mut shared = diagram();
        shared.curves[1] = Curve { name: "again".into(), ..shared.curves[0].clone() };
        let svg = shared.with_level("ceiling", Some(10.0)).to_plot().standalone_svg();
        assert_eq!(svg.matches(">1/240</text>").count(), 1, "{svg}");
        assert_eq!((svg.matches("<circle").count(), svg.matches("></text>").count()), (6, 0), "{svg}");
        assert!(svg.contains("ceiling"), "{svg}");
        assert_eq!(diagram().with_level("ceiling", None).curves.len(), 2);
    }

    #[test]
    fn points_that_are_no_settings_are_not_joined() {
        let mut apart = diagram();
        apart.curves[0].is_joined = false;
        assert!(!apart.to_plot().svg().contains("class=\"line\" d="));
    }
}

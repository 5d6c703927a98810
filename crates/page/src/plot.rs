mod axis;
mod label;

pub use axis::{Axis, Scale};

use crate::escape;
use axis::Placed;
use label::Labels;
use std::fmt::Write;

/// Curves over an axis, drawn as SVG.
///
/// In a page the colors come from the page's style and follow its light or dark theme; a file of its own gets
/// the same rules inside ([`Plot::standalone_svg`]). The drawing area and its x range are in `data-`
/// attributes, so that a script can put a cursor into it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// What the plot shows, for people who cannot see it and for the tooltip.
    pub title: String,
    /// The axis to the right.
    pub x: Axis,
    /// The axis upward.
    pub y: Axis,
    /// The curves, back to front.
    pub series: Vec<Series>,
    /// The size in CSS pixels at which text has its natural size: width, height.
    pub size_px: [f64; 2],
}

/// One curve of a [`Plot`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Its name in the legend; empty for none.
    pub name: String,
    /// The points. One that has no place on an axis (NaN; 0 or less on a logarithmic one) interrupts the curve.
    pub points: Vec<[f64; 2]>,
    /// A word at each point, for instance the setting it stands for, or none; may be shorter than `points`. Where other words
    /// leave it no room it is left out.
    pub labels: Vec<String>,
    /// How it is drawn.
    pub style: SeriesStyle,
}

/// How a [`Series`] is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SeriesStyle {
    /// A line.
    #[default]
    Line,
    /// A line with its points marked: one setting each, in a work-precision plot.
    LineAndPoints,
    /// Points only.
    Points,
    /// A line filled down to the axis.
    Area,
}

/// Room for tick labels and titles round the drawing area, px: left, right, top, bottom.
const MARGIN: [f64; 4] = [56.0, 14.0, 12.0, 40.0];

/// Height of a line of the legend, px.
const LEGEND_LINE: f64 = 18.0;

/// How many colors the style sheet has; later series begin again with the first, dashed.
const N_COLORS: usize = 8;

/// The style sheet of a page that shows plots.
pub const PLOT_STYLE: &str =
    concat!(include_str!("../assets/css/plot-in-page.css"), include_str!("../assets/css/plot.css"));

/// The style sheet of a plot in a file of its own, without variables, of which programs that only draw know nothing.
fn own_style() -> String {
    let mut own = String::new();
    let mut left = include_str!("../assets/css/plot.css");
    while let Some((before, variable)) = left.split_once("var(")
        && let Some((_, fallback)) = variable.split_once(", ")
        && let Some((value, after)) = fallback.split_once(')')
    {
        own.push_str(before);
        own.push_str(value);
        left = after;
    }
    own.push_str(left);
    own
}

/// The drawing area and the two scales.
struct Frame {
    x: Placed,
    y: Placed,
    size: [f64; 2],
}

impl Plot {
    /// The plot as an `<svg>` element that takes its colors from the page.
    pub fn svg(&self) -> String {
        self.element(|_| String::new(), "")
    }

    /// The plot as an SVG file.
    pub fn standalone_svg(&self) -> String {
        let style = format!(
            "<style>{}</style>\n<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n",
            own_style()
        );
        let own = |[width, height]: [f64; 2]| {
            format!(" xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\"")
        };
        self.element(own, &style)
    }

    /// The plot with these attributes of its own, which may depend on its size, and this before all else.
    fn element(&self, attributes: impl Fn([f64; 2]) -> String, first: &str) -> String {
        let frame = self.frame();
        let [width, height] = frame.size;
        let attributes = attributes(frame.size);
        let (left, right) = frame.x.ends();
        let (x0, x1) = frame.x.range();
        let title = escape(&self.title);
        let mut svg = format!(
            "<svg{attributes} class=\"plot\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
             aria-label=\"{title}\" data-x0=\"{x0}\" data-x1=\"{x1}\" data-left=\"{left}\" data-right=\"{right}\">\n\
             {first}<title>{title}</title>\n"
        );
        svg.push_str(&self.ticks(&frame));
        let (bottom, top) = frame.y.ends();
        let mut labels = Labels::new([left, right, top, bottom]);
        for (k, series) in self.series.iter().enumerate() {
            svg.push_str(&series.svg(&class(k), &frame, &mut labels));
        }
        svg.push_str(&self.legend(&frame));
        svg.push_str("</svg>\n");
        svg
    }

    fn frame(&self) -> Frame {
        let [width, height] = self.size_px.map(|size| if size > 0.0 { size } else { 480.0 });
        let [left, right, top, bottom] = MARGIN;
        let legend = self.legend_places(width).last().map_or(0.0, |[_, y]| y + 4.0);
        let along = |axis: usize| self.series.iter().flat_map(move |s| s.points.iter().map(move |p| p[axis]));
        Frame {
            x: self.x.place(along(0), left, width - right),
            y: self.y.place(along(1), height - bottom, top + legend),
            size: [width, height],
        }
    }

    fn ticks(&self, frame: &Frame) -> String {
        let (left, right) = frame.x.ends();
        let (bottom, top) = frame.y.ends();
        let mut svg = String::from("<g class=\"axis\">\n");
        for (value, text) in frame.y.ticks() {
            let Some(y) = frame.y.at(value) else { continue };
            let _ = writeln!(
                svg,
                "<line class=\"grid\" x1=\"{left:.1}\" x2=\"{right:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>"
            );
            let _ = writeln!(
                svg,
                "<text class=\"tick end\" x=\"{:.1}\" y=\"{:.1}\">{text}</text>",
                left - 7.0,
                y + 4.0
            );
        }
        for (value, text) in frame.x.ticks() {
            let Some(x) = frame.x.at(value) else { continue };
            let _ = writeln!(
                svg,
                "<line class=\"grid\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{top:.1}\" y2=\"{bottom:.1}\"/>"
            );
            let _ = writeln!(
                svg,
                "<text class=\"tick middle\" x=\"{x:.1}\" y=\"{:.1}\">{text}</text>",
                bottom + 17.0
            );
        }
        let _ = writeln!(
            svg,
            "<text class=\"label middle\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
            (left + right) / 2.0,
            frame.size[1] - 5.0,
            escape(&self.x.title())
        );
        let (x, y) = (13.0, (bottom + top) / 2.0);
        let _ = writeln!(
            svg,
            "<text class=\"label middle\" transform=\"translate({x:.1} {y:.1}) rotate(-90)\">{}</text>\n</g>",
            escape(&self.y.title())
        );
        svg
    }

    /// Where the legend's entries stand, px: as many on a line as fit.
    fn legend_places(&self, width: f64) -> Vec<[f64; 2]> {
        let [left, right, ..] = MARGIN;
        let [mut x, mut y] = [left, LEGEND_LINE - 4.0];
        let named = self.series.iter().filter(|s| !s.name.is_empty());
        let place = |series: &Series| {
            let room = 38.0 + text_width(&series.name);
            if x > left && x + room > width - right {
                [x, y] = [left, y + LEGEND_LINE];
            }
            x += room;
            [x - room, y]
        };
        named.map(place).collect()
    }

    fn legend(&self, frame: &Frame) -> String {
        let mut svg = String::new();
        let named = self.series.iter().enumerate().filter(|(_, s)| !s.name.is_empty());
        for ((k, series), [x, y]) in named.zip(self.legend_places(frame.size[0])) {
            let class = class(k);
            let _ = writeln!(
                svg,
                "<g class=\"{class}\"><line class=\"line\" x1=\"{x:.1}\" x2=\"{:.1}\" y1=\"{:.1}\" y2=\"{:.1}\"/>\
                 <text class=\"tick\" x=\"{:.1}\" y=\"{y:.1}\">{}</text></g>",
                x + 16.0,
                y - 4.0,
                y - 4.0,
                x + 21.0,
                escape(&series.name)
            );
        }
        svg
    }
}

impl Series {
    fn svg(&self, class: &str, frame: &Frame, labels: &mut Labels) -> String {
        let mut svg = format!("<g class=\"{class}\">\n");
        let placed: Vec<Option<[f64; 2]>> =
            self.points.iter().map(|p| Some([frame.x.at(p[0])?, frame.y.at(p[1])?])).collect();
        let runs: Vec<&[Option<[f64; 2]>]> =
            placed.split(Option::is_none).filter(|run| !run.is_empty()).collect();
        let bottom = frame.y.ends().0;
        for run in &runs {
            let path = path(run);
            if self.style == SeriesStyle::Area {
                let ends = [run[0], run[run.len() - 1]].map(|p| p.map_or(0.0, |p| p[0]));
                let _ = writeln!(
                    svg,
                    "<path class=\"area\" d=\"{path}L{:.1} {bottom:.1}L{:.1} {bottom:.1}Z\"/>",
                    ends[1], ends[0]
                );
            }
            if self.style != SeriesStyle::Points {
                let _ = writeln!(svg, "<path class=\"line\" d=\"{path}\"/>");
            }
        }
        if matches!(self.style, SeriesStyle::Points | SeriesStyle::LineAndPoints) {
            for [x, y] in placed.iter().flatten() {
                let _ = writeln!(svg, "<circle class=\"point\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\"/>");
            }
        }
        for (point, label) in placed.iter().zip(&self.labels) {
            let Some(point) = point.filter(|_| !label.is_empty()) else { continue };
            let Some(place) = labels.place(point, label) else { continue };
            let end = if place.is_left { " end" } else { "" };
            let _ = writeln!(
                svg,
                "<text class=\"tick{end}\" x=\"{:.1}\" y=\"{:.1}\">{}</text>",
                place.x,
                place.y,
                escape(label)
            );
        }
        svg.push_str("</g>\n");
        svg
    }
}

/// About how wide a text is, px: it cannot be measured here; 6.4 px is the width of a letter at 11.5 px, with some to spare.
fn text_width(text: &str) -> f64 {
    6.4 * text.chars().count() as f64
}

/// The style sheet's class of a series by its place in the plot.
fn class(series: usize) -> String {
    let again = if series < N_COLORS { "" } else { " again" };
    format!("s{}{again}", series % N_COLORS)
}

fn path(run: &[Option<[f64; 2]>]) -> String {
    let mut path = String::new();
    for (k, [x, y]) in run.iter().flatten().enumerate() {
        let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<[f64; 2]>, scale: Scale) -> Plot {
        Plot {
            x: Axis { label: "time".into(), unit: "s".into(), range: Some([0.0, 2.0]), ..Axis::default() },
            y: Axis { label: "error".into(), scale, ..Axis::default() },
            series: vec![Series { name: "a<b".into(), points, ..Series::default() }],
            size_px: [470.0, 200.0],
            ..Plot::default()
        }
    }

    /// The drawing area is 400 px wide for 2 s: 1 s lies 200 px right of the left margin.
    #[test]
    fn points_fall_where_the_axes_say() {
        let svg = plot(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 0.5]], Scale::Linear).svg();
        assert!(svg.contains("data-left=\"56\" data-right=\"456\""), "{svg}");
        assert!(svg.contains("d=\"M56.0 160.0L256.0 30.0L456.0 95.0\""), "{svg}");
        assert!(svg.contains("a&lt;b") && svg.contains("time (s)"));
    }

    /// In a file of its own a plot says how large it is and what its colors are: programs that only draw know neither variables
    /// nor a page around it.
    #[test]
    fn a_file_of_its_own_needs_no_page() {
        let plot = plot(vec![[0.0, 0.0], [1.0, 1.0]], Scale::Linear);
        let (own, in_page) = (plot.standalone_svg(), plot.svg());
        assert!(!own.contains("var(") && !own.contains("height: auto"), "{own}");
        assert!(own.contains(".plot text { fill: #23262b; }"), "{own}");
        assert!(
            own.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"470\" height=\"200\""),
            "{own}"
        );
        assert!(in_page.starts_with("<svg class=\"plot\""), "{in_page}");
    }

    #[test]
    fn what_has_no_place_interrupts_the_curve() {
        let svg = plot(vec![[0.0, 1.0], [0.5, f64::NAN], [1.0, 10.0], [2.0, 0.0]], Scale::Log10).svg();
        assert_eq!(svg.matches("class=\"line\" d=").count(), 2, "{svg}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    /// Six names of some 190 px on lines of 400 px: two a line, and the drawing area begins below three lines.
    #[test]
    fn a_long_legend_takes_more_lines() {
        let mut plot = plot(vec![[0.0, 0.0], [2.0, 1.0]], Scale::Linear);
        plot.series[0].name = "twenty-three letters wide".into();
        plot.series = vec![plot.series[0].clone(); 6];
        let places = plot.legend_places(470.0);
        assert_eq!(places.iter().map(|p| p[1]).collect::<Vec<_>>(), [14.0, 14.0, 32.0, 32.0, 50.0, 50.0]);
        assert_eq!(plot.frame().y.ends(), (160.0, 66.0));
    }

    #[test]
    fn an_empty_plot_is_still_a_plot() {
        let svg = Plot::default().svg();
        assert!(svg.contains("</svg>") && !svg.contains("NaN"));
    }
}

use crate::{escape, short};
use std::fmt::Write;
use tousle_core::FrameSpan;

/// What happened to many tracks over time, one thin row a track, drawn as SVG.
///
/// Rows stand in groups (the markers of a lock), time runs to the right: frames as the file numbers them below,
/// seconds above. Whatever is drawn says what it is when pointed at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timeline {
    /// What it shows, for people who cannot see it.
    pub title: String,
    /// The number of the first frame.
    pub first_frame: i64,
    /// Frames.
    pub n_frames: usize,
    /// Frames a second.
    pub rate_hz: f64,
    /// The rows.
    pub groups: Vec<TimelineGroup>,
    /// Stretches of time that concern all rows, with what they are.
    pub shaded: Vec<(FrameSpan, String)>,
}

/// Rows that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimelineGroup {
    /// Their name.
    pub name: String,
    /// The rows, top to bottom.
    pub rows: Vec<TimelineRow>,
}

/// One track.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TimelineRow {
    /// Its label.
    pub label: String,
    /// What happened to it, back to front.
    pub events: Vec<TimelineEvent>,
}

/// Something that happened to a track.
#[derive(Clone, Debug, PartialEq)]
pub struct TimelineEvent {
    /// When.
    pub span: FrameSpan,
    /// How it looks.
    pub mark: Mark,
    /// What it is, in words.
    pub text: String,
}

/// How an event looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// As it should be.
    Good,
    /// Nothing is there.
    Hole,
    /// Filled by a model.
    Filled,
    /// Taken from another label.
    Mended,
    /// Taken from a nameless piece.
    GivenBack,
    /// There, and not used.
    Refused,
    /// A short outlier, drawn as a dot that can be seen at any length.
    Spike,
}

/// Room for labels left and right, px.
const LEFT: f64 = 64.0;
const RIGHT: f64 = 1000.0;
const TOP: f64 = 24.0;
/// Height of a row with the space below it, px: thin, for a wig has some 160 markers.
const ROW: f64 = 8.0;
const BAR: f64 = 6.0;
const BETWEEN_GROUPS: f64 = 7.0;

impl Mark {
    /// The class that the style sheet knows.
    pub fn class(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Hole => "hole",
            Self::Filled => "filled",
            Self::Mended => "mended",
            Self::GivenBack => "given",
            Self::Refused => "refused",
            Self::Spike => "spike",
        }
    }
}

impl Timeline {
    /// The timeline as an `<svg>` element that takes its colors from the page.
    pub fn svg(&self) -> String {
        let n_rows: usize = self.groups.iter().map(|g| g.rows.len()).sum();
        let bottom = TOP + n_rows as f64 * ROW + self.groups.len() as f64 * BETWEEN_GROUPS;
        let height = bottom + 24.0;
        let title = escape(&self.title);
        let mut svg = format!(
            "<svg class=\"events\" viewBox=\"0 0 1020 {height:.0}\" role=\"img\" aria-label=\"{title}\">\n"
        );
        self.shades(&mut svg, bottom);
        self.ticks(&mut svg, bottom);
        let mut y = TOP + BETWEEN_GROUPS / 2.0;
        for group in &self.groups {
            let middle = y + group.rows.len() as f64 * ROW / 2.0;
            let _ = writeln!(
                svg,
                "<text class=\"name\" x=\"{:.0}\" y=\"{:.1}\">{}</text>",
                LEFT - 8.0,
                middle + 3.0,
                escape(&group.name)
            );
            for row in &group.rows {
                self.row(&mut svg, row, y);
                y += ROW;
            }
            y += BETWEEN_GROUPS;
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// Where a frame begins, px.
    fn x(&self, frame: i64) -> f64 {
        let place = frame.saturating_sub(self.first_frame) as f64 / self.n_frames.max(1) as f64;
        LEFT + place.clamp(0.0, 1.0) * (RIGHT - LEFT)
    }

    fn ends(&self, span: FrameSpan) -> (f64, f64) {
        (self.x(span.first_frame), self.x(span.last_frame.saturating_add(1)))
    }

    fn shades(&self, svg: &mut String, bottom: f64) {
        for (span, what) in &self.shaded {
            let (from, to) = self.ends(*span);
            let _ = writeln!(
                svg,
                "<rect class=\"shade\" x=\"{from:.1}\" y=\"{TOP}\" width=\"{:.1}\" height=\"{:.1}\"><title>{}</title></rect>",
                to - from,
                bottom - TOP,
                escape(&format!("{what}: {}", self.when(*span)))
            );
        }
    }

    fn ticks(&self, svg: &mut String, bottom: f64) {
        let step = nice_step(self.n_frames as f64 / 10.0).max(1.0) as i64;
        let last = self.first_frame.saturating_add(self.n_frames as i64);
        let mut frame = self.first_frame.div_euclid(step).saturating_mul(step);
        while frame < last {
            if frame >= self.first_frame {
                let (x, y) = (self.x(frame), bottom + 15.0);
                let _ = writeln!(
                    svg,
                    "<line x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{TOP}\" y2=\"{bottom:.1}\"/>\
                     <text class=\"tick\" x=\"{x:.1}\" y=\"{y:.1}\">{frame}</text>"
                );
            }
            frame = frame.saturating_add(step);
        }
        let left = LEFT - 8.0;
        let _ = writeln!(svg, "<text class=\"name\" x=\"{left}\" y=\"{:.1}\">frame</text>", bottom + 15.0);
        let length_secs = self.n_frames as f64 / self.rate_hz;
        let step_secs = nice_step(length_secs / 10.0);
        for k in 0..=(length_secs / step_secs) as usize {
            let secs = k as f64 * step_secs;
            let x = LEFT + secs / length_secs.max(f64::MIN_POSITIVE) * (RIGHT - LEFT);
            let text = short(secs, 3);
            let _ = writeln!(
                svg,
                "<line class=\"second\" x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{:.0}\" y2=\"{TOP}\"/>\
                 <text class=\"tick\" x=\"{x:.1}\" y=\"14\">{text} s</text>",
                TOP - 5.0
            );
        }
    }

    fn row(&self, svg: &mut String, row: &TimelineRow, y: f64) {
        for event in &row.events {
            let (from, to) = self.ends(event.span);
            let tip = escape(&format!("{}: {}, {}", row.label, event.text, self.when(event.span)));
            let class = event.mark.class();
            let _ = if event.mark == Mark::Spike {
                let (x, y) = ((from + to) / 2.0, y + BAR / 2.0);
                writeln!(
                    svg,
                    "<circle class=\"{class}\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.4\"><title>{tip}</title></circle>"
                )
            } else {
                // One frame of a long capture would be too thin to see.
                let width = (to - from).max(1.2);
                writeln!(
                    svg,
                    "<rect class=\"{class}\" x=\"{from:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{BAR}\">\
                     <title>{tip}</title></rect>"
                )
            };
        }
    }

    /// `frames 12 to 30 (0.16 s)`
    fn when(&self, span: FrameSpan) -> String {
        let n = span.n_frames();
        if n == 1 {
            return format!("frame {}", span.first_frame);
        }
        let secs = n as f64 / self.rate_hz;
        format!("frames {} to {} ({n}, {} s)", span.first_frame, span.last_frame, short(secs, 2))
    }
}

/// The next of …, 0.1, 0.2, 0.5, 1, 2, 5, 10, … that is not below.
fn nice_step(least: f64) -> f64 {
    if !(least > 0.0 && least.is_finite()) {
        return 1.0;
    }
    let magnitude = libm::exp10(libm::log10(least).floor());
    [1.0, 2.0, 5.0, 10.0].map(|k| k * magnitude).into_iter().find(|s| *s >= least).unwrap_or(10.0 * magnitude)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn timeline(mark: Mark) -> Timeline {
        let event = TimelineEvent {
            span: FrameSpan { first_frame: 151, last_frame: 200 },
            mark,
            text: "fi<lled".to_owned(),
        };
        let row = TimelineRow { label: "S01_1".to_owned(), events: vec![event] };
        Timeline {
            title: "gaps".to_owned(),
            first_frame: 101,
            n_frames: 100,
            rate_hz: 100.0,
            groups: vec![TimelineGroup { name: "S01".to_owned(), rows: vec![row] }],
            shaded: vec![(FrameSpan { first_frame: 101, last_frame: 110 }, "still".to_owned())],
        }
    }

    /// The second half of the capture is the right half of the drawing.
    #[test]
    fn events_lie_where_they_happened() {
        let svg = timeline(Mark::Filled).svg();
        assert!(svg.contains("<rect class=\"filled\" x=\"532.0\" y=\"27.5\" width=\"468.0\""), "{svg}");
        assert!(svg.contains("S01_1: fi&lt;lled, frames 151 to 200 (50, 0.5 s)"), "{svg}");
        assert!(svg.contains(">110</text>") && svg.contains(">0.1 s</text>"), "{svg}");
        assert!(svg.contains("<title>still: frames 101 to 110 (10, 0.1 s)"), "{svg}");
    }

    #[test]
    fn a_spike_is_a_dot() {
        assert!(timeline(Mark::Spike).svg().contains("<circle class=\"spike\" cx=\"766.0\""));
    }

    #[test]
    fn steps_are_round() {
        assert_eq!([1.0, 1.5, 3.0, 60.0, 0.3, 0.0].map(nice_step), [1.0, 2.0, 5.0, 100.0, 0.5, 1.0]);
    }

    #[test]
    fn an_empty_timeline_is_still_a_drawing() {
        let svg = Timeline { rate_hz: 100.0, ..Timeline::default() }.svg();
        assert!(svg.contains("</svg>") && !svg.contains("NaN"));
    }
}

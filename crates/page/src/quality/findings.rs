use super::QualityPage;
use crate::{decimals, short};
use tousle_clean::CleanReport;
use tousle_core::FrameSpan;

/// One thing worth a look.
pub(super) struct Finding {
    pub weight: Weight,
    pub text: String,
}

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Weight {
    /// Something is lost.
    Serious,
    /// Something may be wrong.
    Look,
    /// Something was mended.
    Changed,
    /// All is well.
    Fine,
}

impl Weight {
    pub(super) fn class(self) -> &'static str {
        match self {
            Self::Serious => "serious",
            Self::Look => "look",
            Self::Changed => "changed",
            Self::Fine => "fine",
        }
    }
}

/// A fill that is expected to be farther off than this is worth a look, m: about the width of a lock.
const DOUBTFUL_FILL_M: f64 = 7e-3;
/// A marker missing for more than this share is worth a look at its camera coverage.
const OFTEN_MISSING: f64 = 0.25;
/// Names listed before the rest is counted.
const MOST_NAMED: usize = 6;

/// What a technician should know before the next take, the worst first.
pub(super) fn findings(page: &QualityPage<'_>) -> Vec<Finding> {
    let mut found = Vec::new();
    head(page, &mut found);
    if let Some(clean) = page.clean {
        locks(page, clean, &mut found);
    }
    if !page.warnings.is_empty() {
        let text = format!("The file is odd in {} ways, listed below.", page.warnings.len());
        let text = if page.warnings.len() == 1 { format!("The file: {}.", page.warnings[0]) } else { text };
        found.push(Finding { weight: Weight::Look, text });
    }
    if found.is_empty() {
        let text = "Nothing stands out.".to_owned();
        found.push(Finding { weight: Weight::Fine, text });
    }
    found.sort_by_key(|f| f.weight);
    found
}

fn head(page: &QualityPage<'_>, found: &mut Vec<Finding>) {
    for gap in &page.head.without_pose {
        let (what_of_it, weight) = match gap.bridged_to_m {
            Some(0.0) => ("It stands still.".to_owned(), Weight::Changed),
            Some(m) => {
                (format!("Its pose is told from those around, to {:.1} mm.", m * 1e3), Weight::Changed)
            }
            None => (
                "The hair is not seen from the head there; its motion is bridged.".to_owned(),
                Weight::Serious,
            ),
        };
        let text = format!("No head pose in {}: {}. {what_of_it}", when(page, gap.span), gap.why);
        found.push(Finding { weight, text });
    }
    for mended in &page.head.labels_mended {
        let text = format!(
            "Head marker {} carried the label {} in {}; it was told by its place on the head.",
            mended.marker,
            mended.label,
            when(page, mended.span)
        );
        found.push(Finding { weight: Weight::Changed, text });
    }
    let left_out: Vec<&str> =
        page.head.markers.iter().filter(|m| m.is_left_out()).map(|m| m.label.as_str()).collect();
    if !left_out.is_empty() {
        let text = format!(
            "{} did not follow the head and {} not used for its pose.",
            named(&left_out),
            if left_out.len() == 1 { "was" } else { "were" }
        );
        found.push(Finding { weight: Weight::Look, text });
    }
    let never_seen: Vec<&str> =
        page.head.markers.iter().filter(|m| m.is_never_seen()).map(|m| m.label.as_str()).collect();
    if !never_seen.is_empty() {
        let text =
            format!("No camera saw the head's {}: the pose is told by the others.", named(&never_seen));
        found.push(Finding { weight: Weight::Look, text });
    }
}

fn locks(page: &QualityPage<'_>, clean: &CleanReport, found: &mut Vec<Finding>) {
    if !clean.unfilled.is_empty() {
        let labels: Vec<&str> = clean.unfilled.iter().map(|u| u.marker.as_str()).collect();
        let text = format!("Could not be filled: {} ({}).", named(&labels), clean.unfilled[0].why);
        found.push(Finding { weight: Weight::Serious, text });
    }
    let doubtful: Vec<&str> = clean
        .gaps
        .iter()
        .filter(|g| g.expected_error_m > DOUBTFUL_FILL_M)
        .map(|g| g.marker.as_str())
        .collect();
    if !doubtful.is_empty() {
        let text = format!(
            "Filled, but expected to be more than {} mm off in part: {}.",
            short(DOUBTFUL_FILL_M * 1e3, 1),
            named(&unique(&doubtful))
        );
        found.push(Finding { weight: Weight::Look, text });
    }
    let share = |spans: &[FrameSpan]| {
        spans.iter().map(FrameSpan::n_frames).sum::<u64>() as f64 / page.n_frames.max(1) as f64
    };
    let often: Vec<&str> = clean
        .markers
        .iter()
        .filter(|m| share(&m.filled) > OFTEN_MISSING)
        .map(|m| m.marker.as_str())
        .collect();
    if !often.is_empty() {
        let text = format!("Not seen in more than a quarter of the frames: {}.", named(&often));
        found.push(Finding { weight: Weight::Look, text });
    }
    let filled = clean.markers.iter().flat_map(|m| m.filled.iter().map(move |span| (&m.marker, span)));
    if let Some((marker, span)) = filled.max_by_key(|(_, span)| span.n_frames()) {
        let parts = clean.gaps.iter().filter(|g| g.marker == *marker && holds(*span, g.span));
        let worst = parts.map(|g| g.expected_error_m).fold(f64::NAN, f64::max);
        let text = format!(
            "The longest gap is {marker}'s, {}: filled, at worst {} mm off as far as can be told.",
            when(page, *span),
            decimals(worst * 1e3, 1)
        );
        found.push(Finding { weight: Weight::Changed, text });
    }
    for swap in &clean.swaps {
        let [a, b] = &swap.markers;
        let text = format!("{a} and {b} had exchanged labels in {}; mended.", when(page, swap.span));
        found.push(Finding { weight: Weight::Changed, text });
    }
}

/// `frames 12 to 30 (0.16 s)`
fn when(page: &QualityPage<'_>, span: FrameSpan) -> String {
    match span.n_frames() {
        1 => format!("frame {}", span.first_frame),
        n => {
            let secs = short(page.secs(n), 2);
            format!("frames {} to {} ({secs} s)", span.first_frame, span.last_frame)
        }
    }
}

fn holds(outer: FrameSpan, inner: FrameSpan) -> bool {
    outer.first_frame <= inner.first_frame && inner.last_frame <= outer.last_frame
}

fn unique<'a>(labels: &[&'a str]) -> Vec<&'a str> {
    let mut unique: Vec<&str> = Vec::new();
    for label in labels {
        if !unique.contains(label) {
            unique.push(label);
        }
    }
    unique
}

/// A list in words, cut where it would be too long.
fn named(labels: &[&str]) -> String {
    let shown = labels[..labels.len().min(MOST_NAMED)].join(", ");
    match labels.len().saturating_sub(MOST_NAMED) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_counted() {
        assert_eq!(named(&["a", "b"]), "a, b");
        assert_eq!(named(&["a"; 9]), "a, a, a, a, a, a and 3 more");
        assert_eq!(unique(&["a", "b", "a"]), ["a", "b"]);
    }
}

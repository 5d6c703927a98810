use super::Layout;
use super::claims::{ALL_THAT_FIT, Claim, Claims, QUANTITIES, Source, WRAPPED, claims_of};
use crate::io::reader::header::Start;
use crate::parameter::Parameters;
use crate::{BLOCK, Header, Quantity, Storage, Warning};

/// The claims that explain the file's size best.
pub(super) struct Choice {
    pub layout: Layout,
    /// Bytes from the first frame to the end of the data.
    pub data_bytes: u64,
}

/// How a layout fits the file, best first.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Fit {
    /// Less than a block is left over: files are padded to whole blocks.
    Exact,
    /// More is left over.
    Loose,
    /// The file is too short.
    Short,
}

/// Tries every combination of claims. The best fit wins; among equals, the one of most trust.
pub(super) fn choose(start: &Start, parameters: &Parameters, warnings: &mut Vec<Warning>) -> Choice {
    let claims = claims_of(start, parameters);
    let data_end = data_end(start, parameters);
    let candidates = combinations(&claims).map(|(distrust, chosen)| {
        let (choice, fit) = try_out(start, data_end, chosen);
        ((fit, distrust), chosen, choice)
    });
    let (_, chosen, choice) = candidates
        .min_by_key(|(key, ..)| *key)
        .expect("every quantity has a claim, so there is a combination");
    report(&claims, chosen, &choice.layout, warnings);
    choice
}

/// One claim of each quantity, and how far down the lists of trust it lies, in every combination.
fn combinations(claims: &[Claims; 5]) -> impl Iterator<Item = (usize, [Claim; 5])> + '_ {
    let n_combinations = claims.iter().map(|c| c.claims.len()).product();
    (0..n_combinations).map(|combination: usize| {
        let mut rest = combination;
        let mut distrust = 0;
        let chosen = claims.each_ref().map(|c| {
            let idx = rest % c.claims.len();
            rest /= c.claims.len();
            distrust += idx;
            c.claims[idx]
        });
        (distrust, chosen)
    })
}

fn try_out(start: &Start, data_end: u64, chosen: [Claim; 5]) -> (Choice, Fit) {
    let [points, words, frames, scale, block] = chosen.map(|c| c.value);
    let data_start = start.block_start(block as u64).unwrap_or(data_end);
    let data_bytes = data_end.saturating_sub(data_start);
    let mut layout = Layout {
        processor: start.processor,
        storage: if scale < 0.0 { Storage::Float32 } else { Storage::Int16 },
        scale: scale.abs() as f32,
        n_points: points as u64,
        analog_words: words as u64,
        n_frames: 0,
        data_start,
    };
    let frame_bytes = layout.frame_bytes();
    layout.n_frames = n_frames(frames, &start.header, data_bytes.checked_div(frame_bytes).unwrap_or(0));
    let fit = match data_bytes.checked_sub(layout.n_frames.saturating_mul(frame_bytes)) {
        None => Fit::Short,
        Some(n_left) if n_left < BLOCK || frame_bytes == 0 || frames == ALL_THAT_FIT => Fit::Exact,
        Some(_) => Fit::Loose,
    };
    (Choice { layout, data_bytes }, fit)
}

/// The frames that a claim stands for where so many fit.
fn n_frames(claim: f64, header: &Header, n_fitting: u64) -> u64 {
    let by_header = u64::from(header.last_frame.wrapping_sub(header.first_frame).wrapping_add(1));
    match claim {
        ALL_THAT_FIT => n_fitting,
        WRAPPED => by_header + n_fitting.saturating_sub(by_header) / 65536 * 65536,
        _ => claim.max(0.0) as u64,
    }
}

/// Where the data ends: at the rotations, which stand behind it, or at the end of the file.
fn data_end(start: &Start, parameters: &Parameters) -> u64 {
    let data_start = start.block_start(u64::from(start.header.data_block)).unwrap_or(start.section_start);
    let rotations = parameters.count("ROTATION", "DATA_START").and_then(|block| start.block_start(block));
    let has_rotations = parameters.count("ROTATION", "USED").is_some_and(|n| n > 0);
    rotations
        .filter(|&end| has_rotations && end > data_start)
        .unwrap_or(start.file_bytes)
        .min(start.file_bytes)
}

fn report(claims: &[Claims; 5], chosen: [Claim; 5], layout: &Layout, warnings: &mut Vec<Warning>) {
    for ((quantity, claims), chosen) in QUANTITIES.into_iter().zip(claims).zip(chosen) {
        let header = claims.header;
        let used = if quantity == Quantity::Frames { layout.n_frames as f64 } else { chosen.value };
        if chosen.source == Source::Derived {
            warnings.push(match quantity {
                Quantity::Scale => Warning::NoScale { assumed: used as f32 },
                _ => Warning::Fitted { quantity, header, used },
            });
        }
        for claim in claims.claims.iter().chain(&claims.impossible) {
            if let Source::Parameter(parameter) = claim.source {
                let stated = claim.value;
                warnings.push(Warning::Contradiction { quantity, header, parameter, stated, used });
            }
        }
    }
}

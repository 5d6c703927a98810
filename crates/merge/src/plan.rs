use crate::{Input, MergeError, MergeOptions, Span, agree, layers};
use tousle_core::{MAX_SECS, Quantity, Vec3};
use tousle_field::{FieldLayer, GridError, GridSpec, MAX_VOXELS, Scene};

/// The most steps of a merged field for each of the input that has most: between steps it is linear, so more say nothing.
const MAX_RATE: f64 = 4.0;

/// The most steps of a merged field, and of its measured vectors: a day and more at 100 Hz. Fields far apart would have
/// more, nearly all of them empty or alike, and every one takes memory.
pub(crate) const MAX_STEPS: f64 = 1e7;

/// What a merged field will be, and which steps of which input it needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Where its voxels are: the inputs' grid, or where they differ one of the finest edge that holds them all.
    pub grid: GridSpec,
    /// What its vectors are.
    pub quantity: Quantity,
    /// Time of its first step on the common clock, s.
    pub start_secs: f64,
    /// Steps a second.
    pub rate_hz: f64,
    /// How many steps it has.
    pub n_steps: u64,
    /// The edits of all inputs, on the common clock, each once and each id once.
    pub layers: Vec<FieldLayer>,
    /// What a user should know of that.
    pub warnings: Vec<String>,
    /// The first input's scene, on the common clock; the others' are the same to within the tolerances.
    pub scene: Scene,
    inputs: Vec<Times>,
}

/// When an input has steps, common clock.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Times {
    grid: GridSpec,
    start_secs: f64,
    rate_hz: f64,
    n_steps: u64,
}

/// Two neighboring steps of an input, and the share of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    /// The step at or before a time.
    pub before: u64,
    /// The step after it; the same one where the time is a step's own.
    pub after: u64,
    /// The share of the second, 0 to 1.
    pub share: f64,
}

/// How far a time may be from a step's and still be taken for it, in steps.
const SAME_STEP: f64 = 1e-6;

impl Times {
    fn end_secs(&self) -> f64 {
        self.start_secs + (self.n_steps - 1) as f64 / self.rate_hz
    }

    /// Where a time is between the steps; `None` outside them. A single step stands for all times.
    fn between(&self, secs: f64) -> Option<Between> {
        if self.n_steps == 1 {
            return Some(Between { before: 0, after: 0, share: 0.0 });
        }
        let place = (secs - self.start_secs) * self.rate_hz;
        let last = self.n_steps - 1;
        if !(-SAME_STEP..=last as f64 + SAME_STEP).contains(&place) {
            return None;
        }
        let nearest = place.round();
        if (place - nearest).abs() <= SAME_STEP {
            let step = nearest as u64;
            return Some(Between { before: step, after: step, share: 0.0 });
        }
        let before = place as u64;
        Some(Between { before, after: before + 1, share: place - before as f64 })
    }
}

impl Plan {
    /// Plans the merging of fields.
    ///
    /// # Errors
    /// [`MergeError`] if the fields are not of one wig in one wind (it says in what they differ), or have a gap
    /// between them, or begin before 0 s or end after [`MAX_SECS`], or would have too many steps.
    pub fn new(inputs: &[Input<'_>], options: &MergeOptions) -> Result<Self, MergeError> {
        let [first, others @ ..] = inputs else { return Err(MergeError::TooFew { found: 0 }) };
        if others.is_empty() {
            return Err(MergeError::TooFew { found: 1 });
        }
        let times: Vec<Times> = inputs.iter().map(times).collect();
        for (input, times) in inputs.iter().zip(&times) {
            if !input.offset_secs.is_finite() {
                let (found, expected) = (input.offset_secs, "a finite number of seconds");
                return Err(MergeError::BadOption { what: "offset", found, expected });
            }
            if times.start_secs < 0.0 {
                let name = input.name.to_owned();
                return Err(MergeError::BeforeZero { name, start_secs: times.start_secs });
            }
            if times.end_secs() > MAX_SECS {
                let name = input.name.to_owned();
                return Err(MergeError::TooLate { name, end_secs: times.end_secs() });
            }
        }
        let span_secs = span(&times, options.span)?;
        let (rate_hz, n_steps) = steps(&times, span_secs, options)?;
        let (layers, warnings) = layers::join(inputs);
        let plan = Self {
            grid: grid(&times)?,
            quantity: first.quantity,
            start_secs: span_secs[0],
            rate_hz,
            n_steps,
            layers,
            warnings,
            scene: scene(first),
            inputs: times,
        };
        if let Some(k) = (0..n_steps).find(|k| (0..inputs.len()).all(|i| plan.wanted(i, *k).is_none())) {
            return Err(MergeError::Gap { at_secs: plan.step_secs(k) });
        }
        for input in others {
            agree::check(first, input, span_secs, options)?;
        }
        Ok(plan)
    }

    /// The time of a step, common clock, s.
    pub fn step_secs(&self, k: u64) -> f64 {
        self.start_secs + k as f64 / self.rate_hz
    }

    /// Which steps of an input say something of step `k`; `None` if it has none at that time.
    pub fn wanted(&self, input: usize, k: u64) -> Option<Between> {
        self.inputs.get(input)?.between(self.step_secs(k))
    }

    /// The grid of an input.
    pub(crate) fn grid_of(&self, input: usize) -> &GridSpec {
        &self.inputs[input].grid
    }
}

fn times(input: &Input<'_>) -> Times {
    Times {
        grid: input.grid,
        start_secs: input.start_secs + input.offset_secs,
        rate_hz: input.rate_hz,
        n_steps: input.n_steps.max(1),
    }
}

/// From when to when. Single steps stand for all times and bound nothing, unless there are no others.
fn span(times: &[Times], span: Span) -> Result<[f64; 2], MergeError> {
    let bounding: Vec<&Times> = times.iter().filter(|t| t.n_steps > 1).collect();
    let bounding = if bounding.is_empty() { times.iter().take(1).collect() } else { bounding };
    let starts = bounding.iter().map(|t| t.start_secs);
    let ends = bounding.iter().map(|t| t.end_secs());
    let (from, to) = match span {
        Span::All => (starts.fold(f64::INFINITY, f64::min), ends.fold(f64::NEG_INFINITY, f64::max)),
        Span::Common => (starts.fold(f64::NEG_INFINITY, f64::max), ends.fold(f64::INFINITY, f64::min)),
    };
    if from <= to { Ok([from, to]) } else { Err(MergeError::NoCommonSpan { from_secs: from, to_secs: to }) }
}

fn steps(times: &[Times], [from, to]: [f64; 2], options: &MergeOptions) -> Result<(f64, u64), MergeError> {
    if let Some(found) = options.rate_hz.filter(|r| !(r.is_finite() && *r > 0.0)) {
        return Err(MergeError::BadOption { what: "rate", found, expected: "a number above 0 Hz" });
    }
    if times.iter().all(|t| t.n_steps == 1) {
        return Ok((times[0].rate_hz, 1));
    }
    let highest = times.iter().filter(|t| t.n_steps > 1).map(|t| t.rate_hz).fold(0.0, f64::max);
    let rate_hz = options.rate_hz.unwrap_or(highest);
    if rate_hz > MAX_RATE * highest {
        let expected = "no more than four times the steps of the input that has most";
        return Err(MergeError::BadOption { what: "rate", found: rate_hz, expected });
    }
    let n_steps = ((to - from) * rate_hz + SAME_STEP).floor() + 1.0;
    if n_steps > MAX_STEPS {
        return Err(MergeError::TooManySteps { found: n_steps, span_secs: [from, to], rate_hz });
    }
    Ok((rate_hz, n_steps as u64))
}

/// The grid that all inputs have, or one of the finest edge that holds all of theirs.
fn grid(times: &[Times]) -> Result<GridSpec, GridError> {
    let first = times[0].grid;
    if times.iter().all(|t| is_same(&t.grid, &first)) {
        return Ok(first);
    }
    let finest = times.iter().map(|t| t.grid).fold(first, |a, b| if b.edge_m < a.edge_m { b } else { a });
    let edge_m = finest.edge_m;
    // In voxels of the finest grid; a hair's breadth less, so that rounding adds no layer.
    let whole = |x: f64| (x / edge_m - 1e-6).ceil().max(0.0);
    let more = |along: &dyn Fn(&GridSpec, usize) -> f64| {
        [0, 1, 2].map(|a| whole(times.iter().map(|t| along(&t.grid, a)).fold(0.0, f64::max)))
    };
    let low = more(&|grid, a| finest.origin_m[a] - grid.origin_m[a]);
    let high = more(&|grid, a| grid.far_corner_m()[a] - finest.far_corner_m()[a]);
    let dims = [0, 1, 2].map(|a| finest.dims[a] as f64 + low[a] + high[a]);
    let n: f64 = dims.iter().product();
    if n > MAX_VOXELS as f64 {
        return Err(GridError::TooMany { found: n });
    }
    let origin_m = finest.origin_m - Vec3::from(low) * edge_m;
    Ok(GridSpec { origin_m, edge_m, dims: dims.map(|n| n as usize) })
}

/// Whether two grids are one, to within a millionth of a voxel.
pub(crate) fn is_same(a: &GridSpec, b: &GridSpec) -> bool {
    let close = |x: f64, y: f64| (x - y).abs() <= 1e-6 * a.edge_m;
    a.dims == b.dims
        && (a.edge_m - b.edge_m).abs() * a.dims.into_iter().max().unwrap_or(1) as f64 <= 1e-6 * a.edge_m
        && (0..3).all(|axis| close(a.origin_m[axis], b.origin_m[axis]))
}

/// An input's scene on the common clock, without the poses that are before 0 s.
fn scene(input: &Input<'_>) -> Scene {
    let mut scene = input.scene.clone();
    let poses = &mut scene.poses;
    let start_secs = poses.start_secs + input.offset_secs;
    let n_before = ((-start_secs * poses.rate_hz).ceil().max(0.0) as usize).min(poses.poses.len() - 1);
    poses.poses.drain(..n_before);
    poses.start_secs = f64::max(start_secs + n_before as f64 / poses.rate_hz, 0.0);
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{input, scene};

    fn problem(inputs: &[Input<'_>]) -> String {
        Plan::new(inputs, &MergeOptions::default()).unwrap_err().to_string()
    }

    #[test]
    fn fields_that_meet_have_all_their_steps() {
        let scene = scene();
        let late = Input { offset_secs: 0.2, ..input("late", &scene) };
        let plan = Plan::new(&[input("early", &scene), late], &MergeOptions::default()).unwrap();
        assert_eq!((plan.start_secs, plan.rate_hz, plan.n_steps), (0.0, 10.0, 5));
    }

    /// As many steps as there is memory for, and times that the file can say, also of single steps.
    #[test]
    fn fields_far_apart_are_refused() {
        let scene = scene();
        let early = input("early", &scene);
        let at = |offset_secs: f64| Input { offset_secs, ..input("late", &scene) };
        let single = |offset_secs: f64| Input { n_steps: 1, ..at(offset_secs) };
        for offset_secs in [1e6, 1e10, 1e18, 1e25] {
            let says = "s with its offset, expected 1000000 s or earlier";
            for found in [problem(&[early, at(offset_secs)]), problem(&[at(offset_secs), early])] {
                assert!(found.starts_with("late ends at 1000000") && found.ends_with(says), "{found}");
            }
        }
        let found = problem(&[single(0.0), single(1e10)]);
        assert_eq!(found, "late ends at 10000000000 s with its offset, expected 1000000 s or earlier");
        assert_eq!(
            problem(&[early, at(1e5)]),
            "no field has anything at 0.3 s; expected fields that overlap or meet"
        );
        let fast = Input { rate_hz: 100.0, ..at(2e5) };
        assert_eq!(
            problem(&[early, single(0.0), fast]),
            "found 20000003 steps from 0 s to 200000.02 s at 100 Hz, expected at most 10000000"
        );
    }
}

use crate::io::reader::header::Start;
use crate::parameter::{Parameters, Value};
use crate::{BLOCK, Quantity};

/// The quantities that header and parameters both state and that say where samples stand.
pub(super) const QUANTITIES: [Quantity; 5] =
    [Quantity::Points, Quantity::AnalogWords, Quantity::Frames, Quantity::Scale, Quantity::DataStart];

/// What a file says of one quantity, in order of trust.
#[derive(Debug)]
pub(super) struct Claims {
    pub claims: Vec<Claim>,
    /// Parameters whose statement cannot be, such as a data start of 0.
    pub impossible: Vec<Claim>,
    /// The header's statement, whether it can be or not.
    pub header: f64,
}

/// A number and where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Claim {
    pub value: f64,
    pub source: Source,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    Header,
    /// A parameter that says otherwise than the header.
    Parameter(&'static str),
    /// A parameter that says what does not fit into the header's 16 bits: no contradiction.
    Longer,
    /// Nothing says so, but it would explain the file.
    Derived,
}

/// "As many frames as fit", where the file does not say how many there are.
pub(super) const ALL_THAT_FIT: f64 = f64::INFINITY;

/// "So many times 65,536 frames more than the header says as fit", where its 16 bits may have wrapped.
pub(super) const WRAPPED: f64 = f64::NEG_INFINITY;

/// The claims of each of [`QUANTITIES`]; every one has at least one claim.
pub(super) fn claims_of(start: &Start, parameters: &Parameters) -> [Claims; 5] {
    [
        points(start, parameters),
        analog_words(start, parameters),
        frames(start, parameters),
        scale(start, parameters),
        data_block(start, parameters),
    ]
}

impl Claims {
    fn new(header: f64) -> Self {
        Self { claims: Vec::new(), impossible: Vec::new(), header }
    }

    /// Adds a claim unless one before it says the same.
    fn add(&mut self, value: f64, source: Source) {
        if self.claims.iter().all(|c| c.value != value) {
            self.claims.push(Claim { value, source });
        }
    }

    fn add_header(&mut self) {
        self.add(self.header, Source::Header);
    }

    /// Adds what a parameter says, if it says anything, to the claims or to what cannot be.
    fn add_parameter(&mut self, name: &'static str, value: Option<f64>, is_usable: impl Fn(f64) -> bool) {
        let source = Source::Parameter(name);
        match value {
            None => {}
            Some(value) if is_usable(value) => self.add(value, source),
            Some(value) => self.impossible.push(Claim { value, source }),
        }
    }
}

fn points(start: &Start, parameters: &Parameters) -> Claims {
    let mut claims = Claims::new(f64::from(start.header.n_points));
    claims.add_header();
    if let Some(used) = parameters.count("POINT", "USED").filter(|&n| n <= 0xffff) {
        claims.add(used as f64, Source::Parameter("POINT:USED"));
        // Where sizes decide nothing, the number of labels does.
        if parameters.long_texts("POINT", "LABELS").len() as u64 == used {
            claims.claims.reverse();
        }
    }
    claims
}

fn analog_words(start: &Start, parameters: &Parameters) -> Claims {
    let words = f64::from(start.header.analog_words);
    let samples = f64::from(start.header.analog_samples);
    let mut claims = Claims::new(words);
    claims.add_header();
    let Some(used) = parameters.count("ANALOG", "USED").filter(|&n| n <= 0xffff) else { return claims };
    let used = used as f64;
    claims.add(used * samples.max(1.0), Source::Parameter("ANALOG:USED"));
    let rates = parameters.number("ANALOG", "RATE").zip(parameters.number("POINT", "RATE"));
    if let Some((analog, point)) = rates.filter(|(analog, point)| *analog > 0.0 && *point > 0.0) {
        let ratio = (analog / point).round().clamp(1.0, 65535.0);
        claims.add(used * ratio, Source::Parameter("ANALOG:RATE"));
    }
    claims
}

/// Frame counts have 16 bits in the header; longer trials say 65535 there and the truth in parameters. Some writers drop the bits
/// above, and say the truth nowhere.
fn frames(start: &Start, parameters: &Parameters) -> Claims {
    let (first, last) = (f64::from(start.header.first_frame), f64::from(start.header.last_frame));
    let mut claims = Claims::new(last - first + 1.0);
    let is_full = start.header.last_frame == 0xffff;
    let stated = [
        ("TRIAL:ACTUAL_END_FIELD", trial_frames(parameters)),
        ("POINT:LONG_FRAMES", parameters.count("POINT", "LONG_FRAMES")),
        ("POINT:FRAMES", parameters.count("POINT", "FRAMES")),
    ];
    let stated = stated.into_iter().filter_map(|(name, n)| Some((name, n.filter(|n| *n > 0)? as f64)));
    let (longer, others): (Vec<_>, Vec<_>) = stated.partition(|(_, n)| is_full && *n > claims.header);
    for (_, n) in &longer {
        claims.add(*n, Source::Longer);
    }
    if longer.is_empty() {
        claims.add_header();
        if last < first {
            claims.add(claims.header + 65536.0, Source::Derived);
        }
        for (name, n) in others {
            claims.add(n, Source::Parameter(name));
        }
        let is_untold = claims.claims.iter().all(|c| c.value <= 0.0);
        if !is_full {
            claims.add(WRAPPED, Source::Derived);
        }
        if is_full || is_untold {
            claims.add(ALL_THAT_FIT, Source::Derived);
        }
    }
    claims
}

fn scale(start: &Start, parameters: &Parameters) -> Claims {
    let is_usable = |scale: f64| scale.is_finite() && scale != 0.0;
    let mut claims = Claims::new(f64::from(start.header.scale));
    if is_usable(claims.header) {
        claims.add_header();
    }
    claims.add_parameter("POINT:SCALE", parameters.number("POINT", "SCALE"), is_usable);
    if claims.claims.is_empty() {
        claims.add(-1.0, Source::Derived);
        claims.add(1.0, Source::Derived);
    }
    claims
}

fn data_block(start: &Start, parameters: &Parameters) -> Claims {
    let is_usable = |block: f64| {
        let place = start.block_start(block as u64);
        block > 1.0 && place.is_some_and(|p| p <= start.file_bytes && p != start.section_start)
    };
    let mut claims = Claims::new(f64::from(start.header.data_block));
    if is_usable(claims.header) {
        claims.add_header();
    }
    let stated = parameters.count("POINT", "DATA_START").map(|n| n as f64);
    claims.add_parameter("POINT:DATA_START", stated, is_usable);
    if claims.claims.is_empty() {
        // Behind the parameter section, which is where data nearly always stands.
        let block = (start.section_start - start.base) / BLOCK + 1;
        let behind = block as f64 + f64::from(start.section_blocks);
        claims.add(behind, Source::Derived);
    }
    claims
}

/// The number of frames by `TRIAL:ACTUAL_START_FIELD` and `ACTUAL_END_FIELD`.
fn trial_frames(parameters: &Parameters) -> Option<u64> {
    let first = trial_frame(parameters, "ACTUAL_START_FIELD")?;
    let last = trial_frame(parameters, "ACTUAL_END_FIELD")?;
    Some(u64::from(last.checked_sub(first)?) + 1)
}

/// A frame number of 32 bits in two words, the lower one first.
pub(super) fn trial_frame(parameters: &Parameters, name: &str) -> Option<u32> {
    let parameter = parameters.get("TRIAL", name)?;
    match &parameter.value {
        Value::Integers(words) => {
            let word = |i: usize| words.get(i).map(|&w| u32::from(w.cast_unsigned()));
            Some(word(0)? | word(1).unwrap_or(0) << 16)
        }
        _ => u32::try_from(parameter.count()?).ok(),
    }
}

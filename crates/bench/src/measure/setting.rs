use super::Worse;
use tousle_fit::{FitMethod, PaperOptions, PhysicalOptions};
use tousle_refine::RefineOptions;

/// How the wind is measured, and on how good a capture.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// What is varied.
    pub varied: &'static str,
    /// The setting in words.
    pub words: String,
    /// The method.
    pub fit: FitMethod,
    /// Whether and how the closed loop is gone round.
    pub refine: Option<RefineOptions>,
    /// Edge of a voxel, m.
    pub edge_m: f64,
    /// Time steps a second.
    pub rate_hz: f64,
    /// What is done to the capture first.
    pub worse: Worse,
}

impl Setting {
    /// Both methods as they are by default, `physical` with locks held out, and on what perfect cameras would have seen.
    pub fn methods() -> Vec<Self> {
        let paper = Self {
            words: "paper".into(),
            fit: FitMethod::Paper(PaperOptions::default()),
            refine: None,
            ..Self::usual()
        };
        let refined = Self {
            words: "physical --refine".into(),
            refine: Some(RefineOptions::default()),
            ..Self::usual()
        };
        vec![paper, Self::usual(), refined, Self::of("dirt", "none".into(), Worse::Clean)]
    }

    /// The method `physical`, one thing varied at a time.
    pub fn varied() -> Vec<Self> {
        let edge =
            |mm: f64| Self { edge_m: mm * 1e-3, ..Self::of("voxel", format!("{mm:.0} mm"), Worse::Not) };
        let rate = |hz: f64| Self { rate_hz: hz, ..Self::of("rate", format!("{hz:.0} Hz"), Worse::Not) };
        let mut settings: Vec<Self> = [10.0, 30.0, 60.0].map(edge).into();
        settings.extend([15.0, 60.0].map(rate));
        settings.push(Self { refine: None, ..Self::of("refine", "not at all".into(), Worse::Not) });
        settings.extend([1, 4].map(|rounds| Self {
            refine: Some(RefineOptions { rounds, ..RefineOptions::default() }),
            ..Self::of("refine", format!("at most {rounds} rounds"), Worse::Not)
        }));
        let with = |varied, words: &str, worse| Self::of(varied, words.to_owned(), worse);
        settings.extend([
            with("markers", "every second of a lock", Worse::EverySecondMarker),
            with("locks", "14", Worse::Locks(14)),
            with("locks", "7", Worse::Locks(7)),
            with("noise", "0.5 mm more", Worse::Noise(0.5e-3)),
            with("noise", "1 mm more", Worse::Noise(1e-3)),
            with("gaps", "10 % more", Worse::Gaps(0.1)),
            with("gaps", "30 % more", Worse::Gaps(0.3)),
        ]);
        settings
    }

    /// The method `physical` as it is, and with each constant that was chosen by looking at captures set lower and higher.
    pub fn choices() -> Vec<Self> {
        let with = |words: &str, change: &dyn Fn(&mut PhysicalOptions)| {
            let mut options = PhysicalOptions::default();
            change(&mut options);
            Self { fit: FitMethod::Physical(options), ..Self::of("choice", words.to_owned(), Worse::Not) }
        };
        vec![
            with("as it is", &|_| ()),
            with("cutoff 8 Hz", &|o| o.cutoff_hz = 8.0),
            with("cutoff 16 Hz", &|o| o.cutoff_hz = 16.0),
            with("swirls of 10 cm", &|o| o.swirl_length_m = 0.10),
            with("swirls of 18 cm", &|o| o.swirl_length_m = 0.18),
            with("bends off by 0.08", &|o| o.bend_error_rad = 0.08),
            with("bends off by 0.20", &|o| o.bend_error_rad = 0.20),
            with("errors last 0.05 s", &|o| o.errors_last_secs = 0.05),
            with("errors last 0.2 s", &|o| o.errors_last_secs = 0.2),
            with("0.3 of errors fleeting", &|o| o.fleeting_share = 0.3),
            with("0.7 of errors fleeting", &|o| o.fleeting_share = 0.7),
        ]
    }

    fn usual() -> Self {
        Self::of("method", "physical".into(), Worse::Not)
    }

    fn of(varied: &'static str, words: String, worse: Worse) -> Self {
        let fit = FitMethod::Physical(PhysicalOptions::default());
        let refine = Some(RefineOptions::quick());
        Self { varied, words, fit, refine, edge_m: 0.02, rate_hz: 30.0, worse }
    }
}

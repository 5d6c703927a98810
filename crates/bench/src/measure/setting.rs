use super::Worse;
use tousle_fit::{FitMethod, PaperOptions, PaperReading, PhysicalOptions};
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

/// The readings of E3, the literal one first.
const READINGS: [PaperReading; 3] =
    [PaperReading::FirstFrame, PaperReading::SlidingWindow, PaperReading::RestPose];

impl Setting {
    /// What is varied where nothing is but the method.
    pub const AS_IT_IS: &'static str = "method";

    /// Both methods as they are by default, `physical` with locks held out, and on what perfect cameras would have seen.
    pub fn methods() -> Vec<Self> {
        vec![Self::paper(), Self::usual(), Self::refined(), Self::of("dirt", "none".into(), Worse::Clean)]
    }

    /// One thing varied at a time: first readings, voxels and rates of the method `paper`, then all that `physical` has.
    pub fn varied() -> Vec<Self> {
        let default = PaperOptions::default().reading;
        let of_paper = READINGS.into_iter().filter(|reading| *reading != default).map(|reading| Self {
            varied: "reading",
            words: format!("paper, {}", reading.name()),
            fit: FitMethod::Paper(PaperOptions { reading, ..PaperOptions::default() }),
            ..Self::paper()
        });
        let mut settings: Vec<Self> = of_paper.collect();
        settings.extend(Self::finer_and_coarser(&Self::paper(), "paper, "));
        settings.extend(Self::finer_and_coarser(&Self::usual(), ""));
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
            with("rest", "never seen", Worse::RestUnseen),
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
            with("bends off by 0.04", &|o| o.bend_error_rad = 0.04),
            with("bends off by 0.08", &|o| o.bend_error_rad = 0.08),
            with("errors last 0.1 s", &|o| o.errors_last_secs = 0.1),
            with("errors last 0.2 s", &|o| o.errors_last_secs = 0.2),
            with("0.3 of errors fleeting", &|o| o.fleeting_share = 0.3),
            with("0.7 of errors fleeting", &|o| o.fleeting_share = 0.7),
        ]
    }

    /// The method's name: `paper`, `physical`, or with locks held out `physical --refine`.
    pub fn method(&self) -> &'static str {
        match (&self.fit, &self.refine) {
            (FitMethod::Paper(_), _) => "paper",
            (FitMethod::Physical(_), Some(RefineOptions { held_out: Some(_), .. })) => "physical --refine",
            (FitMethod::Physical(_), _) => "physical",
        }
    }

    /// How much there is of what is varied, which puts settings in order: mm of voxels or noise, steps a second, rounds of the
    /// closed loop, the share of a lock's markers, locks, the share of gaps.
    pub fn level(&self) -> f64 {
        self.level_of(self.varied)
    }

    /// How much a method as it is by default has of what is varied of it.
    pub(super) fn usual_level(method: &str, varied: &str) -> f64 {
        let usual = Self::methods().into_iter().find(|setting| setting.method() == method);
        usual.map_or(f64::NAN, |usual| usual.level_of(varied))
    }

    fn level_of(&self, varied: &str) -> f64 {
        match (varied, &self.fit, self.worse) {
            ("voxel", ..) => 1e3 * self.edge_m,
            ("rate", ..) => self.rate_hz,
            ("refine", ..) => self.refine.as_ref().map_or(0.0, |refine| refine.rounds as f64),
            ("reading", FitMethod::Paper(paper), _) => {
                READINGS.iter().position(|reading| *reading == paper.reading).map_or(f64::NAN, |k| k as f64)
            }
            ("markers", _, Worse::EverySecondMarker) => 0.5,
            ("markers", ..) | ("dirt" | "rest", _, Worse::Not) => 1.0,
            ("locks", _, Worse::Locks(n)) => n as f64,
            ("locks", ..) => f64::INFINITY,
            ("noise", _, Worse::Noise(sd_m)) => 1e3 * sd_m,
            ("gaps", _, Worse::Gaps(share)) => share,
            _ => 0.0,
        }
    }

    /// The voxels and rates that a method is measured with besides its own.
    fn finer_and_coarser(as_it_is: &Self, before: &str) -> Vec<Self> {
        let edge = |mm: f64| Self {
            varied: "voxel",
            words: format!("{before}{mm:.0} mm"),
            edge_m: mm * 1e-3,
            ..as_it_is.clone()
        };
        let rate = |rate_hz: f64| Self {
            varied: "rate",
            words: format!("{before}{rate_hz:.0} Hz"),
            rate_hz,
            ..as_it_is.clone()
        };
        [10.0, 30.0, 60.0].map(edge).into_iter().chain([15.0, 60.0].map(rate)).collect()
    }

    fn paper() -> Self {
        let fit = FitMethod::Paper(PaperOptions::default());
        Self { words: "paper".into(), fit, refine: None, ..Self::usual() }
    }

    fn refined() -> Self {
        let refine = Some(RefineOptions::default());
        Self { words: "physical --refine".into(), refine, ..Self::usual() }
    }

    fn usual() -> Self {
        Self::of(Self::AS_IT_IS, "physical".into(), Worse::Not)
    }

    fn of(varied: &'static str, words: String, worse: Worse) -> Self {
        let fit = FitMethod::Physical(PhysicalOptions::default());
        let refine = Some(RefineOptions::quick());
        Self { varied, words, fit, refine, edge_m: 0.02, rate_hz: 30.0, worse }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Settings are told apart by method, what is varied and words; each has a level unlike its method's default.
    #[test]
    fn every_setting_has_a_place_of_its_own_beside_the_default() {
        let settings = [Setting::methods(), Setting::varied()].concat();
        for (k, setting) in settings.iter().enumerate() {
            let is_same = |other: &Setting| {
                (other.method(), other.varied, &other.words)
                    == (setting.method(), setting.varied, &setting.words)
            };
            assert_eq!(settings.iter().position(is_same), Some(k), "{setting:?}");
            let usual = Setting::usual_level(setting.method(), setting.varied);
            assert_eq!(setting.level() == usual, setting.varied == Setting::AS_IT_IS, "{setting:?}");
        }
    }
}

/// How edits become layers.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct EditOptions {
    /// Which time s the method `paper` counts.
    pub span: PaperSpan,
}

/// Which time s in E4's 2 (target − current) / s² is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PaperSpan {
    /// From the first key to the second, literally: the force that throws a free particle to the target.
    ///
    /// A lock is no free particle: its weight draws it back, and it gets a small part of the way.
    Keys,
    /// That, or the time of a fall from the root to the control point along the lock, √(2 l / g), if it is
    /// shorter: then E4 is the force that holds a pendulum at the target, as E3 is read by default.
    #[default]
    FreeFall,
}

impl PaperSpan {
    /// The name used in options and reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Keys => "keys",
            Self::FreeFall => "free-fall",
        }
    }

    /// The span of a name that [`PaperSpan::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Keys, Self::FreeFall].into_iter().find(|span| span.name() == name)
    }
}

use crate::{Finding, Severity};

/// What a scan found wrong, and when it has found enough.
#[derive(Debug)]
pub(crate) struct Findings {
    list: Vec<Finding>,
    n_errors: usize,
    /// How many errors are enough.
    enough: usize,
    /// Findings beyond what is kept.
    n_dropped: usize,
}

/// Beyond this many findings a list helps nobody: the file is of another kind, or noise.
const MOST: usize = 1000;

impl Findings {
    /// Everything, for a report.
    pub fn all() -> Self {
        Self { list: Vec::new(), n_errors: 0, enough: MOST, n_dropped: 0 }
    }

    /// Up to the first error, for a reader.
    pub fn first_error() -> Self {
        Self { enough: 1, ..Self::all() }
    }

    pub fn push(&mut self, finding: impl Into<Box<Finding>>) {
        let finding = finding.into();
        self.n_errors += usize::from(finding.severity == Severity::Error);
        if self.list.len() < MOST {
            self.list.push(*finding);
        } else {
            self.n_dropped += 1;
        }
    }

    /// Whether the scan should stop.
    pub fn is_enough(&self) -> bool {
        self.n_errors >= self.enough
    }

    pub fn n_errors(&self) -> usize {
        self.n_errors
    }

    pub fn n_dropped(&self) -> usize {
        self.n_dropped
    }

    pub fn into_list(self) -> Vec<Finding> {
        self.list
    }

    /// The first error, if there is one.
    pub fn into_first_error(self) -> Option<Finding> {
        self.list.into_iter().find(|f| f.severity == Severity::Error)
    }
}

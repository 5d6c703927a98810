/// Someone who watches a long stage. Stages call it often; it must be cheap.
pub trait Progress: Sync {
    /// `done` of `total` units of work are finished.
    fn at(&self, done: u64, total: u64);
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoProgress;

impl Progress for NoProgress {
    fn at(&self, _done: u64, _total: u64) {}
}

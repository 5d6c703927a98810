//! Counts what is done on several threads, for who watches.

use std::sync::atomic::{AtomicU64, Ordering};
use tousle_core::Progress;

/// How much of some work is done.
pub(crate) struct Counter<'a> {
    done: AtomicU64,
    total: u64,
    progress: &'a dyn Progress,
}

impl<'a> Counter<'a> {
    pub(crate) fn new(total: usize, progress: &'a dyn Progress) -> Self {
        Self { done: AtomicU64::new(0), total: total as u64, progress }
    }

    /// Counts one more, once it is there.
    pub(crate) fn after<T>(&self, result: T) -> T {
        self.progress.at(self.done.fetch_add(1, Ordering::Relaxed) + 1, self.total);
        result
    }
}

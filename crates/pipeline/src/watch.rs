use tousle_core::{NoProgress, Progress};

/// Someone who watches the stages go by: a terminal with a bar, or nobody.
pub trait Watch: Sync {
    /// A stage begins; what is returned hears of its progress and, when dropped, of its end.
    fn stage(&self, name: &'static str) -> Box<dyn Progress + '_>;
}

/// Nobody watches.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Watch for Silent {
    fn stage(&self, _name: &'static str) -> Box<dyn Progress + '_> {
        Box::new(NoProgress)
    }
}

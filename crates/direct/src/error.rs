/// Why edits cannot be solved for.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DirectError {
    /// The edits cannot be used.
    #[error(transparent)]
    Edit(#[from] tousle_edit::EditError),
    /// The strands cannot be simulated.
    #[error("the strands cannot be simulated")]
    Sim(#[from] tousle_sim::SimError),
}

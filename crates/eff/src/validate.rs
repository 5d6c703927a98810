use crate::manifest::Manifest;
use crate::scan::{Findings, Listener, scan};
use crate::{EffError, Finding, Severity};
use serde::Serialize;
use std::io::Read;

/// Everything that is wrong with a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Validation {
    /// Whether a reader may trust the file: there is no error among the findings.
    pub is_sound: bool,
    /// What was found, in the order of the file.
    pub findings: Vec<Finding>,
    /// Findings beyond the thousand that are kept.
    pub n_more: usize,
}

impl Validation {
    /// The findings that make the file unsound.
    pub fn errors(&self) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(|f| f.severity == Severity::Error)
    }
}

/// Decodes and checks every byte of a file, and gives everything that is wrong with it at once.
///
/// # Errors
/// [`EffError::Io`] if the stream fails; an unsound file is no error here.
pub fn validate<R: Read>(input: R) -> Result<Validation, EffError> {
    struct Deaf;
    impl Listener for Deaf {
        fn manifest(&mut self, _manifest: &Manifest) -> Result<(), EffError> {
            Ok(())
        }
    }
    let mut findings = Findings::all();
    scan(input, &mut Deaf, &mut findings)?;
    Ok(Validation {
        is_sound: findings.n_errors() == 0,
        n_more: findings.n_dropped(),
        findings: findings.into_list(),
    })
}

use tousle_core::WindSamples;
use tousle_field::{FieldSequence, Scene};

/// All that a field file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Eff {
    /// What the field is called, for people: the session's name.
    pub name: String,
    /// The method that made the field: `paper`, `physical`, or another by name.
    pub method: String,
    /// The program that made the field, with its version; the same for the same input.
    pub generator: String,
    /// The wind, with its edits.
    pub field: FieldSequence,
    /// All that a simulator needs besides the wind.
    pub scene: Scene,
    /// The measured vectors from which the field can be made again.
    pub samples: Option<WindSamples>,
    /// Files that travel along: the session, the conversion's report.
    pub attachments: Vec<Attachment>,
}

/// A file inside the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Its name, unique in the file: `session.json`.
    pub name: String,
    /// What it is: `application/json`.
    pub media_type: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

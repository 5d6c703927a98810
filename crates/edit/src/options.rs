/// How edits become layers.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct EditOptions {
    /// Which equations.
    pub method: EditMethod,
}

/// Which equations turn a drag into a layer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum EditMethod {
    /// E4 of Kazama, Sugisaki and Morishima (2008): the force that carries a free particle to the target.
    #[default]
    Paper,
}

impl EditMethod {
    /// The name used on the command line, in layers and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
        }
    }

    /// The method of a name that [`EditMethod::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Paper].into_iter().find(|m| m.name() == name)
    }
}

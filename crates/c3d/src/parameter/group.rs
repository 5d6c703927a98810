use super::Parameter;

/// Parameters that belong together, such as `POINT` or `ANALOG`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// Upper case by custom; compared without case. Empty where the file names no group of this id.
    pub name: String,
    /// What it is, for people.
    pub description: String,
    /// Whether programs should leave it alone.
    pub locked: bool,
    /// In the order of the file.
    pub parameters: Vec<Parameter>,
}

impl Group {
    /// The first parameter of this name, case aside.
    pub fn get(&self, name: &str) -> Option<&Parameter> {
        self.parameters.iter().find(|p| p.name.eq_ignore_ascii_case(name))
    }
}

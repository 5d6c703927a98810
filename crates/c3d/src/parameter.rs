mod group;

pub use group::Group;

/// The parameter section: what a system knows of a trial, by group and name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    /// In the order of the file. Parameters whose group is never named stand in a group without a name.
    pub groups: Vec<Group>,
}

/// One named value, or table of values.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Upper case by custom; compared without case.
    pub name: String,
    /// What it is, for people.
    pub description: String,
    /// Whether programs should leave it alone.
    pub locked: bool,
    /// Length along each dimension, the fastest first; empty for a single value.
    pub dimensions: Vec<u8>,
    /// The values, as many as the dimensions say.
    pub value: Value,
}

/// The values of a [`Parameter`], the first dimension running fastest.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Characters, one byte each (Latin-1).
    Text(Vec<u8>),
    /// Bytes.
    Bytes(Vec<u8>),
    /// 16-bit integers. Counts among them are unsigned.
    Integers(Vec<i16>),
    /// 32-bit floats.
    Floats(Vec<f32>),
}

impl Parameters {
    /// The first parameter of this name in a group of this name, case aside.
    pub fn get(&self, group: &str, name: &str) -> Option<&Parameter> {
        self.groups.iter().filter(|g| g.name.eq_ignore_ascii_case(group)).find_map(|g| g.get(name))
    }

    /// The first value of a parameter, as a number.
    pub fn number(&self, group: &str, name: &str) -> Option<f64> {
        self.get(group, name)?.number(0)
    }

    /// The first value of a parameter as a count: integers are unsigned, floats are taken if whole.
    pub fn count(&self, group: &str, name: &str) -> Option<u64> {
        self.get(group, name)?.count()
    }

    /// The texts of a parameter, without blanks and NULs around them; empty if there is none.
    pub fn texts(&self, group: &str, name: &str) -> Vec<String> {
        self.get(group, name).map(Parameter::texts).unwrap_or_default()
    }

    /// The texts of `NAME`, `NAME2`, `NAME3`… after one another: an array ends at 255 entries, and systems with
    /// more go on in the next.
    pub fn long_texts(&self, group: &str, name: &str) -> Vec<String> {
        let mut texts = self.texts(group, name);
        for part in 2_u32.. {
            match self.get(group, &format!("{name}{part}")) {
                Some(more) => texts.extend(more.texts()),
                None => break,
            }
        }
        texts
    }
}

impl Parameter {
    /// The texts of a character parameter, without blanks and NULs around them, Latin-1 read into UTF-8.
    ///
    /// The first dimension is the length of each; without dimensions or with one it is a single text.
    pub fn texts(&self) -> Vec<String> {
        let Value::Text(bytes) = &self.value else { return Vec::new() };
        let length = match self.dimensions.as_slice() {
            [] | [_] => bytes.len(),
            [length, ..] => usize::from(*length),
        };
        if length == 0 { Vec::new() } else { bytes.chunks(length).map(trimmed_text).collect() }
    }

    /// One value as a number; `None` for text or past the end.
    pub fn number(&self, idx: usize) -> Option<f64> {
        match &self.value {
            Value::Text(_) => None,
            Value::Bytes(bytes) => bytes.get(idx).map(|&b| f64::from(b)),
            Value::Integers(integers) => integers.get(idx).map(|&i| f64::from(i)),
            Value::Floats(floats) => floats.get(idx).map(|&f| f64::from(f)),
        }
    }

    /// The first value as a count: integers are unsigned, floats are taken if whole and not negative.
    pub fn count(&self) -> Option<u64> {
        match &self.value {
            Value::Integers(integers) => integers.first().map(|&i| u64::from(i.cast_unsigned())),
            _ => {
                let number = self.number(0)?;
                (number >= 0.0 && number.fract() == 0.0 && number < 1e15).then_some(number as u64)
            }
        }
    }
}

/// Latin-1 to UTF-8, without blanks and NULs around it.
pub(crate) fn trimmed_text(bytes: &[u8]) -> String {
    let text: String = bytes.iter().map(|&b| char::from(b)).collect();
    text.trim_matches([' ', '\0']).to_owned()
}

//! What a layer is made of, as far as curves need it.

use std::collections::BTreeMap;

/// A layer: its metadata and its prims.
#[derive(Debug, Default)]
pub(super) struct Layer {
    pub(super) metadata: BTreeMap<String, Value>,
    pub(super) prims: Vec<Prim>,
    /// What was met and not followed.
    pub(super) warnings: Vec<String>,
}

/// A prim and all below it.
#[derive(Debug)]
pub(super) struct Prim {
    pub(super) specifier: Specifier,
    /// Empty where the prim has none.
    pub(super) type_name: String,
    pub(super) name: String,
    pub(super) properties: BTreeMap<String, Property>,
    pub(super) children: Vec<Prim>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Specifier {
    Def,
    Over,
    Class,
}

/// An attribute: its value, and its earliest sample if it has any.
#[derive(Debug, Default)]
pub(super) struct Property {
    pub(super) value: Option<Value>,
    pub(super) first_sample: Option<(f64, Value)>,
    pub(super) n_samples: usize,
}

/// A value, flattened: of tuples and arrays the numbers are kept, one after the other.
#[derive(Debug, PartialEq)]
pub(super) enum Value {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    /// Paths, assets, dictionaries, `None`: nothing that curves are made of.
    Other,
}

impl Value {
    /// The one number it is.
    pub(super) fn number(&self) -> Option<f64> {
        match self {
            Self::Numbers(values) if values.len() == 1 => Some(values[0]),
            _ => None,
        }
    }

    /// The one text it is.
    pub(super) fn text(&self) -> Option<&str> {
        match self {
            Self::Texts(values) if values.len() == 1 => Some(&values[0]),
            _ => None,
        }
    }
}

impl Prim {
    /// An attribute's value; its earliest sample where it has no other.
    pub(super) fn value(&self, name: &str) -> Option<&Value> {
        let property = self.properties.get(name)?;
        let value = property.value.as_ref().filter(|v| **v != Value::Other);
        value.or(property.first_sample.as_ref().map(|(_, value)| value))
    }

    /// An attribute's numbers, if it has any.
    pub(super) fn numbers(&self, name: &str) -> Option<&[f64]> {
        match self.value(name)? {
            Value::Numbers(values) => Some(values),
            _ => None,
        }
    }

    /// An attribute's text, if it is one and not empty.
    pub(super) fn text(&self, name: &str) -> Option<&str> {
        self.value(name)?.text().filter(|text| !text.is_empty())
    }

    /// Whether an attribute has more than one sample.
    pub(super) fn is_animated(&self, name: &str) -> bool {
        self.properties.get(name).is_some_and(|p| p.n_samples > 1)
    }
}

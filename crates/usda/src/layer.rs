//! What a layer is made of, as far as curves and transforms need it.

use std::collections::BTreeMap;

/// A layer: its metadata and its prims.
#[derive(Debug, Default)]
pub struct Layer {
    /// `metersPerUnit`, `upAxis` and the like.
    pub metadata: BTreeMap<String, Value>,
    /// The prims at the root.
    pub prims: Vec<Prim>,
    /// What was met and not followed.
    pub warnings: Vec<String>,
}

/// A prim and all below it.
#[derive(Debug)]
pub struct Prim {
    /// Whether it is a thing or an opinion.
    pub specifier: Specifier,
    /// Whether it is there at all: what is not active is no part of the scene, and nothing below it.
    pub is_active: bool,
    /// `Xform`, `BasisCurves`; empty where the prim has none.
    pub type_name: String,
    /// Its own name, the last of its path.
    pub name: String,
    /// Attributes that have a value.
    pub properties: BTreeMap<String, Property>,
    /// The prims below it.
    pub children: Vec<Prim>,
}

/// What a prim is there for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Specifier {
    /// It is there.
    Def,
    /// An opinion on one that is defined elsewhere.
    Over,
    /// A pattern for others.
    Class,
}

/// An attribute: its value, and its samples if it has any.
#[derive(Debug, Default)]
pub struct Property {
    /// The default: what holds where there are no samples.
    pub value: Option<Value>,
    /// Values at time codes, rising. All of a transform's operation, only the earliest of anything else: points of
    /// long caches would take room for nothing.
    pub samples: Vec<(f64, Value)>,
    /// How many samples the layer has.
    pub n_samples: usize,
}

/// A value, flattened: of tuples and arrays the numbers are kept, one after the other.
#[derive(Debug, PartialEq)]
pub enum Value {
    /// Numbers; true and false are 1 and 0.
    Numbers(Vec<f64>),
    /// What stood between quotes.
    Texts(Vec<String>),
    /// Paths, assets, dictionaries, `None`: nothing that curves are made of.
    Other,
}

impl Value {
    /// The one number it is.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Numbers(values) if values.len() == 1 => Some(values[0]),
            _ => None,
        }
    }

    /// The one text it is.
    pub fn text(&self) -> Option<&str> {
        match self {
            Self::Texts(values) if values.len() == 1 => Some(&values[0]),
            _ => None,
        }
    }
}

impl Prim {
    /// An attribute's earliest sample; its default where it has none. USD asks for the default first only where no time is
    /// meant: at any time, be it before the first sample, samples hold.
    pub fn value(&self, name: &str) -> Option<&Value> {
        let property = self.properties.get(name)?;
        let earliest = property.samples.first().map(|(_, value)| value);
        earliest.or(property.value.as_ref().filter(|v| **v != Value::Other))
    }

    /// An attribute's numbers, if it has any.
    pub fn numbers(&self, name: &str) -> Option<&[f64]> {
        match self.value(name)? {
            Value::Numbers(values) => Some(values),
            _ => None,
        }
    }

    /// Codes of an attribute's samples that were kept, rising.
    pub fn codes(&self, name: &str) -> impl Iterator<Item = f64> {
        self.properties.get(name).into_iter().flat_map(|p| p.samples.iter().map(|(code, _)| *code))
    }

    /// The samples around a time code, with the share of the way from the first to the second: the same one twice
    /// before the first and after the last. `None` for an attribute without samples of numbers.
    pub(crate) fn samples_around(&self, name: &str, code: f64) -> Option<([&[f64]; 2], f64)> {
        let samples = &self.properties.get(name)?.samples;
        let numbers = |k: usize| match &samples[k].1 {
            Value::Numbers(values) => Some(values.as_slice()),
            _ => None,
        };
        let last = samples.len().checked_sub(1)?;
        let after = samples.partition_point(|(c, _)| *c <= code);
        let [left, right] = [after.saturating_sub(1), after.min(last)];
        let span = samples[right].0 - samples[left].0;
        let share = if span > 0.0 { (code - samples[left].0) / span } else { 0.0 };
        Some(([numbers(left)?, numbers(right)?], share))
    }

    /// An attribute's text, if it is one and not empty.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.value(name)?.text().filter(|text| !text.is_empty())
    }

    /// Whether an attribute has more than one sample.
    pub fn is_animated(&self, name: &str) -> bool {
        self.properties.get(name).is_some_and(|p| p.n_samples > 1)
    }
}

//! JSON in which no member is there twice, at any depth.

use serde::de::{Deserialize, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use std::collections::BTreeSet;
use std::fmt;

/// Reads any JSON and keeps nothing of it.
///
/// Readers differ in which of two members of one name they take, and those that keep what they do not know, as
/// `extensions`, take the last without a word.
#[derive(Debug, PartialEq)]
pub(crate) struct Unique;

impl<'de> Deserialize<'de> for Unique {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Self)
    }
}

impl<'de> Visitor<'de> for Unique {
    type Value = Self;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("JSON")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self, A::Error> {
        let mut names = BTreeSet::new();
        while let Some((name, Self)) = map.next_entry::<String, Self>()? {
            if let Some(again) = names.replace(name) {
                return Err(A::Error::custom(format_args!("member `{again}` again")));
            }
        }
        Ok(self)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self, A::Error> {
        while seq.next_element::<Self>()?.is_some() {}
        Ok(self)
    }

    fn visit_bool<E>(self, _: bool) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_str<E>(self, _: &str) -> Result<Self, E> {
        Ok(self)
    }

    fn visit_unit<E>(self) -> Result<Self, E> {
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_member_twice_is_found_at_any_depth() {
        let sound = r#"{"a": [1, -2, 0.5, true, null, "a"], "b": {"a": {}}, "c": [{"a": 1}, {"a": 2}]}"#;
        assert_eq!(serde_json::from_str::<Unique>(sound).unwrap(), Unique);
        for twice in [r#"{"a": 1, "b": 2, "a": 3}"#, r#"{"b": [{"c": {"a": 1, "a": 1}}]}"#] {
            let error = serde_json::from_str::<Unique>(twice).unwrap_err().to_string();
            assert!(error.starts_with("member `a` again"), "{error}");
        }
    }
}

//! JSON checked against the JSON Schemas that travel in every file: all that is wrong at once, each with its path.
//!
//! Only the words that our schemas use are known (a test sees to it that they use no other); a general
//! validator would take longer to compile than all the rest of this crate.

use serde_json::Value;

/// Something in a value that its schema does not allow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Violation {
    /// Where: `scene.body.colliders[1].name`.
    pub path: String,
    pub found: String,
    pub expected: String,
}

/// Everything in `value` that `schema` does not allow.
pub(crate) fn violations(value: &Value, schema: &Value) -> Vec<Violation> {
    let mut check = Check { root: schema, path: String::new(), violations: Vec::new() };
    check.value(value, schema);
    check.violations
}

/// The words of JSON Schema that [`violations`] knows.
#[cfg(test)]
const WORDS: [&str; 20] = [
    "$defs",
    "$id",
    "$ref",
    "$schema",
    "additionalProperties",
    "anyOf",
    "const",
    "description",
    "exclusiveMinimum",
    "format",
    "items",
    "maxItems",
    "maximum",
    "minItems",
    "minimum",
    "oneOf",
    "properties",
    "required",
    "title",
    "type",
];

struct Check<'a> {
    root: &'a Value,
    path: String,
    violations: Vec<Violation>,
}

impl<'a> Check<'a> {
    fn value(&mut self, value: &Value, schema: &'a Value) {
        if let Some(target) = schema["$ref"].as_str() {
            let pointer = target.trim_start_matches('#');
            if let Some(target) = self.root.pointer(pointer) {
                self.value(value, target);
            }
        }
        for word in ["anyOf", "oneOf"] {
            if let Some(branches) = schema[word].as_array() {
                self.one_of(value, branches);
            }
        }
        if let Some(constant) = schema.get("const")
            && constant != value
        {
            return self.violate(short(value), constant.to_string());
        }
        if !is_of_type(value, &schema["type"]) {
            let expected = schema["type"].to_string().replace('"', "");
            return self.violate(short(value), format!("type {expected}"));
        }
        match value {
            Value::Number(number) => self.number(number.as_f64().unwrap_or(f64::NAN), schema),
            Value::Array(items) => self.array(items, schema),
            Value::Object(members) => self.object(members, schema),
            _ => {}
        }
    }

    /// One branch must fit. If none does, the one meant is the one with the same `kind` or the same only member;
    /// what is wrong within it says more than "none of these".
    fn one_of(&mut self, value: &Value, branches: &'a [Value]) {
        if branches.iter().any(|branch| self.fits(value, branch)) {
            return;
        }
        if let Some(branch) = branches.iter().find(|branch| self.is_meant(value, branch)) {
            return self.value(value, branch);
        }
        let names: Vec<String> = branches.iter().map(name).collect();
        self.violate(short(value), names.join(" or "));
    }

    fn fits(&self, value: &Value, schema: &'a Value) -> bool {
        let mut check = Check { root: self.root, path: String::new(), violations: Vec::new() };
        check.value(value, schema);
        check.violations.is_empty()
    }

    fn is_meant(&self, value: &Value, branch: &Value) -> bool {
        let target = branch["$ref"].as_str().and_then(|t| self.root.pointer(t.trim_start_matches('#')));
        let properties = target.unwrap_or(branch)["properties"].as_object();
        properties.is_some_and(|properties| match properties.get("kind").and_then(|kind| kind.get("const")) {
            Some(kind) => value["kind"] == *kind,
            None => properties.keys().any(|key| value.get(key).is_some()),
        })
    }

    fn number(&mut self, number: f64, schema: &Value) {
        let limit = |word: &str| schema[word].as_f64();
        let checks = [
            (limit("minimum").filter(|limit| number < *limit), "or above"),
            (limit("maximum").filter(|limit| number > *limit), "at most"),
            (limit("exclusiveMinimum").filter(|limit| number <= *limit), "above"),
        ];
        for (limit, word) in checks {
            if let Some(limit) = limit {
                let expected =
                    if word == "or above" { format!("{limit} or above") } else { format!("{word} {limit}") };
                self.violate(number.to_string(), expected);
            }
        }
    }

    fn array(&mut self, items: &[Value], schema: &'a Value) {
        let (least, most) = (schema["minItems"].as_u64(), schema["maxItems"].as_u64());
        let n = items.len() as u64;
        if least.is_some_and(|least| n < least) || most.is_some_and(|most| n > most) {
            let expected = most.or(least).unwrap_or_default();
            self.violate(format!("{n} items"), expected.to_string());
        }
        if let Some(schema) = schema.get("items") {
            for (k, item) in items.iter().enumerate() {
                self.within(&format!("[{k}]"), |check| check.value(item, schema));
            }
        }
    }

    fn object(&mut self, members: &serde_json::Map<String, Value>, schema: &'a Value) {
        for name in schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str) {
            if !members.contains_key(name) {
                self.within(&format!(".{name}"), |check| check.violate("nothing".into(), "a member".into()));
            }
        }
        for (name, member) in members {
            match schema["properties"].get(name) {
                Some(schema) => self.within(&format!(".{name}"), |check| check.value(member, schema)),
                None if schema["additionalProperties"] == false => {
                    let (found, expected) = ("a member".to_owned(), "none of this name".to_owned());
                    self.within(&format!(".{name}"), |check| check.violate(found, expected));
                }
                None => {}
            }
        }
    }

    fn within(&mut self, step: &str, check: impl FnOnce(&mut Self)) {
        let length = self.path.len();
        self.path.push_str(step);
        check(self);
        self.path.truncate(length);
    }

    fn violate(&mut self, found: String, expected: String) {
        let path = self.path.trim_start_matches('.');
        let path = if path.is_empty() { "payload" } else { path }.to_owned();
        self.violations.push(Violation { path, found, expected });
    }
}

fn is_of_type(value: &Value, types: &Value) -> bool {
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "null" => value.is_null(),
        "number" => value.is_number(),
        // 3.0 is an integer to JSON Schema, but not to most programs.
        "integer" => value.is_u64() || value.is_i64(),
        _ => true,
    };
    match types {
        Value::String(name) => is(name),
        Value::Array(names) => names.iter().filter_map(Value::as_str).any(is),
        _ => true,
    }
}

/// A value as a message shows it.
fn short(value: &Value) -> String {
    let text = value.to_string();
    match text.char_indices().nth(60) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

/// What a branch is called in a message.
fn name(branch: &Value) -> String {
    if let Some(constant) = branch.get("const") {
        return constant.to_string();
    }
    let only = branch["required"].as_array().and_then(|r| r.first()).and_then(Value::as_str);
    match (only, branch["$ref"].as_str()) {
        (Some(member), _) => format!("an object with {member:?}"),
        (None, Some(target)) => target.rsplit('/').next().unwrap_or_default().to_owned(),
        (None, None) => branch["type"].to_string().replace('"', ""),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::{EDITS_SCHEMA, MANIFEST_SCHEMA};
    use serde_json::json;

    fn schema(text: &[u8]) -> Value {
        serde_json::from_slice(text).unwrap()
    }

    fn messages(value: &Value, schema: &Value) -> Vec<String> {
        let message = |v: Violation| format!("{}: {}, {}", v.path, v.found, v.expected);
        violations(value, schema).into_iter().map(message).collect()
    }

    #[test]
    fn all_violations_are_found_at_once() {
        let value = json!({"layers": [{
            "id": 7, "name": "lift", "muted": false, "first_secs": 0.0, "last_secs": 1.0, "rise": 1.5, "fall": 0.0,
            "handles": [{"center_m": [0.0, 1.0], "reach_m": 0.0, "extra": [0, 0, 0], "color": "red"}],
            "origin": {"kind": "drag", "strand": "S01", "control_point": 1.5, "target_m": [0, 0, 0]},
        }]});
        let mut found = messages(&value, &schema(EDITS_SCHEMA));
        found.sort();
        assert_eq!(
            found,
            [
                "layers[0].handles[0].center_m: 2 items, 3",
                "layers[0].handles[0].color: a member, none of this name",
                "layers[0].handles[0].reach_m: 0, above 0",
                "layers[0].id: 7, type string",
                "layers[0].origin.control_point: 1.5, type integer",
                "layers[0].origin.method: nothing, a member",
                "layers[0].rise: 1.5, at most 1",
            ]
        );
    }

    #[test]
    fn the_branch_that_was_meant_speaks() {
        let schema = schema(MANIFEST_SCHEMA);
        let shape = json!({"$defs": schema["$defs"], "$ref": "#/$defs/Shape"});
        let capsule = json!({"capsule": {"a_m": [0, 0, 0], "b_m": [0, 0, 1], "radius_m": -1}});
        assert_eq!(messages(&capsule, &shape), ["capsule.radius_m: -1, above 0"]);
        let sphere = json!({"sphere": {}});
        let expected = "payload: {\"sphere\":{}}, an object with \"ellipsoid\" or an object with \"capsule\"";
        assert_eq!(messages(&sphere, &shape), [expected]);
        let quantity = json!({"$defs": schema["$defs"], "$ref": "#/$defs/QuantityName"});
        let expected = "payload: \"wind\", \"air_velocity\" or \"force_per_mass\"";
        assert_eq!(messages(&json!("wind"), &quantity), [expected]);
    }

    /// Whatever is broken in a manifest, a general validator finds it where this one does.
    #[test]
    fn a_general_validator_agrees() {
        let schema = schema(MANIFEST_SCHEMA);
        let general = jsonschema::validator_for(&schema).unwrap();
        let sound: Value =
            serde_json::from_slice(include_bytes!("../../../docs/examples/manifest.json")).unwrap();
        assert!(general.is_valid(&sound) && violations(&sound, &schema).is_empty());
        let replacements = [
            json!(null),
            json!(-1),
            json!(0),
            json!(2.5),
            json!(1_000_000_000),
            json!("x"),
            json!([]),
            json!({}),
        ];
        let mut n_broken = 0;
        for pointer in pointers(&sound, "") {
            for replacement in replacements.iter().map(Some).chain([None]) {
                let mut value = sound.clone();
                replace(&mut value, &pointer, replacement);
                let is_valid = violations(&value, &schema).is_empty();
                assert_eq!(is_valid, general.is_valid(&value), "{pointer} {replacement:?}");
                n_broken += usize::from(!is_valid);
            }
        }
        assert!(n_broken > 300, "{n_broken}");
    }

    /// Where everything in a value is.
    fn pointers(value: &Value, at: &str) -> Vec<String> {
        let children: Vec<(String, &Value)> = match value {
            Value::Object(members) => members.iter().map(|(k, v)| (k.clone(), v)).collect(),
            Value::Array(items) => items.iter().enumerate().map(|(k, v)| (k.to_string(), v)).collect(),
            _ => Vec::new(),
        };
        let within = children.into_iter().flat_map(|(k, v)| {
            let at = format!("{at}/{k}");
            let mut all = pointers(v, &at);
            all.push(at);
            all
        });
        within.collect()
    }

    /// Replaces what is there; takes it away, or adds a stranger beside it, for `None`.
    fn replace(value: &mut Value, pointer: &str, replacement: Option<&Value>) {
        if let Some(replacement) = replacement {
            *value.pointer_mut(pointer).unwrap() = replacement.clone();
            return;
        }
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        match value.pointer_mut(parent).unwrap() {
            Value::Object(members) => drop(members.remove(key)),
            Value::Array(items) => drop(items.remove(key.parse().unwrap())),
            _ => unreachable!(),
        }
    }

    /// A word that is not known would be a rule that is not checked.
    #[test]
    fn our_schemas_use_known_words_only() {
        fn visit(schema: &Value) {
            for (word, value) in schema.as_object().into_iter().flatten() {
                assert!(WORDS.contains(&word.as_str()), "{word}");
                match word.as_str() {
                    "properties" | "$defs" => value.as_object().unwrap().values().for_each(visit),
                    "items" => visit(value),
                    "anyOf" | "oneOf" => value.as_array().unwrap().iter().for_each(visit),
                    "additionalProperties" => assert!(value.is_boolean()),
                    _ => {}
                }
            }
        }
        visit(&schema(MANIFEST_SCHEMA));
        visit(&schema(EDITS_SCHEMA));
    }
}

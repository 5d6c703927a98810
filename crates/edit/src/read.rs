//! Edits files: TOML or JSON in, TOML out.

use crate::list::EDITS_VERSION;
use crate::{EditError, EditList};

/// Reads an edits file: TOML, or JSON with the same names if its first character is a brace.
///
/// # Errors
/// [`EditError`] with line and column for what the format or a single value makes impossible, with the edit's
/// number and name for what its values do together.
pub fn read_edits(bytes: &[u8]) -> Result<EditList, EditError> {
    let text = str::from_utf8(bytes).map_err(|error| EditError::NotText { byte: error.valid_up_to() })?;
    let list = if text.trim_start().starts_with('{') { from_json(text)? } else { from_toml(text)? };
    list.check()?;
    Ok(list)
}

/// An edits file that [`read_edits`] reads back to the same list.
pub fn write_edits(list: &EditList) -> String {
    toml::to_string(list).expect("an edit list has no value that TOML cannot hold")
}

impl EditList {
    /// Checks what edits must keep with each other and with the list: known version, keys in order.
    ///
    /// # Errors
    /// The first [`EditError`] in the list's order.
    pub fn check(&self) -> Result<(), EditError> {
        if self.version != EDITS_VERSION {
            return Err(EditError::Version { found: self.version, expected: EDITS_VERSION });
        }
        for number in 1..=self.edits.len() {
            self.keys_secs(number)?;
        }
        Ok(())
    }

    /// First and second key of the edit with this number (from 1), s.
    ///
    /// # Errors
    /// [`EditError::BadEdit`] if they are frames of no rate, or not in order.
    ///
    /// # Panics
    /// If the list has no such edit.
    pub fn keys_secs(&self, number: usize) -> Result<(f64, f64), EditError> {
        let edit = &self.edits[number - 1];
        let bad = |problem: String| EditError::BadEdit { number, name: edit.name.clone(), problem };
        if let Some(rate) = self.rate_hz.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
            return Err(bad(format!("found rate_hz = {rate}, expected a number above 0")));
        }
        let keys = edit.first.secs(self.rate_hz).zip(edit.second.secs(self.rate_hz));
        let (first, second) =
            keys.ok_or_else(|| bad("found keys given as frames, expected a `rate_hz` in the list".into()))?;
        if !(first.is_finite() && second.is_finite() && second > first) {
            return Err(bad(format!(
                "found a second key at {second} s, expected one after the first, {first} s"
            )));
        }
        Ok((first, second))
    }
}

fn from_toml(text: &str) -> Result<EditList, EditError> {
    toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        let before = text.get(..at).unwrap_or_default();
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let problem = error.message().trim().replace('\n', "; ");
        EditError::Syntax {
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            problem,
        }
    })
}

fn from_json(text: &str) -> Result<EditList, EditError> {
    serde_json::from_str(text).map_err(|error| {
        let (line, column) = (error.line(), error.column());
        let message = error.to_string();
        let problem = message.trim_end_matches(&format!(" at line {line} column {column}")).to_owned();
        EditError::Syntax { line, column, problem }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Action, ControlPoint, KeyTime, Target};
    use tousle_core::Vec3;

    const LIFT: &str = "\
rate_hz = 60

[[edit]]
name = \"lift\"
strand = \"B07\"
control_point = \"tip\"
first_secs = 1.5
second_frame = 120
offset_m = [0, 0.02, 0.05]
";

    #[test]
    fn a_short_file_says_enough() {
        let list = read_edits(LIFT.as_bytes()).unwrap();
        let [edit] = list.edits.as_slice() else { panic!("{list:?}") };
        assert_eq!((edit.first, edit.second), (KeyTime::Secs(1.5), KeyTime::Frame(120)));
        assert_eq!(list.keys_secs(1).unwrap(), (1.5, 2.0));
        let Action::Drag(drag) = &edit.action;
        assert_eq!(drag.control_point, ControlPoint::Tip);
        assert_eq!(drag.target, Target::Offset(Vec3::new(0.0, 0.02, 0.05)));
        assert_eq!(drag.reach_m, 0.06);
    }

    #[test]
    fn what_is_written_reads_back_the_same() {
        let list = read_edits(LIFT.as_bytes()).unwrap();
        assert_eq!(read_edits(write_edits(&list).as_bytes()).unwrap(), list);
        let json = serde_json::to_string_pretty(&list).unwrap();
        assert_eq!(read_edits(json.as_bytes()).unwrap(), list);
        assert_eq!(read_edits(b"").unwrap(), EditList::new());
    }

    #[test]
    fn the_example_in_the_documentation_is_read() {
        let docs = include_str!("../../../docs/equations.md");
        let example = docs.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
        let list = read_edits(example.as_bytes()).unwrap();
        assert_eq!((list.edits[0].name.as_str(), list.keys_secs(1).unwrap()), ("lift the side", (1.5, 2.0)));
        assert_eq!(list.edits[0].ease, crate::DEFAULT_EASE);
    }

    #[test]
    fn errors_say_where() {
        for (from, to, expected) in [
            ("1.5", "1.5.5", "line 7, column 17"),
            ("1.5", "nan", "line 7, column 14: found NaN, expected a finite number"),
            ("\"tip\"", "\"top\"", "line 6, column 17: invalid value: string \"top\", expected \"tip\" or a"),
            ("\"tip\"", "-1", "line 6, column 17: found control point -1, expected 1 or more"),
            ("\"tip\"", "0", "line 3, column 1: found control point 0"),
            ("offset_m", "offset_mm", "line 9, column 1: unknown field `offset_mm`"),
            ("[0, 0.02, 0.05]", "[0, 0.02]", "line 9, column 12: invalid length 2"),
            ("offset_m", "ease = { rise = 0.8, fall = 0.3 }\noffset_m", "line 9, column 8: found rise 0.8"),
            (
                "offset_m",
                "reach_m = 60\noffset_m",
                "line 9, column 11: found a reach of 60 m, expected 0.005 to 1 m",
            ),
            ("offset_m", "target_m = [0, 0, 0]\noffset_m", "found both `target_m` and `offset_m`"),
            ("first_secs = 1.5", "", "found neither `first_secs` nor `first_frame`"),
            ("rate_hz = 60", "", "edit 1 (`lift`): found keys given as frames"),
            ("first_secs = 1.5", "first_secs = 2", "edit 1 (`lift`): found a second key at 2 s"),
            ("rate_hz = 60", "version = 2", "found version 2, expected 1"),
        ] {
            let text = LIFT.replace(from, to);
            let error = read_edits(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(expected), "{to}: {error}");
        }
        let error = read_edits(b"{\"edit\": [\n{\"name\": 7}]}").unwrap_err().to_string();
        assert_eq!(error, "edits, line 2, column 10: invalid type: integer `7`, expected a string");
        assert!(matches!(read_edits(b"a\xff").unwrap_err(), EditError::NotText { byte: 1 }));
    }
}

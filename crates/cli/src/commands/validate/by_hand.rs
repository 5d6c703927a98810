//! Files that people write: sessions, grooms, edits. All that is wrong with one, at once.
//!
//! The readers stop at the first thing that is wrong, as they should. Here a file is taken apart and each part is read
//! beside parts that are sound: what a reader then says is about that part. So the rules are the readers' own, and
//! nothing is said twice.

use serde::Serialize;
use serde_json::{Map, Value, json};

/// What is wrong with a file that people write.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ByHand {
    /// `session`, `groom` or `edits`; of what is none of these and known all the same `capture`, `npz` or `vdb`.
    kind: &'static str,
    pub is_sound: bool,
    pub findings: Vec<Finding>,
    /// Findings beyond the hundred that are kept.
    pub n_more: usize,
}

/// Something wrong.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// `kind`: it is nothing that is checked. `syntax`: it is neither JSON nor TOML. `value`: a part is not what it
    /// should be, whatever the rest. `together`: every part could be, but not all of them at once.
    code: &'static str,
    severity: &'static str,
    /// Which part: `strands[3]`.
    what: String,
    /// What was found and what was expected.
    message: String,
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let what = if self.what.is_empty() { "file" } else { &self.what };
        write!(f, "{}: {what}: {}", self.code, self.message)
    }
}

/// The most elements of a list that are told of, the others are counted: a unit that is wrong makes every strand wrong.
const MAX_FINDINGS: usize = 100;

/// Makes a sound element of a list for a place.
type Sound = fn(usize) -> Value;

/// A kind of file, with a reader and with the least that the reader takes.
struct Kind {
    name: &'static str,
    read: fn(&[u8]) -> Result<(), String>,
    /// A sound file with little more than what is required.
    least: Value,
    /// The members that every such file has.
    required: &'static [&'static str],
    /// The members that are lists, each with a sound element for every place.
    lists: &'static [(&'static str, Sound)],
}

fn in_words(error: impl Into<anyhow::Error>) -> String {
    let error: anyhow::Error = error.into();
    error.chain().map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

fn session() -> Kind {
    Kind {
        name: "session",
        read: |bytes| tousle_ingest::read_session(bytes).map(drop).map_err(in_words),
        least: json!({
            "head_markers_mm_in_head_frame":
                {"~A": [90.0, 0.0, 40.0], "~B": [0.0, 80.0, 40.0], "~C": [0.0, -80.0, -40.0]},
            "strands": [session_strand(0)],
        }),
        required: &["head_markers_mm_in_head_frame", "strands"],
        lists: &[("strands", session_strand), ("fans", session_fan)],
    }
}

fn session_strand(k: usize) -> Value {
    let marker = format!("~{k}_1");
    json!({"strand": format!("~{k}"), "length_mm": 100.0, "root_mm": [0.0, 0.0, 100.0], "markers": [marker]})
}

fn session_fan(_: usize) -> Value {
    json!({"from_azimuth_deg": 0.0, "speed_mps": 1.0})
}

fn groom() -> Kind {
    Kind {
        name: "groom",
        read: |bytes| {
            let options = tousle_groom::GroomOptions::default();
            tousle_groom::read_groom(bytes, &options).map(drop).map_err(in_words)
        },
        least: json!({"strands": [groom_strand(0)]}),
        required: &["strands"],
        lists: &[("strands", groom_strand)],
    }
}

fn groom_strand(k: usize) -> Value {
    json!({"name": format!("~{k}"), "rest_curve_m": [[0.0, 0.0, 0.1], [0.0, 0.0, 0.15]]})
}

fn edits() -> Kind {
    Kind {
        name: "edits",
        read: |bytes| tousle_edit::read_edits(bytes).map(drop).map_err(in_words),
        // Keys may be frames, which need a rate: it is not known to be missing from one edit alone.
        least: json!({"rate_hz": 60.0, "edit": [edit(0)]}),
        required: &[],
        lists: &[("edit", edit)],
    }
}

fn edit(k: usize) -> Value {
    json!({
        "name": format!("~{k}"), "strand": "S", "control_point": "tip", "first_secs": 0.0, "second_secs": 1.0,
        "offset_m": [0.0, 0.0, 0.01],
    })
}

/// Tells what a file is and what is wrong with it; `None` if it is none that people write.
pub fn validate(bytes: &[u8]) -> Option<ByHand> {
    let text = text(bytes)?;
    match parse(text) {
        Ok(Value::Object(members)) => Some(kind_of(&members, is_json(text))?.findings(bytes, &members)),
        Ok(_) => None,
        // Text that begins like neither is for others to tell.
        Err(_) if !is_json(text) && !text.contains(" = ") => None,
        Err(message) => {
            let is_edits =
                |name: &&str| text.contains(&format!("[[{name}]]")) || text.contains(&format!("\"{name}\""));
            let kind = if EDITS.iter().any(is_edits) {
                "edits"
            } else if text.contains("rest_curve_m") {
                "groom"
            } else {
                "session"
            };
            Some(ByHand::of(kind, vec![Finding::new("syntax", "", message)], 0))
        }
    }
}

/// What a file is that people write, sound or not: `session`, `groom` or `edits`.
pub fn kind(bytes: &[u8]) -> Option<&'static str> {
    let text = text(bytes)?;
    let parsed = parse(text).ok()?;
    Some(kind_of(parsed.as_object()?, is_json(text))?.name)
}

fn text(bytes: &[u8]) -> Option<&str> {
    // To TOML the first line of a .usda would be a comment.
    str::from_utf8(bytes).ok().filter(|text| !text.starts_with("#usda"))
}

fn is_json(text: &str) -> bool {
    text.trim_start().starts_with('{')
}

fn parse(text: &str) -> Result<Value, String> {
    if is_json(text) {
        serde_json::from_str(text).map_err(|e| e.to_string())
    } else {
        toml::from_str(text).map_err(|e| e.to_string().trim().replace('\n', " "))
    }
}

/// The members that only edits have.
const EDITS: [&str; 3] = ["edit", "wind", "change"];

/// What a file is, by the members that only its kind has. Of edits all members may be misspelled: TOML that is nothing else is
/// taken for theirs.
fn kind_of(members: &Map<String, Value>, is_json: bool) -> Option<Kind> {
    let first = &members.get("strands").and_then(|s| s.get(0)).unwrap_or(&Value::Null);
    if EDITS.iter().any(|name| members.contains_key(*name)) {
        Some(edits())
    } else if members.contains_key("head_markers_mm_in_head_frame") || first.get("markers").is_some() {
        Some(session())
    } else if members.contains_key("strands") {
        Some(groom())
    } else {
        let is_edits = if is_json {
            ["version", "edits"].iter().any(|name| members.contains_key(*name))
        } else {
            !members.is_empty()
        };
        is_edits.then(edits)
    }
}

impl Kind {
    fn findings(&self, bytes: &[u8], members: &Map<String, Value>) -> ByHand {
        let (mut findings, mut n_more) = (Vec::new(), 0);
        if let Err(first) = (self.read)(bytes) {
            for (name, member) in members {
                match (self.lists.iter().find(|(list, _)| list == name), member.as_array()) {
                    (Some((_, sound)), Some(items)) => {
                        n_more += self.list(name, items, *sound, 0..items.len(), &mut findings);
                    }
                    _ => self.part(name, name, member.clone(), &mut findings),
                }
            }
            self.missing(members, &mut findings);
            if findings.is_empty() {
                findings.push(Finding::new("together", "", first));
            }
        }
        ByHand::of(self.name, findings, n_more)
    }

    /// Reads a member beside sound ones.
    fn part(&self, name: &str, what: &str, member: Value, findings: &mut Vec<Finding>) {
        if let Err(message) = self.read_with(name, Some(member)) {
            findings.push(Finding::new("value", what, without_line(&message)));
        }
    }

    /// Finds the elements of a list that are wrong, by halves: those that are sound are read a few times, together. Gives how many
    /// more are wrong than are kept.
    fn list(
        &self,
        name: &str,
        items: &[Value],
        sound: Sound,
        range: std::ops::Range<usize>,
        findings: &mut Vec<Finding>,
    ) -> usize {
        if findings.len() >= MAX_FINDINGS {
            let is_wrong = |item: &&Value| self.read_with(name, Some(json!([item]))).is_err();
            return items[range].iter().filter(is_wrong).count();
        }
        // Elements keep their places: readers name them by number.
        let list: Vec<Value> =
            (0..items.len()).map(|k| if range.contains(&k) { items[k].clone() } else { sound(k) }).collect();
        if range.len() <= 1 {
            let what = range.clone().next().map_or_else(|| name.to_owned(), |k| format!("{name}[{k}]"));
            self.part(name, &what, list.into(), findings);
            return 0;
        }
        let Err(message) = self.read_with(name, Some(list.into())) else { return 0 };
        let n_before = findings.len();
        let middle = range.start + range.len() / 2;
        let n_more = self.list(name, items, sound, range.start..middle, findings)
            + self.list(name, items, sound, middle..range.end, findings);
        if findings.len() == n_before && range.len() == items.len() {
            findings.push(Finding::new("together", name, without_line(&message)));
        }
        n_more
    }

    /// Members that must be there and are not.
    fn missing(&self, members: &Map<String, Value>, findings: &mut Vec<Finding>) {
        for name in self.required {
            if !members.contains_key(*name)
                && let Err(message) = self.read_with(name, None)
            {
                findings.push(Finding::new("value", name, without_line(&message)));
            }
        }
    }

    /// Reads a sound file with one member in place of its own.
    fn read_with(&self, name: &str, member: Option<Value>) -> Result<(), String> {
        let mut file = self.least.clone();
        if let Some(members) = file.as_object_mut() {
            members.remove(name);
            members.extend(member.map(|member| (name.to_owned(), member)));
        }
        (self.read)(file.to_string().as_bytes())
    }
}

impl ByHand {
    fn of(kind: &'static str, findings: Vec<Finding>, n_more: usize) -> Self {
        Self { kind, is_sound: findings.is_empty(), findings, n_more }
    }

    /// What is wrong with a groom that was read as a whole.
    pub fn groom(problem: Option<String>) -> Self {
        Self::of("groom", problem.into_iter().map(|message| Finding::new("value", "", message)).collect(), 0)
    }

    /// A file that is known and that another command is for.
    pub fn of_no_use(kind: &'static str, found: &str, advice: &str) -> Self {
        let message = format!("found {found}, expected a field, a session, a groom or edits; {advice}");
        Self::of(kind, vec![Finding::new("kind", "", message)], 0)
    }
}

impl Finding {
    fn new(code: &'static str, what: &str, message: impl Into<String>) -> Self {
        Self { code, severity: "error", what: what.to_owned(), message: message.into() }
    }
}

/// A message without its line and column, which are those of a file that we made.
fn without_line(message: &str) -> String {
    let Some(start) = message.find("line 1") else { return message.to_owned() };
    let rest = &message[start + "line 1".len()..];
    let skip = |c: char| c.is_ascii_digit() || " ,:".contains(c);
    let rest = rest.trim_start_matches(skip);
    let rest = rest.strip_prefix("column").map_or(rest, |rest| rest.trim_start_matches(skip));
    format!("{}{rest}", message[..start].trim_end_matches("at ")).trim_end_matches([',', ' ', ':']).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_of_each_kind_is_sound() {
        for kind in [session(), groom(), edits()] {
            assert_eq!((kind.read)(kind.least.to_string().as_bytes()), Ok(()), "{}", kind.name);
            for (name, sound) in kind.lists {
                let list = (0..3).map(sound).collect::<Vec<_>>();
                assert_eq!(kind.read_with(name, Some(list.into())), Ok(()), "{}, {name}", kind.name);
            }
        }
    }

    fn found(file: &str) -> Vec<(&'static str, String)> {
        let findings = validate(file.as_bytes()).unwrap().findings;
        findings.into_iter().map(|f| (f.code, f.what)).collect()
    }

    #[test]
    fn all_that_is_wrong_is_found_at_once() {
        let mut file = session().least;
        file["strands"] = (0..9).map(session_strand).collect::<Vec<_>>().into();
        file["strands"][2]["length_mm"] = json!(-5.0);
        file["strands"][7]["root_mm"] = json!([0.0, 1.0]);
        file["air_density_kg_m3"] = json!(0.0);
        file["fans"] = json!([{"from_azimuth_deg": 0.0}]);
        let expected = ["air_density_kg_m3", "fans[0]", "strands[2]", "strands[7]"];
        let mut all = found(&file.to_string());
        all.sort();
        assert_eq!(all, expected.map(|what| ("value", what.to_owned())));
        let message = &validate(file.to_string().as_bytes()).unwrap().findings;
        assert!(message.iter().all(|f| !f.message.contains("line 1")), "{message:?}");
        file.as_object_mut().unwrap().remove("head_markers_mm_in_head_frame");
        assert!(found(&file.to_string()).contains(&("value", "head_markers_mm_in_head_frame".into())));
    }

    #[test]
    fn a_hundred_are_kept_and_the_others_counted() {
        let mut file = groom().least;
        file["strands"] = (0..250).map(groom_strand).collect::<Vec<_>>().into();
        for k in 50..200 {
            file["strands"][k]["lock_width_m"] = json!(-1.0);
        }
        let told = validate(file.to_string().as_bytes()).unwrap();
        assert_eq!((told.findings.len(), told.n_more), (MAX_FINDINGS, 50));
    }

    #[test]
    fn parts_that_are_sound_can_be_wrong_together() {
        let mut file = session().least;
        file["strands"] = json!([session_strand(7), session_strand(7)]);
        assert_eq!(found(&file.to_string()), [("together", "strands".to_owned())]);
    }

    #[test]
    fn edits_and_what_is_no_text() {
        let edits = "[[edit]]\nname = \"a\"\nstrand = \"S\"\ncontrol_point = \"tip\"\nfirst_secs = 2\nsecond_secs = 1\n\
                     offset_m = [0, 0, nan]\n[[edit]]\nname = 3\n";
        assert_eq!(found(edits), [("value", "edit[0]".to_owned()), ("value", "edit[1]".to_owned())]);
        let gust =
            "version = 1\n[[wind]]\nname = \"g\"\nkind = \"gust\"\nvector = [0, -4, 0]\nat_m = [0, 0, 0.1]\n";
        assert_eq!(validate(gust.as_bytes()).unwrap().kind, "edits");
        for misspelled in ["version = 1\n[[edits]]\nname = \"a\"\n", "{\"version\": 1, \"edits\": []}"] {
            assert_eq!(found(misspelled), [("value", "edits".to_owned())]);
        }
        assert_eq!(found("version = 9"), [("value", "version".to_owned())]);
        assert_eq!(found("version = 1"), []);
        assert_eq!(validate(b"\n"), None);
        assert_eq!(validate(b"{\"frames\": 3}"), None);
        assert_eq!(validate(b"#usda 1.0\n(\n    upAxis = \"Z\"\n)\n"), None);
        assert_eq!(found("{ \"edit\": ]"), [("syntax", String::new())]);
        assert_eq!(validate(b"\x89MCAP0\r\n"), None);
        assert_eq!(validate(b"Field #,1"), None);
    }
}

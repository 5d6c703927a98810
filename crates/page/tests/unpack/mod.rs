//! Reads a page the way its script does, so that tests can compare what arrives with what was sent.

use flate2::read::DeflateDecoder;
use serde_json::Value;
use std::io::Read;

/// A page's data.
pub struct Unpacked<'a> {
    html: &'a str,
    pub json: Value,
}

impl<'a> Unpacked<'a> {
    pub fn of(html: &'a str) -> Self {
        Self { html, json: serde_json::from_str(element(html, "data")).expect("the data is JSON") }
    }

    /// The integers of a packed array: `assets/js/codec.js` in Rust.
    pub fn integers(&self, packed: &Value) -> Vec<i16> {
        let bytes = from_base64(element(self.html, packed["blob"].as_str().expect("a name")));
        let mut planes = Vec::new();
        DeflateDecoder::new(bytes.as_slice()).read_to_end(&mut planes).expect("the bytes inflate");
        let n = whole(&packed["count"]);
        assert_eq!(planes.len(), 2 * n);
        let unfold = |folded: u16| ((folded >> 1) as i16) ^ -((folded & 1) as i16);
        let mut values: Vec<i16> =
            (0..n).map(|i| unfold(u16::from(planes[i]) | u16::from(planes[n + i]) << 8)).collect();
        for lag in packed["lags"].as_array().expect("lags").iter().rev() {
            let lag = whole(lag);
            for i in lag..n {
                values[i] = values[i].wrapping_add(values[i - lag]);
            }
        }
        values
    }

    /// Positions, coordinate after coordinate; `None` where there is none.
    pub fn positions(&self, quantization: &Value, packed: &Value) -> Vec<Option<f64>> {
        let step = quantization["step_m"].as_f64().expect("a number");
        let center = [0, 1, 2].map(|axis| quantization["center_m"][axis].as_f64().expect("a number"));
        let integers = self.integers(packed);
        let back = |(i, &v): (usize, &i16)| (v != i16::MIN).then(|| center[i % 3] + step * f64::from(v));
        integers.iter().enumerate().map(back).collect()
    }
}

fn whole(number: &Value) -> usize {
    number.as_u64().expect("a whole number") as usize
}

/// The text of the script element with an id.
fn element<'a>(html: &'a str, id: &str) -> &'a str {
    let start = html.find(&format!("id=\"{id}\">")).unwrap_or_else(|| panic!("no element {id}"));
    let text = &html[start + id.len() + 6..];
    &text[..text.find("</script>").expect("the element ends")]
}

fn from_base64(text: &str) -> Vec<u8> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => panic!("{c} is no base64 digit"),
    };
    let digits: Vec<u8> = text.trim_end_matches('=').bytes().map(digit).collect();
    let four = |d: &[u8]| {
        let bits = d.iter().fold(0_u32, |bits, &six| bits << 6 | u32::from(six)) << (6 * (4 - d.len()));
        bits.to_be_bytes()[1..d.len()].to_vec()
    };
    digits.chunks(4).flat_map(four).collect()
}

/// Checks that every tag is closed in order, with the elements that HTML leaves open set aside.
pub fn check_nesting(html: &str) -> Result<(), String> {
    const OPEN: [&str; 4] = ["meta", "input", "br", "img"];
    let mut stack: Vec<String> = Vec::new();
    let mut rest = html.strip_prefix("<!doctype html>").ok_or("no doctype")?;
    while let Some(start) = rest.find('<') {
        let tag = &rest[start + 1..];
        let end = tag.find('>').ok_or("a tag does not end")?;
        let (tag, after) = (&tag[..end], &tag[end + 1..]);
        rest = after;
        let name: String = tag.trim_start_matches('/').chars().take_while(|c| c.is_alphanumeric()).collect();
        if tag.starts_with('/') {
            let open = stack.pop();
            if open.as_deref() != Some(&name) {
                return Err(format!("</{name}> closes {open:?}"));
            }
        } else if !tag.ends_with('/') && !OPEN.contains(&name.as_str()) {
            if name == "script" || name == "style" {
                let close = format!("</{name}>");
                rest = &rest[rest.find(&close).ok_or(close.clone())? + close.len()..];
            } else {
                stack.push(name);
            }
        }
    }
    if stack.is_empty() { Ok(()) } else { Err(format!("left open: {stack:?}")) }
}

#[test]
fn the_check_finds_what_is_wrong() {
    assert!(check_nesting("<!doctype html><p><b>x</b></p>").is_ok());
    assert!(check_nesting("<!doctype html><p><b>x</p></b>").is_err());
    assert!(check_nesting("<!doctype html><p>").is_err());
}

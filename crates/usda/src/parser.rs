//! From words to prims.

use std::collections::BTreeMap;

use crate::error::bad;
use crate::lexer::{Lexer, Token};
use crate::{Layer, Prim, Property, Specifier, UsdaError, Value};

/// How deep prims and brackets may be in one another: deeper is no scene, and would be the stack's end.
const MAX_DEPTH: usize = 128;

/// Metadata that brings in what is not in this layer's own prims.
const COMPOSITION: [&str; 6] =
    ["references", "payload", "subLayers", "inherits", "specializes", "variantSets"];

/// Words that stand before a property's type.
const MODIFIERS: [&str; 9] =
    ["custom", "uniform", "varying", "config", "prepend", "append", "add", "delete", "reorder"];

/// Operations of a transform, of which all samples are kept.
const OPERATIONS: &str = "xformOp:";

/// Parses a layer.
///
/// # Errors
/// [`UsdaError`] with the line: bytes that are no text of a layer, or prims and brackets too deep in one another.
pub fn parse(bytes: &[u8]) -> Result<Layer, UsdaError> {
    let text = str::from_utf8(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)).map_err(|error| {
        bad(format!("byte {}", error.valid_up_to()), "bytes that are no text", "UTF-8 text")
    })?;
    let mut parser = Parser { lexer: Lexer::new(text), layer: Layer::default() };
    // The magic line is a comment to the lexer.
    if parser.lexer.peek()? == Token::Sign('(') {
        parser.layer.metadata = parser.metadata("the layer")?;
    }
    let mut prims = Vec::new();
    loop {
        match parser.lexer.next()? {
            Token::End => break,
            Token::Name(word) => match specifier_of(word) {
                Some(specifier) => prims.push(parser.prim(specifier, 0)?),
                // `reorder rootPrims = […]` and its like.
                None => drop(parser.property(word)?),
            },
            token => return Err(parser.unexpected(token, "def, over or class")),
        }
    }
    parser.layer.prims = prims;
    Ok(parser.layer)
}

fn specifier_of(word: &str) -> Option<Specifier> {
    match word {
        "def" => Some(Specifier::Def),
        "over" => Some(Specifier::Over),
        "class" => Some(Specifier::Class),
        _ => None,
    }
}

struct Parser<'a> {
    lexer: Lexer<'a>,
    layer: Layer,
}

impl<'a> Parser<'a> {
    fn unexpected(&self, token: Token<'_>, expected: &str) -> UsdaError {
        self.lexer.bad(&format!("{token:?}"), expected)
    }

    fn expect(&mut self, sign: char) -> Result<(), UsdaError> {
        match self.lexer.next()? {
            Token::Sign(found) if found == sign => Ok(()),
            token => Err(self.unexpected(token, &format!("{sign}"))),
        }
    }

    /// Takes a sign if it is next.
    fn eat(&mut self, sign: char) -> Result<bool, UsdaError> {
        let is_next = self.lexer.peek()? == Token::Sign(sign);
        if is_next {
            self.lexer.next()?;
        }
        Ok(is_next)
    }

    /// The rest of `def TYPE "NAME" (…) {…}`.
    fn prim(&mut self, specifier: Specifier, depth: usize) -> Result<Prim, UsdaError> {
        if depth > MAX_DEPTH {
            return Err(self.lexer.bad("a prim in over 128 others", "fewer"));
        }
        let mut type_name = String::new();
        let name = loop {
            match self.lexer.next()? {
                Token::Name(word) => type_name = word.to_owned(),
                Token::Text(name) => break name.to_owned(),
                token => return Err(self.unexpected(token, "a prim's type or name")),
            }
        };
        let mut prim = Prim {
            specifier,
            is_active: true,
            type_name,
            name,
            properties: BTreeMap::new(),
            children: Vec::new(),
        };
        if self.lexer.peek()? == Token::Sign('(') {
            let metadata = self.metadata(&prim.name)?;
            prim.is_active = metadata.get("active").and_then(Value::number) != Some(0.0);
        }
        self.expect('{')?;
        loop {
            match self.lexer.next()? {
                Token::Sign('}') => return Ok(prim),
                Token::Sign(';') => (),
                Token::Name("variantSet") => {
                    self.layer.warnings.push(format!("prim {}: variants were not followed", prim.name));
                    self.skip_until('{')?;
                    self.skip_brackets(1)?;
                }
                Token::Name(word) => match specifier_of(word) {
                    Some(specifier) => prim.children.push(self.prim(specifier, depth + 1)?),
                    None => {
                        if let Some((name, property)) = self.property(word)? {
                            merge(prim.properties.entry(name).or_default(), property);
                        }
                    }
                },
                token => return Err(self.unexpected(token, "a property, a prim or }")),
            }
        }
    }

    /// `(…)` behind a layer, a prim or a property: names and values; the rest is passed over.
    fn metadata(&mut self, of: &str) -> Result<BTreeMap<String, Value>, UsdaError> {
        self.expect('(')?;
        let mut metadata = BTreeMap::new();
        let mut name = "";
        loop {
            match self.lexer.next()? {
                Token::Sign(')') => return Ok(metadata),
                // The last name before the equals sign is the one that counts: `prepend references = …`.
                Token::Name(word) => name = word,
                Token::Sign('=') => {
                    let value = self.value(0)?;
                    if COMPOSITION.contains(&name) {
                        self.layer.warnings.push(format!("{of}: {name} were not followed"));
                    }
                    metadata.insert(name.to_owned(), value);
                }
                Token::End => return Err(self.unexpected(Token::End, ")")),
                _ => (),
            }
        }
    }

    /// `[uniform …] TYPE[[]] NAME [= VALUE] [(…)]`, its first word being taken. `None` for one without value.
    fn property(&mut self, first: &'a str) -> Result<Option<(String, Property)>, UsdaError> {
        let mut kind = first;
        while MODIFIERS.contains(&kind) {
            kind = self.a_name()?;
        }
        if self.eat('[')? {
            self.expect(']')?;
        }
        // `reorder nameChildren = […]` has no type.
        let is_name_next = matches!(self.lexer.peek()?, Token::Name(_));
        let name = if is_name_next { self.a_name()? } else { kind };
        let mut property = None;
        if self.eat('=')? {
            let (name, suffix) = name.split_once('.').unwrap_or((name, ""));
            let value = match suffix {
                "timeSamples" => self.samples(name.starts_with(OPERATIONS))?,
                "" | "default" => Property { value: Some(self.value(0)?), ..Property::default() },
                _ => {
                    self.value(0)?;
                    Property::default()
                }
            };
            property = Some((name.to_owned(), value));
        }
        if self.lexer.peek()? == Token::Sign('(') {
            self.metadata("a property")?;
        }
        Ok(property)
    }

    fn a_name(&mut self) -> Result<&'a str, UsdaError> {
        match self.lexer.next()? {
            Token::Name(name) => Ok(name),
            token => Err(self.unexpected(token, "a name")),
        }
    }

    /// `{ TIME: VALUE, … }`, of which all or the earliest are kept.
    fn samples(&mut self, all: bool) -> Result<Property, UsdaError> {
        let mut property = Property::default();
        self.expect('{')?;
        while !self.eat('}')? {
            let time = match self.lexer.next()? {
                Token::Number(time) => time,
                token => return Err(self.unexpected(token, "a time")),
            };
            self.expect(':')?;
            let value = self.value(0)?;
            property.n_samples += 1;
            let is_earliest = property.samples.first().is_none_or(|(first, _)| time < *first);
            if !all && is_earliest && value != Value::Other {
                property.samples.clear();
            }
            if (all || is_earliest) && value != Value::Other {
                property.samples.push((time, value));
            }
            if !self.eat(',')? {
                self.expect('}')?;
                break;
            }
        }
        // Of two at one time the later word holds, as in a dictionary.
        property.samples.reverse();
        property.samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        property.samples.dedup_by(|a, b| a.0 == b.0);
        if let Some((time, _)) = property.samples.iter().find(|(time, _)| !time.is_finite()) {
            return Err(self.lexer.bad(&format!("a sample at {time}"), "a finite time"));
        }
        Ok(property)
    }

    /// A value, flattened.
    fn value(&mut self, depth: usize) -> Result<Value, UsdaError> {
        let mut numbers = Vec::new();
        let mut texts = Vec::new();
        let is_other = self.collect(&mut numbers, &mut texts, depth)?;
        Ok(match (is_other, numbers.is_empty(), texts.is_empty()) {
            (false, _, true) => Value::Numbers(numbers),
            (false, true, false) => Value::Texts(texts),
            _ => Value::Other,
        })
    }

    /// Appends the numbers and texts of a value; tells whether it holds anything else.
    fn collect(
        &mut self,
        numbers: &mut Vec<f64>,
        texts: &mut Vec<String>,
        depth: usize,
    ) -> Result<bool, UsdaError> {
        if depth > MAX_DEPTH {
            return Err(self.lexer.bad("brackets in over 128 others", "fewer"));
        }
        match self.lexer.next()? {
            Token::Number(value) => numbers.push(value),
            Token::Text(text) => texts.push(text.to_owned()),
            Token::Name("true") => numbers.push(1.0),
            Token::Name("false") => numbers.push(0.0),
            Token::Name(_) => return Ok(true),
            Token::Reference => {
                // A prim's path and a time offset may follow a layer's name without a comma.
                while self.lexer.peek()? == Token::Reference {
                    self.lexer.next()?;
                }
                if self.eat('(')? {
                    self.skip_brackets(1)?;
                }
                return Ok(true);
            }
            Token::Sign('{') => {
                self.skip_brackets(1)?;
                return Ok(true);
            }
            Token::Sign(open @ ('(' | '[')) => {
                let close = if open == '(' { ')' } else { ']' };
                let mut is_other = false;
                while !self.eat(close)? {
                    is_other |= self.collect(numbers, texts, depth + 1)?;
                    if !self.eat(',')? {
                        self.expect(close)?;
                        break;
                    }
                }
                return Ok(is_other);
            }
            token => return Err(self.unexpected(token, "a value")),
        }
        Ok(false)
    }

    fn skip_until(&mut self, sign: char) -> Result<(), UsdaError> {
        loop {
            match self.lexer.next()? {
                Token::Sign(found) if found == sign => return Ok(()),
                Token::End => return Err(self.unexpected(Token::End, &format!("{sign}"))),
                _ => (),
            }
        }
    }

    /// Passes over everything until `depth` open brackets are closed.
    fn skip_brackets(&mut self, mut depth: usize) -> Result<(), UsdaError> {
        while depth > 0 {
            match self.lexer.next()? {
                Token::Sign('(' | '[' | '{') => depth += 1,
                Token::Sign(')' | ']' | '}') => depth -= 1,
                Token::End => return Err(self.unexpected(Token::End, "a closing bracket")),
                _ => (),
            }
        }
        Ok(())
    }
}

/// Puts an attribute's samples beside its value, which stand in statements of their own.
fn merge(property: &mut Property, other: Property) {
    property.value = other.value.or(property.value.take());
    if !other.samples.is_empty() {
        property.samples = other.samples;
    }
    property.n_samples = property.n_samples.max(other.n_samples);
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYER: &str = r#"#usda 1.0
(
    "a comment"
    defaultPrim = "A"
    metersPerUnit = 0.01
    customLayerData = { dictionary x = { int a = 1 } }
    subLayers = [@./a.usda@ (offset = 1), @b.usda@]
)
reorder rootPrims = ["A"]
def Xform "A" (
    prepend references = @c.usda@</C> (scale = 2)
    kind = "component"
)
{
    custom uniform token name = "x" (doc = """a) "b" """)
    token outputs:surface
    double3 xformOp:translate.timeSamples = { 5: (1, 2, 3), 2: (4, 5, 6), 3: None, }
    double3 xformOp:translate
    rel material:binding = [</a>, </b>]
    token in.connect = </A.b>
    reorder nameChildren = ["B"]
    variantSet "look" = { "red" { def "X" { } } "blue" { } }
    def "B" { int[] n = [1, 2]; point3f[] p = [(1, 2, 3), (4, 5, 6)] (interpolation = "vertex") }
    over "C" { }
    point3f[] points.timeSamples = { 1: [(1, 2, 3)], 0: [(4, 5, 6)], 2: [(7, 8, 9)] }
}
"#;

    fn kept_points(prim: &Prim) -> usize {
        assert_eq!(prim.numbers("points"), Some(&[4.0, 5.0, 6.0][..]));
        prim.properties["points"].samples.len()
    }

    #[test]
    fn a_layer() {
        let layer = parse(LAYER.as_bytes()).unwrap();
        assert_eq!(layer.metadata["metersPerUnit"].number(), Some(0.01));
        assert_eq!(layer.metadata["defaultPrim"].text(), Some("A"));
        let a = &layer.prims[0];
        assert_eq!((a.type_name.as_str(), a.name.as_str(), a.children.len()), ("Xform", "A", 2));
        assert_eq!(a.text("name"), Some("x"));
        assert_eq!(a.numbers("xformOp:translate"), Some(&[4.0, 5.0, 6.0][..]), "the earliest sample");
        assert!(a.is_animated("xformOp:translate"));
        assert_eq!(
            a.codes("xformOp:translate").collect::<Vec<_>>(),
            [2.0, 5.0],
            "rising, blocked ones left out"
        );
        assert_eq!(kept_points(a), 1, "of anything but a transform the earliest");
        let b = &a.children[0];
        assert_eq!(b.numbers("n"), Some(&[1.0, 2.0][..]));
        assert_eq!(b.numbers("p"), Some(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0][..]));
        assert_eq!(a.children[1].specifier, Specifier::Over);
        let expected = [
            "the layer: subLayers were not followed",
            "A: references were not followed",
            "prim A: variants were not followed",
        ];
        assert_eq!(layer.warnings, expected);
    }

    #[test]
    fn samples_hold_over_the_default_beside_them() {
        for both in [
            "float a = 1 float a.timeSamples = { 5: 3, 4: 2 }",
            "float a.timeSamples = { 4: 2, 5: 3 } float a.default = 1",
        ] {
            let layer = parse(format!("#usda 1.0\ndef \"p\" {{ {both} }}").as_bytes()).unwrap();
            assert_eq!(layer.prims[0].numbers("a"), Some(&[2.0][..]), "{both}");
        }
    }

    #[test]
    fn a_cut_layer_is_refused_with_its_line() {
        let end = LAYER.trim_end().len();
        let start = LAYER.find("def Xform").unwrap();
        for len in (start + 3..end).filter(|len| LAYER.is_char_boundary(*len)) {
            assert!(parse(&LAYER.as_bytes()[..len]).is_err(), "{}", &LAYER[..len]);
        }
        let error = parse(b"#usda 1.0\ndef X \"a\" {\n int b = }\n").unwrap_err().to_string();
        assert!(error.contains("line 3"), "{error}");
    }

    #[test]
    fn what_is_too_deep_is_refused() {
        let prims = "def \"a\" {".repeat(100_000);
        assert!(parse(prims.as_bytes()).unwrap_err().to_string().contains("over 128"));
        let brackets = format!("def \"a\" {{ int b = {}", "[".repeat(100_000));
        assert!(parse(brackets.as_bytes()).unwrap_err().to_string().contains("over 128"));
    }
}

//! Words of USD text.

use crate::UsdaError;
use crate::error::bad;

/// One word of a layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Token<'a> {
    /// A name, with its namespaces and suffix: `xformOp:transform.timeSamples`.
    Name(&'a str),
    /// A number.
    Number(f64),
    /// What stands between quotes, escapes as they are.
    Text(&'a str),
    /// `@asset@` or `</path>`.
    Reference,
    /// A bracket, comma, equals sign and the like.
    Sign(char),
    /// The end of the layer.
    End,
}

/// Takes words off a layer.
pub(crate) struct Lexer<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Lexer<'a> {
    pub(crate) fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }

    /// The line that is being read, from 1.
    pub(crate) fn line(&self) -> usize {
        1 + self.text.as_bytes()[..self.at].iter().filter(|b| **b == b'\n').count()
    }

    /// An error at this line.
    pub(crate) fn bad(&self, found: &str, expected: &str) -> UsdaError {
        bad(format!("line {}", self.line()), found, expected)
    }

    /// The next word, left where it is.
    pub(crate) fn peek(&mut self) -> Result<Token<'a>, UsdaError> {
        let before = self.at;
        let token = self.next();
        self.at = before;
        token
    }

    /// The next word.
    pub(crate) fn next(&mut self) -> Result<Token<'a>, UsdaError> {
        self.skip_blanks()?;
        let rest = &self.text[self.at..];
        let Some(first) = rest.chars().next() else { return Ok(Token::End) };
        match first {
            '"' | '\'' => self.text_in_quotes(),
            '@' => self.enclosed(if rest.starts_with("@@@") { "@@@" } else { "@" }),
            '<' => self.enclosed_by("<", ">"),
            '0'..='9' | '-' | '+' | '.' => self.number(),
            c if is_name(c) => Ok(self.name()),
            c => {
                self.at += c.len_utf8();
                Ok(Token::Sign(c))
            }
        }
    }

    fn skip_blanks(&mut self) -> Result<(), UsdaError> {
        loop {
            let rest = &self.text[self.at..];
            let trimmed = rest.trim_start();
            self.at += rest.len() - trimmed.len();
            if trimmed.starts_with('#') || trimmed.starts_with("//") {
                self.at += trimmed.find('\n').unwrap_or(trimmed.len());
            } else if trimmed.starts_with("/*") {
                let end = trimmed.find("*/").ok_or_else(|| self.bad("an open comment", "*/"))?;
                self.at += end + 2;
            } else {
                return Ok(());
            }
        }
    }

    /// Text in single or triple quotes; a backslash takes away the meaning of what follows.
    fn text_in_quotes(&mut self) -> Result<Token<'a>, UsdaError> {
        let rest = &self.text[self.at..];
        let quotes = ["\"\"\"", "'''", "\"", "'"];
        let quote = quotes.into_iter().find(|q| rest.starts_with(q)).unwrap_or("\"");
        let start = quote.len();
        let mut at = start;
        let bytes = rest.as_bytes();
        while at < bytes.len() {
            if bytes[at] == b'\\' {
                at += 2;
            } else if bytes[at..].starts_with(quote.as_bytes()) {
                self.at += at + quote.len();
                return Ok(Token::Text(&rest[start..at]));
            } else {
                at += 1;
            }
        }
        Err(self.bad("an open quote", quote))
    }

    fn enclosed(&mut self, sign: &str) -> Result<Token<'a>, UsdaError> {
        self.enclosed_by(sign, sign)
    }

    fn enclosed_by(&mut self, open: &str, close: &str) -> Result<Token<'a>, UsdaError> {
        let rest = &self.text[self.at + open.len()..];
        let len = rest.find(close).ok_or_else(|| self.bad(&format!("an open {open}"), close))?;
        self.at += open.len() + len + close.len();
        Ok(Token::Reference)
    }

    fn number(&mut self) -> Result<Token<'a>, UsdaError> {
        let rest = &self.text[self.at..];
        let is_part = |c: char| c.is_ascii_alphanumeric() || matches!(c, '.' | '-' | '+');
        let word = &rest[..rest.find(|c| !is_part(c)).unwrap_or(rest.len())];
        match word.parse() {
            Ok(value) => {
                self.at += word.len();
                Ok(Token::Number(value))
            }
            Err(_) => Err(self.bad(&format!("{word:?}"), "a number")),
        }
    }

    fn name(&mut self) -> Token<'a> {
        let rest = &self.text[self.at..];
        let is_part = |c: char| is_name(c) || c.is_ascii_digit() || matches!(c, ':' | '.');
        let word = &rest[..rest.find(|c| !is_part(c)).unwrap_or(rest.len())];
        self.at += word.len();
        match word {
            "inf" => Token::Number(f64::INFINITY),
            "nan" => Token::Number(f64::NAN),
            name => Token::Name(name),
        }
    }
}

/// Whether a name can start with this; USD allows letters of any script.
fn is_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words() {
        let text = "a:b.c[] = (-1e-7, .5, inf, -inf) \"q\\\"\" '''two\nlines''' @x@ @@@y@z@@@ </a/b> # end\n/* c */ é;";
        let mut lexer = Lexer::new(text);
        let mut found = Vec::new();
        loop {
            match lexer.next().unwrap() {
                Token::End => break,
                token => found.push(token),
            }
        }
        let expected = [
            Token::Name("a:b.c"),
            Token::Sign('['),
            Token::Sign(']'),
            Token::Sign('='),
            Token::Sign('('),
            Token::Number(-1e-7),
            Token::Sign(','),
            Token::Number(0.5),
            Token::Sign(','),
            Token::Number(f64::INFINITY),
            Token::Sign(','),
            Token::Number(f64::NEG_INFINITY),
            Token::Sign(')'),
            Token::Text("q\\\""),
            Token::Text("two\nlines"),
            Token::Reference,
            Token::Reference,
            Token::Reference,
            Token::Name("é"),
            Token::Sign(';'),
        ];
        assert_eq!(found, expected);
        assert_eq!(lexer.line(), 3);
    }

    #[test]
    fn what_does_not_end_is_refused() {
        for text in ["\"a", "'''a'", "\"a\\", "@a", "</a", "/* a", "1e", "--1"] {
            assert!(Lexer::new(text).next().is_err(), "{text}");
        }
    }
}

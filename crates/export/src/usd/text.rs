//! The text of a `.usda` layer, streamed.

use std::fmt;
use std::io::{self, Write};

/// How much text is gathered before it goes out.
const BATCH: usize = 1 << 16;

/// A sink for lines of USD text that knows how deep it is and how numbers are written.
pub(super) struct Text<W: Write> {
    out: W,
    buffer: Vec<u8>,
    depth: usize,
}

/// A number in the shortest digits that read back as the same number.
trait Digits: zmij::Float {}

impl Digits for f32 {}

impl Digits for f64 {}

impl<W: Write> Text<W> {
    pub(super) fn new(out: W) -> Self {
        Self { out, buffer: Vec::with_capacity(BATCH + 256), depth: 0 }
    }

    /// One line at the present depth.
    pub(super) fn line(&mut self, line: fmt::Arguments<'_>) -> io::Result<()> {
        self.indent();
        self.buffer.write_fmt(line)?;
        self.end_line()
    }

    /// A line, and everything until [`Text::close`] a step deeper.
    pub(super) fn open(&mut self, line: fmt::Arguments<'_>) -> io::Result<()> {
        self.line(line)?;
        self.depth += 1;
        Ok(())
    }

    /// `def TYPE "NAME"` and its opening brace.
    pub(super) fn open_prim(&mut self, kind: &str, name: &str) -> io::Result<()> {
        self.line(format_args!("def {kind} \"{name}\""))?;
        self.open(format_args!("{{"))
    }

    /// The closing bracket of the last [`Text::open`].
    pub(super) fn close(&mut self, bracket: &str) -> io::Result<()> {
        self.depth -= 1;
        self.line(format_args!("{bracket}"))
    }

    /// An attribute that changes over time: one value a code, written by `value`, which gets the code's index.
    pub(super) fn samples(
        &mut self,
        declaration: &str,
        codes: &[f64],
        mut value: impl FnMut(&mut Self, usize) -> io::Result<()>,
    ) -> io::Result<()> {
        self.open(format_args!("{declaration}.timeSamples = {{"))?;
        for (k, code) in codes.iter().enumerate() {
            self.indent();
            self.f64(*code);
            self.buffer.extend_from_slice(b": ");
            value(self, k)?;
            self.buffer.push(b',');
            self.end_line()?;
        }
        self.close("}")
    }

    /// An attribute with one value, put by `value`.
    pub(super) fn value(&mut self, declaration: &str, value: impl FnOnce(&mut Self)) -> io::Result<()> {
        self.indent();
        self.put(format_args!("{declaration} = "));
        value(self);
        self.end_line()
    }

    /// An attribute with one list of values, each written by `item`, and metadata in parentheses, if any.
    pub(super) fn array<T>(
        &mut self,
        declaration: &str,
        items: impl IntoIterator<Item = T>,
        item: impl FnMut(&mut Self, T),
        metadata: &str,
    ) -> io::Result<()> {
        self.indent();
        self.put(format_args!("{declaration} = "));
        self.list(items, item)?;
        self.put(format_args!("{metadata}"));
        self.end_line()
    }

    /// `[a, b, c]`, each by `item`.
    pub(super) fn list<T>(
        &mut self,
        items: impl IntoIterator<Item = T>,
        mut item: impl FnMut(&mut Self, T),
    ) -> io::Result<()> {
        self.buffer.push(b'[');
        for (k, value) in items.into_iter().enumerate() {
            if k > 0 {
                self.buffer.extend_from_slice(b", ");
            }
            item(self, value);
            self.flush_if_full()?;
        }
        self.buffer.push(b']');
        Ok(())
    }

    /// `(x, y, z)`.
    pub(super) fn tuple<const N: usize>(&mut self, values: [f32; N]) {
        self.buffer.push(b'(');
        for (k, value) in values.into_iter().enumerate() {
            if k > 0 {
                self.buffer.extend_from_slice(b", ");
            }
            self.f32(value);
        }
        self.buffer.push(b')');
    }

    pub(super) fn f32(&mut self, value: f32) {
        self.digits(value);
    }

    pub(super) fn f64(&mut self, value: f64) {
        self.digits(value);
    }

    pub(super) fn usize(&mut self, value: usize) {
        self.put(format_args!("{value}"));
    }

    pub(super) fn put(&mut self, text: fmt::Arguments<'_>) {
        // Writing to a vector cannot fail.
        let _ = self.buffer.write_fmt(text);
    }

    pub(super) fn finish(mut self) -> io::Result<()> {
        self.out.write_all(&self.buffer)?;
        self.out.flush()
    }

    fn digits(&mut self, value: impl Digits) {
        let mut buffer = zmij::Buffer::new();
        let text = buffer.format_finite(value);
        self.buffer.extend_from_slice(text.strip_suffix(".0").unwrap_or(text).as_bytes());
    }

    fn indent(&mut self) {
        for _ in 0..self.depth {
            self.buffer.extend_from_slice(b"    ");
        }
    }

    fn end_line(&mut self) -> io::Result<()> {
        self.buffer.push(b'\n');
        self.flush_if_full()
    }

    fn flush_if_full(&mut self) -> io::Result<()> {
        if self.buffer.len() >= BATCH {
            self.out.write_all(&self.buffer)?;
            self.buffer.clear();
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_exact() {
        let mut out = Vec::new();
        let mut text = Text::new(&mut out);
        text.tuple([0.1, -2.0, 1e-7]);
        text.f64(1.0 / 3.0);
        text.finish().unwrap();
        assert_eq!(str::from_utf8(&out).unwrap(), "(0.1, -2, 1e-7)0.3333333333333333");
    }
}

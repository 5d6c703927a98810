use flate2::{Compression, write::DeflateEncoder};
use serde::Serialize;
use std::io::Write;

/// An array of 16-bit integers on its way into a page: what the script needs to read it, and its text.
///
/// The integers are differenced (once for each lag, with wrap-around), folded so that small negative numbers
/// are small (`0, -1, 1, -2` become `0, 1, 2, 3`), split into a plane of low bytes and one of high bytes,
/// deflated without a header, and written as base64. Every step is exact; `assets/js/codec.js` takes them back
/// in reverse. Small differences leave a high plane of zeros, which costs next to nothing.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Packed {
    /// How many integers.
    pub count: usize,
    /// The lags of the differences, in the order they were taken: `v[i] -= v[i - lag]`.
    pub lags: Vec<usize>,
    /// The base64 text.
    #[serde(skip)]
    pub text: String,
    /// The id of the script element that holds the text.
    pub blob: String,
}

impl Packed {
    /// Packs `values` with each candidate's lags and keeps the shortest; of equals, the first.
    ///
    /// Which lags are good follows from the array's shape: the number of values in a frame for smooth motion,
    /// 1 and the row's length for smooth fields.
    pub fn new(blob: &str, values: &[i16], candidates: &[&[usize]]) -> Self {
        let mut best: Option<(Vec<u8>, &[usize])> = None;
        for &lags in candidates {
            let bytes = deflate(&planes(&differences(values, lags)));
            if best.as_ref().is_none_or(|(shortest, _)| bytes.len() < shortest.len()) {
                best = Some((bytes, lags));
            }
        }
        let (bytes, lags) = best.unwrap_or_else(|| (deflate(&planes(values)), &[]));
        Self { count: values.len(), lags: lags.to_vec(), text: base64(&bytes), blob: blob.to_owned() }
    }

    /// The script element that carries the text. Base64 holds no character that HTML could mistake.
    pub fn element(&self) -> String {
        format!("<script type=\"text/plain\" id=\"{}\">{}</script>\n", crate::escape(&self.blob), self.text)
    }
}

fn differences(values: &[i16], lags: &[usize]) -> Vec<i16> {
    let mut v = values.to_vec();
    for &lag in lags.iter().filter(|&&lag| lag > 0) {
        for i in (lag..v.len()).rev() {
            v[i] = v[i].wrapping_sub(v[i - lag]);
        }
    }
    v
}

fn planes(values: &[i16]) -> Vec<u8> {
    let folded = || values.iter().map(|&v| ((v << 1) ^ (v >> 15)) as u16);
    folded().map(|v| v as u8).chain(folded().map(|v| (v >> 8) as u8)).collect()
}

fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::new(6));
    encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("writing into memory cannot fail")
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = three.iter().fold(0_u32, |bits, &b| bits << 8 | u32::from(b)) << (8 * (3 - three.len()));
        for digit in 0..4 {
            let filled = digit <= three.len();
            let six = (bits >> (18 - 6 * digit) & 63) as usize;
            text.push(if filled { char::from(DIGITS[six]) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_the_rfc() {
        // RFC 4648, section 10.
        for (bytes, text) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foob", "Zm9vYg==")]
        {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    #[test]
    fn small_differences_leave_an_empty_high_plane() {
        // 300, 301, 299 with lag 1: 300, 1, -2; folded: 600 = 0x258, 2, 3.
        assert_eq!(planes(&differences(&[300, 301, 299], &[1])), [0x58, 2, 3, 2, 0, 0]);
        assert_eq!(differences(&[i16::MIN, i16::MAX], &[1]), [i16::MIN, -1]);
    }

    #[test]
    fn the_shortest_candidate_is_kept() {
        let ramp: Vec<i16> = (0..4000).map(|k| k * 7).collect();
        assert_eq!(Packed::new("a", &ramp, &[&[], &[1], &[2000]]).lags, [1]);
        let empty = Packed::new("a", &[], &[&[3]]);
        assert_eq!((empty.count, empty.lags.as_slice()), (0, &[3][..]));
    }
}

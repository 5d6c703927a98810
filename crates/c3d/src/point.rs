/// One marker in one frame, seen.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Coordinates in the file's own unit and axes, finite.
    pub position: [f32; 3],
    /// The cameras' mean residual in steps of the file's scale ([`Info::scale`](crate::Info::scale)). Many systems
    /// write 0, which can mean "interpolated".
    pub residual: u8,
    /// The cameras that saw the marker, one bit each, the first seven.
    pub cameras: u8,
}

impl Point {
    /// A point of which nothing but its position is known.
    pub fn at(position: [f32; 3]) -> Self {
        Self { position, residual: 0, cameras: 0 }
    }

    /// The point with this fourth word, or `None` if it is missing: the sign bit is set, or a coordinate is not finite.
    #[inline]
    pub(crate) fn from_word(position: [f32; 3], word: i16) -> Option<Self> {
        if word < 0 || !position.iter().all(|c| c.is_finite()) {
            return None;
        }
        let [cameras, residual] = word.to_be_bytes();
        Some(Self { position, residual, cameras })
    }

    /// The fourth word: camera bits above the residual.
    pub(crate) fn word(self) -> i16 {
        i16::from_be_bytes([self.cameras & 0x7f, self.residual])
    }
}

/// The fourth word of a point stored as a float: the integer word, converted.
///
/// Some systems convert it unsigned, so 32768 to 65535 have the sign bit set (65535 is -1). A number beyond 16 bits
/// or NaN is no word at all; it occurs on valid points and tells nothing.
#[inline]
pub(crate) fn word_from_f32(word: f32) -> i16 {
    if word < 0.0 {
        -1
    } else if word < 65536.0 {
        (word as u16).cast_signed()
    } else {
        0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_missing() {
        let at = |word| Point::from_word([1.0, 2.0, 3.0], word_from_f32(word));
        let seen = |cameras, residual| Some(Point { position: [1.0, 2.0, 3.0], residual, cameras });
        assert_eq!(at(-1.0), None);
        assert_eq!(at(65535.0), None, "-1 written unsigned");
        assert_eq!(at(32768.0), None);
        assert_eq!(at(0.0), seen(0, 0));
        assert_eq!(at(32767.0), seen(0x7f, 0xff));
        assert_eq!(at(684.0), seen(2, 0xac), "a residual above 127 is no sign");
        assert_eq!(at(1.708e38), seen(0, 0), "no word at all");
        assert_eq!(at(f32::NAN), seen(0, 0), "no word at all");
        assert_eq!(Point::from_word([0.0, f32::NAN, 0.0], 0), None);
        assert_eq!(Point::from_word([0.0, 0.0, f32::INFINITY], 0), None);
    }
}

use crate::trial::Trial;
use crate::{Point, Processor, Storage};

/// Codes points for one processor and storage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coder {
    processor: Processor,
    storage: Storage,
    scale: f32,
}

impl Coder {
    pub fn new(trial: &Trial) -> Self {
        Self { processor: trial.processor, storage: trial.storage, scale: trial.scale }
    }

    /// Bytes of one point.
    pub fn point_bytes(self) -> u64 {
        4 * self.storage.word_bytes()
    }

    /// # Errors
    /// Why the point cannot be stored.
    pub fn push(self, bytes: &mut Vec<u8>, point: Option<Point>) -> Result<(), &'static str> {
        // A missing point stands at the origin, with the sign bit of the fourth word set.
        let (position, word) = point.map_or(([0.0; 3], -1), |p| (p.position, p.word()));
        if point.is_some_and(|p| p.cameras > 0x7f) {
            return Err("the cameras' mask has more than seven bits");
        }
        if position.iter().any(|c| !c.is_finite()) {
            return Err("a coordinate is not finite");
        }
        match self.storage {
            Storage::Float32 => self.push_floats(bytes, position, word),
            Storage::Int16 => self.push_ints(bytes, position, word),
        }
    }

    fn push_floats(self, bytes: &mut Vec<u8>, position: [f32; 3], word: i16) -> Result<(), &'static str> {
        let [x, y, z] = position;
        for value in [x, y, z, f32::from(word)] {
            if !self.processor.holds(value) {
                return Err("a coordinate is too large for a VAX float");
            }
            bytes.extend(self.processor.write_f32(value));
        }
        Ok(())
    }

    fn push_ints(self, bytes: &mut Vec<u8>, position: [f32; 3], word: i16) -> Result<(), &'static str> {
        for coordinate in position {
            let steps = (f64::from(coordinate) / f64::from(self.scale)).round();
            if !(-32768.0..=32767.0).contains(&steps) {
                return Err("a coordinate is more than 32767 steps of the scale");
            }
            bytes.extend(self.processor.write_u16((steps as i16).cast_unsigned()));
        }
        bytes.extend(self.processor.write_u16(word.cast_unsigned()));
        Ok(())
    }
}

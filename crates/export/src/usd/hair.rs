//! What curves and reeds share: the motion on USD's time line, widths, extents.

use std::io::{self, Write};

use tousle_core::{Groom, StrandMotion};

use super::UsdOptions;
use super::text::Text;
use crate::ExportError;
use crate::motion::check_motion;

/// A motion and its groom that fit together, ready to be written.
pub(super) struct Hair<'a> {
    pub(super) motion: &'a StrandMotion,
    pub(super) groom: &'a Groom,
    /// How wide each strand is, m.
    pub(super) widths_m: Vec<f32>,
    /// Time code of each frame.
    pub(super) codes: Vec<f64>,
    /// Time codes a second.
    pub(super) rate_hz: f64,
}

/// The time line of a motion of one frame, which has no rate of its own.
const STILL_RATE_HZ: f64 = 24.0;

/// Time codes within this of a whole number are written as that number. Times that went through 32 bits are off
/// by about 1e-5 of a frame.
const CODE_ROUNDING: f64 = 1e-3;

/// A rate that is given may be off by this share of the frames' own, which went through sums and perhaps 32 bits.
const RATE_ROUNDING: f64 = 1e-4;

impl<'a> Hair<'a> {
    pub(super) fn new(
        motion: &'a StrandMotion,
        groom: &'a Groom,
        options: &UsdOptions<'_>,
    ) -> Result<Self, ExportError> {
        groom.check()?;
        check_motion(motion)?;
        check_counts(&motion.counts, &groom.counts())?;
        let rate_hz = time_codes_per_second(&motion.times_secs, options.rate_hz)?;
        let codes = motion.times_secs.iter().map(|t| snap(t * rate_hz, CODE_ROUNDING)).collect();
        let widths_m = groom.strands.iter().map(|s| (s.lock_width_m * options.width_scale) as f32).collect();
        Ok(Self { motion, groom, widths_m, codes, rate_hz })
    }
}

fn check_counts(of_motion: &[usize], of_groom: &[usize]) -> Result<(), ExportError> {
    let bad = |found: String, expected: String| Err(ExportError::BadMotion { found, expected });
    if of_motion.len() != of_groom.len() {
        return bad(format!("{} strands", of_motion.len()), format!("the groom's {}", of_groom.len()));
    }
    match (0..of_groom.len()).find(|k| of_motion[*k] != of_groom[*k]) {
        None => Ok(()),
        Some(k) => {
            bad(format!("strand {k} of {} points", of_motion[k]), format!("the groom's {}", of_groom[k]))
        }
    }
}

/// One code a frame, so that frames are whole numbers as animators expect: `given`, which no sum of times has rounded, if the frames
/// are so far apart.
fn time_codes_per_second(times_secs: &[f64], given: Option<f64>) -> Result<f64, ExportError> {
    if let Some(rate) = given.filter(|rate| !(rate.is_finite() && *rate > 0.0)) {
        let (found, expected) = (format!("a rate of {rate} Hz"), "a number above 0".to_owned());
        return Err(ExportError::BadOptions { found, expected });
    }
    let bad =
        |found: String| Err(ExportError::BadMotion { found, expected: "frames at rising times".into() });
    let (Some(first), Some(last)) = (times_secs.first(), times_secs.last()) else {
        return bad("no frames".into());
    };
    if times_secs.len() == 1 {
        return Ok(given.unwrap_or(STILL_RATE_HZ));
    }
    if let Some(k) = times_secs.windows(2).position(|pair| pair[1] <= pair[0]) {
        return bad(format!(
            "frame {} at {} s after frame {k} at {} s",
            k + 1,
            times_secs[k + 1],
            times_secs[k]
        ));
    }
    let rate_hz = (times_secs.len() - 1) as f64 / (last - first);
    if !rate_hz.is_finite() {
        return bad(format!("frames {} s apart", 1.0 / rate_hz));
    }
    match given {
        Some(given) if (given - rate_hz).abs() <= RATE_ROUNDING * rate_hz => Ok(given),
        Some(given) => {
            let expected = format!("the frames' own, {rate_hz} Hz");
            Err(ExportError::BadOptions { found: format!("a rate of {given} Hz"), expected })
        }
        None => Ok(snap(rate_hz, 1e-4)),
    }
}

fn snap(value: f64, within: f64) -> f64 {
    let whole = value.round();
    if (value - whole).abs() <= within { whole } else { value }
}

/// A box around points.
pub(super) struct Bounds {
    low: [f32; 3],
    high: [f32; 3],
}

impl Bounds {
    pub(super) fn add(&mut self, point: [f32; 3]) {
        for (axis, x) in point.into_iter().enumerate() {
            self.low[axis] = self.low[axis].min(x);
            self.high[axis] = self.high[axis].max(x);
        }
    }

    pub(super) fn grow(&mut self, margin: f32) {
        self.low = self.low.map(|x| x - margin);
        self.high = self.high.map(|x| x + margin);
    }
}

/// The box of each frame, as `fill` fills it.
pub(super) fn write_extents<W: Write>(
    text: &mut Text<W>,
    codes: &[f64],
    fill: impl Fn(usize, &mut Bounds),
) -> io::Result<()> {
    text.samples("float3[] extent", codes, |text, frame| {
        let mut bounds = Bounds { low: [f32::INFINITY; 3], high: [f32::NEG_INFINITY; 3] };
        fill(frame, &mut bounds);
        text.list([bounds.low, bounds.high], Text::tuple)
    })
}

/// A dark brown, so that hair does not arrive white where nobody has set up materials.
pub(super) fn write_color<W: Write>(text: &mut Text<W>) -> io::Result<()> {
    text.array("color3f[] primvars:displayColor", [[0.12, 0.07, 0.04]], Text::tuple, "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_fall_on_whole_time_codes() {
        let times: Vec<f64> = (0..300_u16).map(|k| f64::from(f32::from(k) / 60.0)).collect();
        assert_eq!(time_codes_per_second(&times, None).unwrap(), 60.0);
        assert_eq!(snap(times[299] * 60.0, CODE_ROUNDING), 299.0);
        assert_eq!(time_codes_per_second(&[3.0], None).unwrap(), 24.0);
        assert!(time_codes_per_second(&[], None).is_err());
        assert!(time_codes_per_second(&[0.0, 0.0], None).is_err());
        assert!(time_codes_per_second(&[0.0, 5e-324], None).is_err());
    }

    #[test]
    fn a_rate_that_was_asked_for_is_written_to_the_bit() {
        for rate in [24000.0 / 1001.0, 30000.0 / 1001.0, 23.976, 60.0] {
            for start in [0.0, 1.0 / 3.0] {
                let times: Vec<f64> = (0..200_u16).map(|k| start + f64::from(k) / rate).collect();
                assert_eq!(time_codes_per_second(&times, Some(rate)).unwrap(), rate);
            }
            assert_eq!(time_codes_per_second(&[3.0], Some(rate)).unwrap(), rate);
        }
        let wrong = time_codes_per_second(&[0.0, 0.5], Some(24.0)).unwrap_err().to_string();
        assert!(wrong.contains("24 Hz") && wrong.contains("2 Hz"), "{wrong}");
        assert!(time_codes_per_second(&[0.0], Some(0.0)).is_err());
    }
}

/// An axis of a [`crate::Plot`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// What is along it.
    pub label: String,
    /// The unit; empty for none.
    pub unit: String,
    /// How values are spaced.
    pub scale: Scale,
    /// First and last value; `None` takes what the points need, with 0 included on a linear axis.
    pub range: Option<[f64; 2]>,
}

/// How an [`Axis`] spaces its values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By their logarithm; values of 0 and less have no place.
    Log10,
}

/// An axis with its range settled, laid between two places on the drawing, px.
pub(super) struct Placed {
    scale: Scale,
    range: [f64; 2],
    ends: [f64; 2],
}

impl Axis {
    pub(super) fn title(&self) -> String {
        match self.unit.as_str() {
            "" => self.label.clone(),
            unit => format!("{} ({unit})", self.label),
        }
    }

    pub(super) fn place(&self, values: impl Iterator<Item = f64>, first: f64, last: f64) -> Placed {
        let usable = |v: &f64| v.is_finite() && (self.scale == Scale::Linear || *v > 0.0);
        let asked = self.range.filter(|[a, b]| usable(a) && usable(b) && a < b);
        let range = asked.unwrap_or_else(|| self.range_of(values.filter(usable)));
        Placed { scale: self.scale, range, ends: [first, last] }
    }

    /// The range the values need, ending on ticks so that the outermost grid lines close the frame.
    fn range_of(&self, values: impl Iterator<Item = f64>) -> [f64; 2] {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        match self.scale {
            Scale::Linear => {
                let (low, high) = if low > high { (0.0, 1.0) } else { (low.min(0.0), high.max(0.0)) };
                let high = if high > low { high } else { low + 1.0 };
                let step = nice_step(high - low);
                [(low / step).floor() * step, (high / step).ceil() * step]
            }
            Scale::Log10 => {
                let (low, high) = if low > high { (1.0, 10.0) } else { (low, high) };
                let first = libm::log10(low).floor();
                let last = libm::log10(high).ceil().max(first + 1.0);
                [libm::exp10(first), libm::exp10(last)]
            }
        }
    }
}

impl Placed {
    /// Where a value lies, px; `None` where it has no place on the axis.
    pub(super) fn at(&self, value: f64) -> Option<f64> {
        let [first, last] = self.range;
        let share = match self.scale {
            Scale::Linear => (value - first) / (last - first),
            Scale::Log10 if value > 0.0 => {
                (libm::log10(value) - libm::log10(first)) / (libm::log10(last) - libm::log10(first))
            }
            Scale::Log10 => f64::NAN,
        };
        // What lies far outside an asked range is pulled to just beyond it: SVG readers differ on huge numbers.
        share.is_finite().then(|| self.ends[0] + share.clamp(-1.0, 2.0) * (self.ends[1] - self.ends[0]))
    }

    pub(super) fn ends(&self) -> (f64, f64) {
        (self.ends[0], self.ends[1])
    }

    pub(super) fn range(&self) -> (f64, f64) {
        (self.range[0], self.range[1])
    }

    /// The values that get a grid line, with their text.
    pub(super) fn ticks(&self) -> Vec<(f64, String)> {
        let [first, last] = self.range;
        match self.scale {
            Scale::Linear => {
                let step = nice_step(last - first);
                let n_decimals = (-libm::log10(step).floor()).clamp(0.0, 9.0) as usize;
                let k0 = (first / step - 1e-9).ceil();
                let n = ((last / step + 1e-9).floor() - k0).clamp(0.0, 20.0) as usize;
                (0..=n).map(|k| (k0 + k as f64) * step).map(|v| (v, crate::decimals(v, n_decimals))).collect()
            }
            Scale::Log10 => {
                let (k0, k1) = (libm::log10(first).ceil() as i32, libm::log10(last).floor() as i32);
                let every = ((k1 - k0) / 8 + 1) as usize;
                let powers = (k0..=k1).step_by(every).map(|k| (libm::exp10(f64::from(k)), power_text(k)));
                // Few decades have room for what lies between.
                let between = if k1 - k0 <= 3 { &[2_u8, 5][..] } else { &[] };
                let between = (k0..k1).flat_map(|k| between.iter().map(move |n| (k, *n)));
                let between = between.map(|(k, n)| {
                    let value = f64::from(n) * libm::exp10(f64::from(k));
                    (value, power_text(k).replace('1', &n.to_string()))
                });
                powers.chain(between).collect()
            }
        }
    }
}

/// 1, 2 or 5 times a power of ten: the step that cuts `span` into 4 to 10.
fn nice_step(span: f64) -> f64 {
    let rough = span / 5.0;
    let power = libm::exp10(libm::log10(rough).floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * power >= rough * 0.999).unwrap_or(10.0);
    factor * power
}

/// A power of ten as people write it: `0.01`, `100`, and `10⁵` beyond four digits.
fn power_text(exponent: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match exponent {
        0..=4 => format!("1{}", "0".repeat(exponent as usize)),
        -3..0 => format!("0.{}1", "0".repeat((-exponent - 1) as usize)),
        _ => {
            let raised = exponent.unsigned_abs().to_string();
            let raised: String = raised.bytes().map(|b| DIGITS[usize::from(b - b'0')]).collect();
            format!("10{}{raised}", if exponent < 0 { "⁻" } else { "" })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_ticks_are_round_and_close_the_frame() {
        let axis = Axis::default().place([0.3, 4.4].into_iter(), 0.0, 100.0);
        assert_eq!(axis.range(), (0.0, 5.0));
        let texts: Vec<String> = axis.ticks().into_iter().map(|t| t.1).collect();
        assert_eq!(texts, ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(nice_step(0.7), 0.2);
    }

    #[test]
    fn decades_are_evenly_spaced() {
        let axis = Axis { scale: Scale::Log10, ..Axis::default() };
        let placed = axis.place([0.02, 5.0].into_iter(), 0.0, 300.0);
        assert!((placed.at(0.1).unwrap() - 100.0).abs() < 1e-9);
        assert_eq!(placed.at(0.0), None);
        let texts: Vec<String> = placed.ticks().into_iter().map(|t| t.1).collect();
        assert_eq!(texts, ["0.01", "0.1", "1", "10", "0.02", "0.05", "0.2", "0.5", "2", "5"]);
        assert_eq!(power_text(-6), "10⁻⁶");
        assert_eq!(power_text(12), "10¹²");
    }

    #[test]
    fn hopeless_ranges_are_mended() {
        let placed = Axis { range: Some([3.0, 3.0]), ..Axis::default() }.place([].into_iter(), 0.0, 1.0);
        assert_eq!(placed.range(), (0.0, 1.0));
    }
}

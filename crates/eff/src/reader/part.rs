use super::{Reader, Unpacker};
use crate::format::MAX_VOXEL_BYTES;
use crate::{Eff, EffError, ReadOptions};
use rayon::prelude::*;
use std::io::{Read, Seek};
use std::ops::RangeInclusive;
use tousle_core::Vec3;
use tousle_field::{Field, FieldSequence, GridSpec, Window};

/// Which part of a field is wanted.
///
/// Within it, sampling gives what the whole field gives, to rounding: the steps and voxels just beyond its ends
/// that interpolation needs are part of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Part {
    /// From when to when, s; all steps if `None`.
    pub span_secs: Option<[f64; 2]>,
    /// Two opposite corners of a box, the lower ones first, head space, m; the whole grid if `None`.
    pub box_m: Option<[Vec3; 2]>,
    /// Whether the voxels' standard deviations stay in the file; a simulator has no use for them.
    pub leaves_deviations: bool,
}

impl Part {
    /// This part within a span of time, s.
    pub fn within_secs(self, first: f64, last: f64) -> Self {
        Self { span_secs: Some([first, last]), ..self }
    }

    /// This part within a box, head space, m.
    pub fn within_box_m(self, low: Vec3, high: Vec3) -> Self {
        Self { box_m: Some([low, high]), ..self }
    }

    /// This part without the voxels' standard deviations.
    pub fn without_deviations(self) -> Self {
        Self { leaves_deviations: true, ..self }
    }
}

impl<R: Read + Seek> Reader<R> {
    /// Reads a part of the field with its scene and its edits; samples and attachments are left in the file.
    ///
    /// # Errors
    /// [`EffError::Unsound`] if something on the way is not sound, [`EffError::TooLarge`] if the part takes more
    /// memory than `options` allow, [`EffError::Io`] if the stream fails.
    pub fn part(&mut self, part: &Part, options: &ReadOptions) -> Result<Eff, EffError> {
        let info = &self.manifest.field;
        let whole = info.grid.spec();
        let last_step = self.n_steps().saturating_sub(1);
        let (start_secs, rate_hz) = (info.start_secs, info.rate_hz);
        let steps = match part.span_secs {
            Some([first, last]) => {
                around((first - start_secs) * rate_hz, (last - start_secs) * rate_hz, last_step)
            }
            None => 0..=last_step,
        };
        let crop = Crop::new(&whole, part.box_m);
        let needed = steps.clone().count() as u64 * (13 * crop.grid.n_voxels()) as u64;
        if needed > options.max_memory {
            return Err(EffError::TooLarge { needed, allowed: options.max_memory });
        }
        let start_secs = info.step_secs(*steps.start());
        let fields = self.steps(steps, part, &crop)?;
        let scene = self.scene()?;
        Ok(Eff {
            name: self.manifest.name.clone(),
            method: self.manifest.method.clone(),
            generator: self.manifest.generator.clone(),
            field: FieldSequence {
                grid: crop.grid,
                quantity: self.manifest.field.quantity.into(),
                start_secs,
                rate_hz,
                steps: fields,
                layers: self.layers.clone(),
            },
            scene,
            samples: None,
            attachments: Vec::new(),
        })
    }

    /// Reads some steps: what lies in the file one after the other, and what that takes to unpack side by side.
    fn steps(
        &mut self,
        steps: RangeInclusive<u64>,
        part: &Part,
        crop: &Crop,
    ) -> Result<Vec<Field>, EffError> {
        let mut fields = Vec::new();
        if self.n_steps() == 0 {
            return Ok(fields);
        }
        let step_bytes = MAX_VOXEL_BYTES as usize * self.manifest.field.grid.spec().n_voxels();
        let at_once = (PACKED_BYTES / step_bytes).clamp(1, PACKED_A_THREAD * rayon::current_num_threads());
        for first in steps.clone().step_by(at_once) {
            let some = first..=(first + at_once as u64 - 1).min(*steps.end());
            let packed: Vec<_> =
                some.map(|k| Ok((k, self.load_step(k)?))).collect::<Result<_, EffError>>()?;
            let unpacker = Unpacker { leaves_deviations: part.leaves_deviations, ..self.unpacker() };
            let unpacked: Vec<_> = packed
                .into_par_iter()
                .map(|(k, chunks)| unpacker.step(k, &chunks).map(|step| crop.apply(step)))
                .collect();
            // The first step that is not sound is the one to speak of, whoever came to it first.
            for field in unpacked {
                fields.push(field?);
            }
        }
        Ok(fields)
    }
}

/// How many packed steps are held for each thread, and how many bytes in all unless a single one has more.
const PACKED_A_THREAD: usize = 8;
const PACKED_BYTES: usize = 64 << 20;

/// The whole numbers around a span, none past the last one. A NaN asks for everything.
fn around(first: f64, last: f64, end: u64) -> RangeInclusive<u64> {
    // A hair's breadth more, so that rounding never leaves a neighbor out.
    let low = ((first - 1e-9).floor().max(0.0) as u64).min(end);
    let high = if last.is_nan() { end } else { ((last + 1e-9).ceil().max(0.0) as u64).min(end) };
    low..=high.max(low)
}

/// The voxels of a grid that a box needs.
struct Crop {
    whole: GridSpec,
    window: Window,
    grid: GridSpec,
}

impl Crop {
    fn new(whole: &GridSpec, box_m: Option<[Vec3; 2]>) -> Self {
        let around = |[low_m, high_m]: [Vec3; 2]| Window::around(whole, low_m, high_m);
        let window = box_m.map_or_else(|| Window::whole(whole), around);
        let corner = Vec3::from(window.first.map(|i| i as f64)) * whole.edge_m;
        let grid = GridSpec { origin_m: whole.origin_m + corner, edge_m: whole.edge_m, dims: window.dims };
        Self { whole: *whole, window, grid }
    }

    /// The voxels of a step that are within.
    fn apply(&self, step: Field) -> Field {
        if self.grid == self.whole {
            return step;
        }
        let n = self.whole.n_voxels();
        let kept: Vec<usize> = self.window.rows(&self.whole).flatten().collect();
        Field {
            u: (0..3).flat_map(|axis| kept.iter().map(move |k| axis * n + k)).map(|k| step.u[k]).collect(),
            flags: kept.iter().map(|k| step.flags[*k]).collect(),
            sd: step.sd.map(|sd| kept.iter().map(|k| sd[*k]).collect()),
            outside: step.outside,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbors_are_kept_and_ends_are_ends() {
        assert_eq!(around(2.3, 4.7, 9), 2..=5);
        assert_eq!(around(2.0, 4.0, 9), 1..=5);
        assert_eq!(around(-3.0, 0.5, 9), 0..=1);
        assert_eq!(around(20.0, 30.0, 9), 9..=9);
        assert_eq!(around(5.0, 1.0, 9), 4..=4);
        assert_eq!(around(f64::NAN, f64::NAN, 9), 0..=9);
    }
}

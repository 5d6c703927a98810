use crate::finding::Place;
use crate::wire::proto::SampleStep;
use crate::{EffError, Finding, array, check};
use tousle_core::WindSample;

/// The message of a step's samples, in single precision.
pub(super) fn pack(samples: &[WindSample], index: u64, time_ns: u64) -> Result<SampleStep, EffError> {
    let samples: Vec<_> = samples.iter().map(as_floats).collect();
    check_all(&samples)
        .map_err(|f| EffError::bad(format!("samples of step {index}, {}", f.what), f.found, f.expected))?;
    let column = |n: usize, get: fn(&WindSample, usize) -> f64| {
        let numbers = (0..n).flat_map(|c| samples.iter().map(move |s| get(s, c) as f32));
        array::pack_f32(&numbers.collect::<Vec<f32>>())
    };
    Ok(SampleStep {
        index,
        time_ns,
        strand_idx: samples.iter().map(|s| s.strand_idx).collect(),
        marker_idx: samples.iter().map(|s| s.marker_idx).collect(),
        position_m: Some(column(3, |s, c| s.position_m[c])),
        value: Some(column(3, |s, c| s.value[c])),
        covariance: Some(column(6, |s, c| s.covariance[c])),
    })
}

/// A sample as the file will have it: what is checked is what will be read.
fn as_floats(sample: &WindSample) -> WindSample {
    let float = |c: f64| f64::from(c as f32);
    WindSample {
        position_m: sample.position_m.map(float),
        value: sample.value.map(float),
        covariance: sample.covariance.map(float),
        ..*sample
    }
}

fn check_all(samples: &[WindSample]) -> Result<(), Box<Finding>> {
    for (k, sample) in samples.iter().enumerate() {
        for (what, vector) in [("position_m", sample.position_m), ("value", sample.value)] {
            check::finite_vector(vector.into(), &format!("{what}[{k}]"), Place::default())?;
        }
    }
    check::covariances(samples, Place::default())
}

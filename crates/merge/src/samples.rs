use crate::plan::MAX_STEPS;
use tousle_core::{MAX_SECS, WindSample, WindSamples};

/// The measured vectors of several inputs, each with what is added to its times, as those of one.
///
/// # Errors
/// In words, why they cannot be: they are of different quantities or rates, an offset is no whole number of their steps,
/// or there would be too many of these.
pub fn join_samples(inputs: &[(&WindSamples, f64)]) -> Result<WindSamples, String> {
    let Some((first, _)) = inputs.first() else { return Err("no input has any".to_owned()) };
    let most = f64::min(MAX_STEPS, (MAX_SECS * first.rate_hz).floor() + 1.0);
    let mut steps: Vec<Vec<WindSample>> = Vec::new();
    for (samples, offset_secs) in inputs {
        if samples.quantity != first.quantity {
            return Err(format!("some are {}, some {}", first.quantity.name(), samples.quantity.name()));
        }
        if samples.rate_hz != first.rate_hz {
            return Err(format!("some come at {} Hz, some at {} Hz", first.rate_hz, samples.rate_hz));
        }
        let offset = offset_secs * first.rate_hz;
        if (offset - offset.round()).abs() > 1e-6 {
            return Err(format!("an offset of {offset_secs} s is no whole number of their steps"));
        }
        let n_steps = offset.round() + samples.steps.len() as f64;
        if n_steps > most {
            return Err(format!(
                "found {n_steps} steps with an offset of {offset_secs} s, expected at most {most}"
            ));
        }
        let offset = offset.round() as i64;
        for (k, step) in (offset..).zip(&samples.steps) {
            let Ok(k) = usize::try_from(k) else {
                if step.is_empty() {
                    continue;
                }
                return Err("some are before 0 s with their offset".to_owned());
            };
            if steps.len() <= k {
                steps.resize(k + 1, Vec::new());
            }
            steps[k].extend(step);
        }
    }
    Ok(WindSamples { quantity: first.quantity, rate_hz: first.rate_hz, steps })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Quantity;

    /// Where a field of one step is much later than another, its vectors are not put behind as many empty steps.
    #[test]
    fn steps_are_as_many_as_memory_holds() {
        let samples =
            WindSamples { quantity: Quantity::AirVelocity, rate_hz: 100.0, steps: vec![Vec::new(); 2] };
        let joined = join_samples(&[(&samples, 0.0), (&samples, 1.0)]).unwrap();
        assert_eq!(joined.steps.len(), 102);
        for offset_secs in [1e5, 1e6, 1e10, 1e25] {
            let why = join_samples(&[(&samples, 0.0), (&samples, offset_secs)]).unwrap_err();
            assert!(why.starts_with("found 100000"), "{why}");
            assert!(why.ends_with("expected at most 10000000"), "{why}");
        }
    }
}

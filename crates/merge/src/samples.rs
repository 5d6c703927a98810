use tousle_core::{WindSample, WindSamples};

/// The measured vectors of several inputs, each with what is added to its times, as those of one.
///
/// # Errors
/// In words, why they cannot be: they are of different quantities or rates, or an offset is no whole number of
/// their steps.
pub fn join_samples(inputs: &[(&WindSamples, f64)]) -> Result<WindSamples, String> {
    let Some((first, _)) = inputs.first() else { return Err("no input has any".to_owned()) };
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

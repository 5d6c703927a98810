use tousle_core::{Groom, NoProgress};
use tousle_field::{FieldSequence, Scene};
use tousle_sim::{Integrator, Method, Precision, SimError, SimOptions, simulate};

/// A way to step a hairstyle: one column of a table, one curve of a diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Way {
    /// Which equations.
    pub method: Method,
    /// How they are stepped.
    pub integrator: Integrator,
    /// How many digits are computed with.
    pub precision: Precision,
}

impl Way {
    /// Every integrator that the simulator offers, of both methods, and the default in single precision.
    pub fn all() -> Vec<Self> {
        let way = |method| {
            move |integrator: &Integrator| Self {
                method,
                integrator: *integrator,
                precision: Precision::Double,
            }
        };
        let of = |method| Integrator::of(method).iter().map(way(method));
        let mut ways: Vec<Self> = of(Method::Physical).chain(of(Method::Paper)).collect();
        ways.insert(1, Self { precision: Precision::Single, ..ways[0] });
        ways
    }

    /// The default of a method.
    pub fn default_of(method: Method) -> Self {
        Self { method, integrator: Integrator::of(method)[0], precision: Precision::Double }
    }

    /// Its name: that of the integrator; for the method `paper` with the method's.
    pub fn name(self) -> String {
        let method = if self.method == Method::Paper { "paper, " } else { "" };
        let precision = if self.precision == Precision::Single { ", single" } else { "" };
        format!("{method}{}{precision}", self.integrator.name())
    }

    /// Options with this way and no other choice made.
    pub fn options(self) -> SimOptions {
        SimOptions {
            integrator: Some(self.integrator),
            precision: self.precision,
            ..SimOptions::of(self.method)
        }
    }

    /// The longest step that it stands, s; `None` if it stands any.
    ///
    /// # Errors
    /// What the simulator refuses besides.
    pub fn limit_secs(
        self,
        field: &FieldSequence,
        scene: &Scene,
        groom: &Groom,
    ) -> Result<Option<f64>, SimError> {
        if !self.integrator.is_limited() {
            return Ok(None);
        }
        // So long a step that it is refused if any is, before anything moves.
        const LONG_SECS: f64 = 1.0;
        let options = SimOptions {
            rate_hz: 1.0 / LONG_SECS,
            dt_secs: Some(LONG_SECS),
            duration_secs: Some(LONG_SECS),
            ..self.options()
        };
        match simulate(field, scene, groom, &options, &NoProgress) {
            Err(SimError::Unstable { limit_secs, .. }) => Ok(Some(limit_secs)),
            Err(other) => Err(other),
            Ok(_) => Ok(None),
        }
    }
}

/// What was simulated; `None` if the step is too short for the digits that are computed with.
///
/// The simulator says so before anything moves, of all hair alike, and no longer step is concerned: for who tries many steps
/// such a one is left out, and is no failure.
///
/// # Errors
/// Whatever else was refused or went wrong.
pub(crate) fn unless_too_short<T>(simulated: Result<T, SimError>) -> Result<Option<T>, SimError> {
    match simulated {
        Err(SimError::TooShort { .. }) => Ok(None),
        other => other.map(Some),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds::{gusts, mannequin, wig};

    /// Steps of 1/960 s: double precision stands them, single is left out, and what no way stands stays an error.
    #[test]
    fn only_steps_too_short_for_the_digits_are_left_out() {
        let (field, scene, groom) = (gusts(), mannequin(), wig(1, 3));
        let double = Way::default_of(Method::Physical);
        let run = |way: Way, dt_secs| {
            let options = SimOptions { dt_secs: Some(dt_secs), duration_secs: Some(0.1), ..way.options() };
            unless_too_short(simulate(&field, &scene, &groom, &options, &NoProgress))
        };
        let single = Way { precision: Precision::Single, ..double };
        assert!(run(double, 1.0 / 960.0).unwrap().is_some());
        assert!(run(single, 1.0 / 960.0).unwrap().is_none());
        assert!(run(single, 1.0 / 480.0).unwrap().is_some());
        assert!(run(single, f64::NAN).is_err());
    }
}

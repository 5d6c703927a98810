use crate::Vec3;
use serde::{Deserialize, Serialize};

/// What a field or a sample tells of the wind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Velocity of the air over the ground, head axes, m/s. A lock feels it less its own velocity.
    AirVelocity,
    /// Force per mass on the lock, head axes, m/s²: what the 2008 method measures, whatever hangs there.
    ForcePerMass,
}

impl Quantity {
    /// The name used in files: `air_velocity` or `force_per_mass`.
    pub fn name(self) -> &'static str {
        match self {
            Self::AirVelocity => "air_velocity",
            Self::ForcePerMass => "force_per_mass",
        }
    }

    /// The unit, for people.
    pub fn unit(self) -> &'static str {
        match self {
            Self::AirVelocity => "m/s",
            Self::ForcePerMass => "m/s²",
        }
    }

    /// The quantity of a name that [`Quantity::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::AirVelocity, Self::ForcePerMass].into_iter().find(|q| q.name() == name)
    }
}

/// The wind as the markers tell it: scattered vectors at each time step, head space.
#[derive(Clone, Debug, PartialEq)]
pub struct WindSamples {
    /// What the vectors are.
    pub quantity: Quantity,
    /// Time steps a second.
    pub rate_hz: f64,
    /// The samples of each time step; step `k` is at `k / rate_hz` seconds after the capture's first frame.
    pub steps: Vec<Vec<WindSample>>,
}

/// One vector of wind, where one marker was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindSample {
    /// Index of the lock in the session.
    pub strand_idx: u32,
    /// Index of the marker on the lock, from the root.
    pub marker_idx: u32,
    /// Where the marker was, head space, m.
    pub position_m: Vec3,
    /// The vector, head axes, in the quantity's unit.
    pub value: Vec3,
    /// Covariance of `value`: xx, yy, zz, xy, xz, yz, in the quantity's unit squared; infinite where unknown.
    pub covariance: [f64; 6],
}

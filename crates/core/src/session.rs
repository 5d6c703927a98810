use crate::{Assumption, Body, LengthUnit, UpAxis, Vec3};

/// What the people in the room knew: the head model, the fans, the measured locks. SI, head space unless said.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// The session's name.
    pub name: String,
    /// The subject's prefix in marker labels, if the session names one.
    pub subject: Option<String>,
    /// Frames a second, if the session says so; checked against the capture's.
    pub rate_hz: Option<f64>,
    /// The unit of the capture's positions, used where the file names none.
    pub unit: Option<LengthUnit>,
    /// The world's up axis.
    pub up_axis: Option<UpAxis>,
    /// First and last frame (as the file numbers them, both included) in which nothing moves.
    pub still_frames: Option<(i64, i64)>,
    /// The frame in which the wind starts, roughly.
    pub wind_start_frame: Option<i64>,
    /// The markers that give the head's pose.
    pub head_markers: Vec<HeadMarker>,
    /// What the hair can touch.
    pub body: Body,
    /// Where the wind came from.
    pub fans: Vec<Fan>,
    /// Density of the air, kg/m³.
    pub air_density: f64,
    /// The measured locks.
    pub strands: Vec<StrandSpec>,
    /// Every value above that the file did not give and a default stands for.
    pub assumed: Vec<Assumption>,
}

impl Session {
    /// The still frames as indices from 0, both included, clipped to a capture; `None` if none is left.
    pub fn still_range(&self, first_frame: i64, n_frames: usize) -> Option<(usize, usize)> {
        let (first, last) = self.still_frames?;
        let first = usize::try_from(first.checked_sub(first_frame)?.max(0)).ok()?;
        let last = usize::try_from(last.checked_sub(first_frame)?).ok()?.min(n_frames.checked_sub(1)?);
        (first <= last).then_some((first, last))
    }
}

/// A marker on the head and its place in head space.
#[derive(Clone, Debug, PartialEq)]
pub struct HeadMarker {
    /// The marker's label without prefix.
    pub label: String,
    /// Its place, head space, m.
    pub position_m: Vec3,
}

/// A fan as it was set.
#[derive(Clone, Debug, PartialEq)]
pub struct Fan {
    /// Where the wind comes from: 0 is the front, positive towards the subject's left, rad.
    pub from_azimuth_rad: f64,
    /// Where it ends up if the fan is carried round, rad.
    pub to_azimuth_rad: Option<f64>,
    /// Where it comes from, above the horizon, rad.
    pub from_elevation_rad: f64,
    /// Speed, m/s.
    pub speed_mps: f64,
    /// The direction the air moves in, world space, unit length, if it was noted.
    pub blows_towards_world: Option<Vec3>,
    /// What the fan did, in words.
    pub program: String,
}

impl Fan {
    /// The direction the air moves in by azimuth and elevation, head axes of the still pose, unit length.
    pub fn blows_towards_head(&self) -> Vec3 {
        let (sin_az, cos_az) = libm::sincos(self.from_azimuth_rad);
        let (sin_el, cos_el) = libm::sincos(self.from_elevation_rad);
        -Vec3::new(cos_el * cos_az, cos_el * sin_az, sin_el)
    }
}

/// A measured lock of the wig.
#[derive(Clone, Debug, PartialEq)]
pub struct StrandSpec {
    /// The lock's name, `S01`.
    pub name: String,
    /// Length from root to tip, m.
    pub length_m: f64,
    /// Mass per length, kg/m.
    pub linear_density_kg_per_m: f64,
    /// How wide the lock is across the wind, m.
    pub lock_width_m: f64,
    /// Where it grows from the scalp, head space, m.
    pub root_m: Vec3,
    /// Its markers, root to tip.
    pub markers: Vec<StrandMarker>,
}

/// A marker on a lock.
#[derive(Clone, Debug, PartialEq)]
pub struct StrandMarker {
    /// The marker's label without prefix.
    pub label: String,
    /// Distance from the root along the lock, m, if it was measured.
    pub distance_from_root_m: Option<f64>,
    /// Mass, kg.
    pub mass_kg: f64,
}

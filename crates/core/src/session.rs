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
    /// A session that says nothing yet: nobody knows of markers, locks, a body or fans, in air of 1.2 kg/m³.
    pub fn unknown(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            subject: None,
            rate_hz: None,
            unit: None,
            up_axis: None,
            still_frames: None,
            wind_start_frame: None,
            head_markers: Vec::new(),
            body: Body::none(),
            fans: Vec::new(),
            air_density: 1.2,
            strands: Vec::new(),
            assumed: Vec::new(),
        }
    }

    /// The still frames as indices from 0, both included, clipped to a capture; `None` if none is left.
    pub fn still_range(&self, first_frame: i64, n_frames: usize) -> Option<(usize, usize)> {
        let (first, last) = self.still_frames?;
        let first = usize::try_from(first.saturating_sub(first_frame).max(0)).ok()?;
        let last = usize::try_from(last.saturating_sub(first_frame)).ok()?.min(n_frames.checked_sub(1)?);
        (first <= last).then_some((first, last))
    }

    /// When the wind starts, roughly, s after a capture's first frame; below 0 where it blew before. `None` if nobody says.
    pub fn wind_start_secs(&self, first_frame: i64, rate_hz: f64) -> Option<f64> {
        // As doubles: a session can name any frame, and the difference of two need not be a whole number that there is.
        self.wind_start_frame.map(|frame| (frame as f64 - first_frame as f64) / rate_hz)
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

impl StrandSpec {
    /// How far down the lock a marker sits, m from the root: as measured, or as if all were spread evenly, the last one at the tip.
    ///
    /// # Panics
    /// If the lock has no such marker.
    pub fn marker_distance_m(&self, marker_idx: usize) -> f64 {
        let evenly = (marker_idx + 1) as f64 / self.markers.len() as f64 * self.length_m;
        self.markers[marker_idx].distance_from_root_m.unwrap_or(evenly)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn session(still_frames: Option<(i64, i64)>, wind_start_frame: Option<i64>) -> Session {
        Session { still_frames, wind_start_frame, ..Session::unknown("") }
    }

    /// Frames count from 5000; a session may name any.
    #[test]
    fn still_frames_are_clipped_to_the_capture() {
        for (named, expected) in [
            ((5000, 5099), Some((0, 99))),
            ((0, 5099), Some((0, 99))),
            ((i64::MIN, 5009), Some((0, 9))),
            ((5900, i64::MAX), Some((900, 999))),
            ((0, 4999), None),
            ((6000, 6100), None),
            ((i64::MIN, i64::MIN), None),
        ] {
            assert_eq!(session(Some(named), None).still_range(5000, 1000), expected, "{named:?}");
        }
    }

    #[test]
    fn markers_that_nobody_measured_are_spread_evenly() {
        let marker =
            |distance_from_root_m| StrandMarker { label: String::new(), distance_from_root_m, mass_kg: 0.0 };
        let lock = StrandSpec {
            name: String::new(),
            length_m: 0.5,
            linear_density_kg_per_m: 1.5e-3,
            lock_width_m: 0.02,
            root_m: Vec3::zeros(),
            markers: [None, Some(0.07), None, None].map(marker).to_vec(),
        };
        assert_eq!([0, 1, 2, 3].map(|k| lock.marker_distance_m(k)), [0.125, 0.07, 0.375, 0.5]);
    }

    #[test]
    fn the_wind_may_start_in_any_frame() {
        let start = |frame, first_frame| session(None, frame).wind_start_secs(first_frame, 100.0);
        assert_eq!(start(Some(5120), 5000), Some(1.2));
        assert_eq!(start(Some(4900), 5000), Some(-1.0));
        assert_eq!(start(None, 5000), None);
        assert!(start(Some(i64::MIN), 1).unwrap() < -9e16 && start(Some(i64::MAX), -1).unwrap() > 9e16);
    }
}

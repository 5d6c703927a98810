use tousle_core::{HeadCapture, Pose, Session, Vec3};

/// The direction the outside wind moves in at a time, head axes, unit length; zero without a fan.
///
/// Fans stand in the room, so a head that turns sees them turn the other way. Several fans are added up by
/// their speeds. A fan that was carried round moves evenly from its first azimuth to its last between the start
/// of the wind and the end of the capture, as the session says no more.
///
/// Source: the paper's 3.3, "the force points from the wind's source to the head".
pub fn outside_direction(
    session: &Session,
    head: &HeadCapture,
    rest_pose: &Pose,
    pose: &Pose,
    time_secs: f64,
) -> Vec3 {
    let winds = fan_winds(session, head, rest_pose, pose, time_secs);
    winds.into_iter().sum::<Vec3>().try_normalize(1e-9).unwrap_or_default()
}

/// The wind that each fan is set to make at a time, head axes, m/s.
pub(crate) fn fan_winds(
    session: &Session,
    head: &HeadCapture,
    rest_pose: &Pose,
    pose: &Pose,
    time_secs: f64,
) -> Vec<Vec3> {
    let turn = pose.rotation.inverse() * rest_pose.rotation;
    let start_secs = session.wind_start_secs(head.first_frame, head.rate_hz).unwrap_or(0.0);
    let share = ((time_secs - start_secs) / (head.duration_secs() - start_secs)).clamp(0.0, 1.0);
    let wind = |fan: &tousle_core::Fan| {
        let at_rest = match (fan.to_azimuth_rad, fan.blows_towards_world) {
            (Some(to), _) => {
                let from_azimuth_rad = fan.from_azimuth_rad + (to - fan.from_azimuth_rad) * share;
                tousle_core::Fan { from_azimuth_rad, ..fan.clone() }.blows_towards_head()
            }
            (None, Some(towards_world)) => rest_pose.rotation.inverse() * towards_world,
            (None, None) => fan.blows_towards_head(),
        };
        turn * at_rest * fan.speed_mps
    };
    session.fans.iter().map(wind).collect()
}

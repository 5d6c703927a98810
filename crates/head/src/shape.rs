use crate::registration::{Pair, least_squares, register};
use tousle_core::{Session, Track, Vec3, median};

/// The head's markers as they really sit, head space, m.
#[derive(Clone, Debug)]
pub(crate) struct HeadShape {
    pub places_m: Vec<Vec3>,
    /// How far each place is from the session's, m.
    pub correction_m: Vec<f64>,
    /// White noise of a marker coordinate, m, as the still interval shows it; `None` without one.
    pub noise_m: Option<f64>,
}

/// Hands measure a marker's place on the head to 1 or 2 mm; cameras see it still for a second to 0.01 mm.
///
/// The shape is therefore taken from the still frames and only *placed* by the session: the means of the still
/// frames, carried into head space by the best fit to the session's places. Without this, the pose jumps by up
/// to a millimeter whenever a marker comes or goes. A marker not seen in the still frames keeps its session
/// place; so does one that stands still on another one's place: its label was exchanged.
pub(crate) fn head_shape(
    tracks: &[Track],
    session: &Session,
    still: Option<(usize, usize)>,
    tolerance_m: f64,
) -> HeadShape {
    let session_places: Vec<Vec3> = session.head_markers.iter().map(|m| m.position_m).collect();
    let unchanged = |noise_m| HeadShape {
        places_m: session_places.clone(),
        correction_m: vec![0.0; session_places.len()],
        noise_m,
    };
    let Some((first, last)) = still else { return unchanged(None) };
    let means: Vec<Option<Vec3>> = tracks.iter().map(|t| still_mean(t, first, last)).collect();
    let noise_m = still_noise(tracks, &means, first, last);
    let pairs: Vec<Pair> = (0..tracks.len())
        .filter_map(|k| Some(Pair { marker: k, place_m: session_places[k], seen_m: means[k]? }))
        .collect();
    // Least squares over all markers that agree: the hand's errors average out over them.
    let Some(fit) = register(&pairs, &vec![1.0; tracks.len()], tolerance_m) else {
        return unchanged(noise_m);
    };
    let used: Vec<Pair> = fit.used.iter().map(|&k| pairs[k]).collect();
    let Some(world_from_head) = least_squares(&used) else { return unchanged(noise_m) };
    let mut shape = unchanged(noise_m);
    for (k, mean) in means.iter().enumerate() {
        if let Some(mean) = mean {
            let place =
                world_from_head.inverse_transform_vector(&(mean - world_from_head.translation.vector));
            let nearest = session_places
                .iter()
                .enumerate()
                .min_by(|a, b| (a.1 - place).norm().total_cmp(&(b.1 - place).norm()));
            if nearest.is_some_and(|(n, at)| n != k && (at - place).norm() < tolerance_m) {
                continue;
            }
            shape.correction_m[k] = (place - session_places[k]).norm();
            shape.places_m[k] = place;
        }
    }
    shape
}

/// Where a marker is in the still frames, robust to a swapped label; `None` if it is seen in fewer than 5, or at no one place.
fn still_mean(track: &Track, first: usize, last: usize) -> Option<Vec3> {
    let seen: Vec<Vec3> = (first..=last).filter_map(|f| track.at(f)).collect();
    if seen.len() < 5 {
        return None;
    }
    let along = |axis: usize| median(seen.iter().map(|p| p[axis]).collect());
    let middle = Vec3::new(along(0)?, along(1)?, along(2)?);
    // The mean of what lies within 5 mm of the median: as robust, and 1.25 times less noisy.
    let near: Vec<Vec3> = seen.into_iter().filter(|p| (p - middle).norm() < 5e-3).collect();
    // None is where a label goes from marker to marker: the median, axis by axis, then lies between the places.
    (!near.is_empty()).then(|| near.iter().sum::<Vec3>() / near.len() as f64)
}

/// White noise of one coordinate, m: from the median absolute deviation over all still samples.
fn still_noise(tracks: &[Track], means: &[Option<Vec3>], first: usize, last: usize) -> Option<f64> {
    let mut deviations = Vec::new();
    for (track, mean) in tracks.iter().zip(means) {
        let Some(mean) = mean else { continue };
        for p in (first..=last).filter_map(|f| track.at(f)) {
            deviations.extend((p - mean).iter().map(|c| c.abs()));
        }
    }
    Some(1.4826 * median(deviations)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A label that changes among three places in turn has its median, axis by axis, at none of them.
    #[test]
    fn a_marker_at_no_one_place_has_no_mean() {
        let places = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)];
        let turns = |n: usize| -> Track { (0..12).map(|f| Some(places[f % n])).collect() };
        assert_eq!(still_mean(&turns(1), 0, 11), Some(places[0]));
        assert_eq!(still_mean(&turns(3), 0, 11), None);
    }
}

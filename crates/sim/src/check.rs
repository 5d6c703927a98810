//! What a scene must hold before it can be simulated.

use crate::{Integrator, SimError, SimOptions};
use tousle_core::{PoseTrack, Shape};
use tousle_field::Scene;

/// The smallest tolerance of [`Integrator::Adaptive`], m. Down to it, ten times less takes twice the steps, as it should by the
/// method's order. Below it what iterations leave over is most of what a step is off, which no shorter step mends: ten
/// times less takes ten times the steps, down to the shortest. What is written, in single precision, is off by a third of it anyway.
const LEAST_TOLERANCE_M: f64 = 1e-7;

/// The farthest that a head may be from its world's origin along an axis, m: beyond, digits end before a hair's width does.
const FARTHEST_M: f64 = 1e9;

/// Refuses an integrator that the method does not have, and a tolerance that is none or that no step can meet.
pub(crate) fn check_options(options: &SimOptions) -> Result<(), SimError> {
    let (found, has) = (options.integrator(), Integrator::of(options.method));
    if !has.contains(&found) {
        let expected = has.iter().map(|i| i.name()).collect::<Vec<_>>().join(", ");
        return Err(SimError::OtherMethod { method: options.method.name(), found: found.name(), expected });
    }
    // A millimeter that became meters may have lost a bit.
    if !(options.tolerance_m.is_finite() && options.tolerance_m >= LEAST_TOLERANCE_M * (1.0 - 1e-9)) {
        let (option, found) = ("tolerance_m", options.tolerance_m);
        let expected = "1e-7 m (1e-4 mm) or more: below that steps get shorter and no more exact";
        return Err(SimError::BadOption { option, found, expected });
    }
    Ok(())
}

/// Refuses a scene, or a shot's head motion, that holds something that cannot be.
pub(crate) fn check_scene(scene: &Scene, options: &SimOptions) -> Result<(), SimError> {
    check_poses("poses", &scene.poses)?;
    if let Some(head) = &options.head {
        check_poses("the shot's poses", head)?;
    }
    let rest = &scene.rest_pose;
    let numbers = rest.translation.vector.iter().chain(rest.rotation.coords.iter());
    check("rest_pose", numbers.copied(), f64::is_finite, "finite numbers")?;
    check("gravity_world", scene.gravity_world.iter().copied(), f64::is_finite, "finite numbers")?;
    check("air_density", [scene.air_density], is_not_negative, "0 or a number above")?;
    check("body.friction", [scene.body.friction], is_not_negative, "0 or a number above")?;
    check("body.pivot_m", scene.body.pivot_m.iter().copied(), f64::is_finite, "finite numbers")?;
    scene.body.colliders.iter().try_for_each(|collider| check_shape(&collider.shape))
}

fn check_poses(what: &'static str, track: &PoseTrack) -> Result<(), SimError> {
    check(what, [track.poses.len() as f64], |n| n >= 1.0, "at least one")?;
    check(what, [track.rate_hz], |rate| rate.is_finite() && rate > 0.0, "a rate above 0")?;
    check(what, [track.start_secs], f64::is_finite, "a finite start")?;
    let places = track.poses.iter().flat_map(|p| p.translation.vector.iter());
    check(what, places.copied(), |m| m.abs() <= FARTHEST_M, "places within 1e9 m of the origin")?;
    let turns = track.poses.iter().flat_map(|p| p.rotation.coords.iter());
    check(what, turns.copied(), f64::is_finite, "finite numbers")
}

fn check_shape(shape: &Shape) -> Result<(), SimError> {
    let is_size = |size: f64| size.is_finite() && size > 0.0;
    match shape {
        Shape::Ellipsoid { center_m, half_axes_m } => {
            check("collider.center_m", center_m.iter().copied(), f64::is_finite, "finite numbers")?;
            check("collider.half_axes_m", half_axes_m.iter().copied(), is_size, "numbers above 0")
        }
        Shape::Capsule { a_m, b_m, radius_m } => {
            check(
                "collider.a_m, b_m",
                a_m.iter().chain(b_m.iter()).copied(),
                f64::is_finite,
                "finite numbers",
            )?;
            check("collider.radius_m", [*radius_m], is_size, "a number above 0")
        }
        Shape::Mesh(solid) => {
            let numbers = solid.points_m.iter().flat_map(|p| p.iter().copied());
            check("collider.points_m", numbers, f64::is_finite, "finite numbers")
        }
    }
}

fn is_not_negative(number: f64) -> bool {
    number.is_finite() && number >= 0.0
}

fn check(
    what: &'static str,
    numbers: impl IntoIterator<Item = f64>,
    is_good: impl Fn(f64) -> bool,
    expected: &'static str,
) -> Result<(), SimError> {
    match numbers.into_iter().find(|number| !is_good(*number)) {
        Some(found) => Err(SimError::BadScene { what, found, expected }),
        None => Ok(()),
    }
}

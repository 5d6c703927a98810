use tousle_core::Vec3;

/// The force of moving air on a thin, round, straight piece of hair.
///
/// Per length, with `w` the velocity of the air relative to the piece, `wn` and `wt` its parts across and along,
/// and `d` the width:
///
/// ```text
/// f = ½ ρ d (Cn |wn| wn + π Ct |wt| wt)
/// Cn = 1 + 10 Re^(−2/3),  Re = |wn| d / ν
/// ```
///
/// Source: `Cn` is the usual fit to the drag of a smooth cylinder across a stream (White, "Viscous Fluid Flow",
/// cylinder in cross-flow), good to some 20 % from Re = 1 to 1e5; the split into independent parts across and
/// along is Taylor's (1952, "Analysis of the swimming of long and narrow animals"). What it leaves out: lift,
/// shedding, air that passes through a loose lock, and the shelter one lock gives another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DragLaw {
    /// Density of the air, kg/m³.
    pub air_density: f64,
    /// Kinematic viscosity of the air, m²/s.
    pub viscosity: f64,
    /// Coefficient along the piece, on its whole skin.
    pub along: f64,
}

/// The force per length of a [`DragLaw`] and how it changes with the wind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// Force per length, N/m.
    pub force: Vec3,
    /// Force across, over speed across, N·s/m²: the resistance to a slow motion across wind and piece.
    pub across: f64,
    /// Twice the force along, over speed along, N·s/m²: the resistance to a slow motion along the piece.
    pub along: f64,
    /// The direction of the wind across the piece, unit length, or zero in still air.
    pub direction: Vec3,
    /// By how much more a change of the wind along `direction` counts than one across it, over `across`: 1 where drag grows as the
    /// square of the speed, a third in a creeping wind.
    pub steeper: f64,
}

impl DragLaw {
    /// Kinematic viscosity of air at 20 °C, m²/s.
    pub const AIR_VISCOSITY: f64 = 1.5e-5;
    /// Skin friction along a thin cylinder, of the order measured at the Reynolds numbers of hair in a breeze.
    pub const ALONG: f64 = 0.08;

    /// The law in air of a density, kg/m³.
    pub fn in_air(air_density: f64) -> Self {
        Self { air_density, viscosity: Self::AIR_VISCOSITY, along: Self::ALONG }
    }

    /// The force on a piece `width_m` wide that points along `tangent` (unit length), in the relative wind.
    pub fn at(&self, width_m: f64, tangent: Vec3, relative_wind: Vec3) -> Drag {
        let speed_along = relative_wind.dot(&tangent);
        let wind_across = relative_wind - tangent * speed_along;
        let speed_across = wind_across.norm();
        let across = self.across(width_m, speed_across);
        let half_along =
            0.5 * self.air_density * width_m * core::f64::consts::PI * self.along * speed_along.abs();
        let direction = if speed_across > 0.0 { wind_across / speed_across } else { Vec3::zeros() };
        let force = wind_across * across + tangent * (half_along * speed_along);
        let inertial = 0.5 * self.air_density * width_m * speed_across;
        // d ln(u + b u^⅓) / d ln u.
        let steeper = if across > 0.0 { (inertial + (across - inertial) / 3.0) / across } else { 1.0 / 3.0 };
        Drag { force, across, along: 2.0 * half_along, direction, steeper }
    }

    /// Force per length across a piece over the speed across it, N·s/m².
    ///
    /// As ½ρd(u + 10 (ν/d)^⅔ u^⅓), which has no pole at rest.
    pub fn across(&self, width_m: f64, speed: f64) -> f64 {
        let viscous = 10.0 * cube_root((self.viscosity / width_m) * (self.viscosity / width_m) * speed);
        0.5 * self.air_density * width_m * (speed + viscous)
    }

    /// The speed across a piece at which air (of a density above 0) pushes it with a force per length, N/m: the inverse of
    /// the law.
    ///
    /// Newton's method on a function that is smooth, rising and convex above 0; from above it cannot fail.
    pub fn speed_across(&self, width_m: f64, force: f64) -> f64 {
        if force <= 0.0 {
            return 0.0;
        }
        let mut speed = libm::sqrt(2.0 * force / (self.air_density * width_m));
        for _ in 0..20 {
            let across = self.across(width_m, speed);
            let inertial = 0.5 * self.air_density * width_m * speed;
            // d(f)/du of u² + b u^(4/3): 2 u + 4/3 b u^(1/3).
            let slope = 2.0 * inertial + 4.0 / 3.0 * (across - inertial);
            let step = (across * speed - force) / slope;
            speed -= step;
            if step.abs() <= 1e-12 * speed {
                break;
            }
        }
        speed
    }
}

impl Drag {
    /// How the force per length changes with a small change of the relative wind: the law's Jacobian times it.
    ///
    /// Across, the force grows as the square of the speed and less so where `Cn` rises towards low speeds: a change along the wind counts
    /// up to twice as much as one across it.
    pub fn change(&self, tangent: Vec3, wind_change: Vec3) -> Vec3 {
        let along = wind_change.dot(&tangent);
        let across = wind_change - tangent * along;
        let windward = across.dot(&self.direction);
        (across + self.direction * (windward * self.steeper)) * self.across + tangent * (self.along * along)
    }
}

/// The cube root of a number that is not negative, to about 1e-13 of it; several times quicker than to the last
/// digit, and the same on every machine.
///
/// A third of the exponent's bits is a guess within 4 %; Halley's iteration cubes that error, to 5e-5, to 1e-13.
fn cube_root(x: f64) -> f64 {
    if x <= f64::MIN_POSITIVE {
        return 0.0;
    }
    let mut root = f64::from_bits(x.to_bits() / 3 + 0x2a9f_7893_0000_0000);
    for _ in 0..2 {
        let cube = root * root * root;
        root *= (cube + 2.0 * x) / (2.0 * cube + x);
    }
    root
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: DragLaw = DragLaw { air_density: 1.2, viscosity: 1.5e-5, along: 0.08 };

    /// 3 m/s across 4 mm: Re = 800, Cn = 1 + 10/86.18 = 1.116, f = ½·1.2·0.004·1.116·9 = 0.0241 N/m.
    #[test]
    fn across_by_hand() {
        let drag = LAW.at(0.004, Vec3::z(), Vec3::new(3.0, 0.0, 0.0));
        assert!((drag.force - Vec3::new(0.024_106, 0.0, 0.0)).norm() < 1e-6, "{}", drag.force);
    }

    /// 3 m/s along 4 mm: f = ½·1.2·0.004·π·0.08·9 = 5.43e-3 N/m.
    #[test]
    fn along_by_hand() {
        let drag = LAW.at(0.004, Vec3::z(), Vec3::new(0.0, 0.0, -3.0));
        assert!((drag.force - Vec3::new(0.0, 0.0, -5.4287e-3)).norm() < 1e-6, "{}", drag.force);
    }

    #[test]
    fn cube_roots_are_cube_roots() {
        for x in [1e-300, 1e-20, 0.3, 1.0, 27.0, 1e20, 1e300] {
            assert!((cube_root(x) / libm::cbrt(x) - 1.0).abs() < 1e-12, "{x}");
        }
        assert_eq!(cube_root(0.0), 0.0);
    }

    #[test]
    fn the_speed_of_a_force_is_the_laws_inverse() {
        for speed in [1e-4, 0.03, 1.0, 30.0, 300.0] {
            let force = LAW.across(0.003, speed) * speed;
            let found = LAW.speed_across(0.003, force);
            assert!((found - speed).abs() < 1e-9 * speed, "{found} for {speed}");
        }
        assert_eq!(LAW.speed_across(0.003, 0.0), 0.0);
    }

    #[test]
    fn change_is_the_slope_of_the_law() {
        let tangent = Vec3::new(0.2, -0.5, 0.9).normalize();
        for speed in [0.1, 1.0, 5.0] {
            let wind = Vec3::new(4.0, 1.0, -2.0).normalize() * speed;
            let drag = LAW.at(0.005, tangent, wind);
            for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
                let [after, before] =
                    [1e-4, -1e-4].map(|step| LAW.at(0.005, tangent, wind + axis * step).force);
                let numeric = (after - before) / 2e-4;
                let analytic = drag.change(tangent, axis);
                assert!((numeric - analytic).norm() < 1e-6 * drag.across, "{numeric} {analytic}");
            }
        }
    }
}

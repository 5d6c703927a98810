use super::{AirOnStick, Batch, Paper, Stick, Work};
use crate::physical::STILL2;
use crate::timeline::StepScene;
use crate::wind::feel_at_middles;
use tousle_core::{HeadMotion, Quantity};
use tousle_field::Moment;
use tousle_lanes::{Lane, Symmetric, Vector, cos_and_sine};
use tousle_rod::DragLaw;

impl<L: Lane> Batch<L> {
    /// g and Ξ of E2: gravity turned into head axes, and the inertia of a head that speeds up or turns.
    #[inline(always)]
    pub(super) fn weigh(&mut self, work: &mut [Work<L>], scene: &StepScene<'_>) {
        let gravity = Vector::same(self.damping_secs, scene.gravity);
        for (stick, work) in self.sticks.iter().zip(&mut *work) {
            work.force = gravity * stick.mass;
        }
        if let Some(head) = &scene.head {
            self.move_head(work, head, scene.dt_secs);
        }
    }

    #[inline(always)]
    fn move_head(&mut self, work: &mut [Work<L>], head: &HeadMotion, dt_secs: f64) {
        let turning = Vector::same(self.damping_secs, head.angular_velocity);
        let speeding_up = Vector::same(self.damping_secs, head.angular_acceleration);
        let acceleration = Vector::same(self.damping_secs, head.acceleration);
        for ((stick, motion), work) in self.sticks.iter().zip(&mut self.motions).zip(work) {
            let felt = acceleration + speeding_up.cross(work.end) + turning.cross(turning.cross(work.end));
            work.force -= felt * stick.mass;
            // Coriolis' force on a stick turns its rate about the stick and changes nothing else of it. To turn
            // the rate by that angle is exact for a stick alone and keeps its energy for every step.
            let angle = turning.dot(motion.direction) * self.damping_secs.same(-2.0 * dt_secs);
            let (cos, sin) = cos_and_sine(angle);
            motion.rate = motion.rate.mul_add(cos, motion.direction.cross(motion.rate) * sin);
        }
    }

    /// Ω of E2, and what I2 stands for: the air's push on each stick, half of it at either end.
    #[inline(always)]
    pub(super) fn blow(&mut self, work: &mut [Work<L>], model: &Paper, scene: &StepScene<'_>) {
        self.feel_wind(work, scene.wind.as_ref());
        let half = self.damping_secs.same(0.5);
        let mut near_velocity = Vector::none(self.damping_secs);
        let mut near = self.root;
        for j in 0..work.len() {
            let (far, far_velocity) = (work[j].end, work[j].velocity);
            let velocity = (near_velocity + far_velocity) * half;
            let stick = &self.sticks[j];
            let direction = self.motions[j].direction;
            // Air velocity acts through the drag law, less the strand's own velocity. A force per mass acts as it is;
            // the resistance that the air then offers is that of the wind whose push across the stick it would be.
            let (wind, push) = match model.terms.quantity {
                Quantity::AirVelocity => {
                    let middle = (near + far) * half;
                    let head = scene.head.as_ref().map_or(Vector::none(self.damping_secs), |head| {
                        Vector::same(self.damping_secs, head.velocity)
                            + Vector::same(self.damping_secs, head.angular_velocity).cross(middle)
                    });
                    (work[j].wind - head, Vector::none(self.damping_secs))
                }
                Quantity::ForcePerMass => {
                    wind_that_pushes(model, stick, work[j].wind * stick.density, direction)
                }
            };
            let (force, air) = air_on_stick(stick, direction, wind, velocity);
            let half_force = push.mul_add(stick.hair_length, force) * half;
            work[j].force += half_force;
            if j > 0 {
                work[j - 1].force += half_force;
            }
            work[j].air = air;
            (near, near_velocity) = (far, far_velocity);
        }
    }

    /// Samples the field at the middle of every stick.
    #[inline(always)]
    fn feel_wind(&mut self, work: &mut [Work<L>], wind: Option<&Moment<'_>>) {
        let Some(wind) = wind else { return };
        if let Some(asked) = &mut self.asked {
            asked.take_in(self.root, work.iter().map(|work| work.end));
        }
        feel_at_middles(wind, self.root, work, |work| work.end, |_, work, found| work.wind = found);
    }
}

/// The air's push on a stick's hair, N, and how it resists ([`DragLaw::at`], [`tousle_rod::Drag::change`]).
#[inline(always)]
fn air_on_stick<L: Lane>(
    stick: &Stick<L>,
    direction: Vector<L>,
    wind: Vector<L>,
    velocity: Vector<L>,
) -> (Vector<L>, AirOnStick<L>) {
    let relative = wind - velocity;
    let speed_along = relative.dot(direction);
    let across = direction.mul_add(-speed_along, relative);
    let speed2 = across.norm_squared().max(stick.length.same(STILL2));
    let per_third = speed2.per_sixth_root();
    let per_two_thirds = per_third * per_third;
    let per_speed = per_two_thirds * per_third;
    let speed = speed2 * per_speed;
    let drag = stick.drag * stick.hair_length;
    let resists_across = drag * stick.viscous.mul_add(speed * per_two_thirds, speed);
    let skin =
        drag * stick.length.same(core::f64::consts::PI * DragLaw::ALONG) * speed_along.max(-speed_along);
    let force = across.mul_add(resists_across, direction * (skin * speed_along));
    let resists_along = skin + skin;
    let mut resistance = Symmetric::scaled_identity(resists_across);
    resistance.add_outer(direction, resists_along - resists_across);
    resistance.add_outer(across, resists_across * per_speed * per_speed);
    let air = AirOnStick {
        resisted: resistance.mul_vector(velocity),
        resistance,
        // Twice the resistance across is what a motion along the wind meets; along the stick it is less.
        most: (resists_across + resists_across).max(resists_along),
    };
    (force, air)
}

/// The wind across a stick whose push on it is the part across of this force per length, N/m; and the rest.
#[inline(always)]
fn wind_that_pushes<L: Lane>(
    model: &Paper,
    stick: &Stick<L>,
    push: Vector<L>,
    direction: Vector<L>,
) -> (Vector<L>, Vector<L>) {
    if !model.terms.air {
        return (Vector::none(stick.length), push);
    }
    let along = direction * direction.dot(push);
    let across = push - along;
    let strength = across.norm_squared().sqrt();
    let speed = speed_across(stick, strength);
    (across * (speed / strength.max(stick.length.same(1e-30))), along)
}

/// [`DragLaw::speed_across`] for many strands, each as if it were alone.
#[inline(always)]
fn speed_across<L: Lane>(stick: &Stick<L>, force: L) -> L {
    let tiny = force.same(1e-30);
    let drag = stick.drag.max(tiny);
    let mut speed = (force / drag).sqrt();
    // 1 for a strand whose speed is not found yet.
    let mut active = force.above(force.same(0.0), force.same(1.0), force.same(0.0));
    for _ in 0..20 {
        // Of u² + b u^(4/3), and its slope.
        let viscous = stick.viscous * speed.cbrt();
        let over = (speed + viscous) * speed - force / drag;
        let slope = (speed + speed) + viscous * force.same(4.0 / 3.0);
        let step = over / slope.max(tiny) * active;
        speed -= step;
        active = step.max(-step).above(speed * force.same(1e-12), active, force.same(0.0));
        if !active.any_above(force.same(0.0)) {
            break;
        }
    }
    speed
}

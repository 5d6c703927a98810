use super::lock::SeenLock;
use nalgebra::DVector;
use tousle_core::Vec3;
use tousle_flow::AirFlow;
use tousle_rod::shortest_rotation;

/// What simulating the captured wig taught, to measure anew with: `tousle-refine` makes it. By lock of the session, empty
/// where nothing was taught.
#[derive(Clone, Debug, PartialEq)]
pub struct Taught {
    /// What each lock is made of.
    pub scales: Vec<Scales>,
    /// How far the logarithm of all locks' stiffness may be off together: what that would do to the wind counts in how sure it is.
    pub stiffness_spread: f64,
    /// What the balance of moments leaves over of each.
    pub defects: Vec<Option<Defects>>,
    /// The air that was found before, at any rate: to start from, so that fewer rounds are needed.
    pub air: Option<AirFlow>,
}

/// How far the logarithm of a wig's stiffness may be from that of as many hairs as weigh so much: hairs differ in thickness, and
/// in how they hold together.
pub const LIKELY_STIFFNESS_SPREAD: f64 = 0.5;

/// Nothing: all hair is as stiff as is likely, and nobody knows it better.
impl Default for Taught {
    fn default() -> Self {
        Self { scales: Vec::new(), stiffness_spread: LIKELY_STIFFNESS_SPREAD, defects: Vec::new(), air: None }
    }
}

/// A lock's mechanics as factors on what is taken for likely: the stiffness of as many hairs as weigh so much, and the drag of
/// its measured width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Of the bending stiffness.
    pub stiffness: f64,
    /// Of the drag.
    pub drag: f64,
}

impl Default for Scales {
    fn default() -> Self {
        Self { stiffness: 1.0, drag: 1.0 }
    }
}

/// What the balance of moments leaves over of a lock that moves as the simulator says, in the wind that it moves in: what
/// smoothing, splines between markers and a lock that does not twist are off by. By time step.
#[derive(Clone, Debug, PartialEq)]
pub struct Defects(Vec<DefectAt>);

/// The same at a step.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DefectAt {
    /// The sticks, head axes.
    directions: Vec<Vec3>,
    /// The moment about each joint across its stick, N·m, head axes.
    moments: Vec<Vec3>,
}

impl Defects {
    pub(crate) fn new(steps: Vec<DefectAt>) -> Self {
        Self(steps)
    }

    pub(crate) fn at(&self, step: usize) -> Option<&DefectAt> {
        self.0.get(step)
    }

    /// Keeps of each step's a share, 0 to 1: so much as the simulated lock stands for the seen one.
    pub fn fade(&mut self, share: impl Fn(usize) -> f64) {
        for (step, at) in self.0.iter_mut().enumerate() {
            let share = share(step);
            at.moments.iter_mut().for_each(|moment| *moment *= share);
        }
    }
}

impl DefectAt {
    /// From two numbers a joint across its stick.
    pub(crate) fn new(seen: &SeenLock, step: usize, moments: &DVector<f64>) -> Self {
        let at = &seen.steps[step];
        let moment =
            |(j, [first, second]): (usize, &[Vec3; 2])| first * moments[2 * j] + second * moments[2 * j + 1];
        let moments = at.across.iter().enumerate().map(moment).collect();
        Self { directions: at.directions.clone(), moments }
    }

    /// About a joint whose stick points along `direction`, N·m: turned along with the stick.
    pub(crate) fn at(&self, joint: usize, direction: Vec3) -> Vec3 {
        match (self.directions.get(joint), self.moments.get(joint)) {
            (Some(own), Some(moment)) => shortest_rotation(*own, direction) * moment,
            _ => Vec3::zeros(),
        }
    }
}

//! Pulling a control point: from the pointer to a wanted edit.

use crate::camera::{Eye, Pixel};
use crate::solve::Wanted;
use tousle_core::Vec3;
use tousle_edit::{Action, ControlPoint, DEFAULT_EASE, DEFAULT_REACH_M, Drag, Edit, KeyTime, Target};

/// A drag that goes on.
///
/// The plane in which the target moves faces the camera as it was when the drag began, and stays: a target that went
/// deeper as the hair moves under the pointer could not be aimed.
#[derive(Clone, Debug)]
pub struct Dragging {
    /// What is asked for, with the target as it is now.
    pub wanted: Wanted,
    /// The strand.
    pub strand_idx: usize,
    /// The control point, from the root.
    pub point: usize,
    eye: Eye,
    /// Where the target was when the drag began, m.
    from_m: Vec3,
    /// Where the pointer was then, on the plane, m.
    grabbed_m: Vec3,
}

/// A control point and the keys between which it is pulled.
#[derive(Clone, Debug)]
pub struct Grip {
    /// The strand.
    pub strand_idx: usize,
    /// Its name.
    pub strand: String,
    /// The control point, from the root.
    pub point: usize,
    /// First and second key, s.
    pub keys_secs: [f64; 2],
    /// Where the target is as the drag begins, head space, m.
    pub target_m: Vec3,
}

impl Dragging {
    /// Begins a drag that makes a new edit.
    pub fn new(grip: &Grip, eye: Eye, at: Pixel) -> Self {
        let drag = Drag {
            strand: grip.strand.clone(),
            control_point: ControlPoint::Index(grip.point as u32),
            target: Target::At(grip.target_m),
            reach_m: DEFAULT_REACH_M,
            also: Vec::new(),
        };
        let [first, second] = grip.keys_secs.map(KeyTime::Secs);
        let edit = Edit {
            name: format!("Pull {}", grip.strand),
            first,
            second,
            ease: DEFAULT_EASE,
            muted: false,
            action: Action::Drag(drag),
        };
        Self::again(grip, Wanted { edit, replaces: None }, eye, at)
    }

    /// Begins a drag that changes an edit.
    pub fn again(grip: &Grip, wanted: Wanted, eye: Eye, at: Pixel) -> Self {
        let grabbed_m = eye.on_plane(at, grip.target_m);
        let Grip { strand_idx, point, target_m, .. } = *grip;
        Self { wanted, strand_idx, point, eye, from_m: target_m, grabbed_m }
    }

    /// The pointer is there now.
    pub fn move_to(&mut self, at: Pixel) {
        let target_m = self.from_m + self.eye.on_plane(at, self.from_m) - self.grabbed_m;
        let Action::Drag(drag) = &mut self.wanted.edit.action else { return };
        drag.target = Target::At(target_m);
    }

    /// Where the target is now, head space, m.
    pub fn target_m(&self) -> Vec3 {
        match &self.wanted.edit.action {
            Action::Drag(Drag { target: Target::At(target_m), .. }) => *target_m,
            _ => self.from_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use tousle_core::Pose;

    #[test]
    fn the_target_follows_the_pointer_in_a_plane_that_faces_the_camera() {
        let eye = Camera::default().eye(&Pose::identity(), Pixel::new(800.0, 600.0));
        let target_m = Vec3::new(0.1, 0.05, -0.1);
        let grip = Grip { strand_idx: 2, strand: "A".into(), point: 4, keys_secs: [0.2, 0.7], target_m };
        // Grabbed a little beside its middle.
        let start = eye.project(target_m).unwrap() + Pixel::new(3.0, -2.0);
        let mut drag = Dragging::new(&grip, eye, start);
        assert_eq!(drag.target_m(), target_m);
        drag.move_to(start + Pixel::new(40.0, -25.0));
        let moved = eye.project(drag.target_m()).unwrap() - eye.project(target_m).unwrap();
        assert!((moved - Pixel::new(40.0, -25.0)).norm() < 1e-6, "{moved}");
        assert!((eye.depth_m(drag.target_m()) - eye.depth_m(target_m)).abs() < 1e-12);
    }
}

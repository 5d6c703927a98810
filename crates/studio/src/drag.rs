//! Dragging what an edit is made of: from the pointer to a wanted edit.

use crate::camera::{Eye, Pixel};
use crate::gust::arrow_end_m;
use crate::solve::{Asked, Wanted};
use tousle_core::Vec3;
use tousle_edit::{
    Action, ControlPoint, DEFAULT_EASE, DEFAULT_REACH_M, Drag, Edit, KeyTime, Target, WindChange,
};

/// A drag that goes on.
///
/// The plane in which the target moves faces the camera as it was when the drag began, and stays: a target that went
/// deeper as the hair moves under the pointer could not be aimed.
#[derive(Clone, Debug)]
pub struct Dragging {
    /// What is asked for, with the target as it is now.
    pub wanted: Wanted,
    /// What is dragged.
    pub part: Part,
    eye: Eye,
    /// Where the target was when the drag began, m.
    from_m: Vec3,
    /// Where the pointer was then, on the plane, m.
    grabbed_m: Vec3,
}

/// What of an edit can be dragged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Part {
    /// A control point, or its target.
    Point {
        /// The strand.
        strand_idx: usize,
        /// The control point, from the root.
        point: usize,
    },
    /// The place at which the wind is changed.
    Center,
    /// The end of a gust's arrow.
    Arrow {
        /// Its length for each unit of the gust, m.
        arrow_m: f64,
    },
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

impl Grip {
    /// The pull as a new edit.
    pub fn wanted(&self) -> Wanted {
        let drag = Drag {
            strand: self.strand.clone(),
            control_point: ControlPoint::Index(self.point as u32),
            target: Target::At(self.target_m),
            reach_m: DEFAULT_REACH_M,
            also: Vec::new(),
        };
        let [first, second] = self.keys_secs.map(KeyTime::Secs);
        let edit = Edit {
            name: format!("Pull {}", self.strand),
            first,
            second,
            ease: DEFAULT_EASE,
            muted: false,
            action: Action::Drag(drag),
        };
        Wanted { asked: Asked::Pull(edit), replaces: None }
    }

    /// What is dragged.
    pub fn part(&self) -> Part {
        Part::Point { strand_idx: self.strand_idx, point: self.point }
    }
}

impl Dragging {
    /// Begins a drag of a part that is at a place, head space, m, by a pointer that is at a place on the picture.
    pub fn new(wanted: Wanted, part: Part, from_m: Vec3, eye: Eye, at: Pixel) -> Self {
        let grabbed_m = eye.on_plane(at, from_m);
        Self { wanted, part, eye, from_m, grabbed_m }
    }

    /// The pointer is there now.
    pub fn move_to(&mut self, at: Pixel) {
        let target_m = self.from_m + self.eye.on_plane(at, self.from_m) - self.grabbed_m;
        match (self.part, &mut self.wanted.asked) {
            (Part::Point { .. }, Asked::Pull(Edit { action: Action::Drag(drag), .. })) => {
                drag.target = Target::At(target_m);
            }
            (Part::Center, Asked::Wind(edit)) => edit.center_m = target_m,
            (Part::Arrow { arrow_m }, Asked::Wind(edit)) => {
                edit.change = WindChange::Gust { vector: (target_m - edit.center_m) / arrow_m };
            }
            _ => {}
        }
    }

    /// Where what is dragged is now, head space, m.
    pub fn target_m(&self) -> Vec3 {
        match (self.part, &self.wanted.asked) {
            (
                _,
                Asked::Pull(Edit { action: Action::Drag(Drag { target: Target::At(target_m), .. }), .. }),
            ) => *target_m,
            (Part::Center, Asked::Wind(edit)) => edit.center_m,
            (Part::Arrow { arrow_m }, Asked::Wind(edit)) => arrow_end_m(edit, arrow_m).unwrap_or(self.from_m),
            _ => self.from_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::gust::{Kind, Spot, arrow_m};
    use tousle_core::{Pose, Quantity};

    #[test]
    fn the_target_follows_the_pointer_in_a_plane_that_faces_the_camera() {
        let eye = Camera::default().eye(&Pose::identity(), Pixel::new(800.0, 600.0));
        let target_m = Vec3::new(0.1, 0.05, -0.1);
        let grip = Grip { strand_idx: 2, strand: "A".into(), point: 4, keys_secs: [0.2, 0.7], target_m };
        // Grabbed a little beside its middle.
        let start = eye.project(target_m).unwrap() + Pixel::new(3.0, -2.0);
        let mut drag = Dragging::new(grip.wanted(), grip.part(), target_m, eye, start);
        assert_eq!(drag.target_m(), target_m);
        drag.move_to(start + Pixel::new(40.0, -25.0));
        let moved = eye.project(drag.target_m()).unwrap() - eye.project(target_m).unwrap();
        assert!((moved - Pixel::new(40.0, -25.0)).norm() < 1e-6, "{moved}");
        assert!((eye.depth_m(drag.target_m()) - eye.depth_m(target_m)).abs() < 1e-12);
    }

    #[test]
    fn a_gust_is_moved_by_its_place_and_aimed_by_its_arrow() {
        let eye = Camera::default().eye(&Pose::identity(), Pixel::new(800.0, 600.0));
        let spot = Spot {
            center_m: Vec3::new(0.1, 0.05, -0.1),
            along: eye.axes[0],
            span_secs: [0.2, 0.7],
            quantity: Quantity::AirVelocity,
            strong: 4.0,
        };
        let wanted = Wanted { asked: Asked::Wind(Kind::Gust.at(&spot)), replaces: None };
        let gust = |drag: &Dragging| match &drag.wanted.asked {
            Asked::Wind(edit) => edit.clone(),
            Asked::Pull(_) => panic!("no gust"),
        };
        let start = eye.project(spot.center_m).unwrap();
        let mut drag = Dragging::new(wanted, Part::Center, spot.center_m, eye, start);
        drag.move_to(start + Pixel::new(30.0, 0.0));
        assert!((gust(&drag).center_m - spot.center_m).dot(&eye.axes[0]) > 0.01);

        let (before, arrow_m) = (gust(&drag), arrow_m(spot.strong));
        let end_m = arrow_end_m(&before, arrow_m).unwrap();
        let start = eye.project(end_m).unwrap();
        let mut drag = Dragging::new(drag.wanted, Part::Arrow { arrow_m }, end_m, eye, start);
        drag.move_to(start + Pixel::new(0.0, -25.0));
        let (after, moved_m) = (gust(&drag), drag.target_m() - end_m);
        assert!(moved_m.dot(&eye.axes[1]) > 0.005 && after.center_m == before.center_m);
        let (WindChange::Gust { vector: a }, WindChange::Gust { vector: b }) = (before.change, after.change)
        else {
            panic!("no gusts");
        };
        assert!(((b - a) * arrow_m - moved_m).norm() < 1e-12);
    }
}

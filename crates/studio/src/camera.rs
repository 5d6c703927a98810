//! The camera: orbit, pan, zoom, frame, and what it sees where.

use nalgebra::{Matrix4, Point3, Vector2, Vector4};
use tousle_core::{Pose, Vec3};

/// A place on the picture, points from its upper left corner.
pub type Pixel = Vector2<f64>;

/// A camera that looks at a point and goes round it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// What it looks at, m.
    pub target_m: Vec3,
    /// How far it is from there, m.
    pub distance_m: f64,
    /// Where it stands: 0 in front of the nose, growing towards the subject's left, rad.
    pub yaw: f64,
    /// How high it stands, from −π/2 to π/2, rad.
    pub pitch: f64,
}

/// A camera at work on a picture of a size: all in head space, wherever the head is shown.
#[derive(Clone, Copy, Debug)]
pub struct Eye {
    /// Head space to clip space: x right, y up, depth 0 near to 1 far.
    pub clip_from_head: Matrix4<f64>,
    /// Where the camera is, head space, m.
    pub position_m: Vec3,
    /// Its axes, head space: right, up, forward.
    pub axes: [Vec3; 3],
    /// The picture's width and height, points.
    pub size: Pixel,
}

/// Height of the view, rad: a lens of 60 mm, which flatters heads.
const VIEW_ANGLE: f64 = 0.4;
/// The nearest and farthest that is drawn, m.
const DEPTHS_M: [f64; 2] = [0.02, 20.0];
/// The camera never stands straight above, where right and left end.
const MAX_PITCH: f64 = 1.5;
const DISTANCES_M: [f64; 2] = [0.1, 10.0];

impl Default for Camera {
    fn default() -> Self {
        Self { target_m: Vec3::new(0.0, 0.0, -0.04), distance_m: 1.5, yaw: 0.65, pitch: 0.12 }
    }
}

impl Camera {
    /// Goes round the target by so many points of a drag.
    pub fn orbit(&mut self, drag: Pixel) {
        const PER_POINT: f64 = 0.008;
        self.yaw -= drag.x * PER_POINT;
        self.pitch = (self.pitch + drag.y * PER_POINT).clamp(-MAX_PITCH, MAX_PITCH);
    }

    /// Moves along the picture's plane, so that what is at the target follows the pointer.
    pub fn pan(&mut self, drag: Pixel, size: Pixel) {
        let [right, up, _] = self.axes();
        let per_point = 2.0 * self.distance_m * libm::tan(VIEW_ANGLE / 2.0) / size.y;
        self.target_m += (up * drag.y - right * drag.x) * per_point;
    }

    /// Comes nearer (above 0) or goes away, by points of the wheel.
    pub fn zoom(&mut self, scroll: f64) {
        self.distance_m =
            (self.distance_m * libm::exp(-0.0015 * scroll)).clamp(DISTANCES_M[0], DISTANCES_M[1]);
    }

    /// Looks at all of these points from the side it is on.
    pub fn frame(&mut self, points_m: impl IntoIterator<Item = Vec3>) {
        let mut points = points_m.into_iter();
        let Some(first) = points.next() else { return };
        let (low, high) = points.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
        self.target_m = (low + high) / 2.0;
        let radius = f64::max((high - low).norm() / 2.0, 0.02);
        self.distance_m = (1.1 * radius / libm::sin(VIEW_ANGLE / 2.0)).clamp(DISTANCES_M[0], DISTANCES_M[1]);
    }

    /// Right, up and forward, in the space it stands in.
    fn axes(&self) -> [Vec3; 3] {
        let ((sin_yaw, cos_yaw), (sin_pitch, cos_pitch)) = (libm::sincos(self.yaw), libm::sincos(self.pitch));
        let forward = -Vec3::new(cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch);
        let right = Vec3::new(-sin_yaw, cos_yaw, 0.0);
        [right, right.cross(&forward), forward]
    }

    /// The camera at work: where the head is shown (`shown_from_head`), on a picture of a size in points.
    pub fn eye(&self, shown_from_head: &Pose, size: Pixel) -> Eye {
        let axes = self.axes();
        let position = self.target_m - axes[2] * self.distance_m;
        let [right, up, forward] = axes;
        let view = Matrix4::from_rows(&[
            right.push(-right.dot(&position)).transpose(),
            up.push(-up.dot(&position)).transpose(),
            forward.push(-forward.dot(&position)).transpose(),
            Vector4::w().transpose(),
        ]);
        let scale = 1.0 / libm::tan(VIEW_ANGLE / 2.0);
        let [near, far] = DEPTHS_M;
        let lens = Matrix4::from_rows(&[
            Vector4::new(scale * size.y / size.x, 0.0, 0.0, 0.0).transpose(),
            Vector4::new(0.0, scale, 0.0, 0.0).transpose(),
            Vector4::new(0.0, 0.0, far / (far - near), -near * far / (far - near)).transpose(),
            Vector4::new(0.0, 0.0, 1.0, 0.0).transpose(),
        ]);
        let head_from_shown = shown_from_head.inverse();
        Eye {
            clip_from_head: lens * view * shown_from_head.to_homogeneous(),
            position_m: (head_from_shown * Point3::from(position)).coords,
            axes: axes.map(|axis| head_from_shown * axis),
            size,
        }
    }
}

impl Eye {
    /// Where a point of head space is on the picture; `None` behind the camera.
    pub fn project(&self, point_m: Vec3) -> Option<Pixel> {
        let clip = self.clip_from_head * point_m.push(1.0);
        let seen = clip.w > DEPTHS_M[0];
        seen.then(|| Pixel::new(1.0 + clip.x / clip.w, 1.0 - clip.y / clip.w).component_mul(&self.size) / 2.0)
    }

    /// How far in front of the camera a point is, m.
    pub fn depth_m(&self, point_m: Vec3) -> f64 {
        (point_m - self.position_m).dot(&self.axes[2])
    }

    /// The direction in which a place on the picture lies, head space, not of length 1.
    pub fn direction(&self, at: Pixel) -> Vec3 {
        let [right, up, forward] = self.axes;
        let half = libm::tan(VIEW_ANGLE / 2.0);
        let (x, y) = (2.0 * at.x / self.size.x - 1.0, 1.0 - 2.0 * at.y / self.size.y);
        forward + right * (x * half * self.size.x / self.size.y) + up * (y * half)
    }

    /// Where the line of sight through a place on the picture meets the plane through a point that faces the camera,
    /// head space, m.
    pub fn on_plane(&self, at: Pixel, through_m: Vec3) -> Vec3 {
        self.position_m + self.direction(at) * self.depth_m(through_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Pixel = Pixel::new(800.0, 600.0);

    #[test]
    fn what_it_looks_at_is_in_the_middle() {
        let camera = Camera::default();
        let eye = camera.eye(&Pose::identity(), SIZE);
        assert!((eye.project(camera.target_m).unwrap() - SIZE / 2.0).norm() < 1e-9);
        assert_eq!(eye.project(eye.position_m - eye.axes[2]), None);
        // From the front, the subject's left is on the right of the picture and up is up.
        let front = Camera { yaw: 0.0, pitch: 0.0, ..camera }.eye(&Pose::identity(), SIZE);
        let left = front.project(camera.target_m + Vec3::y() * 0.1).unwrap();
        let top = front.project(camera.target_m + Vec3::z() * 0.1).unwrap();
        assert!(left.x > 400.0 && top.y < 300.0);
    }

    #[test]
    fn a_place_on_the_picture_goes_there_and_back() {
        let turned = Pose::from_parts(
            Vec3::new(0.1, 0.2, 0.0).into(),
            nalgebra::UnitQuaternion::from_euler_angles(0.1, -0.2, 0.7),
        );
        let eye = Camera::default().eye(&turned, SIZE);
        let point = Vec3::new(0.08, -0.03, 0.05);
        let pixel = eye.project(point).unwrap();
        assert!((eye.on_plane(pixel, point) - point).norm() < 1e-9);
    }

    #[test]
    fn framing_brings_all_into_the_picture() {
        let mut camera = Camera::default();
        let corners = [Vec3::new(-0.3, -0.2, 0.1), Vec3::new(0.2, 0.1, 0.4), Vec3::new(0.0, 0.3, 0.0)];
        camera.frame(corners);
        let eye = camera.eye(&Pose::identity(), SIZE);
        for corner in corners {
            let at = eye.project(corner).unwrap();
            assert!(at.x > 0.0 && at.x < SIZE.x && at.y > 0.0 && at.y < SIZE.y, "{corner} at {at}");
        }
    }

    #[test]
    fn panning_follows_the_pointer() {
        let mut camera = Camera::default();
        let point = camera.target_m;
        camera.pan(Pixel::new(30.0, -20.0), SIZE);
        let at = camera.eye(&Pose::identity(), SIZE).project(point).unwrap();
        assert!((at - SIZE / 2.0 - Pixel::new(30.0, -20.0)).norm() < 0.5, "{at}");
    }
}

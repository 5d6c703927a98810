use tousle_core::{Groom, StrandMotion, Vec3};
use tousle_edit::{
    Action, ControlPoint, DEFAULT_EASE, DEFAULT_REACH_M, Drag, Edit, EditList, KeyTime, StrandPath, Target,
    out_of_reach,
};
use tousle_field::Scene;
use tousle_rod::Surface;

/// Numbers that look random and are the same for ever (`SplitMix64`; Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub(super) struct Dice(u64);

impl Dice {
    pub(super) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A number from 0 to 1, 1 not included.
    pub(super) fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, from: f64, to: f64) -> f64 {
        from + (to - from) * self.share()
    }

    /// A direction, all alike.
    fn direction(&mut self) -> Vec3 {
        let (z, turn) = (self.within(-1.0, 1.0), self.within(0.0, core::f64::consts::TAU));
        let (sin, cos) = libm::sincos(turn);
        let across = (1.0 - z * z).sqrt();
        Vec3::new(across * cos, across * sin, z)
    }
}

/// Frames a second of the motions that are dragged: keys lie on frames.
const RATE_HZ: f64 = 60.0;

/// A strand, a point of its outer half, two frames 0.3 to 0.8 s apart, and a target 10 to 60 mm from where the point
/// would be that the lock can be at: it is no farther from the root than 98 % of the lock's length, and clear of the body
/// by half a lock's width and 2 mm.
pub(super) fn drag(
    dice: &mut Dice,
    number: usize,
    scene: &Scene,
    groom: &Groom,
    motion: &StrandMotion,
) -> EditList {
    let end_secs = motion.times_secs[motion.times_secs.len() - 1];
    loop {
        let strand_idx = (dice.share() * groom.strands.len() as f64) as usize;
        let strand = &groom.strands[strand_idx];
        let last = strand.rest_curve_m.len() - 1;
        let point = (dice.within(0.5 * last as f64, last as f64 + 1.0) as usize).min(last);
        let first = (dice.within(0.5, end_secs - 1.3) * RATE_HZ).round();
        let second = first + (dice.within(0.3, 0.8) * RATE_HZ).round();
        let second_secs = second / RATE_HZ;
        let points = StrandPath::new(motion, strand_idx).points_at(second_secs);
        let target_m = points[point] + dice.direction() * dice.within(0.01, 0.06);
        let reach_m: f64 = points[..=point].windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        let is_near = (target_m - points[0]).norm() <= 0.98 * reach_m
            && out_of_reach(scene, &points, point, target_m, second_secs).is_none();
        if !is_near || clearance_m(scene, target_m, second_secs) < 0.5 * strand.lock_width_m + 0.002 {
            continue;
        }
        let edit = Edit {
            name: format!("drag {number}"),
            first: KeyTime::Secs(first / RATE_HZ),
            second: KeyTime::Secs(second_secs),
            ease: DEFAULT_EASE,
            muted: false,
            action: Action::Drag(Drag {
                strand: strand.name.clone(),
                control_point: ControlPoint::Index(point as u32),
                target: Target::At(target_m),
                reach_m: DEFAULT_REACH_M,
                also: Vec::new(),
            }),
        };
        return EditList { edits: vec![edit], ..EditList::new() };
    }
}

fn clearance_m(scene: &Scene, point_m: Vec3, secs: f64) -> f64 {
    let pose = scene.poses.motion_at(secs).world_from_head;
    let head_from_torso = scene.body.head_from_torso(&pose, &scene.rest_pose);
    let surfaces = Surface::of_body(&scene.body, &head_from_torso);
    surfaces.iter().map(|s| s.gap(point_m).distance_m).fold(f64::INFINITY, f64::min)
}

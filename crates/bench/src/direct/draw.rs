use tousle_core::{Groom, StrandMotion, Vec3};
use tousle_edit::{
    Action, ControlPoint, DEFAULT_EASE, DEFAULT_REACH_M, Drag, Edit, EditList, Key, KeyTime, StrandPath,
    Target, out_of_reach,
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

    /// A whole number below another.
    fn below(&mut self, n: usize) -> usize {
        (self.share() * n as f64) as usize
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

/// How long it may be from one key to the next, s.
const GAP_SECS: (f64, f64) = (0.3, 0.8);

/// How a drag with several keys has them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Several {
    /// Two or three keys of one strand, one after another.
    InTime,
    /// Two strands with a key each at the same time.
    AtOnce,
    /// The same of two that hang beside each other.
    Neighbors,
}

impl Several {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::InTime, Self::AtOnce, Self::Neighbors];

    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::InTime => "one strand in time",
            Self::AtOnce => "two strands at once",
            Self::Neighbors => "two neighbors at once",
        }
    }
}

/// A motion that drags are drawn on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Board<'a> {
    pub(super) scene: &'a Scene,
    pub(super) groom: &'a Groom,
    pub(super) motion: &'a StrandMotion,
}

impl Board<'_> {
    /// A strand, a point of its outer half, two frames 0.3 to 0.8 s apart, and a target that the point can be at
    /// ([`Board::target`]).
    pub(super) fn drag(&self, dice: &mut Dice, number: usize) -> EditList {
        loop {
            let strand = self.strand(dice);
            let point = self.point(dice, strand);
            let first = (dice.within(0.5, self.end_secs() - 1.3) * RATE_HZ).round();
            let second = first + gap_frames(dice);
            if let Some(target_m) = self.target(dice, strand, point, second / RATE_HZ) {
                let key = self.key(strand, point, second, target_m);
                return edit_list(format!("drag {number}"), first, vec![key]);
            }
        }
    }

    /// The same with several keys, each of a point and a target of its own.
    pub(super) fn several(&self, dice: &mut Dice, number: usize, several: Several) -> EditList {
        // Drawn once: three keys are refused more often than two, and would come more seldom.
        let n_later = if several == Several::InTime { 1 + dice.below(2) } else { 0 };
        loop {
            let strand = self.strand(dice);
            let gaps: Vec<f64> = (0..=n_later).map(|_| gap_frames(dice)).collect();
            let room_secs = self.end_secs() - 0.5 - gaps.iter().sum::<f64>() / RATE_HZ;
            let mut frame = (dice.within(0.5, room_secs) * RATE_HZ).round();
            let first = frame;
            let mut at: Vec<(usize, f64)> = Vec::new();
            for gap in gaps {
                frame += gap;
                at.push((strand, frame));
            }
            match several {
                Several::InTime => {}
                Several::AtOnce => at.push((self.other_strand(dice, strand), frame)),
                Several::Neighbors => at.push((self.nearest_strand(strand, frame / RATE_HZ), frame)),
            }
            let key = |(strand, frame): (usize, f64)| {
                let point = self.point(dice, strand);
                let target_m = self.target(dice, strand, point, frame / RATE_HZ)?;
                Some(self.key(strand, point, frame, target_m))
            };
            if let Some(keys) = at.into_iter().map(key).collect() {
                return edit_list(format!("drag {number}"), first, keys);
            }
        }
    }

    fn end_secs(&self) -> f64 {
        self.motion.times_secs[self.motion.times_secs.len() - 1]
    }

    fn strand(&self, dice: &mut Dice) -> usize {
        dice.below(self.groom.strands.len())
    }

    fn other_strand(&self, dice: &mut Dice, than: usize) -> usize {
        let n = self.groom.strands.len();
        (than + 1 + dice.below(n - 1)) % n
    }

    /// The strand whose tip is nearest to that of another at a time.
    fn nearest_strand(&self, to: usize, secs: f64) -> usize {
        let tip =
            |strand| StrandPath::new(self.motion, strand).points_at(secs).pop().expect("a strand has points");
        let away = |strand: &usize| (tip(*strand) - tip(to)).norm();
        let others = (0..self.groom.strands.len()).filter(|strand| *strand != to);
        others.min_by(|a, b| away(a).total_cmp(&away(b))).expect("a wig of several strands")
    }

    /// A point of a strand's outer half.
    fn point(&self, dice: &mut Dice, strand: usize) -> usize {
        let last = self.groom.strands[strand].rest_curve_m.len() - 1;
        (dice.within(0.5 * last as f64, last as f64 + 1.0) as usize).min(last)
    }

    /// A place 10 to 60 mm from where a point would be, if the lock can be there: no farther from the root than 98 % of
    /// the lock's length, and clear of the body by half a lock's width and 2 mm.
    fn target(&self, dice: &mut Dice, strand: usize, point: usize, secs: f64) -> Option<Vec3> {
        let points = StrandPath::new(self.motion, strand).points_at(secs);
        let target_m = points[point] + dice.direction() * dice.within(0.01, 0.06);
        let reach_m: f64 = points[..=point].windows(2).map(|p| (p[1] - p[0]).norm()).sum();
        let clear_m = 0.5 * self.groom.strands[strand].lock_width_m + 0.002;
        let is_free = (target_m - points[0]).norm() <= 0.98 * reach_m
            && out_of_reach(self.scene, &points, point, target_m, secs).is_none()
            && clearance_m(self.scene, target_m, secs) >= clear_m;
        is_free.then_some(target_m)
    }

    fn key(&self, strand: usize, point: usize, frame: f64, target_m: Vec3) -> Key {
        Key {
            strand: self.groom.strands[strand].name.clone(),
            control_point: ControlPoint::Index(point as u32),
            time: KeyTime::Secs(frame / RATE_HZ),
            target: Target::At(target_m),
        }
    }
}

fn gap_frames(dice: &mut Dice) -> f64 {
    (dice.within(GAP_SECS.0, GAP_SECS.1) * RATE_HZ).round()
}

/// One drag from a frame on, with at least one key.
fn edit_list(name: String, first: f64, mut keys: Vec<Key>) -> EditList {
    let own = keys.remove(0);
    let edit = Edit {
        name,
        first: KeyTime::Secs(first / RATE_HZ),
        second: own.time,
        ease: DEFAULT_EASE,
        muted: false,
        action: Action::Drag(Drag {
            strand: own.strand,
            control_point: own.control_point,
            target: own.target,
            reach_m: DEFAULT_REACH_M,
            also: keys,
        }),
    };
    EditList { edits: vec![edit], ..EditList::new() }
}

fn clearance_m(scene: &Scene, point_m: Vec3, secs: f64) -> f64 {
    let pose = scene.poses.motion_at(secs).world_from_head;
    let head_from_torso = scene.body.head_from_torso(&pose, &scene.rest_pose);
    let surfaces = Surface::of_body(&scene.body, &head_from_torso);
    surfaces.iter().map(|s| s.gap(point_m).distance_m).fold(f64::INFINITY, f64::min)
}

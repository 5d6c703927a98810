//! Drags on the fields of real captures: what E4 reaches, and what it must never do.

use std::path::{Path, PathBuf};
use tousle_core::{Groom, NoProgress, Strand, StrandMotion, Vec3};
use tousle_edit::{
    Action, ControlPoint, DEFAULT_EASE, DEFAULT_REACH_M, Drag, Edit, EditList, EditOptions, Edited, KeyTime,
    Target, Under, apply, measure,
};
use tousle_field::{FieldSequence, Scene};
use tousle_fit::{FitMethod, FitOptions, PaperOptions};
use tousle_pipeline::{ConvertOptions, Input, Silent, convert};
use tousle_sim::{Method, SimOptions, simulate};

fn capture(name: &str) -> Option<PathBuf> {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        eprintln!("skipped: TOUSLE_SHARED is not set");
        return None;
    };
    Some(Path::new(&shared).join("captures").join(name))
}

/// A capture's field by the paper's method, its scene, and the other hairstyle.
struct Shot {
    field: FieldSequence,
    scene: Scene,
    groom: Groom,
    unedited: StrandMotion,
}

impl Shot {
    fn new(folder: &Path, name: &str) -> Self {
        let read = |file: &str| std::fs::read(folder.join(file)).expect("a file of the capture");
        let (csv, session) = (read(&format!("{name}.csv")), read("session.json"));
        let method = FitMethod::Paper(PaperOptions::default());
        let fit = FitOptions { method, ..FitOptions::default() };
        let options = ConvertOptions { fit, ..ConvertOptions::default() };
        let [csv, session] = [Input { name: "csv", bytes: &csv }, Input { name: "session", bytes: &session }];
        let converted = convert(csv, session, &options, &Silent).expect("a field");
        let groom = tousle_groom::read_groom(&read("style_b.json"), &tousle_groom::GroomOptions::default());
        let groom = groom.expect("style B is a groom").groom;
        let (field, scene) = (converted.eff.field, converted.eff.scene);
        let unedited = simulated(&field, &scene, &groom);
        Self { field, scene, groom, unedited }
    }

    /// The k-th drag: a tip, half a second, 30 mm to a side that turns from drag to drag.
    fn drag(&self, k: usize) -> EditList {
        let strand_idx = (7 * k + 3) % self.groom.strands.len();
        let angle = 2.4 * k as f64;
        let offset = Vec3::new(libm::cos(angle), libm::sin(angle), 0.3 * libm::cos(2.0 * angle)) * 0.03;
        let first_secs = 1.5 + 0.1 * k as f64;
        let edit = Edit {
            name: format!("drag {k}"),
            first: KeyTime::Secs(first_secs),
            second: KeyTime::Secs(first_secs + 0.5),
            ease: DEFAULT_EASE,
            muted: false,
            action: Action::Drag(Drag {
                strand: self.groom.strands[strand_idx].name.clone(),
                control_point: ControlPoint::Tip,
                target: Target::Offset(offset),
                reach_m: DEFAULT_REACH_M,
                also: Vec::new(),
            }),
        };
        EditList { edits: vec![edit], ..EditList::new() }
    }

    fn edited(&self, edits: &EditList) -> Edited {
        let options = EditOptions::default();
        apply(self.field.clone(), &self.scene, &self.groom, &self.unedited, edits, &options).expect("an edit")
    }
}

fn simulated(field: &FieldSequence, scene: &Scene, groom: &Groom) -> StrandMotion {
    simulate(field, scene, groom, &SimOptions::of(Method::Paper), &NoProgress).expect("a simulation").motion
}

#[test]
fn strands_move_towards_their_targets_without_a_jump() {
    let Some(folder) = capture("gusts_left") else { return };
    let shot = Shot::new(&folder, "gusts_left");
    let mut left = Vec::new();
    for k in 0..8 {
        let edited = shot.edited(&shot.drag(k));
        let motion = simulated(&edited.sequence, &shot.scene, &shot.groom);
        let before = Under { motion: &shot.unedited, layers: &[] };
        let after = Under { motion: &motion, layers: &edited.sequence.layers };
        let effects = measure(before, after, &shot.groom).expect("two motions");
        let effect = &effects.edits[0];
        let (residual, strand) = (effect.keys[0].residual_mm, &effect.strands[0]);
        let share = residual.after / residual.before;
        let (acceleration, jerk, outcome) =
            (strand.peak_acceleration, strand.peak_jerk, &edited.report.edits[0]);
        eprintln!(
            "{}, {}: {:.1} mm to go of {:.1}; acceleration x {:.2}, jerk x {:.2}; {} handles; {:?}",
            outcome.name,
            outcome.strand,
            residual.after,
            residual.before,
            acceleration.after / acceleration.before,
            jerk.after / jerk.before,
            outcome.n_handles,
            outcome.unreachable,
        );
        assert!(effects.first_change_secs.is_some_and(|t| t > outcome.first_secs), "{effects:?}");
        // A lock that lies against the body may be held there, but it is not driven away.
        assert!(share < 1.05, "{effects:?}");
        assert!(effects.most_moved_far.is_none_or(|moved| moved.mm < 1.0));
        left.push(share);
    }
    left.sort_by(f64::total_cmp);
    eprintln!("left of the way: median {:.2}, worst {:.2}", left[4], left[7]);
    // E4 is no solution: it does not count on weight, and ends short. A force lost on its way would leave 1.
    assert!(left[4] < 0.75, "{left:?}");
}

/// A lock that was not there when the edit was made: coarser, a third lighter, and by another name.
#[test]
fn another_hairstyle_inherits_the_edit() {
    let Some(folder) = capture("gusts_left") else { return };
    let shot = Shot::new(&folder, "gusts_left");
    let edited = shot.edited(&shot.drag(5));
    let outcome = &edited.report.edits[0];
    let dragged = shot.groom.strands.iter().find(|s| s.name == outcome.strand).expect("the dragged strand");
    let last = dragged.rest_curve_m.len() - 1;
    let kept = dragged.rest_curve_m.iter().enumerate().filter(|(k, _)| (last - k) % 2 == 0 || *k == 0);
    let heir = Strand {
        name: "heir".into(),
        rest_curve_m: kept.map(|(_, p)| *p).collect(),
        linear_density_kg_per_m: dragged.linear_density_kg_per_m / 1.5,
        ..dragged.clone()
    };
    let groom = Groom { strands: vec![heir], assumed: Vec::new() };
    let [without, with] = [&shot.field, &edited.sequence].map(|field| simulated(field, &shot.scene, &groom));
    let frame = (outcome.second_secs * 60.0).round() as usize;
    let tip = |motion: &StrandMotion| {
        Vec3::from(motion.strand(frame, 0).last().expect("a strand has points").map(f64::from))
    };
    let moved = tip(&with) - tip(&without);
    let towards = (outcome.target_m - outcome.unedited_m).normalize();
    eprintln!(
        "the heir moved by {:.1} mm, {:.1} mm of it as asked",
        moved.norm() * 1e3,
        moved.dot(&towards) * 1e3
    );
    assert!(moved.dot(&towards) > 0.005, "{moved}");
}

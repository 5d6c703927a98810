use tousle_core::{Along, Groom, Strand, Vec3};
use tousle_pipeline::Prepared;

/// Control points of a lock.
const N_POINTS: usize = 14;

/// The captured locks as a hairstyle: each a line through its root and its markers as they hang still, evenly cut.
///
/// `like`: a strand whose stiffness and damping they have, which a session does not say.
pub fn wig(prepared: &Prepared, like: &Strand) -> Groom {
    let (head, session) = (prepared.head(), &prepared.session);
    let n_frames = head.poses.len();
    let (first, last) = session.still_range(head.first_frame, n_frames).unwrap_or((0, n_frames.min(1)));
    let strand = |tracks: &tousle_core::StrandTracks| {
        let spec = &session.strands[tracks.strand_idx];
        let mut line = vec![spec.root_m];
        for track in &tracks.markers {
            let seen: Vec<Vec3> = (first..=last).filter_map(|frame| track.at(frame)).collect();
            if !seen.is_empty() {
                line.push(seen.iter().sum::<Vec3>() / seen.len() as f64);
            }
        }
        let curve = cut(&line, spec.length_m);
        Strand {
            name: spec.name.clone(),
            length_m: spec.length_m,
            rest_curve_m: curve,
            linear_density_kg_per_m: spec.linear_density_kg_per_m,
            lock_width_m: spec.lock_width_m,
            bending_stiffness_n_m2: like.bending_stiffness_n_m2,
            internal_damping_secs: like.internal_damping_secs,
            along: Along::default(),
            holds_style: false,
        }
    };
    Groom { strands: head.strands.iter().map(strand).collect(), assumed: Vec::new() }
}

/// Even points along a line, which goes on straight to a length if it is shorter.
fn cut(line: &[Vec3], length_m: f64) -> Vec<Vec3> {
    let last = line.len() - 1;
    let along: f64 = line.windows(2).map(|p| (p[1] - p[0]).norm()).sum();
    let on = (line[last] - line[last.saturating_sub(1)]).try_normalize(1e-9).unwrap_or(-Vec3::z());
    let mut line = line.to_vec();
    line.push(line[last] + on * (length_m - along).max(1e-3));
    let at = |arc_m: f64| {
        let mut left = arc_m;
        for pair in line.windows(2) {
            let stick = (pair[1] - pair[0]).norm();
            if left <= stick {
                return pair[0] + (pair[1] - pair[0]) * (left / stick.max(1e-9));
            }
            left -= stick;
        }
        line[line.len() - 1]
    };
    (0..N_POINTS).map(|k| at(length_m * k as f64 / (N_POINTS - 1) as f64)).collect()
}

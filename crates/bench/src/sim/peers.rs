use crate::{Curve, CurvePoint};
use serde::Deserialize;

/// What other programs got on the same work: figures quoted from `data/peers.json`, measured elsewhere.
#[derive(Debug, Deserialize)]
pub(super) struct Peers {
    /// Who measured them.
    pub source: String,
    /// On what.
    pub machine: String,
    /// What one should know besides.
    pub remark: String,
    pub points: Vec<PeerPoint>,
}

#[derive(Debug, Deserialize)]
pub(super) struct PeerPoint {
    pub capture: String,
    pub program: String,
    pub setting: String,
    pub cpu_secs_per_sec: f64,
    pub explained_motion: f64,
    pub mean_mm: f64,
}

impl Peers {
    /// The file.
    ///
    /// # Panics
    /// Never: the file is part of the program, and a test reads it.
    pub fn read() -> Self {
        serde_json::from_str(include_str!("../../data/peers.json")).expect("the file is sound")
    }

    /// One curve a program that was run on a capture: its unexplained motion.
    pub fn curves(&self, capture: &str) -> Vec<Curve> {
        let here: Vec<&PeerPoint> = self.points.iter().filter(|p| p.capture == capture).collect();
        let point = |p: &PeerPoint| CurvePoint {
            setting: p.setting.clone(),
            cost: p.cpu_secs_per_sec,
            error: 1.0 - p.explained_motion,
        };
        here.chunk_by(|a, b| a.program == b.program)
            .map(|of_one| Curve {
                points: of_one.iter().map(|p| point(p)).collect(),
                is_labeled: true,
                ..Curve::named(of_one[0].program.clone())
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_sound() {
        let peers = Peers::read();
        assert_eq!(peers.points.len(), 17);
        let gusts = peers.curves("gusts_left");
        assert_eq!(gusts.iter().map(|c| c.points.len()).collect::<Vec<_>>(), [2, 4]);
    }
}

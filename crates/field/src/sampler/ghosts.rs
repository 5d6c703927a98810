//! What stands in for air where a head is.

use crate::{Field, GridSpec, VoxelIndex};

/// The voxels without air that lie beside some with air: ghost cells (R. Mittal and G. Iaccarino, "Immersed boundary methods",
/// *Annual Review of Fluid Mechanics* 37, 2005).
///
/// Read between voxel centers, their zeros would slow the wind down over a whole voxel outside; left out, it would not be slower
/// near the head than a voxel away. So each goes on, past the surface, as the air beside it changes towards it.
#[derive(Debug)]
pub(super) struct Ghosts {
    /// By voxel: which ghost it is, or [`NONE`].
    of_voxels: Box<[u32]>,
    ghosts: Box<[Ghost]>,
}

/// Vectors of all ghosts at a step.
pub(super) type GhostVectors = Box<[[f32; 3]]>;

/// A voxel that is no ghost.
const NONE: u32 = u32::MAX;

#[derive(Debug)]
struct Ghost {
    flat: usize,
    lines: Box<[Line]>,
}

/// A line from a ghost through air.
#[derive(Debug)]
struct Line {
    /// The voxel beside the ghost.
    next: usize,
    /// The one behind that, as far again; the same where that is beyond the grid or has no air.
    beyond: usize,
    /// How much this line counts: as one over the fourth power of its length. All of a ghost's add up to 1.
    weight: f32,
}

impl Ghosts {
    /// The ghosts of a grid whose voxels have air or none; `None` if there are none.
    pub(super) fn of(grid: &GridSpec, has_air: &[bool]) -> Option<Self> {
        let mut of_voxels = vec![NONE; has_air.len()].into_boxed_slice();
        let mut ghosts = Vec::new();
        for flat in (0..has_air.len()).filter(|flat| !has_air[*flat]) {
            let lines = lines(grid, has_air, flat);
            if !lines.is_empty() {
                of_voxels[flat] = ghosts.len() as u32;
                ghosts.push(Ghost { flat, lines });
            }
        }
        (!ghosts.is_empty()).then(|| Self { of_voxels, ghosts: ghosts.into() })
    }

    /// What each ghost stands for at a step.
    pub(super) fn vectors(&self, step: &Field) -> GhostVectors {
        let n = step.flags.len();
        let of_ghost = |ghost: &Ghost| {
            [0, 1, 2].map(|axis| {
                let component = &step.u[axis * n..][..n];
                let goes_on = |line: &Line| {
                    line.weight * (component[line.next] + (component[line.next] - component[line.beyond]))
                };
                ghost.lines.iter().map(goes_on).sum()
            })
        };
        self.ghosts.iter().map(of_ghost).collect()
    }

    /// Each ghost's voxel, in the order of [`Ghosts::vectors`].
    pub(super) fn flats(&self) -> impl Iterator<Item = usize> {
        self.ghosts.iter().map(|ghost| ghost.flat)
    }

    /// Which ghost a voxel is.
    #[inline(always)]
    pub(super) fn at(&self, flat: usize) -> Option<usize> {
        let ghost = self.of_voxels[flat];
        (ghost != NONE).then_some(ghost as usize)
    }
}

/// The lines from a voxel through all those with air of the 26 around it.
fn lines(grid: &GridSpec, has_air: &[bool], flat: usize) -> Box<[Line]> {
    let VoxelIndex(own) = grid.unflat(flat);
    let at = |by: [isize; 3], times: isize| -> Option<usize> {
        let mut voxel = own;
        for ((place, by), n) in voxel.iter_mut().zip(by).zip(grid.dims) {
            *place = place.checked_add_signed(times * by).filter(|place| *place < n)?;
        }
        let flat = grid.flat(VoxelIndex(voxel));
        has_air[flat].then_some(flat)
    };
    let mut lines = Vec::new();
    for by in (0..27).map(|k| [k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1]) {
        if let Some(next) = at(by, 1) {
            let square = by.iter().map(|c| (c * c) as f32).sum::<f32>();
            lines.push(Line { next, beyond: at(by, 2).unwrap_or(next), weight: 1.0 / (square * square) });
        }
    }
    let whole: f32 = lines.iter().map(|line| line.weight).sum();
    lines.iter_mut().for_each(|line| line.weight /= whole);
    lines.into()
}

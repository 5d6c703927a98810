//! Asking the field, the same way for every method.

use tousle_field::{Moment, SAMPLED_AT_ONCE};
use tousle_lanes::{Lane, Vector};

/// How many rows of points are handed to the field at once.
const ROWS: usize = 4;

/// The field's vector at the middle of every stick, from the root outwards. `end`: where a stick ends, head space, m;
/// `put` takes what is there.
#[inline(always)]
pub(crate) fn feel_at_middles<L: Lane, W>(
    moment: &Moment<'_>,
    root: Vector<L>,
    sticks: &mut [W],
    end: impl Fn(&W) -> Vector<L>,
    mut put: impl FnMut(usize, &mut W, Vector<L>),
) {
    let half = root.x.same(0.5);
    let mut before = root;
    let (mut points, mut vectors) =
        ([[[0.0; SAMPLED_AT_ONCE]; 3]; ROWS], [[[0.0; SAMPLED_AT_ONCE]; 3]; ROWS]);
    // A row has room for the strands side by side of so many sticks.
    let in_row = SAMPLED_AT_ONCE / L::N;
    for (chunk, sticks) in sticks.chunks_mut(ROWS * in_row).enumerate() {
        for (k, stick) in sticks.iter().enumerate() {
            let end = end(stick);
            ((before + end) * half).put_single(&mut points[k / in_row], k % in_row * L::N);
            before = end;
        }
        let n_rows = sticks.len().div_ceil(in_row);
        moment.sample_all(&points[..n_rows], &mut vectors[..n_rows]);
        for (k, stick) in sticks.iter_mut().enumerate() {
            let found = Vector::of_single(half, &vectors[k / in_row], k % in_row * L::N);
            put(chunk * ROWS * in_row + k, stick, found);
        }
    }
}

//! Transcendental functions where they are needed, by power series: the same on every machine.

use crate::Lane;
use core::f64::consts::{FRAC_PI_2, PI};

/// Σ `terms[k]` xᵏ.
#[inline(always)]
pub fn series<L: Lane, const N: usize>(x: L, terms: [f64; N]) -> L {
    let mut sum = x.same(terms[N - 1]);
    for k in (0..N - 1).rev() {
        sum = sum.mul_add(x, x.same(terms[k]));
    }
    sum
}

/// A root r of x to the power of −1/k, brought closer: r (1 − h)^(−1/k), h = 1 − x rᵏ, by the terms of that series.
#[inline(always)]
fn closer<L: Lane>(root: L, rest: L, terms: &[f64]) -> L {
    let mut sum = root.same(terms[terms.len() - 1]);
    for k in (0..terms.len() - 1).rev() {
        sum = sum.mul_add(rest, root.same(terms[k]));
    }
    (root * rest).mul_add(sum, root)
}

/// [`Lane::per_sqrt`] from a guess, by as many steps as there are rows of terms.
#[inline(always)]
pub(crate) fn per_sqrt_from<L: Lane>(x: L, mut root: L, steps: [&[f64]; 2]) -> L {
    for terms in steps {
        let rest = (-x * root).mul_add(root, x.same(1.0));
        root = closer(root, rest, terms);
    }
    root
}

/// [`Lane::per_sixth_root`] likewise.
#[inline(always)]
pub(crate) fn per_sixth_root_from<L: Lane>(x: L, mut root: L, steps: [&[f64]; 2]) -> L {
    for terms in steps {
        let cube = root * root * root;
        let rest = (-x * cube).mul_add(cube, x.same(1.0));
        root = closer(root, rest, terms);
    }
    root
}

/// e^(−x) − 1 for x ≥ 0, to a few units in the last place.
///
/// With x = r − k ln 2, |r| ≤ ½ ln 2: the first term that is left out of the series for e^r − 1 is below 1e-16 of it.
#[inline(always)]
pub fn fade<L: Lane>(x: L) -> L {
    // Of an even longer fade nothing is left either.
    let down = -x.min(x.same(80.0));
    let k = (down * x.same(core::f64::consts::LOG2_E)).round();
    // ln 2 in two parts, so that k times the first is exact.
    let r = k.mul_add(x.same(-LN_2_HIGH), down);
    let r = k.mul_add(x.same(-LN_2_LOW), r);
    let rises = r * series(r, OVER_FACTORIALS);
    let scale = k.exp2_whole();
    scale.mul_add(rises, scale - x.same(1.0))
}

/// ln 2 to 11 bits, which leaves room for whole numbers up to 120 in single precision too; and the rest.
const LN_2_HIGH: f64 = 0.693_359_375;
const LN_2_LOW: f64 = core::f64::consts::LN_2 - LN_2_HIGH;

/// 1 / (k + 1)!
const OVER_FACTORIALS: [f64; 14] = {
    let mut terms = [1.0; 14];
    let mut k = 1;
    while k < 14 {
        terms[k] = terms[k - 1] / (k + 1) as f64;
        k += 1;
    }
    terms
};

/// |1 − exp(ix)|² = 2 − 2 cos x from x² ≤ π²/4; the first term that is left out is below 1e-16 of it.
#[inline(always)]
pub fn squared_chord<L: Lane>(x2: L) -> L {
    x2 * series(x2, CHORD2)
}

/// cos x and sin x / x from x² ≤ 1; the first terms that are left out are below 1e-16.
#[inline(always)]
pub fn cos_and_sine_share<L: Lane>(x2: L) -> (L, L) {
    (series(x2, COSINE), series(x2, SINE))
}

/// cos x and sin x.
#[inline(always)]
pub fn cos_and_sine<L: Lane>(x: L) -> (L, L) {
    let (x2, one) = (x * x, x.same(1.0));
    let (mut cos, share) = cos_and_sine_share(x2.min(one));
    let mut sin = x * share;
    if x2.any_above(one) {
        for lane in (0..L::N).filter(|lane| x2.get(*lane) > 1.0) {
            let (s, c) = libm::sincos(x.get(lane));
            sin.set(lane, s);
            cos.set(lane, c);
        }
    }
    (cos, sin)
}

/// An angle over its sine, from the sine's square and the cosine, for angles that are neither next to nothing nor next to
/// half a turn; to a few units in the last place.
#[inline(always)]
pub fn angle_per_sine<L: Lane>(sin2: L, cos: L) -> L {
    let (half, two) = (cos.same(0.5), cos.same(2.0));
    let least = cos.max(-cos);
    // Up to a third of a right angle by its own sine: from a right angle down, or the half of what is farther from it.
    let sine2_of_half = sin2 / (two + least + least);
    let near = least.above(half, sine2_of_half, cos * cos);
    let angle = series(near, ARCSINE) * least.above(half, sine2_of_half.sqrt(), cos);
    let to_end = cos.above(half, angle + angle, cos.same(PI) - (angle + angle));
    least.above(half, to_end, cos.same(FRAC_PI_2) - angle) * sin2.per_sqrt()
}

/// Of arcsin(s)/s in s²; below ¼ the first term that is left out is below 1e-17.
const ARCSINE: [f64; 24] = {
    let mut terms = [1.0; 24];
    let (mut k, mut product) = (1, 1.0);
    while k < 24 {
        product *= (2 * k - 1) as f64 / (2 * k) as f64;
        terms[k] = product / (2 * k + 1) as f64;
        k += 1;
    }
    terms
};

/// (−1)ᵏ / (2 k)!, (−1)ᵏ / (2 k + 1)! and 2 (−1)ᵏ / (2 k + 2)!
const COSINE: [f64; 10] = alternating(0);
const SINE: [f64; 9] = alternating(1);
const CHORD2: [f64; 11] = alternating(2);

const fn alternating<const N: usize>(first: usize) -> [f64; N] {
    let mut terms = [1.0; N];
    let mut k = 1;
    while k < N {
        let at = 2 * k + first;
        terms[k] = -terms[k - 1] / (at * (at - 1)) as f64;
        k += 1;
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::F64x1;

    #[test]
    fn functions_are_those_of_the_library() {
        for k in 0..2000 {
            let x = f64::from(k) * 1e-3;
            let (angle, long) = (x * 0.39, x * x * x * 6.0);
            let close = |found: F64x1, expected: f64| {
                assert!(
                    (found.get(0) - expected).abs() <= 1e-15 * expected.abs(),
                    "{x} {found:?} {expected}"
                );
            };
            close(fade(F64x1::splat(x)), libm::expm1(-x));
            close(fade(F64x1::splat(long)), libm::expm1(-long));
            let half = libm::sin(angle);
            close(squared_chord(F64x1::splat(4.0 * angle * angle)), 4.0 * half * half);
            let (cos, share) = cos_and_sine_share(F64x1::splat(angle * angle));
            close(cos, libm::cos(angle));
            close(share * F64x1::splat(angle), libm::sin(angle));
            let (cos, sin) = cos_and_sine(F64x1::splat(-long));
            assert!(
                (cos.get(0) - libm::cos(long)).abs() < 2e-16 && (sin.get(0) + libm::sin(long)).abs() < 2e-16
            );
        }
        assert_eq!(fade(F64x1::splat(f64::INFINITY)).get(0), -1.0);
    }

    #[test]
    fn an_angle_is_found_from_its_sine_and_cosine() {
        for k in 1..3140 {
            let angle = f64::from(k) * 1e-3;
            let (sin, cos) = libm::sincos(angle);
            let found = angle_per_sine(F64x1::splat(sin * sin), F64x1::splat(cos)).get(0);
            assert!((found * sin / angle - 1.0).abs() < 2e-15, "{angle}: {}", found * sin);
        }
    }
}

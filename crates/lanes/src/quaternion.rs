use crate::{F64x1, Lane, Matrix, Vector};

/// 1 + w of a turn by 335°: [`Turn::one_more`] is no less.
const LEAST_MORE: f64 = 0.024;

/// A rotation for each of some strands, as a unit quaternion w + v.
#[derive(Clone, Copy, Debug)]
pub struct Turn<L> {
    /// The real part.
    pub w: L,
    /// The imaginary part.
    pub v: Vector<L>,
}

impl<L: Lane> Turn<L> {
    /// No turn.
    #[inline(always)]
    pub fn identity(like: L) -> Self {
        Self { w: like.same(1.0), v: Vector::none(like) }
    }

    /// The same turn for all, beside a number that there is.
    #[inline(always)]
    pub fn same(like: L, turn: &Turn<F64x1>) -> Self {
        Self { w: like.same(turn.w.get(0)), v: Vector::same(like, turn.v.get(0)) }
    }

    /// This after another.
    #[inline(always)]
    pub fn after(self, o: Self) -> Self {
        Self {
            w: self.w.mul_add(o.w, -self.v.dot(o.v)),
            v: o.v.mul_add(self.w, self.v.mul_add(o.w, self.v.cross(o.v))),
        }
    }

    /// The turn back.
    #[inline(always)]
    pub fn inverse(self) -> Self {
        Self { w: self.w, v: -self.v }
    }

    /// Where a vector goes.
    #[inline(always)]
    pub fn rotate(self, a: Vector<L>) -> Vector<L> {
        let t = self.v.cross(a) * self.w.same(2.0);
        self.v.cross_add(t, t.mul_add(self.w, a))
    }

    /// Its matrix, less the identity: in single precision 1 itself would leave nothing of small turns.
    #[inline(always)]
    pub fn less_identity(self) -> Matrix<L> {
        let Vector { x, y, z } = self.v * self.w.same(2.0);
        let [xx, yy, zz] = [x * self.v.x, y * self.v.y, z * self.v.z];
        let (w, of_x, of_y) = (self.w, self.v.x, self.v.y);
        Matrix {
            x: Vector::new(-(yy + zz), y.mul_add(of_x, -(z * w)), z.mul_add(of_x, y * w)),
            y: Vector::new(y.mul_add(of_x, z * w), -(xx + zz), z.mul_add(of_y, -(x * w))),
            z: Vector::new(z.mul_add(of_x, -(y * w)), z.mul_add(of_y, x * w), -(xx + yy)),
        }
    }

    /// Where the x axis goes.
    #[inline(always)]
    pub fn x_axis(self) -> Vector<L> {
        let two = self.w.same(2.0);
        let Vector { x, y, z } = self.v;
        Vector::new(
            (-two).mul_add(y.mul_add(y, z * z), self.w.same(1.0)),
            two * x.mul_add(y, self.w * z),
            two * x.mul_add(z, -(self.w * y)),
        )
    }

    /// This where `of` is above `bound`, else another.
    #[inline(always)]
    pub fn where_above(self, of: L, bound: L, no: Self) -> Self {
        Self { w: of.above(bound, self.w, no.w), v: Vector::where_above(of, bound, self.v, no.v) }
    }

    /// This over its length.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        let per_norm = self.w.mul_add(self.w, self.v.norm_squared()).per_sqrt();
        Self { w: self.w * per_norm, v: self.v * per_norm }
    }

    /// This after the turn by 2 arctan(|b|/2) about b: by b itself if b is small, never by more than half a turn.
    #[inline(always)]
    pub fn turned(self, b: Vector<L>) -> Self {
        Self { w: self.w.same(1.0), v: b * self.w.same(0.5) }.after(self).normalized()
    }

    /// Four times the tangent of a quarter of the angle, along the axis (Wiener and Milenkovic): close to the rotation
    /// vector, without a trigonometric function, and smooth up to a whole turn. More than half a turn is not the turn the other
    /// way that ends alike: of the two that is this one whose sign the quaternion has.
    #[inline(always)]
    pub fn bend(self) -> Vector<L> {
        self.v * (self.w.same(4.0) / self.one_more())
    }

    /// One more than w; a whole turn, where that is nothing, counts as a little less.
    #[inline(always)]
    pub fn one_more(self) -> L {
        (self.w + self.w.same(1.0)).max(self.w.same(LEAST_MORE))
    }

    /// The same turn with another sign, 1 or −1.
    #[inline(always)]
    pub fn signed(self, sign: L) -> Self {
        Self { w: self.w * sign, v: self.v * sign }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tousle_core::Vec3;

    #[test]
    fn a_matrix_less_the_identity_is_how_far_vectors_move() {
        let v = Vec3::new(0.3, -0.5, 0.2);
        let turn = Turn { w: F64x1::splat((1.0 - v.norm_squared()).sqrt()), v: Vector::splat(v) };
        for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
            let moved = turn.less_identity().mul_vector(Vector::splat(axis)).get(0);
            assert!((moved + axis - turn.rotate(Vector::splat(axis)).get(0)).norm() < 1e-15);
        }
    }
}

use super::{Lane, Vector};

/// A rotation for each of some strands, as a unit quaternion w + v.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn<L> {
    pub w: L,
    pub v: Vector<L>,
}

impl<L: Lane> Turn<L> {
    #[inline(always)]
    pub fn identity(like: L) -> Self {
        Self { w: like.same(1.0), v: Vector::none(like) }
    }

    /// This after another.
    #[inline(always)]
    pub fn after(self, o: Self) -> Self {
        Self {
            w: self.w.mul_add(o.w, -self.v.dot(o.v)),
            v: o.v.mul_add(self.w, self.v.mul_add(o.w, self.v.cross(o.v))),
        }
    }

    #[inline(always)]
    pub fn inverse(self) -> Self {
        Self { w: self.w, v: -self.v }
    }

    #[inline(always)]
    pub fn rotate(self, a: Vector<L>) -> Vector<L> {
        let t = self.v.cross(a) * self.w.same(2.0);
        t.mul_add(self.w, a) + self.v.cross(t)
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
    /// vector, without a trigonometric function, and smooth up to a whole turn. The shorter of the two ways is taken.
    #[inline(always)]
    pub fn bend(self) -> Vector<L> {
        let (sign, one_more) = self.shorter();
        self.v * (sign * self.w.same(4.0) / one_more)
    }

    /// The sign, 1 or −1, by which this turns the shorter way, and one more than the w that it has then.
    #[inline(always)]
    pub fn shorter(self) -> (L, L) {
        let one = self.w.same(1.0);
        let sign = self.w.above(self.w.same(0.0), one, -one);
        (sign, self.w.mul_add(sign, one))
    }
}

use crate::vector::minor;
use crate::{Lane, Vector};
use nalgebra::Matrix3;
use tousle_core::{Pose, Vec3};

/// A symmetric 3 × 3 matrix for each of some strands.
#[derive(Clone, Copy, Debug)]
pub struct Symmetric<L> {
    /// Row x, column x.
    pub xx: L,
    /// Row x, column y.
    pub xy: L,
    /// Row x, column z.
    pub xz: L,
    /// Row y, column y.
    pub yy: L,
    /// Row y, column z.
    pub yz: L,
    /// Row z, column z.
    pub zz: L,
}

/// A 3 × 3 matrix for each of some strands, by rows.
#[derive(Clone, Copy, Debug)]
pub struct Matrix<L> {
    /// The first row.
    pub x: Vector<L>,
    /// The second row.
    pub y: Vector<L>,
    /// The third row.
    pub z: Vector<L>,
}

/// What the inverse of a symmetric matrix Q plus s times the identity is made of, by Cayley and Hamilton:
/// (Q + s)⁻¹ = (part + inner) / det and (Q + s)⁻¹ Q = (outer − s part) / det. The latter is as exact for an s far above Q,
/// where 1 − s (Q + s)⁻¹ would take like from like.
#[derive(Clone, Copy, Debug)]
pub struct Shifted<L> {
    /// adj Q − s Q.
    pub part: Symmetric<L>,
    /// s (tr Q + s).
    pub inner: L,
    /// det Q + s tr adj Q.
    pub outer: L,
    /// det (Q + s).
    pub det: L,
}

impl<L: Lane> Symmetric<L> {
    /// Zero.
    pub fn zero() -> Self {
        Self::none(L::zero())
    }

    /// Zero, beside a number that there is.
    #[inline(always)]
    pub fn none(like: L) -> Self {
        Self::scaled_identity(like.same(0.0))
    }

    /// s times the identity.
    #[inline(always)]
    pub fn scaled_identity(s: L) -> Self {
        let o = s.same(0.0);
        Self { xx: s, xy: o, xz: o, yy: s, yz: o, zz: s }
    }

    /// Adds s times the identity.
    #[inline(always)]
    pub fn add_identity(&mut self, s: L) {
        self.xx += s;
        self.yy += s;
        self.zz += s;
    }

    /// Adds s v vᵀ.
    #[inline(always)]
    pub fn add_outer(&mut self, v: Vector<L>, s: L) {
        let sv = v * s;
        self.xx = sv.x.mul_add(v.x, self.xx);
        self.xy = sv.x.mul_add(v.y, self.xy);
        self.xz = sv.x.mul_add(v.z, self.xz);
        self.yy = sv.y.mul_add(v.y, self.yy);
        self.yz = sv.y.mul_add(v.z, self.yz);
        self.zz = sv.z.mul_add(v.z, self.zz);
    }

    /// Adds another.
    #[inline(always)]
    pub fn add(&mut self, o: &Self) {
        self.xx += o.xx;
        self.xy += o.xy;
        self.xz += o.xz;
        self.yy += o.yy;
        self.yz += o.yz;
        self.zz += o.zz;
    }

    /// Adds s times another.
    #[inline(always)]
    pub fn add_scaled(&mut self, o: &Self, s: L) {
        self.xx = o.xx.mul_add(s, self.xx);
        self.xy = o.xy.mul_add(s, self.xy);
        self.xz = o.xz.mul_add(s, self.xz);
        self.yy = o.yy.mul_add(s, self.yy);
        self.yz = o.yz.mul_add(s, self.yz);
        self.zz = o.zz.mul_add(s, self.zz);
    }

    /// This times a vector.
    #[inline(always)]
    pub fn mul_vector(&self, v: Vector<L>) -> Vector<L> {
        Vector::new(
            self.xx.mul_add(v.x, self.xy.mul_add(v.y, self.xz * v.z)),
            self.xy.mul_add(v.x, self.yy.mul_add(v.y, self.yz * v.z)),
            self.xz.mul_add(v.x, self.yz.mul_add(v.y, self.zz * v.z)),
        )
    }

    /// This times a vector plus another.
    #[inline(always)]
    pub fn mul_vector_add(&self, v: Vector<L>, to: Vector<L>) -> Vector<L> {
        Vector::new(
            self.xx.mul_add(v.x, self.xy.mul_add(v.y, self.xz.mul_add(v.z, to.x))),
            self.xy.mul_add(v.x, self.yy.mul_add(v.y, self.yz.mul_add(v.z, to.y))),
            self.xz.mul_add(v.x, self.yz.mul_add(v.y, self.zz.mul_add(v.z, to.z))),
        )
    }

    /// This times a number.
    #[inline(always)]
    pub fn scale(&self, s: L) -> Self {
        Self {
            xx: self.xx * s,
            xy: self.xy * s,
            xz: self.xz * s,
            yy: self.yy * s,
            yz: self.yz * s,
            zz: self.zz * s,
        }
    }

    /// This plus s times the identity.
    #[inline(always)]
    pub fn plus_identity(&self, s: L) -> Self {
        Self { xx: self.xx + s, yy: self.yy + s, zz: self.zz + s, ..*self }
    }

    /// This times the matrix of b ↦ b × d: each row r becomes d × r.
    #[inline(always)]
    pub fn mul_lever(&self, d: Vector<L>) -> Matrix<L> {
        let Matrix { x, y, z } = self.to_matrix();
        Matrix { x: d.cross(x), y: d.cross(y), z: d.cross(z) }
    }

    /// Adds half of Sᵀ m + mᵀ S, S the matrix of b ↦ b × d.
    #[inline(always)]
    pub fn add_lever_product(&mut self, d: Vector<L>, m: &Matrix<L>) {
        let half = d * d.x.same(0.5);
        self.xx = plus_minor(self.xx, (m.z.x, d.y), (m.y.x, d.z));
        self.yy = plus_minor(self.yy, (m.x.y, d.z), (m.z.y, d.x));
        self.zz = plus_minor(self.zz, (m.y.z, d.x), (m.x.z, d.y));
        let xy = plus_minor(self.xy, (m.z.y, half.y), (m.y.y, half.z));
        self.xy = plus_minor(xy, (m.x.x, half.z), (m.z.x, half.x));
        let xz = plus_minor(self.xz, (m.z.z, half.y), (m.y.z, half.z));
        self.xz = plus_minor(xz, (m.y.x, half.x), (m.x.x, half.y));
        let yz = plus_minor(self.yz, (m.x.z, half.z), (m.z.z, half.x));
        self.yz = plus_minor(yz, (m.y.y, half.x), (m.x.y, half.y));
    }

    /// [`Shifted`] by s.
    #[inline(always)]
    pub fn shifted(&self, s: L) -> Shifted<L> {
        let (xx, yy, zz) = (
            minor(self.yy, self.zz, self.yz, self.yz),
            minor(self.xx, self.zz, self.xz, self.xz),
            minor(self.xx, self.yy, self.xy, self.xy),
        );
        let xy = minor(self.xz, self.yz, self.xy, self.zz);
        let xz = minor(self.xy, self.yz, self.xz, self.yy);
        let yz = minor(self.xy, self.xz, self.xx, self.yz);
        let own_det = self.xx.mul_add(xx, self.xy.mul_add(xy, self.xz * xz));
        let cofactors = xx + yy + zz;
        let inner = s * (self.xx + self.yy + self.zz + s);
        let mut part = Self { xx, xy, xz, yy, yz, zz };
        part.add_scaled(self, -s);
        Shifted {
            part,
            inner,
            outer: s.mul_add(cofactors, own_det),
            det: s.mul_add(inner + cofactors, own_det),
        }
    }

    /// All nine numbers of it.
    #[inline(always)]
    pub fn to_matrix(self) -> Matrix<L> {
        Matrix {
            x: Vector::new(self.xx, self.xy, self.xz),
            y: Vector::new(self.xy, self.yy, self.yz),
            z: Vector::new(self.xz, self.yz, self.zz),
        }
    }
}

impl<L: Lane> Matrix<L> {
    /// Zero.
    pub fn zero() -> Self {
        Self::none(L::zero())
    }

    /// Zero, beside a number that there is.
    #[inline(always)]
    pub fn none(like: L) -> Self {
        let o = Vector::none(like);
        Self { x: o, y: o, z: o }
    }

    /// The same matrix for all, beside a number that there is.
    #[inline(always)]
    pub fn same(like: L, m: &Matrix3<f64>) -> Self {
        Self {
            x: Vector::same(like, Vec3::new(m.m11, m.m12, m.m13)),
            y: Vector::same(like, Vec3::new(m.m21, m.m22, m.m23)),
            z: Vector::same(like, Vec3::new(m.m31, m.m32, m.m33)),
        }
    }

    /// Rows times a vector.
    #[inline(always)]
    pub fn mul_vector(&self, v: Vector<L>) -> Vector<L> {
        Vector::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }

    /// Rows times a vector, plus another.
    #[inline(always)]
    pub fn mul_vector_add(&self, v: Vector<L>, to: Vector<L>) -> Vector<L> {
        let row = |row: Vector<L>, to: L| row.x.mul_add(v.x, row.y.mul_add(v.y, row.z.mul_add(v.z, to)));
        Vector::new(row(self.x, to.x), row(self.y, to.y), row(self.z, to.z))
    }

    /// The transpose times a vector.
    #[inline(always)]
    pub fn transpose_mul(&self, v: Vector<L>) -> Vector<L> {
        self.x.mul_add(v.x, self.y.mul_add(v.y, self.z * v.z))
    }

    /// The transpose times a vector plus another.
    #[inline(always)]
    pub fn transpose_mul_add(&self, v: Vector<L>, to: Vector<L>) -> Vector<L> {
        self.x.mul_add(v.x, self.y.mul_add(v.y, self.z.mul_add(v.z, to)))
    }

    /// A vector less this times another.
    #[inline(always)]
    pub fn subtract_from(&self, from: Vector<L>, v: Vector<L>) -> Vector<L> {
        Vector::new(less(from.x, self.x, v), less(from.y, self.y, v), less(from.z, self.z, v))
    }

    /// This times a symmetric matrix.
    #[inline(always)]
    pub fn mul_symmetric(&self, s: &Symmetric<L>) -> Self {
        Self { x: s.mul_vector(self.x), y: s.mul_vector(self.y), z: s.mul_vector(self.z) }
    }

    /// This times a number plus another.
    #[inline(always)]
    pub fn mul_add(&self, s: L, o: &Self) -> Self {
        Self { x: self.x.mul_add(s, o.x), y: self.y.mul_add(s, o.y), z: self.z.mul_add(s, o.z) }
    }
}

/// The same pose for all strands.
#[derive(Clone, Copy, Debug)]
pub struct Placing<L> {
    /// The rotation, before the shift.
    pub turn: Matrix<L>,
    /// The shift.
    pub shift: Vector<L>,
}

impl<L: Lane> Placing<L> {
    /// Of a pose, beside a number that there is.
    #[inline(always)]
    pub fn same(like: L, pose: &Pose) -> Self {
        Self {
            turn: Matrix::same(like, pose.rotation.to_rotation_matrix().matrix()),
            shift: Vector::same(like, pose.translation.vector),
        }
    }

    /// Where points go.
    #[inline(always)]
    pub fn place(&self, points: Vector<L>) -> Vector<L> {
        self.turn.mul_vector_add(points, self.shift)
    }
}

impl<L: Lane> Symmetric<L> {
    /// Takes off a bᵀ, for two whose product is symmetric.
    #[inline(always)]
    pub fn subtract_product(&mut self, a: &Matrix<L>, b: &Matrix<L>) {
        self.xx = less(self.xx, a.x, b.x);
        self.xy = less(self.xy, a.x, b.y);
        self.xz = less(self.xz, a.x, b.z);
        self.yy = less(self.yy, a.y, b.y);
        self.yz = less(self.yz, a.y, b.z);
        self.zz = less(self.zz, a.z, b.z);
    }
}

/// A number plus a b − c d.
#[inline(always)]
fn plus_minor<L: Lane>(to: L, (a, b): (L, L), (c, d): (L, L)) -> L {
    a.mul_add(b, (-c).mul_add(d, to))
}

/// A number less a·b.
#[inline(always)]
fn less<L: Lane>(from: L, a: Vector<L>, b: Vector<L>) -> L {
    (-a.x).mul_add(b.x, (-a.y).mul_add(b.y, (-a.z).mul_add(b.z, from)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::F64x1;

    fn lanes(m: &Matrix3<f64>) -> Matrix<F64x1> {
        let row = |r: usize| Vector::splat(Vec3::new(m[(r, 0)], m[(r, 1)], m[(r, 2)]));
        Matrix { x: row(0), y: row(1), z: row(2) }
    }

    fn single(m: &Matrix<F64x1>) -> Matrix3<f64> {
        Matrix3::from_rows(&[m.x, m.y, m.z].map(|row| row.get(0).transpose()))
    }

    fn symmetric(m: &Matrix3<f64>) -> Symmetric<F64x1> {
        let at = |r: usize, c: usize| F64x1::splat(m[(r, c)]);
        Symmetric { xx: at(0, 0), xy: at(0, 1), xz: at(0, 2), yy: at(1, 1), yz: at(1, 2), zz: at(2, 2) }
    }

    #[test]
    fn products_are_those_of_matrices() {
        let m = Matrix3::new(1.0, 2.0, -1.0, 0.5, 3.0, 2.0, -2.0, 0.25, 1.5);
        let d = Vec3::new(0.3, -0.7, 1.1);
        // b × d = −[d]× b.
        let lever = -d.cross_matrix();
        let close = |a: Matrix3<f64>, b: Matrix3<f64>| assert!((a - b).norm() < 1e-12, "{a} {b}");
        let s = m * m.transpose() + Matrix3::identity();
        close(single(&symmetric(&s).mul_lever(Vector::splat(d))), s * lever);
        close(single(&lanes(&m).mul_symmetric(&symmetric(&s))), m * s);
        let mut sum = symmetric(&s);
        sum.add_lever_product(Vector::splat(d), &lanes(&m));
        close(single(&sum.to_matrix()), s + (lever.transpose() * m + m.transpose() * lever) * 0.5);
        let mut less = symmetric(&s);
        less.subtract_product(&lanes(&m), &lanes(&m));
        close(single(&less.to_matrix()), s - m * m.transpose());
    }
    #[test]
    fn a_sum_with_the_identity_is_inverted() {
        let m = Matrix3::new(1.0, 2.0, -1.0, 0.5, 3.0, 2.0, -2.0, 0.25, 1.5);
        let q = m * m.transpose();
        for s in [0.0, 1e-3, 1.0, 1e6] {
            let inverse = (q + Matrix3::identity() * s).try_inverse().unwrap();
            let Shifted { part, inner, outer, det } = symmetric(&q).shifted(F64x1::splat(s));
            let part = single(&part.to_matrix());
            let found = (part + Matrix3::identity() * inner.get(0)) / det.get(0);
            assert!((found - inverse).norm() < 1e-12 * inverse.norm(), "{s}: {found} {inverse}");
            let (found, product) =
                ((Matrix3::identity() * outer.get(0) - part * s) / det.get(0), inverse * q);
            assert!((found - product).norm() < 1e-12 * product.norm(), "{s}: {found} {product}");
        }
    }
}

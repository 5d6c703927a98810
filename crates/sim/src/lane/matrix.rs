use super::vector::minor;
use super::{Lane, Vector};
use nalgebra::Matrix3;
use tousle_core::Vec3;

/// A symmetric 3 × 3 matrix for each of some strands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Symmetric<L> {
    pub xx: L,
    pub xy: L,
    pub xz: L,
    pub yy: L,
    pub yz: L,
    pub zz: L,
}

/// A 3 × 3 matrix for each of some strands, by rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Matrix<L> {
    pub x: Vector<L>,
    pub y: Vector<L>,
    pub z: Vector<L>,
}

impl<L: Lane> Symmetric<L> {
    pub fn zero() -> Self {
        Self::none(L::zero())
    }

    /// Zero, beside a number that there is.
    #[inline(always)]
    pub fn none(like: L) -> Self {
        Self::scaled_identity(like.same(0.0))
    }

    #[inline(always)]
    pub fn scaled_identity(s: L) -> Self {
        let o = s.same(0.0);
        Self { xx: s, xy: o, xz: o, yy: s, yz: o, zz: s }
    }

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

    #[inline(always)]
    pub fn mul_vector(&self, v: Vector<L>) -> Vector<L> {
        Vector::new(
            self.xx.mul_add(v.x, self.xy.mul_add(v.y, self.xz * v.z)),
            self.xy.mul_add(v.x, self.yy.mul_add(v.y, self.yz * v.z)),
            self.xz.mul_add(v.x, self.yz.mul_add(v.y, self.zz * v.z)),
        )
    }

    /// The inverse of a positive definite matrix, by cofactors.
    #[inline(always)]
    pub fn inverse(&self) -> Self {
        let cxx = minor(self.yy, self.zz, self.yz, self.yz);
        let cxy = minor(self.xz, self.yz, self.xy, self.zz);
        let cxz = minor(self.xy, self.yz, self.xz, self.yy);
        let one_over = cxx.same(1.0) / self.xx.mul_add(cxx, self.xy.mul_add(cxy, self.xz * cxz));
        Self {
            xx: cxx * one_over,
            xy: cxy * one_over,
            xz: cxz * one_over,
            yy: minor(self.xx, self.zz, self.xz, self.xz) * one_over,
            yz: minor(self.xy, self.xz, self.xx, self.yz) * one_over,
            zz: minor(self.xx, self.yy, self.xy, self.xy) * one_over,
        }
    }

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

    /// The transpose times a vector.
    #[inline(always)]
    pub fn transpose_mul(&self, v: Vector<L>) -> Vector<L> {
        self.x.mul_add(v.x, self.y.mul_add(v.y, self.z * v.z))
    }

    /// This times a symmetric matrix.
    #[inline(always)]
    pub fn mul_symmetric(&self, s: &Symmetric<L>) -> Self {
        Self { x: s.mul_vector(self.x), y: s.mul_vector(self.y), z: s.mul_vector(self.z) }
    }

    /// This times the matrix of b ↦ b × d: each row r becomes d × r.
    #[inline(always)]
    pub fn mul_lever(&self, d: Vector<L>) -> Self {
        Self { x: d.cross(self.x), y: d.cross(self.y), z: d.cross(self.z) }
    }

    /// The sum of two.
    #[inline(always)]
    pub fn add(&self, o: &Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }

    /// This times a number plus another.
    #[inline(always)]
    pub fn mul_add(&self, s: L, o: &Self) -> Self {
        Self { x: self.x.mul_add(s, o.x), y: self.y.mul_add(s, o.y), z: self.z.mul_add(s, o.z) }
    }

    #[inline(always)]
    pub fn scale(&self, s: L) -> Self {
        Self { x: self.x * s, y: self.y * s, z: self.z * s }
    }
}

impl<L: Lane> Symmetric<L> {
    /// s times this times another, for two that commute: symmetric itself.
    #[inline(always)]
    pub fn times_commuting(&self, o: &Self, s: L) -> Self {
        let x = o.mul_vector(Vector::new(self.xx, self.xy, self.xz)) * s;
        let y = o.mul_vector(Vector::new(self.xy, self.yy, self.yz)) * s;
        Self {
            xx: x.x,
            xy: x.y,
            xz: x.z,
            yy: y.y,
            yz: y.z,
            zz: s * self.xz.mul_add(o.xz, self.yz.mul_add(o.yz, self.zz * o.zz)),
        }
    }

    /// Adds a matrix and its transpose.
    #[inline(always)]
    pub fn add_with_transpose(&mut self, m: &Matrix<L>) {
        self.xx += m.x.x + m.x.x;
        self.xy += m.x.y + m.y.x;
        self.xz += m.x.z + m.z.x;
        self.yy += m.y.y + m.y.y;
        self.yz += m.y.z + m.z.y;
        self.zz += m.z.z + m.z.z;
    }

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

/// A number less a·b.
#[inline(always)]
fn less<L: Lane>(from: L, a: Vector<L>, b: Vector<L>) -> L {
    (-a.x).mul_add(b.x, (-a.y).mul_add(b.y, (-a.z).mul_add(b.z, from)))
}

impl<L: Lane> Matrix<L> {
    /// The transposed matrix of b ↦ b × d times this: each column c becomes d × c.
    #[inline(always)]
    pub fn lever_mul(&self, d: Vector<L>) -> Self {
        Self {
            x: self.z.mul_add(d.y, -(self.y * d.z)),
            y: self.x.mul_add(d.z, -(self.z * d.x)),
            z: self.y.mul_add(d.x, -(self.x * d.y)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::F64x1;

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
        close(single(&lanes(&m).mul_lever(Vector::splat(d))), m * lever);
        close(single(&lanes(&m).lever_mul(Vector::splat(d))), lever.transpose() * m);
        let s = m * m.transpose() + Matrix3::identity();
        close(single(&symmetric(&s).inverse().to_matrix()), s.try_inverse().unwrap());
        close(single(&lanes(&m).mul_symmetric(&symmetric(&s))), m * s);
        let inverse = s.try_inverse().unwrap();
        let commuting = symmetric(&inverse).times_commuting(&symmetric(&s), F64x1::splat(2.0));
        close(single(&commuting.to_matrix()), Matrix3::identity() * 2.0);
        let mut sum = symmetric(&s);
        sum.add_with_transpose(&lanes(&m));
        close(single(&sum.to_matrix()), s + m + m.transpose());
        let mut less = symmetric(&s);
        less.subtract_product(&lanes(&m), &lanes(&m));
        close(single(&less.to_matrix()), s - m * m.transpose());
    }
}

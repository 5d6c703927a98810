use crate::{Lane, MOST_LANES};
use core::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};
use tousle_core::Vec3;

/// A vector for each of some strands.
#[derive(Clone, Copy, Debug)]
pub struct Vector<L> {
    /// Along x.
    pub x: L,
    /// Along y.
    pub y: L,
    /// Along z.
    pub z: L,
}

impl<L: Lane> Vector<L> {
    /// Of its components.
    #[inline(always)]
    pub fn new(x: L, y: L, z: L) -> Self {
        Self { x, y, z }
    }

    /// Zero.
    pub fn zero() -> Self {
        Self::none(L::zero())
    }

    /// Zero, beside a number that there is.
    #[inline(always)]
    pub fn none(like: L) -> Self {
        let o = like.same(0.0);
        Self::new(o, o, o)
    }

    /// The same vector for all.
    pub fn splat(v: Vec3) -> Self {
        Self::same(L::zero(), v)
    }

    /// The same vector for all, beside a number that there is.
    #[inline(always)]
    pub fn same(like: L, v: Vec3) -> Self {
        Self::new(like.same(v.x), like.same(v.y), like.same(v.z))
    }

    /// The vector of one strand.
    #[inline(always)]
    pub fn get(&self, lane: usize) -> Vec3 {
        Vec3::new(self.x.get(lane), self.y.get(lane), self.z.get(lane))
    }

    /// Sets the vector of one strand.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, v: Vec3) {
        self.x.set(lane, v.x);
        self.y.set(lane, v.y);
        self.z.set(lane, v.z);
    }

    /// Puts all strands' vectors, in single precision, into rows of x, y and z, from a place on.
    #[inline(always)]
    pub fn put_single<const N: usize>(&self, rows: &mut [[f32; N]; 3], from: usize) {
        for (row, components) in rows.iter_mut().zip([self.x, self.y, self.z]) {
            components.to_single(&mut row[from..from + L::N]);
        }
    }

    /// Rounded to single precision.
    #[inline(always)]
    pub fn as_single(self) -> Self {
        let rounded = |component: L| {
            let mut numbers = [0.0; MOST_LANES];
            component.to_single(&mut numbers[..L::N]);
            component.of_single(&numbers[..L::N])
        };
        Self::new(rounded(self.x), rounded(self.y), rounded(self.z))
    }

    /// What [`Vector::put_single`] puts, beside a number that there is.
    #[inline(always)]
    pub fn of_single<const N: usize>(like: L, rows: &[[f32; N]; 3], from: usize) -> Self {
        let row = |axis: usize| like.of_single(&rows[axis][from..from + L::N]);
        Self::new(row(0), row(1), row(2))
    }

    /// The vector of one strand for each, as a function of its place.
    #[inline(always)]
    pub fn from_fn(mut f: impl FnMut(usize) -> Vec3) -> Self {
        let mut rows = [[0.0; MOST_LANES]; 3];
        for lane in 0..L::N {
            let vector = f(lane);
            for (row, component) in rows.iter_mut().zip(&vector) {
                row[lane] = *component;
            }
        }
        Self::new(
            L::from_fn(|lane| rows[0][lane]),
            L::from_fn(|lane| rows[1][lane]),
            L::from_fn(|lane| rows[2][lane]),
        )
    }

    /// This · o.
    #[inline(always)]
    pub fn dot(self, o: Self) -> L {
        self.x.mul_add(o.x, self.y.mul_add(o.y, self.z * o.z))
    }

    /// This × o.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            minor(self.y, o.z, self.z, o.y),
            minor(self.z, o.x, self.x, o.z),
            minor(self.x, o.y, self.y, o.x),
        )
    }

    /// This × o plus another.
    #[inline(always)]
    pub fn cross_add(self, o: Self, to: Self) -> Self {
        Self::new(
            self.y.mul_add(o.z, (-self.z).mul_add(o.y, to.x)),
            self.z.mul_add(o.x, (-self.x).mul_add(o.z, to.y)),
            self.x.mul_add(o.y, (-self.y).mul_add(o.x, to.z)),
        )
    }

    /// This times a number plus another.
    #[inline(always)]
    pub fn mul_add(self, by: L, to: Self) -> Self {
        Self::new(self.x.mul_add(by, to.x), self.y.mul_add(by, to.y), self.z.mul_add(by, to.z))
    }

    /// The smaller of each pair of components.
    #[inline(always)]
    pub fn min(self, o: Self) -> Self {
        Self::new(self.x.min(o.x), self.y.min(o.y), self.z.min(o.z))
    }

    /// The larger of each pair of components.
    #[inline(always)]
    pub fn max(self, o: Self) -> Self {
        Self::new(self.x.max(o.x), self.y.max(o.y), self.z.max(o.z))
    }

    /// The square of the length.
    #[inline(always)]
    pub fn norm_squared(self) -> L {
        self.dot(self)
    }

    /// The part of this at right angles to a unit vector.
    #[inline(always)]
    pub fn across(self, direction: Self) -> Self {
        direction.mul_add(-direction.dot(self), self)
    }

    /// This over its length.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        self * self.norm_squared().per_sqrt()
    }

    /// This over its length, where that differs from 1 by rounding errors and no more.
    #[inline(always)]
    pub fn normalized_again(self) -> Self {
        self * self.x.same(-0.5).mul_add(self.norm_squared(), self.x.same(1.5))
    }

    /// `yes` where `of` is above `bound`, else `no`.
    #[inline(always)]
    pub fn where_above(of: L, bound: L, yes: Self, no: Self) -> Self {
        Self::new(of.above(bound, yes.x, no.x), of.above(bound, yes.y, no.y), of.above(bound, yes.z, no.z))
    }
}

/// a b − c d.
#[inline(always)]
pub(crate) fn minor<L: Lane>(a: L, b: L, c: L, d: L) -> L {
    a.mul_add(b, -(c * d))
}

impl<L: Lane> Add for Vector<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<L: Lane> Sub for Vector<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<L: Lane> Neg for Vector<L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<L: Lane> Mul<L> for Vector<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: L) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<L: Lane> AddAssign for Vector<L> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<L: Lane> SubAssign for Vector<L> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

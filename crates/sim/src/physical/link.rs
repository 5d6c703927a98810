use super::contact::Bearing;
use tousle_lanes::{Lane, Matrix, Symmetric, Turn, Vector};

/// A stick and the point at its far end: what never changes. One number a strand of the batch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Link<L> {
    /// Length, m.
    pub length: L,
    /// Mass of the point at the far end, kg.
    pub mass: L,
    /// Stiffness of the joint at the near end, N·m; the same for bending and twist.
    pub stiffness: L,
    /// Internal damping over stiffness, s.
    pub damping_secs: L,
    /// Stiffness times the natural turn, as [`Turn::bend`], in the axes of the stick before, N·m.
    pub natural: Vector<L>,
    /// ½ ρ · width · length of the hair on the stick, kg/m: drag across over speed squared, but for the coefficient.
    pub drag: L,
    /// 10 (ν / width)^⅔, (m/s)^⅔: how much stronger drag is at low speeds.
    pub viscous: L,
    /// Rotary inertia of the stick, kg·m². It is that of a round bundle about its axis, some 1 % of what matters; it
    /// gives a stick without stiffness a definite twist.
    pub rotary: L,
}

/// Where a stick and its far point are at the end of a step, in the head's axes as they are then.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State<L> {
    /// Stick axes (x along it) to head axes.
    pub turn: Turn<L>,
    /// The far point, head space, m.
    pub place: Vector<L>,
    /// Its velocity over the ground, head axes, m/s.
    pub velocity: Vector<L>,
    /// The joint's turn, as [`Turn::bend`].
    pub bend: Vector<L>,
}

/// What bends and twists a joint: gradient and (Gauss-Newton) second derivative of its potential.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bending<L> {
    /// By a turn of the stick, head axes, N·m.
    pub torque: Vector<L>,
    /// N·m, the same in all directions.
    pub curvature: L,
}

/// Sticks' turns from the root outwards. A joint may be turned by more than half a turn: it does not matter to it which way
/// its sticks look alike, but how it came there, and the signs of their quaternions tell that. Beyond [`MOST_TURNED_W`] it
/// gives way: its sticks and all further out go by the other sign, so that it is turned the rest of a whole turn the other way.
pub(super) struct Unwinding<L> {
    /// The turn of the last stick.
    pub before: Turn<L>,
    sign: L,
}

/// A joint of [`Unwinding`]: its [`Turn::bend`], and −1 if it has just given way, else 1.
pub(super) struct Unwound<L> {
    pub bend: Vector<L>,
    pub sign: L,
}

/// w of the turn by 308° at which a joint gives way. Up to a whole turn its torque would grow without end.
const MOST_TURNED_W: f64 = -0.9;

impl<L: Lane> Unwinding<L> {
    /// Before the first stick.
    #[inline(always)]
    pub fn from_root(turn: Turn<L>) -> Self {
        Self { before: turn, sign: turn.w.same(1.0) }
    }

    /// The joint to the next stick.
    #[inline(always)]
    pub fn next(&mut self, turn: Turn<L>) -> Unwound<L> {
        let turn = turn.signed(self.sign);
        let relative = self.before.inverse().after(turn);
        let one = turn.w.same(1.0);
        let sign = relative.w.above(one.same(MOST_TURNED_W), one, -one);
        self.sign = self.sign * sign;
        self.before = turn.signed(sign);
        Unwound { bend: relative.signed(sign).bend(), sign }
    }
}

/// What a step prepares and its iterations read and write.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Work<L> {
    /// Where the point would be at the step's end if nothing but gravity pulled at it, m.
    pub drifting: Vector<L>,
    /// What its velocity is counted from: velocity = (place − from) / h.
    pub from: Vector<L>,
    /// The joint's stiffness and natural torque, internal damping included.
    pub stiffness: L,
    pub natural: Vector<L>,
    /// The field's vector at the stick's middle: wind, m/s, or a push, m/s².
    pub wind: Vector<L>,
    /// The present guess.
    pub turn: Turn<L>,
    pub direction: Vector<L>,
    pub place: Vector<L>,
    /// Gradient and second derivative, by the far point's place, of the potential of all that acts on it.
    pub slope: Vector<L>,
    pub hessian: Symmetric<L>,
    /// What bends the joint at the near end.
    pub joint: Bending<L>,
    /// What the sweep inwards leaves for the sweep outwards:
    /// turn = gain · joint's curvature · turn before − leverᵀ · displacement before − offset.
    pub gain: Symmetric<L>,
    pub lever: Matrix<L>,
    pub offset: Vector<L>,
}

impl<L: Lane> Work<L> {
    pub fn new() -> Self {
        let o = Vector::zero();
        Self {
            drifting: o,
            from: o,
            stiffness: L::zero(),
            natural: o,
            wind: o,
            turn: Turn::identity(L::one()),
            direction: o,
            place: o,
            slope: o,
            hessian: Symmetric::zero(),
            joint: Bending { torque: o, curvature: L::zero() },
            gain: Symmetric::zero(),
            lever: Matrix::zero(),
            offset: o,
        }
    }

    /// How far the far point is from where its velocity is counted from, m.
    #[inline(always)]
    pub fn way(&self) -> Vector<L> {
        self.place - self.from
    }

    /// The far point's velocity. `per_h`: its change for a change of place, 1/s.
    #[inline(always)]
    pub fn velocity(&self, per_h: L) -> Vector<L> {
        self.way() * per_h
    }

    /// A surface touches the far point.
    #[inline(always)]
    pub fn touch(&mut self, bearing: &Bearing<L>) {
        self.slope += bearing.slope;
        self.hessian.add(&bearing.hessian);
    }
}

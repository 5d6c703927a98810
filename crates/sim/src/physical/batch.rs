use super::contact::Touchable;
use super::link::{Link, State, Work};
use super::scene::Now;
use crate::extent::Extent;
use crate::parts::Count;
use tousle_lanes::{Lane, Turn, Vector};
use tousle_rod::DragLaw;

/// What all strands of a run share.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Model {
    /// π times the drag law's coefficient along a stick.
    pub along: f64,
    /// Whether there is air.
    pub air: bool,
    /// Whether the field's vectors push as they are, for want of air to push with.
    pub pushes: bool,
    /// The law by which a field of force per mass is read as wind; `None` for a field of wind.
    pub force_law: Option<DragLaw>,
    /// Coulomb's coefficient.
    pub friction: f64,
    /// An iteration cannot settle closer than this, m: rounding of places.
    pub resolution_m: f64,
}

impl Model {
    /// An iteration has settled when another would move no point farther, m: 0.03 mm at 120 steps a second, and less as
    /// the fourth power of shorter steps. What is left over acts like an acceleration of it over the square of the step,
    /// which so falls with the method's order.
    pub fn settled_m(&self, h_secs: f64) -> f64 {
        let shorter = f64::min(180.0 * h_secs, 1.0);
        self.felt_m(h_secs) * shorter * shorter
    }

    /// When no contact is felt to be off by more, m: less as the square of shorter steps. It rights itself.
    pub fn felt_m(&self, h_secs: f64) -> f64 {
        let steps = 180.0 * h_secs;
        (3e-5 * steps * steps).min(1e-4)
    }
}

/// Strands that are stepped together, one a lane.
#[derive(Clone, Debug)]
pub(crate) struct Batch<L> {
    /// How many there are; further lanes are not read.
    pub n_strands: usize,
    /// Where they grow, head space, m.
    pub root: Vector<L>,
    /// Axes of the first sticks at rest.
    pub root_turn: Turn<L>,
    /// Widths, m, and masses per length, kg/m, of each stick.
    pub widths_m: Vec<L>,
    pub densities: Vec<L>,
    pub links: Vec<Link<L>>,
    /// Now, and a step ago.
    pub states: Vec<State<L>>,
    pub states_before: Vec<State<L>>,
    pub touchable: Vec<Touchable<L>>,
    /// Spring of a contact, N/m, and one over it.
    pub contact_stiffness: L,
    pub contact_give: L,
    /// How much smaller an iteration's second update is than its first, squared, as it last was; it grows from step to
    /// step until it is measured again.
    pub contraction2: L,
    /// How far any point of each strand has gone, at most, since it was looked what may touch, m.
    pub went_m: L,
    /// Whether nothing has moved yet.
    pub at_rest: bool,
    /// How many implicit steps have been taken since.
    pub n_moved: u64,
    /// Where the strands asked the field, if that is to be known.
    pub asked: Option<Extent<L>>,
    pub count: Count,
}

impl<L: Lane> Batch<L> {
    /// Room for a step's work.
    pub fn make_room(&self, work: &mut Vec<Work<L>>) {
        if work.len() != self.links.len() {
            work.resize(self.links.len(), Work::new());
        }
    }

    /// [`Touchable::look`] for all: finds the points that may touch in this step, or, `again`, more of them. A strand whose margin is minus infinity does not look: each does when it would alone.
    #[inline(always)]
    pub fn look(&mut self, work: &[Work<L>], now: &Now<'_>, margin_m: L, again: bool) {
        for touchable in &mut self.touchable {
            let places = work.iter().map(|work| work.place);
            touchable.look(&now.surfaces[touchable.collider], places, (margin_m, self.went_m), again);
        }
        self.went_m = margin_m.same(0.0);
    }
}

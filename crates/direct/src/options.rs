use tousle_core::Quantity;
use tousle_edit::EditOptions;

/// How edits become layers.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectOptions {
    /// Which equations.
    pub method: EditMethod,
    /// What E4 needs besides.
    pub paper: EditOptions,
    /// A key is met if its point is no farther from it than this, m, > 0.
    pub tolerance_m: f64,
    /// The longest extra vector, in the field's quantity.
    pub limit: f64,
    /// How often strands' acceleration and jerk may be their unedited peaks before a smoother answer is looked for.
    pub peak_ratio: f64,
}

/// Which equations turn a drag into layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum EditMethod {
    /// E4 of Kazama, Sugisaki and Morishima (2008): the force that carries a free particle to the target.
    Paper,
    /// The smallest and smoothest extra vectors with which the simulated strand is at its keys.
    #[default]
    Physical,
}

impl DirectOptions {
    /// The defaults for a field of a quantity.
    ///
    /// The limits are a storm's wind, and what such a wind pushes a usual lock with.
    pub fn for_quantity(quantity: Quantity) -> Self {
        let (method, limit) = match quantity {
            Quantity::AirVelocity => (EditMethod::Physical, 60.0),
            Quantity::ForcePerMass => (EditMethod::Paper, 600.0),
        };
        Self { method, paper: EditOptions::default(), tolerance_m: 1e-3, limit, peak_ratio: 1.5 }
    }
}

impl EditMethod {
    /// Every method.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Physical];

    /// The name used on the command line, in layers and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => tousle_edit::METHOD,
            Self::Physical => "physical",
        }
    }

    /// What it makes of a drag, for people.
    pub fn about(self) -> &'static str {
        match self {
            Self::Paper => "a pull towards the key that is not solved to meet it, the paper's E4",
            Self::Physical => {
                "the smallest and smoothest extra wind with which the simulated strand meets its key"
            }
        }
    }

    /// The method of a name that [`EditMethod::name`] gives.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }
}

use tousle_field::GridError;

/// What makes a `.npz` unusable.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NpzError {
    /// The bytes are no zip archive, or a damaged one.
    #[error("not a readable .npz, which is a zip archive of .npy arrays")]
    Zip(#[from] zip::result::ZipError),
    /// Two members of the archive share a name.
    #[error("found two members of one name, expected each array once")]
    TwiceTheSame,
    /// An array is not there.
    #[error("found arrays {found:?}, expected one called `{key}`")]
    MissingKey {
        /// The array's name.
        key: &'static str,
        /// The names that are there.
        found: Vec<String>,
    },
    /// An array's header cannot be understood.
    #[error("array `{key}`: {problem}")]
    Header {
        /// The array's name.
        key: String,
        /// What was found and expected.
        problem: String,
    },
    /// An array is of a type that cannot stand for what it should hold.
    #[error("array `{key}`: found type {found}, expected {expected}")]
    BadType {
        /// The array's name.
        key: String,
        /// NumPy's name of the type.
        found: String,
        /// What would do.
        expected: &'static str,
    },
    /// An array's shape does not fit.
    #[error("array `{key}`: found shape {found:?}, expected {expected}")]
    BadShape {
        /// The array's name.
        key: String,
        /// Its shape.
        found: Vec<usize>,
        /// What would fit.
        expected: String,
    },
    /// An array is larger than the reader was allowed to load.
    #[error("array `{key}`: found shape {shape:?}, expected at most {limit} bytes")]
    TooLarge {
        /// The array's name.
        key: String,
        /// Its shape.
        shape: Vec<usize>,
        /// The most bytes.
        limit: u64,
    },
    /// An array's values cannot be read: its bytes end early, or are damaged.
    #[error("array `{key}`: value {value} of {expected} cannot be read")]
    Cut {
        /// The array's name.
        key: String,
        /// The first value that cannot be read, in file order.
        value: usize,
        /// How many there should be.
        expected: usize,
        /// What the archive says.
        source: std::io::Error,
    },
    /// A value is outside what it can be, or no number at all.
    #[error("array `{key}` at {index:?}: found {found}, expected {expected}")]
    BadValue {
        /// The array's name.
        key: String,
        /// The value's place along each axis.
        index: Vec<usize>,
        /// The value.
        found: f64,
        /// What it should be.
        expected: String,
    },
    /// Time stands still or runs backwards.
    #[error("array `t` at [{index}]: found {found} s, expected more than the {before} s of the step before")]
    FallingTime {
        /// The step.
        index: usize,
        /// Its time, s.
        found: f64,
        /// That of the step before, s.
        before: f64,
    },
    /// Time steps are not evenly spaced.
    #[error(
        "array `t` at [{index}]: found {found} s, expected {expected} s as of even steps (to 2 % of one)"
    )]
    UnevenTime {
        /// The step.
        index: usize,
        /// Its time, s.
        found: f64,
        /// Its time if steps were even, s.
        expected: f64,
    },
    /// The quantity is none that is known.
    #[error("array `quantity`: found {found:?}, expected \"air_velocity\" or \"force_per_mass\"")]
    BadQuantity {
        /// What is there.
        found: String,
    },
    /// The grid is impossible.
    #[error(transparent)]
    Grid(#[from] GridError),
}

/// What keeps a mesh from being a body.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The bytes are no OBJ file.
    #[error("line {line}: cannot read the OBJ file")]
    Obj {
        /// How many lines could be read, the one that could not included.
        line: usize,
        /// What the reader says.
        source: tobj::LoadError,
    },
    /// The mesh holds something that a body cannot.
    #[error("{what}: found {found}, expected {expected}")]
    Bad {
        /// What it is about.
        what: &'static str,
        /// What it is.
        found: String,
        /// What it should be.
        expected: &'static str,
    },
    /// All hair begins deep inside the mesh.
    #[error(
        "found a mesh {across_m:.3} m across, inside which all hair begins at least {depth_m:.3} m deep, expected a body with \
         hair on its surface, or at most {limit_m} m below: is it in another unit?"
    )]
    Swallows {
        /// The longest side of the upright box around it, m.
        across_m: f64,
        /// How far below the surface the least deep root is, m.
        depth_m: f64,
        /// How far below it may be, m.
        limit_m: f64,
    },
    /// The mesh cannot be made ready to be asked for distances.
    #[error("cannot measure distances from the mesh")]
    Distances(#[from] parry3d_f64::shape::TriMeshBuilderError),
}

pub(crate) fn bad(what: &'static str, found: impl std::fmt::Display, expected: &'static str) -> MeshError {
    MeshError::Bad { what, found: found.to_string(), expected }
}

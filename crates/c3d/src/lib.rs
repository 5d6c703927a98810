//! C3D bytes to and from C3D records, nothing more.

//! Groom files to a Groom.

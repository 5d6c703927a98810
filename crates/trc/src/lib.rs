//! TRC bytes to TRC records, nothing more.

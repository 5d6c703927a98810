//! Opens files, runs the stages in order, gathers their reports, writes whole files or none.

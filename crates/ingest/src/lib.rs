//! Any marker bytes to one Capture; session files to a Session.

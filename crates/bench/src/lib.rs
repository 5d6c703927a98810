//! Accuracy scores against truth, and error against run time.

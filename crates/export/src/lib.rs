//! Motions and fields to files for other tools: .npz, .usda.

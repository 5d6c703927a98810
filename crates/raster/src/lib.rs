//! WindSamples to FieldSequence: scattered vectors fill the grid.

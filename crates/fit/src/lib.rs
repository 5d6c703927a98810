//! HeadCapture to WindSamples: what force or wind explains the motion of each lock.

//! Eight head markers give the pose: Capture to HeadCapture.

// What has to hold for any bytes whatever; the fuzz target includes this file too.

/// Takes bytes for a TRC.
///
/// # Panics
/// If a trajectory is not as long as the frames say, if a number is no number, or if an error says nothing.
pub fn exercise(bytes: &[u8]) {
    let _ = tousle_trc::detect(bytes);
    let trc = match tousle_trc::read(bytes) {
        Ok(trc) => trc,
        Err(e) => return assert!(!e.to_string().is_empty()),
    };
    assert!(trc.warnings.iter().all(|w| !w.is_empty()));
    assert_eq!(trc.times_secs.len(), trc.frames.len());
    assert_eq!(trc.lines.len(), trc.frames.len());
    for marker in &trc.markers {
        assert!(!marker.label.is_empty());
        assert_eq!(marker.positions.len(), trc.frames.len());
        assert!(marker.positions.iter().flatten().flatten().all(|x| x.is_finite()));
    }
    // Memory is bounded by the file: no header can ask for more than its rows bear out.
    assert!(trc.markers.len() * trc.frames.len() <= 2 * bytes.len());
}

// What has to hold for any bytes whatever; the fuzz target includes this file too.

use tousle_csv::{PointTable, motive, vicon};

/// Takes bytes for a Vicon CSV and for a Motive CSV.
///
/// # Panics
/// If a table is not as long as its frames say, if a number is no number, or if an error says nothing.
pub fn exercise(bytes: &[u8]) {
    let (_, _) = (vicon::detect(bytes), motive::detect(bytes));
    match vicon::read(bytes) {
        Ok(file) => {
            assert!(!file.sections.is_empty());
            assert!(file.warnings.iter().all(|w| !w.is_empty()));
            for section in &file.sections {
                assert!(section.rate_hz.is_none_or(f64::is_finite));
                check(&section.table, bytes);
            }
        }
        Err(e) => assert!(!e.to_string().is_empty()),
    }
    match motive::read(bytes) {
        Ok(file) => {
            assert!(file.warnings.iter().all(|w| !w.is_empty()));
            assert_eq!(file.times_secs.len(), file.table.frames.len());
            check(&file.table, bytes);
        }
        Err(e) => assert!(!e.to_string().is_empty()),
    }
}

fn check(table: &PointTable, bytes: &[u8]) {
    assert_eq!(table.lines.len(), table.frames.len());
    for point in &table.points {
        assert_eq!(point.positions.len(), table.frames.len());
        assert!(point.positions.iter().flatten().flatten().all(|x| x.is_finite()));
    }
    // Memory is bounded by the file: no header can ask for more than its rows bear out.
    assert!(table.points.len() * table.frames.len() <= 2 * bytes.len());
}

//! The captures' true wind, from NumPy's own files. Needs `TOUSLE_SHARED`, the folder that holds `captures`.

use std::path::{Path, PathBuf};

use tousle_core::Quantity;
use tousle_export::{FieldNpzOptions, read_field_npz_with, read_motion_npz};

fn captures() -> Option<PathBuf> {
    let Some(shared) = std::env::var_os("TOUSLE_SHARED") else {
        println!("skipped: TOUSLE_SHARED is not set");
        return None;
    };
    Some(Path::new(&shared).join("captures"))
}

#[test]
fn the_true_wind_and_motion_of_every_capture_load() {
    let Some(captures) = captures() else { return };
    let mut options = FieldNpzOptions::default();
    options.extent_m = Some(0.6);
    options.quantity = Some(Quantity::AirVelocity);
    for name in ["gusts_left", "nod_turn", "steady_front", "sweep_0_120", "turbulent_dirty", "two_fans"] {
        let truth = captures.join(name).join("truth");
        let field =
            read_field_npz_with(&std::fs::read(truth.join("field.npz")).unwrap(), &options).unwrap().field;
        field.check().unwrap();
        assert_eq!((field.grid.dims, field.rate_hz), ([30; 3], 30.0), "{name}");
        let motion = read_motion_npz(&std::fs::read(truth.join("style_b.npz")).unwrap()).unwrap();
        assert_eq!(motion.times_secs.len(), 2 * field.steps.len(), "{name}: 60 Hz beside 30 Hz");
        assert_eq!(motion.counts.len(), 60, "{name}");
    }
}

//! Steps of a field as OpenVDB files: what a reader of the format comes across, front to back.

#![allow(clippy::unwrap_used, reason = "a helper of tests may panic as a test may")]

use tousle_core::{Quantity, Vec3};
use tousle_export::{ExportError, write_step_vdb};
use tousle_field::{Field, FieldSequence, GridSpec, VoxelFlag};

/// One leaf of 2 x 1 x 1 voxels.
fn field() -> FieldSequence {
    let step = |x: f32| Field {
        u: vec![x, 1.0, 2.0, 3.0, 4.0, 5.0],
        flags: vec![VoxelFlag::Measured, VoxelFlag::Outside],
        sd: None,
        outside: Vec3::new(3.0, 0.0, 0.0),
    };
    FieldSequence {
        grid: GridSpec { origin_m: Vec3::new(-0.5, 0.0, 0.0), edge_m: 0.5, dims: [2, 1, 1] },
        quantity: Quantity::AirVelocity,
        start_secs: 0.0,
        rate_hz: 4.0,
        steps: vec![step(0.0), step(0.5)],
        layers: Vec::new(),
    }
}

/// Takes a file apart as the format says, and nothing else.
struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> &'a [u8] {
        self.at += n;
        &self.bytes[self.at - n..self.at]
    }

    fn u32(&mut self) -> u32 {
        u32::from_le_bytes(self.take(4).try_into().unwrap())
    }

    fn i64(&mut self) -> i64 {
        i64::from_le_bytes(self.take(8).try_into().unwrap())
    }

    fn f64(&mut self) -> f64 {
        f64::from_le_bytes(self.take(8).try_into().unwrap())
    }

    fn text(&mut self) -> &'a str {
        let n = self.u32() as usize;
        str::from_utf8(self.take(n)).unwrap()
    }

    /// Names, types and bytes.
    fn metadata(&mut self) -> Vec<(&'a str, &'a str, &'a [u8])> {
        (0..self.u32())
            .map(|_| {
                let (name, kind, n) = (self.text(), self.text(), self.u32() as usize);
                (name, kind, self.take(n))
            })
            .collect()
    }
}

#[test]
fn a_file_front_to_back() {
    let mut bytes = Vec::new();
    write_step_vdb(&field(), 1, &mut bytes).unwrap();
    let mut file = Reader { bytes: &bytes, at: 0 };
    assert_eq!(file.i64(), 0x5644_4220);
    assert_eq!(file.u32(), 224);
    file.take(8 + 1 + 36);
    let time = file.metadata().into_iter().find(|(name, ..)| *name == "time_secs").unwrap();
    assert_eq!((time.1, time.2), ("double", 0.25_f64.to_le_bytes().as_slice()));

    assert_eq!(file.u32(), 2, "grids");
    for (name, tree, values) in [
        ("wind", "Tree_vec3s_5_4_3", &[0.5_f32, 2.0, 4.0, 1.0, 3.0, 5.0][..]),
        ("flag", "Tree_float_5_4_3", &[2.0, 0.0]),
    ] {
        assert_eq!((file.text(), file.text(), file.text()), (name, tree, ""));
        let [grid_at, leaves_at, end] = [file.i64(), file.i64(), file.i64()].map(|x| x as usize);
        assert_eq!(file.at, grid_at);
        assert_eq!(file.u32(), 3, "zip and active mask");
        let metadata = file.metadata();
        assert!(metadata.is_sorted_by_key(|(name, ..)| *name));
        assert!(metadata.contains(&("name", "string", name.as_bytes())));
        assert_eq!(file.text(), "UniformScaleTranslateMap");
        let map: Vec<f64> = (0..18).map(|_| file.f64()).collect();
        // Half an edge beyond the corner; then scale, size, 1 / scale, its square, its half.
        let expected = [[-0.25, 0.25, 0.25], [0.5; 3], [0.5; 3], [2.0; 3], [4.0; 3], [1.0; 3]];
        assert_eq!(map, expected.concat());
        assert_eq!(file.u32(), 1, "buffers");
        let n = values.len() / 2;
        assert_eq!(file.take(4 * n), vec![0; 4 * n], "background");
        assert_eq!((file.u32(), file.u32()), (0, 1), "tiles, children");
        file.at = leaves_at;
        let mask = file.take(64);
        assert_eq!((mask[0], mask[8]), (1, 1), "x is bits 0 and 64");
        assert_eq!(file.take(1), [0]);
        assert_eq!(file.i64(), -(4 * values.len() as i64));
        let raw: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        assert_eq!(file.take(raw.len()), raw);
        assert_eq!(file.at, end);
    }
    assert_eq!(file.at, bytes.len());
}

#[test]
fn the_same_step_gives_the_same_bytes_and_another_does_not() {
    let bytes = |step| {
        let mut bytes = Vec::new();
        write_step_vdb(&field(), step, &mut bytes).unwrap();
        bytes
    };
    assert_eq!(bytes(0), bytes(0));
    assert_ne!(bytes(0)[21..57], bytes(1)[21..57], "the UUID");
}

#[test]
fn a_step_that_is_not_there() {
    let error = write_step_vdb(&field(), 2, Vec::new()).unwrap_err();
    assert!(matches!(error, ExportError::BadOptions { .. }));
    assert_eq!(error.to_string(), "options: found step 2, expected one below 2");
}

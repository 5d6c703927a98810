//! Single steps and parts are read without the rest.

use crate::arbitrary::{scene, small, small_file, step};
use std::cell::Cell;
use std::io::{Cursor, Read, Seek, SeekFrom};
use tousle_core::{Quantity, Vec3};
use tousle_eff::{Eff, EffError, Part, ReadOptions, Reader, WriteOptions, Writer};
use tousle_field::GridSpec;

#[test]
fn steps_poses_samples_and_edits_are_those_that_were_written() {
    let eff = small();
    let mut reader = Reader::open(Cursor::new(small_file())).unwrap();
    assert_eq!(reader.n_steps(), 5);
    for k in [4, 0, 2, 3, 1] {
        assert_eq!(reader.step(k).unwrap().unwrap(), eff.field.steps[k as usize]);
    }
    assert_eq!(reader.step(5).unwrap(), None);
    assert_eq!(reader.poses().unwrap(), eff.scene.poses.poses);
    assert_eq!(Some(reader.samples().unwrap()), eff.samples.map(|s| s.steps));
    assert_eq!(reader.layers(), eff.field.layers);
}

#[test]
fn a_part_samples_as_the_whole_does() {
    let whole = small();
    let mut reader = Reader::open(Cursor::new(small_file())).unwrap();
    let (low, high) = (Vec3::new(-0.13, -0.06, -0.1), Vec3::new(0.04, 0.02, 0.1));
    let part = Part::default().within_secs(0.04, 0.09).within_box_m(low, high);
    let part = reader.part(&part, &ReadOptions::default()).unwrap();
    assert_eq!(part.field.grid.dims, [3, 3, 2]);
    assert_eq!(part.field.steps.len(), 3);
    assert_eq!(part.scene, whole.scene);
    part.field.check().unwrap();
    for t in [0.04, 0.05, 0.0666, 0.08, 0.09] {
        for s in [0.0, 0.17, 0.5, 0.77, 1.0] {
            let point = low + (high - low).component_mul(&Vec3::new(s, 1.0 - s, s * s));
            let difference = part.field.at(t).sample(point) - whole.field.at(t).sample(point);
            assert!(difference.norm() < 1e-6, "{t} {point}");
        }
    }
}

/// Counts what is read.
struct Counting<'a> {
    inner: Cursor<Vec<u8>>,
    n_read: &'a Cell<u64>,
}

impl Read for Counting<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let n = self.inner.read(bytes)?;
        self.n_read.set(self.n_read.get() + n as u64);
        Ok(n)
    }
}

impl Seek for Counting<'_> {
    fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
        self.inner.seek(to)
    }
}

/// Three hundred steps written one by one; one is read, and little else.
#[test]
fn one_step_of_many_is_read_alone() {
    let grid = GridSpec::cube(0.6, 0.05).unwrap();
    let scene = scene();
    let head = tousle_eff::Head {
        name: "long",
        method: "test",
        generator: "test",
        grid,
        quantity: Quantity::AirVelocity,
        start_secs: 1.0,
        rate_hz: 30.0,
        n_steps: None,
        layers: &[],
        scene: &scene,
        samples: None,
    };
    let mut writer = Writer::new(Vec::new(), &head, &WriteOptions::default()).unwrap();
    for k in 0..300 {
        writer.step(&step(&grid, f64::from(k))).unwrap();
    }
    let (report, bytes) = writer.finish().unwrap();
    assert_eq!((report.n_steps, report.n_bytes), (300, bytes.len() as u64));
    let n_read = Cell::new(0);
    let mut reader = Reader::open(Counting { inner: Cursor::new(bytes), n_read: &n_read }).unwrap();
    assert_eq!(reader.manifest().field.n_steps, None);
    n_read.set(0);
    assert_eq!(reader.step(217).unwrap().unwrap(), step(&grid, 217.0));
    assert!(n_read.get() < 2 * report.n_bytes / 300, "{} of {} bytes", n_read.get(), report.n_bytes);
}

#[test]
fn a_writer_that_is_dropped_leaves_a_cut_file() {
    let eff: Eff = small();
    let mut bytes = Vec::new();
    let head = tousle_eff::Head {
        name: "cut",
        method: "test",
        generator: "test",
        grid: eff.field.grid,
        quantity: Quantity::AirVelocity,
        start_secs: 0.0,
        rate_hz: 30.0,
        n_steps: None,
        layers: &[],
        scene: &eff.scene,
        samples: None,
    };
    let mut writer = Writer::new(&mut bytes, &head, &WriteOptions::default()).unwrap();
    writer.step(&eff.field.steps[0]).unwrap();
    drop(writer);
    let error = Reader::open(Cursor::new(&bytes)).unwrap_err();
    assert!(error.to_string().starts_with("cut: "), "{error}");
}

#[test]
fn damage_is_noticed_where_it_is_read() {
    let sound = small_file();
    for at in (0..sound.len()).step_by(3) {
        let mut bytes = sound.clone();
        bytes[at] ^= 0x10;
        // Whatever is not read may be damaged; what is read is right or refused.
        let Ok(mut reader) = Reader::open(Cursor::new(&bytes)) else { continue };
        match reader.step(3) {
            Ok(step) => assert_eq!(step.unwrap(), small().field.steps[3], "{at}"),
            Err(EffError::Unsound(_)) => {}
            Err(other) => panic!("{at}: {other}"),
        }
    }
    for length in 0..sound.len() {
        assert!(Reader::open(Cursor::new(&sound[..length])).is_err(), "{length}");
    }
}

//! A head of hair that nods, as files for other tools: `cargo run -p tousle-export --example 1_motion_for_other_tools
//! -- FOLDER`.
//!
//! Writes `motion.npz` (NumPy), `curves.usda` (thin curves in head space), `smooth.usda` (the same as splines) and
//! `reeds.usda` (the paper's ribbons, carried by the head into the world, with the body as guides).

use std::fs::File;
use std::io::{BufWriter, Error};
use std::path::Path;

use nalgebra::UnitQuaternion;
use tousle_core::{Attachment, Body, Collider, Groom, Pose, PoseTrack, Shape, Strand, StrandMotion, Vec3};
use tousle_export::{CurveType, HairGeometry, UsdOptions, write_motion_npz, write_motion_usda};
use tousle_field::Scene;

const N_STRANDS: u8 = 60;
const N_POINTS: u8 = 12;
const N_FRAMES: u8 = 48;
const RATE_HZ: f64 = 24.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or_else(|| Error::other("found no folder, expected one"))?;
    let folder = Path::new(&folder);
    std::fs::create_dir_all(folder)?;
    let groom = groom();
    let motion = motion(&groom);
    let scene = scene();

    let file = |name: &str| File::create(folder.join(name));
    write_motion_npz(&motion, BufWriter::new(file("motion.npz")?))?;
    write_motion_usda(&motion, &groom, &UsdOptions::default(), file("curves.usda")?)?;

    let mut smooth = UsdOptions::default();
    smooth.curve_type = CurveType::CatmullRom;
    smooth.geometry = HairGeometry::Both;
    write_motion_usda(&motion, &groom, &smooth, file("smooth.usda")?)?;

    let mut reeds = UsdOptions::default();
    reeds.geometry = HairGeometry::Reeds;
    reeds.width_scale = 2.0;
    reeds.scene = Some(&scene);
    reeds.in_world = true;
    reeds.with_body = true;
    write_motion_usda(&motion, &groom, &reeds, file("reeds.usda")?)?;
    println!("{} strands, {} frames: {}", groom.strands.len(), motion.times_secs.len(), folder.display());
    Ok(())
}

/// Strands that leave the back of a head outwards and then hang.
fn groom() -> Groom {
    let strand = |k: u8| {
        let (sin, cos) = libm::sincos(f64::from(k) * 2.4);
        let height = f64::from(k) / f64::from(N_STRANDS) * 0.9;
        let ring = libm::sqrt(1.0 - height * height);
        let root = Vec3::new(-0.095 * (0.3 + 0.7 * cos.abs()) * ring, 0.08 * sin * ring, 0.11 * height);
        let point = |p: u8| {
            let share = f64::from(p) / f64::from(N_POINTS - 1);
            root * (1.0 + 0.35 * share.min(0.3)) - Vec3::z() * (0.28 * share * share)
        };
        Strand {
            name: format!("S{:02}", k + 1),
            rest_curve_m: (0..N_POINTS).map(point).collect(),
            length_m: 0.3,
            linear_density_kg_per_m: 2e-3,
            lock_width_m: 0.006,
            bending_stiffness_n_m2: 5e-6,
            internal_damping_secs: 0.02,
            along: tousle_core::Along::default(),
            holds_style: false,
        }
    };
    Groom { strands: (0..N_STRANDS).map(strand).collect(), assumed: Vec::new() }
}

/// The groom as it sways from side to side, more so towards the tips.
fn motion(groom: &Groom) -> StrandMotion {
    let mut positions_m = Vec::new();
    for frame in 0..N_FRAMES {
        let sway = 0.08 * libm::sin(f64::from(frame) * 0.26);
        for strand in &groom.strands {
            for (k, p) in strand.rest_curve_m.iter().enumerate() {
                let share = k as f64 / f64::from(N_POINTS - 1);
                positions_m.push([p.x as f32, (p.y + sway * share * share) as f32, p.z as f32]);
            }
        }
    }
    let times_secs = (0..N_FRAMES).map(|k| f64::from(k) / RATE_HZ).collect();
    StrandMotion { counts: groom.counts(), times_secs, positions_m }
}

/// A head at the height of someone standing, nodding, on a neck and shoulders.
fn scene() -> Scene {
    let pose = |k: u8| {
        let nod = 0.3 * libm::sin(f64::from(k) * 0.13);
        Pose::from_parts(Vec3::new(0.0, 0.0, 1.6).into(), UnitQuaternion::from_euler_angles(0.0, nod, 0.0))
    };
    let head = Shape::Ellipsoid { center_m: Vec3::zeros(), half_axes_m: Vec3::new(0.095, 0.08, 0.115) };
    let neck = Shape::Capsule {
        a_m: Vec3::new(-0.02, 0.0, -0.08),
        b_m: Vec3::new(-0.03, 0.0, -0.2),
        radius_m: 0.055,
    };
    let collider = |name: &str, shape, attachment| Collider { name: name.into(), shape, attachment };
    Scene {
        poses: PoseTrack { start_secs: 0.0, rate_hz: RATE_HZ, poses: (0..N_FRAMES).map(pose).collect() },
        rest_pose: pose(0),
        gravity_world: Vec3::new(0.0, 0.0, -9.81),
        air_density: 1.2,
        body: Body {
            colliders: vec![
                collider("head", head, Attachment::Head),
                collider("neck", neck, Attachment::Torso),
            ],
            pivot_m: Vec3::new(-0.02, 0.0, -0.11),
            friction: 0.25,
        },
    }
}

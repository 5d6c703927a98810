//! Previews: the wind as points that a viewer of robots' logs can draw, and the head's frame.
//!
//! A vector is a row of points from a voxel's center along the way that the air goes, colored by its length: viewers
//! draw points everywhere and arrows hardly anywhere. Everything here is made from the rest of the file; a reader loses
//! nothing by skipping it.

mod check;

use crate::format::{Stream, topic};
use crate::manifest::Manifest;
use crate::wire::foxglove::{
    FLOAT32, FrameTransform, PackedElementField, PointCloud, Pose as WirePose, Timestamp, UINT8,
};
use crate::wire::proto::{Quaternion, Vector3};
pub(crate) use check::check;
use tousle_core::{Pose, PoseTrack, Quantity};
use tousle_field::{Field, FieldLayer, GridSpec, VoxelFlag, VoxelIndex};

/// The descriptors of Foxglove's messages.
const DESCRIPTORS: &[u8] = include_bytes!("../../../schemas/preview.binpb");

const fn stream(topic: &'static str, schema_name: &'static str) -> Stream {
    let (message_encoding, schema_encoding) = ("protobuf", "protobuf");
    Stream { version: 1, topic, message_encoding, schema_name, schema_encoding, schema: DESCRIPTORS }
}

/// The channels of previews.
pub(crate) static PREVIEWS: [Stream; 2] = [
    stream(topic::PREVIEW_HEAD, "foxglove.FrameTransform"),
    stream(topic::PREVIEW_WIND, "foxglove.PointCloud"),
];

/// The frames of the previews.
const WORLD: &str = "world";
const HEAD: &str = "head";

/// The most vectors shown of a step: more are slow to draw and hide one another.
const MAX_VECTORS: usize = 1000;
/// Points a vector.
const N_POINTS: usize = 6;
/// Bytes a point: three floats and four bytes of color.
const STRIDE: usize = 16;

/// What previews are made from besides a step.
#[derive(Clone, Debug)]
pub(crate) struct Preview {
    grid: GridSpec,
    /// The voxels that are shown.
    voxels: Vec<usize>,
    /// The length at which a vector reaches the next one that is shown, and is red.
    full: f64,
    /// Distance between voxels that are shown, m.
    spacing_m: f64,
    poses: PoseTrack,
    layers: Vec<FieldLayer>,
}

impl Preview {
    pub fn new(manifest: &Manifest, poses: &[Pose], layers: Vec<FieldLayer>) -> Self {
        let grid = manifest.field.grid.spec();
        let count = |every: usize| grid.dims.iter().map(|n| n.div_ceil(every)).product::<usize>();
        let every = (1..).find(|every| count(*every) <= MAX_VECTORS).unwrap_or(1);
        let shown = |n: usize| (every / 2..n.max(every / 2 + 1)).step_by(every).map(move |k| k.min(n - 1));
        let [nx, ny, nz] = grid.dims;
        let voxels = shown(nx).flat_map(|x| {
            shown(ny).flat_map(move |y| shown(nz).map(move |z| grid.flat(VoxelIndex([x, y, z]))))
        });
        Self {
            grid,
            voxels: voxels.collect(),
            full: match manifest.field.quantity.into() {
                Quantity::AirVelocity => 6.0,
                Quantity::ForcePerMass => 12.0,
            },
            spacing_m: every as f64 * grid.edge_m,
            poses: PoseTrack {
                start_secs: manifest.pose.start_secs,
                rate_hz: manifest.pose.rate_hz,
                poses: poses.to_vec(),
            },
            layers,
        }
    }

    /// Where the head is.
    pub fn head(&self, time_ns: u64, secs: f64) -> FrameTransform {
        let pose = self.poses.motion_at(secs).world_from_head;
        let ([x, y, z], [qx, qy, qz, qw]): ([f64; 3], [f64; 4]) =
            (pose.translation.vector.into(), pose.rotation.coords.into());
        FrameTransform {
            timestamp: Some(Timestamp::from_ns(time_ns)),
            parent_frame_id: WORLD.into(),
            child_frame_id: HEAD.into(),
            translation: Some(Vector3 { x, y, z }),
            rotation: Some(Quaternion { x: qx, y: qy, z: qz, w: qw }),
        }
    }

    /// The wind of a step, with its edits.
    pub fn wind(&self, time_ns: u64, secs: f64, step: &Field) -> PointCloud {
        let mut data = Vec::with_capacity(self.voxels.len() * N_POINTS * STRIDE);
        for &flat in &self.voxels {
            let center_m = self.grid.cell_center_m(self.grid.unflat(flat));
            let under = |vector, l: &FieldLayer| l.apply(center_m, l.presence(secs), vector);
            let share = self.layers.iter().fold(step.vector(flat), under) / self.full;
            let color = color(share.norm(), step.flags[flat]);
            for k in 0..N_POINTS {
                let along = k as f64 / (N_POINTS - 1) as f64;
                let point_m = center_m + share * (self.spacing_m * along);
                data.extend(point_m.iter().flat_map(|c| (*c as f32).to_le_bytes()));
                data.extend(color);
            }
        }
        let field = |name: &str, offset, kind| PackedElementField { name: name.into(), offset, kind };
        PointCloud {
            timestamp: Some(Timestamp::from_ns(time_ns)),
            frame_id: HEAD.into(),
            pose: Some(WirePose {
                position: Some(Vector3::default()),
                orientation: Some(Quaternion { w: 1.0, ..Quaternion::default() }),
            }),
            point_stride: STRIDE as u32,
            fields: vec![
                field("x", 0, FLOAT32),
                field("y", 4, FLOAT32),
                field("z", 8, FLOAT32),
                field("red", 12, UINT8),
                field("green", 13, UINT8),
                field("blue", 14, UINT8),
                field("alpha", 15, UINT8),
            ],
            data,
        }
    }
}

/// From blue by green to red as the length rises, the paler the less is known.
fn color(share: f64, flag: VoxelFlag) -> [u8; 4] {
    let share = share.clamp(0.0, 1.0);
    let byte = |x: f64| (255.0 * x.clamp(0.0, 1.0)) as u8;
    let alpha = match flag {
        VoxelFlag::Measured => 255,
        VoxelFlag::Interpolated => 160,
        VoxelFlag::Outside => 60,
    };
    [byte(2.0 * share - 0.5), byte(1.5 - (4.0 * share - 2.0).abs()), byte(1.5 - 3.0 * share), alpha]
}

//! The picture in the middle of the window: drawn with the graphics card into a texture of its own, which egui shows.

mod batch;
mod body;
pub mod color;
pub mod hair;
mod target;
pub mod wind;

use crate::camera::Eye;
use batch::{Batch, Kind};
use eframe::egui;
use eframe::egui_wgpu::RenderState;
use hair::N_SAMPLES;
use target::Target;
use tousle_core::{Body, Pose};

/// How hair is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HairLook {
    /// Each lock as many hairs.
    #[default]
    Lines,
    /// Each lock as one ribbon.
    Ribbons,
}

impl HairLook {
    /// All of them, as they are offered.
    pub const ALL: [Self; 2] = [Self::Lines, Self::Ribbons];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lines => "Lines",
            Self::Ribbons => "Ribbons",
        }
    }
}

/// What is to be seen, in numbers for the shaders.
#[derive(Debug, Default, PartialEq)]
pub struct Picture {
    /// How hair is drawn.
    pub hair_look: HairLook,
    /// [`hair::samples`] of all strands.
    pub hair: Vec<[f32; 4]>,
    /// [`wind::Wind::arrows`].
    pub arrows: Vec<[f32; 4]>,
    /// [`wind::Wind::slice`].
    pub slice: Vec<[f32; 4]>,
    /// Where the torso is as the head sees it.
    pub head_from_torso: Pose,
}

/// The graphics card's side of the picture.
#[derive(Debug)]
pub struct View {
    state: RenderStateHandle,
    /// Whether the processor does a graphics card's work.
    is_software: bool,
    target: Target,
    globals: wgpu::Buffer,
    backdrop: Batch,
    body: Batch,
    hair: Batch,
    arrows: Batch,
    slice: Batch,
    /// What the texture holds: it is drawn anew only for something else.
    drawn: Option<(Globals, Picture)>,
}

/// The part of egui's renderer that is used here.
struct RenderStateHandle(RenderState);

impl std::fmt::Debug for RenderStateHandle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("RenderState").finish()
    }
}

/// Four by four, twice, and six vectors.
type Globals = [[f32; 4]; 14];

/// How well a picture is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// As well as can be.
    Full,
    /// Of a third of the hairs and a quarter of the pixels where the processor has to do a graphics card's work: while
    /// something moves, a picture in time is worth more than a fine one. Where there is a card, as well as can be.
    Draft,
}

impl Quality {
    /// Hairs of all locks together.
    fn max_hairs(self) -> usize {
        match self {
            Self::Full => 4200,
            Self::Draft => 1400,
        }
    }

    /// Pixels of the window along the side of one that is drawn.
    fn pixel(self) -> u32 {
        match self {
            Self::Full => 1,
            Self::Draft => 2,
        }
    }
}

/// Hairs of one lock.
const MAX_HAIRS_OF_A_LOCK: usize = 64;

impl View {
    /// A picture of this body.
    pub fn new(state: &RenderState, body: &Body) -> Self {
        use wgpu::PrimitiveTopology::{TriangleList, TriangleStrip};
        let device = &state.device;
        let globals = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("globals"),
            size: size_of::<Globals>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let batch = |name, shader, topology, transparent| {
            Batch::new(device, &globals, &Kind { name, shader, topology, transparent })
        };
        let mut backdrop = batch("backdrop", include_str!("view/shaders/backdrop.wgsl"), TriangleList, true);
        backdrop.set(device, &state.queue, &[[0.0; 4]], 3, 1);
        let mut body_batch = batch("body", include_str!("view/shaders/body.wgsl"), TriangleList, false);
        let mesh = body::mesh(body);
        body_batch.set(device, &state.queue, &mesh, mesh.len() / 2, 1);
        Self {
            target: Target::new(state, [8, 8], None),
            backdrop,
            body: body_batch,
            hair: batch("hair", include_str!("view/shaders/hair.wgsl"), TriangleStrip, false),
            arrows: batch("arrows", include_str!("view/shaders/arrows.wgsl"), TriangleList, false),
            slice: batch("slice", include_str!("view/shaders/slice.wgsl"), TriangleList, true),
            globals,
            drawn: None,
            is_software: state.adapter.get_info().device_type == wgpu::DeviceType::Cpu,
            state: RenderStateHandle(state.clone()),
        }
    }

    /// Draws a picture of a size in pixels and gives the texture that shows it.
    pub fn draw(&mut self, eye: &Eye, size: [u32; 2], picture: Picture, quality: Quality) -> egui::TextureId {
        let quality = if self.is_software { quality } else { Quality::Full };
        let size = size.map(|n| (n / quality.pixel()).max(1));
        if self.target.size != size {
            self.target = Target::new(&self.state.0, size, Some(self.target.id));
            self.drawn = None;
        }
        let n_strands = picture.hair.len() / (2 * N_SAMPLES);
        let n_hairs = match picture.hair_look {
            HairLook::Lines => (quality.max_hairs() / n_strands.max(1)).clamp(1, MAX_HAIRS_OF_A_LOCK),
            HairLook::Ribbons => 0,
        };
        let wanted = (globals(eye, size, &picture.head_from_torso, n_hairs), picture);
        if self.drawn.as_ref() == Some(&wanted) {
            return self.target.id;
        }
        let (globals, picture) = self.drawn.insert(wanted);
        let (device, queue) = (&self.state.0.device, &self.state.0.queue);
        self.hair.set(device, queue, &picture.hair, 2 * N_SAMPLES, n_strands * n_hairs.max(1));
        self.arrows.set(device, queue, &picture.arrows, 9, picture.arrows.len() / 3);
        self.slice.set(device, queue, &picture.slice, picture.slice.len() / 2, 1);
        queue.write_buffer(&self.globals, 0, bytemuck::cast_slice(globals));
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = self.target.pass(&mut encoder);
            for batch in [&self.backdrop, &self.body, &self.hair, &self.arrows, &self.slice] {
                batch.draw(&mut pass);
            }
        }
        queue.submit([encoder.finish()]);
        self.target.id
    }
}

fn globals(eye: &Eye, size: [u32; 2], head_from_torso: &Pose, n_hairs: usize) -> Globals {
    let mut globals: Globals = [[0.0; 4]; 14];
    let matrices = [eye.clip_from_head, head_from_torso.to_homogeneous()];
    let columns = matrices.iter().flat_map(|m| m.column_iter().map(|c| [c[0], c[1], c[2], c[3]]));
    for (place, column) in globals.iter_mut().zip(columns) {
        *place = column.map(|c| c as f32);
    }
    let vectors = [eye.position_m, eye.axes[0], eye.axes[1], eye.axes[2]];
    for (place, v) in globals[8..].iter_mut().zip(vectors) {
        *place = [v.x as f32, v.y as f32, v.z as f32, 0.0];
    }
    globals[12] = [size[0] as f32, size[1] as f32, 0.0, 0.0];
    globals[13] = [N_SAMPLES as f32, n_hairs as f32, 0.0, 0.0];
    globals
}

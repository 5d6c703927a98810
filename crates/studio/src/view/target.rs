//! The picture's textures: color and depth, four samples a pixel, and what egui shows of them.

use eframe::egui;
use eframe::egui_wgpu::RenderState;

/// Eight bits a color, gamma encoded, as egui takes textures.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Depth from 0 near to 1 far.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Samples a pixel: hairs are thinner than pixels.
pub const N_SAMPLES: u32 = 4;

/// Textures of one size.
#[derive(Debug)]
pub struct Target {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// What egui shows.
    pub id: egui::TextureId,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
    resolved: wgpu::TextureView,
}

impl Target {
    /// Textures of a size, under the id of the former ones if there are such.
    pub fn new(state: &RenderState, size: [u32; 2], former: Option<egui::TextureId>) -> Self {
        let texture = |name: &str, format, sample_count, usage| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some(name),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            };
            state.device.create_texture(&descriptor).create_view(&wgpu::TextureViewDescriptor::default())
        };
        let none = wgpu::TextureUsages::empty();
        let color = texture("studio color", FORMAT, N_SAMPLES, none);
        let depth = texture("studio depth", DEPTH_FORMAT, N_SAMPLES, none);
        let resolved = texture("studio picture", FORMAT, 1, wgpu::TextureUsages::TEXTURE_BINDING);
        let mut renderer = state.renderer.write();
        let filter = wgpu::FilterMode::Linear;
        let id = match former {
            Some(id) => {
                renderer.update_egui_texture_from_wgpu_texture(&state.device, &resolved, filter, id);
                id
            }
            None => renderer.register_native_texture(&state.device, &resolved, filter),
        };
        Self { size, id, color, depth, resolved }
    }

    /// A pass that draws into them, from an empty picture on.
    pub fn pass<'a>(&'a self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("studio"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.color,
                resolve_target: Some(&self.resolved),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Discard,
                },
                depth_slice: None,
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }),
            ..wgpu::RenderPassDescriptor::default()
        })
    }
}

//! One kind of thing that is drawn: its shader and its data.

use super::target::{DEPTH_FORMAT, FORMAT, N_SAMPLES};
use wgpu::util::DeviceExt;

/// How a kind of thing is drawn.
pub struct Kind {
    /// Its name, for graphics debuggers.
    pub name: &'static str,
    /// Its shader, without what all share.
    pub shader: &'static str,
    /// What its vertices make.
    pub topology: wgpu::PrimitiveTopology,
    /// Whether what lies behind shines through: then it is drawn last and hides nothing.
    pub transparent: bool,
}

/// Things of one kind, with their numbers on the graphics card.
#[derive(Debug)]
pub struct Batch {
    name: &'static str,
    pipeline: wgpu::RenderPipeline,
    data: wgpu::Buffer,
    group: wgpu::BindGroup,
    globals: wgpu::Buffer,
    n_vertices: u32,
    n_instances: u32,
}

const GLOBALS_SHADER: &str = include_str!("shaders/globals.wgsl");

impl Batch {
    /// A kind of thing of which there is none yet.
    pub fn new(device: &wgpu::Device, globals: &wgpu::Buffer, kind: &Kind) -> Self {
        let pipeline = pipeline(device, kind);
        let data = storage(device, kind.name, &[[0.0; 4]]);
        let group = group(device, &pipeline, globals, &data);
        let globals = globals.clone();
        Self { name: kind.name, pipeline, data, group, globals, n_vertices: 0, n_instances: 0 }
    }

    /// What is drawn from now on: as many vertices, so often, from these numbers.
    pub fn set(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        data: &[[f32; 4]],
        n_vertices: usize,
        n_instances: usize,
    ) {
        (self.n_vertices, self.n_instances) = (n_vertices as u32, n_instances as u32);
        if data.is_empty() {
            self.n_instances = 0;
            return;
        }
        let bytes: &[u8] = bytemuck::cast_slice(data);
        if bytes.len() as u64 <= self.data.size() {
            queue.write_buffer(&self.data, 0, bytes);
        } else {
            self.data = storage(device, self.name, data);
            self.group = group(device, &self.pipeline, &self.globals, &self.data);
        }
    }

    /// Draws them.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.n_instances > 0 {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.group, &[]);
            pass.draw(0..self.n_vertices, 0..self.n_instances);
        }
    }
}

fn storage(device: &wgpu::Device, name: &str, data: &[[f32; 4]]) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(name),
        contents: bytemuck::cast_slice(data),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
    })
}

fn group(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    globals: &wgpu::Buffer,
    data: &wgpu::Buffer,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: globals.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: data.as_entire_binding() },
        ],
    })
}

fn pipeline(device: &wgpu::Device, kind: &Kind) -> wgpu::RenderPipeline {
    let source = format!("{GLOBALS_SHADER}\n{}", kind.shader);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(kind.name),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let entry = |binding: u32, ty: wgpu::BufferBindingType| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    };
    let group = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(kind.name),
        entries: &[
            entry(0, wgpu::BufferBindingType::Uniform),
            entry(1, wgpu::BufferBindingType::Storage { read_only: true }),
        ],
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(kind.name),
        bind_group_layouts: &[Some(&group)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(kind.name),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState { topology: kind.topology, ..wgpu::PrimitiveState::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(!kind.transparent),
            depth_compare: Some(wgpu::CompareFunction::LessEqual),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState { count: N_SAMPLES, ..wgpu::MultisampleState::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(wgpu::ColorTargetState {
                format: FORMAT,
                blend: kind.transparent.then_some(wgpu::BlendState::ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
        }),
        multiview_mask: None,
        cache: None,
    })
}

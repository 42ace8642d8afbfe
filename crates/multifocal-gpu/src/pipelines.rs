//! The shaders as pipelines.

use sightlines_shaders::multifocal::{CARRY, DECODE, DIRECT, FLAGS, FLOAT, RASTER};
use sightlines_shaders::{Access, Shader};
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BufferBindingType, CompareFunction,
    ComputePipeline, ComputePipelineDescriptor, DepthBiasState, DepthStencilState, Device, FragmentState,
    PipelineCompilationOptions, PipelineLayout, PipelineLayoutDescriptor, RenderPipeline, RenderPipelineDescriptor,
    ShaderModule, ShaderModuleDescriptor, ShaderSource, ShaderStages, StencilState, TextureFormat, VertexAttribute,
    VertexBufferLayout, VertexFormat, VertexState, VertexStepMode,
};

/// A compute shader that is ready to run.
#[derive(Debug)]
pub(crate) struct Compute {
    pub(crate) pipeline: ComputePipeline,
    pub(crate) layout: BindGroupLayout,
}

/// All shaders.
#[derive(Debug)]
pub(crate) struct Pipelines {
    pub(crate) direct: Compute,
    pub(crate) carry: Compute,
    pub(crate) decode: Compute,
    pub(crate) flags: Compute,
    pub(crate) float: Compute,
    pub(crate) raster: RenderPipeline,
    pub(crate) raster_layout: BindGroupLayout,
}

/// Bytes of a corner of a polygon that the raster form draws: a place and the number of the form.
pub(crate) const CORNER_BYTES: u64 = 12;

impl Pipelines {
    pub(crate) fn new(device: &Device) -> Self {
        let raster_layout = layout(device, &RASTER, ShaderStages::FRAGMENT);
        let raster = raster(device, &raster_layout);
        let [direct, carry, decode, flags, float] =
            [DIRECT, CARRY, DECODE, FLAGS, FLOAT].map(|shader| compute(device, &shader));
        Self { direct, carry, decode, flags, float, raster, raster_layout }
    }
}

fn module(device: &Device, shader: &Shader) -> ShaderModule {
    device.create_shader_module(ShaderModuleDescriptor {
        label: Some(shader.name),
        source: ShaderSource::Wgsl(shader.text.into()),
    })
}

fn layout(device: &Device, shader: &Shader, visibility: ShaderStages) -> BindGroupLayout {
    let entry = |(binding, access): (u32, &Access)| BindGroupLayoutEntry {
        binding,
        visibility,
        ty: BindingType::Buffer {
            ty: match access {
                Access::Uniform => BufferBindingType::Uniform,
                Access::Read => BufferBindingType::Storage { read_only: true },
                Access::Write => BufferBindingType::Storage { read_only: false },
            },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    let entries: Vec<_> = (0..).zip(shader.bindings).map(entry).collect();
    device.create_bind_group_layout(&BindGroupLayoutDescriptor { label: Some(shader.name), entries: &entries })
}

fn pipeline_layout(device: &Device, layout: &BindGroupLayout) -> PipelineLayout {
    device.create_pipeline_layout(&PipelineLayoutDescriptor {
        label: None,
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    })
}

fn compute(device: &Device, shader: &Shader) -> Compute {
    let layout = layout(device, shader, ShaderStages::COMPUTE);
    let pipeline = device.create_compute_pipeline(&ComputePipelineDescriptor {
        label: Some(shader.name),
        layout: Some(&pipeline_layout(device, &layout)),
        module: &module(device, shader),
        entry_point: None,
        // The texts write whatever they read.
        compilation_options: PipelineCompilationOptions {
            zero_initialize_workgroup_memory: false,
            ..Default::default()
        },
        cache: None,
    });
    Compute { pipeline, layout }
}

fn raster(device: &Device, layout: &BindGroupLayout) -> RenderPipeline {
    let module = module(device, &RASTER);
    let attribute = |shader_location, offset, format| VertexAttribute { format, offset, shader_location };
    let attributes = [attribute(0, 0, VertexFormat::Float32x2), attribute(1, 8, VertexFormat::Uint32)];
    let corners =
        VertexBufferLayout { array_stride: CORNER_BYTES, step_mode: VertexStepMode::Vertex, attributes: &attributes };
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some(RASTER.name),
        layout: Some(&pipeline_layout(device, layout)),
        vertex: VertexState {
            module: &module,
            entry_point: None,
            compilation_options: PipelineCompilationOptions::default(),
            buffers: &[Some(corners)],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(DepthStencilState {
            format: TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(CompareFunction::Greater),
            stencil: StencilState::default(),
            bias: DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: PipelineCompilationOptions::default(),
            targets: &[],
        }),
        multiview_mask: None,
        cache: None,
    })
}

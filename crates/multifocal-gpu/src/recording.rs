//! The work of a job while it is recorded: its buffers on the device, and the passes over them.

use crate::context::Gpu;
use crate::pack::{Packed, pitch};
use crate::pipelines::{CORNER_BYTES, Compute};
use sightlines_multifocal::Carry;
use sightlines_shaders::Record;
use sightlines_shaders::multifocal::{self as records, CARRY_LANES, DECODE_LANES, TILE};
use wgpu::{BindGroup, Buffer, BufferBinding, BufferUsages, CommandEncoder};

/// Bytes between the beginnings of parts of a buffer that are bound on their own: what every device takes.
const PART: u64 = 256;

/// Values of all planes of a job, on the device.
#[derive(Debug)]
pub struct Values {
    pub(crate) buffer: Buffer,
    pub(crate) parts: Vec<Part>,
}

/// Where the values of a plane lie.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part {
    pub(crate) texels: [u32; 2],
    pub(crate) offset: u64,
}

impl Part {
    pub(crate) fn n_texels(&self) -> u64 {
        u64::from(self.texels[0]) * u64::from(self.texels[1])
    }

    pub(crate) fn bytes(&self) -> u64 {
        4 * self.n_texels()
    }
}

impl Values {
    /// The buffer that all values lie in: usable as storage and as source of copies.
    pub const fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// Where the values of a plane begin in the buffer, in bytes; one `u32` for each texel follows, row by row.
    pub fn offset(&self, plane: usize) -> u64 {
        self.parts[plane].offset
    }

    /// How many texels a plane has along each axis.
    pub fn texels(&self, plane: usize) -> [u32; 2] {
        self.parts[plane].texels
    }

    /// How many planes.
    pub fn n_planes(&self) -> usize {
        self.parts.len()
    }

    pub(crate) fn binding(&self, plane: usize) -> BufferBinding<'_> {
        part(&self.buffer, self.parts[plane].offset, self.parts[plane].bytes())
    }
}

pub(crate) fn part(buffer: &Buffer, offset: u64, size: u64) -> BufferBinding<'_> {
    BufferBinding { buffer, offset, size: wgpu::BufferSize::new(size) }
}

pub(crate) fn whole(buffer: &Buffer) -> BufferBinding<'_> {
    BufferBinding { buffer, offset: 0, size: None }
}

/// Sizes of a job's buffers.
pub(crate) struct Sizes {
    pub(crate) parts: Vec<Part>,
    /// All values.
    pub(crate) values: u64,
    /// The largest plane in any other shape.
    pub(crate) scratch: u64,
}

impl Sizes {
    pub(crate) fn new(texels: impl Iterator<Item = [u32; 2]>) -> Self {
        let (mut parts, mut values, mut scratch): (Vec<Part>, u64, u64) = (Vec::new(), 0, 0);
        for texels in texels {
            let part = Part { texels, offset: values };
            let [w, h] = texels.map(u64::from);
            // Rows of the plane before and columns of this one; or padded rows.
            let before = parts.last().map_or(0, |p| u64::from(p.texels[1]));
            scratch = scratch.max(4 * w * before).max(4 * u64::from(pitch(texels[0])) * h);
            values += part.bytes().next_multiple_of(PART);
            parts.push(part);
        }
        Self { parts, values, scratch }
    }
}

/// The lists of a job on the device.
pub(crate) struct Uploaded {
    forms: Buffer,
    edges: Buffer,
    slopes: Buffer,
    planes: Buffer,
}

impl Uploaded {
    pub(crate) fn new(gpu: &Gpu, packed: &Packed) -> Self {
        let list =
            |label, bytes: &[u8]| gpu.upload(label, bytes, records::Form::LAYOUT.size().into(), BufferUsages::STORAGE);
        let mut planes = Vec::new();
        for plane in &packed.planes {
            plane.put(&mut planes);
            planes.resize(planes.len().next_multiple_of(PART as usize), 0);
        }
        Self {
            forms: list("forms", &packed.forms),
            edges: list("edges", &packed.edges),
            slopes: list("slopes", &packed.slopes),
            planes: gpu.upload("planes", &planes, PART, BufferUsages::UNIFORM),
        }
    }

    fn bindings(&self, plane: usize) -> [BufferBinding<'_>; 4] {
        let record = part(&self.planes, plane as u64 * PART, records::Plane::LAYOUT.size().into());
        [record, whole(&self.forms), whole(&self.edges), whole(&self.slopes)]
    }
}

/// A job that is being recorded.
pub(crate) struct Recording<'a> {
    gpu: &'a Gpu,
    pub(crate) values: Values,
    pub(crate) encoder: CommandEncoder,
    scratch: Option<Buffer>,
    scratch_size: u64,
}

impl<'a> Recording<'a> {
    pub(crate) fn new(gpu: &'a Gpu, sizes: Sizes) -> Self {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        let buffer = gpu.buffer("values", sizes.values, usage);
        let encoder =
            gpu.device().create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("multifocal") });
        let values = Values { buffer, parts: sizes.parts };
        Self { gpu, values, encoder, scratch: None, scratch_size: sizes.scratch }
    }

    /// Draws each plane and carries the one before over to it, then submits.
    pub(crate) fn run(mut self, carries: &[Option<&Carry>], mut draw: impl FnMut(&mut Self, usize)) -> Values {
        for (plane, carry) in carries.iter().enumerate() {
            draw(&mut self, plane);
            if let (Some(carry), true) = (carry, plane > 0) {
                self.carry(carry, plane);
            }
        }
        self.gpu.queue().submit([self.encoder.finish()]);
        self.values
    }

    /// Records a dispatch.
    pub(crate) fn dispatch(&mut self, shader: &Compute, bindings: &BindGroup, groups: [u32; 2]) {
        let mut pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&shader.pipeline);
        pass.set_bind_group(0, bindings, &[]);
        pass.dispatch_workgroups(groups[0], groups[1], 1);
    }

    /// Memory for what is not kept; the same for all planes, since they follow each other.
    fn scratch(&mut self) -> Buffer {
        let make = || self.gpu.buffer("scratch", self.scratch_size, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        self.scratch.get_or_insert_with(make).clone()
    }

    pub(crate) fn direct(&mut self, uploaded: &Uploaded, plane: usize) {
        let shader = &self.gpu.pipelines().direct;
        let [a, b, c, d] = uploaded.bindings(plane);
        let bindings = self.gpu.bind(&shader.layout, &[a, b, c, d, self.values.binding(plane)]);
        let groups = self.values.parts[plane].texels.map(|n| n.div_ceil(TILE));
        self.dispatch(shader, &bindings, groups);
    }

    pub(crate) fn raster(&mut self, uploaded: &Uploaded, record: &records::Plane, corners: &[u8], plane: usize) {
        let [width, height] = self.values.parts[plane].texels;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = self.gpu.device().create_texture(&wgpu::TextureDescriptor {
            label: Some("depths"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let vertices = self.gpu.upload("corners", corners, CORNER_BYTES, BufferUsages::VERTEX);
        let bindings = self.gpu.bind(&self.gpu.pipelines().raster_layout, &uploaded.bindings(plane));
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        };
        let descriptor = wgpu::RenderPassDescriptor { depth_stencil_attachment: Some(depth), ..Default::default() };
        let mut pass = self.encoder.begin_render_pass(&descriptor);
        pass.set_pipeline(&self.gpu.pipelines().raster);
        pass.set_bind_group(0, &bindings, &[]);
        pass.set_vertex_buffer(0, vertices.slice(..));
        pass.draw(0..(corners.len() as u64 / CORNER_BYTES) as u32, 0..1);
        drop(pass);
        self.decode(uploaded, record, &texture, size, plane);
    }

    /// Copies depths to a buffer and from there, decoded, to the values.
    fn decode(
        &mut self,
        uploaded: &Uploaded,
        record: &records::Plane,
        texture: &wgpu::Texture,
        size: wgpu::Extent3d,
        plane: usize,
    ) {
        let scratch = self.scratch();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * record.pitch),
            rows_per_image: Some(size.height),
        };
        let target = wgpu::TexelCopyBufferInfo { buffer: &scratch, layout };
        self.encoder.copy_texture_to_buffer(texture.as_image_copy(), target, size);
        let shader = &self.gpu.pipelines().decode;
        let [record, ..] = uploaded.bindings(plane);
        let bindings = self.gpu.bind(&shader.layout, &[record, whole(&scratch), self.values.binding(plane)]);
        self.dispatch(shader, &bindings, [size.width.div_ceil(DECODE_LANES), size.height]);
    }

    /// Carries the plane before over to this one, in two passes.
    fn carry(&mut self, carry: &Carry, plane: usize) {
        let scratch = self.scratch();
        let [[width, height], [new_width, new_height]] = [plane - 1, plane].map(|p| self.values.parts[p].texels);
        let n_columns = carry.columns.len() as u32;
        debug_assert_eq!([n_columns, carry.rows.len() as u32], [new_width, new_height], "a range for each texel");
        let along = records::Carry { width, height, n_ranges: new_width, ..Default::default() };
        let across = records::Carry {
            width: height,
            height: new_width,
            n_ranges: new_height,
            first_range: n_columns,
            rise: carry.rise,
            last: 1,
            ..Default::default()
        };
        let mut ranges = Vec::new();
        carry.columns.iter().chain(&carry.rows).flatten().for_each(|n| ranges.extend_from_slice(&n.to_le_bytes()));
        let ranges = self.gpu.upload("ranges", &ranges, PART, BufferUsages::STORAGE);
        for record in [along, across] {
            let mut bytes = Vec::new();
            record.put(&mut bytes);
            let uniform = self.gpu.upload("carry", &bytes, PART, BufferUsages::UNIFORM);
            let first = record.last == 0;
            let shader = &self.gpu.pipelines().carry;
            let [source, found] = if first {
                [self.values.binding(plane - 1), whole(&scratch)]
            } else {
                [whole(&scratch), self.values.binding(plane)]
            };
            let bindings = self.gpu.bind(&shader.layout, &[whole(&uniform), source, whole(&ranges), found]);
            self.dispatch(shader, &bindings, [record.n_ranges.div_ceil(CARRY_LANES), record.height]);
        }
    }
}

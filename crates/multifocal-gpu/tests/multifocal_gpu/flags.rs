//! Results that stay on the device: which objects are hidden, and draws that leave them out.

use crate::common::scene::{job, occluders};
use crate::common::{Chance, gpu};
use sightlines_geometry::Aabb;
use sightlines_multifocal::{Buffer, BufferJob, Footprint, Measure};
use sightlines_multifocal_gpu::{DrawRecords, Gpu, GpuBackend, GpuPath, Values, wgpu};
use wgpu::BufferUsages;

/// Whether a footprint is hidden, straight from its definition.
fn is_hidden(footprint: &Footprint, buffer: &Buffer) -> bool {
    let [x0, y0, x1, y1] = footprint.bounds;
    let touched = |x: i32, y: i32| footprint.edges.iter().all(|&[a, b, c]| a * x + b * y + c >= 0);
    let texels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y)));
    footprint.inside
        && texels.filter(|&(x, y)| touched(x, y)).all(|(x, y)| buffer.get(x as u32, y as u32) > footprint.limit)
}

/// Boxes behind a scene's occluders, and some that nothing is in front of or that leave the window.
fn footprints(chance: &mut Chance, job: &BufferJob<'_>, plane: usize, n: usize) -> Vec<Footprint> {
    let mut out = Vec::new();
    while out.len() < n {
        let z = chance.real(2.0, 20.0);
        let at = [chance.real(-z, z), chance.real(-z, z), z];
        let size = chance.real(0.01, 1.0);
        let target = Aabb { min: at, max: at.map(|x| x + size) };
        out.extend(Footprint::of_box(job.volume(), &job.planes()[plane], job.unit(), &target));
    }
    out
}

struct Frame {
    gpu: Gpu,
    flags: wgpu::Buffer,
    draws: wgpu::Buffer,
}

/// Words of a draw with one vertex and one instance.
fn draw_words(indexed: bool, i: u32) -> Vec<u32> {
    if indexed { vec![1, 1, i, 0, 0] } else { vec![1, 1, i, 0] }
}

impl Frame {
    /// All objects visible.
    fn new(gpu: &Gpu, n: u32, indexed: bool) -> Self {
        let buffer = |words: Vec<u32>, usage| {
            let size = 4 * words.len() as u64;
            let usage = usage | BufferUsages::STORAGE | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
            let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
            let buffer = gpu.device().create_buffer(&descriptor);
            gpu.queue().write_buffer(&buffer, 0, &words.into_iter().flat_map(u32::to_le_bytes).collect::<Vec<_>>());
            buffer
        };
        let flags = buffer(vec![1; n as usize], BufferUsages::STORAGE);
        let draws = buffer((0..n).flat_map(|i| draw_words(indexed, i)).collect(), BufferUsages::INDIRECT);
        Self { gpu: gpu.clone(), flags, draws }
    }

    fn hide(&self, values: &Values, plane: usize, footprints: &[Footprint], draws: Option<bool>) {
        let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
        let draws = draws
            .map(|indexed| if indexed { DrawRecords::Indexed(&self.draws) } else { DrawRecords::Plain(&self.draws) });
        self.gpu.hide(&mut encoder, values, plane, footprints, &self.flags, draws).expect("it is recorded");
        self.gpu.queue().submit([encoder.finish()]);
    }

    fn words(&self, buffer: &wgpu::Buffer) -> Vec<u32> {
        read(
            &self.gpu,
            |encoder, target| encoder.copy_buffer_to_buffer(buffer, 0, target, 0, buffer.size()),
            buffer.size(),
        )
    }
}

/// Words that `copy` copies to a buffer.
fn read(gpu: &Gpu, copy: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::Buffer), size: u64) -> Vec<u32> {
    let usage = BufferUsages::COPY_DST | BufferUsages::MAP_READ;
    let descriptor = wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false };
    let staging = gpu.device().create_buffer(&descriptor);
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    copy(&mut encoder, &staging);
    gpu.queue().submit([encoder.finish()]);
    staging.map_async(wgpu::MapMode::Read, .., |result| result.expect("it can be read"));
    gpu.device().poll(wgpu::PollType::wait_indefinitely()).expect("it is done");
    let bytes = staging.get_mapped_range(..).expect("it is mapped");
    bytes.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().expect("four bytes"))).collect()
}

#[test]
fn flags_equality_with_a_plain_loop() {
    let Some(gpu) = gpu("flags as in a plain loop") else { return };
    let (mut n_hidden, mut n_visible) = (0, 0);
    for seed in 0..4 {
        let mut chance = Chance::new(seed);
        let occluders = occluders(&mut chance, 150);
        let job = job(&occluders, Measure::SectionHeight, [120, 100], true);
        let way = [GpuPath::Compute, GpuPath::Raster][seed as usize % 2];
        let backend = GpuBackend::new(gpu.clone(), way);
        let values = backend.keep(&job).expect("it is done");
        let buffers = backend.wait(&backend.submit(&job).expect("submitted")).expect("done");
        for plane in [0, 3] {
            let footprints = footprints(&mut chance, &job, plane, 300);
            let expected: Vec<u32> = footprints.iter().map(|f| (!is_hidden(f, &buffers[plane])).into()).collect();
            for draws in [None, Some(false), Some(true)] {
                let frame = Frame::new(&gpu, 300, draws == Some(true));
                frame.hide(&values, plane, &footprints, draws);
                assert_eq!(frame.words(&frame.flags), expected, "seed {seed}, plane {plane}");
                let records = frame.words(&frame.draws);
                let right = expected.iter().zip(0..).flat_map(|(&visible, i)| {
                    let mut words = draw_words(draws == Some(true), i);
                    words[1] = if draws.is_some() { visible } else { 1 };
                    words
                });
                assert_eq!(records, right.collect::<Vec<_>>(), "draws, seed {seed}, plane {plane}");
            }
            n_visible += expected.iter().filter(|&&v| v == 1).count();
            n_hidden += expected.iter().filter(|&&v| v == 0).count();
        }
    }
    assert!(n_hidden > 100 && n_visible > 100, "{n_hidden} hidden, {n_visible} visible");
}

#[test]
fn flags_add_up_over_planes() {
    let Some(gpu) = gpu("flags of several planes") else { return };
    let mut chance = Chance::new(9);
    let occluders = occluders(&mut chance, 150);
    let job = job(&occluders, Measure::SectionHeight, [120, 100], false);
    let backend = GpuBackend::new(gpu.clone(), GpuPath::Compute);
    let values = backend.keep(&job).expect("it is done");
    let buffer = &backend.wait(&backend.submit(&job).expect("submitted")).expect("done")[0];
    let [first, second] = [0; 2].map(|_| footprints(&mut chance, &job, 0, 200));
    let frame = Frame::new(&gpu, 200, false);
    frame.hide(&values, 0, &first, None);
    frame.hide(&values, 0, &second, None);
    let pairs = first.iter().zip(&second);
    let expected: Vec<u32> =
        pairs.clone().map(|(a, b)| (!(is_hidden(a, buffer) || is_hidden(b, buffer))).into()).collect();
    assert_eq!(frame.words(&frame.flags), expected);
    let by_one = pairs.filter(|(a, b)| is_hidden(a, buffer) != is_hidden(b, buffer)).count();
    assert!(by_one > 10, "{by_one} objects are hidden by one plane alone");
}

#[test]
fn footprints_that_leave_the_window_hide_nothing() {
    let Some(gpu) = gpu("footprints beyond the window") else { return };
    let mut chance = Chance::new(10);
    let occluders = occluders(&mut chance, 400);
    let job = job(&occluders, Measure::VertexHeight, [16, 16], false);
    let values = GpuBackend::new(gpu.clone(), GpuPath::Compute).keep(&job).expect("it is done");
    let bounds = [[0, 0, 17, 16], [-1, 0, 4, 4], [4, 4, 4, 8], [i32::MIN, 0, i32::MAX, 16], [0, 0, 1, 1]];
    let footprints = bounds.map(|bounds| Footprint { bounds, edges: vec![[0, 0, -1]], limit: 0, inside: true });
    let frame = Frame::new(&gpu, 5, false);
    frame.hide(&values, 0, &footprints, None);
    // The last one touches no texel, so nothing is seen through it.
    assert_eq!(frame.words(&frame.flags), [1, 1, 1, 1, 0]);
    frame.hide(&values, 0, &[], None);
}

/// Draws a pixel for each object whose draw has an instance.
const POINTS: &str = "
@vertex fn point(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>((f32(i) + 0.5) / 128.0 - 1.0, 0.0, 0.5, 1.0);
}
@fragment fn white() -> @location(0) vec4<f32> {
    return vec4<f32>(1.0);
}
";

/// Which of 256 pixels are drawn by the indirect draws.
fn draw_points(frame: &Frame) -> Vec<u32> {
    let device = frame.gpu.device();
    let source = wgpu::ShaderSource::Wgsl(POINTS.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let format = wgpu::TextureFormat::Rgba8Unorm;
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState { topology: wgpu::PrimitiveTopology::PointList, ..Default::default() },
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: None,
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let size = wgpu::Extent3d { width: 256, height: 1, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let view = texture.create_view(&Default::default());
    let copy = |encoder: &mut wgpu::CommandEncoder, target: &wgpu::Buffer| {
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        };
        let descriptor = wgpu::RenderPassDescriptor { color_attachments: &[Some(attachment)], ..Default::default() };
        let mut pass = encoder.begin_render_pass(&descriptor);
        pass.set_pipeline(&pipeline);
        for i in 0..256 {
            pass.draw_indirect(&frame.draws, i * 16);
        }
        drop(pass);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(1024), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: target, layout },
            size,
        );
    };
    read(&frame.gpu, copy, 1024).into_iter().map(|pixel| (pixel != 0).into()).collect()
}

#[test]
fn flags_hidden_objects_are_not_drawn() {
    let Some(gpu) = gpu("an indirect draw") else { return };
    let mut chance = Chance::new(12);
    let occluders = occluders(&mut chance, 200);
    let job = job(&occluders, Measure::SectionHeight, [120, 100], false);
    let values = GpuBackend::new(gpu.clone(), GpuPath::Compute).keep(&job).expect("it is done");
    let footprints = footprints(&mut chance, &job, 0, 256);
    let frame = Frame::new(&gpu, 256, false);
    assert_eq!(draw_points(&frame), vec![1; 256], "before, all are drawn");
    frame.hide(&values, 0, &footprints, Some(false));
    let drawn = draw_points(&frame);
    assert_eq!(drawn, frame.words(&frame.flags));
    let n = drawn.iter().sum::<u32>();
    assert!((20..236).contains(&n), "{n} of 256 are drawn");
}

//! A job in 32-bit floats.

use crate::context::Gpu;
use crate::recording::{Recording, whole};
use sightlines_multifocal::{BufferJob, BufferPlane, Occluder};
use sightlines_shaders::Record;
use sightlines_shaders::multifocal::{FLOAT_TILE, FloatOccluder, FloatScene};
use wgpu::BufferUsages;

/// Bytes of a job: its occluders, shared by all planes, and the planes.
pub(crate) struct Packed {
    pub(crate) occluders: Vec<u8>,
    pub(crate) points: Vec<u8>,
    planes: Vec<(FloatScene, Vec<u8>)>,
}

/// The frame that floats are used in: the middle of the volume, and a power of two that brings the largest coordinate
/// near 1. Moving there rounds once, by 2^-53 of what comes out; scaling does not round, and the floats are within
/// 2^-24 then.
struct Frame {
    origin: [f64; 3],
    scale: f64,
}

impl Frame {
    fn new(job: &BufferJob<'_>) -> Self {
        let b = job.volume().bounds();
        let origin = std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) / 2.0);
        let mut largest = 0.0_f64;
        let mut reach = |p: [f64; 3]| (0..3).for_each(|k| largest = largest.max((p[k] - origin[k]).abs()));
        reach(b.min);
        reach(b.max);
        for plane in job.planes() {
            let [w, h] = plane.texels();
            reach(plane.corner(0, 0));
            reach(plane.corner(w, h));
        }
        for occluder in job.occluders() {
            occluder.outline().iter().chain(occluder.facets().iter().flatten()).for_each(|&p| reach(p));
        }
        // The power of two below it, by its bits.
        Self { origin, scale: 1.0 / f64::from_bits(largest.to_bits() & 0x7ff0_0000_0000_0000) }
    }

    fn coordinate(&self, x: f64, k: usize) -> f32 {
        ((x - self.origin[k]) * self.scale) as f32
    }

    fn put_point(&self, p: [f64; 3], out: &mut Vec<u8>) {
        let words = [self.coordinate(p[0], 0), self.coordinate(p[1], 1), self.coordinate(p[2], 2), 0.0];
        words.iter().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
    }
}

impl Packed {
    pub(crate) fn new(job: &BufferJob<'_>) -> Self {
        let frame = Frame::new(job);
        let corners = job.volume().corners();
        let (mut occluders, mut points) = (Vec::new(), Vec::new());
        let mut n_occluders = 0;
        for occluder in job.occluders() {
            if let Some(front) = occluder.side_of(&corners) {
                put_occluder(&frame, occluder, if front { 1.0 } else { -1.0 }, &mut occluders, &mut points);
                n_occluders += 1;
            }
        }
        let planes = job.planes().iter().map(|plane| pack_plane(job, &frame, plane, n_occluders)).collect();
        Self { occluders, points, planes }
    }
}

fn put_occluder(frame: &Frame, occluder: &Occluder, sign: f32, records: &mut Vec<u8>, points: &mut Vec<u8>) {
    let n_before = (points.len() / 16) as u32;
    occluder.outline().iter().chain(occluder.facets().iter().flatten()).for_each(|&p| frame.put_point(p, points));
    let n_corners = occluder.outline().len() as u32;
    let record = FloatOccluder {
        first_corner: n_before,
        n_corners,
        first_facet: n_before + n_corners,
        n_facets: occluder.facets().len() as u32,
        sign,
        ..Default::default()
    };
    record.put(records);
}

fn pack_plane(job: &BufferJob<'_>, frame: &Frame, plane: &BufferPlane, n_occluders: u32) -> (FloatScene, Vec<u8>) {
    let b = job.volume().bounds();
    let half = |k: usize| {
        let half = (b.max[k] - frame.origin[k]).max(frame.origin[k] - b.min[k]);
        let float = (half * frame.scale) as f32;
        if half == 0.0 { 0.0 } else { float.next_up() }
    };
    let [width, height] = plane.texels();
    let scene = FloatScene {
        width,
        height,
        n_occluders,
        axis: plane.axis() as u32,
        half_size: [half(0), half(1), half(2)],
        at: frame.coordinate(plane.at(), plane.axis()),
        direction: if plane.positive() { 1.0 } else { -1.0 },
        per_unit: (1.0 / (frame.scale * job.unit())) as f32,
        ..Default::default()
    };
    let [u, v] = plane.across();
    let across = (0..=width).map(|x| frame.coordinate(plane.corner(x, 0)[u], u));
    let lines = across.chain((0..=height).map(|y| frame.coordinate(plane.corner(0, y)[v], v)));
    (scene, lines.flat_map(f32::to_le_bytes).collect())
}

/// Records one plane.
pub(crate) fn record(gpu: &Gpu, recording: &mut Recording<'_>, packed: &Packed, plane: usize) {
    let (scene, lines) = &packed.planes[plane];
    let mut uniform = Vec::new();
    scene.put(&mut uniform);
    let uniform = gpu.upload("scene", &uniform, 16, BufferUsages::UNIFORM);
    let occluders = gpu.upload("occluders", &packed.occluders, 32, BufferUsages::STORAGE);
    let points = gpu.upload("points", &packed.points, 16, BufferUsages::STORAGE);
    let lines = gpu.upload("lines", lines, 16, BufferUsages::STORAGE);
    let shader = &gpu.pipelines().float;
    let values = recording.values.binding(plane);
    let parts = [whole(&uniform), whole(&occluders), whole(&points), whole(&lines), values];
    let bindings = gpu.bind(&shader.layout, &parts);
    recording.dispatch(shader, &bindings, [scene.width, scene.height].map(|n| n.div_ceil(FLOAT_TILE)));
}

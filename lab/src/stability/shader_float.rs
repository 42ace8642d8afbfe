//! The arithmetic of the shader in 32-bit floats, `float.wgsl`, on the processor: operation by operation, in the order
//! in which it is written there, without fused or reordered operations. A device may order sums otherwise, which the
//! shader's margin allows for; the real one is tested where there is a device, in the tests of
//! `sightlines-multifocal-gpu`.

use super::plain::{V, cross, dot, minus};
use sightlines::geometry::Point3;
use sightlines::multifocal::{Buffer, BufferJob, BufferPlane, Occluder};

/// 16 * 2^-23, the shader's.
pub(crate) const MARGIN: f32 = f32::from_bits((127 - 19) << 23);
/// 2^-60, the shader's.
const TINY: f32 = f32::from_bits((127 - 60) << 23);

/// The frame that floats are used in: the middle of the volume, and a power of two.
pub(crate) struct Frame {
    origin: Point3,
    scale: f64,
}

impl Frame {
    /// For a volume and all other points.
    pub(crate) fn new(min: Point3, max: Point3, points: impl IntoIterator<Item = Point3>) -> Self {
        let origin = std::array::from_fn(|k| min[k] + (max[k] - min[k]) / 2.0);
        let reach = |p: Point3| (0..3).fold(0.0f64, |m, k| m.max((p[k] - origin[k]).abs()));
        let largest = points.into_iter().map(reach).fold(reach(min).max(reach(max)), f64::max);
        Self { origin, scale: 1.0 / f64::from_bits(largest.to_bits() & 0x7ff0_0000_0000_0000) }
    }

    fn coordinate(&self, x: f64, k: usize) -> f32 {
        ((x - self.origin[k]) * self.scale) as f32
    }

    pub(crate) fn point(&self, p: Point3) -> V<f32> {
        std::array::from_fn(|k| self.coordinate(p[k], k))
    }

    /// Half the size of the volume, rounded up.
    pub(crate) fn half_size(&self, min: Point3, max: Point3) -> V<f32> {
        std::array::from_fn(|k| {
            let half = (max[k] - self.origin[k]).max(self.origin[k] - min[k]);
            let float = (half * self.scale) as f32;
            if half == 0.0 { 0.0 } else { float.next_up() }
        })
    }
}

fn plus(a: V<f32>, b: V<f32>) -> V<f32> {
    std::array::from_fn(|k| a[k] + b[k])
}

fn magnitudes(a: V<f32>, b: V<f32>) -> V<f32> {
    [a[1] * b[2] + a[2] * b[1], a[2] * b[0] + a[0] * b[2], a[0] * b[1] + a[1] * b[0]]
}

/// What has to be exceeded: with the margin 0 the sum need not even be positive.
fn exceeds(sum: f32, margin: f32, magnitude: f32) -> bool {
    if margin == 0.0 { sum >= 0.0 } else { sum > margin * magnitude + TINY }
}

/// Whether the box is on the inner side of an edge, seen from t; surely with [`MARGIN`].
pub(crate) fn inner(half_size: V<f32>, [a, b]: [V<f32>; 2], t: V<f32>, sign: f32, margin: f32) -> bool {
    let absolute = |v: V<f32>| v.map(f32::abs);
    let n = cross(minus(a, t), minus(b, t));
    let n_magnitude = magnitudes(plus(absolute(a), absolute(t)), plus(absolute(b), absolute(t)));
    let sum = sign * dot(t.map(|x| -x), n) - dot(absolute(n), half_size);
    let magnitude = dot(absolute(t), n_magnitude) + dot(n_magnitude, half_size);
    exceeds(sum, margin, magnitude)
}

/// Whether t is behind a facet, or on it; surely with [`MARGIN`].
fn behind([a, b, c]: [V<f32>; 3], t: V<f32>, sign: f32, margin: f32) -> bool {
    let absolute = |v: V<f32>| v.map(f32::abs);
    let sum = -sign * dot(minus(t, a), cross(minus(b, a), minus(c, a)));
    let [ta, ba, ca] = [t, b, c].map(|p| plus(absolute(p), absolute(a)));
    exceeds(sum, margin, dot(ta, magnitudes(ba, ca)))
}

struct FloatOccluder {
    outline: Vec<V<f32>>,
    facets: Vec<[V<f32>; 3]>,
    sign: f32,
    /// In the code of buffers.
    value: u32,
}

impl FloatOccluder {
    fn new(frame: &Frame, plane: &BufferPlane, unit: f64, margin: f32, occluder: &Occluder, sign: f32) -> Self {
        let outline: Vec<V<f32>> = occluder.outline().iter().map(|&p| frame.point(p)).collect();
        let facets = occluder.facets().iter().map(|f| f.map(|p| frame.point(p))).collect();
        let at = frame.coordinate(plane.at(), plane.axis());
        let direction = if plane.positive() { 1.0 } else { -1.0 };
        let per_unit = (1.0 / (frame.scale * unit)) as f32;
        let tiny = if margin == 0.0 { 0.0 } else { TINY };
        let height = |p: &V<f32>| {
            let p = p[plane.axis()];
            direction * (at - p) - margin * (at.abs() + p.abs()) - tiny
        };
        let least = outline.iter().map(height).fold(f32::from_bits((127 + 100) << 23), f32::min);
        let value = ((least * per_unit).floor().max(0.0) as u32).saturating_add(1);
        Self { outline, facets, sign, value }
    }

    fn blocks(&self, half_size: V<f32>, t: V<f32>, margin: f32) -> bool {
        let n = self.outline.len();
        (0..n).all(|i| inner(half_size, [self.outline[i], self.outline[(i + 1) % n]], t, self.sign, margin))
            && self.facets.iter().all(|&f| behind(f, t, self.sign, margin))
    }
}

/// Draws one plane of a job as the shader does; with a margin of 0, as if its author had not known of rounding.
pub(crate) fn draw(job: &BufferJob<'_>, plane: &BufferPlane, margin: f32) -> Buffer {
    let b = job.volume().bounds();
    let [w, h] = plane.texels();
    let points = job.occluders().iter().flat_map(|o| o.outline().iter().chain(o.facets().iter().flatten()).copied());
    let frame = Frame::new(b.min, b.max, points.chain([plane.corner(0, 0), plane.corner(w, h)]));
    let half_size = frame.half_size(b.min, b.max);
    let corners = job.volume().corners();
    let occluders: Vec<FloatOccluder> = job
        .occluders()
        .iter()
        .filter_map(|o| {
            let sign = if o.side_of(&corners)? { 1.0 } else { -1.0 };
            Some(FloatOccluder::new(&frame, plane, job.unit(), margin, o, sign))
        })
        .collect();
    let mut out = Buffer::new(plane);
    // Each corner of the grid is tested once for each occluder.
    let row = w as usize + 1;
    for o in &occluders {
        let blocked: Vec<bool> = (0..row * (h as usize + 1))
            .map(|i| o.blocks(half_size, frame.point(plane.corner((i % row) as u32, (i / row) as u32)), margin))
            .collect();
        for (i, value) in out.values_mut().iter_mut().enumerate() {
            let at = i / w as usize * row + i % w as usize;
            if [at, at + 1, at + row, at + row + 1].iter().all(|&k| blocked[k]) {
                *value = (*value).max(o.value);
            }
        }
    }
    out
}

//! Jobs of one occluder whose umbra ends on lines between texels, nearly.

use crate::stability::predicates::cases::{Apart, Place};
use sightlines::geometry::{Aabb, Point3, Random};
use sightlines::multifocal::{BufferJob, BufferPlane, Measure, Occluder, Volume};

/// What a job is made of, so that it can be printed.
#[derive(Debug, Clone)]
pub(crate) struct Scene {
    pub(crate) volume: Volume,
    pub(crate) plane: BufferPlane,
    pub(crate) occluders: Vec<Occluder>,
}

impl Scene {
    pub(crate) fn job(&self, measure: Measure) -> BufferJob<'_> {
        BufferJob::new(self.volume, vec![self.plane], &self.occluders, measure, false)
            .expect("the plane is in front of the volume")
    }
}

/// Heights are counted from the plane; eyes are at this one.
const EYES: f64 = 16.0;

/// Axes and directions of a scene.
#[derive(Debug, Clone, Copy)]
struct Setting {
    axis: usize,
    positive: bool,
    place: Place,
}

impl Setting {
    fn random(place: Place, random: &mut Random) -> Self {
        Self { axis: random.below(3), positive: random.below(2) == 0, place }
    }

    /// The point across at `u` and `v`, at a height above the plane. Rounded.
    fn put(&self, u: f64, v: f64, height: f64) -> Point3 {
        let away = [self.place.far, -0.71 * self.place.far, 0.43 * self.place.far];
        let mut p = [0.0; 3];
        p[self.axis] = if self.positive { -height } else { height };
        p[(self.axis + 1) % 3] = u;
        p[(self.axis + 2) % 3] = v;
        std::array::from_fn(|k| (p[k] + away[k]) * self.place.scale)
    }

    /// The same for coordinates across that are final already.
    fn put_across(&self, [u, v]: [f64; 2], height: f64) -> Point3 {
        let mut p = self.put(0.0, 0.0, height);
        p[(self.axis + 1) % 3] = u;
        p[(self.axis + 2) % 3] = v;
        p
    }

    fn volume(&self, half: Point3) -> Volume {
        let [low, high] = [-1.0, 1.0].map(|s| self.put(s * half[0], s * half[1], EYES + s * half[2]));
        Volume::new(Aabb::around([low, high])).expect("it is a box")
    }

    /// Nothing if the window is too small for its place.
    fn plane(&self, half: [f64; 2], texels: [u32; 2]) -> Option<BufferPlane> {
        let [low, high] = [-1.0, 1.0].map(|s| self.put(s * half[0], s * half[1], 0.0));
        let across = |p: Point3| [p[(self.axis + 1) % 3], p[(self.axis + 2) % 3]];
        BufferPlane::new(self.axis, self.positive, low[self.axis], across(low), across(high), texels).ok()
    }

    /// A coordinate moved out or in.
    fn moved(&self, x: f64, random: &mut Random) -> f64 {
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        match self.place.apart {
            Apart::Part(part) => x + sign * part * self.place.scale,
            Apart::Ulps(n) => f64::from_bits(x.to_bits().wrapping_add_signed(if sign > 0.0 { n } else { -n })),
        }
    }
}

/// Where an occluder at height `q` has to end, on its upper or lower side, for its umbra to end on a line of the plane.
fn border(line: f64, eyes: [f64; 2], heights: [f64; 2], q: f64, upper: bool) -> f64 {
    let all = eyes.into_iter().flat_map(|eye| heights.map(|h| (line * (h - q) + eye * q) / h));
    if upper { all.fold(f64::NEG_INFINITY, f64::max) } else { all.fold(f64::INFINITY, f64::min) }
}

/// The sizes of a scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sizes {
    /// Half of the volume.
    pub(crate) volume: Point3,
    /// Half of the window.
    pub(crate) window: [f64; 2],
    pub(crate) texels: [u32; 2],
    /// How much one side of the occluder is higher than the other, along the first axis, as a slope.
    pub(crate) slope: f64,
}

/// One quadrilateral, of which each border of the umbra would be a line between texels, had its corners not been moved.
pub(crate) fn aligned(place: Place, sizes: &Sizes, random: &mut Random) -> Option<Scene> {
    let setting = Setting::random(place, random);
    let (volume, plane) = (setting.volume(sizes.volume), setting.plane(sizes.window, sizes.texels)?);
    let height = EYES * (0.3 + 0.4 * random.unit());
    let b = volume.bounds();
    let at = setting.put(0.0, 0.0, height);
    let q = plane.height(at);
    let heights = [plane.height(b.min), plane.height(b.max)];
    let mut ends = [[0.0; 2]; 2];
    for (k, ends) in ends.iter_mut().enumerate() {
        let axis = plane.across()[k];
        let n = sizes.texels[k] as usize;
        let first = random.below(n / 2);
        let last = n / 2 + 1 + random.below(n / 2);
        for (side, line) in [first, last].into_iter().enumerate() {
            let line = if k == 0 { plane.corner(line as u32, 0)[axis] } else { plane.corner(0, line as u32)[axis] };
            let end = border(line, [b.min[axis], b.max[axis]], heights, q, side == 1);
            ends[side] = setting.moved(end, random);
        }
        if ends[0] >= ends[1] {
            return None;
        }
    }
    let [[u0, u1], [v0, v1]] = ends;
    // Slopes are counted from the first side on.
    let rise = sizes.slope * (u1 - u0) / place.scale;
    let corners = [([u0, v0], 0.0), ([u1, v0], rise), ([u1, v1], rise), ([u0, v1], 0.0)]
        .map(|(across, rise)| setting.put_across(across, height + rise));
    let [p, q, r, s] = corners;
    let occluder = Occluder::patch(corners.to_vec(), &[[p, q, r], [p, r, s]]);
    // Which way round it goes depends on the axis's direction; either will do, but not both facets for one.
    let occluders = vec![occluder.ok().filter(Occluder::is_flat)?];
    Some(Scene { volume, plane, occluders })
}

/// Two rectangles side by side and the gap between: their ends.
#[derive(Debug, Clone)]
pub(crate) struct Gap {
    pub(crate) scene: Scene,
    pub(crate) triangles: Vec<[Point3; 3]>,
    /// The edges on both sides of the gap.
    pub(crate) edges: [[Point3; 2]; 2],
    /// The outline of both and the gap.
    pub(crate) whole: [Point3; 4],
}

/// A gap of some units in the last place, none for 0, in a large rectangle in front of the middle of the window.
pub(crate) fn gap(place: Place, ulps: i64, sizes: &Sizes, random: &mut Random) -> Option<Gap> {
    let setting = Setting::random(place, random);
    let (volume, plane) = (setting.volume(sizes.volume), setting.plane(sizes.window, sizes.texels)?);
    let height = EYES * (0.3 + 0.4 * random.unit());
    let [u0, v0] = [0; 2].map(|_| -5.0 - random.unit());
    let [u1, v1] = [0; 2].map(|_| 5.0 + random.unit());
    let middle = setting.put(2.0 * random.unit() - 1.0, 0.0, height)[plane.across()[0]];
    let other = f64::from_bits(middle.to_bits().wrapping_add_signed(ulps));
    let [left, right] = [middle.min(other), middle.max(other)];
    let low = setting.put(u0, v0, height);
    let high = setting.put(u1, v1, height);
    let [a, b] = plane.across();
    let at = |u: f64, v: f64| setting.put_across([u, v], height);
    let quad = |from: f64, to: f64| [at(from, low[b]), at(to, low[b]), at(to, high[b]), at(from, high[b])];
    let quads = [quad(low[a], left), quad(right, high[a])];
    let triangles: Vec<[Point3; 3]> = quads.iter().flat_map(|&[p, q, r, s]| [[p, q, r], [p, r, s]]).collect();
    let occluders = quads
        .iter()
        .map(|q| Occluder::patch(q.to_vec(), &[[q[0], q[1], q[2]]]).ok())
        .collect::<Option<Vec<Occluder>>>()?;
    let edges = [left, right].map(|u| [at(u, low[b]), at(u, high[b])]);
    let whole = quad(low[a], high[a]);
    Some(Gap { scene: Scene { volume, plane, occluders }, triangles, edges, whole })
}

//! Scenes on a small grid, and what hides in them, by intersecting segments with triangles in whole numbers.

use num_rational::BigRational;
use num_traits::Zero;
use proptest::prelude::*;
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{Buffer, BufferJob, BufferPlane, Measure, Occluder, Volume};

/// A point in whole numbers, in a frame that looks along z.
pub(crate) type Grid3 = [i64; 3];

/// A surface: outline and triangles.
#[derive(Debug, Clone)]
pub(crate) struct Surface {
    pub(crate) outline: Vec<Grid3>,
    pub(crate) triangles: Vec<[Grid3; 3]>,
}

/// A scene in whole numbers. Texels are `step` wide in each plane; the window starts at `low`.
#[derive(Debug, Clone)]
pub(crate) struct GridScene {
    pub(crate) eyes: [Grid3; 2],
    pub(crate) surfaces: Vec<Surface>,
    pub(crate) planes: Vec<i64>,
    pub(crate) low: [i64; 2],
    pub(crate) step: [i64; 2],
    pub(crate) texels: [u32; 2],
    /// The axis looked along, and whether towards larger coordinates.
    pub(crate) axis: usize,
    pub(crate) positive: bool,
}

fn point(scene: &GridScene, p: Grid3) -> Point3 {
    let mut q = [0.0; 3];
    q[(scene.axis + 1) % 3] = p[0] as f64;
    q[(scene.axis + 2) % 3] = p[1] as f64;
    q[scene.axis] = if scene.positive { p[2] } else { -p[2] } as f64;
    q
}

impl GridScene {
    pub(crate) fn occluders(&self) -> Vec<Occluder> {
        let occluder = |s: &Surface| {
            let triangles: Vec<_> = s.triangles.iter().map(|t| t.map(|p| point(self, p))).collect();
            Occluder::patch(s.outline.iter().map(|&p| point(self, p)).collect(), &triangles)
        };
        self.surfaces.iter().map(|s| occluder(s).expect("triangles have areas")).collect()
    }

    pub(crate) fn job<'a>(&self, occluders: &'a [Occluder], measure: Measure) -> BufferJob<'a> {
        let volume = Volume::new(Aabb::around(self.eyes.map(|p| point(self, p)))).expect("eyes are in a box");
        let [low, high] = [[0, 0], self.texels].map(|[x, y]| {
            [self.low[0] + i64::from(x) * self.step[0], self.low[1] + i64::from(y) * self.step[1]].map(|x| x as f64)
        });
        let plane = |&z: &i64| {
            let at = if self.positive { z } else { -z } as f64;
            let plane = BufferPlane::new(self.axis, self.positive, at, low, high, self.texels).expect("a window");
            assert_eq!(plane.origin(), low, "whole numbers make exact grids");
            assert_eq!(plane.end(), high, "whole numbers make exact grids");
            plane
        };
        let planes = self.planes.iter().map(plane).collect();
        BufferJob::new(volume, planes, occluders, measure, measure.is_height()).expect("a job")
    }

    pub(crate) fn eye_corners(&self) -> [Grid3; 8] {
        std::array::from_fn(|i| std::array::from_fn(|k| self.eyes[i >> k & 1][k]))
    }

    pub(crate) fn texel_corners(&self, plane: usize, x: u32, y: u32) -> [Grid3; 4] {
        [[x, y], [x + 1, y], [x, y + 1], [x + 1, y + 1]].map(|[x, y]| {
            [self.low[0] + i64::from(x) * self.step[0], self.low[1] + i64::from(y) * self.step[1], self.planes[plane]]
        })
    }

    /// All texels of all planes.
    pub(crate) fn all_texels(&self) -> impl Iterator<Item = (usize, u32, u32)> {
        let [w, h] = self.texels;
        (0..self.planes.len()).flat_map(move |k| (0..h).flat_map(move |y| (0..w).map(move |x| (k, x, y))))
    }
}

pub(crate) fn sub(a: Grid3, b: Grid3) -> Grid3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn dot(a: Grid3, b: Grid3) -> i64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Grid3, b: Grid3) -> Grid3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Where the segment from `p` to `v` meets a closed triangle: the part of the way. None if it does not, or lies in its
/// plane. By Cramer's rule for `p + t (v - p) = a + r (b - a) + s (c - a)`.
pub(crate) fn meets(p: Grid3, v: Grid3, [a, b, c]: [Grid3; 3]) -> Option<BigRational> {
    let (d, e, f, g) = (sub(v, p), sub(b, a), sub(c, a), sub(p, a));
    let n = cross(e, f);
    let det = -dot(d, n);
    if det == 0 {
        return None;
    }
    let (sign, det) = (det.signum(), det.abs());
    let t = sign * dot(g, n);
    let m = cross(g, d);
    let (r, s) = (sign * dot(f, m), -sign * dot(e, m));
    let inside = r >= 0 && s >= 0 && r + s <= det && (0..=det).contains(&t);
    inside.then(|| BigRational::new(t.into(), det.into()))
}

/// The largest measure at which anything blocks the segment from `p`, on a plane, to `v`: a height, or the square of
/// a distance.
pub(crate) fn blocked_from(
    scene: &GridScene,
    plane: usize,
    p: Grid3,
    v: Grid3,
    measure: Measure,
) -> Option<BigRational> {
    let all = scene.surfaces.iter().flat_map(|s| &s.triangles);
    let farthest = all.filter_map(|&t| meets(p, v, t)).max()?;
    let d = sub(v, p);
    let size = if measure.is_height() { scene.planes[plane] - v[2] } else { dot(d, d) };
    let part = if measure.is_height() { farthest } else { &farthest * &farthest };
    Some(part * BigRational::from_integer(size.into()))
}

/// The stored value as a height, or the square of a distance. None where nothing is known to block.
pub(crate) fn decoded(buffer: &Buffer, x: u32, y: u32, unit: f64, measure: Measure) -> Option<BigRational> {
    let units = buffer.get(x, y).checked_sub(1)?;
    let value = BigRational::from_float(f64::from(units) * unit).expect("values are finite");
    Some(if measure.is_height() { value } else { &value * &value })
}

/// Everything that is stored as blocked, against segments: those between corners, and those that `samples` picks inside.
/// Returns how many segments were looked at.
pub(crate) fn check_blocked(
    scene: &GridScene,
    buffers: &[Buffer],
    unit: f64,
    measure: Measure,
    samples: &[[i64; 5]],
) -> Result<usize, String> {
    let mut n_segments = 0;
    for (plane, x, y) in scene.all_texels() {
        let Some(value) = decoded(&buffers[plane], x, y, unit, measure) else { continue };
        let (eyes, texel) = (scene.eye_corners(), scene.texel_corners(plane, x, y));
        let corners = eyes.into_iter().flat_map(|v| texel.map(|p| (p, v)));
        // Whole numbers between the ends.
        let between = |low: i64, high: i64, i: i64| low + i.rem_euclid(high - low + 1);
        let inside = samples.iter().map(|s| {
            let v = [0, 1, 2].map(|k| between(eyes[0][k], eyes[7][k], s[k]));
            let p = [0, 1].map(|k| between(texel[0][k], texel[3][k], s[3 + k]));
            ([p[0], p[1], texel[0][2]], v)
        });
        for (p, v) in corners.chain(inside) {
            n_segments += 1;
            let met = blocked_from(scene, plane, p, v, measure);
            if met.as_ref().is_none_or(|met| *met < value) {
                let place = format!("plane {plane}, texel ({x}, {y}), from {p:?} to {v:?}");
                return Err(format!("{place}: {} {value} is stored, {met:?} is met", measure.name()));
            }
        }
    }
    Ok(n_segments)
}

fn is_flat([a, b, c]: &[Grid3; 3]) -> bool {
    cross(sub(*b, *a), sub(*c, *a)).iter().all(Zero::is_zero)
}

/// A corner between eyes and planes, or a little behind these.
fn corner() -> impl Strategy<Value = Grid3> {
    [-60i64..60, -60i64..60, 10i64..72].prop_map(|[x, y, z]| [x, y, z])
}

pub(crate) fn triangle() -> impl Strategy<Value = Surface> {
    let any = [corner(), corner(), corner()];
    // Around the axis, so that it hides something.
    let about = |x: i64, y: i64| [x - 20..x + 20, y - 20..y + 20, 20i64..60].prop_map(|[x, y, z]| [x, y, z]);
    let large = [about(-70, -50), about(0, 80), about(70, -50)];
    let triangle = |corners: [Grid3; 3]| Surface { outline: corners.to_vec(), triangles: vec![corners] };
    prop_oneof![1 => any.prop_map(triangle), 3 => large.prop_map(triangle)]
        .prop_filter("has an area", |s| !is_flat(&s.triangles[0]))
}

/// A quadrangle of two triangles, or a tent of four with a corner inside: bent, if not by chance.
pub(crate) fn bent() -> impl Strategy<Value = Surface> {
    let edge = 10i64..60;
    let heights = prop::collection::vec(30i64..50, 5);
    (edge.clone(), edge.clone(), edge.clone(), edge, heights, any::<bool>()).prop_map(|(w, e, s, n, z, tent)| {
        let q = [[-w, -s, z[0]], [-w, n, z[1]], [e, n, z[2]], [e, -s, z[3]]];
        let top = [(e - w) / 2, (n - s) / 2, z[4]];
        let triangles = if tent {
            (0..4).map(|i| [top, q[i], q[(i + 1) % 4]]).collect()
        } else {
            vec![[q[0], q[1], q[2]], [q[0], q[2], q[3]]]
        };
        Surface { outline: q.to_vec(), triangles }
    })
}

pub(crate) fn scene(
    surface: impl Strategy<Value = Surface>,
    n_surfaces: std::ops::RangeInclusive<usize>,
    n_planes: std::ops::RangeInclusive<usize>,
) -> impl Strategy<Value = GridScene> {
    let eyes = ([-8i64..8, -8i64..8, -8i64..1], [0i64..8, 0i64..8, 0i64..8]);
    let window = ([-60i64..0, -60i64..0], [1i64..16, 1i64..16], [1u32..5, 1u32..5]);
    let planes = prop::collection::btree_set(64i64..90, n_planes);
    let surfaces = prop::collection::vec(surface, n_surfaces);
    (eyes, surfaces, planes, window, 0..3usize, any::<bool>()).prop_map(
        |((low_eye, size), surfaces, planes, (low, step, texels), axis, positive)| GridScene {
            eyes: [low_eye, [0, 1, 2].map(|k| low_eye[k] + size[k])],
            surfaces,
            planes: planes.into_iter().collect(),
            low,
            step,
            texels,
            axis,
            positive,
        },
    )
}

//! Meshes of many kinds, sound and damaged, for methods that take occluders from triangles, and rays to judge these by.

use crate::{Random, RayScene};
use proptest::prelude::*;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::{Aabb, Point3};

/// Triangles in no particular order.
pub type Soup = Vec<[Point3; 3]>;

fn p(x: i32, y: i32, z: i32) -> Point3 {
    [x, y, z].map(f64::from)
}

/// Two triangles; `other` picks the diagonal.
pub fn quad([a, b, c, d]: [Point3; 4], other: bool) -> [[Point3; 3]; 2] {
    if other { [[a, b, d], [b, c, d]] } else { [[a, b, c], [a, c, d]] }
}

/// The twelve triangles of a box.
pub fn solid(min: Point3, max: Point3) -> Soup {
    let mut all = Soup::new();
    for k in 0..3 {
        let (u, v) = ((k + 1) % 3, (k + 2) % 3);
        for side in [min, max] {
            let corner = |x: f64, y: f64| {
                let mut c = [0.0; 3];
                (c[k], c[u], c[v]) = (side[k], x, y);
                c
            };
            let ring = [(min[u], min[v]), (max[u], min[v]), (max[u], max[v]), (min[u], max[v])];
            all.extend(quad(ring.map(|(x, y)| corner(x, y)), k == 1));
        }
    }
    all
}

/// A wall of `n` by `n` squares near x = 4 from (-1, -1) to (n - 1, n - 1), with bumps.
pub fn bumpy(n: i32, bumps: &[u8]) -> Soup {
    let at = |y: i32, z: i32| p(4 + i32::from(bumps[(y * (n + 1) + z) as usize % bumps.len()] % 3), y - 1, z - 1);
    let square = |i: i32| {
        let (y, z) = (i / n, i % n);
        quad([at(y, z), at(y + 1, z), at(y + 1, z + 1), at(y, z + 1)], (y + z) % 3 == 0)
    };
    (0..n * n).flat_map(square).collect()
}

/// An octahedron, each face in four, twice over, pushed out to a sphere.
pub fn sphere(middle: Point3, radius: f64, n_times: u32) -> Soup {
    let axis = |k: usize, s: f64| std::array::from_fn(|i| if i == k { s } else { 0.0 });
    let mut all = Soup::new();
    for i in 0..8 {
        let s = |k: usize| if i >> k & 1 == 0 { 1.0 } else { -1.0 };
        all.push([axis(0, s(0)), axis(1, s(1)), axis(2, s(2))]);
    }
    for _ in 0..n_times {
        let half = |a: Point3, b: Point3| -> Point3 {
            let m: Point3 = std::array::from_fn(|k| a[k] + b[k]);
            let l = m.iter().map(|x| x * x).sum::<f64>().sqrt();
            m.map(|x| x / l)
        };
        let split = |[a, b, c]: [Point3; 3]| {
            let [d, e, f] = [half(a, b), half(b, c), half(c, a)];
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        all = all.into_iter().flat_map(split).collect();
    }
    all.into_iter().map(|t| t.map(|p| std::array::from_fn(|k| middle[k] + radius * p[k]))).collect()
}

/// A wall at x = 4 of rectangles whose corners lie on the sides of others, from (-1, -1) to (9, 9): cut again and again.
pub fn uneven(cuts: &[u8]) -> Soup {
    let mut rectangles = vec![[-1, -1, 9, 9]];
    for &cut in cuts {
        let r = rectangles.remove(usize::from(cut) % rectangles.len());
        let axis = usize::from(cut >> 7);
        let at = r[axis] + 1 + i32::from(cut >> 3) % (r[axis + 2] - r[axis]).max(1);
        if at >= r[axis + 2] {
            rectangles.push(r);
            continue;
        }
        let (mut low, mut high) = (r, r);
        (low[axis + 2], high[axis]) = (at, at);
        rectangles.extend([low, high]);
    }
    let corners = |[a, b, c, d]: [i32; 4]| quad([p(4, a, b), p(4, c, b), p(4, c, d), p(4, a, d)], (a + b) % 2 == 0);
    rectangles.into_iter().flat_map(corners).collect()
}

/// Walls, floor and ceiling of a room with an open door at x = 0, as thin sheets.
pub fn room(door: [i32; 2]) -> Soup {
    let [low, high] = [door[0].min(door[1]), door[0].max(door[1]) + 1];
    let mut all = solid(p(0, -1, -1), p(8, 9, 9));
    all.retain(|t| t.iter().any(|c| c[0] != 0.0));
    let mut wall = |y0, y1, z0, z1| {
        if y0 < y1 && z0 < z1 {
            all.extend(quad([p(0, y0, z0), p(0, y1, z0), p(0, y1, z1), p(0, y0, z1)], false));
        }
    };
    wall(-1, low, -1, 9);
    wall(high, 9, -1, 9);
    wall(low, high, 4, 9);
    all
}

/// Some of the triangles are missing, twice there, turned over.
fn damaged(soup: Soup, missing: &[u16], twice: &[u16], turned: u64) -> Soup {
    let mut all: Soup = soup;
    for &i in twice {
        let t = all[usize::from(i) % all.len()];
        all.push([t[1], t[2], t[0]]);
    }
    for &i in missing {
        if all.len() > 1 {
            all.swap_remove(usize::from(i) % all.len());
        }
    }
    for (i, t) in all.iter_mut().enumerate() {
        if turned >> (i % 64) & 1 == 1 {
            t.swap(1, 2);
        }
    }
    all
}

fn integers(n: i32) -> impl Strategy<Value = Point3> {
    prop::array::uniform3(0..=n).prop_map(|q| q.map(f64::from))
}

/// Meshes of many kinds, within about -1 to 9 along each axis.
pub fn soup() -> impl Strategy<Value = Soup> {
    let boxes = prop::collection::vec((integers(7), prop::array::uniform3(1..=6)), 1..4).prop_map(|boxes| {
        let one = |(min, size): (Point3, [i32; 3])| solid(min, std::array::from_fn(|k| min[k] + f64::from(size[k])));
        boxes.into_iter().flat_map(one).collect::<Soup>()
    });
    let slabs = (1i32..7, 1i32..3).prop_map(|(x, d)| solid(p(x, -2, -2), p(x + d, 10, 10)));
    let bumps = (2i32..11, prop::collection::vec(any::<u8>(), 7)).prop_map(|(n, b)| bumpy(n, &b));
    let spheres = (integers(6), 1u32..5, 0u32..3).prop_map(|(m, r, n)| sphere(m, f64::from(r) * 0.9, n));
    let uneven = prop::collection::vec(any::<u8>(), 0..12).prop_map(|c| uneven(&c));
    let rooms = [-1i32..8, -1i32..8].prop_map(room);
    let junk = prop::collection::vec(prop::array::uniform3(integers(8)), 1..12);
    let one = prop_oneof![2 => boxes, 2 => slabs, 3 => bumps, 1 => spheres, 3 => uneven, 2 => rooms, 1 => junk];
    let few = |max: usize| prop::collection::vec(any::<u16>(), 0..max);
    let turned = prop_oneof![Just(0), any::<u64>()];
    let many = prop::collection::vec(one, 1..3).prop_map(|all| all.concat());
    (many, prop_oneof![2 => few(1), 1 => few(3)], few(3), turned)
        .prop_map(|(s, missing, twice, t)| damaged(s, &missing, &twice, t))
}

/// A box at low x, and one at high x or anywhere; either may be flat.
pub fn boxes() -> impl Strategy<Value = [Aabb<3>; 2]> {
    let cube = |low: i32, high: i32| {
        (low..=high, [0i32..9, 0i32..9], prop::array::uniform3(0u8..6)).prop_map(|(x, [y, z], size)| {
            let min = [x, y, z].map(f64::from);
            Aabb { min, max: std::array::from_fn(|k| min[k] + f64::from(size[k]) / 2.0) }
        })
    };
    [cube(-3, 2), cube(3, 10)].prop_flat_map(|b| prop_oneof![4 => Just(b), 1 => Just([b[1], b[0]])])
}

/// A scene of one object, to be traced.
///
/// # Panics
/// If coordinates are not finite.
pub fn scene(soup: &[[Point3; 3]]) -> RayScene {
    let vertices = soup.iter().flatten().copied().collect();
    let triangles = (0..soup.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let object = SceneObject { name: String::new(), vertices, triangles };
    RayScene::new(&Scene::new(vec![object]).expect("the coordinates are small"))
}

fn random_in(b: &Aabb<3>, random: &mut Random) -> Point3 {
    std::array::from_fn(|k| b.min[k] + (b.max[k] - b.min[k]) * random.unit())
}

/// A segment from `v` to `e` that meets nothing before its end, out of `n` random ones.
pub fn free_segment(rays: &RayScene, v: &Aabb<3>, e: &Aabb<3>, seed: u64, n: u64) -> Option<[Point3; 2]> {
    (0..n).find_map(|i| {
        let mut random = Random::new(seed, i);
        let (a, b) = (random_in(v, &mut random), random_in(e, &mut random));
        let direction = std::array::from_fn(|k| b[k] - a[k]);
        rays.first_hit(a, direction).is_none_or(|h| h.t >= 1.0).then_some([a, b])
    })
}

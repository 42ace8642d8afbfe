//! Meshes for tests: rectangles cut into triangles in many ways, boxes, rooms.

use proptest::prelude::*;
use sightlines_cells::{Point3, Scene, SceneObject};
use sightlines_geometry::Aabb;

/// An object from triangles, each with corners of its own.
pub(crate) fn object(name: &str, triangles: &[[Point3; 3]]) -> SceneObject {
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    SceneObject { name: name.to_owned(), vertices: triangles.as_flattened().to_vec(), triangles: indices }
}

/// A checked scene.
pub(crate) fn scene(objects: Vec<SceneObject>) -> Scene {
    Scene::new(objects).expect("coordinates are good")
}

/// The rectangle between two corners on a plane of `axis` in two triangles, its front towards larger
/// coordinates if `up`.
pub(crate) fn quad(axis: usize, min: Point3, max: Point3, up: bool) -> Vec<[Point3; 3]> {
    // Right-handed: u, v, axis.
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |far_u: bool, far_v: bool| {
        let mut p = min;
        p[u] = if far_u { max[u] } else { min[u] };
        p[v] = if far_v { max[v] } else { min[v] };
        p
    };
    let [a, b, c, d] = [corner(false, false), corner(true, false), corner(true, true), corner(false, true)];
    if up { vec![[a, b, c], [a, c, d]] } else { vec![[a, c, b], [a, d, c]] }
}

/// A box in twelve triangles, seen from outside; from inside if `inwards`.
pub(crate) fn cuboid(b: &Aabb<3>, inwards: bool) -> Vec<[Point3; 3]> {
    let side = |axis: usize, up: bool| {
        let (mut min, mut max) = (b.min, b.max);
        if up {
            min[axis] = b.max[axis]
        } else {
            max[axis] = b.min[axis]
        }
        quad(axis, min, max, up != inwards)
    };
    (0..3).flat_map(|axis| [side(axis, false), side(axis, true)]).flatten().collect()
}

/// A box from two corners.
pub(crate) const fn aabb(min: Point3, max: Point3) -> Aabb<3> {
    Aabb { min, max }
}

/// Rectangles with integer coordinates on planes of the cube of side `n`, as axis, low, high corner.
pub(crate) fn rectangle(n: i32) -> impl Strategy<Value = (usize, Point3, Point3)> {
    let corner = || prop::array::uniform3(0..=n);
    (0..3usize, corner(), corner()).prop_map(|(axis, p, q)| {
        let min: [i32; 3] = std::array::from_fn(|k| p[k].min(q[k]));
        let mut max: [i32; 3] = std::array::from_fn(|k| p[k].max(q[k]));
        max[axis] = min[axis];
        (axis, min.map(f64::from), max.map(f64::from))
    })
}

/// Boxes with integer coordinates in the cube of side `n`.
pub(crate) fn cube(n: i32) -> impl Strategy<Value = Aabb<3>> {
    prop::array::uniform3((0..n, 1..=n)).prop_map(move |spans| Aabb {
        min: spans.map(|(lo, _)| f64::from(lo)),
        max: spans.map(|(lo, len)| f64::from((lo + len).min(n))),
    })
}

/// Cuts a rectangle into smaller ones, then into triangles, as the digits of `seed` prescribe.
pub(crate) fn triangulated(axis: usize, min: Point3, max: Point3, seed: u64) -> Vec<[Point3; 3]> {
    let (k, rest) = ([(axis + 1) % 3, (axis + 2) % 3][(seed % 2) as usize], seed / 2);
    let cut = min[k] + 1.0 + (rest % 3) as f64;
    if rest % 5 < 2 && cut < max[k] {
        let (mut low, mut high) = (max, min);
        (low[k], high[k]) = (cut, cut);
        let mut out = triangulated(axis, min, low, rest / 15);
        out.extend(triangulated(axis, high, max, rest / 21));
        return out;
    }
    let mut two = quad(axis, min, max, rest % 7 < 3);
    if rest % 11 < 5 {
        // The other diagonal, and corners in another order.
        let mut other = [min, max];
        (other[0][k], other[1][k]) = (max[k], min[k]);
        let [a, c] = [min, max];
        let [b, d] = other;
        two = vec![[b, d, a], [d, b, c]];
    }
    two
}

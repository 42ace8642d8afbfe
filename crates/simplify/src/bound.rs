//! How much of the view a triangle can take up: a proven bound for all eyes of a box.
//!
//! From an eye at distance `r` of a piece of surface `dA`, seen at the angle `theta` from its normal, the piece takes up
//! `cos(theta) dA / r^2` of the sphere's `4 pi`, and `cos(theta) = h / r`, where `h` is the eye's distance to the surface's plane. So a
//! triangle takes up at most `A min(1 / d^2, h / d^3)` if all eyes are at least at distance `d` from it and at most at
//! distance `h` from its plane; and at most half of the sphere, as all of it lies on one side of a plane through the
//! eye. A triangle that is large compared with its distance is split in four at the midpoints of its sides, and the
//! bounds of its parts are added.
//!
//! # Rounding
//! Every step is rounded so that the result can only grow. Parts have exactly a quarter of the area and the same plane,
//! so only their bounding boxes are constructed; their corners are widened by the rounding of the midpoints.

use sightlines_geometry::{Aabb, Point3};

/// Unit of rounding of doubles, 2^-53.
const U: f64 = f64::EPSILON / 2.0;
/// A lower bound of `4 pi` as a double.
const SPHERE: f64 = 12.566_370_614_359_172;

/// The largest share of the sphere of directions that a triangle takes up for any eye of a box, from 0 to 1/2.
///
/// * `eyes`: the closed box, scene units
/// * `depth`: how often the triangle is split in four at most; each split improves the bound where the box is near
///
/// Errs upwards only. 1/2 for triangles that touch the box; near 0, but not always 0, for triangles without area.
/// O(4^depth) in the worst case.
///
/// # Source
/// The bound is elementary; that a sum of such bounds limits the error of an image for all eyes is the idea of Andújar
/// et al., "Integrating occlusion culling and levels of detail through hardly-visible sets", Computer Graphics Forum
/// 19(3), 2000.
pub fn share(triangle: &[Point3; 3], eyes: &Aabb<3>, depth: u32) -> f64 {
    let plane = PlaneOf::new(triangle, eyes);
    let largest = triangle.iter().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
    Piece { corners: *triangle, area: plane.area, level: 0 }.share(&plane, eyes, largest, depth).min(0.5)
}

/// The data that all parts of a triangle share.
struct PlaneOf {
    /// An upper bound of the area.
    area: f64,
    /// A lower bound of the least distance of an eye from the plane, and an upper bound of the greatest.
    heights: [f64; 2],
}

/// The result of a sum or product of non-negative numbers, rounded up.
fn up(x: f64) -> f64 {
    if x == 0.0 { x } else { x.next_up() }
}

/// The same, rounded down.
fn down(x: f64) -> f64 {
    if x <= 0.0 { 0.0 } else { x.next_down() }
}

/// An upper bound of the length of a vector with non-negative components.
fn length_up(v: Point3) -> f64 {
    let sum = v.iter().fold(0.0, |sum, &x| up(sum + (x * x).next_up()));
    up(sum.sqrt())
}

/// A lower bound of that length.
fn length_down(v: Point3) -> f64 {
    let sum = v.iter().fold(0.0, |sum, &x| down(sum + down(x * x)));
    down(sum.sqrt())
}

impl PlaneOf {
    fn new(&[a, b, c]: &[Point3; 3], eyes: &Aabb<3>) -> Self {
        let sub = |p: Point3, q: Point3| [0, 1, 2].map(|k| p[k] - q[k]);
        let (u, v) = (sub(b, a), sub(c, a));
        // Each product has two rounded differences and its own rounding, and the difference rounds once more: less than
        // 5 U of the products' sizes, plus what is lost below the smallest normal number.
        let part = |i: usize, j: usize| {
            let (s, t) = (u[i] * v[j], u[j] * v[i]);
            (s - t, 8.0 * U * (s.abs() + t.abs()) + 4.0 * f64::MIN_POSITIVE)
        };
        let parts = [part(1, 2), part(2, 0), part(0, 1)];
        let (n, off) = (parts.map(|p| p.0), parts.map(|p| p.1));
        let longest = length_up([0, 1, 2].map(|k| up(n[k].abs() + off[k])));
        let shortest = length_down([0, 1, 2].map(|k| down(n[k].abs() - off[k])));
        // The plane's function at the corners of the box, each with its error: of the normal, and four roundings.
        let (mut least, mut most, mut sides) = (f64::INFINITY, 0.0f64, [false; 2]);
        for corner in 0..8 {
            let x = sub([0, 1, 2].map(|k| if corner >> k & 1 == 0 { eyes.min[k] } else { eyes.max[k] }), a);
            let value: f64 = (0..3).map(|k| n[k] * x[k]).sum();
            let error = (0..3).map(|k| (off[k] + 8.0 * U * (n[k].abs() + off[k])) * x[k].abs()).sum::<f64>();
            let error = error * (1.0 + 16.0 * U) + 8.0 * f64::MIN_POSITIVE;
            least = least.min(down(value.abs() - error));
            most = most.max(up(value.abs() + error));
            sides[usize::from(value > 0.0)] = true;
        }
        if sides == [true, true] {
            least = 0.0;
        }
        let highest = if shortest > 0.0 { up(most / shortest) } else { f64::INFINITY };
        let lowest = if longest > 0.0 { down(least / longest) } else { 0.0 };
        Self { area: up(longest / 2.0), heights: [lowest, highest] }
    }
}

/// A lower bound of the distance of two boxes, in scene units: 0 if they touch.
pub(crate) fn distance(a: &Aabb<3>, b: &Aabb<3>) -> f64 {
    apart(a, b, 0.0)
}

/// A lower bound of their distance, if the first may be larger by `off` on each side.
fn apart(a: &Aabb<3>, b: &Aabb<3>, off: f64) -> f64 {
    let gap = |k: usize| {
        let apart = (a.min[k] - b.max[k]).max(b.min[k] - a.max[k]);
        // The difference rounds once.
        down(down(apart) - off)
    };
    length_down([gap(0), gap(1), gap(2)])
}

/// A part of a triangle.
struct Piece {
    /// Rounded at most once for each level.
    corners: [Point3; 3],
    /// An upper bound of its area.
    area: f64,
    level: u32,
}

impl Piece {
    fn share(&self, plane: &PlaneOf, eyes: &Aabb<3>, largest: f64, depth: u32) -> f64 {
        let around = Aabb::<3>::around(self.corners);
        // A midpoint is off by the rounding of a number no larger than the corners, in addition to the error of its
        // ends.
        let off = 2.0 * U * largest * f64::from(self.level) + f64::MIN_POSITIVE * f64::from(self.level);
        let near = apart(&around, eyes, off).max(plane.heights[0]);
        let size = (0..3).map(|k| around.max[k] - around.min[k]).fold(0.0, f64::max);
        if self.level < depth && size > near / 8.0 {
            return self.parts().iter().fold(0.0, |sum, part| up(sum + part.share(plane, eyes, largest, depth)));
        }
        if near == 0.0 {
            return 0.5;
        }
        let square = down(near * near);
        let slanted = if plane.heights[1] < near { up(plane.heights[1] / near) } else { 1.0 };
        let share = up(up(up(self.area / square) * slanted) / SPHERE);
        // The share of a triangle with an area is never 0, however small it is.
        if share.is_nan() { 0.5 } else { share.clamp(f64::from_bits(1), 0.5) }
    }

    fn parts(&self) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let middle = |p: Point3, q: Point3| [0, 1, 2].map(|k| p[k] / 2.0 + q[k] / 2.0);
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        // A quarter is exact except below the smallest normal number, where it is rounded up.
        let (area, level) = (up(self.area / 4.0), self.level + 1);
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(|corners| Self { corners, area, level })
    }
}

#[cfg(test)]
mod tests;

//! Vectors in doubles, for estimates only.

use sightlines_geometry::{Point2, Point3, orient2d, vector as geometry};

pub(super) use sightlines_geometry::vector::{add, cross, dot, length, normal, scale, sub};

/// The vector of length 1, or zero if there is no direction: a patch without area then faces nothing.
pub(super) fn unit(a: Point3) -> Point3 {
    geometry::unit(a).unwrap_or_default()
}

/// Area of a loop along its right-hand normal.
pub(super) fn vector_area(outline: &[Point3]) -> Point3 {
    let Some(&o) = outline.first() else { return [0.0; 3] };
    let twice = outline.windows(2).fold([0.0; 3], |sum, w| add(sum, cross(sub(w[0], o), sub(w[1], o))));
    scale(twice, 0.5)
}

/// Whether three points lie on a line. Exact.
pub fn collinear(a: Point3, b: Point3, c: Point3) -> bool {
    (0..3).all(|k| {
        let of = |p: Point3| Point2::new(p[k], p[(k + 1) % 3]);
        orient2d(of(a), of(b), of(c)) == 0.0
    })
}

/// Two directions of length 1 across `n`, at right angles, so that `n` is their right-hand normal.
pub(super) fn basis(n: Point3) -> [Point3; 2] {
    let k = (0..3).min_by(|&a, &b| n[a].abs().total_cmp(&n[b].abs())).expect("there are three axes");
    let axis: Point3 = std::array::from_fn(|i| f64::from(u8::from(i == k)));
    let u = unit(cross(axis, n));
    [u, unit(cross(n, u))]
}

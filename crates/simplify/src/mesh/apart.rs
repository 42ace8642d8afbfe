//! How far the surface is apart before and after a change.

use super::{Change, Mesh};
use crate::vector::{cross, dot, length, minus, normal};
use sightlines_geometry::Point3;

/// Unit of rounding of doubles, 2^-53.
const U: f64 = f64::EPSILON / 2.0;

/// How far a point of the faces at `change.from` is from those that replace them at most, and the other way round, in scene units.
///
/// Seen along the mean normal, the faces around a place are a fan that covers an outline once; afterwards they cover the same outline from another
/// corner of it, so the two surfaces are apart by no more than the outline's corners differ in height. On a border the outline loses or
/// gains a triangle, no wider than the corner that goes is away from the new edge. Where the fan is no such thing, the bound is the
/// way that the corner goes.
pub(super) fn apart(mesh: &Mesh, change: &Change) -> f64 {
    let (from, to) = (mesh.place(change.from), mesh.place(change.to));
    seen_from_above(mesh, change).unwrap_or_else(|| length(minus(to, from)) * (1.0 + 8.0 * U)) + f64::MIN_POSITIVE
}

fn seen_from_above(mesh: &Mesh, change: &Change) -> Option<f64> {
    let from = mesh.place(change.from);
    let faces: Vec<u32> = mesh.at(change.from).to_vec();
    let before: Vec<[Point3; 3]> = faces.iter().map(|&f| local(mesh.corners(f), from)).collect();
    let up = before.iter().map(normal).fold([0.0; 3], |sum, n| [0, 1, 2].map(|k| sum[k] + n[k]));
    let long = length(up);
    if !(long > 0.0 && long.is_finite()) {
        return None;
    }
    let up = up.map(|x| x / long);
    let is_up = |t: &[Point3; 3]| dot(normal(t), up) > 0.0;
    let mut after = change.moved.iter().map(|&(f, _)| local(change.corners(mesh, f), from));
    if !before.iter().all(is_up) || !after.all(|t| is_up(&t)) || !covers_once(mesh, change.from, &faces, up) {
        return None;
    }
    let heights = before.iter().flatten().map(|&p| dot(p, up));
    let (low, high) = heights.fold((0.0f64, 0.0f64), |(low, high), h| (low.min(h), high.max(h)));
    // Differences of places, products, two sums; and `up` is a unit vector but for four roundings.
    let size = before.iter().flatten().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
    let height = high - low + 32.0 * U * size;
    let border: Vec<u32> = mesh.around(change.from).iter().filter(|(_, n)| *n == 1).map(|(p, _)| *p).collect();
    let aside = match border[..] {
        [] => 0.0,
        [a, b] => {
            let [a, b] = [a, b].map(|p| minus(mesh.place(p), from));
            to_segment(a, b) + 32.0 * U * size
        }
        _ => return None,
    };
    Some((height + aside) * (1.0 + 8.0 * U))
}

/// Whether a fan whose faces are all seen from the front covers what it covers once: whether its rim goes round once at most.
fn covers_once(mesh: &Mesh, centre: u32, faces: &[u32], up: Point3) -> bool {
    // Two directions across.
    let k = (0..3).fold(0, |least, k| if up[k].abs() < up[least].abs() { k } else { least });
    let mut axis = [0.0; 3];
    axis[k] = 1.0;
    let x = cross(up, axis);
    let y = cross(up, x);
    let place = mesh.place(centre);
    // The rim turns one way only, so it goes round as often as it gets from below the line along x to above.
    let rounds = faces.iter().filter(|&&face| {
        let corners = mesh.face(face).corners;
        let at = corners.iter().position(|&c| c == centre).unwrap_or(0);
        let [a, b] = [1, 2].map(|i| minus(mesh.place(corners[(at + i) % 3]), place));
        let (ya, yb) = (dot(a, y), dot(b, y));
        (ya < 0.0) != (yb < 0.0) && dot(a, x) * yb.abs() + dot(b, x) * ya.abs() > 0.0
    });
    rounds.count() <= 1
}

/// How far the origin is from a segment.
fn to_segment(a: Point3, b: Point3) -> f64 {
    let way = minus(b, a);
    let square = dot(way, way);
    let t = if square > 0.0 { (-dot(a, way) / square).clamp(0.0, 1.0) } else { 0.0 };
    length([0, 1, 2].map(|k| a[k] + t * way[k]))
}

fn local(t: [Point3; 3], origin: Point3) -> [Point3; 3] {
    t.map(|p| minus(p, origin))
}

//! The distance between the surfaces before and after a change.

use super::{Change, Mesh};
use sightlines_geometry::Point3;
use sightlines_geometry::vector::{dot, length, normal, sub};

/// Unit of rounding of doubles, 2^-53.
const U: f64 = f64::EPSILON / 2.0;

/// Upper bound of the distance of a point of the faces at `change.from` from the faces that replace them, and the other
/// way round, in scene units.
///
/// Seen along the mean normal, if the faces around a place all show their fronts, before and after, and their rim is a
/// single path, both cover the same outline equally often, and their distance is at most the difference in height of
/// the outline's corners. On a border the outline loses or gains a triangle, no wider than the distance of the removed
/// corner from the new edge. Otherwise the bound is the distance that the corner moves.
pub(super) fn apart(mesh: &Mesh, change: &Change) -> f64 {
    let (from, to) = (mesh.place(change.from), mesh.place(change.to));
    seen_from_above(mesh, change).unwrap_or_else(|| length(sub(to, from)) * (1.0 + 8.0 * U)) + f64::MIN_POSITIVE
}

fn seen_from_above(mesh: &Mesh, change: &Change) -> Option<f64> {
    let from = mesh.place(change.from);
    let faces: Vec<u32> = mesh.at(change.from).to_vec();
    let before: Vec<[Point3; 3]> = faces.iter().map(|&f| local(mesh.corners(f), from)).collect();
    let up = before.iter().map(|t| normal(*t)).fold([0.0; 3], |sum, n| [0, 1, 2].map(|k| sum[k] + n[k]));
    let long = length(up);
    if !(long > 0.0 && long.is_finite()) {
        return None;
    }
    let up = up.map(|x| x / long);
    let is_up = |t: &[Point3; 3]| dot(normal(*t), up) > 0.0;
    let mut after = change.moved.iter().map(|&(f, _)| local(change.corners(mesh, f), from));
    if !before.iter().all(is_up) || !after.all(|t| is_up(&t)) || !has_plain_rim(mesh, change.from, &faces) {
        return None;
    }
    let heights = before.iter().flatten().map(|&p| dot(p, up));
    let (low, high) = heights.fold((0.0f64, 0.0f64), |(low, high), h| (low.min(h), high.max(h)));
    // In units of U times the largest coordinate; points are at most sqrt(3) times that away. They are differences (1),
    // `up` is a unit vector except for four roundings (4), products and two sums (3), so a height is off by 8 sqrt(3),
    // two by 28; their difference, twice as large, is rounded once (4).
    let size = before.iter().flatten().flatten().fold(0.0f64, |m, x| m.max(x.abs()));
    let height = high - low + 32.0 * U * size;
    let border: Vec<u32> = mesh.around(change.from).iter().filter(|(_, n)| *n == 1).map(|(p, _)| *p).collect();
    let aside = match border[..] {
        [] => 0.0,
        [a, b] => {
            let [a, b] = [a, b].map(|p| sub(mesh.place(p), from));
            // In the same units: a coordinate of the nearest point comes from differences (1 and 4), a product (2) and
            // a sum (1); three of these errors of 8 amount to 14; squares, sums and the root add 5.
            to_segment(a, b) + 32.0 * U * size
        }
        _ => return None,
    };
    Some((height + aside) * (1.0 + 8.0 * U))
}

/// Whether the rim of the faces around a place is a single path: no place on it begins two edges, or ends two.
fn has_plain_rim(mesh: &Mesh, centre: u32, faces: &[u32]) -> bool {
    let mut ends = [Vec::new(), Vec::new()];
    for &face in faces {
        let corners = mesh.face(face).corners;
        let at = corners.iter().position(|&c| c == centre).unwrap_or(0);
        ends[0].push(corners[(at + 1) % 3]);
        ends[1].push(corners[(at + 2) % 3]);
    }
    ends.iter_mut().all(|places| {
        places.sort_unstable();
        places.windows(2).all(|w| w[0] != w[1])
    })
}

/// The distance of the origin from a segment.
fn to_segment(a: Point3, b: Point3) -> f64 {
    let way = sub(b, a);
    let square = dot(way, way);
    let t = if square > 0.0 { (-dot(a, way) / square).clamp(0.0, 1.0) } else { 0.0 };
    length([0, 1, 2].map(|k| a[k] + t * way[k]))
}

fn local(t: [Point3; 3], origin: Point3) -> [Point3; 3] {
    t.map(|p| sub(p, origin))
}

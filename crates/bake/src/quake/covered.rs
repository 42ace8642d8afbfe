//! Which openings the faces of a map cover.

use sightlines_formats::quake::bsp::FaceCover;
use sightlines_geometry::Point3;
use std::collections::HashMap;

/// How far faces may end before the border of what they are meant to cover, in map units.
///
/// Compilers move corners of faces: to whole numbers if they are nearer than 0.001 to 0.05, and by as much when they merge corners. What is
/// solid is closed if its faces say so up to that precision.
const FACE_PRECISION: f64 = 0.25;

/// Openings that are no wider count as covered, in map units: compilers clip with tolerances of 0.01 to 0.1, and what is narrower gets no face. The planes of
/// walls that meet in one line are rounded, so there are many such.
const SLIVER: f64 = 0.125;

/// An opening of which faces leave more pieces than this counts as open.
const MOST_PIECES: usize = 256;

/// The opaque faces of a map, by the plane and the side that they are drawn on.
#[derive(Debug)]
pub(super) struct Covers {
    of_plane: HashMap<[u64; 4], Vec<Face>>,
}

/// A face as its plane is seen along an axis: its hull, counter-clockwise, and the box around it.
#[derive(Debug)]
struct Face {
    corners: Vec<Point2>,
    /// How far its own corners are inside of the hull, at most.
    dent: f64,
    low: Point2,
    high: Point2,
}

/// Whether a convex polygon on a plane is so narrow that no compiler gives it a face. Rounded arithmetic.
pub(super) fn is_sliver(normal: Point3, polygon: &[Point3]) -> bool {
    let view = View::along(normal);
    let whole = hull(polygon.iter().map(|p| view.of(p)).collect());
    let across = |edge: [Point2; 2]| whole.iter().map(|&p| -height(edge, p)).fold(0.0, f64::max);
    // What is seen of a width is at least this part of it.
    whole.len() < 3 || edges(&whole).map(across).fold(f64::INFINITY, f64::min) <= SLIVER * view.slope
}

impl Covers {
    /// Sorts faces, given with their corners.
    pub(super) fn new<'c>(faces: impl Iterator<Item = (FaceCover, &'c [Point3])>) -> Self {
        let mut of_plane: HashMap<_, Vec<Face>> = HashMap::new();
        for (cover, corners) in faces.filter(|(cover, corners)| cover.is_opaque && corners.len() > 2) {
            let view = View::along(cover.normal);
            let key = key(cover.normal, cover.distance, usize::from(cover.side));
            of_plane.entry(key).or_default().push(Face::new(corners.iter().map(|p| view.of(p)).collect()));
        }
        Self { of_plane }
    }

    /// Whether faces that are drawn on a side of a plane (0 in front, 1 behind) cover a convex polygon on it: whether nothing of it is left that is farther than
    /// their precision from all of them. A face that is not convex, but for dents within the precision, covers nothing. Rounded arithmetic.
    /// O(faces of the plane × pieces).
    pub(super) fn cover(&self, (normal, distance): (Point3, f64), side: usize, polygon: &[Point3]) -> bool {
        let Some(faces) = self.of_plane.get(&key(normal, distance, side)) else { return false };
        let view = View::along(normal);
        let whole = Face::new(polygon.iter().map(|p| view.of(p)).collect());
        // So that it is no farther in the plane than the precision.
        let margin = FACE_PRECISION * view.slope;
        let mut pieces = vec![whole.corners.clone()];
        for face in faces.iter().filter(|face| face.is_near(&whole, margin)) {
            pieces = pieces.into_iter().flat_map(|piece| face.leave(piece, margin)).collect();
            if pieces.is_empty() || pieces.len() > MOST_PIECES {
                break;
            }
        }
        pieces.is_empty()
    }
}

impl Face {
    fn new(own: Vec<Point2>) -> Self {
        let corners = hull(own.clone());
        let to_border = |p: &Point2| edges(&corners).map(|edge| -height(edge, *p)).fold(f64::INFINITY, f64::min);
        let dent = own.iter().map(to_border).fold(0.0, f64::max);
        let bound = |k: usize, least: fn(f64, f64) -> f64, start: f64| corners.iter().map(|p| p[k]).fold(start, least);
        let low = [0, 1].map(|k| bound(k, f64::min, f64::INFINITY));
        let high = [0, 1].map(|k| bound(k, f64::max, f64::NEG_INFINITY));
        Self { corners, dent, low, high }
    }

    fn is_near(&self, other: &Self, margin: f64) -> bool {
        (0..2).all(|k| self.low[k] - margin <= other.high[k] && other.low[k] <= self.high[k] + margin)
    }

    /// What the face leaves of a convex polygon, if it is widened so that it has nothing that is farther from it than a margin. A face with deeper dents
    /// leaves all.
    fn leave(&self, mut polygon: Vec<Point2>, margin: f64) -> Vec<Vec<Point2>> {
        let by = margin - self.dent;
        if by < 0.0 {
            return vec![polygon];
        }
        let mut left = Vec::new();
        for edge in edges(&self.corners) {
            left.push(half(&polygon, |p| height(edge, p) - by));
            polygon = half(&polygon, |p| by - height(edge, p));
        }
        left.retain(|piece| area(piece) > 0.0);
        left
    }
}

type Point2 = [f64; 2];

/// A plane, seen along the axis that is nearest to its normal.
struct View {
    axis: usize,
    /// How much of a length in the plane is seen at least.
    slope: f64,
}

impl View {
    fn along(normal: Point3) -> Self {
        let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
        let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
        Self { axis, slope: normal[axis].abs() / length }
    }

    fn of(&self, p: &Point3) -> Point2 {
        [p[(self.axis + 1) % 3], p[(self.axis + 2) % 3]]
    }
}

/// The plane and the side that faces are sought by; a plane and its opposite are the same.
fn key(normal: Point3, distance: f64, side: usize) -> [u64; 4] {
    let is_behind = side == 1;
    let [x, y, z] = normal;
    [x, y, z, distance].map(|k| (if is_behind { 0.0 - k } else { k + 0.0 }).to_bits())
}

fn edges(polygon: &[Point2]) -> impl Iterator<Item = [Point2; 2]> + '_ {
    (0..polygon.len()).map(|k| [polygon[k], polygon[(k + 1) % polygon.len()]])
}

fn area(polygon: &[Point2]) -> f64 {
    let Some(start) = polygon.first() else { return 0.0 };
    let cross = |[p, q]: [Point2; 2]| (p[0] - start[0]) * (q[1] - start[1]) - (p[1] - start[1]) * (q[0] - start[0]);
    edges(polygon).map(cross).sum::<f64>() / 2.0
}

/// How far a point is outside of an edge of what lies to its left.
fn height([p, q]: [Point2; 2], r: Point2) -> f64 {
    let [dx, dy] = [q[0] - p[0], q[1] - p[1]];
    ((r[0] - p[0]) * dy - (r[1] - p[1]) * dx) / (dx * dx + dy * dy).sqrt()
}

/// The corners of the convex hull, counter-clockwise; rounded.
fn hull(mut points: Vec<Point2>) -> Vec<Point2> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let mut corners: Vec<Point2> = Vec::with_capacity(points.len() + 1);
    // Lower chain forwards, upper chain backwards.
    for pass in 0..2 {
        let start = corners.len();
        for k in 0..points.len() {
            let p = points[if pass == 0 { k } else { points.len() - 1 - k }];
            while let [.., a, b] = corners[start..]
                && (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) <= 0.0
            {
                corners.pop();
            }
            corners.push(p);
        }
        corners.pop();
    }
    corners
}

/// The part of a convex polygon where a height is not negative.
fn half(polygon: &[Point2], height: impl Fn(Point2) -> f64) -> Vec<Point2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for [a, b] in edges(polygon) {
        let (ha, hb) = (height(a), height(b));
        if ha >= 0.0 {
            kept.push(a);
        }
        if (ha > 0.0 && hb < 0.0) || (ha < 0.0 && hb > 0.0) {
            let t = ha / (ha - hb);
            kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rectangle at x = 0, in y and z.
    fn rectangle(y: [f64; 2], z: [f64; 2]) -> Vec<Point3> {
        vec![[0.0, y[0], z[0]], [0.0, y[1], z[0]], [0.0, y[1], z[1]], [0.0, y[0], z[1]]]
    }

    fn is_covered(faces: &[(Vec<Point3>, bool)], side: usize) -> bool {
        let cover = |is_opaque: bool| FaceCover { normal: [1.0, 0.0, 0.0], distance: 0.0, side: 0, is_opaque };
        let covers = Covers::new(faces.iter().map(|(corners, is_opaque)| (cover(*is_opaque), &corners[..])));
        covers.cover(([1.0, 0.0, 0.0], 0.0), side, &rectangle([0.0, 128.0], [0.0, 128.0]))
    }

    /// A wall of four faces round a hole.
    fn round_hole(size: f64) -> Vec<(Vec<Point3>, bool)> {
        let (a, b) = (60.0, 60.0 + size);
        let all = [([0.0, a], [0.0, 128.0]), ([b, 128.0], [0.0, 128.0]), ([a, b], [0.0, a]), ([a, b], [b, 128.0])];
        all.map(|(y, z)| (rectangle(y, z), true)).to_vec()
    }

    #[test]
    fn holes_are_found_however_large_the_wall() {
        assert!(is_covered(&[(rectangle([0.0, 128.0], [0.0, 128.0]), true)], 0));
        // Faces that end a little before the border, and whose corners go round the other way.
        let mut short = rectangle([0.1, 127.9], [0.2, 127.8]);
        short.reverse();
        assert!(is_covered(&[(short, true)], 0));
        assert!(is_covered(&round_hole(0.0), 0) && is_covered(&round_hole(0.4), 0));
        for size in [0.6, 8.0, 11.0] {
            assert!(!is_covered(&round_hole(size), 0), "a hole of {size}");
            // Faces that lie twice do not make up for it.
            assert!(!is_covered(&[round_hole(size), round_hole(size)].concat(), 0), "a hole of {size}");
            // A fence in the hole is none either, a lid is.
            let lid = |is_opaque: bool| (rectangle([60.0, 60.0 + size], [60.0, 60.0 + size]), is_opaque);
            assert!(!is_covered(&[round_hole(size), vec![lid(false)]].concat(), 0));
            assert!(is_covered(&[round_hole(size), vec![lid(true)]].concat(), 0));
        }
    }

    #[test]
    fn slivers_are_narrow_whatever_their_length_and_tilt() {
        let strip = |width: f64| rectangle([0.0, 900.0], [0.0, width]);
        assert!([0.0, 1e-5, 0.12].iter().all(|&width| is_sliver([1.0, 0.0, 0.0], &strip(width))));
        assert!([0.13, 1.0].iter().all(|&width| !is_sliver([1.0, 0.0, 0.0], &strip(width))));
        // Tilted by 45 degrees, and measured in the plane.
        let tilted =
            |width: f64| strip(width * 0.5f64.sqrt()).into_iter().map(|[_, y, z]| [-z, y, z]).collect::<Vec<_>>();
        assert!(is_sliver([1.0, 0.0, 1.0], &tilted(0.12)) && !is_sliver([1.0, 0.0, 1.0], &tilted(0.13)));
    }

    #[test]
    fn faces_count_on_their_side_and_plane_only() {
        let whole = (rectangle([0.0, 128.0], [0.0, 128.0]), true);
        assert!(!is_covered(std::slice::from_ref(&whole), 1) && !is_covered(&[], 0));
        let opposite = FaceCover { normal: [-1.0, 0.0, 0.0], distance: -0.0, side: 1, is_opaque: true };
        let covers = Covers::new([(opposite, &whole.0[..])].into_iter());
        assert!(covers.cover(([1.0, 0.0, 0.0], 0.0), 0, &whole.0));
        assert!(!covers.cover(([1.0, 0.0, 0.0], 1.0), 0, &whole.0));
    }
}

//! Which part of an opening the faces of a map cover.

use sightlines_formats::quake::bsp::FaceCover;
use sightlines_geometry::Point3;
use std::collections::HashMap;

/// Openings into what is solid count as covered if what faces leave of them is on average no wider than this along their border, in map units.
///
/// Compilers move corners of faces: to whole numbers if they are nearer than 0.001 to 0.05, and by as much when they merge corners. What is
/// solid is closed if its faces say so up to that precision.
const FACE_PRECISION: f64 = 0.25;

/// The opaque faces of a map, by the plane and the side that they are drawn on.
#[derive(Debug)]
pub(super) struct Covers<'c> {
    of_plane: HashMap<[u64; 4], Vec<usize>>,
    faces: Vec<&'c [Point3]>,
}

impl<'c> Covers<'c> {
    /// Sorts faces, given with their corners.
    pub(super) fn new(faces: impl Iterator<Item = (FaceCover, &'c [Point3])>) -> Self {
        let mut covers = Self { of_plane: HashMap::new(), faces: Vec::new() };
        for (cover, corners) in faces.filter(|(cover, _)| cover.is_opaque) {
            let key = key(cover.normal, cover.distance, usize::from(cover.side));
            covers.of_plane.entry(key).or_default().push(covers.faces.len());
            covers.faces.push(corners);
        }
        covers
    }

    /// Whether faces that are drawn on a side of a plane (0 in front, 1 behind) cover a convex polygon on it, up to their precision. Rounded arithmetic.
    ///
    /// Faces of one side of a plane do not overlap in a map; where they do, more may count as covered than is.
    pub(super) fn cover(&self, (normal, distance): (Point3, f64), side: usize, polygon: &[Point3]) -> bool {
        self.gap((normal, distance), side, polygon) <= FACE_PRECISION
    }

    pub(super) fn gap(&self, (normal, distance): (Point3, f64), side: usize, polygon: &[Point3]) -> f64 {
        let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
        let flat = |p: &Point3| [p[(axis + 1) % 3], p[(axis + 2) % 3]];
        let polygon: Vec<Point2> = polygon.iter().map(flat).collect();
        let polygon = counter_clockwise(polygon);
        let all = area(&polygon);
        let around: f64 = edges(&polygon).map(|[p, q]| (q[0] - p[0]).hypot(q[1] - p[1])).sum();
        let faces = self.of_plane.get(&key(normal, distance, side)).into_iter().flatten();
        let covered: f64 = faces.map(|&face| shared(&polygon, self.faces[face].iter().map(flat).collect())).sum();
        // Of a sliver, the area is smaller than the border times the precision.
        ((all - covered) / around * 2.0).max(0.0)
    }
}

type Point2 = [f64; 2];

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

fn counter_clockwise(mut polygon: Vec<Point2>) -> Vec<Point2> {
    if area(&polygon) < 0.0 {
        polygon.reverse();
    }
    polygon
}

/// The area that a convex polygon shares with another polygon.
fn shared(convex: &[Point2], other: Vec<Point2>) -> f64 {
    let mut rest = counter_clockwise(other);
    for [p, q] in edges(convex) {
        let height = |r: Point2| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        let mut kept = Vec::with_capacity(rest.len() + 1);
        for [a, b] in edges(&rest) {
            let (ha, hb) = (height(a), height(b));
            if ha >= 0.0 {
                kept.push(a);
            }
            if (ha > 0.0) != (hb > 0.0) && ha != 0.0 && hb != 0.0 {
                let t = ha / (ha - hb);
                kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
            }
        }
        rest = kept;
    }
    area(&rest)
}

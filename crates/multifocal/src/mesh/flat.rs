//! Convex polygons inside the union of triangles on one axis-parallel plane.
//!
//! A wall with doors and windows is concave, and cut into triangles that reach from corners of doors to corners of the
//! wall: no union of some of them need be both large and convex. On a plane perpendicular to an axis every double is a
//! coordinate, so polygons need not consist of triangles, and may overlap: a seam between two polygons would lose
//! umbra, a common part does not.
//!
//! Starting from a point inside, cuts remove everything that is not covered, the nearest first, each along the one of a
//! few lines that keeps most. Nearest is measured in a square, a wide and a tall metric, so that the wide strip above
//! the doors is found, and the tall one between two windows. All of that may be affected by rounding; the result is
//! checked exactly: no edge at which the coverage changes meets the polygon's interior, and the starting point is
//! inside it and inside a triangle.
//!
//! Source: the greedy cuts are those of Deits and Tedrake, "Computing Large Convex Regions of Obstacle-Free Space", WAFR 2014,
//! without its ellipsoids.

use super::PatchOptions;
use super::polygon::{cut, is_inside, is_strictly_convex, stays_out, twice_area};
use super::vector::normal;
use super::weld::Mesh;
use crate::Occluder;
use sightlines_geometry::{Point2, Point3, orient2d};
use std::collections::BTreeSet;

/// An edge, by its ends, at which the coverage by triangles changes.
type Border = [Point2; 2];

/// Triangles on one plane that are connected by edges, and hide from the same sides.
#[derive(Debug)]
struct Piece {
    axis: usize,
    at: f64,
    triangles: Vec<u32>,
    borders: Vec<Border>,
}

/// The polygons found, and the triangles that need no patch any more.
#[derive(Debug, Default)]
pub(super) struct Found {
    pub(super) occluders: Vec<Occluder>,
    pub(super) covered: Vec<u32>,
}

/// Metrics in which the next cut is searched: factors along both axes.
const METRICS: [[f64; 2]; 3] = [[1.0, 1.0], [1.0, 16.0], [16.0, 1.0]];

/// Polygons on all axis-parallel planes of a mesh, in a deterministic order.
pub(super) fn convex_polygons(mesh: &Mesh, options: &PatchOptions) -> Found {
    let mut found = Found::default();
    // Number of border tests; more are not worth their time.
    let mut work = 32 * mesh.triangles().len() as u64 + (1 << 23);
    // The largest first, as long as work is left.
    let mut pieces: Vec<(f64, Piece)> = pieces(mesh).into_iter().map(|p| (p.twice_area(mesh), p)).collect();
    pieces.sort_by(|a, b| b.0.total_cmp(&a.0));
    for (twice_area, piece) in pieces {
        if twice_area >= 2.0 * options.min_area {
            // No more than a share for one piece, so that a floor with a thousand holes does not use it all.
            let share = work.min(64 * piece.triangles.len() as u64 + (1 << 16));
            let mut left = share;
            piece.polygons(mesh, options, &mut found, &mut left);
            work -= share - left;
        }
    }
    found
}

/// The sides that a triangle across an axis hides from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Sides {
    Both,
    Low,
    High,
}

fn sides(mesh: &Mesh, triangle: u32, axis: usize) -> Sides {
    let [a, b, c] = mesh.corners(triangle).map(|p| flat(axis, p));
    match mesh.is_front_only(triangle) {
        false => Sides::Both,
        true if orient2d(a, b, c) > 0.0 => Sides::High,
        true => Sides::Low,
    }
}

/// The pieces of all planes with at least two triangles.
fn pieces(mesh: &Mesh) -> Vec<Piece> {
    let mut on_planes: Vec<(usize, u64, Sides, u32)> = Vec::new();
    for t in 0..mesh.triangles().len() as u32 {
        let [a, b, c] = mesh.corners(t);
        let axis = (0..3).find(|&k| a[k] == b[k] && b[k] == c[k]);
        on_planes.extend(axis.map(|k| (k, a[k].to_bits(), sides(mesh, t, k), t)));
    }
    on_planes.sort_unstable();
    let mut pieces = Vec::new();
    for plane in on_planes.chunk_by(|a, b| (a.0, a.1, a.2) == (b.0, b.1, b.2)) {
        let triangles: Vec<u32> = plane.iter().map(|p| p.3).collect();
        split(mesh, plane[0].0, f64::from_bits(plane[0].1), &triangles, &mut pieces);
    }
    pieces
}

/// Divides the triangles of a plane into connected pieces.
fn split(mesh: &Mesh, axis: usize, at: f64, triangles: &[u32], pieces: &mut Vec<Piece>) {
    // Which of the triangles, by edge, and whether it lies to the left of the edge from its lower to its upper end.
    let mut uses: Vec<(u32, u32, bool)> = Vec::new();
    for (i, &t) in (0..).zip(triangles) {
        let ring = mesh.outline(t);
        let [a, b, c] = mesh.corners(t).map(|p| flat(axis, p));
        let is_ccw = orient2d(a, b, c) > 0.0;
        for (k, &edge) in mesh.outline_edges(t).iter().enumerate() {
            uses.push((edge, i, (ring[k] < ring[(k + 1) % ring.len()]) == is_ccw));
        }
    }
    uses.sort_unstable();
    let mut parents: Vec<u32> = (0..triangles.len() as u32).collect();
    for same in uses.chunk_by(|a, b| a.0 == b.0) {
        for u in &same[1..] {
            let [a, b] = [root(&mut parents, same[0].1), root(&mut parents, u.1)];
            parents[a.max(b) as usize] = a.min(b);
        }
    }
    let mut numbers = vec![u32::MAX; triangles.len()];
    let first = pieces.len();
    for i in 0..triangles.len() as u32 {
        let r = root(&mut parents, i) as usize;
        if numbers[r] == u32::MAX {
            numbers[r] = (pieces.len() - first) as u32;
            pieces.push(Piece { axis, at, triangles: Vec::new(), borders: Vec::new() });
        }
        pieces[first + numbers[r] as usize].triangles.push(triangles[i as usize]);
    }
    for same in uses.chunk_by(|a, b| a.0 == b.0) {
        if same.iter().map(|u| if u.2 { 1 } else { -1 }).sum::<i32>() != 0 {
            let r = root(&mut parents, same[0].1) as usize;
            let ends = mesh.edges()[same[0].0 as usize].map(|v| flat(axis, mesh.vertices()[v as usize]));
            pieces[first + numbers[r] as usize].borders.push(ends);
        }
    }
    // A single triangle is a patch already.
    let mut i = 0;
    pieces.retain(|p| {
        i += 1;
        i <= first || p.triangles.len() > 1
    });
}

fn root(parents: &mut [u32], mut i: u32) -> u32 {
    while parents[i as usize] != i {
        let above = parents[parents[i as usize] as usize];
        parents[i as usize] = above;
        i = above;
    }
    i
}

fn flat(axis: usize, p: Point3) -> Point2 {
    Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3])
}

impl Piece {
    /// Twice the areas of all its triangles.
    fn twice_area(&self, mesh: &Mesh) -> f64 {
        self.triangles.iter().map(|&t| normal(mesh.corners(t))[self.axis].abs()).sum()
    }

    fn polygons(&self, mesh: &Mesh, options: &PatchOptions, found: &mut Found, work: &mut u64) {
        let area = |t: u32| normal(mesh.corners(t))[self.axis].abs();
        let mut seeds = self.triangles.clone();
        seeds.sort_by(|&s, &t| area(t).total_cmp(&area(s)).then(s.cmp(&t)));
        let mut covered = BTreeSet::new();
        let mut known = BTreeSet::new();
        let whole = self.twice_area(mesh);
        for &seed in &seeds {
            if covered.contains(&seed) {
                continue;
            }
            let triangle = mesh.corners(seed).map(|p| flat(self.axis, p));
            let middle = centre(triangle);
            let mut polygons: Vec<Vec<Point2>> = Vec::new();
            for metric in METRICS {
                if let Some(polygon) = self.around(middle, metric, work)
                    && let Some(polygon) = self.checked(polygon, triangle, middle)
                {
                    polygons.push(polygon);
                }
                // A convex piece contains no other shapes.
                if polygons.first().is_some_and(|p| twice_area(p) >= whole * (1.0 - 1e-9)) {
                    break;
                }
            }
            let largest = polygons.iter().map(|p| twice_area(p)).fold(area(seed), f64::max);
            // Strips of another shape are kept if they are not much smaller.
            polygons.retain(|p| {
                2.0 * twice_area(p) >= largest
                    && twice_area(p) >= 2.0 * options.min_area
                    && p.len() <= options.max_corners
            });
            for polygon in polygons {
                let (low, high) = box_of(&polygon);
                let inside = |t: &u32| {
                    let middle = centre(mesh.corners(*t).map(|p| flat(self.axis, p)));
                    middle.cmpgt(low).all() && middle.cmplt(high).all() && is_inside(&polygon, middle)
                };
                covered.extend(self.triangles.iter().copied().filter(inside));
                let key: Vec<[u64; 2]> = rotated(&polygon).iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
                if known.insert(key) {
                    found.occluders.extend(self.occluder(mesh, &polygon));
                }
            }
        }
        found.covered.extend(covered);
    }

    /// A convex polygon around `middle` whose interior borders do not enter, or hardly.
    fn around(&self, middle: Point2, metric: [f64; 2], work: &mut u64) -> Option<Vec<Point2>> {
        let all = || self.borders.iter().flatten();
        let (low, high) = all().fold((Point2::INFINITY, Point2::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)));
        let slack = (high - low).max_element() * 1e-9;
        let mut polygon = vec![low, Point2::new(high.x, low.y), high, Point2::new(low.x, high.y)];
        let (mut near, mut scratch): (Vec<Border>, Vec<Point2>) = (self.borders.clone(), Vec::new());
        let stretch = Point2::new(metric[0], metric[1]);
        for _ in 0..MAX_CUTS {
            *work = work.checked_sub(near.len() as u64)?;
            let mut nearest: Option<(f64, Point2, Border)> = None;
            near.retain(|&border| {
                let Some(inner) = within(&polygon, border, slack) else { return false };
                let point = nearest_on(inner, middle, stretch);
                let distance = ((point - middle) * stretch).length_squared();
                if nearest.is_none_or(|n| distance < n.0) {
                    nearest = Some((distance, point, border));
                }
                true
            });
            let Some((_, point, border)) = nearest else { return Some(polygon) };
            let best = cuts(point, border, middle, stretch, slack).into_iter().filter_map(|[p, q]| {
                let mut left = polygon.clone();
                cut(&mut left, &mut scratch, p, q);
                let area = twice_area(&left);
                (left.len() >= 3 && area < twice_area(&polygon)).then_some((area, left))
            });
            polygon = best.reduce(|a, b| if b.0 > a.0 { b } else { a })?.1;
        }
        None
    }

    /// The polygon, if it is inside the area covered by triangles; or one within it that is smaller by less than
    /// rounding.
    fn checked(&self, polygon: Vec<Point2>, triangle: [Point2; 3], middle: Point2) -> Option<Vec<Point2>> {
        let polygon = simplified(polygon);
        let is_good = |p: &[Point2]| {
            let (low, high) = box_of(p);
            // What is beside the box is beside the polygon.
            let is_beside = |a: Point2, b: Point2| a.max(b).cmple(low).any() || a.min(b).cmpge(high).any();
            is_strictly_convex(p)
                && is_inside(p, middle)
                && is_inside(&counter_clockwise(triangle), middle)
                && self.borders.iter().all(|&[a, b]| is_beside(a, b) || stays_out(p, a, b))
        };
        if is_good(&polygon) {
            return Some(polygon);
        }
        let smaller: Vec<Point2> =
            polygon.iter().map(|&p| p + (middle - p) * f64::from_bits((1023 - 30) << 52)).collect();
        is_good(&smaller).then_some(smaller)
    }

    fn occluder(&self, mesh: &Mesh, polygon: &[Point2]) -> Option<Occluder> {
        let lifted = |p: &Point2| {
            let mut q = [self.at; 3];
            q[(self.axis + 1) % 3] = p.x;
            q[(self.axis + 2) % 3] = p.y;
            q
        };
        let mut outline: Vec<Point3> = polygon.iter().map(lifted).collect();
        let triangle = self.triangles[0];
        if sides(mesh, triangle, self.axis) == Sides::Low {
            outline.reverse();
        }
        let fan: Vec<[Point3; 3]> = outline[1..].windows(2).map(|w| [outline[0], w[0], w[1]]).collect();
        Some(mesh.sided(triangle, Occluder::patch(outline, &fan).ok()?))
    }
}

/// Most cuts for one polygon.
const MAX_CUTS: usize = 256;

/// The lower and the upper corner of the box around a polygon.
fn box_of(polygon: &[Point2]) -> (Point2, Point2) {
    polygon.iter().fold((Point2::INFINITY, Point2::NEG_INFINITY), |(l, h), &p| (l.min(p), h.max(p)))
}

fn centre([a, b, c]: [Point2; 3]) -> Point2 {
    (a + b + c) / 3.0
}

fn counter_clockwise([a, b, c]: [Point2; 3]) -> [Point2; 3] {
    if orient2d(a, b, c) > 0.0 { [a, b, c] } else { [a, c, b] }
}

/// The same loop, from its lowest corner on.
fn rotated(polygon: &[Point2]) -> Vec<Point2> {
    let lower = |&i: &usize, &k: &usize| {
        let (p, q) = (polygon[i], polygon[k]);
        p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y))
    };
    let first = (0..polygon.len()).min_by(lower).unwrap_or(0);
    let mut out = polygon.to_vec();
    out.rotate_left(first);
    out
}

/// The part of a border that is more than `slack` inside of a polygon.
fn within(polygon: &[Point2], [a, b]: Border, slack: f64) -> Option<Border> {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (i, &p) in polygon.iter().enumerate() {
        let d = polygon[(i + 1) % polygon.len()] - p;
        let least = slack * d.length();
        let [ga, gb] = [a, b].map(|x| d.perp_dot(x - p) - least);
        match (ga <= 0.0, gb <= 0.0) {
            (true, true) => return None,
            (false, true) => last = last.min(ga / (ga - gb)),
            (true, false) => first = first.max(ga / (ga - gb)),
            (false, false) => {}
        }
    }
    (first < last).then(|| [a + (b - a) * first, a + (b - a) * last])
}

/// The point of a segment that is nearest to `middle` after stretching.
fn nearest_on([a, b]: Border, middle: Point2, stretch: Point2) -> Point2 {
    let (d, m) = ((b - a) * stretch, (middle - a) * stretch);
    let t = if d.length_squared() > 0.0 { (m.dot(d) / d.length_squared()).clamp(0.0, 1.0) } else { 0.0 };
    a + (b - a) * t
}

/// Lines that could cut off the nearest point of a border, with `middle` on their left: along the border, along the
/// axes, and perpendicular to the way there.
fn cuts(point: Point2, [a, b]: Border, middle: Point2, stretch: Point2, slack: f64) -> Vec<[Point2; 2]> {
    let normal = (point - middle) * stretch * stretch;
    let across = Point2::new(-normal.y, normal.x);
    let lines = [[a, b], [point, point + Point2::X], [point, point + Point2::Y], [point, point + across]];
    let side = |[p, q]: [Point2; 2]| (q - p).perp_dot(middle - p) / (q - p).length();
    let turned = lines.into_iter().filter_map(|[p, q]| {
        let s = side([p, q]);
        (s.abs() > slack).then_some(if s > 0.0 { [p, q] } else { [q, p] })
    });
    turned.collect()
}

/// Removes corners that are exactly equal to a neighbour or collinear with both.
fn simplified(mut polygon: Vec<Point2>) -> Vec<Point2> {
    polygon.dedup();
    while polygon.len() > 1 && polygon.first() == polygon.last() {
        polygon.pop();
    }
    let mut i = 0;
    while polygon.len() > 3 && i < polygon.len() {
        let n = polygon.len();
        if orient2d(polygon[(i + n - 1) % n], polygon[i], polygon[(i + 1) % n]) == 0.0 {
            polygon.remove(i);
            i = i.saturating_sub(1);
        } else {
            i += 1;
        }
    }
    polygon
}

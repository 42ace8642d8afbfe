//! Polygons of space, bent or not convex, to triangles.

use crate::{Point2, Point3, orient2d};

/// The most corners of a polygon that no fan covers: cutting ears takes cubic time at worst.
pub const MAX_WINDING_CORNERS: usize = 1024;

/// Why a polygon is not a union of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PolygonError {
    /// Its outline crosses itself as seen from every axis.
    Crossing,
    /// It has more than [`MAX_WINDING_CORNERS`] corners and no fan covers it.
    TooLarge,
}

/// Cuts a polygon of three or more corners into triangles of the same hand; returns indices of corners.
///
/// The polygon may be bent: it is cut as seen along the axis that shows most of it, if it can be, else along
/// another along which it is more than a line. Along that axis no triangle runs the other way round, exactly. The triangles then cover each
/// point as often as the outline winds around it, so they cover the polygon, all of it and nothing else.
/// Corners on a straight line make triangles without area.
///
/// # Errors
/// [`PolygonError`]
pub fn triangulate(polygon: &[Point3]) -> Result<Vec<[usize; 3]>, PolygonError> {
    if polygon.len() <= 3 {
        return Ok(vec![[0, 1, 2]]);
    }
    let normal = newell_normal(polygon);
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| normal[b].abs().total_cmp(&normal[a].abs()));
    let mut flat: Vec<Vec<Point2>> = axes.iter().map(|&axis| project(polygon, axis, normal[axis] < 0.0)).collect();
    // Seen edge-on, no triangle runs either way round.
    flat.retain(|flat| !is_line(flat));
    if flat.is_empty() {
        return Ok((1..polygon.len() - 1).map(|k| [0, k, k + 1]).collect());
    }
    if let Some(fan) = flat.iter().find_map(|flat| fan(flat)) {
        return Ok(fan);
    }
    if polygon.len() > MAX_WINDING_CORNERS {
        return Err(PolygonError::TooLarge);
    }
    flat.iter().find_map(|flat| cut_ears(flat)).ok_or(PolygonError::Crossing)
}

/// The normal, twice as long as the polygon is large; rounded, so only good for choosing among views that
/// are each checked.
fn newell_normal(polygon: &[Point3]) -> Point3 {
    let mut normal = [0.0; 3];
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        // Relative to a corner, so that little is lost far from the origin.
        let (p, q) = (from(polygon[0], *p), from(polygon[0], *q));
        for (axis, sum) in normal.iter_mut().enumerate() {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            *sum += p[u] * q[v] - p[v] * q[u];
        }
    }
    normal
}

fn from(a: Point3, b: Point3) -> Point3 {
    [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
}

/// The polygon as seen along an axis, from the side where it runs counter-clockwise.
fn project(polygon: &[Point3], axis: usize, from_below: bool) -> Vec<Point2> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    polygon.iter().map(|p| if from_below { Point2::new(p[v], p[u]) } else { Point2::new(p[u], p[v]) }).collect()
}

/// Whether all points lie on one line.
fn is_line(flat: &[Point2]) -> bool {
    let Some(&other) = flat.iter().find(|&&p| p != flat[0]) else { return true };
    flat.iter().all(|&p| orient2d(flat[0], other, p) == 0.0)
}

/// All triangles with the first corner, if none of them runs clockwise.
fn fan(flat: &[Point2]) -> Option<Vec<[usize; 3]>> {
    let triangles = (1..flat.len() - 1).map(|k| [0, k, k + 1]);
    triangles.map(|t| (orientation(flat, t) >= 0.0).then_some(t)).collect()
}

fn orientation(flat: &[Point2], [a, b, c]: [usize; 3]) -> f64 {
    orient2d(flat[a], flat[b], flat[c])
}

/// Cuts off one ear after the other (Meisters 1975): a corner whose triangle holds no other corner.
///
/// That an ear is empty only keeps what is left simple. That it does not run clockwise is what counts.
fn cut_ears(flat: &[Point2]) -> Option<Vec<[usize; 3]>> {
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = Vec::with_capacity(flat.len() - 2);
    while left.len() > 3 {
        let n = left.len();
        let ear_at = |k: usize| [left[(k + n - 1) % n], left[k], left[(k + 1) % n]];
        let k = (0..n).find(|&k| is_ear(flat, &left, ear_at(k)))?;
        triangles.push(ear_at(k));
        left.remove(k);
    }
    let last = [left[0], left[1], left[2]];
    triangles.push(last);
    (orientation(flat, last) >= 0.0).then_some(triangles)
}

fn is_ear(flat: &[Point2], left: &[usize], ear: [usize; 3]) -> bool {
    let [a, b, c] = ear.map(|k| flat[k]);
    let turn = orient2d(a, b, c);
    if turn <= 0.0 {
        // A corner on a straight line, or one that is there twice, may go; the tip of a spike too.
        return turn == 0.0;
    }
    let inside = |p: Point2| orient2d(a, b, p) >= 0.0 && orient2d(b, c, p) >= 0.0 && orient2d(c, a, p) >= 0.0;
    // Corners in the same place are those of a slit that joins a hole to the outline.
    left.iter().map(|&k| flat[k]).all(|p| p == a || p == b || p == c || !inside(p))
}

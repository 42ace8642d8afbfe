//! A sequence of portals, clipped by separating planes as Quake's programs do it, in plain floating point with a
//! tolerance: a warning example.
//!
//! Source: Abrash, Graphics Programming Black Book, 1997, chapter 70, and descriptions of programs that followed.

use crate::stability::axial::naive::Real;
use sightlines::geometry::Portal3;
use std::ops::Div;

/// A floating-point number with roots.
pub trait Rooted: Real + Div<Output = Self> {
    /// The square root, rounded.
    fn root(self) -> Self;
}

impl Rooted for f64 {
    fn root(self) -> Self {
        self.sqrt()
    }
}

impl Rooted for f32 {
    fn root(self) -> Self {
        self.sqrt()
    }
}

/// A point or a vector.
pub type Vector<T> = [T; 3];

/// The difference of two points.
pub fn sub<T: Real>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The scalar product.
pub fn dot<T: Real>(a: Vector<T>, b: Vector<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
pub fn cross<T: Real>(a: Vector<T>, b: Vector<T>) -> Vector<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The corners of a portal, rounded.
pub fn corners<T: Real>(portal: &Portal3) -> Vec<Vector<T>> {
    portal.corners().iter().map(|p| p.map(T::of)).collect()
}

/// Unit normal and offset.
#[derive(Debug, Clone, Copy)]
struct Plane<T> {
    normal: Vector<T>,
    offset: T,
}

impl<T: Rooted> Plane<T> {
    fn facing(along: Vector<T>, through: Vector<T>) -> Option<Self> {
        let length = dot(along, along).root();
        if length.partial_cmp(&T::of(0.0)) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        let normal = along.map(|x| x / length);
        Some(Self { normal, offset: dot(normal, through) })
    }

    fn of(polygon: &[Vector<T>]) -> Option<Self> {
        let up = polygon[1..].windows(2).fold([T::of(0.0); 3], |sum, pair| {
            let n = cross(sub(pair[0], polygon[0]), sub(pair[1], polygon[0]));
            [sum[0] + n[0], sum[1] + n[1], sum[2] + n[2]]
        });
        Self::facing(up, polygon[0])
    }

    fn distance(&self, p: Vector<T>) -> T {
        dot(self.normal, p) - self.offset
    }

    fn flipped(self) -> Self {
        Self { normal: self.normal.map(|x| -x), offset: -self.offset }
    }
}

/// Whether anything is left of the last portal after all clipping. What is nearer to a plane than `tolerance` counts as
/// on it, in scene units.
pub fn passes<T: Rooted>(portals: &[Portal3], tolerance: f64) -> bool {
    let tolerance = T::of(tolerance);
    let polygons: Vec<Vec<Vector<T>>> = portals.iter().map(corners).collect();
    let [first, second, rest @ ..] = polygons.as_slice() else { return true };
    let (mut source, mut pass) = (first.clone(), second.clone());
    let Some(source_plane) = Plane::of(first) else { return false };
    if !clip(&mut pass, &source_plane, tolerance) {
        return false;
    }
    rest.iter().all(|target| {
        let mut target = target.clone();
        let Some(plane) = Plane::of(&target) else { return false };
        let left = clip(&mut target, &source_plane, tolerance)
            && clip(&mut source, &plane.flipped(), tolerance)
            && clip_between(&source, &pass, false, &mut target, tolerance)
            && clip_between(&pass, &source, true, &mut target, tolerance)
            && clip_between(&target, &pass, false, &mut source, tolerance)
            && clip_between(&pass, &target, true, &mut source, tolerance);
        pass = target;
        left
    })
}

/// Leaves of a polygon what is in front of a plane; whether anything is.
fn clip<T: Rooted>(polygon: &mut Vec<Vector<T>>, plane: &Plane<T>, tolerance: T) -> bool {
    let distances: Vec<T> = polygon.iter().map(|&p| plane.distance(p)).collect();
    if !distances.iter().any(|&d| d > tolerance) {
        return false;
    }
    if !distances.iter().any(|&d| d < -tolerance) {
        return true;
    }
    let n = polygon.len();
    let mut part = Vec::with_capacity(n + 1);
    for k in 0..n {
        let (p, q, d, e) = (polygon[k], polygon[(k + 1) % n], distances[k], distances[(k + 1) % n]);
        if d >= -tolerance {
            part.push(p);
        }
        if (d > tolerance && e < -tolerance) || (d < -tolerance && e > tolerance) {
            let share = d / (d - e);
            part.push([0, 1, 2].map(|i| p[i] + share * (q[i] - p[i])));
        }
    }
    *polygon = part;
    true
}

/// Clips `target` by the planes through an edge of `first` and a corner of `second` that have the one behind and the
/// other in front; `flipped` turns them round.
fn clip_between<T: Rooted>(
    first: &[Vector<T>],
    second: &[Vector<T>],
    flipped: bool,
    target: &mut Vec<Vector<T>>,
    tolerance: T,
) -> bool {
    (0..first.len()).all(|edge| match separator(first, edge, second, tolerance) {
        Some(plane) => clip(target, &if flipped { plane.flipped() } else { plane }, tolerance),
        None => true,
    })
}

fn separator<T: Rooted>(first: &[Vector<T>], edge: usize, second: &[Vector<T>], tolerance: T) -> Option<Plane<T>> {
    let a = first[edge];
    let along = sub(first[(edge + 1) % first.len()], a);
    second.iter().enumerate().find_map(|(j, &corner)| {
        let plane = Plane::facing(cross(along, sub(corner, a)), a)?;
        // The whole of `first` is on one side; a corner that is off the plane tells which.
        let off = first.iter().map(|&p| plane.distance(p)).find(|&d| d > tolerance || d < -tolerance)?;
        let plane = if off > T::of(0.0) { plane.flipped() } else { plane };
        let others = || second.iter().enumerate().filter(|&(i, _)| i != j).map(|(_, &p)| plane.distance(p));
        (others().all(|d| d >= -tolerance) && others().any(|d| d > tolerance)).then_some(plane)
    })
}

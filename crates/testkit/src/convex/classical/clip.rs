//! Polygons and planes in doubles, with a tolerance. Vectors are written out here on purpose: the reference shares nothing with
//! what it is measured against.

use sightlines_geometry::Point3;

#[inline(always)]
pub(super) fn sub(a: Point3, b: Point3) -> Point3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn dot(a: Point3, b: Point3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn cross(a: Point3, b: Point3) -> Point3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The points `x` with `normal · x = offset`; in front are those with more. The normal has length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    pub(super) normal: Point3,
    pub(super) offset: f64,
}

impl Plane {
    /// The plane through a point that faces along a vector; `None` if that has no direction.
    #[inline]
    pub(super) fn facing(along: Point3, through: Point3) -> Option<Self> {
        let square = dot(along, along);
        if square.is_nan() || square < f64::MIN_POSITIVE {
            return None;
        }
        let normal = along.map(|x| x / square.sqrt());
        Some(Self { normal, offset: dot(normal, through) })
    }

    /// How far in front of it a point is.
    #[inline(always)]
    pub(super) fn distance(&self, p: Point3) -> f64 {
        dot(self.normal, p) - self.offset
    }

    #[inline(always)]
    pub(super) fn flipped(self) -> Self {
        Self { normal: self.normal.map(|x| -x), offset: -self.offset }
    }
}

/// What a plane leaves of a polygon.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Left {
    All,
    Nothing,
    /// What was written.
    Part,
}

/// Clips polygons, and counts how often.
#[derive(Debug, Clone)]
pub(super) struct Clipper {
    /// What is nearer to a plane counts as on it.
    tolerance: f64,
    pub(super) clips: u64,
    distances: Vec<f64>,
    spare: Vec<Point3>,
}

impl Clipper {
    pub(super) fn new(tolerance: f64) -> Self {
        Self { tolerance, clips: 0, distances: Vec::new(), spare: Vec::new() }
    }

    /// Leaves of a polygon what is in front of a plane; whether anything is. O(corners).
    #[inline]
    pub(super) fn clip(&mut self, polygon: &mut Vec<Point3>, plane: &Plane) -> bool {
        match self.front_part(polygon, plane) {
            Left::All => true,
            Left::Nothing => false,
            Left::Part => {
                std::mem::swap(polygon, &mut self.spare);
                true
            }
        }
    }

    /// Writes into `spare` what a plane leaves, if that is a part.
    #[inline]
    fn front_part(&mut self, polygon: &[Point3], plane: &Plane) -> Left {
        self.clips += 1;
        self.distances.clear();
        let (mut is_front, mut is_back) = (false, false);
        for &p in polygon {
            let d = plane.distance(p);
            is_front |= d > self.tolerance;
            is_back |= d < -self.tolerance;
            self.distances.push(d);
        }
        if !is_back {
            return Left::All;
        }
        if !is_front {
            return Left::Nothing;
        }
        self.spare.clear();
        let n = polygon.len();
        for (k, (&p, &d)) in polygon.iter().zip(&self.distances).enumerate() {
            if d >= -self.tolerance {
                self.spare.push(p);
            }
            let next = if k + 1 == n { 0 } else { k + 1 };
            let e = self.distances[next];
            if (d > self.tolerance && e < -self.tolerance) || (d < -self.tolerance && e > self.tolerance) {
                let (q, share) = (polygon[next], d / (d - e));
                self.spare.push([0, 1, 2].map(|i| p[i] + share * (q[i] - p[i])));
            }
        }
        Left::Part
    }

    /// The planes through an edge of `first` and a corner of `second` that have the one behind and the other in
    /// front; `flipped` turns them round. Replaces `planes`. O(edges of `first` · corners of both).
    pub(super) fn separators(&self, first: &[Point3], second: &[Point3], flipped: bool, planes: &mut Vec<Plane>) {
        planes.clear();
        for k in 0..first.len() {
            if let Some(plane) = self.separator(first, k, second) {
                planes.push(if flipped { plane.flipped() } else { plane });
            }
        }
    }

    /// The separator through one edge: all that there are of it are the same plane.
    #[inline]
    fn separator(&self, first: &[Point3], edge: usize, second: &[Point3]) -> Option<Plane> {
        let a = first[edge];
        let along = sub(first[if edge + 1 == first.len() { 0 } else { edge + 1 }], a);
        'corners: for (j, &corner) in second.iter().enumerate() {
            let Some(mut plane) = Plane::facing(cross(along, sub(corner, a)), a) else { continue };
            // The whole of `first` is on one side of a plane through its edge; a corner that is off it tells which.
            let off = first.iter().map(|&p| plane.distance(p)).find(|d| d.abs() > self.tolerance);
            match off {
                None => continue,
                Some(d) if d > 0.0 => plane = plane.flipped(),
                Some(_) => {}
            }
            let mut is_front = false;
            for (i, &p) in second.iter().enumerate() {
                if i == j {
                    continue;
                }
                let d = plane.distance(p);
                if d < -self.tolerance {
                    continue 'corners;
                }
                is_front |= d > self.tolerance;
            }
            if is_front {
                return Some(plane);
            }
        }
        None
    }

    /// Clips `target` by the separators of `first` and `second`, as they are found; whether anything is left.
    pub(super) fn clip_between(
        &mut self,
        first: &[Point3],
        second: &[Point3],
        flipped: bool,
        target: &mut Vec<Point3>,
    ) -> bool {
        for k in 0..first.len() {
            if let Some(plane) = self.separator(first, k, second) {
                let plane = if flipped { plane.flipped() } else { plane };
                if !self.clip(target, &plane) {
                    return false;
                }
            }
        }
        true
    }
}

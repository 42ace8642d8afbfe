//! Openings between cells, as the older methods need them: lines through them, planes between them.

use sightlines::geometry::vector::{cross, dot, sub};
use sightlines::geometry::{Adaptive, Orient2d, Point2, Point3, Portal2, orient3d};
use sightlines_testkit::Random;

/// A ray, in scene units; in the plane, the third coordinates are 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it begins.
    pub origin: Point3,
    /// Of length 1.
    pub direction: Point3,
}

/// An opening, as who leaves through it sees it.
pub trait Opening: Clone + Send + Sync {
    /// A line of the plane, or a plane in space, with the source of a beam behind it and the opening that the beam
    /// passes next before it. A line that has passed both stays before it, as it crosses it once.
    type Barrier;

    /// Its corners.
    fn corners(&self) -> Vec<Point3>;

    /// A random point of it.
    fn point(&self, random: &mut Random) -> Point3;

    /// A random direction.
    fn direction(random: &mut Random) -> Point3;

    /// Whether the line of a ray leaves through it and stays clear of its border by that much. By rounded products.
    fn is_passed(&self, ray: &Ray, clearance: f64) -> bool;

    /// The barrier in the opening itself.
    fn front(&self) -> Self::Barrier;

    /// All barriers between this, as the source, and an opening that is passed later.
    fn barriers(&self, via: &Self, found: &mut Vec<Self::Barrier>);

    /// Whether nothing of it is strictly before a barrier, decided exactly.
    fn is_behind(&self, barrier: &Self::Barrier) -> bool;
}

/// A segment of the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap(pub Portal2);

impl Opening for Gap {
    /// Before it is what lies to its left.
    type Barrier = [Point2; 2];

    fn corners(&self) -> Vec<Point3> {
        [self.0.left, self.0.right].map(|p| [p.x, p.y, 0.0]).to_vec()
    }

    fn point(&self, random: &mut Random) -> Point3 {
        let (Portal2 { left, right }, t) = (self.0, random.unit());
        [left.x + t * (right.x - left.x), left.y + t * (right.y - left.y), 0.0]
    }

    fn direction(random: &mut Random) -> Point3 {
        loop {
            let [x, y] = [0; 2].map(|_| 2.0 * random.unit() - 1.0);
            let length = (x * x + y * y).sqrt();
            if (0.1..=1.0).contains(&length) {
                return [x / length, y / length, 0.0];
            }
        }
    }

    fn is_passed(&self, ray: &Ray, clearance: f64) -> bool {
        let [dx, dy, _] = ray.direction;
        let side = |p: Point2| dx * (p.y - ray.origin[1]) - dy * (p.x - ray.origin[0]);
        side(self.0.left) > clearance && side(self.0.right) < -clearance
    }

    fn front(&self) -> [Point2; 2] {
        [self.0.left, self.0.right]
    }

    fn barriers(&self, via: &Self, found: &mut Vec<[Point2; 2]>) {
        let (source, via) = (self.0, via.0);
        let is_left = |a: Point2, b: Point2, c: Point2| Adaptive.orient(a, b, c) > 0.0;
        let is_right = |a: Point2, b: Point2, c: Point2| Adaptive.orient(a, b, c) < 0.0;
        let [a, b] = [source.left, via.right];
        if is_right(a, b, source.right) && is_left(a, b, via.left) {
            found.push([a, b]);
        }
        let [a, b] = [source.right, via.left];
        if is_left(a, b, source.left) && is_right(a, b, via.right) {
            found.push([b, a]);
        }
    }

    fn is_behind(&self, [a, b]: &[Point2; 2]) -> bool {
        [self.0.left, self.0.right].into_iter().all(|p| Adaptive.orient(*a, *b, p) <= 0.0)
    }
}

/// A convex polygon in space, its corners counter-clockwise about the direction in which it is left.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    corners: Vec<Point3>,
    /// The length of the edge from each corner to the next.
    lengths: Vec<f64>,
}

impl Polygon {
    pub(super) fn new(corners: Vec<Point3>) -> Self {
        let n = corners.len();
        let length = |i: usize| {
            let e = sub(corners[(i + 1) % n], corners[i]);
            dot(e, e).sqrt()
        };
        let lengths = (0..n).map(length).collect();
        Self { corners, lengths }
    }

    fn edges(&self) -> impl Iterator<Item = [Point3; 2]> + '_ {
        let n = self.corners.len();
        (0..n).map(move |i| [self.corners[i], self.corners[(i + 1) % n]])
    }
}

/// Whether all points lie on one side of a plane or in it, and not all in it: -1 or 1 for the side, 0 for no.
fn side_of([a, b, c]: [Point3; 3], points: &[Point3]) -> i32 {
    let mut side = 0;
    for &p in points {
        let value = orient3d(a, b, c, p);
        let this = i32::from(value > 0.0) - i32::from(value < 0.0);
        if this != 0 && side == -this {
            return 0;
        }
        side = if this == 0 { side } else { this };
    }
    side
}

impl Opening for Polygon {
    /// Before it is where the right-hand normal points to.
    type Barrier = [Point3; 3];

    fn corners(&self) -> Vec<Point3> {
        self.corners.clone()
    }

    fn point(&self, random: &mut Random) -> Point3 {
        let weights: Vec<f64> = self.corners.iter().map(|_| -random.unit().ln()).collect();
        let all: f64 = weights.iter().sum();
        [0, 1, 2].map(|k| self.corners.iter().zip(&weights).map(|(p, w)| p[k] * w / all).sum())
    }

    fn direction(random: &mut Random) -> Point3 {
        random.direction()
    }

    fn is_passed(&self, ray: &Ray, clearance: f64) -> bool {
        self.edges().zip(&self.lengths).all(|([a, b], length)| {
            let moment = cross(sub(a, ray.origin), sub(b, ray.origin));
            dot(ray.direction, moment) > clearance * length
        })
    }

    fn front(&self) -> [Point3; 3] {
        let c = &self.corners;
        let area = |i: &usize| {
            let n = cross(sub(c[*i], c[0]), sub(c[*i + 1], c[0]));
            dot(n, n)
        };
        let i = (1..c.len() - 1).max_by(|i, j| area(i).total_cmp(&area(j))).unwrap_or(1);
        [c[0], c[i], c[i + 1]]
    }

    fn barriers(&self, via: &Self, found: &mut Vec<[Point3; 3]>) {
        for (of_edge, of_corner) in [(self, via), (via, self)] {
            for [a, b] in of_edge.edges() {
                for &c in &of_corner.corners {
                    let sides = [self, via].map(|polygon| side_of([a, b, c], &polygon.corners));
                    match sides {
                        [-1, 1] => found.push([a, b, c]),
                        [1, -1] => found.push([b, a, c]),
                        _ => {}
                    }
                }
            }
        }
    }

    fn is_behind(&self, [a, b, c]: &[Point3; 3]) -> bool {
        self.corners.iter().all(|&p| orient3d(*a, *b, *c, p) <= 0.0)
    }
}

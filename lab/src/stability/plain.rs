//! The same formulas as everywhere, in plain floats of either size: the warning examples.

use sightlines::geometry::Point3;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A float of 32 or 64 bits.
pub(crate) trait Float:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// Rounded to nearest.
    fn of(x: f64) -> Self;
    /// As it is.
    fn wide(self) -> f64;
    /// The magnitude.
    fn abs(self) -> Self;
    /// The square root.
    fn root(self) -> Self;
}

impl Float for f32 {
    fn of(x: f64) -> Self {
        x as Self
    }
    fn wide(self) -> f64 {
        f64::from(self)
    }
    fn abs(self) -> Self {
        Self::abs(self)
    }
    fn root(self) -> Self {
        self.sqrt()
    }
}

impl Float for f64 {
    fn of(x: f64) -> Self {
        x
    }
    fn wide(self) -> f64 {
        self
    }
    fn abs(self) -> Self {
        Self::abs(self)
    }
    fn root(self) -> Self {
        self.sqrt()
    }
}

/// A vector of floats.
pub(crate) type V<F> = [F; 3];

pub(crate) fn rounded<F: Float>(p: Point3) -> V<F> {
    p.map(F::of)
}

pub(crate) fn minus<F: Float>(a: V<F>, b: V<F>) -> V<F> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn cross<F: Float>(a: V<F>, b: V<F>) -> V<F> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn dot<F: Float>(a: V<F>, b: V<F>) -> F {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Twice the area of a triangle in the plane of x and y, positive if it turns left.
pub(crate) fn turn<F: Float>([a, b, c]: [Point3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(rounded::<F>);
    ((a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0])).wide()
}

/// Six times the volume of a tetrahedron, positive if `d` lies where `(b - a) × (c - a)` points to.
pub(crate) fn side<F: Float>([a, b, c, d]: [Point3; 4]) -> f64 {
    let [a, b, c, d] = [a, b, c, d].map(rounded::<F>);
    dot(cross(minus(b, a), minus(c, a)), minus(d, a)).wide()
}

/// A line of the plane as numbers kept for later: `n · p + e` with a normal of length 1.
pub(crate) fn kept_turn<F: Float>([a, b, c]: [Point3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(rounded::<F>);
    let n = [a[1] - b[1], b[0] - a[0]];
    let length = (n[0] * n[0] + n[1] * n[1]).root();
    let n = n.map(|x| x / length);
    let e = -(n[0] * a[0] + n[1] * a[1]);
    (n[0] * c[0] + n[1] * c[1] + e).wide()
}

/// A plane as numbers kept for later, as most programs keep them: `n · p + e` with a normal of length 1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Kept<F> {
    pub(crate) normal: V<F>,
    pub(crate) e: F,
}

impl<F: Float> Kept<F> {
    pub(crate) fn through([a, b, c]: [Point3; 3]) -> Self {
        let [a, b, c] = [a, b, c].map(rounded::<F>);
        let n = cross(minus(b, a), minus(c, a));
        let length = dot(n, n).root();
        let normal = n.map(|x| x / length);
        Self { normal, e: -dot(normal, a) }
    }

    /// The distance of a point, positive in front.
    pub(crate) fn at(&self, p: V<F>) -> F {
        dot(self.normal, p) + self.e
    }
}

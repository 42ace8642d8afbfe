//! The funnel in plain floating point, in some of the ways in which it is written: warning examples.

use sightlines::geometry::{Point2, Portal2};

/// How an end point is decided to be left of a line.
pub trait Side {
    /// Positive if `c` is left of the line from `a` to `b`, as far as this arithmetic knows.
    fn side(&self, a: Point2, b: Point2, c: Point2) -> f64;
    /// Values up to this count as zero: the end is on the line.
    fn tolerance(&self) -> f64 {
        0.0
    }
    /// Whether an end on the limit lets lines pass, or closes the funnel.
    fn lenient(&self) -> bool {
        false
    }
}

/// Differences of coordinates, in doubles.
#[derive(Debug, Clone, Copy)]
pub struct Doubles;

impl Side for Doubles {
    fn side(&self, a: Point2, b: Point2, c: Point2) -> f64 {
        (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
    }
}

/// The line's three coefficients, then its value at the point, in doubles.
#[derive(Debug, Clone, Copy)]
pub struct Coefficients;

impl Side for Coefficients {
    fn side(&self, p: Point2, q: Point2, c: Point2) -> f64 {
        let line = [p.y - q.y, q.x - p.x, p.x * q.y - p.y * q.x];
        line[0] * c.x + line[1] * c.y + line[2]
    }
}

/// Differences of coordinates, stored and computed in single precision.
#[derive(Debug, Clone, Copy)]
pub struct Singles;

impl Side for Singles {
    fn side(&self, a: Point2, b: Point2, c: Point2) -> f64 {
        let [a, b, c] = [a, b, c].map(|p| [p.x as f32, p.y as f32]);
        f64::from((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    }
}

/// The line's coefficients in doubles, with the tolerance of so many programs, 1e-9: what is within it is in doubt, and
/// decided one way.
#[derive(Debug, Clone, Copy)]
pub struct Epsilon {
    /// In doubt lines pass.
    pub lenient: bool,
}

impl Side for Epsilon {
    fn side(&self, a: Point2, b: Point2, c: Point2) -> f64 {
        Coefficients.side(a, b, c)
    }

    fn tolerance(&self) -> f64 {
        1e-9
    }

    fn lenient(&self) -> bool {
        self.lenient
    }
}

/// Whether the funnel stays open, by the rules of the shipped one, with sides that are computed naively.
pub fn passes(arithmetic: &impl Side, doors: &[Portal2]) -> bool {
    let Some((first, rest)) = doors.split_first() else { return true };
    let (mut left, mut right) = (vec![first.left], vec![first.right]);
    rest.iter().all(|door| {
        push(arithmetic, 1.0, &mut left, &mut right, door.left)
            && push(arithmetic, -1.0, &mut right, &mut left, door.right)
    })
}

fn push(arithmetic: &impl Side, sign: f64, own: &mut Vec<Point2>, other: &mut Vec<Point2>, q: Point2) -> bool {
    let side = |a: Point2, b: Point2, c: Point2| {
        let value = sign * arithmetic.side(a, b, c);
        if value.abs() <= arithmetic.tolerance() { 0.0 } else { value }
    };
    if side(other[0], own[own.len() - 1], q) >= 0.0 {
        return true;
    }
    let (first, last) = (own[0], other[other.len() - 1]);
    let limit = side(first, last, q);
    let is_beyond = (last - first).dot(q - last) >= 0.0;
    if limit < 0.0 || (limit == 0.0 && is_beyond && !arithmetic.lenient()) {
        return false;
    }
    while own.len() >= 2 && side(own[own.len() - 2], own[own.len() - 1], q) <= 0.0 {
        own.pop();
    }
    while other.len() >= 2 && side(other[0], other[1], q) <= 0.0 {
        other.remove(0);
    }
    own.push(q);
    true
}

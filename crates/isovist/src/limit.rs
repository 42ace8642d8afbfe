//! Isovists with an end: within a radius, within a sector.

use crate::{Boundary, Isovist};
use sightlines_geometry::Point2;

/// How far and in which directions an isovist reaches.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Nothing farther than this is seen; in units of the plan.
    pub radius: Option<f64>,
    /// Nothing outside of this sector is seen.
    pub sector: Option<Sector>,
    /// How far the straight pieces that stand for a circle may be inside of it, in units of the plan; a thousandth of the
    /// radius if it is `None`, and a billionth of it at least.
    pub deviation: Option<f64>,
}

/// A sector of directions around the eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sector {
    /// The direction of its middle; not zero.
    pub direction: Point2,
    /// Its whole angle in degrees, above 0 and below 360.
    pub angle: f64,
}

/// Limits that are none.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LimitError {
    /// The radius is not a positive number.
    #[error("the radius {0} is not a positive number")]
    Radius(f64),
    /// The angle is not above 0 and below 360.
    #[error("the angle {0} is not above 0 and below 360 degrees")]
    Angle(f64),
    /// The direction is zero or not finite.
    #[error("the direction ({}, {}) is none", .0.x, .0.y)]
    Direction(Point2),
    /// The deviation is not a positive number.
    #[error("the deviation {0} is not a positive number")]
    Deviation(f64),
}

/// A part of the outline that is not along a ray, relative to the eye.
#[derive(Debug, Clone, Copy)]
struct Part {
    from: Point2,
    to: Point2,
    kind: Boundary,
}

impl Limits {
    fn check(&self) -> Result<(), LimitError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        if let Some(radius) = self.radius.filter(|&r| !positive(r)) {
            return Err(LimitError::Radius(radius));
        }
        if let Some(deviation) = self.deviation.filter(|&d| !positive(d)) {
            return Err(LimitError::Deviation(deviation));
        }
        if let Some(Sector { direction, angle }) = self.sector {
            if !(positive(angle) && angle < 360.0) {
                return Err(LimitError::Angle(angle));
            }
            if !direction.is_finite() || direction == Point2::ZERO {
                return Err(LimitError::Direction(direction));
            }
        }
        Ok(())
    }
}

impl Isovist {
    /// The part of the isovist within limits.
    ///
    /// Vertices at the limits are computed in doubles. A circle becomes straight pieces inside of it, so the polygon is smaller than the truth
    /// by no more than the deviation.
    ///
    /// # Errors
    /// [`LimitError`].
    pub fn limited(&self, limits: &Limits) -> Result<Self, LimitError> {
        limits.check()?;
        let relative = self.edges().map(|(from, to, kind)| Part { from: from - self.eye, to: to - self.eye, kind });
        // What is along a ray joins the parts and comes back in the end.
        let mut parts: Vec<Part> =
            relative.filter(|part| part.kind != Boundary::Occluding && part.from.perp_dot(part.to) > 0.0).collect();
        let mut limited = Self { eye: self.eye, angle: self.angle, ..Self::default() };
        if let Some(sector) = limits.sector {
            limited.angle = sector.angle.to_radians();
            let (right, left) = sector.sides();
            parts = in_sector(&parts, right, left, sector.angle);
        }
        if let Some(radius) = limits.radius {
            // Finer pieces than this are rounding.
            let deviation = limits.deviation.unwrap_or(radius * 1e-3).max(radius * 1e-9);
            parts = parts.into_iter().flat_map(|part| in_circle(part, radius, deviation)).collect();
        }
        limited.join(&parts, limits.sector.is_some());
        Ok(limited)
    }

    /// Makes parts of an outline in their order a polygon; with the eye as its first vertex if it is a sector.
    fn join(&mut self, parts: &[Part], is_sector: bool) {
        let add = |isovist: &mut Self, from: Point2, kind: Boundary| {
            isovist.vertices.push(from + isovist.eye);
            isovist.boundaries.push(kind);
        };
        if is_sector && !parts.is_empty() {
            add(self, Point2::ZERO, Boundary::Limit);
        }
        for (i, part) in parts.iter().enumerate() {
            add(self, part.from, part.kind);
            let next = parts.get(i + 1).or(parts.first().filter(|_| !is_sector));
            match next {
                Some(next) if next.from == part.to => {}
                // Both ends are on the circle and on one ray.
                Some(next) if next.kind == Boundary::Limit && part.kind == Boundary::Limit => {}
                Some(_) => add(self, part.to, Boundary::Occluding),
                None => add(self, part.to, Boundary::Limit),
            }
        }
    }
}

impl Sector {
    /// The directions of its right and left side.
    fn sides(&self) -> (Point2, Point2) {
        let half = 0.5 * self.angle.to_radians();
        let (sin, cos) = (libm::sin(half), libm::cos(half));
        // Large and small directions keep their squares within range.
        let d = (self.direction / self.direction.abs().max_element()).normalize();
        (
            Point2::new(d.x * cos + d.y * sin, d.y * cos - d.x * sin),
            Point2::new(d.x * cos - d.y * sin, d.y * cos + d.x * sin),
        )
    }
}

/// Where a ray in direction `d` from the eye meets the line of a part.
fn at(part: &Part, d: Point2) -> Point2 {
    let step = part.to - part.from;
    let far = part.from.perp_dot(step) / d.perp_dot(step);
    // A part that a side has left no length has no direction.
    if far.is_finite() { d * far } else { part.from }
}

/// The parts inside a sector, from its right side to its left one.
///
/// Each part begins where the one before it ends, so the order of their beginnings alone tells which part holds a side: no side falls between two.
fn in_sector(parts: &[Part], right: Point2, left: Point2, angle: f64) -> Vec<Part> {
    let n = parts.len();
    let starts: Vec<f64> = parts.iter().map(|part| turn_from(right, part.from)).collect();
    // The part that holds the right side: the last one before the turn begins anew.
    let Some(first) = (0..n).max_by(|&i, &j| starts[i].total_cmp(&starts[j]).then(i.cmp(&j))) else {
        return Vec::new();
    };
    let end = match turn_from(right, left) {
        // Rounding may move the left side of a narrow or a wide sector past the right one.
        turn if angle < 90.0 && turn > 2.0 => 0.0,
        turn if angle > 270.0 && turn < 2.0 => 4.0,
        turn => turn,
    };
    let mut inside = Vec::new();
    for j in 0..n {
        let (mut part, next) = (parts[(first + j) % n], starts[(first + j + 1) % n]);
        if j == 0 {
            part.from = at(&part, right);
        }
        if next >= end {
            part.to = at(&part, left);
            inside.push(part);
            return inside;
        }
        inside.push(part);
    }
    // What is left of the first part, on the other side of the sector.
    inside.push(Part { to: at(&parts[first], left), ..parts[first] });
    inside
}

/// How far a direction is turned counter-clockwise from another one, from 0 to 4: monotonic in the angle, without functions of angles.
fn turn_from(from: Point2, d: Point2) -> f64 {
    let (x, y) = (from.dot(d), from.perp_dot(d));
    let part = x / (x.abs() + y.abs());
    if y >= 0.0 { 1.0 - part } else { 3.0 + part }
}

/// A part within a circle around the eye: what is outside becomes pieces of the circle.
fn in_circle(part: Part, radius: f64, deviation: f64) -> Vec<Part> {
    let step = part.to - part.from;
    let length = step.length();
    if length == 0.0 || !length.is_finite() {
        return Vec::new();
    }
    let direction = step / length;
    let (s, e) = (part.from.dot(direction), part.to.dot(direction));
    let foot = part.from - direction * s;
    let half_chord = radius * radius - foot.length_squared();
    let mut pieces = Vec::new();
    let onto = |p: Point2| p * (radius / p.length());
    if half_chord <= 0.0 {
        arc(onto(part.from), onto(part.to), radius, deviation, &mut pieces);
        return pieces;
    }
    let half_chord = half_chord.sqrt();
    let (enters, leaves) = ((-half_chord).clamp(s, e), half_chord.clamp(s, e));
    let point = |t: f64| {
        if t == s {
            part.from
        } else if t == e {
            part.to
        } else {
            foot + direction * t
        }
    };
    if enters >= leaves {
        arc(onto(part.from), onto(part.to), radius, deviation, &mut pieces);
        return pieces;
    }
    if enters > s {
        arc(onto(part.from), point(enters), radius, deviation, &mut pieces);
    }
    pieces.push(Part { from: point(enters), to: point(leaves), kind: part.kind });
    if leaves < e {
        arc(point(leaves), onto(part.to), radius, deviation, &mut pieces);
    }
    pieces
}

/// Straight pieces along a circle, halved until none is farther inside of it than the deviation.
fn arc(from: Point2, to: Point2, radius: f64, deviation: f64, pieces: &mut Vec<Part>) {
    let middle = from + to;
    let sagitta = radius - 0.5 * middle.length();
    let on_circle = middle * (radius / middle.length());
    if sagitta <= deviation || on_circle == from || on_circle == to || !on_circle.is_finite() {
        pieces.push(Part { from, to, kind: Boundary::Limit });
        return;
    }
    arc(from, on_circle, radius, deviation, pieces);
    arc(on_circle, to, radius, deviation, pieces);
}

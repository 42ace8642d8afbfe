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
    /// radius if it is `None`.
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
            if !direction.is_finite() || direction.try_normalize().is_none() {
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
        let mut parts: Vec<Part> = relative.filter(|part| part.from.perp_dot(part.to) > 0.0).collect();
        let mut limited = Self { eye: self.eye, angle: self.angle, ..Self::default() };
        if let Some(sector) = limits.sector {
            limited.angle = sector.angle.to_radians();
            let (right, left) = sector.sides();
            parts = in_sector(&parts, right, left, sector.angle);
        }
        if let Some(radius) = limits.radius {
            let deviation = limits.deviation.unwrap_or(radius * 1e-3);
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
        let d = self.direction.normalize();
        (
            Point2::new(d.x * cos + d.y * sin, d.y * cos - d.x * sin),
            Point2::new(d.x * cos - d.y * sin, d.y * cos + d.x * sin),
        )
    }
}

/// Where a ray in direction `d` from the eye meets the line of a part.
fn at(part: &Part, d: Point2) -> Point2 {
    let step = part.to - part.from;
    d * (part.from.perp_dot(step) / d.perp_dot(step))
}

/// The parts inside a sector, from its right side to its left one.
fn in_sector(parts: &[Part], right: Point2, left: Point2, angle: f64) -> Vec<Part> {
    // Whether a direction within the half circle from `from` to `to` lies strictly inside a part.
    let holds = |part: &Part, d: Point2| part.from.perp_dot(d) >= 0.0 && d.perp_dot(part.to) > 0.0;
    let Some(first) = parts.iter().position(|part| holds(part, right)) else { return Vec::new() };
    let mut inside = Vec::new();
    for (i, part) in parts[first..].iter().chain(&parts[..=first]).enumerate() {
        let mut part = *part;
        let (starts, again) = (i == 0, i == parts.len());
        if starts {
            part.from = at(&part, right);
        }
        // The first part holds both sides of a narrow sector; of a wide one, the left side comes when it is met again.
        let ends = holds(&part, left) && (!starts || right.perp_dot(left) > 0.0 && angle < 180.0);
        if ends {
            let end = at(&part, left);
            if end != part.from {
                inside.push(Part { to: end, ..part });
            }
            break;
        }
        if again {
            break;
        }
        inside.push(part);
    }
    inside
}

/// A part within a circle around the eye: what is outside becomes pieces of the circle.
fn in_circle(part: Part, radius: f64, deviation: f64) -> Vec<Part> {
    let step = part.to - part.from;
    let length = step.length();
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

//! Half-spaces whose border goes through the eye, and how far rounding may move a border.
//!
//! Everything here is about vectors from the eye. A [`Side`] keeps the vectors `v` with `normal · v >= 0`; it
//! lets go only of what is certainly on the other side, `normal · v < -tolerance` in plain doubles. What is
//! kept too much is within rounding of the border, and so the answers err towards visible.
//!
//! **The tolerance.** With u = 2^-53, R a bound on |v|₁ (sum of magnitudes) of every tested vector, and w the rounded
//! form of a true vector:
//!
//! - A side through an edge of a portal has the normal E × v (v from the eye to a corner, E along the edge). Each
//!   of v and E carries a relative error of u in each coordinate, the products and their difference 3 u more; so
//!   the value of the normal at w is off by at most 5 u |v|₁ |E|₁ R, and adding up three products costs 4 u |v|₁
//!   |E|₁ R. Let A = |v|₁ |E|₁ R; for a side that the viewer's cone brings along, |normal|₁ stands for |v|₁ |E|₁,
//!   and the 16 u by which its constructor may be off, and the 174 u of a turn into the frame of a table, are part of what follows.
//! - Clipping a polygon makes a new corner on an edge, at a place that is off by at most 8 u R in each coordinate.
//!   Polygons are always the input's, clipped afresh by at most [`MOST_SIDES`] = 24 sides, so that a point of the true
//!   clipped polygon is never farther than 24 × 8 u R from the computed one. At such a point a normal's value
//!   changes by at most 192 u A. The new corner lies where the value is -tolerance but for 22 u A.
//! - Together below 256 u A. A piece that is put together from others may reach beyond a side by a quarter of the
//!   tolerance ([`Side::nearly_keeps`]), and by the error of the corners that it is tested with, below 181 u A. The
//!   tolerance is 1024 u A = 2^-43 A, of which these take 256 + 256 + 181 + 174, and the smallest normal number for
//!   underflow.
//!
//! If the eye itself is known only to within `slack` in each coordinate (seen in a mirror), the value changes by
//! at most slack |E|₁ (|v|₁ + R) more, for which 4 slack |E|₁ R is added (|v|₁ is at most R).
//!
//! With numbers that overflow the tolerance is infinite or a comparison is one with NaN: nothing is let go.

use sightlines_geometry::Aabb;
pub(crate) use sightlines_geometry::vector::{cross, dot, sub};

/// The most sides of a cone of sight, and corners of a portal, that are worked with; more are left out, which
/// shows more.
pub(crate) const MOST_SIDES: usize = 24;

/// The tolerance as a share of its measure: 2^-43.
const SHARE: f64 = 1.0 / (1u64 << 43) as f64;

pub(crate) type Vector = [f64; 3];

/// A half-space through the eye.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Side {
    normal: Vector,
    tolerance: f64,
    /// |v|₁ |E|₁ of the documentation of this file, or |normal|₁.
    size: f64,
    /// |E|₁ of a side through an edge, else 0: how much the slack of the eye counts, for each unit of radius.
    edge: f64,
    /// |normal|₁ of a given side, else 0: how much the slack of the eye counts.
    still: f64,
}

/// How far tested points are from the eye, and how well the eye is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reach {
    /// Bound on |v|₁ of every vector from the eye.
    pub(crate) radius: f64,
    /// Bound on the error of each coordinate of the eye.
    pub(crate) slack: f64,
}

impl Reach {
    /// No bound yet.
    const NOWHERE: Self = Self { radius: 0.0, slack: 0.0 };
}

impl Side {
    /// A side with a given normal of about unit length, for no reach yet.
    pub(crate) fn given(normal: Vector) -> Self {
        let size = norm(normal);
        Self { normal, tolerance: 0.0, size, edge: 0.0, still: size }.within(Reach::NOWHERE)
    }

    /// The side through the eye and the edge from `corner` (as a vector from the eye) along `edge`, with what
    /// lies counter-clockwise of the edge as the eye sees it.
    #[inline]
    pub(crate) fn through(corner: Vector, edge: Vector, reach: Reach) -> Self {
        let length = norm(edge);
        let size = norm(corner) * length;
        Self { normal: cross(edge, corner), tolerance: 0.0, size, edge: length, still: 0.0 }.within(reach)
    }

    /// The side to the right of the vector `left`, in the plane. The edge is the unit vector upwards.
    #[inline]
    pub(crate) fn right_of(left: Vector, reach: Reach) -> Self {
        let size = norm(left);
        Self { normal: [left[1], -left[0], 0.0], tolerance: 0.0, size, edge: 1.0, still: 0.0 }.within(reach)
    }

    /// The side to the left of the vector `right`, in the plane.
    #[inline]
    pub(crate) fn left_of(right: Vector, reach: Reach) -> Self {
        let side = Self::right_of(right, reach);
        Self { normal: side.normal.map(|x| -x), ..side }
    }

    /// The same side, for vectors within `reach`.
    #[inline]
    pub(crate) fn within(self, reach: Reach) -> Self {
        let moved = self.edge * reach.radius + self.still;
        let tolerance = self.size * reach.radius * SHARE + 4.0 * reach.slack * moved + f64::MIN_POSITIVE;
        Self { tolerance, ..self }
    }

    /// Where inside is; of any length.
    pub(crate) fn normal(&self) -> Vector {
        self.normal
    }

    /// What the error of the normal is a share of: its magnitude, or more, if it is a difference of larger numbers.
    pub(crate) fn size(&self) -> f64 {
        self.size
    }

    /// How far inside; meant to be compared with [`Side::lets_go`] only.
    #[inline]
    pub(crate) fn value(&self, v: Vector) -> f64 {
        dot(self.normal, v)
    }

    /// Whether a vector with this value is certainly outside.
    #[inline]
    pub(crate) fn lets_go(&self, value: f64) -> bool {
        value < -self.tolerance
    }

    /// Whether a vector with this value is inside or so near the border that a side more than half as tolerant would keep it.
    #[inline]
    pub(crate) fn nearly_keeps(&self, value: f64) -> bool {
        value >= -0.25 * self.tolerance
    }

    /// Where the border is drawn: values from here on are kept.
    #[inline]
    pub(crate) fn border(&self) -> f64 {
        -self.tolerance
    }

    /// Whether a box is certainly outside as a whole. Monotone: a box that contains another, or a point that is
    /// not outside, is not outside either, rounding included, as each step of the sum is monotone.
    #[inline]
    pub(crate) fn excludes_box(&self, bounds: &Aabb<3>, eye: Vector) -> bool {
        let far = |k: usize| (if self.normal[k] >= 0.0 { bounds.max[k] } else { bounds.min[k] }) - eye[k];
        self.lets_go(self.value([far(0), far(1), far(2)]))
    }

    /// The side as a mirror whose plane is at a right angle to the unit vector `across` shows it. Exact along an
    /// axis; else off by some 8 u of its size, for which the tolerance has room.
    pub(crate) fn mirrored(self, across: Vector) -> Self {
        Self { normal: mirrored(self.normal, across), ..self }
    }
}

/// Bound on the sum of magnitudes of `p - eye` for the points of a box; 0 if it is empty. Rounded up by more than
/// the additions may lose.
pub(crate) fn radius(bounds: &Aabb<3>, eye: Vector) -> f64 {
    let far = |k: usize| (bounds.max[k] - eye[k]).abs().max((bounds.min[k] - eye[k]).abs());
    if bounds.is_empty() { 0.0 } else { (far(0) + far(1) + far(2)) * (1.0 + 8.0 * f64::EPSILON) }
}

/// The vector `v` as a mirror at a right angle to the unit vector `across` shows it.
pub(crate) fn mirrored(v: Vector, across: Vector) -> Vector {
    let along = 2.0 * dot(v, across);
    std::array::from_fn(|k| v[k] - along * across[k])
}

/// Sum of magnitudes.
#[inline]
pub(crate) fn norm(v: Vector) -> f64 {
    v[0].abs() + v[1].abs() + v[2].abs()
}

//! Affine functions on a plane, with bounds of their errors, and integers below them.

use crate::BufferPlane;
use sightlines_geometry::Point3;

/// A plane with the scale of its coefficients.
pub(super) struct Window<'a> {
    pub(super) plane: &'a BufferPlane,
    /// Largest coefficient of an edge.
    largest: f64,
}

/// Largest magnitude of `A * x`; see the module of forms.
const LARGEST_TERM: f64 = (1u32 << 28) as f64;
/// A constant coefficient below minus this is abandoned.
const LARGEST_CONSTANT: f64 = (1u32 << 30) as f64;
/// Largest magnitude of a value's coefficients across the bounds.
const LARGEST_VALUE: f64 = (1u32 << 29) as f64;

/// A number known to lie within `error` of `about`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Around {
    pub(super) about: f64,
    pub(super) error: f64,
}

impl Around {
    /// A lower bound of the number: the difference is rounded, and its error subtracted as well.
    pub(super) fn low(self) -> f64 {
        (self.about - self.error).next_down()
    }

    /// An upper bound of the number.
    pub(super) fn high(self) -> f64 {
        (self.about + self.error).next_up()
    }
}

impl<'a> Window<'a> {
    pub(super) fn new(plane: &'a BufferPlane) -> Self {
        let [w, h] = plane.texels();
        Self { plane, largest: (LARGEST_TERM / f64::from(w.max(h))).floor() }
    }

    /// All of its texels.
    pub(super) fn all(&self) -> [i32; 4] {
        let [w, h] = self.plane.texels();
        [0, 0, w as i32, h as i32]
    }

    /// The corners of `bounds`, as places in the grid of texels: lower left, lower right, upper left, upper right.
    pub(super) fn places([x0, y0, x1, y1]: [i32; 4]) -> [[i32; 2]; 4] {
        [[x0, y0], [x1, y0], [x0, y1], [x1, y1]]
    }

    /// A place in the grid of texels as a point. Exact.
    pub(super) fn point(&self, [x, y]: [i32; 2]) -> Point3 {
        self.plane.corner(x as u32, y as u32)
    }

    /// Integers `A, B, C` with `A * x + B * y + C` nowhere more than a positive multiple of the function in the
    /// texel whose lower corner is `(x, y)`, for all texels of `bounds`; `at` are the values of the function at
    /// the corners of the bounds, as [`Self::places`] orders them.
    pub(super) fn edge(&self, bounds: [i32; 4], at: [Around; 4]) -> Edge {
        if at.iter().all(|f| f.low() >= 0.0) {
            return Edge::Superfluous;
        }
        if at.iter().all(|f| f.high() < 0.0) {
            return Edge::Nowhere;
        }
        let width = f64::from(bounds[2] - bounds[0]);
        let height = f64::from(bounds[3] - bounds[1]);
        let (dx, dy) = ((at[1].about - at[0].about) / width, (at[2].about - at[0].about) / height);
        let scale = self.largest / dx.abs().max(dy.abs());
        if !scale.is_finite() {
            return Edge::Nowhere;
        }
        let (a, b) = ((dx * scale).round(), (dy * scale).round());
        // Sums of whole numbers below 2^53 are exact; the product with the scale is rounded once.
        let low = |f: Around| {
            let scaled = f.low() * scale;
            (if scaled.is_finite() { scaled.next_down() } else { f64::NEG_INFINITY }).floor()
        };
        let rest = |([x, y], f): ([i32; 2], Around)| low(f) - (a * f64::from(x) + b * f64::from(y));
        let c = Self::places(bounds).into_iter().zip(at).map(rest).fold(f64::INFINITY, f64::min);
        let c = c + a.min(0.0) + b.min(0.0);
        if c < -LARGEST_CONSTANT { Edge::Nowhere } else { Edge::Integers([a as i32, b as i32, c as i32]) }
    }

    /// Integers `P, Q, R` with `R + P * (x - x0) + Q * (y - y0)` nowhere more than a function of values in the texel whose
    /// lower corner is `(x, y)`, for all texels of `bounds`; `low` are lower bounds of the affine function at the
    /// corners of the bounds. None if they do not fit.
    pub(super) fn slope(bounds: [i32; 4], low: [f64; 4]) -> Option<[i32; 3]> {
        let [x0, y0, x1, y1] = bounds;
        let (width, height) = (f64::from(x1 - x0), f64::from(y1 - y0));
        let (p, q) = (((low[1] - low[0]) / width).round(), ((low[2] - low[0]) / height).round());
        let rest = |([x, y], low): ([i32; 2], f64)| low.floor() - p * f64::from(x - x0) - q * f64::from(y - y0);
        let r = Self::places(bounds).into_iter().zip(low).map(rest).fold(f64::INFINITY, f64::min);
        let r = r + p.min(0.0) + q.min(0.0);
        let fits = (p * width).abs() + (q * height).abs() < LARGEST_VALUE && r.abs() < LARGEST_VALUE;
        fits.then_some([p as i32, q as i32, r as i32])
    }
}

/// An edge in integers.
pub(super) enum Edge {
    /// It holds in all of the bounds.
    Superfluous,
    /// It holds nowhere, or this cannot be decided.
    Nowhere,
    /// `A, B, C`.
    Integers([i32; 3]),
}

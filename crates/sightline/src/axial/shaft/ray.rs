//! A line in doubles, by the times at which it reaches coordinates.

use super::super::rows::Line;
use sightlines_geometry::Aabb;

/// Relative error of a time, with room to spare: a difference, a reciprocal of a difference, and their
/// product err by 2^-53 of themselves each, together by less than 2^-50.
const TIME_ERROR: f64 = 4.0 * f64::EPSILON;

/// A line with a time for every coordinate of every axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ray {
    /// Where it is at time 0.
    start: [f64; 3],
    /// Time that a scene unit takes on each axis, signed; finite.
    pace: [f64; 3],
}

impl Ray {
    /// From a start and finite paces; `None` if rounding made them useless.
    pub(super) fn new([start, pace]: [[f64; 3]; 2]) -> Option<Self> {
        let usable = |x: &f64| x.is_finite();
        (start.iter().all(usable) && pace.iter().all(|p| p.is_finite() && *p != 0.0)).then_some(Self { start, pace })
    }

    /// The line through two points, at time 0 and 1.
    pub(super) fn through(line: &Line) -> Option<Self> {
        Self::new([line.from, [0, 1, 2].map(|i| (line.to[i] - line.from[i]).recip())])
    }

    /// When it reaches coordinate `x` of an axis.
    #[inline(always)]
    pub(super) fn time(&self, axis: usize, x: f64) -> f64 {
        (x - self.start[axis]) * self.pace[axis]
    }

    /// Where it is on an axis at a time.
    pub(super) fn place(&self, axis: usize, time: f64) -> f64 {
        self.start[axis] + time / self.pace[axis]
    }

    /// A box that the ray meets if a line meets `b` that the ray was rounded from.
    ///
    /// The start and the paces err by 2^-52 of themselves at most, and the start by 2^-96 of the place `origin` besides that it was computed
    /// from, as that may have cancelled; so at the time at which the line is at `x`, the ray is off by at most 2^-51 of the magnitudes of the
    /// start and of `x`, and by 2^-96 of that of the origin.
    pub(super) fn widened(&self, b: &Aabb<3>, origin: [f64; 3]) -> Aabb<3> {
        let by = [0, 1, 2].map(|i| {
            let sizes = self.start[i].abs() + b.min[i].abs().max(b.max[i].abs());
            16.0 * f64::EPSILON * sizes + origin[i].abs() / (1u128 << 90) as f64
        });
        Aabb { min: [0, 1, 2].map(|i| b.min[i] - by[i]), max: [0, 1, 2].map(|i| b.max[i] + by[i]) }
    }

    /// When it enters and when it leaves a box; the other way round if it misses it.
    #[inline(always)]
    pub(super) fn span(&self, b: &Aabb<3>) -> [f64; 2] {
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for i in 0..3 {
            let (low, high) = (self.time(i, b.min[i]), self.time(i, b.max[i]));
            let (first, last) = if self.pace[i] > 0.0 { (low, high) } else { (high, low) };
            enter = enter.max(first);
            leave = leave.min(last);
        }
        [enter, leave]
    }

    /// Whether it seems to meet the closed box between two times.
    #[inline(always)]
    pub(super) fn seems_to_meet(&self, b: &Aabb<3>, [from, to]: [f64; 2]) -> bool {
        let [enter, leave] = self.span(b);
        enter.max(from) <= leave.min(to)
    }

    /// Whether it may meet the closed box between two times; `false` is certain.
    #[inline(always)]
    pub(super) fn may_meet(&self, b: &Aabb<3>, [from, to]: [f64; 2]) -> bool {
        let [enter, leave] = self.span(b);
        let (enter, leave) = (enter.max(from), leave.min(to));
        enter - enter.abs() * TIME_ERROR <= leave + leave.abs() * TIME_ERROR
    }
}

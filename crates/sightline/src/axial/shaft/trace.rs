//! A free line beyond the two boxes it was found for: how far it goes, and what it meets on its way.

use super::super::rows::{Line, Octant, Row, first_and_last, is_forward, others, sign};
use super::super::witness::AxialWitness;
use super::blockers::Blockers;
use super::ray::Ray;
use sightlines_geometry::{Aabb, AxialDoor};

/// Times closer than this share of themselves may be equal: twice the error of a time.
const SAME_TIME: f64 = 8.0 * f64::EPSILON;

/// Parts of a line, each eight times as long as the one before, that are searched for its ends before all of it is.
const WINDOWS: u32 = 3;

/// Whether one time is certainly before another.
fn apart(early: f64, late: f64) -> bool {
    late - early > SAME_TIME * (early.abs() + late.abs())
}

/// The last time up to a middle, and the first after it, at which something is met.
fn ends_around(middle: f64, met: &[(f64, usize, f64)]) -> [f64; 2] {
    let times = || met.iter().map(|m| m.0);
    let before = times().filter(|t| *t <= middle).fold(f64::NEG_INFINITY, f64::max);
    [before, times().filter(|t| *t > middle).fold(f64::INFINITY, f64::min)]
}

/// A line that was checked to lead from one box to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeLine {
    line: Line,
    octant: Octant,
    pub(super) ray: Ray,
}

/// The part of a line between the nearest rectangles that it meets before and behind some place.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeSpan {
    free: FreeLine,
    /// When it is free, in doubles.
    times: [f64; 2],
    /// Axis and coordinate of the planes that may be its two ends.
    ends: [Vec<(usize, f64)>; 2],
}

impl FreeLine {
    pub(super) fn new(line: Line, octant: Octant) -> Option<Self> {
        Some(Self { line, octant, ray: Ray::through(&line)? })
    }

    /// Two points of the line, in its direction: the first inside the first box, the second in the second.
    pub const fn points(&self) -> [[f64; 3]; 2] {
        [self.line.from, self.line.to]
    }

    /// The same line in fractions.
    pub fn witness(&self) -> AxialWitness {
        AxialWitness::through(&self.line)
    }

    /// Whether it crosses the plane of a door in the door's direction and meets the closed rectangle. Exact.
    pub fn touches(&self, door: &AxialDoor) -> bool {
        let axis = usize::from(door.axis);
        door.forward == is_forward(self.octant, axis) && !self.line.misses(&door.extent, axis, self.octant)
    }

    /// Whether it passes the inside of a box, or crosses a flat one. Exact.
    pub fn passes(&self, bounds: &Aabb<3>) -> bool {
        let extents = [0, 1, 2].map(|i| first_and_last(bounds, self.octant, i));
        let after = |i: usize, j: usize| Row { early: i, late: j, from: extents[i][0], to: extents[j][1] };
        (0..3).all(|i| others(i).into_iter().all(|j| self.line.obeys(&after(i, j), self.octant)))
    }

    /// How far the line goes both ways from where it leaves `from` and enters `to`, the boxes that it
    /// was found for. O(log n) for each rectangle near that part of it, and a little beyond.
    pub fn span(&self, from: &Aabb<3>, to: &Aabb<3>, blockers: &Blockers) -> FreeSpan {
        // A line that was found from `to` to `from` is followed all the same.
        let is_back = self.ray.span(to)[0] < self.ray.span(from)[0];
        let [from, to] = if is_back { [to, from] } else { [from, to] };
        let (leave, enter) = (self.ray.span(from)[1], self.ray.span(to)[0]);
        let middle = leave + (enter - leave) / 2.0;
        let [start, end] = [self.ray.span(from)[0], self.ray.span(to)[1]];
        // Most lines end soon, so what is far along the line is looked at last.
        let windows = (0..WINDOWS).map(|k| f64::from(1u32 << (3 * k)) * (end - start));
        let windows = windows.map(|beyond| [start - beyond, end + beyond]);
        let part = windows.filter(|[from, to]| from < to && from.is_finite() && to.is_finite()).find_map(|within| {
            let met = self.met(within, blockers);
            let ends = ends_around(middle, &met);
            // Whatever is at the same time as an end has to be within, too.
            let is_within = |t: f64| within.iter().all(|w| (t - w).abs() > 4.0 * SAME_TIME * (t.abs() + w.abs()));
            ends.into_iter().all(|t| t.is_finite() && is_within(t)).then(|| self.free_between(ends, &met))
        });
        part.unwrap_or_else(|| {
            let met = self.met([f64::NEG_INFINITY, f64::INFINITY], blockers);
            self.free_between(ends_around(middle, &met), &met)
        })
    }

    /// The rectangles met: when, and their planes. All that are met between two times are among them.
    fn met(&self, times: [f64; 2], blockers: &Blockers) -> Vec<(f64, usize, f64)> {
        let mut met = Vec::new();
        blockers.near(&self.ray, self.octant, times, |i| {
            if !blockers.missed(i, &self.line, self.octant) {
                let (axis, at) = (blockers.axis(i), blockers.rectangle(i).min[blockers.axis(i)]);
                met.push((self.ray.time(axis, at), axis, at));
            }
        });
        met
    }

    /// The part between two times, of which all rectangles met at them are given.
    fn free_between(&self, [before, behind]: [f64; 2], met: &[(f64, usize, f64)]) -> FreeSpan {
        let close = |limit: f64| {
            let near = |m: &&(f64, usize, f64)| (m.0 - limit).abs() <= SAME_TIME * (m.0.abs() + limit.abs());
            met.iter().filter(near).map(|m| (m.1, m.2)).collect()
        };
        FreeSpan { free: *self, times: [before, behind], ends: [close(before), close(behind)] }
    }
}

impl FreeSpan {
    /// Whether the line may meet a closed box on its free part; `false` is certain.
    #[inline]
    pub fn may_meet(&self, bounds: &Aabb<3>) -> bool {
        self.free.ray.may_meet(bounds, self.times)
    }

    /// Whether the free part certainly passes the inside of a box that no rectangle cuts.
    pub fn passes(&self, bounds: &Aabb<3>) -> bool {
        let [enter, leave] = self.free.ray.span(bounds);
        // As nothing cuts the box, the whole of it lies on one side of each end.
        let middle = enter + (leave - enter) / 2.0;
        let [before, behind] = self.times;
        let inside = (before.is_infinite() || apart(before, middle)) && (behind.is_infinite() || apart(middle, behind));
        inside && apart(enter, leave) && self.free.passes(bounds)
    }

    /// Whether the free part certainly passes some of the inside of a box; rectangles may cut it.
    pub fn passes_some_of(&self, bounds: &Aabb<3>) -> bool {
        let [enter, leave] = self.free.ray.span(bounds);
        let [before, behind] = self.times;
        apart(enter.max(before), leave.min(behind)) && self.free.passes(bounds)
    }

    /// Whether a line that the free part [passes](Self::passes_some_of) a box on, and [meets](Self::meets) another, certainly leads from
    /// some of the one to some of the other in its direction.
    pub fn leads(&self, from: &Aabb<3>, to: &Aabb<3>) -> bool {
        let ([enter, _], [_, leave]) = (self.free.ray.span(from), self.free.ray.span(to));
        apart(enter.max(self.times[0]), leave)
    }

    /// Whether the free part, with its ends, meets a closed box in more than its edges. Exact.
    pub fn meets(&self, bounds: &Aabb<3>) -> bool {
        let (free, octant) = (&self.free, self.free.octant);
        if !free.passes(bounds) {
            return false;
        }
        let extents = [0, 1, 2].map(|i| first_and_last(bounds, octant, i));
        let [before, behind] = &self.ends;
        let enters_by = |&(axis, at): &(usize, f64)| {
            sign(octant, axis) * extents[axis][0] <= sign(octant, axis) * at
                && others(axis)
                    .into_iter()
                    .all(|i| free.line.obeys(&Row { early: i, late: axis, from: extents[i][0], to: at }, octant))
        };
        let leaves_after = |&(axis, at): &(usize, f64)| {
            sign(octant, axis) * extents[axis][1] >= sign(octant, axis) * at
                && others(axis)
                    .into_iter()
                    .all(|i| free.line.obeys(&Row { early: axis, late: i, from: at, to: extents[i][1] }, octant))
        };
        before.iter().all(leaves_after) && behind.iter().all(enters_by)
    }
}

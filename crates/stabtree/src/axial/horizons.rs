//! Horizons: how far from a group of cells, along an axis, everything is hidden.
//!
//! From an office of a tower everything is hidden that is more than a storey above. With one query for the group and each
//! other group there, their number grows with the square of the storeys, if only because stairs are open from each
//! storey to each. One query for the group and all that is beyond some plane hides the same at once.
//!
//! A horizon is sought when a group has been asked about often in one direction, so it is at most a fraction of the work that
//! was done. It depends on nothing but the group; whether it has been sought already depends on the order of work. So that
//! answers do not, a pair of cells that nothing else decides asks [all that might hide it](AxialSearch::is_hidden_in_groups).

use super::AxialSearch;
use super::first_true::first_true;
use super::pairs::Pair;
use super::witness_log::{FoundFor, Worker};
use sightlines_geometry::Aabb;
use sightlines_sightline::{ShaftLine, Verdict};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// Queries about a group in one direction before its horizon is sought.
const PATIENCE: u32 = 48;

/// Linear programs spent on a group and all that is beyond a plane: what hides that is simple.
const HORIZON_BUDGET: u32 = 8;

/// Most planes that are tried for a horizon, each twice as far away as the one before.
const PLANES: u32 = 32;

/// The horizons of all groups.
#[derive(Debug, Default)]
pub(super) struct Horizons {
    /// By node; for each axis downwards, then upwards.
    of: Vec<[Horizon; 6]>,
}

#[derive(Debug, Default)]
struct Horizon {
    n_asked: AtomicU32,
    /// Everything at least this coordinate or beyond is hidden; infinite if nothing is.
    at: OnceLock<f64>,
}

/// A direction along an axis.
#[derive(Debug, Clone, Copy)]
struct Direction {
    axis: usize,
    up: bool,
}

impl Direction {
    fn index(self) -> usize {
        2 * self.axis + usize::from(self.up)
    }

    /// How far a box is beyond another; negative if it is not.
    fn gap(self, from: &Aabb<3>, to: &Aabb<3>) -> f64 {
        if self.up { to.min[self.axis] - from.max[self.axis] } else { from.min[self.axis] - to.max[self.axis] }
    }

    /// Whether a box is at a coordinate or beyond.
    fn is_beyond(self, b: &Aabb<3>, at: f64) -> bool {
        if self.up { b.min[self.axis] >= at } else { b.max[self.axis] <= at }
    }
}

impl Horizons {
    pub(super) fn new(n_nodes: usize) -> Self {
        Self { of: std::iter::repeat_with(Default::default).take(n_nodes).collect() }
    }
}

fn extent(b: &Aabb<3>, axis: usize) -> f64 {
    b.max[axis] - b.min[axis]
}

impl AxialSearch<'_> {
    /// The horizons that may hide a group of a pair from the other: those of the one that are at least as far away from it as it
    /// is wide.
    fn directions([from, to]: [&Aabb<3>; 2]) -> impl Iterator<Item = Direction> + use<> {
        let (from, to) = (*from, *to);
        let all = (0..3).flat_map(|axis| [false, true].map(|up| Direction { axis, up }));
        all.filter(move |direction| {
            let gap = direction.gap(&from, &to);
            gap > 0.0 && gap >= extent(&from, direction.axis)
        })
    }

    /// Whether a group is hidden from another by a horizon of one of them. Counts as a query about both, and horizons that are worth it
    /// are sought.
    pub(super) fn is_beyond_horizon(&self, pair: Pair, worker: &mut Worker<'_>) -> bool {
        self.is_beyond(pair, PATIENCE, worker)
    }

    /// The same; horizons are sought if there were this many queries.
    pub(super) fn is_beyond(&self, [a, b]: Pair, patience: u32, worker: &mut Worker<'_>) -> bool {
        if self.horizons.of.is_empty() {
            return false;
        }
        let [of_a, of_b] = [a, b].map(|n| &self.tree.nodes()[n as usize].bounds);
        [(a, of_a, of_b), (b, of_b, of_a)].into_iter().any(|(node, from, to)| {
            Self::directions([from, to]).any(|direction| {
                let horizon = &self.horizons.of[node as usize][direction.index()];
                let is_due = || horizon.n_asked.fetch_add(1, Relaxed) >= patience;
                let at = match horizon.at.get() {
                    None if !is_due() => return false,
                    _ => *horizon.at.get_or_init(|| self.horizon_of(from, direction, worker)),
                };
                direction.is_beyond(to, at)
            })
        })
    }

    /// The nearest of some planes, each twice as far from a group as the one before, beyond which everything is hidden from the
    /// group; infinite if there is none.
    fn horizon_of(&self, from: &Aabb<3>, direction: Direction, worker: &mut Worker<'_>) -> f64 {
        let Direction { axis, up } = direction;
        let all = self.tree.nodes()[0].bounds;
        let plane = |k: u32| {
            let gap = extent(from, axis) * (1u64 << k) as f64;
            if up { from.max[axis] + gap } else { from.min[axis] - gap }
        };
        let beyond = |at: f64| {
            let mut rest = all;
            *(if up { &mut rest.min[axis] } else { &mut rest.max[axis] }) = at;
            Some(rest).filter(|rest| rest.min[axis] < rest.max[axis])
        };
        let end = (0..PLANES).find(|&k| beyond(plane(k)).is_none()).unwrap_or(PLANES);
        // Most that have no horizon are found out by one query, about the farthest plane.
        let found = first_true(0, end, end.saturating_sub(1), |k| {
            let Some(rest) = beyond(plane(k)) else { return true };
            match worker.shaft.decide_either(from, &rest, HORIZON_BUDGET) {
                Verdict::Hidden(()) => true,
                Verdict::Visible(ShaftLine::Free(line)) => {
                    self.follow(&line, [from, &rest], FoundFor::Groups, worker);
                    false
                }
                Verdict::Visible(ShaftLine::Fine(_)) | Verdict::Undecided(_) => false,
            }
        });
        match found < end {
            true => plane(found),
            false if up => f64::INFINITY,
            false => f64::NEG_INFINITY,
        }
    }
}

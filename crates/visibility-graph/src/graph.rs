//! The graph: for each point the points that it sees, as runs of consecutive numbers.

use crate::bytes::fits_row;
use crate::work::Stage;
use crate::{Run, WorkOptions};
use sightlines_progress::{Cancelled, Halt};

/// Which points see which, without the points themselves: a point is not among those that it sees.
///
/// A row is a list of runs, 8 bytes each. Points of a [`PixelGrid`](crate::PixelGrid) are numbered up its columns, so a run is what is seen of a
/// column without interruption.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VisibilityGraph {
    rows: Vec<Box<[Run]>>,
}

/// Why there is no graph.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GraphError {
    /// What a point sees is not an ascending list of points.
    #[error("what point {point} sees is not an ascending list of numbers below {n_points}")]
    Row {
        /// The point.
        point: u32,
        /// Points of the graph.
        n_points: u32,
    },
    /// The observer cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The store of units ends the work: it keeps what was done, and the rest is for others or later.
    #[error(transparent)]
    Halted(Halt),
}

impl From<Halt> for GraphError {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Cancelled(cancelled) => cancelled.into(),
            halt => Self::Halted(halt),
        }
    }
}

/// Points of a unit of work.
const UNIT: usize = 256;

impl VisibilityGraph {
    /// Builds the graph of `n_points` points.
    ///
    /// * `seen`: fills an empty list with the numbers of the points that are seen from the given one, ascending; the point itself may be
    ///   among them. It is called once for each point, from all threads. Measures take for granted that who is seen sees
    ///   ([`first_one_sided`](Self::first_one_sided)).
    ///
    /// # Errors
    /// [`GraphError`]
    ///
    /// # Cost
    /// That of the calls, and 8 bytes for each run.
    pub fn build(
        n_points: u32,
        seen: impl Fn(u32, &mut Vec<u32>) + Sync + Send,
        effort: &WorkOptions<'_>,
    ) -> Result<Self, GraphError> {
        let state = || (Vec::new(), Vec::new());
        let row = |(list, runs): &mut (Vec<u32>, Vec<Run>), point: usize| {
            let point = point as u32;
            list.clear();
            seen(point, list);
            let ascends = list.is_sorted_by(|a, b| a < b) && list.last().is_none_or(|&last| last < n_points);
            runs_of(list, point, runs);
            ascends.then(|| Box::<[Run]>::from(&runs[..])).ok_or(GraphError::Row { point, n_points })
        };
        let stage = Stage::<Box<[Run]>> {
            title: "what points see",
            phase: "sight",
            size: UNIT,
            cost: &|_| 1.0,
            fits: &|row, point| fits_row(row, point, n_points as usize),
        };
        Ok(Self { rows: effort.each(&stage, n_points as usize, state, row)? })
    }

    /// Number of points.
    pub fn n_points(&self) -> usize {
        self.rows.len()
    }

    /// What a point sees, ascending; neighbouring runs do not touch, except around the point itself.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn row(&self, point: u32) -> &[Run] {
        &self.rows[point as usize]
    }

    /// The numbers of the points that a point sees, ascending.
    ///
    /// # Panics
    /// If there is no such point.
    pub fn seen(&self, point: u32) -> impl Iterator<Item = u32> + '_ {
        self.row(point).iter().flat_map(|run| run.start..run.end)
    }

    /// How many points a point sees. O(runs).
    ///
    /// # Panics
    /// If there is no such point.
    pub fn n_seen(&self, point: u32) -> u32 {
        self.row(point).iter().map(|run| run.end - run.start).sum()
    }

    /// Whether the first point sees the second; not if they are one point. O(log runs).
    ///
    /// # Panics
    /// If there is no such first point.
    pub fn sees(&self, a: u32, b: u32) -> bool {
        let row = self.row(a);
        let next = row.partition_point(|run| run.end <= b);
        row.get(next).is_some_and(|run| run.start <= b)
    }

    /// Number of runs of all rows.
    pub fn n_runs(&self) -> usize {
        self.rows.iter().map(|row| row.len()).sum()
    }

    /// Bytes that the rows take.
    pub fn n_bytes(&self) -> usize {
        self.n_runs() * size_of::<Run>() + self.rows.len() * size_of::<Box<[Run]>>()
    }

    /// The first pair of which the first point sees the second, but not the other way round. `None` for a graph that measures make sense
    /// of. O(pairs that see each other · log runs).
    pub fn first_one_sided(&self) -> Option<(u32, u32)> {
        let points = 0..self.rows.len() as u32;
        points.flat_map(|a| self.seen(a).map(move |b| (a, b))).find(|&(a, b)| !self.sees(b, a))
    }

    /// For each point the smallest number of a point that can be reached from it through any others.
    /// O(runs · a number that hardly grows + points).
    pub(crate) fn components(&self) -> Vec<u32> {
        fn root(parent: &mut [u32], mut p: u32) -> u32 {
            while parent[p as usize] != p {
                parent[p as usize] = parent[parent[p as usize] as usize];
                p = parent[p as usize];
            }
            p
        }
        let n = self.rows.len();
        let mut parent: Vec<u32> = (0..n as u32).collect();
        let mut join = |a: u32, b: u32| {
            let [a, b] = [root(&mut parent, a), root(&mut parent, b)];
            // The smaller one leads.
            parent[a.max(b) as usize] = a.min(b);
        };
        // Points of one run are joined once for all rows: to the next one, by a count of the runs that go on there.
        let mut goes_on = vec![0i32; n + 1];
        for (point, row) in self.rows.iter().enumerate() {
            for run in row {
                join(point as u32, run.start);
                goes_on[run.start as usize] += 1;
                goes_on[run.end as usize - 1] -= 1;
            }
        }
        let mut depth = 0;
        for (point, change) in (0u32..).zip(&goes_on[..n]) {
            depth += change;
            if depth > 0 {
                join(point, point + 1);
            }
        }
        (0..n as u32).map(|p| root(&mut parent, p)).collect()
    }
}

/// The runs of an ascending list without one of its points.
fn runs_of(list: &[u32], point: u32, runs: &mut Vec<Run>) {
    runs.clear();
    for &seen in list.iter().filter(|&&seen| seen != point) {
        match runs.last_mut() {
            Some(run) if run.end == seen => run.end += 1,
            _ => runs.push(Run { start: seen, end: seen.saturating_add(1) }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(lists: &[&[u32]]) -> Result<VisibilityGraph, GraphError> {
        let seen = |point: u32, list: &mut Vec<u32>| list.extend_from_slice(lists[point as usize]);
        VisibilityGraph::build(lists.len() as u32, seen, &WorkOptions::default())
    }

    #[test]
    fn rows_are_runs_without_the_point() {
        let graph = of(&[&[0, 1, 2, 4], &[0, 1, 2], &[0, 1], &[], &[0]]).unwrap();
        let run = |start, end| Run { start, end };
        assert_eq!(graph.row(0), [run(1, 3), run(4, 5)]);
        assert_eq!(graph.row(1), [run(0, 1), run(2, 3)], "a run ends at the point itself");
        assert_eq!((graph.n_seen(0), graph.n_seen(3), graph.n_points(), graph.n_runs()), (3, 0, 5, 6));
        assert_eq!(graph.seen(0).collect::<Vec<_>>(), [1, 2, 4]);
        let sees: Vec<bool> = (0..5).map(|b| graph.sees(0, b)).collect();
        assert_eq!(sees, [false, true, true, false, true]);
        assert_eq!(graph.first_one_sided(), None);
        assert_eq!(graph.components(), [0, 0, 0, 3, 0]);
    }

    #[test]
    fn one_sided_pairs_and_wrong_lists_are_noticed() {
        assert_eq!(of(&[&[1], &[], &[]]).unwrap().first_one_sided(), Some((0, 1)));
        for wrong in [&[1u32, 1][..], &[2, 1], &[3], &[u32::MAX]] {
            let error = of(&[&[], wrong, &[]]).unwrap_err();
            assert_eq!(error.to_string(), "what point 1 sees is not an ascending list of numbers below 3");
        }
        assert_eq!(of(&[]).unwrap().components(), [0u32; 0]);
    }

    #[test]
    fn points_are_joined_through_runs() {
        // 2 sees 3 to 5, which do not see each other.
        let graph = of(&[&[1], &[0], &[3, 4, 5], &[2], &[2], &[2], &[]]).unwrap();
        assert_eq!(graph.components(), [0, 0, 2, 2, 2, 2, 6]);
    }

    #[test]
    fn an_observer_cancels() {
        let stop = |_: sightlines_progress::Progress| std::ops::ControlFlow::Break(());
        let effort = WorkOptions { threads: 2, observer: Some(&stop), ..WorkOptions::default() };
        let graph = VisibilityGraph::build(9, |_, _| (), &effort);
        assert_eq!(graph, Err(GraphError::Cancelled(Cancelled)));
    }
}

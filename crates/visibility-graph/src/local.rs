//! Local measures: what a point's neighbourhood in the graph is like.

use crate::bytes::fits_values;
use crate::work::Stage;
use crate::{Points, Run, UNDEFINED, VisibilityGraph, WorkOptions};
use sightlines_progress::Halt;

/// Local measures of all points, a value for each point in every list. With N(i) the points that i sees, and k of them:
///
/// # Source
/// Turner, Doxa, O'Sullivan and Penn 2001 (connectivity, clustering); Hillier and Hanson 1984 (control); Turner 2001 (controllability).
/// Definitions are those of depthmapX, `sparkPixel2` in salalib/pointdata.cpp and `VGAVisualLocal::run`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LocalMeasures {
    /// k, which depthmapX names connectivity. The point itself does not count.
    pub connectivity: Vec<u32>,
    /// Sum of the distances to N(i), in scene units (point first moment).
    pub first_moment: Vec<f64>,
    /// Sum of the squared distances to N(i), in square scene units (point second moment).
    pub second_moment: Vec<f64>,
    /// Visual clustering coefficient: the share of ordered pairs of N(i) that see each other, sum over j in N(i) of |N(i) ∩ N(j)|, over
    /// k (k - 1). [`UNDEFINED`] for k < 2, as the next two are.
    pub clustering: Vec<f64>,
    /// Visual control: sum over j in N(i) of 1 / |N(j)|.
    pub control: Vec<f64>,
    /// Visual controllability: k over the number of points in the union of all N(j), j in N(i). The union contains i, and a point of N(i)
    /// if another one of them sees it.
    pub controllability: Vec<f64>,
}

/// Points of a unit of work.
const UNIT: usize = 256;

/// What one point has, in the order of the fields.
type Row = (u32, [f64; 5]);

impl LocalMeasures {
    /// Computes the local measures.
    ///
    /// # Errors
    /// [`Halt`] by the observer, or by the store of units.
    ///
    /// # Panics
    /// If the points are not as many as those of the graph.
    ///
    /// # Cost
    /// For each point O(points + runs of the points that it sees and the one before it does not, or the other way round), on all threads.
    pub fn of(graph: &VisibilityGraph, points: &Points, effort: &WorkOptions<'_>) -> Result<Self, Halt> {
        let n = graph.n_points();
        assert_eq!(n, points.len(), "one row for each point");
        let degrees: Vec<u32> = (0..n as u32).map(|p| graph.n_seen(p)).collect();
        let row =
            |sight: &mut Sight<'_>, point: usize| Ok::<_, Halt>(one(graph, points, &degrees, point as u32, sight));
        let (cost, fits) = (&|point: usize| f64::from(degrees[point]), &|row: &_, _| fits_values(row, n));
        let stage = Stage { title: "local measures", phase: "local-measures", size: UNIT, cost, fits };
        let rows = effort.each(&stage, n, || Sight::new(graph), row)?;
        let column = |k: usize| rows.iter().map(|(_, values)| values[k]).collect();
        Ok(Self {
            connectivity: rows.iter().map(|&(k, _)| k).collect(),
            first_moment: column(0),
            second_moment: column(1),
            clustering: column(2),
            control: column(3),
            controllability: column(4),
        })
    }
}

fn one(graph: &VisibilityGraph, points: &Points, degrees: &[u32], point: u32, sight: &mut Sight<'_>) -> Row {
    let k = degrees[point as usize];
    let (mut first, mut second, mut control) = (0.0, 0.0, 0.0);
    for j in graph.seen(point) {
        let [x, y] = points.offset(point, j);
        let square = x * x + y * y;
        first += square.sqrt();
        second += square;
        control += 1.0 / f64::from(degrees[j as usize]);
    }
    let unit = points.unit();
    let (first, second) = (first * unit, second * (unit * unit));
    if k < 2 {
        return (k, [first, second, UNDEFINED, UNDEFINED, UNDEFINED]);
    }
    sight.go_to(point);
    let [n_both, n_union] = sight.counts();
    let pairs = f64::from(k) * f64::from(k - 1);
    (k, [first, second, n_both as f64 / pairs, control, f64::from(k) / n_union as f64])
}

/// How many of the points that a point sees see each point.
struct Sight<'a> {
    graph: &'a VisibilityGraph,
    /// The point.
    at: Option<u32>,
    /// Those numbers, as the change from each point to the next.
    changes: Vec<i32>,
}

impl<'a> Sight<'a> {
    fn new(graph: &'a VisibilityGraph) -> Self {
        Self { graph, at: None, changes: vec![0; graph.n_points() + 1] }
    }

    /// Takes another point. Neighbours see nearly the same, so only what one of the two sees is added or taken away.
    fn go_to(&mut self, point: u32) {
        let (graph, new) = (self.graph, self.graph.row(point));
        let old = self.at.replace(point).map_or(&[][..], |old| graph.row(old));
        let length = |runs: &[Run]| runs.iter().map(|run| u64::from(run.end - run.start)).sum::<u64>();
        let mut n_changed = 0;
        differences(old, new, |run, _| n_changed += u64::from(run.end - run.start));
        let old = if n_changed > length(new) {
            self.changes.fill(0);
            &[][..]
        } else {
            old
        };
        differences(old, new, |run, by| {
            for j in run.start..run.end {
                for seen in graph.row(j) {
                    self.changes[seen.start as usize] += by;
                    self.changes[seen.end as usize] -= by;
                }
            }
        });
    }

    /// Sum over the points that the point sees of how many of them see it; and how many points any of them see.
    fn counts(&self) -> [u64; 2] {
        let (mut n_both, mut n_union, mut n_see) = (0, 0, 0i32);
        let mut sum = |points: std::ops::Range<usize>, is_own: bool| {
            let (mut n, mut total) = (0u32, 0);
            for change in &self.changes[points] {
                n_see += change;
                n += u32::from(n_see > 0);
                total += n_see as u64;
            }
            n_union += u64::from(n);
            n_both += if is_own { total } else { 0 };
        };
        let mut from = 0;
        for run in self.at.map_or(&[][..], |at| self.graph.row(at)) {
            let [start, end] = [run.start, run.end].map(|p| p as usize);
            sum(from..start, false);
            sum(start..end, true);
            from = end;
        }
        sum(from..self.changes.len(), false);
        [n_both, n_union]
    }
}

/// What is in one of two lists of runs and not in the other: -1 for the old one, 1 for the new one. Ascending.
fn differences(old: &[Run], new: &[Run], mut each: impl FnMut(Run, i32)) {
    let ends = |runs: &[Run], k: usize| {
        runs.get(k / 2).map_or(u32::MAX, |run| if k.is_multiple_of(2) { run.start } else { run.end })
    };
    // How many ends of each are passed: inside a run after an odd number.
    let (mut a, mut b) = (0, 0);
    let mut from = 0;
    loop {
        let to = ends(old, a).min(ends(new, b));
        if a % 2 != b % 2 && from < to {
            each(Run { start: from, end: to }, if a % 2 == 1 { -1 } else { 1 });
        }
        if a == 2 * old.len() && b == 2 * new.len() {
            return;
        }
        from = to;
        while a < 2 * old.len() && ends(old, a) == to {
            a += 1;
        }
        while b < 2 * new.len() && ends(new, b) == to {
            b += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_what_one_list_has() {
        let runs = |ends: &[[u32; 2]]| ends.iter().map(|&[start, end]| Run { start, end }).collect::<Vec<_>>();
        let of = |old: &[[u32; 2]], new: &[[u32; 2]]| {
            let mut all = Vec::new();
            differences(&runs(old), &runs(new), |run, by| all.push((run.start, run.end, by)));
            all
        };
        assert_eq!(of(&[], &[]), []);
        assert_eq!(of(&[[2, 5]], &[]), [(2, 5, -1)]);
        assert_eq!(of(&[[2, 5], [5, 6]], &[[3, 4]]), [(2, 3, -1), (4, 5, -1), (5, 6, -1)]);
        assert_eq!(of(&[[0, 3], [4, 9]], &[[0, 4], [6, 12]]), [(3, 4, 1), (4, 6, -1), (9, 12, 1)]);
        assert_eq!(of(&[[0, 3]], &[[3, 5]]), [(0, 3, -1), (3, 5, 1)]);
        assert_eq!(of(&[[1, 9]], &[[1, 9]]), []);
    }
}

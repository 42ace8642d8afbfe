//! Local measures: what a point's neighbourhood in the graph is like.

use crate::{Effort, Points, UNDEFINED, VisibilityGraph};
use sightlines_progress::Cancelled;

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

/// What one point has, in the order of the fields.
type Row = (u32, [f64; 5]);

impl LocalMeasures {
    /// Computes the local measures.
    ///
    /// # Errors
    /// [`Cancelled`]
    ///
    /// # Panics
    /// If the points are not as many as those of the graph.
    ///
    /// # Cost
    /// For each point O(points + runs of all points that it sees), on all threads.
    pub fn of(graph: &VisibilityGraph, points: &Points, effort: &Effort<'_>) -> Result<Self, Cancelled> {
        let n = graph.n_points();
        assert_eq!(n, points.len(), "one row for each point");
        let degrees: Vec<u32> = (0..n as u32).map(|p| graph.n_seen(p)).collect();
        let row = |changes: &mut Vec<i32>, point: usize| one(graph, points, &degrees, point as u32, changes);
        let rows = effort.each("local measures", n, || vec![0i32; n + 1], row)?;
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

/// * `changes`: zeros, and again afterwards
fn one(graph: &VisibilityGraph, points: &Points, degrees: &[u32], point: u32, changes: &mut [i32]) -> Row {
    let k = degrees[point as usize];
    let (mut first, mut second, mut control) = (0.0, 0.0, 0.0);
    // How many of N(i) see a point, as the changes of that number from a point to the next.
    for j in graph.seen(point) {
        let [x, y] = points.offset(point, j);
        let square = x * x + y * y;
        first += square.sqrt();
        second += square;
        control += 1.0 / f64::from(degrees[j as usize]);
        for run in graph.row(j) {
            changes[run.start as usize] += 1;
            changes[run.end as usize] -= 1;
        }
    }
    let (mut n_both, mut n_union) = (0u64, 0u32);
    let mut n_see = 0i32;
    let mut own = graph.row(point).iter();
    let mut run = own.next();
    for (m, change) in changes.iter_mut().enumerate() {
        n_see += std::mem::take(change);
        n_union += u32::from(n_see > 0);
        if run.is_some_and(|run| run.end as usize <= m) {
            run = own.next();
        }
        if run.is_some_and(|run| run.start as usize <= m) {
            n_both += n_see as u64;
        }
    }
    let unit = points.unit();
    let pairs = f64::from(k) * (f64::from(k) - 1.0);
    let [clustering, control, controllability] =
        if k > 1 { [n_both as f64 / pairs, control, f64::from(k) / f64::from(n_union)] } else { [UNDEFINED; 3] };
    (k, [first * unit, second * (unit * unit), clustering, control, controllability])
}

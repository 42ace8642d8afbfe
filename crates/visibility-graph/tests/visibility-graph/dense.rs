//! Oracles: everything in whole numbers and full matrices.

use proptest::prelude::*;
use sightlines_cells::Plan;
use sightlines_geometry::Point2;
use sightlines_visibility_graph::{GraphError, VisibilityGraph, WorkOptions};

pub(crate) type At = [i64; 2];

/// A plan on whole numbers.
#[derive(Debug, Clone)]
pub(crate) struct Walls(pub(crate) Vec<[At; 2]>);

pub(crate) fn point([x, y]: At) -> Point2 {
    Point2::new(x as f64, y as f64)
}

impl Walls {
    pub(crate) fn plan(&self) -> Plan {
        Plan::from_walls(self.0.iter().map(|&[a, b]| (point(a), point(b)))).expect("walls have a length")
    }

    /// Whether a wall and the segment have a point in common.
    pub(crate) fn meet(&self, s: [At; 2]) -> bool {
        self.0.iter().any(|&wall| meet(wall, s))
    }
}

fn side([a, b]: [At; 2], p: At) -> i64 {
    ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])).signum()
}

/// Whether closed segments meet: their boxes do, and neither lies strictly on one side of the other's line. Holds for points, too.
pub(crate) fn meet(s: [At; 2], t: [At; 2]) -> bool {
    let boxes =
        (0..2).all(|k| s[0][k].min(s[1][k]) <= t[0][k].max(t[1][k]) && t[0][k].min(t[1][k]) <= s[0][k].max(s[1][k]));
    boxes && side(s, t[0]) * side(s, t[1]) <= 0 && side(t, s[0]) * side(t, s[1]) <= 0
}

/// Random walls on multiples of `step` from 0 to `side`, mostly along axes, with a box around them.
pub(crate) fn walls(side: i64, step: i64, n: std::ops::Range<usize>) -> impl Strategy<Value = Walls> {
    let most = side / step;
    let any = (0..=most, 0..=most, 0..=most, 0..=most, 0..4u32).prop_map(move |(ax, ay, bx, by, kind)| {
        let [a, b] = match kind {
            0 => [[ax, ay], [bx, by]],
            1 => [[ax, ay], [ax, by]],
            _ => [[ax, ay], [bx, ay]],
        };
        [a, b].map(|p| p.map(|x| x * step))
    });
    let wall = any.prop_filter("of some length", |[a, b]| a != b);
    prop::collection::vec(wall, n).prop_map(move |inner| {
        let corners = [[0, 0], [side, 0], [side, side], [0, side]];
        let around = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]);
        Walls(inner.into_iter().chain(around).collect())
    })
}

/// Who sees whom.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Matrix(pub(crate) Vec<Vec<bool>>);

impl Matrix {
    pub(crate) fn of(walls: &Walls, points: &[At]) -> Self {
        let n = points.len();
        Self((0..n).map(|i| (0..n).map(|j| i != j && !walls.meet([points[i], points[j]])).collect()).collect())
    }

    pub(crate) fn n(&self) -> usize {
        self.0.len()
    }

    pub(crate) fn graph(&self, effort: &WorkOptions<'_>) -> Result<VisibilityGraph, GraphError> {
        let seen =
            |i: u32, list: &mut Vec<u32>| list.extend((0..self.n() as u32).filter(|&j| self.0[i as usize][j as usize]));
        VisibilityGraph::build(self.n() as u32, seen, effort)
    }

    /// Connectivity, clustering, control and controllability of a point by their definitions.
    pub(crate) fn local(&self, i: usize) -> [f64; 4] {
        let n = self.n();
        let sees = |a: usize, b: usize| self.0[a][b];
        let own: Vec<usize> = (0..n).filter(|&j| sees(i, j)).collect();
        let k = own.len() as f64;
        if own.len() < 2 {
            return [k, -1.0, -1.0, -1.0];
        }
        let pairs = own.iter().flat_map(|&j| own.iter().map(move |&m| (j, m))).filter(|&(j, m)| sees(j, m)).count();
        let control: f64 = own.iter().map(|&j| 1.0 / (0..n).filter(|&m| sees(j, m)).count() as f64).sum();
        let union = (0..n).filter(|&m| own.iter().any(|&j| sees(j, m))).count();
        [k, pairs as f64 / (k * (k - 1.0)), control, k / union as f64]
    }

    /// Least numbers of steps between all points, by Floyd and Warshall.
    pub(crate) fn depths(&self) -> Vec<Vec<f64>> {
        let cost = |i: usize, j: usize| if self.0[i][j] { 1.0 } else { f64::INFINITY };
        floyd(self.n(), cost, |_| true)
    }

    /// Least lengths of paths that turn at some of the points.
    pub(crate) fn lengths(&self, points: &[At], turns_at: impl Fn(usize) -> bool) -> Vec<Vec<f64>> {
        let cost = |i: usize, j: usize| if self.0[i][j] { distance(points[i], points[j]) } else { f64::INFINITY };
        floyd(self.n(), cost, turns_at)
    }
}

pub(crate) fn distance(a: At, b: At) -> f64 {
    (((a[0] - b[0]).pow(2) + (a[1] - b[1]).pow(2)) as f64).sqrt()
}

/// Shortest paths between all points with only some of them between their ends.
fn floyd(n: usize, cost: impl Fn(usize, usize) -> f64, through: impl Fn(usize) -> bool) -> Vec<Vec<f64>> {
    let mut d: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| if i == j { 0.0 } else { cost(i, j) }).collect()).collect();
    for k in (0..n).filter(|&k| through(k)) {
        for i in 0..n {
            for j in 0..n {
                d[i][j] = d[i][j].min(d[i][k] + d[k][j]);
            }
        }
    }
    d
}

/// Node count, mean depth, integrations (HH, Tekl, P-value), entropy, relativised entropy from a row of depths, by the library's functions.
pub(crate) fn global(depths: &[f64], radius: Option<u32>) -> [f64; 7] {
    let most = radius.map_or(f64::INFINITY, f64::from);
    let reached: Vec<f64> = depths.iter().copied().filter(|&d| d.is_finite() && d <= most).collect();
    let (n, total) = (reached.len() as f64, reached.iter().sum::<f64>());
    let mut all = [n, -1.0, -1.0, -1.0, -1.0, -1.0, -1.0];
    if n > 1.0 {
        let mean = total / (n - 1.0);
        all[1] = mean;
        if n > 2.0 && mean > 1.0 {
            let ra = 2.0 * (mean - 1.0) / (n - 2.0);
            let pairs = (n - 1.0) * (n - 2.0);
            all[2] = 1.0 / (ra / (2.0 * (n * (((n + 2.0) / 3.0).log2() - 1.0) + 1.0) / pairs));
            if total - n + 1.0 > 1.0 {
                all[3] = (0.5 * (n - 2.0)).ln() / (total - n + 1.0).ln();
            }
            all[4] = 1.0 / (ra / (2.0 * (n - n.log2() - 1.0) / pairs));
        }
        (all[5], all[6]) = (0.0, 0.0);
        let mut factorial = 1.0;
        for k in 1..=reached.iter().copied().fold(0.0, f64::max) as i32 {
            factorial *= f64::from(k + 1);
            let p = reached.iter().filter(|&&d| d == f64::from(k)).count() as f64 / (n - 1.0);
            if p > 0.0 {
                all[5] -= p * p.log2();
                all[6] += p * (p / (mean.powi(k) / factorial * (-mean).exp())).log2();
            }
        }
    }
    all
}

/// Whether numbers are alike but for rounding.
pub(crate) fn is_near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0)
}

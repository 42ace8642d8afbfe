//! The edges of portals as rows over the parameters of a chart.
//!
//! For a line from `q` to `r` an edge from `e` to `f` is on its inner side if
//! `(f - e) · ((q - e) × (r - e))` is positive. With `q` and `r` linear in two coordinates each, this has
//! nine coefficients: of 1, u, v, s, t, us, ut, vs and vt.

use super::chart::Chart;
use super::vector::{cross, dot, scale, sub};
use sightlines_geometry::{Point3, Portal3};

/// An edge of a sequence.
#[derive(Debug, Clone, Copy)]
pub(super) struct Edge {
    pub(super) portal: usize,
    pub(super) edge: usize,
    pub(super) from: Point3,
    pub(super) to: Point3,
    /// What its row is multiplied by, so that its values are distances in units of the chart.
    pub(super) scale: f64,
    /// Coefficients over the chart's coordinates.
    pub(super) row: [f64; 9],
}

/// Coefficients of 1, u, v, s, t, us, ut, vs, vt on a box of coordinates, in coordinates of that box.
pub(super) fn on_box(c: &[f64; 9], low: &[f64; 4], high: &[f64; 4]) -> [f64; 9] {
    let [u, v, s, t] = *low;
    let [du, dv, ds, dt] = [0, 1, 2, 3].map(|i| high[i] - low[i]);
    let (cu, cv) = (c[1] + c[5] * s + c[6] * t, c[2] + c[7] * s + c[8] * t);
    let (cs, ct) = (c[3] + c[5] * u + c[7] * v, c[4] + c[6] * u + c[8] * v);
    let c0 = c[0] + cu * u + cv * v + c[3] * s + c[4] * t;
    [c0, cu * du, cv * dv, cs * ds, ct * dt, c[5] * du * ds, c[6] * du * dt, c[7] * dv * ds, c[8] * dv * dt]
}

/// Bounds of a row on the unit box: products are between 0 and 1 like their factors.
pub(super) fn range(c: &[f64; 9]) -> [f64; 2] {
    c[1..].iter().fold([c[0]; 2], |[low, high], x| [low + x.min(0.0), high + x.max(0.0)])
}

/// The edges that some line of the chart has on its outer side; the others cannot matter. A relative `1e-9` of their
/// size is left for rounding.
pub(super) fn edges(portals: &[&Portal3], chart: &Chart, into: &mut Vec<Edge>) {
    into.clear();
    let middle = |i: usize| {
        let block = &chart.blocks[i];
        ([0, 1, 2].map(|k| block.corner[k] + 0.5 * block.edges[2][k]), block.edges[0], block.edges[1])
    };
    let ((q, qu, qv), (r, rs, rt)) = (middle(0), middle(1));
    for (portal, polygon) in portals.iter().enumerate() {
        for (edge, [from, to]) in polygon.edges().enumerate() {
            let along = sub(to, from);
            let factor = 1.0 / (dot(along, along).sqrt() * chart.distance * chart.unit);
            let d = scale(along, factor);
            let q = sub(q, from);
            let (gr, gs, gt) = (cross(sub(r, from), d), cross(rs, d), cross(rt, d));
            let row = [
                dot(q, gr),
                dot(qu, gr),
                dot(qv, gr),
                dot(q, gs),
                dot(q, gt),
                dot(qu, gs),
                dot(qu, gt),
                dot(qv, gs),
                dot(qv, gt),
            ];
            let [low, high] = range(&row);
            if low <= 1e-9 * (high - low) {
                into.push(Edge { portal, edge, from, to, scale: factor, row });
            }
        }
    }
}

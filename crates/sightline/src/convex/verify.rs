//! Whether a weighted sum of rows is negative for a whole box of lines: in doubles, with a bound on their error.
//!
//! # The bound
//! A term is `λ det(d, Q, R)` with an edge `d = f - e` and `Q = q - e`, `R = r - e` for the corners `q`, `r`
//! of both blocks' middles. Let `|x|` be the sum of magnitudes, so that `|det(d, Q, R)| <= |d||Q||R|`, and ε
//! be 2^-53.
//!
//! * Each component of the three differences is right up to a factor 1 ± ε, each triple product has
//!   five more roundings: less than `10 ε |d||Q||R|`.
//! * Adding up `n` terms: less than `(n + 1) ε` times the sum of all `λ |d||Q||R|`.
//! * `q` is the middle of the block's thickness, computed: the true corners are within
//!   `D_q = |edges[2]| / 2 + 16 ε (|corner| + |edges|)` of it, since each component has three products and
//!   three additions. So are the `r`. That changes a determinant by at most
//!   `|d| (D_q |R| + D_r |Q| + D_q D_r)`.
//!
//! The total is doubled to cover the rounding of the bound itself.

use super::certificate::{Block, ConvexTerm};
use super::chart::Chart;
use super::rows::Edge;
use super::vector::{along, cross, dot, size, sub};
use sightlines_geometry::Point3;

/// Corners of the middle of a block's part, and a bound on their distance from the true ones.
fn corners(block: &Block, low: &[f64], high: &[f64]) -> ([Point3; 4], f64) {
    let base = along(block.corner, block.edges[2], 0.5);
    let place = |x: f64, y: f64| along(along(base, block.edges[0], x), block.edges[1], y);
    let magnitude = size(block.corner) + block.edges.iter().map(|e| size(*e)).sum::<f64>();
    let off = 0.5 * size(block.edges[2]) + 8.0 * f64::EPSILON * magnitude;
    ([place(low[0], low[1]), place(low[0], high[1]), place(high[0], low[1]), place(high[0], high[1])], off)
}

/// Whether the sum is negative for every line with coordinates from `low` to `high`. Rigorous; `false` where doubles
/// cannot decide.
pub(super) fn refutes<'a>(
    chart: &Chart,
    [low, high]: [&[f64; 4]; 2],
    terms: impl ExactSizeIterator<Item = (&'a Edge, f64)>,
) -> bool {
    let (qs, q_off) = corners(&chart.blocks[0], &low[..2], &high[..2]);
    let (rs, r_off) = corners(&chart.blocks[1], &low[2..], &high[2..]);
    let rounding = (terms.len() as f64 + 16.0) * f64::EPSILON;
    let mut sums = [0.0; 16];
    for (edge, multiplier) in terms {
        let d = sub(edge.to, edge.from);
        let reach = multiplier * size(d);
        for (i, q) in qs.iter().enumerate() {
            let q = sub(*q, edge.from);
            let q_size = size(q);
            for (j, r) in rs.iter().enumerate() {
                let r = sub(*r, edge.from);
                let r_size = size(r);
                let wrong = rounding * q_size * r_size + q_off * r_size + r_off * q_size + q_off * r_off;
                sums[4 * i + j] += multiplier * dot(d, cross(q, r)) + 2.0 * reach * wrong;
            }
        }
    }
    rounding < 1e-6 && sums.iter().all(|sum| *sum < 0.0)
}

/// The sum as a certificate names it.
pub(super) fn named<'a>(terms: impl Iterator<Item = (&'a Edge, f64)>) -> Vec<ConvexTerm> {
    terms.map(|(edge, multiplier)| ConvexTerm { portal: edge.portal, edge: edge.edge, multiplier }).collect()
}

//! Openings between cells: what faces leave of the walls that two cells share.
//!
//! Two cells are separated by the plane of exactly one node, the lowest above both. So each node handles its own plane:
//! the part of its cross-section that faces leave open is passed down to pairs of subtrees, one below and one above,
//! until both are cells.

use crate::face::across;
use crate::ranks::{RankBox, Ranks};
use crate::region::{Rect, unite};
use crate::skeleton::{RankNode, Skeleton};
use crate::tree::AxialPortal;
use sightlines_pvs::CellId;

/// A portal in ranks.
type RankPortal<const D: usize> = ([CellId; 2], usize, RankBox<D>);

/// All portals of a tree, in the order of [`AxialTree::portals`](crate::AxialTree::portals).
///
/// Visits only pairs of nodes with an opening between them: at most the depth of the tree times the
/// number of portals, in balanced trees in proportion to the number of portals.
pub(crate) fn portals_of<const D: usize>(ranks: &Ranks<D>, skeleton: &Skeleton<D>) -> Vec<AxialPortal<D>> {
    let mut found = Vec::new();
    for (low, node) in (1u32..).zip(&skeleton.nodes) {
        if let RankNode::Inner { axis, rank, high, open } = node {
            join::<D>(&skeleton.nodes, (*axis, *rank), Pair { low, high: *high, open: open.clone() }, &mut found);
        }
    }
    found.sort_unstable_by_key(|(cells, _, extent)| (*cells, extent.lo));
    let in_scene = |(cells, axis, extent): RankPortal<D>| {
        let (min, max) = (ranks.corner(extent.lo), ranks.corner(extent.hi));
        AxialPortal { cells, axis, at: min[axis], min, max }
    };
    found.into_iter().map(in_scene).collect()
}

/// A subtree below a plane, one above it, and what is open between the two.
struct Pair {
    low: u32,
    high: u32,
    open: Vec<Rect>,
}

/// Finds the portals between the cells of two subtrees on a plane, given as axis and rank.
fn join<const D: usize>(nodes: &[RankNode], plane: (usize, u32), root: Pair, found: &mut Vec<RankPortal<D>>) {
    let mut stack = vec![root];
    while let Some(pair) = stack.pop() {
        if pair.open.is_empty() {
            continue;
        }
        match (&nodes[pair.low as usize], &nodes[pair.high as usize]) {
            (RankNode::Leaf(a), RankNode::Leaf(b)) => {
                let pieces = unite(&pair.open).into_iter();
                found.extend(pieces.map(|r| ([*a, *b], plane.0, r.on_plane(plane.0, plane.1))));
            }
            // Of a node that is cut by a parallel plane, only the child next to the opening matters.
            (&RankNode::Inner { axis, high, .. }, _) if axis == plane.0 => stack.push(Pair { low: high, ..pair }),
            (_, &RankNode::Inner { axis, .. }) if axis == plane.0 => stack.push(Pair { high: pair.high + 1, ..pair }),
            (&RankNode::Inner { axis, rank, high, .. }, _) => {
                let [below, above] = halves::<D>(pair.open, plane.0, axis, rank);
                stack.push(Pair { low: pair.low + 1, high: pair.high, open: below });
                stack.push(Pair { low: high, high: pair.high, open: above });
            }
            (_, &RankNode::Inner { axis, rank, high, .. }) => {
                let [below, above] = halves::<D>(pair.open, plane.0, axis, rank);
                stack.push(Pair { low: pair.low, high: pair.high + 1, open: below });
                stack.push(Pair { low: pair.low, high, open: above });
            }
        }
    }
}

/// The parts below and above `rank` on `axis` of rectangles on a plane perpendicular to `normal`.
fn halves<const D: usize>(mut open: Vec<Rect>, normal: usize, axis: usize, rank: u32) -> [Vec<Rect>; 2] {
    let along_u = across::<D>(normal).next() == Some(axis);
    let mut below = Vec::new();
    open.retain_mut(|rect| {
        let mut part = *rect;
        let (lower, upper) = if along_u { (&mut part.u, &mut rect.u) } else { (&mut part.v, &mut rect.v) };
        lower[1] = lower[1].min(rank);
        upper[0] = upper[0].max(rank);
        let (is_below, is_above) = (lower[0] < lower[1], upper[0] < upper[1]);
        if is_below {
            below.push(part);
        }
        is_above
    });
    [below, open]
}

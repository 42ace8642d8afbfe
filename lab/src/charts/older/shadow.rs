//! Portals seen through pairs of portals: shadow volumes without clipping.
//!
//! Light falls through a source portal and a second one; of what lies behind, only the volume between the planes that
//! separate the two is lit. A portal outside of it is not reached. Each portal is tested against the source and the
//! portal that the light came through, and no light is ever clipped, so that a pair of source and portal is gone
//! through once: the cost is polynomial, and what is hidden by three portals together, or by two that do not follow
//! each other, is not found. Source: after Airey, Rohlf and Brooks, I3D 1990; passing each pair once is our own choice.

use super::{Opening, PortalGraph};
use sightlines::pvs::BitMatrix;
use sightlines_benches::measure::{CpuClock, Work};
use std::time::Duration;

/// Which cells are seen from which, cells by cells. Errs towards visible: barriers are decided exactly, so in the plane
/// and between axis-aligned doors nothing visible is left out; where the corners of polygons are off their planes by
/// rounding, planes through three corners are too. The two cells of a pair are tested separately, and may disagree.
/// `None` if the process works longer than `limit` on it.
///
/// O(exits² · edges³) at worst.
pub fn shadow_volumes<O: Opening>(graph: &PortalGraph<O>, limit: Duration) -> Option<BitMatrix> {
    let start = CpuClock::start(Work::Process);
    let n = graph.n_cells();
    let mut seen = BitMatrix::identity(n);
    let mut is_lit = vec![u32::MAX; graph.edges.len()];
    let mut barriers = Vec::new();
    let mut next: Vec<usize> = Vec::new();
    let mut source_number = 0;
    for cell in 0..n {
        for source in graph.places_of(cell) {
            if start.is_over(limit) {
                return None;
            }
            let from = &graph.edges[source].opening;
            let front = from.front();
            next.push(source);
            while let Some(place) = next.pop() {
                let via = &graph.edges[place];
                seen.set(cell, via.to, true);
                barriers.clear();
                if place != source {
                    from.barriers(&via.opening, &mut barriers);
                }
                for k in graph.places_of(via.to) {
                    let edge = &graph.edges[k];
                    if is_lit[k] != source_number
                        && edge.side != via.entry_side
                        && !edge.opening.is_behind(&front)
                        && !barriers.iter().any(|barrier| edge.opening.is_behind(barrier))
                    {
                        is_lit[k] = source_number;
                        next.push(k);
                    }
                }
            }
            source_number += 1;
        }
    }
    Some(seen)
}

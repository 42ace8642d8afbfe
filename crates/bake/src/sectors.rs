//! Which groups of a plan see each other: the flat model of sectors.

use crate::error::BakeError;
use sightlines_cells::Plan;
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::{SearchOptions, Zones, planar_visibility};
use sightlines_triangulation::{SubdivisionSummary, TriangulationError, subdivide};

/// Which groups see each other, groups by groups: symmetric, with the diagonal set, for groups below
/// `n_groups`; and what the subdivision did.
///
/// Group A sees group B if an open set of segments, blocked by no closed opaque line, leads from a
/// region of A into a region of B. A region is a face of the arrangement of all lines; it belongs to
/// every group that a line names on a side facing it. Groups that no line names see only themselves.
///
/// Exact, but for rounded crossings (see the triangulation's notes on noding), which err towards
/// visible. Cost: as [`sightlines_stabtree::visible_zones`].
///
/// # Errors
/// [`BakeError`] for a plan without lines.
pub fn see_groups(
    plan: &Plan,
    n_groups: u32,
    options: &SearchOptions<'_>,
) -> Result<(BitMatrix, SubdivisionSummary), BakeError> {
    let n = n_groups.max(plan.n_groups()) as usize;
    let mut seen = BitMatrix::identity(n);
    let (graph, summary) = match subdivide(plan) {
        Ok(cut) => cut,
        // Without groups, collinear lines enclose no region, so nothing is visible.
        Err(TriangulationError::Flat) => return Ok((seen, SubdivisionSummary::default())),
        Err(error) => return Err(error.into()),
    };
    let (zones, groups) = Zones::by_groups(&graph);
    let (visible, _) = planar_visibility(&graph, &zones, options)?;
    for (zone, own) in groups.iter().enumerate() {
        for other in visible.iter_ones(zone) {
            for &a in own {
                for &b in &groups[other] {
                    seen.set(a as usize, b as usize, true);
                }
            }
        }
    }
    Ok((seen, summary))
}

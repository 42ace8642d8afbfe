#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the way from a [`Plan`] to a [`CellGraph`] by triangulation.
//! - **Out of scope**: sight lines, tables, files, the k-d tree.
//! - **Invariants**: every piece of an opaque line that was not given up lies on cell boundaries and under no
//!   portal; every other cell side towards a neighbour is a portal; no wall is invented.
//!
//! The lines of a plan are cut where they meet ([`noding`]), a constrained Delaunay triangulation (the
//! `spade` crate) fills the plane between them, the groups that lines name are spread over the regions
//! they bound (`regions`), and triangles are merged into convex cells (`merge`).
//!
//! # On which side it errs
//! All end points are input points and all predicates are exact, so plans whose lines meet only in
//! common end points or touch with an end point are cut exactly. A proper crossing needs a new point; [`noding`]
//! explains how it is rounded and why no open set of sight lines is lost.

mod crossing;
mod grid;
mod joined;
mod merge;
mod mesh;
pub mod noding;
mod piece;
mod regions;

use sightlines_cells::{CellGraph, Plan, Planar};
use sightlines_geometry::Point2;

/// Why a plan could not be cut.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TriangulationError {
    /// The plan has no lines.
    #[error("the plan has no lines")]
    Empty,
    /// All end points are on one straight line, so there is no region to cut.
    #[error("all lines of the plan lie on one straight line")]
    Flat,
    /// The lines meet in more places than are cut.
    #[error("the lines of the plan meet in more than {limit} places")]
    TooManyMeetings {
        /// The limit.
        limit: usize,
    },
    /// The triangulation rejected a vertex.
    #[error("vertex ({x}, {y}) cannot be triangulated")]
    Vertex {
        /// Its coordinate.
        x: f64,
        /// Its coordinate.
        y: f64,
    },
}

/// Statistics of a subdivision.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SubdivisionSummary {
    /// Triangles before merging.
    pub n_triangles: usize,
    /// Points where lines cross that are no line's end point and could not be represented exactly.
    pub n_rounded_crossings: usize,
    /// Pieces of opaque lines that do not block because rounding could have closed a gap with them.
    pub n_dropped_pieces: usize,
    /// Cells in regions whose lines disagree about the group.
    pub n_disputed_cells: usize,
}

/// Cuts the convex hull of `plan` into convex cells.
///
/// Cells of one region share the groups that the lines around the region name. If any line of the
/// plan names a group, the outside of the hull is cut too, as far as a frame around the plan, because a
/// line may name a group there; and cells from which no line of sight leads into a region with a group
/// are left out (the void around a Doom map). Cell ids follow the triangulation and are the same on every
/// machine.
///
/// Cost: O(n log n) for n lines with few crossings.
///
/// # Errors
/// [`TriangulationError::Empty`] and [`TriangulationError::Flat`] for plans without a region,
/// [`TriangulationError::TooManyMeetings`] for lines that cross too often.
///
/// # Source
/// Chew, "Constrained Delaunay triangulations", Algorithmica 4, 1989, by way of `spade`; Hertel and
/// Mehlhorn, "Fast triangulation of simple polygons", FCT 1983, for the merging, which leaves at most
/// four times the least number of convex pieces.
pub fn subdivide(plan: &Plan) -> Result<(CellGraph<Planar>, SubdivisionSummary), TriangulationError> {
    if plan.lines().is_empty() {
        return Err(TriangulationError::Empty);
    }
    let noded = noding::node(plan)?;
    let frame = if plan.n_groups() > 0 { corners_around(plan) } else { Vec::new() };
    let mesh = mesh::triangulate(plan, &noded, &frame)?;
    let regions = regions::label(&mesh, &noded.everywhere);
    let graph = merge::convex_cells(&mesh, &regions, plan.n_groups() > 0);
    let n_disputed_cells = graph.cells().iter().filter(|c| c.groups.len() > 1).count();
    let summary = SubdivisionSummary {
        n_triangles: mesh.n_triangles(),
        n_rounded_crossings: noded.n_rounded_crossings,
        n_dropped_pieces: noded.n_dropped_pieces,
        n_disputed_cells,
    };
    Ok((graph, summary))
}

/// Corners of a box that is strictly larger than the plan on all sides, by the plan's own size, so that
/// they are on the grid if the plan is.
fn corners_around(plan: &Plan) -> Vec<Point2> {
    let bounds = plan.bounds();
    let size = (bounds.max[0] - bounds.min[0]).max(bounds.max[1] - bounds.min[1]);
    // The triangulation accepts coordinates up to twice the limit of a plan.
    let limit = 2.0 * sightlines_geometry::coordinate::MAX_MAGNITUDE;
    let [x, y] = [0, 1].map(|k| [(bounds.min[k] - size).max(-limit), (bounds.max[k] + size).min(limit)]);
    x.into_iter().flat_map(|x| y.map(|y| Point2::new(x, y))).collect()
}

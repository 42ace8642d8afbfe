//! Approximations that came before exact cell-to-cell visibility, written plainly to be measured against.
//!
//! | | method | errs |
//! | --- | --- | --- |
//! | [`connected`] | what frustum culling yields for a cell: every reachable cell | towards visible |
//! | [`shadow_volumes`] | portals seen through pairs of portals | towards visible |
//! | [`sampled`] | random rays | towards hidden: it misses what no ray happens to meet |
//! | [`BoxTreeN`] | boxes in a quadtree or octree against one view volume, from an eye | towards visible |
//!
//! All work on [`PortalGraph`]: cells and the openings between them, in the plane and in space alike.

mod octree;
mod opening;
mod sampling;
mod shadow;

pub use octree::{BoxTreeN, connected};
pub use opening::{Gap, Opening, Polygon, Ray};
pub use sampling::sampled;
pub use shadow::shadow_volumes;

use sightlines::cells::{Axial, CellGraph, Convex, Exit, Planar, Space};
use sightlines::geometry::{AxialDoor, Portal3};

/// A portal as an edge: one way out of a cell.
#[derive(Debug, Clone)]
pub struct PortalEdge<O> {
    /// The opening, as who leaves sees it.
    pub opening: O,
    /// The cell entered.
    pub to: usize,
    /// The side left by, of the cell left.
    pub side: u32,
    /// The side entered by, of the cell entered.
    pub entry_side: u32,
}

/// Cells, and the portals out of each.
#[derive(Debug, Clone)]
pub struct PortalGraph<O> {
    edges: Vec<PortalEdge<O>>,
    /// Edges out of cell `c` are `edges[first[c]..first[c + 1]]`.
    first: Vec<usize>,
    /// By how much rays keep clear of edges, in scene units.
    clearance: f64,
}

impl<O: Opening> PortalGraph<O> {
    fn new<S: Space>(graph: &CellGraph<S>, opening: impl Fn(&Exit) -> O) -> Self {
        let edge = |exit: &Exit| PortalEdge {
            opening: opening(exit),
            to: exit.to.idx(),
            side: exit.side,
            entry_side: exit.entry_side,
        };
        let edges: Vec<PortalEdge<O>> = graph.all_exits().iter().map(edge).collect();
        let mut first = vec![0];
        first.extend(graph.cell_ids().map(|cell| graph.exit_range(cell).end));
        let corners = || edges.iter().flat_map(|w| w.opening.corners());
        let size = (0..3)
            .map(|k| corners().map(|p| p[k]).fold([f64::MAX, f64::MIN], |[l, h], x| [l.min(x), h.max(x)]))
            .map(|[low, high]| high - low)
            .fold(0.0, f64::max);
        let magnitude = corners().flatten().fold(size, |m: f64, x| m.max(x.abs()));
        // A million times what doubles lose at this magnitude.
        Self { edges, first, clearance: magnitude / f64::from(1u32 << 20) / 16.0 }
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.first.len() - 1
    }

    /// The edges out of a cell.
    pub fn out_of(&self, cell: usize) -> &[PortalEdge<O>] {
        &self.edges[self.places_of(cell)]
    }

    fn places_of(&self, cell: usize) -> std::ops::Range<usize> {
        self.first[cell]..self.first[cell + 1]
    }
}

/// Cells of the plane.
pub fn planar_portal_graph(graph: &CellGraph<Planar>) -> PortalGraph<Gap> {
    PortalGraph::new(graph, |exit| Gap(graph.crossing(exit)))
}

/// Boxes in space.
pub fn axial_portal_graph(graph: &CellGraph<Axial>) -> PortalGraph<Polygon> {
    PortalGraph::new(graph, |exit| Polygon::new(corners_of(&graph.door(exit))))
}

/// Convex cells in space.
pub fn convex_portal_graph(graph: &CellGraph<Convex>) -> PortalGraph<Polygon> {
    PortalGraph::new(graph, |exit| {
        let shape: &Portal3 = &graph.portal(exit.portal).shape;
        Polygon::new(if exit.forward { shape.corners().to_vec() } else { shape.reversed().corners().to_vec() })
    })
}

/// The corners of a door, counter-clockwise about the direction of crossing.
fn corners_of(door: &AxialDoor) -> Vec<[f64; 3]> {
    let [min, max] = [door.extent.min, door.extent.max];
    let axis = usize::from(door.axis);
    let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
    let corner = |high_b: bool, high_c: bool| {
        let mut p = min;
        p[b] = if high_b { max[b] } else { min[b] };
        p[c] = if high_c { max[c] } else { min[c] };
        p
    };
    // From b towards c the right-hand rule gives the axis.
    let mut corners = vec![corner(false, false), corner(true, false), corner(true, true), corner(false, true)];
    if !door.forward {
        corners.reverse();
    }
    corners
}

#[cfg(test)]
mod tests;

//! The cells and portals that a table was made from.

use sightlines_cells::{Axial, CellGraph, Convex, Planar};
use sightlines_geometry::Aabb;
use sightlines_pvs::{Table, TableKind};

/// The cells and portals that a table was made from, of whichever kind.
#[derive(Debug, Clone, PartialEq)]
pub enum TableGraph {
    /// Convex polygons of a plan.
    Planar(CellGraph<Planar>),
    /// The boxes of a k-d tree in space.
    Axial(CellGraph<Axial>),
    /// The clusters of a Quake map.
    Convex(CellGraph<Convex>),
    /// View cells that were given: boxes without portals, which may overlap and leave gaps.
    Boxes(Vec<Aabb<3>>),
}

impl TableGraph {
    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        GraphRef::from(self).n_cells()
    }

    /// Number of portals; 0 for given boxes.
    pub fn n_portals(&self) -> usize {
        GraphRef::from(self).n_portals()
    }
}

impl From<CellGraph<Planar>> for TableGraph {
    fn from(graph: CellGraph<Planar>) -> Self {
        Self::Planar(graph)
    }
}

impl From<CellGraph<Axial>> for TableGraph {
    fn from(graph: CellGraph<Axial>) -> Self {
        Self::Axial(graph)
    }
}

impl From<CellGraph<Convex>> for TableGraph {
    fn from(graph: CellGraph<Convex>) -> Self {
        Self::Convex(graph)
    }
}

/// The kinds of [`TableGraph`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum GraphKind {
    /// Convex polygons of a plan.
    Planar,
    /// The boxes of a k-d tree in space.
    Axial,
    /// The clusters of a Quake map.
    Convex,
    /// View cells that were given: boxes without portals.
    Boxes,
}

impl GraphKind {
    /// The kind of the graph that a table stores, by the table's [kind](TableKind); by its dimension if that is not stated.
    pub fn of(table: &Table) -> Self {
        match table.kind() {
            kind if kind.is_quake() => Self::Convex,
            _ if table.dimension() == 2 => Self::Planar,
            TableKind::SceneGivenCells { .. } => Self::Boxes,
            _ => Self::Axial,
        }
    }
}

/// A borrowed graph of a table: what stab trees, proofs and explanations are made from.
#[derive(Debug, Clone, Copy)]
pub enum GraphRef<'a> {
    /// Convex polygons of a plan.
    Planar(&'a CellGraph<Planar>),
    /// The boxes of a k-d tree in space.
    Axial(&'a CellGraph<Axial>),
    /// The clusters of a Quake map.
    Convex(&'a CellGraph<Convex>),
    /// View cells that were given: boxes without portals.
    Boxes(&'a [Aabb<3>]),
}

/// The graph of another table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the graph has {} cells and {} portals, the table {} and {}", graph[0], graph[1], table[0], table[1])]
pub struct OtherGraph {
    /// Cells and portals of the graph.
    pub graph: [usize; 2],
    /// Cells and portals of the table.
    pub table: [usize; 2],
}

impl GraphRef<'_> {
    /// Number of cells.
    pub fn n_cells(self) -> usize {
        match self {
            Self::Planar(graph) => graph.n_cells(),
            Self::Axial(graph) => graph.n_cells(),
            Self::Convex(graph) => graph.n_cells(),
            Self::Boxes(boxes) => boxes.len(),
        }
    }

    /// Number of portals; 0 for given boxes.
    pub fn n_portals(self) -> usize {
        match self {
            Self::Planar(graph) => graph.portals().len(),
            Self::Axial(graph) => graph.portals().len(),
            Self::Convex(graph) => graph.portals().len(),
            Self::Boxes(_) => 0,
        }
    }

    /// Refuses a table with another number of cells or portals.
    pub(crate) fn check_size(self, table: &Table) -> Result<(), OtherGraph> {
        let graph = [self.n_cells(), self.n_portals()];
        let table = [table.n_cells(), table.portals().len()];
        if graph == table { Ok(()) } else { Err(OtherGraph { graph, table }) }
    }
}

impl<'a> From<&'a TableGraph> for GraphRef<'a> {
    fn from(graph: &'a TableGraph) -> Self {
        match graph {
            TableGraph::Planar(graph) => Self::Planar(graph),
            TableGraph::Axial(graph) => Self::Axial(graph),
            TableGraph::Convex(graph) => Self::Convex(graph),
            TableGraph::Boxes(boxes) => Self::Boxes(boxes),
        }
    }
}

impl<'a> From<&'a CellGraph<Planar>> for GraphRef<'a> {
    fn from(graph: &'a CellGraph<Planar>) -> Self {
        Self::Planar(graph)
    }
}

impl<'a> From<&'a CellGraph<Axial>> for GraphRef<'a> {
    fn from(graph: &'a CellGraph<Axial>) -> Self {
        Self::Axial(graph)
    }
}

impl<'a> From<&'a CellGraph<Convex>> for GraphRef<'a> {
    fn from(graph: &'a CellGraph<Convex>) -> Self {
        Self::Convex(graph)
    }
}

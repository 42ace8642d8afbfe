//! What every bake returns: the graph that was cut, the table made from it, and a report.

use crate::graph::TableGraph;
use crate::reports::{ClusterVisibility, MapReport, PlanReport, RegionReport, Report, SceneReport};
use sightlines_cells::{Axial, CellGraph, Convex, Planar};
use sightlines_pvs::Table;

/// A table, the graph that it was made from, and a report.
///
/// The functions for one kind of input have types of their own for graph and report; [`bake`](fn@crate::bake) has the
/// enums over all kinds.
#[derive(Debug, Clone, PartialEq)]
pub struct Baked<G = TableGraph, R = Report> {
    /// The cells and portals: cell `k` of the graph is cell `k` of the table, and portal `k` is portal `k`.
    pub graph: G,
    /// The table.
    pub table: Table,
    /// What was done.
    pub report: R,
}

/// A plan, baked.
pub type BakedPlan = Baked<CellGraph<Planar>, PlanReport>;
/// A scene, baked by sightlines through the portals of a k-d tree.
pub type BakedScene = Baked<CellGraph<Axial>, SceneReport>;
/// A scene, baked by a from-region method or for given cells.
pub type BakedRegions = Baked<TableGraph, RegionReport>;
/// A portal file, baked.
pub type BakedPrt = Baked<CellGraph<Convex>, ClusterVisibility>;
/// A Quake map with its portal file, baked.
pub type BakedMap = Baked<CellGraph<Convex>, MapReport>;

impl<G: Into<TableGraph>, R: Into<Report>> Baked<G, R> {
    /// The same with the enums over all kinds of graphs and reports.
    pub fn into_any(self) -> Baked {
        Baked { graph: self.graph.into(), table: self.table, report: self.report.into() }
    }
}

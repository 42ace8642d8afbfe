//! The table of a scene that changes: doors that close and open, walls that are built, moved and torn down, furniture
//! that is carried about.
//!
//! The scene is cut with what the last one leaves of its faces ([`SceneCutter`]); [`LiveAxial`] updates the visibility
//! where walls differ. The table is the one that [`bake_scene`](crate::bake_scene) makes of the new scene, byte for
//! byte, unless pairs are given up ([`SceneReport::n_assumed`](crate::SceneReport::n_assumed)): an update may know from
//! an easier earlier search that these are hidden. Walls with one side hide nothing in it, but where two stand back to back: it is the table of
//! [`SceneOptions::only_both_sides`].
//!
//! Doors at run time are portals, named by their ids. A portal that is closed is a wall, for the rows of the table only: its
//! portals stay, so that ids mean the same when it is opened.

mod cut;

use crate::doors;
use crate::error::BakeError;
use crate::mirrors;
use crate::scene::{PortalMode, SceneBakeOptions, extents, info, scene_parts};
use crate::stopwatch::Stopwatch;
use crate::table::state_file;
use cut::Cut;
use sightlines_cells::{Axial, AxialDoor, CellGraph, PortalId, Scene};
use sightlines_formats::SceneInfo;
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneCutter, SceneOptions};
use sightlines_pvs::Table;
use sightlines_stabtree::{AxialUpdate, LiveAxial, SearchOptions};
use std::time::Duration;

/// A scene with its table, and the state that keeps the table up to date.
///
/// Memory beside the table: see [`LiveAxial`].
#[derive(Debug, Clone)]
pub struct LiveScene {
    how: How,
    scene: Scene,
    /// The boxes of its objects.
    boxes: Vec<Aabb<3>>,
    cutter: SceneCutter,
    cut: Cut,
    /// Closed openings.
    closed: Vec<AxialDoor>,
    space: LiveAxial,
    table: Table,
}

/// The options that every update needs again.
#[derive(Debug, Clone)]
struct How {
    cut: SceneOptions,
    portals: PortalMode,
    threads: usize,
    file: Option<SceneInfo>,
}

impl How {
    fn options(&self) -> SceneBakeOptions<'_> {
        let Self { cut, portals, threads, ref file } = *self;
        SceneBakeOptions { cut, portals, threads, file: file.as_ref(), ..SceneBakeOptions::default() }
    }
}

/// What an update did, and how long it took.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct LiveUpdate {
    /// What changed, and how it was decided.
    pub space: AxialUpdate,
    /// Time to cut the scene.
    pub cut_time: Duration,
    /// Time to decide what is visible.
    pub see_time: Duration,
    /// Time to make the table.
    pub table_time: Duration,
}

impl LiveScene {
    /// Bakes a scene as [`bake_scene`](crate::bake_scene) does, and keeps what updates need. Ignores a budget.
    ///
    /// # Errors
    /// As [`bake_scene`](crate::bake_scene).
    pub fn new(scene: Scene, options: &SceneBakeOptions<'_>) -> Result<Self, BakeError> {
        let SceneBakeOptions { cut, portals, threads, file, progress, .. } = *options;
        let how = How { cut, portals, threads, file: file.cloned() };
        let mut cutter = SceneCutter::default();
        let cut = Cut::of(&mut cutter, &scene, &how.cut, portals)?;
        let search = SearchOptions { threads, progress, ..SearchOptions::default() };
        let boxes = extents(&scene);
        let space = LiveAxial::new(cut.graph.clone(), &cut.solid, boxes.clone(), &search)?;
        let table = tabulate(&scene, &boxes, &cut, &space, &how)?;
        Ok(Self { how, scene, boxes, cutter, cut, closed: Vec::new(), space, table })
    }

    /// The scene.
    pub const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The table, as of the last update.
    pub const fn table(&self) -> &Table {
        &self.table
    }

    /// Cells and portals, closed ones among them: ids are those of the table.
    pub const fn graph(&self) -> &CellGraph<Axial> {
        &self.cut.graph
    }

    /// Goes over to another scene, whatever it is; quick if it differs little.
    ///
    /// Objects may come, go, move and change their order. Portals that were closed stay closed as far as they lie in the
    /// same openings; all others are open.
    ///
    /// # Errors
    /// As [`bake_scene`](crate::bake_scene); then everything stays as it was.
    pub fn update(&mut self, scene: Scene) -> Result<LiveUpdate, BakeError> {
        let start = Stopwatch::start();
        let cut = Cut::of(&mut self.cutter, &scene, &self.how.cut, self.how.portals)?;
        let cut_time = start.elapsed();
        (self.boxes, self.scene, self.cut) = (extents(&scene), scene, cut);
        Ok(LiveUpdate { cut_time, ..self.see()? })
    }

    /// Closes portals, by their ids in the table: its rows become those of a scene with a wall in each of these openings.
    /// Ids that there are not close nothing.
    ///
    /// # Errors
    /// [`BakeError::Table`] for a defect of this crate.
    pub fn close(&mut self, portals: &[PortalId]) -> Result<LiveUpdate, BakeError> {
        let found = portals.iter().filter_map(|id| self.cut.graph.portals().get(id.idx()));
        let more: Vec<AxialDoor> = found.map(|portal| portal.shape).filter(|shape| !self.is_closed(shape)).collect();
        self.closed.extend(more);
        self.see()
    }

    /// Opens portals, by their ids in the table; those that are open stay so.
    ///
    /// # Errors
    /// [`BakeError::Table`] for a defect of this crate.
    pub fn open(&mut self, portals: &[PortalId]) -> Result<LiveUpdate, BakeError> {
        let found = portals.iter().filter_map(|id| self.cut.graph.portals().get(id.idx()));
        let opened: Vec<AxialDoor> = found.map(|portal| portal.shape).collect();
        // What was closed before the scene changed may be several portals now, of which only some are opened; where it is walled up, none.
        let (parted, mut closed): (Vec<AxialDoor>, Vec<AxialDoor>) =
            self.closed.iter().partition(|door| opened.iter().any(|portal| lies_in(portal, door)));
        let portals = self.cut.graph.portals().iter().map(|portal| portal.shape);
        let stays = |portal: &AxialDoor| !opened.contains(portal) && parted.iter().any(|door| lies_in(portal, door));
        closed.extend(portals.filter(stays));
        self.closed = closed;
        self.see()
    }

    /// The portals that are closed, ascending. O(portals × closed openings).
    pub fn closed_portals(&self) -> Vec<PortalId> {
        let ids = (0u32..).map(PortalId).zip(self.cut.graph.portals());
        ids.filter(|(_, portal)| self.is_closed(&portal.shape)).map(|(id, _)| id).collect()
    }

    fn is_closed(&self, portal: &AxialDoor) -> bool {
        self.closed.iter().any(|door| lies_in(portal, door))
    }

    /// Brings the answer and the table up to date with the scene that is cut and the portals that are closed.
    fn see(&mut self) -> Result<LiveUpdate, BakeError> {
        let start = Stopwatch::start();
        let search = SearchOptions { threads: self.how.threads, ..SearchOptions::default() };
        let graph = if self.closed.is_empty() {
            self.cut.graph.clone()
        } else {
            let open = self.cut.graph.portals().iter().filter(|portal| !self.is_closed(&portal.shape));
            CellGraph::new(self.cut.graph.cells().to_vec(), open.cloned().collect())
        };
        let space = self.space.update(graph, &self.cut.solid, self.boxes.clone(), &search);
        let see_time = start.elapsed();
        let start = Stopwatch::start();
        self.table = tabulate(&self.scene, &self.boxes, &self.cut, &self.space, &self.how)?;
        Ok(LiveUpdate { space, cut_time: Duration::ZERO, see_time, table_time: start.elapsed() })
    }
}

/// Whether an opening is a part of another one, or all of it.
fn lies_in(portal: &AxialDoor, door: &AxialDoor) -> bool {
    let (inner, outer) = (&portal.extent, &door.extent);
    portal.axis == door.axis && outer.contains(inner.min) && outer.contains(inner.max)
}

fn tabulate(scene: &Scene, boxes: &[Aabb<3>], cut: &Cut, space: &LiveAxial, how: &How) -> Result<Table, BakeError> {
    let info = info(&how.options(), &cut.summary);
    let mirrors = mirrors::of_scene(&cut.graph, scene).parts;
    let mut parts = scene_parts(&cut.graph, space.seen().clone(), scene, boxes, info, mirrors);
    parts.doors = doors::records(scene, &doors::of_scene(&cut.graph, scene));
    state_file(&mut parts, how.file.as_ref());
    Ok(Table::new(parts)?)
}

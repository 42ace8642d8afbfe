//! What a viewer in one cell may need: the cells that it sees, the portals between them, the objects in them.

use crate::front::Front;
use crate::source::{CellSource, MirrorPiece, PortalEdge};
use crate::trees::LocalTrees;
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Frame, MirrorId, ObjectId, PortalId};

/// All that a cell may see, gathered from a table: everything that the eye-to-cell methods ask, and nothing else.
///
/// Cells, ways and objects are numbered by themselves here, in the order of the table. Never changed once it is made, so it may
/// be shared between threads. Memory in proportion to what the cell sees.
#[derive(Debug, Clone, PartialEq)]
pub struct VisibleSubgraph {
    pub(crate) root: u32,
    pub(crate) planar: bool,
    /// The axes of all coordinates here; `None`: those of the scene.
    pub(crate) frame: Option<Frame>,
    /// The cells that the root sees, ascending, and their boxes.
    pub(crate) cells: Vec<CellId>,
    pub(crate) bounds: Vec<Aabb<3>>,
    /// Where the ways out of each cell begin, and behind them their number.
    pub(crate) first_way: Vec<u32>,
    pub(crate) ways: Vec<LocalEdge>,
    pub(crate) corners: Vec<[f64; 3]>,
    /// The objects that the root sees, ascending, and their boxes.
    pub(crate) objects: Vec<ObjectId>,
    pub(crate) object_bounds: Vec<Aabb<3>>,
    /// For each cell the objects that touch it, as places in `objects`.
    pub(crate) first_object: Vec<u32>,
    pub(crate) cell_objects: Vec<u32>,
    /// Cells without any portal, but the root: no portal leads there, so only their boxes can be tested.
    pub(crate) apart_cells: Vec<u32>,
    /// Objects that touch no cell that the root sees; all of them if the root has no portal.
    pub(crate) loose_objects: Vec<u32>,
    pub(crate) first_mirror: Vec<u32>,
    pub(crate) mirrors: Vec<LocalMirror>,
    pub(crate) trees: Option<LocalTrees>,
    /// Around all cells and corners.
    pub(crate) extent: Aabb<3>,
}

/// A way from one cell of an subgraph into another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LocalEdge {
    pub(crate) to: u32,
    pub(crate) portal: PortalId,
    pub(crate) first_corner: u32,
    pub(crate) n_corners: u32,
    pub(crate) front: Front,
}

/// A piece of a mirror in a cell of an subgraph.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LocalMirror {
    pub(crate) mirror: MirrorId,
    pub(crate) first_corner: u32,
    pub(crate) n_corners: u32,
    pub(crate) front: Front,
}

impl VisibleSubgraph {
    /// Gathers what `root` may see. O(what it sees, times the logarithm of that).
    ///
    /// # Errors
    /// The first of `source`.
    ///
    /// # Panics
    /// If the source has no such cell.
    pub fn prepare<S: CellSource + ?Sized>(source: &S, root: CellId) -> Result<Self, S::Error> {
        let mut cells = Vec::new();
        source.visible(root, &mut cells)?;
        if let Err(place) = cells.binary_search(&root) {
            cells.insert(place, root);
        }
        let bounds = cells.iter().map(|&cell| source.cell_box(cell)).collect::<Result<Vec<_>, _>>()?;
        let extent =
            bounds.iter().filter(|b| !b.is_empty()).fold(Aabb::EMPTY, |e: Aabb<3>, b| e.with(b.min).with(b.max));
        let mut objects = Vec::new();
        source.objects_seen(root, &mut objects)?;
        let object_bounds = objects.iter().map(|&o| source.object_box(o)).collect::<Result<Vec<_>, _>>()?;
        let mut subgraph = Self {
            root: cells.binary_search(&root).unwrap_or_default() as u32,
            planar: source.dimension() == 2,
            frame: source.frame(),
            bounds,
            first_way: vec![0],
            ways: Vec::new(),
            corners: Vec::new(),
            objects,
            object_bounds,
            first_object: vec![0],
            cell_objects: Vec::new(),
            apart_cells: Vec::new(),
            loose_objects: Vec::new(),
            first_mirror: vec![0],
            mirrors: Vec::new(),
            trees: None,
            extent,
            cells,
        };
        for k in 0..subgraph.cells.len() {
            subgraph.gather(source, k)?;
        }
        subgraph.find_loose_objects();
        subgraph.extent = subgraph.corners.iter().fold(subgraph.extent, |e, &c| e.with(c));
        let edge_through = |cell: u32, portal: PortalId| {
            let edge = subgraph.ways_of(cell).find(|&edge| subgraph.ways[edge as usize].portal == portal)?;
            Some((edge, subgraph.ways[edge as usize].to))
        };
        let trees = LocalTrees::of(source, (root, subgraph.root), edge_through)?;
        subgraph.trees = trees;
        Ok(subgraph)
    }

    /// Gathers the ways, objects and mirrors of the cell in place `k`.
    fn gather<S: CellSource + ?Sized>(&mut self, source: &S, k: usize) -> Result<(), S::Error> {
        let cell = self.cells[k];
        let mut has_portal = false;
        source.portal_edges(cell, &mut |way: PortalEdge<'_>| {
            has_portal = true;
            let Ok(to) = self.cells.binary_search(&way.to) else { return };
            let first_corner = self.corners.len() as u32;
            self.corners.extend_from_slice(way.corners);
            let corners = &mut self.corners[first_corner as usize..];
            if !way.forward {
                corners.reverse();
            }
            let front = Front::of(corners, self.planar);
            let n_corners = corners.len() as u32;
            self.ways.push(LocalEdge { to: to as u32, portal: way.portal, first_corner, n_corners, front });
        })?;
        self.first_way.push(self.ways.len() as u32);
        if !has_portal {
            self.apart_cells.push(k as u32);
        }

        let mut touching = Vec::new();
        source.objects_of(cell, &mut touching)?;
        let seen = touching.iter().filter_map(|o| self.objects.binary_search(o).ok());
        self.cell_objects.extend(seen.map(|o| o as u32));
        self.first_object.push(self.cell_objects.len() as u32);

        source.mirrors(cell, &mut |mirror: MirrorPiece<'_>| {
            let first_corner = self.corners.len() as u32;
            self.corners.extend_from_slice(mirror.corners);
            let front = Front::of(mirror.corners, self.planar);
            let n_corners = mirror.corners.len() as u32;
            self.mirrors.push(LocalMirror { mirror: mirror.mirror, first_corner, n_corners, front });
        })?;
        self.first_mirror.push(self.mirrors.len() as u32);
        Ok(())
    }

    /// A cell without portals is a box from elsewhere: boxes leave gaps, in which an object that touches one of them may be seen although
    /// that one is not.
    fn find_loose_objects(&mut self) {
        let n_apart = self.apart_cells.len();
        self.apart_cells.retain(|&cell| cell != self.root);
        if self.apart_cells.len() < n_apart {
            self.loose_objects = (0..self.objects.len() as u32).collect();
            return;
        }
        let mut touches = vec![false; self.objects.len()];
        self.cell_objects.iter().for_each(|&o| touches[o as usize] = true);
        self.loose_objects = (0u32..).zip(&touches).filter(|(_, touches)| !**touches).map(|(o, _)| o).collect();
    }

    /// The cell that all this is seen from.
    pub fn root(&self) -> CellId {
        self.cells[self.root as usize]
    }

    /// The cells that it may see, itself included, ascending: the cell-to-cell set.
    pub fn cells(&self) -> &[CellId] {
        &self.cells
    }

    /// The objects that it may see, ascending.
    pub fn objects(&self) -> &[ObjectId] {
        &self.objects
    }

    /// Bytes that the subgraph takes, the spare room of its lists included.
    pub fn n_bytes(&self) -> usize {
        fn list<T>(v: &Vec<T>) -> usize {
            v.capacity() * size_of::<T>()
        }
        size_of::<Self>()
            + list(&self.cells)
            + list(&self.bounds)
            + list(&self.first_way)
            + list(&self.ways)
            + list(&self.corners)
            + list(&self.objects)
            + list(&self.object_bounds)
            + list(&self.first_object)
            + list(&self.cell_objects)
            + list(&self.apart_cells)
            + list(&self.loose_objects)
            + list(&self.first_mirror)
            + list(&self.mirrors)
            + self.trees.as_ref().map_or(0, LocalTrees::n_bytes)
    }

    pub(crate) fn ways_of(&self, cell: u32) -> std::ops::Range<u32> {
        self.first_way[cell as usize]..self.first_way[cell as usize + 1]
    }

    pub(crate) fn objects_of(&self, cell: u32) -> &[u32] {
        &self.cell_objects[self.first_object[cell as usize] as usize..self.first_object[cell as usize + 1] as usize]
    }

    pub(crate) fn mirrors_of(&self, cell: u32) -> &[LocalMirror] {
        &self.mirrors[self.first_mirror[cell as usize] as usize..self.first_mirror[cell as usize + 1] as usize]
    }

    pub(crate) fn corners(&self, first: u32, n: u32) -> &[[f64; 3]] {
        &self.corners[first as usize..(first + n) as usize]
    }
}

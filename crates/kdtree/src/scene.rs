//! From a scene in space to a graph of boxes and rectangular portals.

use crate::build::{Cuts, KdOptions, subdivide_with};
use crate::cache::FaceCache;
use crate::doors::shut_doors;
use crate::error::KdError;
use crate::left_out::{LeftOut, left_out};
use crate::scene_faces::{SceneFaces, Survey};
use crate::scene_options::SceneOptions;
use crate::tree::{AxialPortal, AxialTree};
use sightlines_cells::{Axial, AxialDoor, BoxCell, CellGraph, Portal, Scene};
use sightlines_geometry::{Aabb, OneWayRectangle, check_coordinate};
use sightlines_pvs::CellId;

/// Statistics of the subdivision of a scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SceneSummary {
    /// Triangles of all objects with an area that are perpendicular to an axis.
    pub n_axial_triangles: usize,
    /// Triangles perpendicular to an axis that have no area.
    pub n_empty_triangles: usize,
    /// All other triangles; they hide nothing.
    pub n_other_triangles: usize,
    /// Size below which things were detail, in scene units.
    pub detail_below: f64,
    /// How many objects were detail.
    pub n_detail_objects: usize,
    /// How many flat regions were left out because they are small.
    pub n_small_regions: usize,
    /// How many rectangles the scene was cut along.
    pub n_faces: usize,
    /// How many pieces of these rectangles the threshold `tau` left inside of cells.
    pub n_unfollowed: usize,
    /// Cells of the graph.
    pub n_cells: usize,
    /// Portals of the graph.
    pub n_portals: usize,
    /// Cells of the tree that were left out because they are inside of solid matter.
    pub n_solid: usize,
    /// Cells of the tree that were left out because they are closed and show only back sides.
    pub n_hollow: usize,
    /// Cells of the tree that were left out because no way leads to them from the view region.
    pub n_unreachable: usize,
}

/// A scene, cut.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneSubdivision {
    /// The tree of all cells, those that the graph leaves out too. Its ids are its own; see
    /// [`Self::cell_of`].
    pub tree: AxialTree<3>,
    /// Cells and portals. Ids count the cells of the tree that are not left out, in the same order.
    pub graph: CellGraph<Axial>,
    /// Statistics.
    pub summary: SceneSummary,
    /// For each object whether it was detail, or see-through.
    pub detail: Vec<bool>,
    /// Rectangles in what hides from its front. They divide cells as walls do, and lie in portals: the graph does not tell which way they hide.
    /// None with [`SceneOptions::only_both_sides`].
    pub fronts: Vec<OneWayRectangle>,
    cells: Vec<Option<CellId>>,
}

/// Cuts the box around `scene` and the view region along the faces of the scene.
///
/// The faces are those of [`scene_faces`](crate::scene_faces); all other triangles hide nothing. Errs
/// towards "visible" only.
///
/// Where a face of a [door](Scene::doors) fills an opening, the cells are divided along it, so that there is a portal that the door closes.
///
/// # What is left out
/// Cells inside solid things would be rows of a table that are never queried. Cells joined by portals are left out
/// together, and only if no portal leads to them from others, so nothing changes for the cells that stay. They are left
/// out
/// * as *solid* if each of them is, all through, inside of a closed piece of an object (one that winds
///   around it counter-clockwise as seen from outside, less what hollows of the same object take away).
///   A closed piece that other things lie in is a house and no wall, and does not count;
/// * as *hollow* if they are closed on all sides, have nothing inside, and show only back sides of
///   triangles: the space between the two sheets of a wall;
/// * as *unreachable* if a view region was given and none of them meets it.
///
/// A closed room that shows the front of any triangle stays. If no cell would stay, all do.
///
/// Cost: as [`scene_faces`](crate::scene_faces) and [`subdivide`](crate::subdivide); to leave out cells, O(log n) for each
/// pair of a triangle and a cell that it lies against, as a rule.
///
/// # Errors
/// [`KdError::Empty`] and [`KdError::Flat`] for scenes without faces or without extent along an axis;
/// [`KdError::Bounds`] and [`KdError::ViewRegion`] for a view region that is no box; [`KdError::Tau`],
/// [`KdError::DetailBelow`], [`KdError::TooManyCells`].
pub fn subdivide_scene(scene: &Scene, options: &SceneOptions) -> Result<SceneSubdivision, KdError> {
    SceneCutter::default().cut(scene, options)
}

/// Cuts scenes one after the other. What a scene shares with the last one is not processed again.
///
/// Memory: about that of the last scene.
#[derive(Debug, Clone, Default)]
pub struct SceneCutter {
    cache: FaceCache,
}

impl SceneCutter {
    /// Cuts a scene as [`subdivide_scene`] does, with the same result.
    ///
    /// Cost: as there, except for finding the faces: O(vertices) for objects that the last scene had too, and the cost
    /// of planes on which something differs.
    ///
    /// # Errors
    /// As [`subdivide_scene`].
    pub fn cut(&mut self, scene: &Scene, options: &SceneOptions) -> Result<SceneSubdivision, KdError> {
        if let Some(size) = options.detail_below.filter(|s| s.is_nan() || *s < 0.0) {
            return Err(KdError::DetailBelow(size));
        }
        let survey = Survey::of(scene, options, &mut self.cache);
        let bounds = root_box(survey.bounds(), options.view_region)?;
        let found = survey.faces(&mut self.cache);
        let doors: Vec<_> = shut_doors(scene).into_iter().flat_map(|door| door.faces).collect();
        let how = KdOptions { tau: options.tau, max_cells: options.max_cells };
        let open: Vec<_> = found.fronts.iter().map(|front| front.0).collect();
        let tree = subdivide_with(&Cuts { walls: &found.faces, open: &open, dividers: &doors }, bounds, &how)?;
        let out = match options.keep_solid {
            true => vec![None; tree.cells().len()],
            false => left_out(scene, &survey, &found, &tree, options.view_region),
        };
        let mut cut = SceneSubdivision::assemble(tree, &out, found);
        if options.only_both_sides {
            cut.fronts.clear();
        }
        Ok(cut)
    }
}

fn root_box(bounds: Aabb<3>, view_region: Option<Aabb<3>>) -> Result<Aabb<3>, KdError> {
    let Some(region) = view_region else { return Ok(bounds) };
    for x in region.min.into_iter().chain(region.max) {
        check_coordinate(x).map_err(KdError::Bounds)?;
    }
    if region.is_empty() { Err(KdError::ViewRegion) } else { Ok(bounds.with(region.min).with(region.max)) }
}

impl SceneSubdivision {
    fn assemble(tree: AxialTree<3>, out: &[Option<LeftOut>], found: SceneFaces) -> Self {
        let mut next = 0u32..;
        let cells: Vec<Option<CellId>> =
            out.iter().map(|o| if o.is_none() { next.next().map(CellId) } else { None }).collect();
        let boxes = tree.cells().iter().zip(&cells).filter(|(_, id)| id.is_some());
        let boxes = boxes.map(|(cell, _)| BoxCell { bounds: cell.bounds }).collect();
        // The graph leaves out both cells of a portal or neither.
        let inner = |p: &AxialPortal<3>| match p.cells.map(|c| cells[c.idx()]) {
            [Some(a), Some(b)] => Some(portal(p, [a, b])),
            _ => None,
        };
        let graph = CellGraph::new(boxes, tree.portals().iter().filter_map(inner).collect());
        let summary = summarise(&tree, out, &found, &graph);
        let fronts = found.fronts.iter().map(|(face, front_up)| OneWayRectangle {
            bounds: Aabb { min: face.min, max: face.max },
            front_up: *front_up,
        });
        Self { tree, graph, summary, detail: found.detail, fronts: fronts.collect(), cells }
    }

    /// The boxes of the tree's cells that the graph leaves out.
    pub fn left_out(&self) -> Vec<Aabb<3>> {
        let all = self.tree.cells().iter().zip(&self.cells);
        all.filter(|(_, id)| id.is_none()).map(|(cell, _)| cell.bounds).collect()
    }

    /// The cell of the graph that equals a cell of the tree; none if it is left out.
    ///
    /// # Panics
    /// If the tree has no such cell.
    pub fn cell_of(&self, leaf: CellId) -> Option<CellId> {
        self.cells[leaf.idx()]
    }

    /// The one cell of the graph that `p`, in scene units, is assigned to; none outside the tree's bounds, for NaN, and
    /// inside of what is left out. On the border between the two it is a cell that is not left out.
    pub fn locate(&self, p: [f64; 3]) -> Option<CellId> {
        let inside = self.tree.locate(p)?;
        self.cell_of(inside).or_else(|| self.locate_all(p).first().copied())
    }

    /// All closed cells of the graph that contain `p`, in scene units, ascending.
    pub fn locate_all(&self, p: [f64; 3]) -> Vec<CellId> {
        self.tree.locate_all(p).into_iter().filter_map(|leaf| self.cell_of(leaf)).collect()
    }
}

fn summarise(
    tree: &AxialTree<3>,
    out: &[Option<LeftOut>],
    found: &SceneFaces,
    graph: &CellGraph<Axial>,
) -> SceneSummary {
    let n_out = |why: LeftOut| out.iter().filter(|o| **o == Some(why)).count();
    SceneSummary {
        n_axial_triangles: found.n_axial_triangles,
        n_empty_triangles: found.n_empty_triangles,
        n_other_triangles: found.n_other_triangles,
        detail_below: found.detail_below,
        n_detail_objects: found.n_detail_objects,
        n_small_regions: found.n_small_regions,
        n_faces: found.faces.len() + found.fronts.len(),
        n_unfollowed: tree.n_detail(),
        n_cells: graph.n_cells(),
        n_portals: graph.portals().len(),
        n_solid: n_out(LeftOut::Solid),
        n_hollow: n_out(LeftOut::Hollow),
        n_unreachable: n_out(LeftOut::Unreachable),
    }
}

fn portal(portal: &AxialPortal<3>, cells: [CellId; 2]) -> Portal<Axial> {
    let low_side = 2 * portal.axis as u32;
    let extent = Aabb { min: portal.min, max: portal.max };
    let shape = AxialDoor { extent, axis: portal.axis as u8, forward: true };
    Portal { cells, sides: [low_side + 1, low_side], shape }
}

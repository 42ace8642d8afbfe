//! Tables of maps: clusters with their places, and the faces that are drawn when they are seen.

mod faces;
mod planes;

use super::table::{SOURCE_KEY, parts_of_clusters};
use super::{PrtBakeError, PrtOptions, graph, see};
use crate::baked::{Baked, BakedMap};
use crate::objects::object_lists;
use crate::reports::{MapReport, WorldSummary};
use planes::ClusterTree;
use sightlines_cells::{CellGraph, Convex};
use sightlines_formats::quake::bsp::{BspTree, WorldFaces};
use sightlines_formats::quake::visibility::{check_portals, clusters_of_leafs};
use sightlines_formats::quake::{Bsp, Prt};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellRecord, Locator, ObjectRecord, Table, TableKind};

/// By how much the bounds of leafs may be too small, in map units. Most formats have them as whole numbers, and some
/// compilers cut the rest off.
const BOUNDS_ROUNDING: f64 = 1.0;

/// Decides which clusters of a map see which, and makes a table of them with their places: cell `k` is
/// cluster `k`, planes are those of the map's tree, an object is a face of the world, named by its number in the map.
///
/// The box of a cell is that around its leafs and its portals. The tree is that of the map, whose planes are rounded to
/// floats; so a viewer counts to both sides of a plane that is nearer than portals were found to be from the plane that
/// they are on, or than they are uneven. A cell is touched by the faces that its leafs list, and by those that
/// reach into it further than that.
///
/// # Errors
/// [`PrtBakeError`]: before the search for portals of another map, as [`super::vis_map`], for a map whose tree or faces are
/// broken, and for a portal that is beside all planes between its clusters.
pub fn bake_map(bsp: &Bsp, prt: &Prt, options: PrtOptions<'_>) -> Result<BakedMap, PrtBakeError> {
    check_portals(bsp, prt)?;
    let (tree, faces, listed) = (bsp.world_tree()?, bsp.world_faces()?, bsp.leaf_faces()?);
    let graph = graph(prt)?;
    let leafs = clusters_of_leafs(bsp, &prt.leaf_clusters());
    let planes = ClusterTree::new(&tree, &leafs, &graph)?;
    let lists = faces::lists(&planes, &leafs, &faces, &listed, prt.n_clusters() as usize);
    let fast = options.search.fast;
    let clusters = see(&graph, options)?;

    let mut parts = parts_of_clusters(prt, &graph, clusters.seen.cells.clone(), fast);
    parts.cells = boxes(bsp, &tree, &leafs, &graph).into_iter().map(cell_record).collect();
    parts.locator = Locator::build(&parts.cell_bounds(), 3);
    parts.objects = (0..faces.n_faces()).map(|k| object_record(&faces, k)).collect();
    parts.object_polygons = (0..faces.n_faces()).map(|k| faces.polygons(k).len() as u32).collect();
    let world = WorldSummary {
        n_faces: faces.n_faces(),
        n_unlisted_faces: lists.n_unlisted_faces,
        n_listed: lists.n_listed,
        n_reaching: lists.n_reaching,
        n_planes: planes.n_nodes(),
        slack: planes.slack(),
    };
    parts.cell_objects = object_lists(lists.of_clusters);
    parts.planes = planes.into_planes();
    let source = format!("Quake map {} with {}", bsp.format().name(), prt.dialect());
    parts.kind = TableKind::QuakeMap;
    parts.info.iter_mut().filter(|(key, _)| key == SOURCE_KEY).for_each(|(_, value)| value.clone_from(&source));
    Ok(Baked { table: Table::new(parts)?, graph, report: MapReport { clusters, world } })
}

/// The box around the leafs and the portals of each cluster; empty for one that has neither.
fn boxes(bsp: &Bsp, tree: &BspTree, leafs: &[Option<u32>], graph: &CellGraph<Convex>) -> Vec<Aabb<3>> {
    let mut boxes: Vec<Aabb<3>> = graph.cells().iter().map(|cell| cell.bounds).collect();
    for leaf in planes::leafs_of(tree) {
        let (Some(cluster), record) = (leafs[leaf as usize], bsp.leafs()[leaf as usize]) else { continue };
        let (low, high) = (record.mins.map(f64::from), record.maxs.map(f64::from));
        // An invalid box gives no bounds of its leaf, so the portals have to do.
        if (0..3).all(|k| low[k].is_finite() && high[k].is_finite() && low[k] <= high[k]) {
            let around = &mut boxes[cluster as usize];
            *around = around.with(low.map(|x| x - BOUNDS_ROUNDING)).with(high.map(|x| x + BOUNDS_ROUNDING));
        }
    }
    boxes
}

fn cell_record(bounds: Aabb<3>) -> CellRecord {
    let (min, max) = if bounds.is_empty() { ([0.0; 3], [0.0; 3]) } else { (bounds.min, bounds.max) };
    CellRecord { min, max, group: None, polygon: Vec::new() }
}

fn object_record(faces: &WorldFaces, k: usize) -> ObjectRecord {
    let around = Aabb::around(faces.corners(k).iter().copied());
    let Aabb { min, max } = if around.is_empty() { Aabb { min: [0.0; 3], max: [0.0; 3] } } else { around };
    ObjectRecord { name: format!("face {}", faces.range().start as usize + k), min, max }
}

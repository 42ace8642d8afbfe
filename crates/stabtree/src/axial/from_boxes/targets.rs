//! Targets of boxes, and where boxes lie among the cells.

use super::super::components;
use super::super::objects::touch;
use super::super::slivers::THIN;
use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::{Aabb, BoxTree};

/// Locates boxes among the cells.
pub(super) struct CellLocator {
    pub(super) all: Aabb<3>,
    /// Half of the minimum thickness of a box.
    pub(super) thin: f64,
    pub(super) extents: Vec<Aabb<3>>,
    pub(super) tree: BoxTree<3>,
    /// For each cell, its connected component through portals, given by the least cell in it.
    pub(super) component: Vec<u32>,
}

impl CellLocator {
    pub(super) fn new(graph: &CellGraph<Axial>) -> Self {
        let extents: Vec<Aabb<3>> = graph.cells().iter().map(|c| c.bounds).collect();
        let all = Aabb::<3>::around(extents.iter().flat_map(|b| [b.min, b.max]));
        let longest = (0..3).map(|k| all.max[k] - all.min[k]).fold(0.0, f64::max);
        let tree = BoxTree::build(&extents, 4);
        Self { all, thin: longest * THIN, extents, tree, component: components(graph) }
    }

    /// The box, widened slightly along axes on which it is too thin to be decided.
    pub(super) fn thickened(&self, b: &Aabb<3>) -> Aabb<3> {
        let mut thick = *b;
        for k in 0..3 {
            if b.max[k] - b.min[k] < self.thin {
                thick.min[k] = (b.min[k] - self.thin).next_down();
                thick.max[k] = (b.max[k] + self.thin).next_up();
            }
        }
        thick
    }

    pub(super) fn holds(&self, b: &Aabb<3>) -> bool {
        self.all.contains(b.min) && self.all.contains(b.max)
    }

    /// The components of the cells that a box touches, ascending.
    pub(super) fn components(&self, b: &Aabb<3>) -> Vec<u32> {
        let mut found = Vec::new();
        self.tree.visit(
            |node| touch(node, b),
            |cell| {
                if touch(&self.extents[cell as usize], b) {
                    found.push(self.component[cell as usize]);
                }
            },
        );
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// Targets, all of one kind.
pub(super) struct Targets<'a> {
    /// What has to be reached.
    pub(super) boxes: &'a [Aabb<3>],
    /// Boxes that are visible if they are touched.
    pub(super) own: &'a [Aabb<3>],
    pub(super) tree: BoxTree<3>,
    pub(super) components: Vec<Vec<u32>>,
    /// Whether each extends beyond the cells.
    pub(super) outside: Vec<bool>,
}

impl<'a> Targets<'a> {
    pub(super) fn new(boxes: &'a [Aabb<3>], own: &'a [Aabb<3>], places: &CellLocator) -> Self {
        Self {
            boxes,
            own,
            tree: BoxTree::build(boxes, 1),
            components: own.par_iter().map(|b| places.components(b)).collect(),
            outside: own.iter().map(|b| !b.is_empty() && !places.holds(b)).collect(),
        }
    }

    /// Whether lines can reach it at all: not if it is empty, or, for objects, flat along two axes.
    pub(super) fn can_be_reached(&self, i: usize) -> bool {
        let b = &self.boxes[i];
        !b.is_empty() && (0..3).filter(|&k| b.min[k] == b.max[k]).count() < 2
    }
}

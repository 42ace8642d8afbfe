//! Free space that ways join to given boxes: cells of a k-d tree that hold all of it, and points that are certainly in it.
//!
//! Sight is a way. So what eyes see that walk from some boxes is joined to these by free space. A k-d tree along the walls divides all space into cells, and
//! no way leads from a cell to another but by portals, where walls leave a part of their common side open. So the closed cells that portals join to those which the boxes meet hold all
//! places of the eye, and whatever meets none of them is seen from none. Walls that the tree does not follow, as they stand along no axis, bar no way.

use sightlines_cells::Scene;
use sightlines_from_region::may_meet;
use sightlines_geometry::{Aabb, BoxTree, Point3, Random};
use sightlines_kdtree::{SceneOptions, subdivide_scene};
use sightlines_multifocal::Volume;
use std::collections::BTreeSet;

/// How many points are found that ways lead to.
const STATIONS: usize = 4096;

/// How many of them are tried for a way to another point.
const NEAREST: usize = 8;

/// Cells that hold all of the free space that is joined to some boxes.
#[derive(Debug)]
pub(crate) struct Space {
    cells: Vec<Aabb<3>>,
    tree: BoxTree<3>,
}

impl Space {
    /// Finds the cells for some boxes, or without any for all that is outside; or none if all of the scene is joined or there are too many cells. O(n log n) for n walls along axes, as a rule.
    ///
    /// * `around`: a box that is larger than the one around the scene
    pub(crate) fn joined_to(scene: &Scene, boxes: &[Aabb<3>], around: Aabb<3>) -> Option<Self> {
        // First all walls, then without what is small.
        let exact = SceneOptions { tau: 0.0, detail_below: Some(0.0), ..SceneOptions::default() };
        let cut = [exact, SceneOptions::default()].into_iter().find_map(|options| {
            let options =
                SceneOptions { view_region: Some(around), keep_solid: true, only_both_sides: true, ..options };
            subdivide_scene(scene, &options).ok()
        })?;
        let (graph, all) = (&cut.graph, cut.tree.bounds());
        let is_border = |b: &Aabb<3>| (0..3).any(|k| b.min[k] == all.min[k] || b.max[k] == all.max[k]);
        let meet = |a: &Aabb<3>, b: &Aabb<3>| (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k]);
        let leaves = |b: &Aabb<3>| (0..3).any(|k| b.min[k] < all.min[k] || b.max[k] > all.max[k]);
        let mut is_outside = boxes.is_empty() || boxes.iter().any(leaves);
        let mut is_reached = vec![false; graph.n_cells()];
        let is_start = |b: &Aabb<3>| boxes.iter().any(|eyes| meet(b, eyes)) || is_outside && is_border(b);
        let mut pending: Vec<_> = graph.cell_ids().filter(|&id| is_start(&graph.cell(id).bounds)).collect();
        while let Some(id) = pending.pop() {
            if std::mem::replace(&mut is_reached[id.idx()], true) {
                continue;
            }
            pending.extend(graph.exits(id).iter().map(|exit| exit.to));
            // What is outside joins all that is at the border.
            if !is_outside && is_border(&graph.cell(id).bounds) {
                is_outside = true;
                pending.extend(graph.cell_ids().filter(|&other| is_border(&graph.cell(other).bounds)));
            }
        }
        if is_reached.iter().all(|reached| *reached) {
            return None;
        }
        let cells: Vec<Aabb<3>> = graph
            .cells()
            .iter()
            .zip(&is_reached)
            .filter(|(_, reached)| **reached)
            .map(|(cell, _)| cell.bounds)
            .collect();
        Some(Self { tree: BoxTree::build(&cells, 4), cells })
    }

    /// Whether a triangle may meet what is joined. Never wrongly no.
    pub(crate) fn touches(&self, triangle: &[Point3; 3]) -> bool {
        let mut touches = false;
        let near = |b: &Aabb<3>| may_meet(triangle, b);
        self.tree.visit(near, |i| touches |= near(&self.cells[i as usize]));
        touches
    }
}

/// Points that ways lead to, of free segments one after the other.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Stations {
    points: Vec<Point3>,
    /// The same by their bits.
    all: BTreeSet<[u64; 3]>,
}

impl Stations {
    /// Walks from random points of some boxes.
    ///
    /// * `step`: a point that a free segment joins to one, in a direction, at a share of the way to what is there
    pub(crate) fn find(
        boxes: &[Volume],
        random: &mut Random,
        step: impl Fn(Point3, Point3, f64) -> Option<Point3>,
    ) -> Self {
        let mut found = Self::default();
        for _ in 0..boxes.len().max(64) {
            let any = random.below(boxes.len());
            found.add(random.point(boxes[any].bounds()));
        }
        for _ in 0..2 * STATIONS {
            if found.points.len() >= STATIONS.max(2 * boxes.len()) {
                break;
            }
            let from = found.any(random);
            if let Some(to) = step(from, random.direction(), random.open_unit()) {
                found.add(to);
            }
        }
        found
    }

    fn add(&mut self, p: Point3) {
        if self.all.insert(p.map(f64::to_bits)) {
            self.points.push(p);
        }
    }

    pub(crate) fn any(&self, random: &mut Random) -> Point3 {
        self.points[random.below(self.points.len())]
    }

    pub(crate) fn has(&self, point: Point3) -> bool {
        self.all.contains(&point.map(f64::to_bits))
    }

    pub(crate) fn near(&self, point: Point3) -> Vec<Point3> {
        let away = |p: &Point3| -> f64 { (0..3).map(|k| (p[k] - point[k]) * (p[k] - point[k])).sum() };
        let mut near = self.points.clone();
        near.sort_by(|a, b| away(a).total_cmp(&away(b)));
        near.truncate(NEAREST);
        near
    }
}

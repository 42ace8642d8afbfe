//! Chords of the plane: lines through two points in doubles, followed by exact orientations.

use super::mark;
use crate::zones::Zones;
use sightlines_cells::{CellGraph, CellId, Exit, Planar};
use sightlines_geometry::Random;
use sightlines_geometry::{Point2, orient2d};
use sightlines_pvs::BitMatrix;

/// Shoots `per_exit` chords through each exit that leads from one zone into another, and returns which
/// zones were seen from which: symmetric, with the diagonal set, a subset of what is visible.
///
/// Deterministic. Cost: a chord costs one exact test for each exit of each cell that it crosses.
pub fn shoot_chords(graph: &CellGraph<Planar>, zones: &Zones, per_exit: u32) -> BitMatrix {
    let mut seen = BitMatrix::identity(zones.n_zones());
    let mut random = Random::new(0x5167_6874_6C69_6E65);
    let extent = extent(graph);
    let mut path = Vec::new();
    for from in graph.cell_ids() {
        for exit in graph.exits(from) {
            if exit.to < from || zones.of(exit.to) == zones.of(from) {
                continue;
            }
            for _ in 0..per_exit {
                let door = graph.crossing(exit);
                let p = door.right + (door.left - door.right) * random.open_unit();
                let q = p + Point2::new(random.open_unit() - 0.5, random.open_unit() - 0.5) * extent;
                // Either direction of the line may be the one that crosses the door forwards.
                let (p, q) = if orient2d(p, q, door.left) > 0.0 { (p, q) } else { (q, p) };
                if passes(graph, exit, p, q) {
                    path.clear();
                    follow(graph, from, exit, p, q, |cell| path.extend(zones.of(cell)));
                    mark(&mut seen, &mut path);
                }
            }
        }
    }
    seen
}

fn extent(graph: &CellGraph<Planar>) -> f64 {
    let bounds = graph.cells().iter().flat_map(|c| &c.polygon).map(|p| [p.x, p.y]);
    let bounds = sightlines_geometry::Aabb::<2>::around(bounds);
    (bounds.max[0] - bounds.min[0]).max(bounds.max[1] - bounds.min[1])
}

fn passes(graph: &CellGraph<Planar>, exit: &Exit, p: Point2, q: Point2) -> bool {
    let door = graph.crossing(exit);
    orient2d(p, q, door.left) > 0.0 && orient2d(p, q, door.right) < 0.0
}

/// Visits the cells on both sides of `exit` along the line, each side from near to far.
fn follow(graph: &CellGraph<Planar>, from: CellId, exit: &Exit, p: Point2, q: Point2, mut visit: impl FnMut(CellId)) {
    let mut go = |mut cell: CellId, mut entry_side: u32, p: Point2, q: Point2| {
        visit(cell);
        // A line crosses each convex cell once.
        for _ in 0..graph.n_cells() {
            let onward = |e: &&Exit| e.side != entry_side && passes(graph, e, p, q);
            let Some(next) = graph.exits(cell).iter().find(onward) else { return };
            (cell, entry_side) = (next.to, next.entry_side);
            visit(cell);
        }
    };
    go(exit.to, exit.entry_side, p, q);
    go(from, exit.side, q, p);
}

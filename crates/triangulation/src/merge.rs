//! Merging triangles into convex cells, and the graph of what remains.
//!
//! An edge between two cells is removed if the merged cell is convex and no information is lost: the edge blocks
//! nothing, and both sides have the same groups. Edges are tried longest first, then by index: the rule of Hertel and
//! Mehlhorn in a fixed order.

use crate::mesh::{Mesh, OUTSIDE};
use crate::regions::Regions;
use sightlines_cells::{CellGraph, CellId, ConvexCell2, Planar, graph::Portal};
use sightlines_geometry::{Point2, Portal2, along, orient2d};

/// Cells as rings of edges, while edges are removed.
struct Rings<'a> {
    mesh: &'a Mesh,
    next: Vec<u32>,
    previous: Vec<u32>,
    gone: Vec<bool>,
}

impl<'a> Rings<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let n = u32::try_from(mesh.edges.len()).expect("fewer than 2^32 edges");
        let next: Vec<u32> = (0..n).map(Mesh::next).collect();
        let previous = (0..n).map(|e| Mesh::next(Mesh::next(e))).collect();
        Self { mesh, next, previous, gone: vec![false; n as usize] }
    }

    fn start(&self, edge: u32) -> Point2 {
        self.mesh.vertices[self.mesh.edges[edge as usize].from as usize]
    }

    /// Whether the cell stays convex at both ends of `edge` if the edge is removed.
    fn convex_without(&self, edge: u32, twin: u32) -> bool {
        let corner = |before: u32, after: u32| {
            let (from, at, to) = (self.start(before), self.start(after), self.start(self.next[after as usize]));
            let turn = orient2d(from, at, to);
            // Straight on is convex; straight back is the tip of a line that ends inside the cell.
            turn > 0.0 || (turn == 0.0 && along(from, at, to))
        };
        let before = |e: u32| self.previous[e as usize];
        let after = |e: u32| self.next[e as usize];
        corner(before(edge), after(twin)) && corner(before(twin), after(edge))
    }

    fn remove(&mut self, edge: u32, twin: u32) {
        for (e, t) in [(edge, twin), (twin, edge)] {
            let (before, after) = (self.previous[e as usize], self.next[t as usize]);
            self.next[before as usize] = after;
            self.previous[after as usize] = before;
            self.gone[e as usize] = true;
        }
    }

    /// All edges of the cell that `edge` bounds, from `edge` on.
    fn ring(&self, edge: u32) -> Vec<u32> {
        let mut ring = vec![edge];
        let mut at = self.next[edge as usize];
        while at != edge {
            ring.push(at);
            at = self.next[at as usize];
        }
        ring
    }
}

/// Whether sight crosses the edge.
fn open(mesh: &Mesh, edge: u32) -> bool {
    let e = &mesh.edges[edge as usize];
    e.twin != OUTSIDE && e.line.is_none_or(|l| !l.opaque)
}

/// Merges triangles and builds the graph. With `seen_only`, cells from which no group can be seen are left out.
pub(crate) fn convex_cells(mesh: &Mesh, regions: &Regions, seen_only: bool) -> CellGraph<Planar> {
    let mut rings = Rings::new(mesh);
    let groups_of = |edge: u32| &regions.groups[regions.of_triangle[edge as usize / 3] as usize];
    for edge in by_length(mesh) {
        let twin = mesh.edges[edge as usize].twin;
        if groups_of(edge) == groups_of(twin) && rings.convex_without(edge, twin) {
            rings.remove(edge, twin);
        }
    }
    let keep = if seen_only { in_sight(mesh, regions) } else { vec![true; mesh.n_triangles()] };
    build(&rings, &keep, groups_of)
}

/// Open edges, one of each pair, longest first.
fn by_length(mesh: &Mesh) -> Vec<u32> {
    let mut edges: Vec<(f64, u32)> = (0u32..)
        .zip(&mesh.edges)
        .filter(|&(i, e)| e.twin != OUTSIDE && i < e.twin && open(mesh, i))
        .map(|(i, _)| {
            let (a, b) = mesh.ends(i);
            (a.distance_squared(b), i)
        })
        .collect();
    edges.sort_by(|p, q| q.0.total_cmp(&p.0).then(p.1.cmp(&q.1)));
    edges.into_iter().map(|(_, i)| i).collect()
}

/// Triangles that are joined by open edges with one that has a group.
fn in_sight(mesh: &Mesh, regions: &Regions) -> Vec<bool> {
    let labelled = |t: &usize| !regions.groups[regions.of_triangle[*t] as usize].is_empty();
    let mut stack: Vec<usize> = (0..mesh.n_triangles()).filter(labelled).collect();
    let mut keep = vec![false; mesh.n_triangles()];
    for &t in &stack {
        keep[t] = true;
    }
    while let Some(t) = stack.pop() {
        for edge in 3 * t..3 * t + 3 {
            let neighbour = mesh.edges[edge].twin as usize / 3;
            if open(mesh, edge as u32) && !keep[neighbour] {
                keep[neighbour] = true;
                stack.push(neighbour);
            }
        }
    }
    keep
}

fn build<'r>(rings: &Rings<'_>, keep: &[bool], groups_of: impl Fn(u32) -> &'r Vec<u32>) -> CellGraph<Planar> {
    let mesh = rings.mesh;
    let n = mesh.edges.len();
    let mut cell_of = vec![u32::MAX; n];
    let mut side_of = vec![0u32; n];
    let mut cells = Vec::new();
    let mut ordered = Vec::new();
    for edge in 0..u32::try_from(n).expect("fewer than 2^32 edges") {
        if rings.gone[edge as usize] || cell_of[edge as usize] != u32::MAX || !keep[edge as usize / 3] {
            continue;
        }
        let ring = from_corner(rings, rings.ring(edge));
        number_sides(rings, &ring, &mut side_of);
        let id = u32::try_from(cells.len()).expect("fewer than 2^32 cells");
        for &e in &ring {
            cell_of[e as usize] = id;
        }
        cells.push(ConvexCell2 { polygon: corners(rings, &ring), groups: groups_of(edge).clone() });
        ordered.push(ring);
    }
    let portals = portals(rings, &ordered, &cell_of, &side_of);
    CellGraph::new(cells, portals)
}

/// Whether the ring turns at the start of `edge`.
fn turns(rings: &Rings<'_>, edge: u32) -> bool {
    let (before, after) = (rings.previous[edge as usize], rings.next[edge as usize]);
    orient2d(rings.start(before), rings.start(edge), rings.start(after)) != 0.0
}

/// The ring, rotated to begin at a true corner.
fn from_corner(rings: &Rings<'_>, mut ring: Vec<u32>) -> Vec<u32> {
    let corner = ring.iter().position(|&e| turns(rings, e)).unwrap_or(0);
    ring.rotate_left(corner);
    ring
}

fn number_sides(rings: &Rings<'_>, ring: &[u32], side_of: &mut [u32]) {
    let mut side = 0;
    for (i, &e) in ring.iter().enumerate() {
        side += u32::from(i > 0 && turns(rings, e));
        side_of[e as usize] = side;
    }
}

/// The corners where the ring turns.
fn corners(rings: &Rings<'_>, ring: &[u32]) -> Vec<Point2> {
    ring.iter().filter(|&&e| turns(rings, e)).map(|&e| rings.start(e)).collect()
}

/// One portal for each run of open edges on one side of a cell towards one neighbour.
fn portals(rings: &Rings<'_>, ordered: &[Vec<u32>], cell_of: &[u32], side_of: &[u32]) -> Vec<Portal<Planar>> {
    let mesh = rings.mesh;
    let mut portals = Vec::new();
    for ring in ordered {
        let key = |e: u32| {
            let to = if open(mesh, e) { cell_of[mesh.edges[e as usize].twin as usize] } else { u32::MAX };
            (side_of[e as usize], to)
        };
        for run in ring.chunk_by(|&e, &f| key(e) == key(f)) {
            let (first, last) = (run[0], run[run.len() - 1]);
            let (cell, to) = (cell_of[first as usize], key(first).1);
            if to == u32::MAX || to < cell {
                continue;
            }
            let twin = mesh.edges[first as usize].twin;
            // The cell is on the left of the run, so a line that leaves it has the run's start on its right.
            let shape = Portal2 { left: rings.start(rings.next[last as usize]), right: rings.start(first) };
            let sides = [side_of[first as usize], side_of[twin as usize]];
            portals.push(Portal { cells: [CellId(cell), CellId(to)], sides, shape });
        }
    }
    portals
}

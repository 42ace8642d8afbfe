//! Worlds of convex cells, cut as map compilers cut them: by planes, into a tree whose leafs are empty or solid. The
//! empty leafs are the cells; the common part of two of them on a cut is a portal.
//!
//! Planes have integer normals, and all decisions are made in an order that does not depend on the machine.
//! Corners come from clipping in doubles, so that they carry the rounding errors that those of real maps carry.
//! Additions, products, quotients and square roots of doubles are the same everywhere, so the bytes are too.

mod brushes;
mod build;
mod families;
mod plane;
mod polytope;
mod quake_like;
mod random;
#[cfg(test)]
mod tests;

pub use brushes::{Brush, world_of_brushes};
pub use families::{
    corridor, corridor_sees, grazing, pillar_ring, separate_rooms, slivers, spiral_stairs, world_families,
};
pub use plane::WorldPlane;
pub use quake_like::{QuakeLikeOptions, quake_like};
pub use random::{BspWorldOptions, bsp_world};

use crate::rng::Rng;
use sightlines_cells::{CellGraph, CellId, Convex, Portal3};
use sightlines_geometry::{Aabb, Point3};

/// A node of the tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorldNode {
    /// The index of its plane.
    pub plane: usize,
    /// The parts in front of the plane, and behind it.
    pub children: [WorldChild; 2],
}

/// One side of a cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WorldChild {
    /// A node, by index.
    Node(usize),
    /// A leaf, by index.
    Leaf(usize),
}

/// A convex piece of the world.
#[derive(Debug, Clone, PartialEq)]
pub struct WorldLeaf {
    /// Its cell; none if it is solid.
    pub cell: Option<CellId>,
    /// The planes around it; they face outwards.
    pub planes: Vec<WorldPlane>,
    /// For each plane the face in it: its corners in order, counter-clockwise as seen from outside.
    pub faces: Vec<Vec<Point3>>,
}

/// Cells and portals, and the tree whose empty leafs they are. Outside the outermost leafs everything is solid.
#[derive(Debug, Clone, PartialEq)]
pub struct World {
    /// Cells are the empty leafs, in the order of leafs.
    pub graph: CellGraph<Convex>,
    /// The planes of the cuts.
    pub planes: Vec<WorldPlane>,
    /// The cuts, parents before children; none if there is only one leaf.
    pub nodes: Vec<WorldNode>,
    /// All leafs, at least one.
    pub leafs: Vec<WorldLeaf>,
}

impl WorldLeaf {
    /// The box around it.
    pub fn bounds(&self) -> Aabb<3> {
        self.faces.iter().flatten().fold(Aabb::EMPTY, |b, &p| b.with(p))
    }

    /// The depth of a point inside: its distance from the nearest plane around the leaf, negative outside.
    pub fn depth(&self, p: Point3) -> f64 {
        self.planes.iter().map(|plane| -plane.distance(p)).fold(f64::INFINITY, f64::min)
    }
}

impl World {
    /// The solid leafs.
    pub fn solids(&self) -> impl Iterator<Item = &WorldLeaf> {
        self.leafs.iter().filter(|leaf| leaf.cell.is_none())
    }

    /// The leaf of each cell. O(leafs).
    pub fn cells(&self) -> Vec<&WorldLeaf> {
        self.leafs.iter().filter(|leaf| leaf.cell.is_some()).collect()
    }

    /// The box around everything.
    pub fn bounds(&self) -> Aabb<3> {
        self.leafs.iter().flat_map(|leaf| leaf.faces.iter().flatten()).fold(Aabb::EMPTY, |b, &p| b.with(p))
    }

    /// The leaf that a point is in, by rounded distances; points on a cut are in front of it.
    pub fn leaf_at(&self, p: Point3) -> usize {
        let mut at = if self.nodes.is_empty() { WorldChild::Leaf(0) } else { WorldChild::Node(0) };
        loop {
            match at {
                WorldChild::Leaf(leaf) => return leaf,
                WorldChild::Node(node) => {
                    let WorldNode { plane, children } = self.nodes[node];
                    at = children[usize::from(self.planes[plane].distance(p) < 0.0)];
                }
            }
        }
    }

    /// The same world, translated. Corners are rounded where no double is the sum.
    #[must_use]
    pub fn moved(&self, by: Point3) -> Self {
        let plane = |p: &WorldPlane| {
            let n = p.normal.map(f64::from);
            WorldPlane { offset: p.offset + (n[0] * by[0] + n[1] * by[1] + n[2] * by[2]), ..*p }
        };
        self.transformed(plane, |p| [0, 1, 2].map(|k| p[k] + by[k]))
    }

    /// The same world, scaled: exact for powers of two.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let plane = |p: &WorldPlane| WorldPlane { offset: p.offset * factor, ..*p };
        self.transformed(plane, |p| p.map(|x| x * factor))
    }

    /// The world under a linear map with the rows of `matrix`: visibility stays the same. Exact for coordinates that
    /// are integers or fractions of a power of two, as far as doubles represent the result.
    ///
    /// # Panics
    /// If the determinant is not 1: normals would not stay integers, or outside would become inside.
    #[must_use]
    pub fn sheared(&self, matrix: [[i32; 3]; 3]) -> Self {
        let m = matrix;
        let minor = |i: usize, j: usize| {
            let (r, s, u, v) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            m[r][u] * m[s][v] - m[r][v] * m[s][u]
        };
        let determinant: i32 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
        assert!(determinant == 1, "the determinant of {m:?} is {determinant}, not 1");
        // Normals transform with the cofactors, which are the inverse's transpose.
        let plane = |p: &WorldPlane| {
            let normal = std::array::from_fn(|i| (0..3).map(|j| minor(i, j) * p.normal[j]).sum());
            WorldPlane { normal, offset: p.offset }
        };
        let point = |p: Point3| m.map(|row| (0..3).map(|k| f64::from(row[k]) * p[k]).sum());
        self.transformed(plane, point)
    }

    /// The same world with portals whose corners have moved independently by up to `amount` along each axis: the effect
    /// of rounding in a long chain of tools.
    #[must_use]
    pub fn jittered(&self, seed: u64, amount: f64) -> Self {
        let mut rng = Rng::new(seed, 0x6A17);
        let mut noise = move || f64::from(rng.between(-1000, 1000)) * (amount / 1000.0);
        let graph = with_corners(&self.graph, |p| p.map(|x| x + noise()));
        Self { graph, ..self.clone() }
    }

    fn transformed(&self, plane: impl Fn(&WorldPlane) -> WorldPlane, point: impl Fn(Point3) -> Point3) -> Self {
        let leaf = |leaf: &WorldLeaf| WorldLeaf {
            cell: leaf.cell,
            planes: leaf.planes.iter().map(&plane).collect(),
            faces: leaf.faces.iter().map(|face| face.iter().map(|&p| point(p)).collect()).collect(),
        };
        Self {
            graph: with_corners(&self.graph, &point),
            planes: self.planes.iter().map(&plane).collect(),
            nodes: self.nodes.clone(),
            leafs: self.leafs.iter().map(leaf).collect(),
        }
    }
}

/// The same cells, with portals that have other corners; portals that no longer have an area are left out.
fn with_corners(graph: &CellGraph<Convex>, mut point: impl FnMut(Point3) -> Point3) -> CellGraph<Convex> {
    let mut portals = Vec::with_capacity(graph.portals().len());
    for portal in graph.portals() {
        let corners: Vec<Point3> = portal.shape.corners().iter().map(|&p| point(p)).collect();
        portals.extend(Portal3::around(&corners).map(|shape| (portal.cells, shape)));
    }
    CellGraph::of_portals(graph.n_cells(), portals)
}

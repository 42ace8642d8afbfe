//! Cutting: the tree as it grows, and the portals between its leafs.

use super::plane::WorldPlane;
use super::polytope::Polytope;
use super::{World, WorldChild, WorldLeaf, WorldNode};
use sightlines_cells::{CellGraph, CellId, Portal3};
use sightlines_geometry::Point3;

/// A corner within this distance counts as on a plane, in scene units: far above the rounding errors of coordinates of
/// some thousand units (about 1e-12), far below anything that the generators build on purpose. It decides only which
/// slivers exist.
pub(super) const EPSILON: f64 = 1.0 / (1u64 << 30) as f64;

/// A growing tree of cuts.
#[derive(Debug)]
pub(super) struct Builder {
    planes: Vec<WorldPlane>,
    nodes: Vec<WorldNode>,
    /// The part of each node's plane inside the node.
    sections: Vec<Vec<Point3>>,
    leafs: Vec<(Polytope, bool)>,
}

impl Builder {
    /// Grows a whole tree from a convex region. `decide` determines what happens to a piece, given its data; a cut has
    /// to leave something on both sides.
    pub(super) fn grow<T>(region: Polytope, data: T, mut decide: impl FnMut(&Polytope, T) -> Decision<T>) -> World {
        let mut builder = Self { planes: Vec::new(), nodes: Vec::new(), sections: Vec::new(), leafs: Vec::new() };
        // Pieces wait with the child slot that will refer to them.
        let mut waiting = vec![(region, data, None)];
        while let Some((piece, data, parent)) = waiting.pop() {
            let child = match decide(&piece, data) {
                Decision::Leaf { is_solid } => {
                    builder.leafs.push((piece, is_solid));
                    WorldChild::Leaf(builder.leafs.len() - 1)
                }
                Decision::Cut { plane, halves: [front, back], data: [front_data, back_data] } => {
                    let node = builder.nodes.len();
                    let index = builder.planes.iter().position(|p| *p == plane).unwrap_or(builder.planes.len());
                    if index == builder.planes.len() {
                        builder.planes.push(plane);
                    }
                    // The children are filled in when they are made.
                    builder.nodes.push(WorldNode { plane: index, children: [WorldChild::Leaf(0); 2] });
                    let section = piece.section(&plane, EPSILON).expect("a plane that cuts has a section");
                    builder.sections.push(section);
                    waiting.push((back, back_data, Some((node, 1))));
                    waiting.push((front, front_data, Some((node, 0))));
                    WorldChild::Node(node)
                }
            };
            if let Some((node, side)) = parent {
                builder.nodes[node].children[side] = child;
            }
        }
        builder.finish()
    }

    fn finish(self) -> World {
        let mut n_cells = 0;
        let leafs: Vec<WorldLeaf> = self
            .leafs
            .iter()
            .map(|(piece, is_solid)| {
                let cell = (!is_solid).then_some(CellId(n_cells));
                n_cells += u32::from(!is_solid);
                let (planes, faces) = piece.faces.iter().cloned().unzip();
                WorldLeaf { cell, planes, faces }
            })
            .collect();
        let mut portals = Vec::new();
        for (node, section) in self.nodes.iter().zip(&self.sections) {
            let mut behind = Vec::new();
            self.sink(node.children[1], section.clone(), &mut behind);
            for (back, polygon) in behind {
                let Some(back) = leafs[back].cell else { continue };
                let mut both = Vec::new();
                self.sink(node.children[0], polygon, &mut both);
                for (front, polygon) in both {
                    let shape = leafs[front].cell.zip(Portal3::around(&polygon));
                    portals.extend(shape.map(|(front, shape)| ([back, front], shape)));
                }
            }
        }
        let graph = CellGraph::of_portals(n_cells as usize, portals);
        World { graph, planes: self.planes, nodes: self.nodes, leafs }
    }

    /// Cuts a polygon along the tree below `child`, into pieces with the leaf that contains each.
    fn sink(&self, child: WorldChild, polygon: Vec<Point3>, out: &mut Vec<(usize, Vec<Point3>)>) {
        let mut waiting = vec![(child, polygon)];
        while let Some((child, polygon)) = waiting.pop() {
            match child {
                WorldChild::Leaf(leaf) => out.push((leaf, polygon)),
                WorldChild::Node(node) => {
                    let WorldNode { plane, children } = self.nodes[node];
                    let halves = self.planes[plane].split(&polygon, EPSILON);
                    let pieces = children.into_iter().zip(halves).rev();
                    waiting.extend(pieces.filter_map(|(child, half)| Some((child, half?))));
                }
            }
        }
    }
}

/// What to do with a piece of the world.
pub(super) enum Decision<T> {
    /// It becomes a leaf.
    Leaf {
        /// Whether it is solid.
        is_solid: bool,
    },
    /// It is cut.
    Cut {
        /// The plane of the cut.
        plane: WorldPlane,
        /// The parts in front and behind.
        halves: [Polytope; 2],
        /// The data of each part.
        data: [T; 2],
    },
}

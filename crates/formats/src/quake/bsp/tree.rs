//! The tree of planes that a map's world was cut along, down to its leafs.

use super::layout::Layout;
use super::records::{By, Records};
use super::{Bsp, MAX_TREE_DEPTH};
use crate::bytes::{i32_at, u16_at, u32_at};
use crate::error::{Malformed, malformed};
use sightlines_geometry::Point3;

/// What is on a side of a plane of a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BspChild {
    /// A node of the tree, by its index in [`BspTree::nodes`].
    Node(u32),
    /// A leaf of the map.
    Leaf(u32),
}

/// A plane that divides what is left of space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BspNode {
    /// Its index in the file.
    pub index: u32,
    /// The plane's normal, of unit length as far as floats have it.
    pub normal: Point3,
    /// The plane's points `p` have `normal . p = distance`, in scene units.
    pub distance: f64,
    /// What is where `normal . p` is larger, and where it is smaller.
    pub children: [BspChild; 2],
}

impl BspNode {
    /// How far a point is above the plane, rounded: by some units in the last place of the largest product, which is less than 2^-44 of the largest
    /// coordinate.
    pub fn height(&self, p: Point3) -> f64 {
        (0..3).map(|k| self.normal[k] * p[k]).sum::<f64>() - self.distance
    }
}

/// The tree of the world, without those of doors and the like. Every node has one parent, before it in the list, and is
/// at most [`MAX_TREE_DEPTH`] steps below the root; every leaf that is named is there.
#[derive(Debug, Clone, PartialEq)]
pub struct BspTree {
    nodes: Vec<BspNode>,
    root: BspChild,
}

impl BspTree {
    /// The nodes, parents before children.
    pub fn nodes(&self) -> &[BspNode] {
        &self.nodes
    }

    /// Where the tree begins: node 0, or a leaf if nothing is cut.
    pub fn root(&self) -> BspChild {
        self.root
    }
}

impl Bsp {
    /// Reads the tree of the world. O(file).
    ///
    /// # Errors
    /// [`Malformed`] for lumps that are not a whole number of records, a plane, node or leaf that is not there, a plane that
    /// is none, a node that is reached twice, and a tree that is too deep.
    ///
    /// # Source
    /// As [`Bsp::parse`]. That children of version 29 are as many nodes as there are and count leafs from the other end of
    /// 16 bits is how engines read maps with more than 32767 nodes; for others it is the same as a sign.
    pub fn world_tree(&self) -> Result<BspTree, Malformed> {
        let layout = self.format().layout();
        let (planes, nodes) = (self.records(layout.planes)?, self.records(layout.nodes)?);
        let file = NodesOfFile { layout, planes, nodes, leafs: self.records(layout.leafs)? };
        let mut tree = Growing { nodes: Vec::new(), depths: Vec::new(), is_reached: vec![false; nodes.n()] };
        let model = self.world_model()?;
        let named = layout.model_root.map_or(0, |at| i64::from(i32_at(model, at)));
        let root = tree.add(&file, file.found(named, (layout.models.lump, 0))?, 0)?;
        let mut at = 0;
        while let Some(&BspNode { index, .. }) = tree.nodes.get(at) {
            for (side, child) in file.children(index).into_iter().enumerate() {
                let found = file.found(child, (layout.nodes.lump, index as usize))?;
                let child = tree.add(&file, found, tree.depths[at] + 1)?;
                tree.nodes[at].children[side] = child;
            }
            at += 1;
        }
        Ok(BspTree { nodes: tree.nodes, root })
    }

    pub(super) fn world_model(&self) -> Result<&[u8], Malformed> {
        let models = self.records(self.format().layout().models)?;
        models.iter().next().ok_or_else(|| malformed!("{}: there is no model 0", models.label()))
    }
}

/// A tree whose nodes are placed one after the other, breadth first.
struct Growing {
    nodes: Vec<BspNode>,
    /// How many steps each of them is below the root.
    depths: Vec<usize>,
    /// Which nodes of the file are among them.
    is_reached: Vec<bool>,
}

impl Growing {
    /// Puts a node of the file behind the others, with children that are still to come; returns it as one of the tree.
    fn add(&mut self, file: &NodesOfFile<'_>, found: BspChild, depth: usize) -> Result<BspChild, Malformed> {
        let index = match found {
            BspChild::Leaf(_) => return Ok(found),
            BspChild::Node(index) => index,
        };
        let nodes = || file.nodes.label();
        if std::mem::replace(&mut self.is_reached[index as usize], true) {
            return Err(malformed!("{}: node {index} is reached twice, so this is no tree", nodes()));
        }
        if depth >= MAX_TREE_DEPTH {
            let what = format_args!("{MAX_TREE_DEPTH} steps below the root, more than are followed");
            return Err(malformed!("{}: node {index} is {what}", nodes()));
        }
        let (normal, distance) = file.plane(index)?;
        self.nodes.push(BspNode { index, normal, distance, children: [BspChild::Leaf(0); 2] });
        self.depths.push(depth);
        Ok(BspChild::Node(self.nodes.len() as u32 - 1))
    }
}

struct NodesOfFile<'b> {
    layout: &'static Layout,
    planes: Records<'b>,
    nodes: Records<'b>,
    leafs: Records<'b>,
}

impl NodesOfFile<'_> {
    /// The children as numbers: nodes from 0, leafs from -1 downwards.
    fn children(&self, node: u32) -> [i64; 2] {
        let record = self.nodes.get(node as usize);
        [0, 1].map(|side| {
            if self.layout.short_children {
                let child = i64::from(u16_at(record, 4 + 2 * side));
                if child < self.nodes.n() as i64 { child } else { child - 0x1_0000 }
            } else {
                i64::from(i32_at(record, 4 + 4 * side))
            }
        })
    }

    fn plane(&self, node: u32) -> Result<(Point3, f64), Malformed> {
        let found = i64::from(u32_at(self.nodes.get(node as usize), 0));
        let plane = self.planes.named((self.nodes.lump, node as usize), found)?;
        plane_of(self.planes.get(plane)).ok_or_else(|| {
            let lump = self.planes.label();
            malformed!("{lump}: plane {plane} has no normal of unit length, or no finite distance")
        })
    }

    /// A child as the file has it, checked.
    fn found(&self, child: i64, by: By) -> Result<BspChild, Malformed> {
        match child {
            ..0 => Ok(BspChild::Leaf(self.leafs.named(by, -1 - child)? as u32)),
            _ => Ok(BspChild::Node(self.nodes.named(by, child)? as u32)),
        }
    }
}

/// The plane that a record begins with, of at least 16 bytes; `None` if that is none.
pub(super) fn plane_of(record: &[u8]) -> Option<(Point3, f64)> {
    let [x, y, z, distance]: [f64; 4] = std::array::from_fn(|k| f64::from(f32::from_bits(u32_at(record, 4 * k))));
    // A normal of any other length is not the result of rounding: floats have it to 1e-7, and the maps that were examined do.
    let length = (x * x + y * y + z * z).sqrt();
    ((length - 1.0).abs() <= 1.0 / 64.0 && distance.is_finite()).then_some(([x, y, z], distance))
}

//! The tree of planes that a map's world was cut along, down to its leafs.

use super::leaf::MODELS;
use super::{Bsp, BspError, BspFormat, MAX_TREE_DEPTH, i32_at, u16_at, u32_at};
use sightlines_geometry::Point3;

/// Index of the lump of planes, in all formats.
pub(super) const PLANES: usize = 1;
/// Bytes of a plane: normal and distance as floats, and which axis it is across.
const PLANE_LEN: usize = 20;
/// Where a model has the root of its tree: behind 9 floats, in all formats.
const MODEL_ROOT: usize = 36;

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
    /// [`BspError`] for lumps that are not a whole number of records, a plane, node or leaf that is not there, a plane that
    /// is none, a node that is reached twice, and a tree that is too deep.
    ///
    /// # Source
    /// As [`Bsp::parse`]. That children of version 29 are as many nodes as there are and count leafs from the other end of
    /// 16 bits is how engines read maps with more than 32767 nodes; for others it is the same as a sign.
    pub fn world_tree(&self) -> Result<BspTree, BspError> {
        let planes = self.records(PLANES, PLANE_LEN)?;
        let nodes = self.records(self.node_lump(), node_len(self.format()))?;
        let file = NodesOfFile { bsp: self, planes, nodes };
        let mut tree = Growing { nodes: Vec::new(), depths: Vec::new(), is_reached: vec![false; file.n_nodes()] };
        let named = i64::from(i32_at(self.world_model()?, MODEL_ROOT));
        let root = tree.add(&file, file.found(named, (self.model_lump(), 0))?, 0)?;
        let mut at = 0;
        while let Some(&BspNode { index, .. }) = tree.nodes.get(at) {
            for (side, child) in file.children(index).into_iter().enumerate() {
                let found = file.found(child, (self.node_lump(), index as usize))?;
                let child = tree.add(&file, found, tree.depths[at] + 1)?;
                tree.nodes[at].children[side] = child;
            }
            at += 1;
        }
        Ok(BspTree { nodes: tree.nodes, root })
    }

    /// The record of model 0, which is the world.
    pub(super) fn world_model(&self) -> Result<&[u8], BspError> {
        let (lump, len) = match self.format() {
            BspFormat::Quake2 => (self.model_lump(), 48),
            _ => (MODELS, super::leaf::MODEL_LEN),
        };
        let models = self.records(lump, len)?;
        models.get(..len).ok_or(BspError::NoModel { lump: self.format().lump_id(lump) })
    }

    fn node_lump(&self) -> usize {
        if self.format() == BspFormat::Quake2 { 4 } else { 5 }
    }

    fn model_lump(&self) -> usize {
        if self.format() == BspFormat::Quake2 { 13 } else { MODELS }
    }

    /// The bytes of a lump of records of `record` bytes.
    pub(super) fn records(&self, lump: usize, record: usize) -> Result<&[u8], BspError> {
        let bytes = self.lump_bytes(lump);
        let whole = bytes.len().is_multiple_of(record);
        let error = BspError::LumpLength { lump: self.format().lump_id(lump), len: bytes.len(), record };
        if whole { Ok(bytes) } else { Err(error) }
    }

    /// An index that a record of a lump names, if the other lump has so many records.
    pub(super) fn named(&self, by: (usize, usize), found: i64, of: usize, n: usize) -> Result<usize, BspError> {
        let index = usize::try_from(found).ok().filter(|&k| k < n);
        let (lump, of) = (self.format().lump_id(by.0), self.format().lump_id(of));
        index.ok_or(BspError::Reference { lump, record: by.1, found, of, n })
    }
}

/// Bytes of a node: the plane, two children, bounds, first face and number of faces.
const fn node_len(format: BspFormat) -> usize {
    match format {
        BspFormat::Bsp29 => 24,
        BspFormat::Bsp2 => 44,
        BspFormat::Bsp2Psb => 32,
        BspFormat::Quake2 => 28,
    }
}

/// A child as the file has it, checked.
enum Found {
    Node(u32),
    Leaf(u32),
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
    /// Puts a node behind the others, with children that are still to come.
    fn add(&mut self, file: &NodesOfFile<'_>, found: Found, depth: usize) -> Result<BspChild, BspError> {
        let index = match found {
            Found::Leaf(leaf) => return Ok(BspChild::Leaf(leaf)),
            Found::Node(index) => index,
        };
        let (lump, node) = (file.bsp.format().lump_id(file.bsp.node_lump()), index as usize);
        if std::mem::replace(&mut self.is_reached[node], true) {
            return Err(BspError::NodeTwice { lump, node });
        }
        if depth >= MAX_TREE_DEPTH {
            return Err(BspError::TreeDepth { lump, node });
        }
        let (normal, distance) = file.plane(index)?;
        self.nodes.push(BspNode { index, normal, distance, children: [BspChild::Leaf(0); 2] });
        self.depths.push(depth);
        Ok(BspChild::Node(self.nodes.len() as u32 - 1))
    }
}

/// The lumps that a tree is read from.
struct NodesOfFile<'b> {
    bsp: &'b Bsp,
    planes: &'b [u8],
    nodes: &'b [u8],
}

impl NodesOfFile<'_> {
    fn n_nodes(&self) -> usize {
        self.nodes.len() / node_len(self.bsp.format())
    }

    fn node(&self, node: u32) -> &[u8] {
        let len = node_len(self.bsp.format());
        &self.nodes[node as usize * len..][..len]
    }

    /// The children as numbers: nodes from 0, leafs from -1 downwards.
    fn children(&self, node: u32) -> [i64; 2] {
        let record = self.node(node);
        [0, 1].map(|side| match self.bsp.format() {
            BspFormat::Bsp29 => {
                let child = i64::from(u16_at(record, 4 + 2 * side));
                if child < self.n_nodes() as i64 { child } else { child - 0x1_0000 }
            }
            _ => i64::from(i32_at(record, 4 + 4 * side)),
        })
    }

    /// The normal and the distance of a node's plane.
    fn plane(&self, node: u32) -> Result<(Point3, f64), BspError> {
        let by = (self.bsp.node_lump(), node as usize);
        let found = i64::from(u32_at(self.node(node), 0));
        let plane = self.bsp.named(by, found, PLANES, self.planes.len() / PLANE_LEN)?;
        let numbers: [f64; 4] =
            std::array::from_fn(|k| f64::from(f32::from_bits(u32_at(self.planes, PLANE_LEN * plane + 4 * k))));
        let [x, y, z, distance] = numbers;
        // A normal of any other length is not the result of rounding: floats have it to 1e-7, and the maps that were examined do.
        let length = (x * x + y * y + z * z).sqrt();
        if (length - 1.0).abs() <= 1.0 / 64.0 && distance.is_finite() {
            Ok(([x, y, z], distance))
        } else {
            Err(BspError::NotAPlane { lump: self.bsp.format().lump_id(PLANES), plane })
        }
    }

    fn found(&self, child: i64, by: (usize, usize)) -> Result<Found, BspError> {
        if child < 0 {
            let (leafs, n) = (self.bsp.format().leaf_lump(), self.bsp.leafs().len());
            Ok(Found::Leaf(self.bsp.named(by, -1 - child, leafs, n)? as u32))
        } else {
            Ok(Found::Node(self.bsp.named(by, child, self.bsp.node_lump(), self.n_nodes())? as u32))
        }
    }
}

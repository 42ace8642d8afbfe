//! Trees of planes.

use crate::Plane;

/// What is on a side of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Child {
    /// A node, by its place in the list.
    Node(u32),
    /// A region that nothing divides further, with any number: several regions may have the same.
    Leaf(u32),
}

/// A plane that divides what is left of space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node {
    /// Its front is the side that the normal points to.
    pub plane: Plane,
    /// In front, and behind.
    pub children: [Child; 2],
}

/// A region below a tree: the side of a node on which a leaf is. Convex, and open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Region {
    /// The node.
    pub node: u32,
    /// 0 in front of it, 1 behind.
    pub side: u8,
    /// The number of the leaf there.
    pub leaf: u32,
}

/// Why nodes are no tree.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TreeError {
    /// A normal of zeros, or a number that is neither 0 nor from 1e-60 to 1e60.
    #[error("node {node}: its plane has no normal, or numbers that are too small or too large")]
    Plane {
        /// The node.
        node: usize,
    },
    /// A node is not behind its parent in the list, or is not there, or has two parents.
    #[error("node {node}: its child {child} is not a later node with no other parent")]
    Child {
        /// The node.
        node: usize,
        /// What it names.
        child: u32,
    },
    /// A node other than the first is nobody's child.
    #[error("node {node} has no parent")]
    Orphan {
        /// The node.
        node: usize,
    },
}

/// Nodes, parents before children: the first is the root, and each other has one parent. Without nodes, nothing is divided.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    nodes: Vec<Node>,
    /// For each node its parent, and the side that it is on there.
    parents: Vec<Option<(u32, usize)>>,
}

impl Tree {
    /// Checks that nodes are a tree. O(nodes).
    ///
    /// # Errors
    /// [`TreeError`] with the first node that is wrong.
    pub fn new(nodes: Vec<Node>) -> Result<Self, TreeError> {
        let mut parents: Vec<Option<(u32, usize)>> = vec![None; nodes.len()];
        for (at, node) in nodes.iter().enumerate() {
            if !node.plane.is_sound() {
                return Err(TreeError::Plane { node: at });
            }
            for (side, child) in node.children.into_iter().enumerate() {
                let Child::Node(child) = child else { continue };
                match parents.get_mut(child as usize) {
                    Some(parent @ None) if child as usize > at => *parent = Some((at as u32, side)),
                    _ => return Err(TreeError::Child { node: at, child }),
                }
            }
        }
        match parents.iter().skip(1).position(Option::is_none) {
            Some(before) => Err(TreeError::Orphan { node: before + 1 }),
            None => Ok(Self { nodes, parents }),
        }
    }

    /// The nodes.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The nodes above one, nearest first, each with the side that it is on.
    pub(crate) fn above(&self, node: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let mut at = node;
        std::iter::from_fn(move || {
            let (parent, side) = *self.parents.get(at)?.as_ref()?;
            at = parent as usize;
            Some((at, side))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(front: Child, back: Child) -> Node {
        Node { plane: Plane { normal: [1.0, 0.0, 0.0], distance: 0.0 }, children: [front, back] }
    }

    #[test]
    fn nodes_are_checked() {
        use Child::{Leaf, Node as Below};
        let of =
            |nodes: &[Node]| Tree::new(nodes.to_vec()).map(|tree| tree.above(nodes.len().saturating_sub(1)).count());
        assert_eq!(of(&[]), Ok(0));
        assert_eq!(of(&[node(Leaf(0), Below(1)), node(Below(2), Leaf(1)), node(Leaf(2), Leaf(2))]), Ok(2));
        assert_eq!(of(&[node(Below(0), Leaf(0))]), Err(TreeError::Child { node: 0, child: 0 }));
        assert_eq!(of(&[node(Below(1), Leaf(0))]), Err(TreeError::Child { node: 0, child: 1 }));
        let twice = [node(Below(1), Below(1)), node(Leaf(0), Leaf(0))];
        assert_eq!(of(&twice), Err(TreeError::Child { node: 0, child: 1 }));
        assert_eq!(of(&[node(Leaf(0), Leaf(0)), node(Leaf(0), Leaf(0))]), Err(TreeError::Orphan { node: 1 }));
        let mut bad = [node(Leaf(0), Leaf(0))];
        bad[0].plane.normal = [0.0; 3];
        assert_eq!(of(&bad), Err(TreeError::Plane { node: 0 }));
    }
}

//! Trees of planes: nodes, what lies in them, and walks in the order of an eye.

use super::Order;
use crate::counters::Counters;
use crate::face_mask::FaceMask;
use crate::faces::Faces;
use crate::fragment::Fragment;
use crate::plane::InputPlane;
use sightlines_geometry::Point3;
use std::ops::{ControlFlow, Range};

/// No node.
const NONE: u32 = u32::MAX;

/// A child of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Child {
    /// What lies on the positive side of its plane.
    Front,
    /// What lies on the negative side.
    Behind,
}

/// Where a node hangs; nothing for the root.
pub(crate) type Slot = Option<(u32, Child)>;

/// A node: a plane and what lies in it, or a leaf and what lies there.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    /// None in a leaf.
    plane: Option<InputPlane>,
    parent: u32,
    /// In front and behind.
    children: [u32; 2],
    own: Range<u32>,
}

/// Nodes, parents before their children, and the fragments in them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tree {
    nodes: Vec<Node>,
    fragments: Vec<Fragment>,
    depths: Vec<u32>,
    /// For each face where in `holders` the nodes begin that hold a part of it; and the end of the last.
    first_holder: Vec<u32>,
    holders: Vec<u32>,
}

/// How far a walk went.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Walked {
    /// Nodes that hold something that may be drawn, or have such nodes below.
    pub(crate) visited: u64,
    /// Children of those that do not, and were not entered.
    pub(crate) skipped: u64,
}

impl Walked {
    /// Adds to the tests of a picture.
    pub(crate) fn count(self, counters: &mut Counters) {
        counters.tested("nodes visited", self.visited);
        counters.tested("subtrees skipped", self.skipped);
    }
}

impl Tree {
    /// Hangs in a node. The fragments keep their order.
    pub(crate) fn add(
        &mut self,
        place: Slot,
        plane: Option<InputPlane>,
        own: impl IntoIterator<Item = Fragment>,
    ) -> u32 {
        let id = self.nodes.len() as u32;
        let start = self.fragments.len() as u32;
        self.fragments.extend(own);
        let parent = place.map_or(NONE, |(parent, _)| parent);
        let own = start..self.fragments.len() as u32;
        self.nodes.push(Node { plane, parent, children: [NONE; 2], own });
        self.depths.push(place.map_or(1, |(parent, _)| self.depths[parent as usize] + 1));
        if let Some((parent, child)) = place {
            self.nodes[parent as usize].children[child as usize] = id;
        }
        id
    }

    /// Notes for each face which nodes hold it. To be called once, when all nodes are there.
    pub(crate) fn finish(&mut self, n_faces: usize) {
        let mut first = vec![0u32; n_faces + 1];
        self.fragments.iter().for_each(|f| first[f.face() as usize + 1] += 1);
        for k in 0..n_faces {
            first[k + 1] += first[k];
        }
        let mut next = first.clone();
        self.holders = vec![0; self.fragments.len()];
        for (id, node) in (0u32..).zip(&self.nodes) {
            for fragment in &self.fragments[node.own.start as usize..node.own.end as usize] {
                let at = &mut next[fragment.face() as usize];
                self.holders[*at as usize] = id;
                *at += 1;
            }
        }
        self.first_holder = first;
    }

    /// Number of nodes.
    pub(crate) fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// Number of fragments.
    pub(crate) fn n_fragments(&self) -> usize {
        self.fragments.len()
    }

    /// Number of faces that it was made for.
    pub(crate) fn n_faces(&self) -> usize {
        self.first_holder.len().saturating_sub(1)
    }

    /// Nodes on the longest way down.
    pub(crate) fn depth(&self) -> usize {
        self.depths.iter().max().map_or(0, |&d| d as usize)
    }

    /// The plane of a node, and its children behind and in front of it.
    pub(crate) fn parts(&self, node: u32) -> (Option<InputPlane>, [Option<u32>; 2]) {
        let Node { plane, children: [front, behind], .. } = &self.nodes[node as usize];
        (*plane, [*behind, *front].map(|child| (child != NONE).then_some(child)))
    }

    /// What lies in a node.
    pub(crate) fn own(&self, node: u32) -> &[Fragment] {
        let own = &self.nodes[node as usize].own;
        &self.fragments[own.start as usize..own.end as usize]
    }

    /// Whether a node has no plane.
    pub(crate) fn is_leaf(&self, node: u32) -> bool {
        self.nodes[node as usize].plane.is_none()
    }

    /// For each node whether a chosen face lies in it or below it. As Quake does it, from the faces up until a node that is marked already.
    fn marks(&self, chosen: &FaceMask) -> Vec<bool> {
        let mut marked = vec![false; self.nodes.len()];
        for face in chosen.iter() {
            let holders = self.first_holder[face as usize] as usize..self.first_holder[face as usize + 1] as usize;
            for &holder in &self.holders[holders] {
                let mut node = holder;
                while node != NONE && !marked[node as usize] {
                    marked[node as usize] = true;
                    node = self.nodes[node as usize].parent;
                }
            }
        }
        marked
    }

    /// Calls `at` for the nodes in the order of an eye, without those that hold nothing chosen, nor below; and without planes that
    /// hold the eye, of which nothing is seen; until it says that it has enough.
    pub(crate) fn walk(
        &self,
        faces: &Faces,
        eye: Point3,
        order: Order,
        chosen: &FaceMask,
        mut at: impl FnMut(u32) -> ControlFlow<()>,
    ) -> Walked {
        let mut walked = Walked::default();
        let marked = self.marks(chosen);
        // Nodes to come, the next one last; whether its farther (or nearer) child has been sent before it.
        let mut stack = Vec::new();
        if !self.nodes.is_empty() {
            stack.push((0, false));
        }
        while let Some((id, is_open)) = stack.pop() {
            if is_open {
                if at(id).is_break() {
                    break;
                }
                continue;
            }
            if !marked[id as usize] {
                walked.skipped += 1;
                continue;
            }
            walked.visited += 1;
            let node = &self.nodes[id as usize];
            let Some(plane) = node.plane else {
                if at(id).is_break() {
                    break;
                }
                continue;
            };
            let side = plane.side(faces, eye);
            let [front, behind] = node.children;
            let (first, last) =
                if (side < 0) == (order == Order::BackToFront) { (front, behind) } else { (behind, front) };
            if last != NONE {
                stack.push((last, false));
            }
            if side != 0 {
                stack.push((id, true));
            }
            if first != NONE {
                stack.push((first, false));
            }
        }
        walked
    }
}

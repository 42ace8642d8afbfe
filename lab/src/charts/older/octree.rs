//! Culling by the view volume: boxes in a quadtree or octree against one view, and what that knows of whole cells.

use super::{Opening, PortalGraph};
use sightlines::geometry::Aabb;
use sightlines::pvs::BitMatrix;

/// Boxes in a tree whose nodes are halved along the first `N` axes: a quadtree with 2, an octree with 3.
///
/// A box that fits into no half stays in the node above. Source: Clark, CACM 19, 1976, for the hierarchy of boxes.
#[derive(Debug, Clone)]
pub struct BoxTreeN<const N: usize> {
    nodes: Vec<Node>,
    boxes: Vec<Aabb<3>>,
}

#[derive(Debug, Clone)]
struct Node {
    /// Around the boxes of the node and of those below.
    around: Aabb<3>,
    boxes: Vec<u32>,
    children: Vec<usize>,
}

/// Nodes are halved down to so many boxes.
const FEW: usize = 4;
/// And no deeper than so.
const DEEPEST: u32 = 24;

impl<const N: usize> BoxTreeN<N> {
    /// O(n log n) for boxes that are small beside the distances between them.
    pub fn build(boxes: Vec<Aabb<3>>) -> Self {
        let mut tree = Self { nodes: Vec::new(), boxes };
        let all: Vec<u32> = (0..tree.boxes.len() as u32).collect();
        let around = Aabb::around(tree.boxes.iter().flat_map(|b| [b.min, b.max]));
        tree.add(all, around, DEEPEST);
        tree
    }

    fn add(&mut self, ids: Vec<u32>, region: Aabb<3>, deeper: u32) -> usize {
        let around = Aabb::around(ids.iter().flat_map(|&i| [self.boxes[i as usize].min, self.boxes[i as usize].max]));
        let place = self.nodes.len();
        self.nodes.push(Node { around, boxes: Vec::new(), children: Vec::new() });
        if ids.len() <= FEW || deeper == 0 {
            self.nodes[place].boxes = ids;
            return place;
        }
        let middle = [0, 1, 2].map(|k| f64::midpoint(region.min[k], region.max[k]));
        let mut parts: Vec<Vec<u32>> = vec![Vec::new(); 1 << N];
        for id in ids {
            let b = &self.boxes[id as usize];
            let half =
                |k: usize| if b.max[k] <= middle[k] { Some(0) } else { (b.min[k] >= middle[k]).then_some(1 << k) };
            match (0..N).try_fold(0, |sum, k| Some(sum + half(k)?)) {
                Some(part) => parts[part].push(id),
                None => self.nodes[place].boxes.push(id),
            }
        }
        for (part, ids) in parts.into_iter().enumerate().filter(|(_, ids)| !ids.is_empty()) {
            let mut region = region;
            for (k, &at) in middle.iter().enumerate().take(N) {
                if part >> k & 1 == 1 {
                    region.min[k] = at;
                } else {
                    region.max[k] = at;
                }
            }
            let child = self.add(ids, region, deeper - 1);
            self.nodes[place].children.push(child);
        }
        place
    }

    /// Adds the boxes that `may_meet` lets through, and whose nodes it lets through, to `found`. It is called for boxes
    /// and for boxes around them, and must let through every box around one that it lets through. O(nodes) at worst.
    pub fn cull(&self, may_meet: impl Fn(&Aabb<3>) -> bool, found: &mut Vec<u32>) {
        let mut next = vec![0];
        while let Some(node) = next.pop().map(|place: usize| &self.nodes[place]) {
            if node.around.is_empty() || !may_meet(&node.around) {
                continue;
            }
            found.extend(node.boxes.iter().copied().filter(|&i| may_meet(&self.boxes[i as usize])));
            next.extend(&node.children);
        }
    }
}

/// What culling by view volumes says about whole cells, cells by cells: eyes anywhere in a cell, looking anywhere, have
/// all of space in their views, so every cell that can be reached at all counts as visible. O(cells²) bits.
pub fn connected<O: Opening>(graph: &PortalGraph<O>) -> BitMatrix {
    let n = graph.n_cells();
    let mut seen = BitMatrix::identity(n);
    let mut is_done = vec![false; n];
    for first in 0..n {
        if is_done[first] {
            continue;
        }
        let mut part = vec![first];
        is_done[first] = true;
        let mut k = 0;
        while let Some(&cell) = part.get(k) {
            for edge in graph.out_of(cell) {
                if !std::mem::replace(&mut is_done[edge.to], true) {
                    part.push(edge.to);
                }
            }
            k += 1;
        }
        let row = {
            let mut row = BitMatrix::new(1, n);
            part.iter().for_each(|&cell| row.set(0, cell, true));
            row
        };
        part.iter().for_each(|&cell| seen.row_mut(cell).copy_from_slice(row.row(0)));
    }
    seen
}

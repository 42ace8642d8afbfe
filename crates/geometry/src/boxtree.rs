//! A tree of boxes: many boxes, so arranged that those near a line or a box are found quickly.

use crate::Aabb;

/// A node of a [`BoxTree`]: the boxes of a contiguous range of [`BoxTree::order`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxNode<const D: usize> {
    /// Around all of its boxes.
    pub bounds: Aabb<D>,
    /// Its boxes are `order()[start..end]`.
    pub start: u32,
    /// One past the last.
    pub end: u32,
    /// The second child; 0 for a leaf. The first child is the next node.
    second: u32,
    /// The node after all of its descendants.
    past: u32,
}

impl<const D: usize> BoxNode<D> {
    /// Whether it has no children.
    pub const fn is_leaf(&self) -> bool {
        self.second == 0
    }

    /// Number of boxes.
    pub const fn len(&self) -> usize {
        (self.end - self.start) as usize
    }

    /// Whether it has no boxes; only the root of an empty tree has none.
    pub const fn is_empty(&self) -> bool {
        self.start == self.end
    }
}

/// A binary tree of boxes, cut where the surfaces of the halves, weighted by their numbers, are least.
///
/// Deterministic: equal boxes in equal order give an equal tree.
///
/// Source: Goldsmith and Salmon, IEEE CG&A 7(5), 1987, for the cost.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxTree<const D: usize> {
    nodes: Vec<BoxNode<D>>,
    order: Vec<u32>,
}

fn union<const D: usize>(a: &Aabb<D>, b: &Aabb<D>) -> Aabb<D> {
    Aabb { min: std::array::from_fn(|k| a.min[k].min(b.min[k])), max: std::array::from_fn(|k| a.max[k].max(b.max[k])) }
}

/// What building needs: the boxes sorted along each axis once, and kept so within each node.
#[derive(Debug)]
struct Work<const D: usize> {
    sorted: [Vec<u32>; D],
    costs: Vec<f64>,
    is_first: Vec<bool>,
    second: Vec<u32>,
}

impl<const D: usize> Work<D> {
    /// Brings those that `order` has from `start` to before `middle` before the others, along each axis, and changes no order else.
    fn part(&mut self, order: &[u32], start: usize, middle: usize, end: usize) {
        order[start..end].iter().enumerate().for_each(|(k, &i)| self.is_first[i as usize] = start + k < middle);
        for sorted in &mut self.sorted {
            self.second.clear();
            let mut to = start;
            for k in start..end {
                let i = sorted[k];
                if self.is_first[i as usize] {
                    sorted[to] = i;
                    to += 1;
                } else {
                    self.second.push(i);
                }
            }
            sorted[to..end].copy_from_slice(&self.second);
        }
    }
}

impl<const D: usize> BoxTree<D> {
    /// Builds the tree of `boxes`, with at most `per_leaf` boxes in a leaf. O(n log n).
    ///
    /// # Panics
    /// If `per_leaf` is 0.
    pub fn build(boxes: &[Aabb<D>], per_leaf: usize) -> Self {
        assert!(per_leaf > 0, "a leaf holds something");
        let n = boxes.len();
        let sorted = std::array::from_fn(|axis| {
            let mut ids: Vec<u32> = (0..n as u32).collect();
            let key =
                |i: u32| (boxes[i as usize].min[axis] + boxes[i as usize].max[axis], boxes[i as usize].min[axis], i);
            ids.sort_unstable_by(|&a, &b| {
                let (a, b) = (key(a), key(b));
                a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2))
            });
            ids
        });
        let mut work = Work { sorted, costs: vec![0.0; n], is_first: vec![false; n], second: Vec::with_capacity(n) };
        let mut tree = Self { nodes: Vec::new(), order: (0..n as u32).collect() };
        tree.split(boxes, per_leaf, 0, n, &mut work);
        tree
    }

    fn split(&mut self, boxes: &[Aabb<D>], per_leaf: usize, start: usize, end: usize, work: &mut Work<D>) {
        let of = |i: u32| boxes[i as usize];
        let bounds = self.order[start..end].iter().fold(Aabb::EMPTY, |all, &i| union(&all, &of(i)));
        let node = self.nodes.len();
        self.nodes.push(BoxNode { bounds, start: start as u32, end: end as u32, second: 0, past: node as u32 + 1 });
        if end - start <= per_leaf {
            return;
        }
        // The smaller half has at least a sixteenth, so the depth is at most logarithmic.
        let (middle, least) = (start + (end - start) / 2, ((end - start) / 16).max(1));
        let mut best = (f64::INFINITY, usize::MAX, 0, middle);
        for axis in 0..D {
            let sorted = &work.sorted[axis][start..end];
            let mut all = Aabb::EMPTY;
            for (n, (cost, &i)) in (1u32..).zip(work.costs[start..end].iter_mut().zip(sorted)) {
                all = union(&all, &of(i));
                *cost = all.half_surface() * f64::from(n);
            }
            let mut all = Aabb::EMPTY;
            for k in (start + 1..end).rev() {
                all = union(&all, &of(work.sorted[axis][k]));
                let cost = work.costs[k - 1] + all.half_surface() * (end - k) as f64;
                let off = k.abs_diff(middle);
                if k >= start + least && k + least <= end && (cost, off) < (best.0, best.1) {
                    best = (cost, off, axis, k);
                }
            }
        }
        let (_, _, axis, middle) = best;
        self.order[start..end].copy_from_slice(&work.sorted[axis][start..end]);
        work.part(&self.order, start, middle, end);
        self.split(boxes, per_leaf, start, middle, work);
        self.nodes[node].second = self.nodes.len() as u32;
        self.split(boxes, per_leaf, middle, end, work);
        self.nodes[node].past = self.nodes.len() as u32;
    }

    /// The nodes; the first is the root, which is there even without boxes.
    pub fn nodes(&self) -> &[BoxNode<D>] {
        &self.nodes
    }

    /// The indices of all boxes, in the order of the leaves.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// The children of a node that is not a leaf.
    #[inline]
    pub fn children(&self, node: u32) -> [u32; 2] {
        debug_assert!(!self.nodes[node as usize].is_leaf(), "leaves have no children");
        [node + 1, self.nodes[node as usize].second]
    }

    /// Visits the boxes of all leaves that are reached through nodes which `enter` accepts.
    #[inline]
    pub fn visit(&self, mut enter: impl FnMut(&Aabb<D>) -> bool, mut each: impl FnMut(u32)) {
        // The nodes of a subtree follow each other: what is not entered is skipped to `past`.
        let mut n = 0;
        while let Some(node) = self.nodes.get(n) {
            if !enter(&node.bounds) {
                n = node.past as usize;
                continue;
            }
            if node.is_leaf() {
                self.order[node.start as usize..node.end as usize].iter().for_each(|&i| each(i));
            }
            n += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn boxes() -> impl Strategy<Value = Vec<Aabb<3>>> {
        let corner = || [-4i32..5, -4i32..5, -4i32..5].prop_map(|p| p.map(f64::from));
        let one = (corner(), [0i32..4, 0i32..4, 0i32..4])
            .prop_map(|(min, size)| Aabb { min, max: std::array::from_fn(|k| min[k] + f64::from(size[k])) });
        prop::collection::vec(one, 0..40)
    }

    fn touch(a: &Aabb<3>, b: &Aabb<3>) -> bool {
        (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
    }

    proptest! {
        /// Invariant: a visit finds exactly what one by one is found.
        #[test]
        fn a_visit_misses_nothing(boxes in boxes(), at in boxes(), per_leaf in 1usize..4) {
            let tree = BoxTree::build(&boxes, per_leaf);
            let mut order = tree.order().to_vec();
            order.sort_unstable();
            prop_assert_eq!(order, (0..boxes.len() as u32).collect::<Vec<_>>());
            for probe in &at {
                let mut found = Vec::new();
                tree.visit(|b| touch(b, probe), |i| if touch(&boxes[i as usize], probe) { found.push(i) });
                found.sort_unstable();
                let all = (0..boxes.len() as u32).filter(|&i| touch(&boxes[i as usize], probe));
                prop_assert_eq!(found, all.collect::<Vec<_>>());
            }
        }

        /// Invariant: nodes hold what their children hold, children come after their parents, and leaves
        /// are no larger than asked for.
        #[test]
        fn nodes_nest(boxes in boxes(), per_leaf in 1usize..4) {
            let tree = BoxTree::build(&boxes, per_leaf);
            for (n, node) in (0u32..).zip(tree.nodes()) {
                if node.is_leaf() {
                    prop_assert!(node.len() <= per_leaf);
                    continue;
                }
                let [a, b] = tree.children(n).map(|c| tree.nodes()[c as usize]);
                prop_assert_eq!((a.start, a.end, b.end), (node.start, b.start, node.end));
                prop_assert!(!a.is_empty() && !b.is_empty());
                prop_assert_eq!(union(&a.bounds, &b.bounds), node.bounds);
            }
        }
    }
}

//! Occludees: objects made of triangles, in trees that are tested top-down.

use crate::Umbra;
use sightlines_geometry::{Aabb, BoxTree, Point3};

/// Triangles in a leaf of an object's tree: they are tested one by one only if their box is not hidden.
const PER_LEAF: usize = 4;

/// Objects as occludees: a tree over their boxes, and for each object a tree over its triangles.
///
/// A node is tested with its box first; nodes whose box is hidden are not entered. An object is hidden if all of its
/// triangles are, so the first visible triangle ends the search in it.
#[derive(Debug, Clone)]
pub struct Occludees {
    objects: Vec<Object>,
    tree: BoxTree<3>,
}

#[derive(Debug, Clone)]
struct Object {
    triangles: Vec<[Point3; 3]>,
    tree: BoxTree<3>,
}

/// Numbers of queries.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct QueryCounts {
    /// Boxes of groups of objects.
    pub groups: u64,
    /// Boxes of objects and of parts of objects.
    pub boxes: u64,
    /// Single triangles.
    pub triangles: u64,
}

impl std::ops::Add for QueryCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            groups: self.groups + other.groups,
            boxes: self.boxes + other.boxes,
            triangles: self.triangles + other.triangles,
        }
    }
}

impl Occludees {
    /// Objects by their triangles. An object without triangles is hidden from everywhere. O(n log² n).
    pub fn new(objects: Vec<Vec<[Point3; 3]>>) -> Self {
        let objects: Vec<Object> = objects
            .into_iter()
            .map(|triangles| {
                let boxes: Vec<Aabb<3>> = triangles.iter().map(|t| Aabb::around(*t)).collect();
                Object { tree: BoxTree::build(&boxes, PER_LEAF), triangles }
            })
            .collect();
        let boxes: Vec<Aabb<3>> = objects.iter().map(|o| o.tree.nodes()[0].bounds).collect();
        // An object without triangles has no box; its position does not matter.
        let boxes: Vec<Aabb<3>> =
            boxes.iter().map(|b| if b.is_empty() { Aabb { min: [0.0; 3], max: [0.0; 3] } } else { *b }).collect();
        Self { tree: BoxTree::build(&boxes, 1), objects }
    }

    /// Number of objects.
    pub fn len(&self) -> usize {
        self.objects.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.objects.is_empty()
    }

    /// Box around an object; empty if it has no triangles.
    pub fn bounds(&self, object: usize) -> &Aabb<3> {
        &self.objects[object].tree.nodes()[0].bounds
    }

    /// The triangles of an object.
    pub fn triangles(&self, object: usize) -> &[[Point3; 3]] {
        &self.objects[object].triangles
    }

    /// Finds the objects that `umbra` does not prove hidden: sets `visible` for them, among the `candidates`; all
    /// others are left unchanged.
    ///
    /// # Panics
    /// If the lists are shorter than the objects.
    pub fn see(&self, umbra: &mut dyn Umbra, candidates: &[bool], visible: &mut [bool]) -> QueryCounts {
        let mut counts = QueryCounts::default();
        if !self.is_empty() {
            self.see_node(0, umbra, candidates, visible, &mut counts);
        }
        counts
    }

    fn see_node(
        &self,
        n: u32,
        umbra: &mut dyn Umbra,
        candidates: &[bool],
        visible: &mut [bool],
        counts: &mut QueryCounts,
    ) {
        let node = &self.tree.nodes()[n as usize];
        let order = &self.tree.order()[node.start as usize..node.end as usize];
        if order.iter().all(|&i| !candidates[i as usize]) {
            return;
        }
        if let &[i] = order {
            visible[i as usize] = self.objects[i as usize].is_seen(umbra, counts);
            return;
        }
        counts.groups += 1;
        if umbra.hides(&node.bounds) {
            order.iter().filter(|&&i| candidates[i as usize]).for_each(|&i| visible[i as usize] = false);
            return;
        }
        for child in self.tree.children(n) {
            self.see_node(child, umbra, candidates, visible, counts);
        }
    }
}

impl Object {
    /// Whether any triangle is not proven hidden.
    fn is_seen(&self, umbra: &mut dyn Umbra, counts: &mut QueryCounts) -> bool {
        !self.triangles.is_empty() && self.is_seen_at(0, umbra, counts)
    }

    fn is_seen_at(&self, n: u32, umbra: &mut dyn Umbra, counts: &mut QueryCounts) -> bool {
        let node = &self.tree.nodes()[n as usize];
        counts.boxes += 1;
        if umbra.hides(&node.bounds) {
            return false;
        }
        if !node.is_leaf() {
            return self.tree.children(n).into_iter().any(|child| self.is_seen_at(child, umbra, counts));
        }
        self.tree.order()[node.start as usize..node.end as usize].iter().any(|&i| {
            counts.triangles += 1;
            !umbra.hides_points(&self.triangles[i as usize])
        })
    }
}

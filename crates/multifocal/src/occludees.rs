//! Occludees: objects made of triangles, in trees that are tested top-down.

use crate::{Umbra, Volume};
use sightlines_geometry::vector::{length, normal};
use sightlines_geometry::{Aabb, BoxTree, Point3, orient3d};

/// Triangles in a leaf of an object's tree: they are tested one by one only if their box is not hidden.
const PER_LEAF: usize = 4;

/// One of the largest triangles of an object is tested before its tree, by all methods: if that is not hidden, nothing else has to be.
const LARGEST: usize = 8;

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
    is_single_sided: bool,
    /// The largest triangles, largest first: most likely to be seen.
    largest: Vec<u32>,
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
                let area: Vec<f64> = triangles.iter().map(|t| length(normal(*t))).collect();
                let mut largest: Vec<u32> = (0..triangles.len() as u32).collect();
                largest.sort_by(|&i, &j| area[j as usize].total_cmp(&area[i as usize]).then(i.cmp(&j)));
                largest.truncate(LARGEST);
                Object { tree: BoxTree::build(&boxes, PER_LEAF), triangles, is_single_sided: false, largest }
            })
            .collect();
        let boxes: Vec<Aabb<3>> = objects.iter().map(|o| o.tree.nodes()[0].bounds).collect();
        // An object without triangles has no box; its position does not matter.
        let boxes: Vec<Aabb<3>> =
            boxes.iter().map(|b| if b.is_empty() { Aabb { min: [0.0; 3], max: [0.0; 3] } } else { *b }).collect();
        Self { tree: BoxTree::build(&boxes, 1), objects }
    }

    /// The same, with objects whose triangles are seen from their fronts only. Seen from the front, a triangle turns
    /// counterclockwise.
    pub fn with_single_sided(mut self, is_single_sided: impl Fn(u32) -> bool) -> Self {
        (0..).zip(&mut self.objects).for_each(|(object, o)| o.is_single_sided = is_single_sided(object));
        self
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

    /// Finds the objects that `umbra`, that of `volume`, does not prove hidden: sets `visible` for them, among the
    /// `candidates`; all others are left unchanged, and those that are visible spare questions about boxes around them.
    ///
    /// # Panics
    /// If the lists are shorter than the objects.
    pub fn see(
        &self,
        umbra: &mut dyn Umbra,
        volume: &Volume,
        candidates: &[bool],
        visible: &mut [bool],
    ) -> QueryCounts {
        let mut query = Query { umbra, eyes: volume.corners(), counts: QueryCounts::default() };
        if !self.is_empty() {
            self.see_node(0, &mut query, candidates, visible);
        }
        query.counts
    }

    fn see_node(&self, n: u32, query: &mut Query<'_>, candidates: &[bool], visible: &mut [bool]) {
        let node = &self.tree.nodes()[n as usize];
        let order = &self.tree.order()[node.start as usize..node.end as usize];
        if order.iter().all(|&i| !candidates[i as usize]) {
            return;
        }
        if let &[i] = order {
            visible[i as usize] = self.objects[i as usize].is_seen(query);
            return;
        }
        // A box is not hidden if an object in it is known to be visible.
        let is_open = order.iter().any(|&i| visible[i as usize] && !candidates[i as usize]);
        query.counts.groups += u64::from(!is_open);
        if !is_open && query.umbra.hides(&node.bounds) {
            order.iter().filter(|&&i| candidates[i as usize]).for_each(|&i| visible[i as usize] = false);
            return;
        }
        for child in self.tree.children(n) {
            self.see_node(child, query, candidates, visible);
        }
    }
}

/// What is asked about objects.
struct Query<'a> {
    umbra: &'a mut dyn Umbra,
    /// The corners of the volume.
    eyes: [Point3; 8],
    counts: QueryCounts,
}

impl Query<'_> {
    /// Whether no eye is in front of a triangle, and some are behind it. Exact. A triangle without area has no back.
    fn is_behind(&self, &[a, b, c]: &[Point3; 3]) -> bool {
        let sides = self.eyes.map(|eye| orient3d(a, b, c, eye));
        sides.iter().all(|&side| side <= 0.0) && sides.iter().any(|&side| side < 0.0)
    }
}

impl Object {
    /// Whether any triangle is not proven hidden.
    fn is_seen(&self, query: &mut Query<'_>) -> bool {
        if self.triangles.is_empty() {
            return false;
        }
        let largest = self.largest.iter().map(|&i| &self.triangles[i as usize]);
        if let Some(t) = largest.into_iter().find(|t| !self.is_single_sided || !query.is_behind(t)) {
            query.counts.triangles += 1;
            if !query.umbra.hides_points_by_any(t) {
                return true;
            }
        }
        self.is_seen_at(0, query)
    }

    fn is_seen_at(&self, n: u32, query: &mut Query<'_>) -> bool {
        let node = &self.tree.nodes()[n as usize];
        let triangles = || {
            let order = &self.tree.order()[node.start as usize..node.end as usize];
            order.iter().map(|&i| &self.triangles[i as usize])
        };
        if node.is_leaf() && self.is_single_sided && triangles().all(|t| query.is_behind(t)) {
            return false;
        }
        query.counts.boxes += 1;
        if query.umbra.hides_box_of(&node.bounds, (node.end - node.start) as usize) {
            return false;
        }
        if !node.is_leaf() {
            return self.tree.children(n).into_iter().any(|child| self.is_seen_at(child, query));
        }
        triangles().any(|t| {
            let is_behind = self.is_single_sided && query.is_behind(t);
            query.counts.triangles += u64::from(!is_behind);
            !is_behind && !query.umbra.hides_points(t)
        })
    }
}

//! The feature nearest to a point.

use super::features::{Face, Features};
use sightlines_geometry::vector::{cross, dot, sub};
use sightlines_geometry::{Aabb, Point3};

/// What is nearest to a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Id of the feature.
    pub feature: u32,
    /// Distance to it, in scene units.
    pub distance: f64,
}

/// A feature, and its squared distance.
type Candidate = (f64, u32);

impl Features {
    /// The feature nearest to `p`: of several at the same distance, the one with the lowest id. None if
    /// there are no features.
    ///
    /// Computed in doubles. The distance to a vertex is right but for a few units in the last place; that to an edge or
    /// a face but for a few units in the last place of the distance to its corners, over the sine of the
    /// triangle's angle for faces. Where two features are equally far but for that, it may name either; always the same
    /// one for the same point.
    pub fn nearest(&self, p: Point3) -> Option<Nearest> {
        let mut best: Candidate = (f64::INFINITY, u32::MAX);
        let nodes = self.tree.nodes();
        let to = |node: u32| (squared_to_box(p, &nodes[node as usize].bounds), node);
        let mut stack = Vec::with_capacity(64);
        stack.push(to(0));
        while let Some((distance, n)) = stack.pop() {
            // As near as the best is not too far: its id may be lower.
            if distance > best.0 {
                continue;
            }
            let node = &nodes[n as usize];
            if node.is_leaf() {
                for &i in &self.tree.order()[node.start as usize..node.end as usize] {
                    best = self.nearer(best, self.of_face(p, i));
                }
                continue;
            }
            let [a, b] = self.tree.children(n).map(to);
            stack.extend(if a.0 <= b.0 { [b, a] } else { [a, b] });
        }
        (best.1 != u32::MAX).then(|| Nearest { feature: best.1, distance: best.0.sqrt() })
    }

    /// The nearest of the seven features of a triangle.
    pub(super) fn of_face(&self, p: Point3, index: u32) -> Candidate {
        let face = &self.faces[index as usize];
        let mut best = (f64::INFINITY, u32::MAX);
        for &v in &face.vertices {
            best = self.nearer(best, (squared(sub(p, self.vertices[v as usize])), v));
        }
        for &e in &face.edges {
            if let Some(distance) = self.squared_to_edge(p, e) {
                best = self.nearer(best, (distance, self.first_edge() + e));
            }
        }
        if let Some(distance) = self.squared_to_face(p, face) {
            best = self.nearer(best, (distance, self.first_face() + index));
        }
        best
    }

    fn nearer(&self, a: Candidate, b: Candidate) -> Candidate {
        if (b.0, b.1) < (a.0, a.1) { b } else { a }
    }

    /// None if another point of the edge's line is nearest. The same for all triangles of the edge, since its ends
    /// have an order of their own.
    fn squared_to_edge(&self, p: Point3, edge: u32) -> Option<f64> {
        let [a, b] = self.edges[edge as usize].map(|v| self.vertices[v as usize]);
        let (along, from_a) = (sub(b, a), sub(p, a));
        let (foot, length) = (dot(from_a, along), squared(along));
        if !(0.0 < foot && foot < length) {
            return None;
        }
        // The area of the parallelogram over its base: nothing cancels that is not small itself.
        let area = squared(cross(from_a, along));
        Some(area / length)
    }

    /// None if the foot of the perpendicular is not inside, or the triangle has no area.
    fn squared_to_face(&self, p: Point3, face: &Face) -> Option<f64> {
        let [a, b, c] = face.vertices.map(|v| self.vertices[v as usize]);
        let normal = cross(sub(b, a), sub(c, a));
        let inside = |s: Point3, t: Point3| dot(cross(sub(t, s), sub(p, s)), normal) > 0.0;
        if !(inside(a, b) && inside(b, c) && inside(c, a)) {
            return None;
        }
        let height = dot(normal, sub(p, a)) / squared(normal).sqrt();
        Some(height * height)
    }
}

/// The squared distance to a box; never more, even as it is rounded, than that to a vertex inside.
fn squared_to_box(p: Point3, b: &Aabb<3>) -> f64 {
    squared(std::array::from_fn(|k| (b.min[k] - p[k]).max(p[k] - b.max[k]).max(0.0)))
}

fn squared(a: Point3) -> f64 {
    dot(a, a)
}

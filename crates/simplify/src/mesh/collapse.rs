//! Edge collapse, in order of least importance.

use super::apart::apart;
use super::quadric::Quadric;
use super::{Change, Mesh, State};
use sightlines_geometry::Point3;
use sightlines_geometry::vector::{cross, dot, length, normal};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Decides which edges may be collapsed.
pub(crate) trait Policy {
    /// Whether a face may be changed at all.
    fn may_touch(&self, mesh: &Mesh, face: u32) -> bool;

    /// Whether to make a change; if so, it is charged to the budget. `moved`: an upper bound of how far the surface has
    /// moved there since the beginning.
    fn accepts(&mut self, mesh: &Mesh, change: &Change, moved: f64) -> bool;

    /// Whether there are few enough faces.
    fn is_done(&self, mesh: &Mesh) -> bool;
}

/// The weights of faces and edges.
pub(crate) struct Weights<'a> {
    /// For each face.
    pub(crate) face: &'a dyn Fn(u32) -> f64,
    /// Whether some eye may see one of two faces from the front and the other from behind.
    pub(crate) may_be_silhouette: &'a dyn Fn(u32, u32) -> bool,
}

/// A place that may be moved to another one, and the cost.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Candidate {
    cost: f64,
    from: u32,
    to: u32,
    /// How often both ends had changed.
    stamps: [u32; 2],
}

impl Eq for Candidate {}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let key = |c: &Self| (c.from, c.to, c.stamps);
        self.cost.total_cmp(&other.cost).then(key(self).cmp(&key(other)))
    }
}

/// Collapses edges of a mesh.
pub(crate) struct Collapser {
    quadrics: Vec<Quadric>,
    stamps: Vec<u32>,
    /// For each face, upper bounds of its distance from the original surface, and of the original surface from it.
    moved: Vec<f64>,
    deviation: f64,
    /// Subtracted from all places, so that quadrics have small numbers.
    origin: Point3,
    heap: BinaryHeap<Reverse<Candidate>>,
}

impl Collapser {
    pub(crate) fn new(mesh: &Mesh, weights: &Weights<'_>) -> Self {
        let n = mesh.n_places();
        let all = sightlines_geometry::Aabb::<3>::around((0..n as u32).map(|p| mesh.place(p)));
        let origin = [0, 1, 2].map(|k| if all.is_empty() { 0.0 } else { all.min[k] / 2.0 + all.max[k] / 2.0 });
        let mut collapser = Self {
            quadrics: vec![Quadric::default(); n],
            stamps: vec![0; n],
            moved: vec![0.0; mesh.faces().len()],
            deviation: 0.0,
            origin,
            heap: BinaryHeap::new(),
        };
        for (id, face) in (0..).zip(mesh.faces()).filter(|(_, f)| f.state != State::Gone) {
            let corners = face.corners.map(|c| collapser.local(mesh, c));
            let quadric = Quadric::plane(normal(corners), corners[0], (weights.face)(id));
            face.corners.iter().for_each(|&c| collapser.quadrics[c as usize].add(&quadric));
        }
        for place in 0..n as u32 {
            for (other, _) in mesh.around(place).into_iter().filter(|(other, _)| place < *other) {
                collapser.keep_edge(mesh, weights, place, other);
            }
        }
        collapser
    }

    fn local(&self, mesh: &Mesh, place: u32) -> Point3 {
        let p = mesh.place(place);
        [0, 1, 2].map(|k| p[k] - self.origin[k])
    }

    /// Preserves borders and edges that may be silhouettes: adds a plane through the edge, perpendicular to a face,
    /// with the weight of the heavier face and, where two faces meet, in proportion to how much they bend.
    fn keep_edge(&mut self, mesh: &Mesh, weights: &Weights<'_>, a: u32, b: u32) {
        let faces: Vec<u32> = mesh.at(a).iter().copied().filter(|&f| mesh.face(f).corners.contains(&b)).collect();
        let normals: Vec<Point3> = faces.iter().map(|&f| unit(normal(mesh.corners(f)))).collect();
        let weight = faces.iter().map(|&f| (weights.face)(f)).fold(0.0, f64::max);
        let bend = match (&faces[..], &normals[..]) {
            ([f, g], [n, m]) => {
                if !(weights.may_be_silhouette)(*f, *g) {
                    return;
                }
                let across = cross(*n, *m);
                dot(across, across)
            }
            _ => 1.0,
        };
        let (p, q) = (self.local(mesh, a), self.local(mesh, b));
        let edge = [0, 1, 2].map(|k| q[k] - p[k]);
        for n in &normals {
            let quadric = Quadric::plane(cross(edge, *n), p, weight * bend);
            [a, b].into_iter().for_each(|c| self.quadrics[c as usize].add(&quadric));
        }
    }

    /// Collapses edges as long as the policy permits, least cost first.
    pub(crate) fn run(&mut self, mesh: &mut Mesh, policy: &mut dyn Policy) {
        for place in 0..mesh.n_places() as u32 {
            for (other, _) in mesh.around(place) {
                self.push(mesh, policy, place, other);
            }
        }
        while let Some(Reverse(candidate)) = self.heap.pop() {
            if policy.is_done(mesh) {
                return;
            }
            let Candidate { from, to, stamps, .. } = candidate;
            if stamps != [from, to].map(|p| self.stamps[p as usize]) {
                continue;
            }
            let Some(change) = Change::new(mesh, from, to) else { continue };
            // Points near a face now were near those that it replaces, and those near the original surface. Points near
            // a lost face are now near one of its neighbours.
            let before = mesh.at(from).iter().map(|&f| self.moved[f as usize]).fold(0.0, f64::max);
            let moved = (before + apart(mesh, &change)).next_up();
            if !policy.accepts(mesh, &change, moved) {
                continue;
            }
            self.deviation = self.deviation.max(moved);
            change.apply(mesh);
            // Unchanged neighbours too: lost surface may now be nearest to one of them.
            for &face in mesh.at(to) {
                self.moved[face as usize] = self.moved[face as usize].max(moved);
            }
            let quadric = self.quadrics[from as usize];
            self.quadrics[to as usize].add(&quadric);
            [from, to].into_iter().for_each(|p| self.stamps[p as usize] += 1);
            for (other, _) in mesh.around(to) {
                self.push(mesh, policy, to, other);
                self.push(mesh, policy, other, to);
            }
        }
    }

    fn push(&mut self, mesh: &Mesh, policy: &dyn Policy, from: u32, to: u32) {
        if !mesh.at(from).iter().all(|&f| policy.may_touch(mesh, f)) {
            return;
        }
        let at = self.local(mesh, to);
        let cost = self.quadrics[from as usize].at(at) + self.quadrics[to as usize].at(at);
        if cost.is_finite() {
            let stamps = [from, to].map(|p| self.stamps[p as usize]);
            self.heap.push(Reverse(Candidate { cost, from, to, stamps }));
        }
    }

    /// Upper bound of the distance between the surface and the original one, in both directions; scene units.
    pub(crate) fn deviation(&self) -> f64 {
        self.deviation
    }
}

/// The vector of length 1, or zero if there is no direction. It divides, where `geometry::vector::unit` multiplies by the
/// reciprocal: another rounding would choose other edges among equal ones.
fn unit(v: Point3) -> Point3 {
    let length = length(v);
    if length > 0.0 && length.is_finite() { v.map(|x| x / length) } else { [0.0; 3] }
}

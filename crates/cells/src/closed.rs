//! Closed things: what hides from both sides though only its fronts are drawn.
//!
//! A line between two points outside of a closed surface crosses it as often inwards as outwards. So each of the two sees
//! a front on the line, and neither sees the other; and what is inside is behind fronts. A single wall that is drawn from
//! one side hides nothing from who stands behind it.

use crate::{Point3, SceneObject};
use std::collections::BTreeMap;

/// Whether every piece of an object is closed, with its fronts outwards: each edge is passed as often in one direction as in
/// the other, by two triangles, and the volume inside is certainly positive. Triangles that share an edge are of one piece.
///
/// Corners at one place are one. Whether a piece intersects itself is not looked at. O(n log n).
pub fn is_closed_outwards(object: &SceneObject) -> bool {
    let mut places: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut place = |p: Point3| {
        let next = places.len();
        // Negative zero is zero.
        *places.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next)
    };
    let triangles: Vec<[usize; 3]> = object.corners().map(|t| t.map(&mut place)).collect();
    // For each edge the triangles that pass it, and how much more often upwards.
    let mut edges: BTreeMap<[usize; 2], (Vec<usize>, i32)> = BTreeMap::new();
    for (k, &[a, b, c]) in triangles.iter().enumerate() {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let edge = edges.entry([from.min(to), from.max(to)]).or_default();
            edge.0.push(k);
            edge.1 += if from < to { 1 } else { -1 };
        }
    }
    if edges.values().any(|(passing, balance)| passing.len() != 2 || *balance != 0) {
        return false;
    }
    // Pieces hang together by edges. Two of them may touch at a corner, with the one inside out.
    let mut pieces: Vec<usize> = (0..triangles.len()).collect();
    fn root(pieces: &mut [usize], mut k: usize) -> usize {
        while pieces[k] != k {
            pieces[k] = pieces[pieces[k]];
            k = pieces[k];
        }
        k
    }
    for (passing, _) in edges.values() {
        let (x, y) = (root(&mut pieces, passing[0]), root(&mut pieces, passing[1]));
        pieces[x] = y;
    }
    let mut volumes: BTreeMap<usize, Volume> = BTreeMap::new();
    for (k, [p, q, r]) in object.corners().enumerate() {
        let volume =
            volumes.entry(root(&mut pieces, k)).or_insert(Volume { origin: p, sum: 0.0, magnitude: 0.0, n: 0 });
        volume.add([p, q, r]);
    }
    !volumes.is_empty() && volumes.values().all(Volume::is_positive)
}

/// Six times the volume that triangles enclose, and how far rounding can be off.
struct Volume {
    origin: Point3,
    sum: f64,
    /// The sum of the magnitudes of all products.
    magnitude: f64,
    n: usize,
}

impl Volume {
    fn add(&mut self, corners: [Point3; 3]) {
        let [p, q, r] = corners.map(|v| -> Point3 { std::array::from_fn(|k| v[k] - self.origin[k]) });
        for (k, x) in p.into_iter().enumerate() {
            let (a, b) = ((k + 1) % 3, (k + 2) % 3);
            let (ahead, back) = (q[a] * r[b], q[b] * r[a]);
            self.sum += x * (ahead - back);
            self.magnitude += x.abs() * (ahead.abs() + back.abs());
        }
        self.n += 1;
    }

    /// Whether it is certainly above zero.
    ///
    /// A product is of three differences, each rounded once, and rounded itself in two steps; the difference in it is rounded
    /// once, the sum at most 3 n times. So a product is off by a share of at most 6 + 3 n units of 2^-53, up to terms of
    /// second order, which the doubled bound covers for all n that a file can have.
    fn is_positive(&self) -> bool {
        self.sum > self.magnitude * (12.0 + 6.0 * self.n as f64) * (0.5 * f64::EPSILON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tetrahedron() -> SceneObject {
        let vertices = vec![[5., 0., 0.], [6., 0., 0.], [5., 1., 0.], [5., 0., 1.]];
        let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        SceneObject { name: String::new(), vertices, triangles }
    }

    #[test]
    fn only_whole_things_with_fronts_outwards_are_closed() {
        let whole = tetrahedron();
        assert!(is_closed_outwards(&whole));
        let changed = |change: &dyn Fn(&mut SceneObject)| {
            let mut object = tetrahedron();
            change(&mut object);
            is_closed_outwards(&object)
        };
        assert!(!changed(&|o| _ = o.triangles.pop()));
        assert!(!changed(&|o| o.triangles[0].swap(0, 1)));
        assert!(!changed(&|o| o.triangles.iter_mut().for_each(|t| t.swap(0, 1))));
        assert!(!changed(&|o| o.triangles.clear()));
        assert!(!changed(&|o| o.triangles.push([0, 1, 2])));
        // Two of them, one of which is a hollow; corners that are repeated.
        let twice = |turned: bool| {
            changed(&|o| {
                let more: Vec<Point3> = o.vertices.iter().map(|p| p.map(|x| x * 8.0)).collect();
                o.vertices.extend(more);
                let more = o.triangles.clone().into_iter().map(|[a, b, c]| if turned { [a, c, b] } else { [a, b, c] });
                let more: Vec<[u32; 3]> = more.map(|t| t.map(|i| i + 4)).collect();
                o.triangles.extend(more);
            })
        };
        assert!(twice(false) && !twice(true));
        // A small one inside out that hangs at a corner of a large one; the right way round it is closed.
        let hanging = |inside_out: bool| {
            changed(&|o| {
                o.vertices.extend([[5.0, 0.0, -0.1], [5.1, 0.0, 0.0], [5.0, -0.1, 0.0]]);
                let small = [[0, 4, 6], [0, 5, 4], [0, 6, 5], [4, 5, 6]];
                let small = small.map(|[a, b, c]| if inside_out { [a, c, b] } else { [a, b, c] });
                o.triangles.extend(small);
            })
        };
        assert!(hanging(false) && !hanging(true));
        // A sheet of two sides has no inside, wherever it is.
        let sheet = |at: f64| {
            changed(&|o| {
                o.vertices = vec![[at, 0.1, 0.7], [at + 0.3, 1.1, 0.2], [at, 0.9, 1.3]];
                o.triangles = vec![[0, 1, 2], [0, 2, 1]];
            })
        };
        assert!(!sheet(0.1) && !sheet(1e6 / 3.0));
        assert!(changed(&|o| {
            o.vertices.push(o.vertices[3]);
            o.triangles[1] = [0, 1, 4];
        }));
    }
}

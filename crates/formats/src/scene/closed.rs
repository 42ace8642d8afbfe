//! Closed things: what hides from both sides though only its fronts are drawn.
//!
//! A line between two points outside of a closed surface crosses it as often inwards as outwards. So each of the two sees
//! a front on the line, and neither sees the other; and what is inside is behind fronts. A single wall that is drawn from
//! one side hides nothing from who stands behind it.

use sightlines_cells::{Point3, SceneObject};
use std::collections::BTreeMap;

/// Whether every piece of an object is closed, with its fronts outwards: each edge is passed as often in one direction as in
/// the other, by two triangles, and the volume inside is positive.
///
/// Corners at one place are one. Whether a piece intersects itself is not looked at. O(n log n).
pub(super) fn is_closed_outwards(object: &SceneObject) -> bool {
    let mut places: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut place = |p: Point3| {
        let next = places.len();
        // Negative zero is zero.
        *places.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(next)
    };
    let triangles: Vec<[usize; 3]> = object.corners().map(|t| t.map(&mut place)).collect();
    // For each edge how often it is passed, and how much more often upwards.
    let mut edges: BTreeMap<[usize; 2], (u32, i32)> = BTreeMap::new();
    for &[a, b, c] in &triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let edge = edges.entry([from.min(to), from.max(to)]).or_default();
            *edge = (edge.0 + 1, edge.1 + if from < to { 1 } else { -1 });
        }
    }
    if edges.values().any(|&(n, balance)| n != 2 || balance != 0) {
        return false;
    }
    // Pieces hang together by corners.
    let mut parents: Vec<usize> = (0..places.len()).collect();
    fn root(parents: &mut [usize], mut k: usize) -> usize {
        while parents[k] != k {
            parents[k] = parents[parents[k]];
            k = parents[k];
        }
        k
    }
    for &[a, b, c] in &triangles {
        for other in [b, c] {
            let (x, y) = (root(&mut parents, a), root(&mut parents, other));
            parents[x] = y;
        }
    }
    let mut volumes: BTreeMap<usize, (Point3, f64)> = BTreeMap::new();
    for (&[a, ..], [p, q, r]) in triangles.iter().zip(object.corners()) {
        let (origin, volume) = volumes.entry(root(&mut parents, a)).or_insert((p, 0.0));
        let [p, q, r] = [p, q, r].map(|v| -> Point3 { std::array::from_fn(|k| v[k] - origin[k]) });
        let cross = [q[1] * r[2] - q[2] * r[1], q[2] * r[0] - q[0] * r[2], q[0] * r[1] - q[1] * r[0]];
        *volume += p[0] * cross[0] + p[1] * cross[1] + p[2] * cross[2];
    }
    !volumes.is_empty() && volumes.values().all(|&(_, volume)| volume > 0.0)
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
        assert!(changed(&|o| {
            o.vertices.push(o.vertices[3]);
            o.triangles[1] = [0, 1, 4];
        }));
    }
}

//! Regions and paths against each of their points.

use crate::oracle::{sees_brute, sees_touching};
use crate::{Walls, plan, point, walls};
use proptest::prelude::*;
use sightlines_geometry::Point2;
use sightlines_isovist::{Touch, ViewerRegion, WallMesh};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Whether no wall touches the triangle from an eye to a piece, but for the eye and the piece, in integers: the walls are cut at all lines
/// through the eye, so their ends and the sides decide.
fn clear(walls: &Walls, eye: [i64; 2], a: [i64; 2], b: [i64; 2]) -> bool {
    let cross = |o: [i64; 2], p: [i64; 2], q: [i64; 2]| (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
    let turn = cross(eye, a, b).signum();
    let inside = |p: [i64; 2]| {
        let [u, v, w] = [cross(eye, a, p), cross(a, b, p), cross(b, eye, p)].map(|x| x * turn);
        turn != 0 && p != eye && u >= 0 && v > 0 && w >= 0
    };
    // A wall through the eye, into the triangle.
    let between = |p: [i64; 2]| turn != 0 && cross(eye, a, p) * turn > 0 && cross(b, eye, p) * turn > 0;
    let splits = |w: &[i64; 4]| {
        let (p, q) = ([w[0], w[1]], [w[2], w[3]]);
        let holds = |k: usize| p[k].min(q[k]) <= eye[k] && eye[k] <= p[k].max(q[k]);
        cross(p, q, eye) == 0 && holds(0) && holds(1) && (between(p) || between(q))
    };
    sees_brute(walls, eye, a)
        && sees_brute(walls, eye, b)
        && !walls.iter().any(|w| splits(w) || inside([w[0], w[1]]) || inside([w[2], w[3]]))
}

proptest! {
    /// Invariant: an eye that sees all of a path sees every point of it; one that does not is blocked from some point or has a wall in
    /// the way, by plain loops over all walls.
    #[test]
    fn all_of_a_path_is_seen_as_by_brute_force(walls in walls(7, 9), eye in prop::array::uniform2(0i64..9), path in prop::array::uniform3(prop::array::uniform2(0i64..9))) {
        static SEEN: AtomicUsize = AtomicUsize::new(0);
        let scaled: Walls = walls.iter().map(|w| w.map(|x| 12 * x)).collect();
        let (eye, path) = (eye.map(|x| 12 * x), path.map(|p| p.map(|x| 12 * x)));
        let frame = sightlines_geometry::Aabb { min: [-9.0; 2], max: [150.0; 2] };
        let mesh = WallMesh::with_frame(&plan(&scaled), frame).unwrap();
        let points = path.map(point);
        let all = mesh.sees_all(point(eye), ViewerRegion::Path(&points), Touch::Blocks).unwrap();
        let truth = clear(&scaled, eye, path[0], path[1]) && clear(&scaled, eye, path[1], path[2]);
        prop_assert_eq!(all, truth);
        let polygon = mesh.sees_all(point(eye), ViewerRegion::Polygon(&points), Touch::Blocks).unwrap();
        prop_assert_eq!(polygon, truth && clear(&scaled, eye, path[2], path[0]));
        let passes = mesh.sees_all(point(eye), ViewerRegion::Path(&points), Touch::Passes).unwrap();
        prop_assert!(passes || !all);
        for k in 0..=12 {
            let at = |a: [i64; 2], b: [i64; 2]| [0, 1].map(|i| a[i] + (b[i] - a[i]) / 12 * k);
            let p = at(path[0], path[1]);
            prop_assert!(!all || sees_brute(&scaled, eye, p), "{:?}", p);
            prop_assert!(!passes || sees_touching(&scaled, eye, p), "{:?}", p);
        }
        SEEN.fetch_add(usize::from(all), Ordering::Relaxed);
    }
}

#[test]
fn a_pillar_in_front_of_a_region_counts() {
    let mesh = WallMesh::new(&plan(&vec![[-9, -9, 9, -9], [0, 0, 0, 1], [-9, 9, 9, 9]])).unwrap();
    let at = |x: f64, y: f64| Point2::new(x, y);
    let (eye, wall) = (at(-4.0, 0.5), [at(4.0, -8.0), at(4.0, 8.0)]);
    assert!(wall.iter().all(|&p| mesh.sees(eye, p, Touch::Blocks).unwrap()), "both ends are seen");
    assert!(!mesh.sees_all(eye, ViewerRegion::Path(&wall), Touch::Blocks).unwrap(), "not what is behind the pillar");
    assert!(mesh.sees_all(at(2.0, 0.5), ViewerRegion::Path(&wall), Touch::Blocks).unwrap());
}

/// A wall along the line of sight hides nothing where walls may be touched.
#[test]
fn walls_seen_edge_on_hide_nothing() {
    let mesh = WallMesh::new(&plan(&vec![[2, 0, 3, 0], [-9, -9, 9, -9], [-9, 9, 9, 9]])).unwrap();
    let path = [point([5, -1]), point([5, 1])];
    for (eye, touch, truth) in [
        ([0, 0], Touch::Passes, true),
        ([2, 0], Touch::Passes, true),
        ([0, 0], Touch::Blocks, false),
        ([2, 0], Touch::Blocks, false),
        ([0, 1], Touch::Passes, false),
    ] {
        assert_eq!(mesh.sees_all(point(eye), ViewerRegion::Path(&path), touch).unwrap(), truth, "{eye:?} {touch:?}");
    }
}

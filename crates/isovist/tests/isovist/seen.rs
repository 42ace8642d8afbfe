//! Sight between points against plain loops over all walls, in integers.

use crate::oracle::{sees_brute, sees_touching};
use crate::{Walls, plan, point, walls};
use proptest::prelude::*;
use sightlines_isovist::{Touch, WallMesh};
use std::sync::atomic::{AtomicUsize, Ordering};

fn oracle(walls: &Walls, a: [i64; 2], b: [i64; 2], touch: Touch) -> bool {
    match touch {
        Touch::Blocks => sees_brute(walls, a, b),
        Touch::Passes => sees_touching(walls, a, b),
    }
}

proptest! {
    /// Invariant: `sees` and `points_seen` equal brute force, for every pair of a grid, both conventions.
    #[test]
    fn points_see_each_other_as_by_brute_force(walls in walls(9, 7)) {
        static SEEN: [AtomicUsize; 2] = [const { AtomicUsize::new(0) }; 2];
        let mesh = WallMesh::new(&plan(&walls)).unwrap();
        let inside = |p: [i64; 2]| {
            let f = mesh.frame();
            (0..2).all(|k| f.min[k] < p[k] as f64 && (p[k] as f64) < f.max[k])
        };
        let grid: Vec<[i64; 2]> = (0..49).map(|i| [i % 7, i / 7]).filter(|&p| inside(p)).collect();
        let points: Vec<_> = grid.iter().map(|&p| point(p)).collect();
        let index = mesh.index(&points).unwrap();
        let mut list = Vec::new();
        for touch in [Touch::Blocks, Touch::Passes] {
            for (i, &a) in grid.iter().enumerate() {
                mesh.points_seen(i as u32, &index, touch, &mut list);
                for (j, &b) in grid.iter().enumerate() {
                    let truth = oracle(&walls, a, b, touch);
                    SEEN[usize::from(truth)].fetch_add(1, Ordering::Relaxed);
                    let sees = mesh.sees(point(a), point(b), touch).unwrap();
                    prop_assert_eq!(sees, truth, "{:?} {:?} {:?}", a, b, touch);
                    prop_assert_eq!(list.binary_search(&(j as u32)).is_ok(), truth, "{:?} in the list of {:?} {:?}", b, a, touch);
                }
            }
        }
        let seen = [&SEEN[0], &SEEN[1]].map(|n| n.load(Ordering::Relaxed));
        prop_assert!(seen.iter().sum::<usize>() > 0);
    }

    /// The same off the grid of the walls, where crossings of walls are between the points.
    #[test]
    fn points_between_see_each_other_as_by_brute_force(walls in walls(14, 5), a in prop::array::uniform2(0i64..41), b in prop::array::uniform2(0i64..41)) {
        let large: Walls = walls.iter().map(|w| w.map(|x| 10 * x)).collect();
        let mesh = WallMesh::new(&plan(&large)).unwrap();
        for touch in [Touch::Blocks, Touch::Passes] {
            if let Ok(sees) = mesh.sees(point(a), point(b), touch) {
                prop_assert_eq!(sees, oracle(&large, a, b, touch), "{:?}", touch);
                prop_assert_eq!(mesh.sees(point(b), point(a), touch).unwrap(), sees);
            }
        }
    }
}

/// The impostor: the two conventions differ, so each comparison can fail.
#[test]
fn conventions_differ() {
    let walls = vec![[2, 0, 2, 2]];
    let mesh = WallMesh::new(&plan(&walls)).unwrap();
    let (a, b) = ([1, 2], [3, 2]);
    // The frame leaves half a unit around the wall.
    let at = |p: [i64; 2]| sightlines_geometry::Point2::new(1.0 + 0.5 * p[0] as f64, p[1] as f64);
    assert!(!mesh.sees(at(a), at(b), Touch::Blocks).unwrap());
    assert!(mesh.sees(at(a), at(b), Touch::Passes).unwrap());
    assert_ne!(sees_brute(&walls, a, b), sees_touching(&walls, a, b));
}

/// A facade with many windows in one line: of the ways along it, each edge is followed once.
#[test]
fn views_along_many_walls_in_line_end() {
    let mut walls: Walls = (0..60).map(|i| [2 * i + 1, 0, 2 * i + 2, 0]).collect();
    walls.push([121, -1, 121, 1]);
    let mesh = WallMesh::new(&plan(&walls)).unwrap();
    let points: Vec<_> = (0..124).map(|x| point([x, 0])).collect();
    let index = mesh.index(&points).unwrap();
    let mut seen = Vec::new();
    mesh.points_seen(0, &index, Touch::Passes, &mut seen);
    assert_eq!(seen, (0..=121).collect::<Vec<u32>>(), "up to the wall across");
    mesh.points_seen(0, &index, Touch::Blocks, &mut seen);
    assert_eq!(seen, [0, 1]);
}

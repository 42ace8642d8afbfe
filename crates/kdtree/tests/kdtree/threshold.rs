//! The obscuration threshold: which faces are followed.

use crate::common::{SIDE_2D, SIDE_3D, centres, cut, faces, office, on_face, step};
use proptest::prelude::*;
use sightlines_kdtree::{AxialCell, AxialFace, AxialTree, FaceClass, KdOptions, bounds_of, classify, subdivide};

/// The largest share of a cell's cross-section that faces on one plane inside of it cover, counted
/// square by square.
fn most_obscured<const D: usize>(tree: &AxialTree<D>, faces: &[AxialFace<D>], n: u32, cell: usize) -> f64 {
    let bounds = tree.cells()[cell].bounds;
    let mut most = 0.0f64;
    for axis in 0..D {
        for at in 1..n {
            let here =
                |p: [f64; D]| p[axis] == f64::from(at) && bounds.min[axis] < p[axis] && p[axis] < bounds.max[axis];
            let middles =
                centres::<D>(n).into_iter().map(|c| step(c, axis).1).filter(|p| here(*p) && bounds.contains(*p));
            let (mut covered, mut all) = (0.0, 0.0);
            for middle in middles {
                all += 1.0;
                covered += f64::from(u8::from(on_face(faces, axis, middle)));
            }
            most = most.max(if all > 0.0 { covered / all } else { 0.0 });
        }
    }
    most
}

proptest! {
    /// Invariant: a cell stays whole only if no plane inside of it is obscured enough; and what is
    /// counted as detail is there.
    #[test]
    fn leaves_have_no_plane_above_the_threshold(faces in faces::<3>(SIDE_3D, 8), quarters in 1u8..=4) {
        let tau = f64::from(quarters) / 4.0;
        let tree = cut(&faces, SIDE_3D, tau);
        let mut any = false;
        for (i, cell) in tree.cells().iter().enumerate() {
            let most = most_obscured(&tree, &faces, SIDE_3D, i);
            prop_assert!(most < tau, "cell {} has a plane obscured by {}", i, most);
            any |= most > 0.0;
            let spanning = faces.iter().find(|f| classify(f, &cell.bounds) == FaceClass::Spanning);
            prop_assert!(spanning.is_none());
        }
        prop_assert_eq!(any, tree.n_detail() > 0);
    }

    /// Invariant: the cells at threshold 1 are bordered by walls only, so those at any other lie inside.
    #[test]
    fn any_threshold_refines_the_largest(faces in faces::<2>(SIDE_2D, 14), tenths in 0u8..10) {
        let (fine, coarse) = (cut(&faces, SIDE_2D, f64::from(tenths) / 10.0), cut(&faces, SIDE_2D, 1.0));
        prop_assert_eq!(coarse.portals(), &[]);
        for cell in fine.cells() {
            let around = |c: &&AxialCell<2>| c.bounds.contains(cell.bounds.min) && c.bounds.contains(cell.bounds.max);
            prop_assert!(coarse.cells().iter().any(|c| around(&c)), "{:?} is in no cell at threshold 1", cell);
        }
    }
}

#[test]
fn the_oracle_sees_what_is_left() {
    let face = AxialFace::new(0, [2.0, 0.0, 0.0], [2.0, 2.0, 4.0]);
    let (whole, halves) = (cut(&[face], 4, 0.75), cut(&[face], 4, 0.5));
    assert_eq!((whole.cells().len(), most_obscured(&whole, &[face], 4, 0)), (1, 0.5));
    assert_eq!((halves.cells().len(), most_obscured(&halves, &[face], 4, 0)), (2, 0.0));
}

#[test]
fn a_larger_threshold_gives_fewer_cells_in_an_office() {
    let walls = office(6);
    let n_cells =
        |tau| subdivide(&walls, bounds_of(&walls), &KdOptions { tau, ..KdOptions::default() }).unwrap().cells().len();
    let sweep: Vec<usize> = (0..=10).map(|i| n_cells(f64::from(i) / 10.0)).collect();
    assert!(sweep.is_sorted_by(|a, b| a >= b), "{sweep:?}");
    assert!(sweep[0] > 2 * sweep[10], "{sweep:?}");
}

#[test]
fn a_larger_threshold_may_also_give_more_cells() {
    // The threshold drops the plane that would have cleaved least, and a worse one is used first: the number of cells
    // is not monotonic in the threshold; only its ends are ordered.
    let walls = [
        AxialFace::new(1, [1.0, 4.0], [6.0, 4.0]),
        AxialFace::new(0, [5.0, 0.0], [5.0, 4.0]),
        AxialFace::new(1, [0.0, 1.0], [3.0, 1.0]),
        AxialFace::new(0, [3.0, 3.0], [3.0, 5.0]),
    ];
    let n_cells = |tau| cut(&walls, 6, tau).cells().len();
    assert_eq!([0.0, 0.3, 0.4, 0.5, 1.0].map(n_cells), [6, 6, 7, 6, 1]);
}

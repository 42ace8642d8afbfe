//! Cells: they tile the bounds, walls lie on their borders, points are found in them.

use crate::common::{SIDE_2D, SIDE_3D, cell_at, centres, cut, faces, grid, unit_walls};
use proptest::prelude::*;
use sightlines_geometry::Aabb;
use sightlines_kdtree::{AxialFace, AxialNode, AxialTree, FaceClass, classify};
use sightlines_pvs::{CellId, Locator, LocatorNode};

/// Volumes add up, no unit cube is in two cells, and the tree finds for each point the cell that
/// comparing with all cells finds.
fn check_tiling<const D: usize>(tree: &AxialTree<D>, n: u32) -> Result<(), String> {
    let volume = |b: Aabb<D>| (0..D).map(|k| b.max[k] - b.min[k]).product::<f64>();
    let total: f64 = tree.cells().iter().map(|c| volume(c.bounds)).sum();
    if total != volume(tree.bounds()) {
        return Err(format!("cells have volume {total}"));
    }
    for centre in centres::<D>(n) {
        let cell = cell_at(tree.cells(), centre)?;
        let corner = centre.map(|x| x - 0.5);
        for p in [centre, corner, grid::<D>(n).max] {
            check_location(tree, p)?;
        }
        if tree.locate(centre).map(CellId::idx) != Some(cell) {
            return Err(format!("{centre:?} is located in {:?}, not {cell}", tree.locate(centre)));
        }
    }
    Ok(())
}

fn check_location<const D: usize>(tree: &AxialTree<D>, p: [f64; D]) -> Result<(), String> {
    let (cells, end) = (tree.cells(), tree.bounds().max);
    let ids = || (0u32..).map(CellId).take(cells.len());
    let closed: Vec<CellId> = ids().filter(|c| cells[c.idx()].bounds.contains(p)).collect();
    // Half-open: a cell owns its lower border, and its upper one only where the scene ends.
    let owns = |c: &CellId| {
        let b = cells[c.idx()].bounds;
        (0..D).all(|k| b.min[k] <= p[k] && (p[k] < b.max[k] || (p[k] == b.max[k] && b.max[k] == end[k])))
    };
    let owner: Vec<CellId> = ids().filter(owns).collect();
    if tree.locate_all(p) != closed || owner != Vec::from_iter(tree.locate(p)) {
        return Err(format!("{p:?}: {:?} and {:?}, not {owner:?} and {closed:?}", tree.locate(p), tree.locate_all(p)));
    }
    Ok(())
}

/// No face has anything inside a cell.
fn check_walls<const D: usize>(tree: &AxialTree<D>, faces: &[AxialFace<D>]) -> Result<(), String> {
    for cell in tree.cells() {
        let inside = |f: &&AxialFace<D>| matches!(classify(f, &cell.bounds), FaceClass::Spanning | FaceClass::Incident);
        if let Some(face) = faces.iter().find(inside) {
            return Err(format!("{face:?} is inside {cell:?}"));
        }
    }
    Ok(())
}

/// Every piece of a face inside the bounds is on the border of a cell; the twin of [`check_walls`].
fn check_covered<const D: usize>(tree: &AxialTree<D>, faces: &[AxialFace<D>]) -> Result<(), String> {
    let covered_by = |f: &AxialFace<D>| tree.cells().iter().any(|c| classify(f, &c.bounds) == FaceClass::Covering);
    match faces.iter().find(|f| classify(f, &tree.bounds()) != FaceClass::Disjoint && !covered_by(f)) {
        Some(face) => Err(format!("{face:?} covers no cell")),
        None => Ok(()),
    }
}

/// Nodes are a preorder tree, cells are numbered from low to high, splits are coordinates of faces.
fn check_nodes<const D: usize>(tree: &AxialTree<D>, faces: &[AxialFace<D>]) {
    let ids = tree.nodes().iter().filter_map(|n| if let AxialNode::Leaf(cell) = n { Some(cell.0) } else { None });
    assert!(ids.eq(0..tree.cells().len() as u32), "leaves are numbered in order");
    assert_eq!(tree.nodes().len(), 2 * tree.cells().len() - 1);
    for (i, node) in tree.nodes().iter().enumerate() {
        if let AxialNode::Inner { axis, at, low, high } = *node {
            assert!(low as usize == i + 1 && (high as usize) < tree.nodes().len());
            assert!(faces.iter().any(|f| f.axis == axis && f.at == at), "{axis} at {at} is no face's plane");
        }
    }
    let node = |node: &AxialNode| match *node {
        AxialNode::Leaf(cell) => LocatorNode::Leaf { cells: vec![cell] },
        AxialNode::Inner { axis, at, low, high } => LocatorNode::Inner { axis: axis as u8, split: at, low, high },
    };
    Locator::from_nodes(&tree.nodes().iter().map(node).collect::<Vec<_>>()).expect("a tree");
}

fn check_all<const D: usize>(faces: &[AxialFace<D>], n: u32) -> Result<(), TestCaseError> {
    let tree = cut(faces, n, 0.0);
    check_nodes(&tree, faces);
    check_tiling(&tree, n)
        .and_then(|()| check_walls(&tree, faces))
        .and_then(|()| check_covered(&tree, faces))
        .map_err(TestCaseError::fail)?;
    prop_assert_eq!(tree.n_detail(), 0);
    Ok(())
}

proptest! {
    /// Invariant: cells tile the plane, and walls are on their borders.
    #[test]
    fn cells_tile_and_are_bordered_by_walls_2d(faces in faces::<2>(SIDE_2D, 14)) {
        check_all(&faces, SIDE_2D)?;
    }

    /// Invariant: the same for many short walls, which meet in crossings and corners.
    #[test]
    fn cells_tile_and_are_bordered_by_unit_walls_2d(faces in unit_walls(SIDE_2D)) {
        check_all(&faces, SIDE_2D)?;
    }

    /// Invariant: the same in space.
    #[test]
    fn cells_tile_and_are_bordered_by_walls_3d(faces in faces::<3>(SIDE_3D, 8)) {
        check_all(&faces, SIDE_3D)?;
    }

    /// Invariant: cells depend on the set of points that faces cover, not on how it is given.
    #[test]
    fn subdivision_ignores_order_and_repetition(faces in faces::<3>(SIDE_3D, 8), turn in 0usize..8) {
        let mut other = faces.clone();
        other.rotate_left(turn % faces.len().max(1));
        other.extend(faces.iter().take(turn).copied());
        // Halving a face changes nothing either.
        other.extend(faces.iter().map(|f| {
            let mut half = *f;
            let k = (f.axis + 1) % 3;
            half.max[k] = half.min[k].midpoint(half.max[k]).floor();
            half
        }));
        prop_assert_eq!(cut(&faces, SIDE_3D, 0.25), cut(&other, SIDE_3D, 0.25));
    }
}

#[test]
fn points_outside_have_no_cell() {
    let tree = cut::<2>(&[AxialFace::new(0, [2.0, 0.0], [2.0, 3.0])], 4, 0.0);
    for p in [[-0.1, 1.0], [4.1, 1.0], [f64::NAN, 1.0], [1.0, f64::NAN]] {
        assert_eq!((tree.locate(p), tree.locate_all(p)), (None, vec![]));
    }
    assert_eq!(tree.locate([2.0, 1.0]), Some(CellId(1)));
    assert_eq!(tree.locate_all([2.0, 1.0]), [CellId(0), CellId(1)]);
    assert_eq!(tree.locate([4.0, 4.0]), Some(CellId(1)), "the bounds are closed");
}

#[test]
fn impostors_fail_the_checks() {
    // A tree that left a wall inside a cell, shown to the check with the wall, and to the twin with a
    // wall that is nowhere.
    let wall = AxialFace::new(0, [2.0, 0.0], [2.0, 1.0]);
    let blind = cut::<2>(&[], 4, 0.0);
    assert!(check_walls(&blind, &[wall]).is_err());
    assert!(check_covered(&blind, &[wall]).is_err());
    assert!(check_tiling(&blind, 4).is_ok());
    let ragged = cell_at(&[blind.cells()[0], blind.cells()[0]], [0.5, 0.5]);
    assert!(ragged.is_err(), "overlapping cells are noticed");
}

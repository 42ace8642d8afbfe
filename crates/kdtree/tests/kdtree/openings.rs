//! Portals: exactly where walls between cells are open.

use crate::common::{
    SIDE_2D, SIDE_3D, all_shared_walls, check_connectivity, check_openings, cut, faces, office, unit_walls,
};
use proptest::prelude::*;
use sightlines_kdtree::{AxialFace, AxialPortal, AxialTree, KdOptions, bounds_of, planar_graph, subdivide};

fn check_all<const D: usize>(faces: &[AxialFace<D>], n: u32, tau: f64) -> Result<AxialTree<D>, TestCaseError> {
    let tree = cut(faces, n, tau);
    check_openings(faces, n, tree.cells(), tree.portals()).map_err(TestCaseError::fail)?;
    check_borders(&tree);
    check_joined(&tree);
    if tau == 0.0 {
        check_connectivity(faces, n, tree.cells(), tree.portals()).map_err(TestCaseError::fail)?;
    }
    Ok(tree)
}

/// Portals lie on the upper side of their first cell and on the lower side of their second.
fn check_borders<const D: usize>(tree: &AxialTree<D>) {
    for p in tree.portals() {
        let [low, high] = p.cells.map(|c| tree.cells()[c.idx()].bounds);
        assert!(low.max[p.axis] == p.at && high.min[p.axis] == p.at, "{p:?} is not between its cells");
        assert!(p.min[p.axis] == p.at && p.max[p.axis] == p.at);
        assert!([p.min, p.max].into_iter().all(|end| low.contains(end) && high.contains(end)), "{p:?} sticks out");
    }
    let order: Vec<_> = tree.portals().iter().map(|p| (p.cells, p.min)).collect();
    assert!(order.is_sorted(), "portals are ordered by cells and place");
}

/// No two pieces of an opening together form a rectangle along the first axis across: pieces depend on the opening
/// alone, not on what was cut elsewhere on its plane.
fn check_joined<const D: usize>(tree: &AxialTree<D>) {
    for (p, q) in tree.portals().iter().flat_map(|p| tree.portals().iter().map(move |q| (p, q))) {
        let along = (0..D).find(|&k| k != p.axis).expect("there is an axis across");
        let beside = (0..D).all(|k| k == along || (p.min[k], p.max[k]) == (q.min[k], q.max[k]));
        assert!(p.cells != q.cells || !beside || p.max[along] != q.min[along], "{p:?} goes on in {q:?}");
    }
}

proptest! {
    /// Invariant: what is open is in one portal, what is not in none; connectivity is kept.
    #[test]
    fn portals_are_the_openings_2d(faces in faces::<2>(SIDE_2D, 14)) {
        check_all(&faces, SIDE_2D, 0.0)?;
    }

    /// Invariant: the same for many short walls.
    #[test]
    fn portals_are_the_openings_of_unit_walls_2d(faces in unit_walls(SIDE_2D)) {
        check_all(&faces, SIDE_2D, 0.0)?;
    }

    /// Invariant: the same in space, where openings are not always rectangles.
    #[test]
    fn portals_are_the_openings_3d(faces in faces::<3>(SIDE_3D, 8)) {
        check_all(&faces, SIDE_3D, 0.0)?;
    }

    /// Invariant: with detail left out, the walls between cells are still open exactly where no face is.
    #[test]
    fn portals_are_the_openings_at_any_threshold(faces in faces::<3>(SIDE_3D, 8), tau in 0u8..=4) {
        check_all(&faces, SIDE_3D, f64::from(tau) / 4.0)?;
    }

    /// Invariant: the graph of a planar tree is well formed, and each portal leads both ways.
    #[test]
    fn graphs_are_well_formed(faces in unit_walls(SIDE_2D), tau in 0u8..=4) {
        let tree = cut(&faces, SIDE_2D, f64::from(tau) / 4.0);
        let graph = planar_graph(&tree);
        graph.assert_well_formed();
        prop_assert_eq!(graph.n_cells(), tree.cells().len());
        prop_assert_eq!(graph.portals().len(), tree.portals().len());
        for id in graph.cell_ids() {
            for exit in graph.exits(id) {
                let back = graph.exits(exit.to).iter().find(|e| e.portal == exit.portal).expect("a way back");
                prop_assert_eq!((back.to, back.side, back.entry_side), (id, exit.entry_side, exit.side));
                prop_assert_eq!(exit.side ^ 1, exit.entry_side, "opposite sides of two boxes meet");
            }
        }
    }
}

/// Two rooms with a wall between them that has one door or none.
fn two_rooms(door: bool) -> Vec<AxialFace<2>> {
    let upper = AxialFace::new(0, [2.0, 2.0], [2.0, 4.0]);
    let lower = AxialFace::new(0, [2.0, 0.0], [2.0, if door { 1.0 } else { 2.0 }]);
    vec![upper, lower]
}

#[test]
fn portals_that_ignore_faces_are_found_out() {
    let walls = two_rooms(false);
    let tree = cut(&walls, 4, 0.0);
    let impostor = all_shared_walls(&tree);
    assert_eq!(impostor.len(), 1);
    assert!(check_connectivity(&walls, 4, tree.cells(), &impostor).is_err(), "flood fill stops at the wall");
    assert!(check_openings(&walls, 4, tree.cells(), &impostor).is_err());
    assert!(check_connectivity(&walls, 4, tree.cells(), tree.portals()).is_ok());
}

#[test]
fn a_forgotten_portal_is_found_out() {
    let walls = two_rooms(true);
    let tree = cut(&walls, 4, 0.0);
    assert_eq!(tree.portals().len(), 1);
    assert!(check_connectivity(&walls, 4, tree.cells(), &[]).is_err());
    assert!(check_openings(&walls, 4, tree.cells(), &[]).is_err());
    // One that is too small keeps connectivity, but not the openings.
    let walls = [AxialFace::new(0, [2.0, 0.0], [2.0, 1.0])];
    let tree = cut(&walls, 4, 0.0);
    let mut small = tree.portals().to_vec();
    small[0].max[1] -= 1.0;
    assert!(check_connectivity(&walls, 4, tree.cells(), &small).is_ok());
    assert!(check_openings(&walls, 4, tree.cells(), &small).is_err());
}

#[test]
fn a_hole_in_space_is_cut_into_rectangles() {
    // A square pane in the middle of the wall between two rooms: what is open goes round it.
    let pane = AxialFace::new(2, [1.0, 1.0, 2.0], [2.0, 2.0, 2.0]);
    let tree = cut(&[pane], 3, 0.0);
    let piece = |x0, y0, x1, y1| {
        let cells = tree.portals()[0].cells;
        AxialPortal { cells, axis: 2, at: 2.0, min: [x0, y0, 2.0], max: [x1, y1, 2.0] }
    };
    let ring = [piece(0., 0., 1., 3.), piece(1., 0., 2., 1.), piece(1., 2., 2., 3.), piece(2., 0., 3., 3.)];
    assert_eq!(tree.portals(), ring);
}

#[test]
fn an_office_has_its_doors() {
    let walls = office(5);
    let tree = subdivide(&walls, bounds_of(&walls), &KdOptions { tau: 0.3, ..KdOptions::default() }).unwrap();
    let doors = |y: f64| tree.portals().iter().filter(move |p| p.axis == 1 && p.at == y && p.max[0] - p.min[0] == 1.0);
    assert_eq!((doors(8.0).count(), doors(10.0).count()), (5, 5));
    assert_eq!(tree.n_detail(), 10, "desks are detail");
}

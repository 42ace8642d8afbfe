//! Walls that nearly meet, just meet, or lie on each other.

use crate::common::{cut, grid};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{AxialFace, AxialTree, KdOptions, bounds_of, subdivide};

fn upright(x: f64, y0: f64, y1: f64) -> AxialFace<2> {
    AxialFace::new(0, [x, y0], [x, y1])
}

fn doors(tree: &AxialTree<2>) -> Vec<([f64; 2], [f64; 2])> {
    tree.portals().iter().map(|p| (p.min, p.max)).collect()
}

#[test]
fn collinear_walls_span_together() {
    let parts = [upright(1.0, 0.0, 1.5), upright(1.0, 1.5, 3.0), upright(1.0, 2.5, 4.0)];
    let tree = cut(&parts, 4, 1.0);
    assert_eq!((tree.cells().len(), tree.portals().len()), (2, 0));
    assert_eq!(tree, cut(&[upright(1.0, 0.0, 4.0)], 4, 1.0));
}

#[test]
fn repeated_and_overlapping_walls_count_once() {
    let wall = upright(1.0, 0.0, 2.0);
    let (once, thrice) = (cut(&[wall], 4, 0.6), cut(&[wall, upright(1.0, 0.5, 2.0), wall], 4, 0.6));
    assert_eq!(once.cells().len(), 1, "half of the cross-section, however often");
    assert_eq!(once, thrice);
}

#[test]
fn a_gap_of_one_ulp_is_a_portal() {
    let end = 2.0f64.next_up();
    let tree = cut(&[upright(1.0, 0.0, 2.0), upright(1.0, end, 4.0)], 4, 0.0);
    assert_eq!(doors(&tree), [([1.0, 2.0], [1.0, end])]);
    sightlines_kdtree::planar_graph(&tree).assert_well_formed();
    // In space, a slit along the whole wall.
    let part = |y0, y1| AxialFace::new(0, [1.0, y0, 0.0], [1.0, y1, 4.0]);
    let tree = cut(&[part(0.0, 2.0), part(end, 4.0)], 4, 0.0);
    let [slit] = tree.portals() else { panic!("one slit, not {:?}", tree.portals()) };
    assert_eq!((slit.min, slit.max), ([1.0, 2.0, 0.0], [1.0, end, 4.0]));
}

#[test]
fn a_wall_that_stops_an_ulp_short_of_the_next_is_passed() {
    // A corner that is not quite closed, and the same one closed.
    let corner = |end: f64| {
        let level = AxialFace::new(1, [0.0, 2.0], [end, 2.0]);
        cut(&[upright(2.0, 0.0, 2.0), level], 4, 0.0)
    };
    let inside = |tree: &AxialTree<2>| {
        let room = tree.locate([1.0, 1.0]).expect("inside");
        tree.portals().iter().filter(|p| p.cells.contains(&room)).count()
    };
    let open = corner(2.0f64.next_down());
    assert_eq!(inside(&corner(2.0)), 0);
    assert!(inside(&open) > 0 && doors(&open).contains(&([2.0f64.next_down(), 2.0], [2.0, 2.0])), "{:?}", doors(&open));
}

#[test]
fn doors_of_no_width_are_no_portals() {
    assert_eq!(doors(&cut(&[upright(1.0, 0.0, 2.0), upright(1.0, 2.0, 4.0)], 4, 0.0)), []);
    // Two panes that touch at a corner leave two openings that do.
    let pane = |lo: f64| AxialFace::new(2, [lo, lo, 1.0], [lo + 2.0, lo + 2.0, 1.0]);
    let tree = cut(&[pane(0.0), pane(2.0)], 4, 0.0);
    let openings: Vec<_> = tree.portals().iter().map(|p| (p.min, p.max)).collect();
    assert_eq!(openings, [([0., 2., 1.], [2., 4., 1.]), ([2., 0., 1.], [4., 2., 1.])]);
}

#[test]
fn faces_without_extent_or_on_the_bounds_divide_nothing() {
    let faces = [upright(1.0, 2.0, 2.0), upright(0.0, 0.0, 4.0), upright(4.0, 1.0, 2.0), upright(9.0, 0.0, 4.0)];
    assert_eq!(cut(&faces, 4, 0.0).cells().len(), 1);
    let line = AxialFace::new(1, [0.0, 1.0, 2.0], [4.0, 1.0, 2.0]);
    assert_eq!(cut(&[line], 4, 0.0).cells().len(), 1, "a rectangle without height");
}

#[test]
fn negative_zero_is_zero() {
    let bounds = Aabb { min: [-2.0; 2], max: [2.0; 2] };
    let cut =
        |x: f64| subdivide(&[upright(x, -2.0, -0.0), upright(0.0, 0.0, 2.0)], bounds, &KdOptions::default()).unwrap();
    assert_eq!((cut(-0.0).cells().len(), cut(-0.0).portals().len()), (2, 0));
    assert_eq!(format!("{:?}", cut(-0.0)), format!("{:?}", cut(0.0)), "the same bits");
}

#[test]
fn the_largest_and_smallest_coordinates_are_cut() {
    let (huge, tiny) = (2.0f64.powi(200), 2.0f64.powi(-140));
    let bounds = Aabb { min: [-huge; 2], max: [huge; 2] };
    let walls = [upright(tiny, -huge, tiny), upright(-tiny, -tiny, huge), upright(0.0, -huge, huge)];
    for tau in [0.0, 0.5, 1.0] {
        let tree = subdivide(&walls, bounds, &KdOptions { tau, ..KdOptions::default() }).unwrap();
        assert!(tree.cells().len() >= 2 && tree.cells().iter().all(|c| c.bounds.min[0] < c.bounds.max[0]), "{tau}");
    }
}

#[test]
fn nested_boxes_make_a_deep_tree() {
    // Each ring of walls is peeled off by itself, so the tree is as deep as there are rings.
    let n_rings = 400;
    let ring = |i: u32| {
        let (lo, hi) = (f64::from(i), f64::from(2 * n_rings - i));
        let level = |y| AxialFace::new(1, [lo, y], [hi, y]);
        [upright(lo, lo, hi), upright(hi, lo, hi), level(lo), level(hi)]
    };
    let walls: Vec<AxialFace<2>> = (0..n_rings).flat_map(ring).collect();
    assert_eq!(bounds_of(&walls), grid(2 * n_rings));
    let tree = cut(&walls, 2 * n_rings, 0.0);
    assert_eq!(tree.cells().len() as u32, 4 * (n_rings - 1) + 1);
    // Nothing leads from ring to ring.
    let ring_of = |c: sightlines_pvs::CellId| {
        let b = tree.cells()[c.idx()].bounds;
        let side = f64::from(2 * n_rings);
        b.min[0].min(b.min[1]).min(side - b.max[0]).min(side - b.max[1])
    };
    assert!(tree.portals().iter().all(|p| ring_of(p.cells[0]) == ring_of(p.cells[1])));
}

//! Point location by planes, against integers.

use crate::common::full::{plane_choices, plane_nodes, wedges};
use proptest::prelude::*;
use sightlines_pvs::{
    CellId, DecodeErrorKind, PlaceBuffer, PlaneChild, PlaneError, PlaneNode, PlaneTree, Table, TableError,
};

fn found(tree: &PlaneTree, p: [f64; 3]) -> Vec<CellId> {
    let (mut cells, mut pending) = (Vec::new(), vec![9, 9]);
    tree.for_each_cell(p, &mut pending, |cell| cells.push(cell));
    cells.sort_unstable();
    cells.dedup();
    cells
}

/// Height over a plane, which must have integer coefficients.
fn height(node: &PlaneNode, p: [i64; 3]) -> i128 {
    let product = |k: usize| node.normal[k] as i128 * i128::from(p[k]);
    (0..3).map(product).sum::<i128>() - node.offset as i128
}

/// The oracle, from node to node: the cells on leaves whose planes all have `p` on the right side, or at most `slack`
/// on the wrong one.
fn expected(nodes: &[PlaneNode], p: [i64; 3], slack: impl Fn(&PlaneNode, [i64; 3]) -> i128 + Copy) -> Vec<CellId> {
    fn walk(
        nodes: &[PlaneNode],
        child: PlaneChild,
        p: [i64; 3],
        slack: impl Fn(&PlaneNode, [i64; 3]) -> i128 + Copy,
        out: &mut Vec<CellId>,
    ) {
        match child {
            PlaneChild::Nothing => {}
            PlaneChild::Cell(cell) => out.push(cell),
            PlaneChild::Node(node) => {
                let node = &nodes[node as usize];
                let (height, slack_here) = (height(node, p), slack(node, p));
                if height >= -slack_here {
                    walk(nodes, node.children[0], p, slack, out);
                }
                if height <= slack_here {
                    walk(nodes, node.children[1], p, slack, out);
                }
            }
        }
    }
    let mut out = Vec::new();
    walk(nodes, PlaneChild::Node(0), p, slack, &mut out);
    out.sort_unstable();
    out.dedup();
    out
}

/// A point of the plane through 0 with normal `n`, given a direction, moved by some steps.
fn beside(n: [i64; 3], m: [i64; 3], by: i64) -> [i64; 3] {
    let cross = |i: usize, j: usize| n[i] * m[j] - n[j] * m[i];
    [cross(1, 2) + by, cross(2, 0) - 2 * by, cross(0, 1) + by]
}

/// Planes and points whose products do not fit doubles; half of the points nearly on the plane.
fn large() -> impl Strategy<Value = (PlaneNode, [i64; 3])> {
    let wide = || prop::array::uniform3(-(1i64 << 50)..(1i64 << 50));
    (wide(), wide(), any::<bool>(), -4i64..5).prop_map(|(n, p, near, by)| {
        let small = |v: [i64; 3]| v.map(|x| x >> 25);
        let (n, p) = if near { (small(n), beside(small(n), small(p), by)) } else { (n, p) };
        let children = [PlaneChild::Cell(CellId(0)), PlaneChild::Cell(CellId(1))];
        (PlaneNode { normal: n.map(|x| x as f64), offset: 0.0, children }, p)
    })
}

proptest! {
    /// Invariant: on a small grid, where doubles are exact except for their bound, a point is found in exactly the
    /// cells whose closed leaves contain it; with a slack, in those not farther off.
    #[test]
    fn planes_small_grid_is_exact(choices in plane_choices(), p in [-5i64..6, -5i64..6, -5i64..6], slack in 0u8..3) {
        let nodes = plane_nodes(&choices, 5, 1.0);
        let tree = PlaneTree::new(nodes.clone(), f64::from(slack)).unwrap();
        let expected = expected(&nodes, p, |_, _| i128::from(slack));
        prop_assert_eq!(found(&tree, p.map(|x| x as f64)), expected);
    }

    /// Invariant: no rounding loses a cell.
    #[test]
    fn planes_soundness_no_cell_is_lost((node, p) in large(), slack in 0u8..3) {
        let tree = PlaneTree::new(vec![node], f64::from(slack)).unwrap();
        let found = found(&tree, p.map(|x| x as f64));
        prop_assert!(expected(&[node], p, |_, _| i128::from(slack)).iter().all(|cell| found.contains(cell)));
    }

    /// The tightness twin: a point goes to both sides only where rounding could matter.
    #[test]
    fn planes_tightness_clear_is_certain((node, p) in large()) {
        let tree = PlaneTree::new(vec![node], 0.0).unwrap();
        let size = |node: &PlaneNode, p: [i64; 3]| (0..3).map(|k| (node.normal[k] as i128 * i128::from(p[k])).abs()).sum::<i128>();
        let clear = expected(&[node], p, |node, p| size(node, p) >> 49);
        let found = found(&tree, p.map(|x| x as f64));
        prop_assert!(found.iter().all(|cell| clear.contains(cell)), "{:?} {:?}", found, clear);
    }

    /// Invariant: a box has the cells of all its points; with a single plane, exactly those of its corners; a larger
    /// box has at least as many.
    #[test]
    fn planes_boxes_have_the_cells_of_their_points(
        choices in plane_choices(),
        p in [-5i64..6, -5i64..6, -5i64..6],
        size in [0i64..4, 0i64..4, 0i64..4],
        unit in prop_oneof![Just(1.0), Just(0.1)],
    ) {
        let nodes = plane_nodes(&choices, 5, 1.0);
        let at = |p: [i64; 3]| p.map(|x| x as f64 * unit);
        let far = std::array::from_fn(|k| p[k] + size[k]);
        let of_box = |tree: &PlaneTree, min: [i64; 3], max: [i64; 3]| {
            let mut cells = Vec::new();
            tree.for_each_cell_of_box(at(min), at(max), &mut Vec::new(), |cell| { cells.push(cell); true });
            cells.sort_unstable();
            cells.dedup();
            cells
        };
        let tree = PlaneTree::new(nodes.clone(), 0.0).unwrap();
        let cells = of_box(&tree, p, far);
        let corners = (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 0 { p[k] } else { far[k] }));
        let at_corners = |tree: &PlaneTree| corners.clone().flat_map(|c: [i64; 3]| found(tree, at(c))).collect::<Vec<_>>();
        prop_assert!(at_corners(&tree).iter().all(|cell| cells.contains(cell)));
        let larger = of_box(&tree, p.map(|x| x - 1), far.map(|x| x + 2));
        prop_assert!(cells.iter().all(|cell| larger.contains(cell)));
        let children = [PlaneChild::Cell(CellId(0)), PlaneChild::Cell(CellId(1))];
        let one = PlaneTree::new(vec![PlaneNode { children, ..nodes[0] }], 0.0).unwrap();
        let mut cells = at_corners(&one);
        cells.sort_unstable();
        cells.dedup();
        prop_assert_eq!(of_box(&one, p, far), cells);
    }

    /// Whatever the numbers, at least one side is open.
    #[test]
    fn planes_extreme_numbers_lose_nothing(n in any::<[f64; 4]>(), p in any::<[f64; 3]>(), slack in any::<f64>()) {
        let children = [PlaneChild::Cell(CellId(0)), PlaneChild::Cell(CellId(1))];
        if let Ok(tree) = PlaneTree::new(vec![PlaneNode { normal: [n[0], n[1], n[2]], offset: n[3], children }], slack.abs()) {
            prop_assert!(!found(&tree, p).is_empty());
        }
    }
}

/// The impostor: without the bound, the plain formula loses cells that the oracle has.
#[test]
fn impostor_plain_doubles_lose_cells() {
    let lost = (0..1000i64).filter(|&t| {
        let n = [(1 << 25) - 12_345, (1 << 24) + 6_789 + t, 9_876_543];
        let p = beside(n, [7_654_321 + 31 * t, -(1 << 25) + 5, 12_345_677], t % 3 - 1);
        let node = PlaneNode { normal: n.map(|x| x as f64), offset: 0.0, children: [PlaneChild::Nothing; 2] };
        let plain: f64 = (0..3).map(|k| node.normal[k] * p[k] as f64).sum();
        let exact = height(&node, p);
        (exact >= 0 && plain < 0.0) || (exact <= 0 && plain > 0.0)
    });
    assert!(lost.count() > 0);
}

#[test]
fn tables_in_space_ask_the_planes() {
    let table = Table::new(wedges()).unwrap();
    let both = [CellId(0), CellId(1)];
    assert_eq!(table.in_dimension().unwrap().at([3.0, 1.0, 1.0]).cells(), [CellId(0)]);
    assert_eq!(table.in_dimension().unwrap().at([1.0, 3.0, 1.0]).cells(), [CellId(1)]);
    assert_eq!(table.in_dimension().unwrap().at([1.0, 1.0, 1.0]).cells(), both);
    assert_eq!(table.in_dimension().unwrap().at([1.0, 1.5, 1.0]).cells(), both, "within the slack");
    assert_eq!(
        table.in_dimension().unwrap().at([3.0, 1.0, -0.25]).cells(),
        [CellId(0)],
        "within the slack of the floor"
    );
    assert_eq!(table.in_dimension().unwrap().at([3.0, 1.0, -1.0]).cells(), []);
    assert_eq!(
        table.in_dimension().unwrap().at([9.0, 1.0, 1.0]).cells(),
        [CellId(0)],
        "the planes alone decide, not the boxes"
    );
    assert_eq!(table.in_dimension().unwrap().at([f64::NAN, 1.0, 1.0]).cells(), []);
    assert_eq!(table.in_dimension().unwrap().at([f64::INFINITY, 1.0, 1.0]).cells(), []);
    // Without the planes, the boxes decide; a stripped table keeps the planes.
    let mut parts = wedges();
    parts.planes = None;
    assert_eq!(Table::new(parts).unwrap().in_dimension().unwrap().at([3.0, 1.0, 1.0]).cells(), both);
    assert_eq!(table.strip_geometry().in_dimension().unwrap().at([3.0, 1.0, 1.0]).cells(), [CellId(0)]);
    // The scratch space does not affect the answer.
    let mut buffer = PlaceBuffer::new();
    let query = table.in_dimension().unwrap();
    assert_eq!(query.at_with([1.0, 1.0, 1.0], &mut buffer).cells(), both);
    assert!(query.at_with([1.0, f64::NAN, 1.0], &mut buffer).is_outside());
    assert_eq!(query.at_with([3.0, 1.0, 1.0], &mut buffer).cells(), [CellId(0)]);
}

#[test]
fn defects_of_planes_are_refused() {
    let node = |a, b| PlaneNode { normal: [1.0, 0.0, 0.0], offset: 0.0, children: [a, b] };
    let (at, none) = (PlaneChild::Node, PlaneChild::Nothing);
    let refused = |nodes: Vec<PlaneNode>| PlaneTree::new(nodes, 0.0).unwrap_err();
    assert_eq!(refused(vec![]), PlaneError::Empty);
    assert_eq!(refused(vec![node(at(0), none)]), PlaneError::Child { node: 0, child: 0 });
    assert_eq!(refused(vec![node(at(1), none)]), PlaneError::Child { node: 0, child: 1 });
    assert_eq!(refused(vec![node(at(1), at(1)), node(none, none)]), PlaneError::Shared { node: 1 });
    assert_eq!(refused(vec![node(at(1), none), node(at(0), none)]), PlaneError::Child { node: 1, child: 0 });
    assert_eq!(refused(vec![node(none, none), node(none, none)]), PlaneError::Unreachable { node: 1 });
    let far = PlaneChild::Cell(CellId(1 << 31));
    assert_eq!(refused(vec![node(far, none)]), PlaneError::TooMany { n: 1 << 31 });
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(refused(vec![PlaneNode { offset: bad, ..node(none, none) }]), PlaneError::NotFinite { node: 0 });
        assert_eq!(PlaneTree::new(vec![node(none, none)], bad).unwrap_err(), PlaneError::Slack);
    }
    assert_eq!(PlaneTree::new(vec![node(none, none)], -1.0).unwrap_err(), PlaneError::Slack);
    let chain = |n: u32| (0..n).map(|i| node(if i + 1 < n { at(i + 1) } else { none }, none)).collect::<Vec<_>>();
    assert!(PlaneTree::new(chain(1024), 0.0).is_ok());
    let deep = refused(chain(1025));
    assert_eq!(deep, PlaneError::TooDeep { node: 1024 });
    assert_eq!(deep.to_string(), "plane 1024 is deeper than 1024 levels");

    let mut parts = wedges();
    parts.planes = Some(PlaneTree::new(vec![node(PlaneChild::Cell(CellId(2)), none)], 0.0).unwrap());
    let error = Table::new(parts).unwrap_err();
    assert_eq!(error, TableError::Planes(PlaneError::UnknownCell { node: 0, cell: CellId(2) }));
    assert_eq!(error.to_string(), "plane 0 leads to cell 2, which does not exist");
    let mut flat = crate::common::rooms();
    flat.planes = wedges().planes;
    assert_eq!(Table::new(flat).unwrap_err(), TableError::Planes(PlaneError::Dimension));
}

/// The same defects in a file, with correct checksums.
#[test]
fn forged_planes_are_refused() {
    let forge = |at: usize, value: &[u8]| {
        let mut file = crate::common::file::File::parse(&Table::new(wedges()).unwrap().to_bytes());
        file.part(b"PLNS").bytes[at..at + value.len()].copy_from_slice(value);
        let error = Table::from_bytes(&file.write()).unwrap_err();
        assert_eq!(error.section.unwrap().0, *b"PLNS");
        error.kind
    };
    let planes = |error| DecodeErrorKind::Table(TableError::Planes(error));
    assert_eq!(forge(0, &f64::NAN.to_le_bytes()), planes(PlaneError::Slack));
    assert!(matches!(forge(8, &u32::MAX.to_le_bytes()), DecodeErrorKind::Cut { .. }));
    assert_eq!(forge(12, &f64::NAN.to_le_bytes()), planes(PlaneError::NotFinite { node: 0 }));
    assert_eq!(forge(12 + 32, &[5]), planes(PlaneError::Child { node: 0, child: 5 }));
    assert_eq!(forge(12 + 40 + 32, &[2]), planes(PlaneError::UnknownCell { node: 1, cell: CellId(2) }));
}

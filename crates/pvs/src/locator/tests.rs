//! The tree against brute force over boxes.

use super::*;
use proptest::prelude::*;
use std::collections::BTreeSet;

type Bounds = ([f64; 3], [f64; 3]);

/// Boxes on a small grid, some of them flat; many share faces.
fn boxes() -> impl Strategy<Value = (Vec<Bounds>, u8)> {
    let one = prop::array::uniform3((-6i8..7, 0i8..5)).prop_map(|spans| {
        (spans.map(|(at, _)| f64::from(at)), spans.map(|(at, size)| f64::from(at) + f64::from(size)))
    });
    (prop::collection::vec(one, 0..80), 2u8..4).prop_map(|(mut boxes, dimension)| {
        if dimension == 2 {
            boxes.iter_mut().for_each(|(min, max)| (min[2], max[2]) = (0.0, 0.0));
        }
        (boxes, dimension)
    })
}

fn contains((min, max): &Bounds, p: [f64; 3]) -> bool {
    (0..3).all(|k| min[k] <= p[k] && p[k] <= max[k])
}

/// A point at which the locator misses a box, over all grid points, half-way points included.
fn missed(locator: &Locator, boxes: &[Bounds], dimension: u8) -> Option<[f64; 3]> {
    let steps = || (-13i8..26).map(|i| f64::from(i) / 2.0);
    let zs: Vec<f64> = if dimension == 2 { vec![0.0] } else { steps().step_by(3).collect() };
    let mut points = zs.iter().flat_map(|&z| steps().flat_map(move |y| steps().map(move |x| [x, y, z])));
    points.find(|&p| {
        let mut found = BTreeSet::new();
        locator.for_each_candidate(p, |cell| {
            found.insert(cell.idx());
        });
        boxes.iter().enumerate().any(|(i, b)| contains(b, p) && !found.contains(&i))
    })
}

/// Length of the longest path.
fn depth(nodes: &[LocatorNode], at: usize) -> usize {
    match nodes[at] {
        LocatorNode::Inner { low, high, .. } => 1 + depth(nodes, low as usize).max(depth(nodes, high as usize)),
        LocatorNode::Leaf { .. } => 0,
    }
}

proptest! {
    #[test]
    fn locator_soundness_no_box_is_missed((boxes, dimension) in boxes()) {
        let locator = Locator::build(&boxes, dimension);
        prop_assert_eq!(locator.check(&boxes, dimension), Ok(()));
        prop_assert_eq!(missed(&locator, &boxes, dimension), None);
        prop_assert!(locator.n_entries() <= 4 * boxes.len());
        prop_assert_eq!(&Locator::build(&boxes, dimension), &locator);
    }

    #[test]
    fn locator_survives_its_nodes((boxes, dimension) in boxes()) {
        let locator = Locator::build(&boxes, dimension);
        prop_assert_eq!(Locator::from_nodes(&locator.to_nodes()), Ok(locator.clone()));
        let (nodes, cells) = locator.raw();
        prop_assert_eq!(Locator::from_raw(nodes.to_vec(), cells.to_vec()), Ok(locator.clone()));
    }

    /// The impostor: a locator with one entry less. An accepted locator misses nothing; and where brute force finds a
    /// miss, the check refuses.
    #[test]
    fn locator_impostors_are_caught((boxes, dimension) in boxes(), at in any::<prop::sample::Index>()) {
        let mut nodes = Locator::build(&boxes, dimension).to_nodes();
        let entries: Vec<(usize, usize)> = nodes.iter().enumerate().flat_map(|(i, node)| match node {
            LocatorNode::Leaf { cells } => (0..cells.len()).map(|k| (i, k)).collect::<Vec<_>>(),
            LocatorNode::Inner { .. } => vec![],
        }).collect();
        prop_assume!(!entries.is_empty());
        let (i, k) = entries[at.index(entries.len())];
        let LocatorNode::Leaf { cells } = &mut nodes[i] else { unreachable!("entries are of leaves") };
        let cell = cells.remove(k);
        let impostor = Locator::from_nodes(&nodes).unwrap();
        let reported = match impostor.check(&boxes, dimension) {
            Err(LocatorError::Misses { cell, .. }) => Some(cell),
            _ => None,
        };
        prop_assert_eq!(reported, Some(cell));
        // Brute force agrees, unless the piece of the box in that leaf is too thin for the grid of points.
        let (min, max) = boxes[cell.idx()];
        if dimension == 2 && (nodes.len() == 1 || (0..2).all(|axis| max[axis] > min[axis])) {
            prop_assert!(missed(&impostor, &boxes, dimension).is_some());
        }
    }

    /// Trees of any shape: an error or a tree, and no endless loop.
    #[test]
    fn locator_any_nodes_are_safe(raw in prop::collection::vec((any::<bool>(), 0u8..4, -3i8..3, 0u32..8, 0u32..8), 0..8)) {
        let nodes: Vec<LocatorNode> = raw.into_iter().map(|(leaf, axis, split, low, high)| match leaf {
            true => LocatorNode::Leaf { cells: (low..high).map(CellId).collect() },
            false => LocatorNode::Inner { axis, split: f64::from(split), low, high },
        }).collect();
        if let Ok(locator) = Locator::from_nodes(&nodes) {
            prop_assert_eq!(locator.n_nodes(), nodes.len());
            locator.for_each_candidate([f64::NAN; 3], |_| ());
            prop_assert_eq!(Locator::from_nodes(&locator.to_nodes()), Ok(locator));
        }
    }
}

/// The tightness twin: a point has few candidates; otherwise a list of all cells would pass.
#[test]
fn locator_tightness_few_candidates_on_a_grid() {
    let n = 64;
    let square = |i: i32| {
        let (x, y) = (f64::from(i % n), f64::from(i / n));
        ([x, y, 0.0], [x + 1.0, y + 1.0, 0.0])
    };
    let boxes: Vec<Bounds> = (0..n * n).map(square).collect();
    let locator = Locator::build(&boxes, 2);
    assert_eq!(locator.n_entries(), boxes.len(), "faces that meet are not listed on both sides");
    for i in 0..n * n {
        let mut found = 0;
        locator.for_each_candidate([f64::from(i % n) + 0.5, f64::from(i / n) + 0.5, 0.0], |_| found += 1);
        assert!((1..=8).contains(&found), "{found} candidates");
    }
    assert_eq!(depth(&locator.to_nodes(), 0), 9);
}

/// A k-d tree whose leaves are the cells is complete as it is, though boxes touch across its splits.
#[test]
fn locator_of_a_kd_tree_lists_each_cell_once() {
    let leaf = |i| LocatorNode::Leaf { cells: vec![CellId(i)] };
    let nodes = [
        LocatorNode::Inner { axis: 0, split: 1.0, low: 3, high: 1 },
        LocatorNode::Inner { axis: 1, split: 2.0, low: 4, high: 2 },
        leaf(2),
        leaf(0),
        leaf(1),
    ];
    let boxes = [([0., 0., 0.], [1., 4., 0.]), ([1., 0., 0.], [3., 2., 0.]), ([1., 2., 0.], [3., 4., 0.])];
    let locator = Locator::from_nodes(&nodes).unwrap();
    assert_eq!(locator.check(&boxes, 2), Ok(()));
    assert_eq!(missed(&locator, &boxes, 2), None);
    let mut found = vec![];
    locator.for_each_candidate([1.0, 2.0, 0.0], |cell| found.push(cell.0));
    assert_eq!(found, [0, 1, 2]);
}

#[test]
fn locator_defects_are_reported() {
    let inner = |low, high| LocatorNode::Inner { axis: 0, split: 0.0, low, high };
    let leaf = |cells: &[u32]| LocatorNode::Leaf { cells: cells.iter().copied().map(CellId).collect() };
    let error = |nodes: &[LocatorNode]| Locator::from_nodes(nodes).unwrap_err();
    assert_eq!(error(&[]), LocatorError::Empty);
    assert_eq!(error(&[inner(0, 0)]), LocatorError::Shared { node: 0 });
    assert_eq!(error(&[inner(1, 1), leaf(&[])]), LocatorError::Shared { node: 1 });
    assert_eq!(error(&[inner(1, 3), leaf(&[])]), LocatorError::Child { node: 0, child: 3 });
    assert_eq!(error(&[inner(1, 2), leaf(&[]), leaf(&[]), leaf(&[])]), LocatorError::Unreachable { node: 3 });
    assert_eq!(error(&[leaf(&[1, 1])]), LocatorError::Order { node: 0 });
    let inner = |axis, split| LocatorNode::Inner { axis, split, low: 1, high: 2 };
    assert_eq!(error(&[inner(3, 0.0), leaf(&[]), leaf(&[])]), LocatorError::Axis { node: 0, axis: 3 });
    assert_eq!(error(&[inner(0, f64::NAN), leaf(&[]), leaf(&[])]), LocatorError::Split { node: 0 });
    let upright = Locator::from_nodes(&[inner(2, 0.0), leaf(&[]), leaf(&[])]).unwrap();
    assert_eq!(upright.check(&[], 2), Err(LocatorError::Axis { node: 0, axis: 2 }));
    let foreign = Locator::from_nodes(&[leaf(&[4])]).unwrap();
    assert_eq!(foreign.check(&[], 2), Err(LocatorError::UnknownCell { node: 0, cell: CellId(4) }));
}

#[test]
fn locator_depth_is_bounded() {
    let chain = |n: u32| {
        let links = (0..n).map(|i| LocatorNode::Inner { axis: 0, split: 0.0, low: 2 * n - i, high: i + 1 });
        let leaves = (0..=n).map(|_| LocatorNode::Leaf { cells: vec![] });
        links.chain(leaves).collect::<Vec<_>>()
    };
    assert!(Locator::from_nodes(&chain(1024)).is_ok());
    assert!(matches!(Locator::from_nodes(&chain(1025)), Err(LocatorError::TooDeep { .. })));
    // Identical boxes, and nested boxes, do not make a deep tree either.
    let same = vec![([0.0; 3], [1.0; 3]); 1000];
    assert_eq!(Locator::build(&same, 3).n_nodes(), 1);
    let nested: Vec<Bounds> = (0..1000).map(|i| ([f64::from(-i); 3], [f64::from(i); 3])).collect();
    let nest = Locator::build(&nested, 3);
    assert_eq!(nest.check(&nested, 3), Ok(()));
    assert!(nest.n_entries() <= 4000 && depth(&nest.to_nodes(), 0) <= 24);
    // Nothing panics before the table refuses such boxes.
    assert_eq!(Locator::build(&[([f64::NAN; 3], [f64::NAN; 3]); 20], 2).n_entries(), 20);
}

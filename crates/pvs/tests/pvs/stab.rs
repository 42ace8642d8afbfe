//! Stored stab trees, against their sequences written out.

use crate::common::file::File;
use crate::common::full::{Choice, choices, stab_parts, villa};
use crate::common::rooms;
use proptest::prelude::*;
use sightlines_pvs::{BitMatrix, CellId, CellRecord, Locator, PortalId, PortalRecord};
use sightlines_pvs::{StabError, StabParts, StabTrees, Table, TableError, TableKind, TableParts};
use std::collections::{BTreeMap, BTreeSet};

/// Portals between few cells, so that a cell may have more than the sixteen entries that fit a mask.
fn network() -> impl Strategy<Value = (Vec<PortalRecord>, usize)> {
    (2usize..6).prop_flat_map(|n| {
        let portal = (0..n, 1..n).prop_map(move |(a, by)| portal_between(a, (a + by) % n));
        (prop::collection::vec(portal, 1..40), Just(n))
    })
}

fn any_stab() -> impl Strategy<Value = (Vec<PortalRecord>, usize, Vec<Choice>, Vec<Choice>)> {
    (network(), choices(0..30), choices(1..6)).prop_map(|((portals, n), nodes, roots)| (portals, n, nodes, roots))
}

/// Trees identified by their content, regardless of where they are stored: each gets a number.
#[derive(Default)]
struct Forest(BTreeMap<(u32, bool, BTreeSet<usize>), usize>);

/// The trees of each cell, and whether anything may follow.
type Trees = Vec<(BTreeSet<usize>, bool)>;

impl Forest {
    fn tree(&mut self, gate: u32, open: bool, children: BTreeSet<usize>) -> usize {
        let next = self.0.len();
        *self.0.entry((gate, open, children)).or_insert(next)
    }

    /// The oracle: the tree under each node of the parts, and those of the cells.
    fn of_parts(&mut self, parts: &StabParts) -> (Vec<usize>, Trees) {
        let range = |first: &[u32], i: usize| first[i] as usize..first[i + 1] as usize;
        let mut nodes: Vec<usize> = Vec::new();
        for (i, &gate) in parts.gates.iter().enumerate() {
            let children = &parts.children[range(&parts.first_child, i)];
            let children = children.iter().map(|&c| nodes[c as usize]).collect();
            nodes.push(self.tree(gate, parts.open[i], children));
        }
        let roots = |i: usize| parts.roots[range(&parts.first_root, i)].iter().map(|&r| nodes[r as usize]).collect();
        let trees = (0..parts.root_open.len()).map(|i| (roots(i), parts.root_open[i])).collect();
        (nodes, trees)
    }

    fn of_stab(&mut self, stab: &StabTrees) -> (Vec<usize>, Trees) {
        let mut nodes: Vec<usize> = Vec::new();
        for node in 0..stab.n_nodes() as u32 {
            let (portal, forward) = stab.gate(node);
            let children = stab.children(node).iter().map(|&c| nodes[c as usize]).collect();
            nodes.push(self.tree(2 * portal.0 + u32::from(!forward), stab.is_open(node), children));
        }
        let cells = (0..stab.n_cells() as u32).map(CellId);
        let roots = |cell| stab.roots(cell).iter().map(|&r| nodes[r as usize]).collect();
        let trees = cells.map(|cell| (roots(cell), stab.is_root_open(cell))).collect();
        (nodes, trees)
    }
}

/// The reachable nodes.
fn shown(parts: &StabParts) -> BTreeSet<u32> {
    let mut pending: Vec<u32> = parts.roots.clone();
    let mut seen: BTreeSet<u32> = BTreeSet::new();
    while let Some(node) = pending.pop() {
        if seen.insert(node) {
            let (a, b) = (parts.first_child[node as usize], parts.first_child[node as usize + 1]);
            pending.extend(&parts.children[a as usize..b as usize]);
        }
    }
    seen
}

fn opened(parts: &StabParts, portals: &[PortalRecord], n: usize) -> StabTrees {
    StabTrees::new(parts.clone(), portals, n).expect("trees over the portals")
}

/// The same trees with twice the nodes: each has a copy, which every other parent uses.
fn doubled(parts: &StabParts) -> StabParts {
    let mut out = StabParts::default();
    let list = |first: &[u32], items: &[u32], i: usize| -> Vec<u32> {
        let own = |(k, &node): (usize, &u32)| 2 * node + ((i + k) % 2) as u32;
        items[first[i] as usize..first[i + 1] as usize].iter().enumerate().map(own).rev().collect()
    };
    for (i, &gate) in parts.gates.iter().enumerate() {
        for _ in 0..2 {
            let children = list(&parts.first_child, &parts.children, i);
            out.push_node(PortalId(gate / 2), gate.is_multiple_of(2), &children, parts.open[i]);
        }
    }
    for cell in 0..parts.root_open.len() {
        out.push_cell(&list(&parts.first_root, &parts.roots, cell), parts.root_open[cell]);
    }
    out
}

proptest! {
    /// Invariant: no sequence is lost and none is added; each node is stored once, and only if it is used; children
    /// come before parents, and lists ascend.
    #[test]
    fn stab_trees_are_what_was_given((portals, n, nodes, roots) in any_stab()) {
        let parts = stab_parts(&portals, n, &nodes, &roots);
        let stab = opened(&parts, &portals, n);
        let mut forest = Forest::default();
        let ((given, expected), (kept, trees)) = (forest.of_parts(&parts), forest.of_stab(&stab));
        prop_assert_eq!(trees, expected);
        prop_assert_eq!(kept.len(), kept.iter().collect::<BTreeSet<_>>().len());
        let used: BTreeSet<usize> = shown(&parts).into_iter().map(|node| given[node as usize]).collect();
        prop_assert_eq!(kept.into_iter().collect::<BTreeSet<_>>(), used);
        for node in 0..stab.n_nodes() as u32 {
            let children = stab.children(node);
            prop_assert!(children.is_sorted_by(|a, b| a < b) && children.iter().all(|&c| c < node));
        }
        prop_assert!(stab.n_lists() <= stab.n_nodes());
    }

    /// Invariant: however the nodes are shared and numbered, the result is the same.
    #[test]
    fn stab_trees_have_one_order((portals, n, nodes, roots) in any_stab()) {
        let parts = stab_parts(&portals, n, &nodes, &roots);
        let stab = opened(&parts, &portals, n);
        prop_assert_eq!(&opened(&doubled(&parts), &portals, n), &stab);
        // Taken apart and reassembled.
        let mut again = StabParts::default();
        for node in 0..stab.n_nodes() as u32 {
            let (portal, forward) = stab.gate(node);
            again.push_node(portal, forward, stab.children(node), stab.is_open(node));
        }
        (0..n as u32).map(CellId).for_each(|cell| again.push_cell(stab.roots(cell), stab.is_root_open(cell)));
        prop_assert_eq!(opened(&again, &portals, n), stab);
    }

    /// Invariant: the number of sequences is that of walks from the roots, counted one by one.
    #[test]
    fn stab_sequences_are_counted((portals, n, nodes, roots) in any_stab()) {
        let stab = opened(&stab_parts(&portals, n, &nodes, &roots), &portals, n);
        let (mut pending, mut walks) = (Vec::new(), 0u128);
        (0..n as u32).for_each(|cell| pending.extend(stab.roots(CellId(cell))));
        while let Some(node) = pending.pop() {
            walks += 1;
            if walks > 20_000 {
                break;
            }
            pending.extend(stab.children(node));
        }
        let all = walks <= 20_000;
        prop_assert!(stab.n_sequences() == walks || (!all && stab.n_sequences() > walks));
        let edges = (0..stab.n_nodes() as u32).map(|node| stab.children(node).len() as u64).sum::<u64>();
        prop_assert_eq!(stab.n_edges(), edges);
    }

    /// Invariant: written trees can be read, with cells of few entries and of many.
    #[test]
    fn stab_trees_survive_a_file((portals, n, nodes, roots) in any_stab()) {
        let stab = opened(&stab_parts(&portals, n, &nodes, &roots), &portals, n);
        let table = table_with(portals, n, stab);
        let bytes = table.to_bytes();
        let read = Table::from_bytes(&bytes);
        prop_assert_eq!(read.as_ref(), Ok(&table));
        prop_assert_eq!(read.unwrap().to_bytes(), bytes);
    }

    /// The impostor: trees that differ in one flag are distinguished.
    #[test]
    fn impostor_trees_differ((portals, n, nodes, roots) in any_stab(), at in any::<prop::sample::Index>()) {
        let parts = stab_parts(&portals, n, &nodes, &roots);
        let stab = opened(&parts, &portals, n);
        let mut less = StabParts::default();
        let gone = at.index(stab.n_nodes() + n);
        for node in 0..stab.n_nodes() {
            let (portal, forward) = stab.gate(node as u32);
            less.push_node(portal, forward, stab.children(node as u32), stab.is_open(node as u32) ^ (node == gone));
        }
        for cell in 0..n as u32 {
            let flip = gone == stab.n_nodes() + cell as usize;
            less.push_cell(stab.roots(CellId(cell)), stab.is_root_open(CellId(cell)) ^ flip);
        }
        let other = opened(&less, &portals, n);
        let mut forest = Forest::default();
        prop_assert_ne!(forest.of_stab(&other).1, forest.of_stab(&stab).1);
        prop_assert_ne!(other, stab);
    }

    /// A child or a root that begins elsewhere is refused.
    #[test]
    fn impostor_children_apart_are_refused((portals, n, nodes, roots) in any_stab(), at in any::<prop::sample::Index>()) {
        let mut parts = stab_parts(&portals, n, &nodes, &roots);
        // Without children there is nothing to damage.
        if parts.children.is_empty() {
            return Ok(());
        }
        // A reversed gate begins in the cell that it led into, which is another one.
        let k = at.index(parts.children.len());
        let child = parts.children[k];
        parts.gates[child as usize] ^= 1;
        let error = StabTrees::new(parts, &portals, n).unwrap_err();
        prop_assert!(matches!(error, StabError::Apart { .. } | StabError::Root { .. }), "{}", error);
    }
}

#[test]
fn trees_of_the_villa_share_nodes() {
    let table = Table::new(villa()).unwrap();
    let stab = table.stab().unwrap();
    assert_eq!((stab.n_cells(), stab.n_nodes(), stab.n_edges(), stab.n_sequences()), (5, 8, 4, 10));
    assert!(stab.is_root_open(CellId(4)) && stab.roots(CellId(4)).is_empty());
    let mut doors: BTreeMap<(PortalId, bool), usize> = BTreeMap::new();
    (0..8).for_each(|node| *doors.entry(stab.gate(node)).or_default() += 1);
    assert_eq!(doors.values().copied().collect::<Vec<_>>(), [1, 1, 2, 2, 1, 1]);
    assert_eq!((0..8).filter(|&node| stab.is_open(node)).count(), 1);
    assert_eq!(table.strip_geometry().stab(), None, "trees need their portals");
}

/// A table in the plane with nothing else in it.
fn table_with(portals: Vec<PortalRecord>, n_cells: usize, stab: StabTrees) -> Table {
    let cell = CellRecord { min: [0.0; 3], max: [0.0; 3], group: None, polygon: vec![] };
    Table::new(TableParts {
        cells: vec![cell; n_cells],
        portals,
        rows: BitMatrix::identity(n_cells),
        cell_objects: vec![vec![]; n_cells],
        locator: Locator::build(&vec![([0.0; 3], [0.0; 3]); n_cells], 2),
        stab: Some(stab),
        ..TableParts::empty(2, TableKind::Unspecified)
    })
    .expect("a table of nothing but trees")
}

fn portal_between(a: usize, b: usize) -> PortalRecord {
    PortalRecord { cells: [a, b].map(|i| CellId(i as u32)), sides: [0, 0], points: vec![[0.0; 3]; 2] }
}

/// Bytes of the section.
fn section_len(table: &Table) -> usize {
    File::parse(&table.to_bytes()).part(b"STAB").bytes.len()
}

/// Both forms of a header: sixteen entries have a mask, seventeen a list.
#[test]
fn headers_are_masks_or_lists() {
    for (n, expected) in [(16, 1 + 1 + 3 + 1 + 1 + 16 + 1), (17, 1 + 1 + 1 + 1 + 17 + 1 + 1 + 17 + 1)] {
        let portals = vec![portal_between(0, 1); n];
        let mut parts = StabParts::default();
        let roots: Vec<u32> = (0..n as u32).map(|portal| parts.push_node(PortalId(portal), true, &[], false)).collect();
        parts.push_cell(&roots, false);
        parts.push_cell(&[], false);
        let table = table_with(portals.clone(), 2, opened(&parts, &portals, 2));
        assert_eq!(section_len(&table), expected, "{n} entries");
        assert_eq!(Table::from_bytes(&table.to_bytes()), Ok(table));
    }
}

/// Rooms on a grid, and all paths of at most eight steps that never go back: their trees, stored.
#[test]
fn trees_on_a_grid_are_small() {
    let side = 12usize;
    let cell = |x: usize, y: usize| y * side + x;
    let mut portals = Vec::new();
    // For each room its gates to the east, north, west and south.
    let mut gates = vec![[None; 4]; side * side];
    for (x, y) in (0..side).flat_map(|y| (0..side).map(move |x| (x, y))) {
        for (way, (x1, y1)) in [(x + 1, y), (x, y + 1)].into_iter().enumerate().filter(|(_, to)| to.0.max(to.1) < side)
        {
            let portal = portals.len() as u32;
            portals.push(portal_between(cell(x, y), cell(x1, y1)));
            gates[cell(x, y)][way] = Some((portal, true));
            gates[cell(x1, y1)][way + 2] = Some((portal, false));
        }
    }
    let into = |(portal, forward): (u32, bool)| portals[portal as usize].cells[usize::from(forward)].idx();
    let mut parts = StabParts::default();
    let mut roots: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); side * side];
    // A quadrant has two directions; nodes[room][direction]: the node that crosses that gate with this many steps to
    // go.
    for quadrant in 0..4 {
        let ways = [quadrant, (quadrant + 1) % 4];
        let mut nodes: Vec<Vec<u32>> = vec![Vec::new(); side * side];
        for _ in 0..8 {
            let step = |from: usize| ways.into_iter().filter_map(|way| gates[from][way]).collect::<Vec<_>>();
            let longer = (0..side * side).map(|from| {
                let cross = |gate: (u32, bool)| parts.push_node(PortalId(gate.0), gate.1, &nodes[into(gate)], false);
                step(from).into_iter().map(cross).collect()
            });
            nodes = longer.collect();
        }
        roots.iter_mut().zip(&nodes).for_each(|(roots, nodes)| roots.extend(nodes));
    }
    roots.iter().for_each(|roots| parts.push_cell(&roots.iter().copied().collect::<Vec<_>>(), false));
    let n_cells = side * side;
    let stab = opened(&parts, &portals, n_cells);
    let (n_nodes, plain) = (stab.n_nodes() as f64, 12.0 * stab.n_sequences() as f64);
    let table = table_with(portals, n_cells, stab);
    let bytes = section_len(&table) as f64;
    eprintln!("{n_nodes} nodes in {bytes} bytes: {:.2} each, plain {plain}", bytes / n_nodes);
    assert!(n_nodes > 4000.0 && bytes < 4.0 * n_nodes && bytes < plain / 100.0);
    assert_eq!(Table::from_bytes(&table.to_bytes()), Ok(table));
}

/// Numbers of sequences saturate at the maximum.
#[test]
fn numbers_of_sequences_saturate() {
    // Two cells with two portals: every step doubles.
    let portals = vec![portal_between(0, 1); 2];
    let mut parts = StabParts::default();
    let mut last: Vec<u32> = Vec::new();
    for step in 0..200 {
        last = (0..2).map(|portal| parts.push_node(PortalId(portal), step % 2 == 1, &last, false)).collect();
    }
    parts.push_cell(&last, false);
    parts.push_cell(&[], false);
    let stab = StabTrees::new(parts, &portals, 2).unwrap();
    assert_eq!((stab.n_nodes(), stab.n_lists(), stab.n_sequences()), (400, 200, u128::MAX));
}

/// Introduces one defect.
type Spoil = fn(&mut StabParts);

/// Each defect alone is refused, with its position.
#[test]
fn defects_of_stab_trees_are_refused() {
    let portals = rooms().portals;
    let good = || {
        let mut parts = StabParts::default();
        let end = parts.push_node(PortalId(1), true, &[], false);
        let root = parts.push_node(PortalId(0), true, &[end], false);
        [&[root][..], &[end], &[], &[], &[]].into_iter().for_each(|roots| parts.push_cell(roots, false));
        parts
    };
    assert!(StabTrees::new(good(), &portals, 5).is_ok());
    let cases: [(Spoil, StabError, &str); 10] = [
        (
            |p| p.open.truncate(1),
            StabError::Lists { n: 1, expected: 2 },
            "the lists of the stab trees have 1 entries where 2 are needed",
        ),
        (
            |p| p.first_child.truncate(2),
            StabError::Lists { n: 2, expected: 3 },
            "the lists of the stab trees have 2 entries where 3 are needed",
        ),
        (
            |p| p.first_child[0] = 1,
            StabError::Bounds { list: 0 },
            "list 0 of the stab trees does not lie where it must",
        ),
        (
            |p| p.first_child[1] = 9,
            StabError::Bounds { list: 1 },
            "list 1 of the stab trees does not lie where it must",
        ),
        (|p| p.roots.push(0), StabError::Bounds { list: 5 }, "list 5 of the stab trees does not lie where it must"),
        (
            |p| p.push_cell(&[], false),
            StabError::Cells { n: 6, n_cells: 5 },
            "the stab trees are of 6 cells, the table has 5",
        ),
        (
            |p| p.gates[0] = 6,
            StabError::Portal { node: 0, portal: 3 },
            "node 0 of the stab trees crosses portal 3, which does not exist",
        ),
        (
            |p| p.children[0] = 1,
            StabError::Child { node: 1, child: 1 },
            "node 1 of the stab trees has child 1, which does not come before it",
        ),
        (
            |p| p.gates[0] = 4,
            StabError::Apart { node: 1, child: 0 },
            "node 1 of the stab trees does not lead to where its child 0 begins",
        ),
        (
            |p| p.roots[0] = 0,
            StabError::Root { cell: CellId(0), root: 0 },
            "node 0 of the stab trees does not begin in cell 0",
        ),
    ];
    for (spoil, expected, text) in cases {
        let mut parts = good();
        spoil(&mut parts);
        let error = StabTrees::new(parts, &portals, 5).unwrap_err();
        assert_eq!((&error, error.to_string().as_str()), (&expected, text));
    }
    // Valid trees of another table.
    let mut parts = villa();
    parts.portals.pop();
    assert!(matches!(Table::new(parts).unwrap_err(), TableError::Stab(StabError::Portal { portal: 2, .. })));
}

//! Tables with all optional parts.

use super::{any_parts, rooms};
use proptest::prelude::*;
use sightlines_pvs::{
    Axis, BitMatrix, CellId, CellRecord, Locator, MirrorId, MirrorRecord, PlaneChild, PlaneNode, PlaneTree, PortalId,
    PortalRecord, SceneMethods, StabParts, StabTrees, TableKind, TableParts,
};

/// The rooms with a mirror at the western wall, numbers of polygons, and their stab trees by hand: the door that is the
/// first of one tree and the last of another is stored once.
pub(crate) fn villa() -> TableParts {
    let parts = rooms();
    let mut stab = StabParts::default();
    // Eastwards: the last door, the middle one before it, and so on; westwards likewise.
    let last = stab.push_node(PortalId(2), true, &[], false);
    let middle = stab.push_node(PortalId(1), true, &[last], false);
    let end = stab.push_node(PortalId(1), true, &[], false);
    let first = stab.push_node(PortalId(0), true, &[end], false);
    let back = [stab.push_node(PortalId(0), false, &[], false), stab.push_node(PortalId(1), false, &[], true)];
    let home = stab.push_node(PortalId(1), false, &[back[0]], false);
    let from_last = stab.push_node(PortalId(2), false, &[back[1]], false);
    for (roots, open) in
        [(&[first][..], false), (&[back[0], middle], false), (&[last, home], false), (&[from_last], false), (&[], true)]
    {
        stab.push_cell(roots, open);
    }
    TableParts {
        mirrors: vec![
            MirrorRecord { cell: CellId(0), mirror: MirrorId(7), points: vec![[0.0, 1.0, 0.0], [0.0, 3.0, 0.0]] },
            MirrorRecord {
                cell: CellId(3),
                mirror: MirrorId(u32::MAX),
                points: vec![[14.0, 4.0, 0.0], [15.0, 4.0, 0.0]],
            },
        ],
        object_polygons: vec![12, 0],
        stab: Some(StabTrees::new(stab, &parts.portals, parts.cells.len()).expect("trees of the rooms")),
        ..parts
    }
}

/// All kinds of tables.
pub(crate) fn kinds() -> Vec<TableKind> {
    let bit = |k: u32, bits: u32| bits >> k & 1 == 1;
    let methods =
        |bits| SceneMethods { sightlines: bit(0, bits), from_region: bit(1, bits), only_in_air: bit(2, bits) };
    let methods: [SceneMethods; 8] = std::array::from_fn(|bits| methods(bits as u32));
    let mut all = vec![TableKind::Unspecified, TableKind::PlanKdTree, TableKind::PlanTriangulation];
    all.extend(methods.map(|hidden_by| TableKind::SceneKdTree { hidden_by }));
    all.extend(methods.map(|hidden_by| TableKind::SceneGivenCells { hidden_by }));
    all.extend([TableKind::QuakePortalFile, TableKind::QuakeMap]);
    all
}

/// The wedges as a map with the third axis up.
pub(crate) fn map_of_wedges() -> TableParts {
    TableParts { kind: TableKind::QuakeMap, up: Some(Axis::Z), ..wedges() }
}

/// The villa with names of its cells: two that are equal, an empty one, one that is not ASCII.
pub(crate) fn named_villa() -> TableParts {
    let names = ["room0_Living Room", "hall", "", "Küche", "hall"];
    TableParts { cell_names: names.map(str::to_owned).to_vec(), ..villa() }
}

/// Two wedges of a box in space, divided by the plane x = y with a slack of a half, nothing below z = 0,
/// a mirror on the floor, and a portal that is open on all trees.
pub(crate) fn wedges() -> TableParts {
    let cell = CellRecord { min: [0.0; 3], max: [4.0; 3], group: None, polygon: vec![] };
    let mut rows = BitMatrix::identity(2);
    rows.set(0, 1, true);
    rows.set(1, 0, true);
    let diagonal = vec![[0.0, 0.0, 0.0], [4.0, 4.0, 0.0], [4.0, 4.0, 4.0], [0.0, 0.0, 4.0]];
    let portals = vec![PortalRecord { cells: [CellId(0), CellId(1)], sides: [0, 0], points: diagonal }];
    let nodes = vec![
        PlaneNode { normal: [0.0, 0.0, 1.0], offset: 0.0, children: [PlaneChild::Node(1), PlaneChild::Nothing] },
        PlaneNode {
            normal: [1.0, -1.0, 0.0],
            offset: 0.0,
            children: [PlaneChild::Cell(CellId(0)), PlaneChild::Cell(CellId(1))],
        },
    ];
    let mut stab = StabParts::default();
    let across = [stab.push_node(PortalId(0), true, &[], true), stab.push_node(PortalId(0), false, &[], true)];
    across.iter().for_each(|&root| stab.push_cell(&[root], false));
    TableParts {
        rows,
        cell_objects: vec![vec![], vec![]],
        mirrors: vec![MirrorRecord {
            cell: CellId(1),
            mirror: MirrorId(0),
            points: vec![[0.0, 1.0, 0.0], [0.0, 3.0, 0.0], [1.0, 3.0, 0.0]],
        }],
        locator: Locator::build(&[(cell.min, cell.max), (cell.min, cell.max)], 3),
        planes: Some(PlaneTree::new(nodes, 0.5).expect("a tree")),
        stab: Some(StabTrees::new(stab, &portals, 2).expect("trees of two wedges")),
        portals,
        cells: vec![cell.clone(), cell],
        ..TableParts::empty(3, TableKind::Unspecified)
    }
}

/// A random choice for a node or cell: a gate, some of the nodes that fit, a flag.
pub(crate) type Choice = (u32, u64, bool);

/// The cells that a gate leads from and into.
pub(crate) fn ends(portals: &[PortalRecord], gate: u32) -> [CellId; 2] {
    let [a, b] = portals[gate as usize / 2].cells;
    if gate.is_multiple_of(2) { [a, b] } else { [b, a] }
}

/// Parts of stab trees with a node for each of `nodes` and a tree for each cell; not without portals.
pub(crate) fn stab_parts(portals: &[PortalRecord], n_cells: usize, nodes: &[Choice], roots: &[Choice]) -> StabParts {
    let mut parts = StabParts::default();
    let mut leaving: Vec<Vec<u32>> = vec![Vec::new(); n_cells];
    // Late nodes first, so that there are long sequences.
    let some = |of: &[u32], mask: u64| -> Vec<u32> {
        of.iter().rev().enumerate().filter(|(i, _)| mask >> (i % 64) & 1 == 1).map(|(_, &node)| node).take(6).collect()
    };
    for &(gate, mask, open) in nodes.iter().filter(|_| !portals.is_empty()) {
        let gate = gate % (2 * portals.len() as u32);
        let [from, into] = ends(portals, gate);
        let node = parts.push_node(PortalId(gate / 2), gate.is_multiple_of(2), &some(&leaving[into.idx()], mask), open);
        leaving[from.idx()].push(node);
    }
    for (cell, &(_, mask, open)) in roots.iter().cycle().take(n_cells).enumerate() {
        parts.push_cell(&some(&leaving[cell], mask), open);
    }
    parts
}

pub(crate) fn choices(n: impl Into<proptest::collection::SizeRange>) -> impl Strategy<Value = Vec<Choice>> {
    // Open nodes are rare.
    prop::collection::vec((any::<u32>(), any::<u64>(), (0u8..8).prop_map(|x| x == 0)), n)
}

/// A tree of planes through a small grid, one node for each choice.
pub(crate) fn plane_nodes(choices: &[([i8; 3], i8, usize, [u32; 2])], n_cells: usize, unit: f64) -> Vec<PlaneNode> {
    let end = |x: u32| match x as usize % (n_cells + 1) {
        0 => PlaneChild::Nothing,
        cell => PlaneChild::Cell(CellId(cell as u32 - 1)),
    };
    let mut nodes: Vec<PlaneNode> = Vec::new();
    for (i, (normal, offset, place, ends)) in choices.iter().enumerate() {
        // Replaces some child that is no node.
        let free: Vec<(usize, usize)> = (0..2 * nodes.len())
            .map(|k| (k / 2, k % 2))
            .filter(|&(node, side)| !matches!(nodes[node].children[side], PlaneChild::Node(_)))
            .collect();
        if i > 0 {
            let (node, side) = free[place % free.len()];
            nodes[node].children[side] = PlaneChild::Node(i as u32);
        }
        let normal = normal.map(f64::from);
        nodes.push(PlaneNode { normal, offset: unit * f64::from(*offset), children: ends.map(end) });
    }
    nodes
}

pub(crate) fn plane_choices() -> impl Strategy<Value = Vec<([i8; 3], i8, usize, [u32; 2])>> {
    prop::collection::vec(([-2i8..3, -2i8..3, -2i8..3], -4i8..5, any::<usize>(), any::<[u32; 2]>()), 1..12)
}

/// Any valid table, with any optional parts.
pub(crate) fn any_full_parts() -> impl Strategy<Value = TableParts> {
    let mirrors = prop::collection::vec((any::<u32>(), any::<u32>(), any::<[i8; 3]>()), 0..4);
    let planes = prop::option::of((plane_choices(), 0u8..3));
    let stab = prop::option::of((choices(0..40), choices(1..8)));
    let polygons = prop::option::of(any::<[u32; 4]>());
    let names = prop::option::of(prop::collection::vec(".{0,4}", 1..4));
    let made = (prop::sample::select(kinds()), prop::option::of(prop::sample::select(Axis::ALL.to_vec())));
    let parts = (any_parts(), mirrors, planes, stab, polygons, names, made);
    parts.prop_map(|(mut parts, mirrors, planes, stab, polygons, names, (kind, up))| {
        if kind.dimension().is_none_or(|d| d == parts.dimension) {
            (parts.kind, parts.up) = (kind, up);
        }
        let n_cells = parts.cells.len();
        let flat = parts.dimension == 2;
        if n_cells > 0 {
            let record = |(cell, face, [x, y, z]): (u32, u32, [i8; 3])| {
                let at = |x: i8| [f64::from(x), f64::from(y), if flat { 0.0 } else { f64::from(z) }];
                let points = [x, y, z, 0].map(at)[..if flat { 2 } else { 4 }].to_vec();
                MirrorRecord { cell: CellId(cell % n_cells as u32), mirror: MirrorId(face), points }
            };
            parts.mirrors = mirrors.into_iter().map(record).collect();
        }
        if let Some((choices, slack)) = planes.filter(|_| !flat) {
            let nodes = plane_nodes(&choices, n_cells, 1.0);
            parts.planes = Some(PlaneTree::new(nodes, f64::from(slack)).expect("a tree"));
        }
        if let Some((nodes, roots)) = stab {
            let trees = stab_parts(&parts.portals, n_cells, &nodes, &roots);
            parts.stab = Some(StabTrees::new(trees, &parts.portals, n_cells).expect("trees over the portals"));
        }
        if let Some(polygons) = polygons {
            parts.object_polygons = polygons[..parts.objects.len()].to_vec();
        }
        if let Some(names) = names {
            parts.cell_names = names.into_iter().cycle().take(n_cells).collect();
        }
        parts
    })
}

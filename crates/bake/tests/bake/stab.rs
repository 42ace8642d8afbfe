//! Stab trees in tables: lines shot through a scene pass only sequences that the trees have, or have cut.

use sightlines_bake::{
    GraphRef, OtherGraph, PlanBakeOptions, PrtOptions, SceneBakeOptions, StabBakeError, StabOptions, TableGraph,
    bake_plan, bake_prt, bake_scene, from_table, with_stab_trees,
};
use sightlines_formats::quake::prt::parse_prt;
use sightlines_geometry::{Aabb, Point2, Portal3, orient2d};
use sightlines_pvs::{CellId, PortalId, StabParts, StabTrees, Table};
use sightlines_scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines_sightline::Line3;
use sightlines_testkit::Random;

/// Lines for each scene.
const N_LINES: u64 = 1_000;
/// Budgets of trees: most are cut, some are cut, none is.
const BUDGETS: [Option<usize>; 3] = [Some(12), Some(150), None];

/// A table of each kind with its graph, by name.
pub(crate) fn tables() -> Vec<(&'static str, Table, TableGraph)> {
    let options = OfficeOptions { rooms_x: 6, rooms_y: 3, block: 3, ..OfficeOptions::default() };
    let plan = office(options).expect("options in range");
    let plan = bake_plan(&plan, &PlanBakeOptions::default()).expect("a sound plan").into_any();
    let scene = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
    let scene = tower(scene).expect("options in range");
    let boxes = bake_scene(&scene, &SceneBakeOptions::default()).expect("a sound scene").into_any();
    let convex =
        bake_prt(&parse_prt(&windows()).expect("a sound file"), PrtOptions::default()).expect("portals").into_any();
    [("plan", plan), ("boxes", boxes), ("convex", convex)].map(|(name, b)| (name, b.table, b.graph)).into()
}

/// A portal file of four by three rooms of side 4, each with one window, and at times two, into the next along x and y.
fn windows() -> Vec<u8> {
    let id = |x: i32, y: i32| x + 4 * y;
    let mut portals = Vec::new();
    for (x, y) in (0..3).flat_map(|y| (0..4).map(move |x| (x, y))) {
        for k in 0..1 + (x + y) % 2 {
            let (low, up) = (f64::from(k) * 2.0 + f64::from((2 * x + y) % 3) * 0.5, f64::from((x + 2 * y) % 3));
            let (at_x, at_y) = (f64::from(4 * (x + 1)), f64::from(4 * (y + 1)));
            let corners = [(low, up), (low + 0.75, up), (low + 0.75, up + 1.0), (low, up + 1.0)];
            let list = |point: &dyn Fn(f64, f64) -> [f64; 3]| -> String {
                let text = |&(a, b): &(f64, f64)| {
                    let [x, y, z] = point(a, b);
                    format!(" ({x} {y} {z})")
                };
                corners.iter().map(text).collect()
            };
            if x < 3 {
                let (from, to) = (id(x, y), id(x + 1, y));
                portals.push(format!("4 {from} {to}{}", list(&|a, b| [at_x, f64::from(4 * y) + a, b])));
            }
            if y < 2 {
                let (from, to) = (id(x, y), id(x, y + 1));
                portals.push(format!("4 {from} {to}{}", list(&|a, b| [f64::from(4 * x + 4) - a, at_y, b])));
            }
        }
    }
    format!("PRT1\n12\n{}\n{}\n", portals.len(), portals.join("\n")).into_bytes()
}

/// Portals by gate: the cells from and to, and whether a line through two points passes, decided exactly.
struct Gates {
    ends: Vec<[CellId; 2]>,
    shapes: Vec<Shape>,
    exits: Vec<Vec<u32>>,
}

enum Shape {
    Flat([Point2; 2]),
    Solid(Portal3),
}

impl Gates {
    fn of(table: &Table) -> Self {
        let mut gates = Self { ends: vec![], shapes: vec![], exits: vec![Vec::new(); table.n_cells()] };
        for portal in table.portals() {
            for forward in [true, false] {
                let [a, b] = portal.cells;
                gates.ends.push(if forward { [a, b] } else { [b, a] });
                let shape = match portal.points[..] {
                    [[lx, ly, _], [rx, ry, _]] => {
                        let [l, r] = [Point2::new(lx, ly), Point2::new(rx, ry)];
                        Shape::Flat(if forward { [l, r] } else { [r, l] })
                    }
                    _ => {
                        let corners = portal.points.iter().rev().copied().collect();
                        let shape = Portal3::of_corners(corners).expect("polygons with area");
                        Shape::Solid(if forward { shape } else { shape.reversed() })
                    }
                };
                gates.shapes.push(shape);
                let gate = gates.shapes.len() as u32 - 1;
                gates.exits[gates.ends[gate as usize][0].idx()].push(gate);
            }
        }
        gates
    }

    fn passes(&self, gate: u32, line: &Line3) -> bool {
        match &self.shapes[gate as usize] {
            Shape::Solid(portal) => line.passes(portal),
            Shape::Flat([left, right]) => {
                let [a, b] = [line.a, line.b].map(|p| Point2::new(p[0], p[1]));
                orient2d(a, b, *left) > 0.0 && orient2d(a, b, *right) < 0.0
            }
        }
    }

    /// The gates that a line passes from `first` on, until it meets a wall or an edge.
    fn follow(&self, first: u32, line: &Line3) -> Vec<u32> {
        let mut passed = vec![first];
        while passed.len() < self.exits.len() {
            let last = passed[passed.len() - 1];
            let onward = |&&gate: &&u32| gate != last ^ 1 && self.passes(gate, line);
            match self.exits[self.ends[last as usize][1].idx()].iter().find(onward) {
                Some(&next) => passed.push(next),
                None => break,
            }
        }
        passed
    }
}

/// Whether the trees have a sequence, or were cut on the way.
fn covers(trees: &StabTrees, from: CellId, sequence: &[u32]) -> bool {
    let (mut nodes, mut open) = (trees.roots(from), trees.is_root_open(from));
    for &gate in sequence {
        let is_gate = |&&node: &&u32| trees.gate(node) == (PortalId(gate / 2), gate % 2 == 0);
        match nodes.iter().find(is_gate) {
            Some(&node) => (nodes, open) = (trees.children(node), trees.is_open(node)),
            None => return open,
        }
    }
    true
}

/// How many sequences lines were seen to pass, and how many of them are lost.
fn shoot(table: &Table, trees: &StabTrees) -> (u64, u64) {
    let gates = Gates::of(table);
    let middle = |p: &[f64; 3], q: &[f64; 3], t: f64| [0, 1, 2].map(|k| p[k] + (q[k] - p[k]) * t);
    let (mut passed, mut lost) = (0, 0);
    for number in 0..N_LINES {
        let mut random = Random::new(7, number);
        let mut point = || {
            let points = &table.portals()[random.below(table.portals().len())].points;
            let [p, q] = [0, points.len() / 2].map(|k| points[k]);
            middle(&p, &q, random.unit())
        };
        let Some(line) = Line3::through(point(), point()) else { continue };
        for gate in (0..gates.ends.len() as u32).filter(|&gate| gates.passes(gate, &line)) {
            let sequence = gates.follow(gate, &line);
            passed += 1;
            lost += u64::from(!covers(trees, gates.ends[gate as usize][0], &sequence));
        }
    }
    (passed, lost)
}

fn options(max_nodes: Option<usize>, threads: usize) -> StabOptions<'static> {
    StabOptions { max_nodes, threads, ..StabOptions::default() }
}

/// Invariant: what a line was seen to pass is in the trees, or beyond a cut; nothing else of a table changes; any
/// number of threads gives the same bytes.
#[test]
fn lines_pass_what_trees_have() {
    for (name, table, graph) in tables() {
        for max_nodes in BUDGETS {
            let baked = with_stab_trees(table.clone(), &graph, &options(max_nodes, 1)).expect("a table with portals");
            let trees = baked.table.stab().expect("trees were added");
            let (passed, lost) = shoot(&table, trees);
            assert!(passed > N_LINES && lost == 0, "{name}, {max_nodes:?}: {lost} of {passed} are lost");
            assert_eq!(trees.n_sequences(), u128::from(baked.report.trees.n_sequences), "{name}");
            let again =
                with_stab_trees(baked.table.clone(), &graph, &options(max_nodes, 3)).expect("trees are replaced");
            assert!(again.table.to_bytes() == baked.table.to_bytes(), "{name}, {max_nodes:?}: threads changed it");
            let mut parts = baked.table.into_parts();
            parts.stab = None;
            assert!(Table::new(parts).expect("the parts of a table") == table, "{name}: only trees were added");
        }
    }
}

/// The tightness twin: whole trees lead to what rows say, and nowhere else.
#[test]
fn whole_trees_lead_to_what_is_seen() {
    for (name, table, graph) in tables() {
        let baked = with_stab_trees(table.clone(), &graph, &options(None, 1)).expect("a table with portals");
        assert_eq!(
            (baked.report.trees.n_cut_cells, Some(baked.report.max_nodes)),
            (0, GraphRef::from(&graph).most_nodes()),
            "{name}"
        );
        let trees = baked.table.stab().expect("trees were added");
        let mut n_hidden = 0;
        for cell in (0..table.n_cells() as u32).map(CellId) {
            let mut met = vec![false; table.n_cells()];
            met[cell.idx()] = true;
            let mut waiting = trees.roots(cell).to_vec();
            while let Some(node) = waiting.pop() {
                let (portal, forward) = trees.gate(node);
                met[table.portals()[portal.idx()].cells[usize::from(forward)].idx()] = true;
                waiting.extend_from_slice(trees.children(node));
            }
            for other in (0..table.n_cells() as u32).map(CellId) {
                assert_eq!(met[other.idx()], table.sees(cell, other), "{name}: {cell} and {other}");
                n_hidden += u64::from(!met[other.idx()]);
            }
        }
        assert!(n_hidden > table.n_cells() as u64, "{name}: {n_hidden} hidden pairs");
    }
}

/// The impostors: trees that were cut and do not say so, and trees with children left out, lose lines.
#[test]
fn lines_find_what_is_missing() {
    for (name, table, graph) in tables() {
        let rebuilt = |max_nodes, keep_open: bool, leave_out: u32| {
            let baked = with_stab_trees(table.clone(), &graph, &options(max_nodes, 1)).expect("a table with portals");
            let trees = baked.table.stab().expect("trees were added");
            let mut parts = StabParts::default();
            for node in 0..trees.n_nodes() as u32 {
                let children = if leave_out > 0 && node % leave_out == 0 { &[] } else { trees.children(node) };
                let (portal, forward) = trees.gate(node);
                parts.push_node(portal, forward, children, keep_open && trees.is_open(node));
            }
            for cell in (0..table.n_cells() as u32).map(CellId) {
                parts.push_cell(trees.roots(cell), keep_open && trees.is_root_open(cell));
            }
            StabTrees::new(parts, table.portals(), table.n_cells()).expect("trees of this table")
        };
        assert_eq!(shoot(&table, &rebuilt(Some(12), true, 0)).1, 0, "{name}");
        assert!(shoot(&table, &rebuilt(Some(12), false, 0)).1 > 0, "{name}: no line noticed that marks are gone");
        assert!(shoot(&table, &rebuilt(None, true, 7)).1 > 0, "{name}: no line noticed that children are gone");
    }
}

/// The graph that a table stores gives the trees of the graph that it was made from.
#[test]
fn stored_graphs_give_the_same_trees() {
    for (name, table, graph) in tables() {
        let stored = from_table::graph(&table).expect("the table stores its graph");
        let [by_stored, by_baked] = [&stored, &graph]
            .map(|graph| with_stab_trees(table.clone(), graph, &options(Some(150), 1)).expect("portals"));
        assert!(by_stored.table == by_baked.table, "{name}");
        assert_eq!((stored.n_cells(), stored.n_portals()), (graph.n_cells(), graph.n_portals()), "{name}");
    }
}

#[test]
fn stripped_tables_cannot_have_trees() {
    for (name, table, graph) in tables() {
        let stripped = table.strip_geometry();
        assert_eq!(from_table::graph(&stripped), None, "{name}");
        let sizes = [[graph.n_cells(), graph.n_portals()], [stripped.n_cells(), 0]];
        let error =
            with_stab_trees(stripped.clone(), &graph, &StabOptions::default()).expect_err("a table without portals");
        assert_eq!(error, OtherGraph { graph: sizes[0], table: sizes[1] }.into(), "{name}");
        let boxes = TableGraph::Boxes(table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect());
        assert_eq!(GraphRef::from(&boxes).most_nodes(), None);
        let error = with_stab_trees(stripped, &boxes, &StabOptions::default()).expect_err("boxes without portals");
        assert_eq!(error, StabBakeError::NoGraph, "{name}");
        assert!(error.to_string().ends_with("it does not have them"), "{error}");
    }
}

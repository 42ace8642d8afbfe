//! Lines of sight for the pairs of tables: each is followed by other code, joins only what the table lists, and is that of the
//! explanation of its pair alone.

use sightlines::bake::from_table;
use sightlines::bake::lines::{LineOptions, Lines, Obstacle, lines};
use sightlines::bake::{BakeRequest, TableGraph, bake};
use sightlines::cells::PortalId;
use sightlines::certificates::axial::{AxialLine, AxialNetwork, AxialPortal};
use sightlines::formats::quake::{Bsp, BspFormat};
use sightlines::pvs::{CellId, PortalRecord, Table};
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines::sightline::Verdict;
use sightlines::stabtree::{Sight, explain, explain_axial, explain_convex};
use sightlines_tests::world_files::{bsp_bytes, prt_of_world};
use std::sync::LazyLock;

const ALL: LineOptions = LineOptions { max_lines: usize::MAX, max_hidden: 300 };

fn plan() -> Table {
    let plan = office(OfficeOptions { seed: 4, ..OfficeOptions::default() }).expect("an office");
    bake(&plan, &BakeRequest::default()).expect("a table").table
}

static BUILDING: LazyLock<Table> = LazyLock::new(|| {
    let options = TowerOptions { floors: 2, rooms_x: 3, rooms_y: 2, furniture: 1, ..TowerOptions::default() };
    bake(&tower(options).expect("a tower"), &BakeRequest::default()).expect("a table").table
});

fn map() -> Table {
    let world = quake_like(QuakeLikeOptions { seed: 7, rooms_x: 3, rooms_y: 2, floors: 2 }).expect("few rooms");
    let bsp = Bsp::parse(bsp_bytes(&world, BspFormat::Bsp29)).expect("a map");
    let prt = prt_of_world(&world);
    bake((&bsp, &prt), &BakeRequest::default()).expect("a table").table
}

fn lines_of(table: &Table, options: LineOptions) -> Lines {
    lines(table, options, None).expect("nothing cancels").expect("the table has portals")
}

/// The portals of the explanation of one pair alone.
fn explained(graph: &TableGraph, from: CellId, to: CellId) -> Option<Vec<PortalId>> {
    match graph {
        TableGraph::Convex(graph) => match explain_convex(graph, from, to, 1_000) {
            Verdict::Visible(Sight::Along(path)) => Some(path.gates.iter().map(|gate| gate.portal).collect()),
            _ => None,
        },
        TableGraph::Planar(graph) => match explain(graph, from, to, 1, 100_000) {
            Verdict::Visible(Sight::Along(path)) => Some(path.portals),
            _ => None,
        },
        TableGraph::Axial(graph) => match explain_axial(graph, &[], from, to, 2_000) {
            Verdict::Visible(Sight::Along(path)) => Some(path.portals),
            _ => None,
        },
        _ => panic!("cells without portals"),
    }
}

/// How many pairs that the table hides lie on lines: none, unless it is wrong.
fn n_contradicted(table: &Table, found: &Lines) -> usize {
    let ahead = |cells: &[CellId]| -> Vec<[CellId; 2]> {
        (1..cells.len()).flat_map(|j| cells[..j].iter().map(move |a| [*a, cells[j]])).collect()
    };
    found.lines.iter().flat_map(|line| ahead(&line.cells)).filter(|[a, b]| !table.sees(*a, *b)).count()
}

#[test]
fn lines_join_all_visible_pairs_and_no_others() {
    for table in [plan(), BUILDING.clone(), map()] {
        let graph = from_table::graph(&table).expect("the table has portals");
        let found = lines_of(&table, ALL);
        let visible: usize =
            (0..).take(table.n_cells()).map(|a| table.visible(CellId(a)).filter(|b| b.0 > a).count()).sum();
        assert_eq!((found.n_pairs, found.n_joined), (visible, visible));
        assert!(found.lines.len() < visible * 2 / 3, "{} lines for {visible} pairs", found.lines.len());
        assert_eq!(n_contradicted(&table, &found), 0);
        for line in &found.lines {
            assert_eq!(line.cells.len(), line.portals.len() + 1);
            for (k, portal) in line.portals.iter().enumerate() {
                let cells = table.portals()[portal.idx()].cells;
                assert!(cells == [line.cells[k], line.cells[k + 1]] || cells == [line.cells[k + 1], line.cells[k]]);
            }
        }
        for line in found.lines.iter().step_by(17) {
            let (first, last) = (line.cells[0], line.cells[line.cells.len() - 1]);
            assert_eq!(explained(&graph, first, last).as_ref(), Some(&line.portals), "{first} and {last}");
        }
        assert!(!found.hidden.is_empty());
        for pair in &found.hidden {
            let [a, b] = pair.cells;
            assert!(!table.sees(a, b));
            assert_eq!(explained(&graph, a, b), None);
            match &pair.obstacle {
                Obstacle::NotConnected => {}
                Obstacle::Portals(portals) => assert!(!portals.is_empty()),
                Obstacle::Walls(walls) => assert!(!walls.is_empty()),
            }
        }
        // The comparison can fail: a table that hides what a line joins.
        let line = found.lines.iter().find(|line| line.cells.len() > 2).expect("a line through three cells");
        let [a, b] = [line.cells[0].idx(), line.cells[2].idx()];
        let mut parts = table.clone().into_parts();
        parts.rows.set(a, b, false);
        parts.rows.set(b, a, false);
        parts.stab = None;
        assert!(n_contradicted(&Table::new(parts).expect("a table"), &found) > 0);
    }
}

/// The checker of proofs, which knows nothing of how lines are found, follows each through the same cells.
#[test]
fn lines_in_space_are_followed_by_the_checker_of_proofs() {
    let table = &*BUILDING;
    let cells: Vec<_> = table.cells().iter().map(|cell| [cell.min, cell.max]).collect();
    let portal = |portal: &PortalRecord| {
        let corner = |pick: fn(f64, f64) -> f64| {
            let both = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|k| pick(a[k], b[k]));
            portal.points.iter().copied().reduce(both).expect("portals have corners")
        };
        let extent = [corner(f64::min), corner(f64::max)];
        let axis = (0..3).find(|&k| extent[0][k] == extent[1][k]).expect("portals are flat");
        let forward = table.cells()[portal.cells[0].idx()].max[axis] == extent[0][axis];
        AxialPortal { cells: portal.cells.map(|id| id.0), extent, axis: axis as u8, forward }
    };
    let portals: Vec<AxialPortal> = table.portals().iter().map(portal).collect();
    let network = AxialNetwork::new(&cells, &portals).expect("a network");
    let found = lines_of(table, ALL);
    let mut n_followed = 0;
    for line in &found.lines {
        let Some([from, to]) = line.ends else { continue };
        let passed = network.follow(&AxialLine::through(line.cells[0].0, from, to));
        if line.cells.iter().all(|cell| passed.contains(&cell.0)) {
            n_followed += 1;
        }
    }
    assert!(n_followed * 100 >= found.lines.len() * 99, "{n_followed} of {}", found.lines.len());
    // Not every line does: one that is moved leaves the way.
    let line = found.lines.iter().find(|line| line.cells.len() > 3 && line.ends.is_some()).expect("a long line");
    let [from, to] = line.ends.expect("it has some");
    let moved = network.follow(&AxialLine::through(line.cells[0].0, from, [to[0], to[1] + 1000.0, to[2]]));
    assert!(!line.cells.iter().all(|cell| moved.contains(&cell.0)));
}

#[test]
fn lines_do_not_depend_on_threads_and_are_bounded() {
    let table = &*BUILDING;
    let with = |n: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().expect("threads");
        pool.install(|| lines_of(table, LineOptions { max_lines: 200, max_hidden: 40 }))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one, three);
    assert!(one.lines.len() <= 200 && one.hidden.len() <= 40 && one.n_joined < one.n_pairs);
    assert_eq!(lines_of(table, LineOptions { max_lines: 0, max_hidden: 0 }).lines, []);
}

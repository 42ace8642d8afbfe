//! Tables of plans: which subdivision is used, what is in the table, and that it is the same every time.

use proptest::prelude::*;
use sightlines_bake::from_table::planar_graph;
use sightlines_bake::{BakeError, BakedPlan, PlanBakeOptions, Subdivide, bake_plan, table_of};
use sightlines_cells::{CellGraph, CellId, Plan, PlanLine, PlanObject, Planar};
use sightlines_geometry::{Aabb, Point2, Segment2, signed_area};
use sightlines_kdtree::KdError;
use sightlines_progress::{Cancelled, Progress};
use sightlines_pvs::{BitMatrix, CellRecord, Locator, ObjectId, Table, TableKind, TableParts};
use sightlines_scenes::{OfficeOptions, doom_like, maze, office, turned_pillared_hall};
use sightlines_testkit::{axial_plan, small_grid_plan};
use sightlines_triangulation::TriangulationError;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

const METHODS: [Subdivide; 2] = [Subdivide::KdTree, Subdivide::Triangulation];

fn line(ax: f64, ay: f64, bx: f64, by: f64) -> PlanLine {
    PlanLine::wall(Point2::new(ax, ay), Point2::new(bx, by))
}

fn with(subdivide: Subdivide) -> PlanBakeOptions<'static> {
    PlanBakeOptions { subdivide, threads: 1, ..PlanBakeOptions::default() }
}

fn bake(plan: &Plan, subdivide: Subdivide) -> BakedPlan {
    bake_plan(plan, &with(subdivide)).unwrap_or_else(|e| panic!("{e}"))
}

fn lines_of_box(x1: f64, y1: f64) -> Vec<PlanLine> {
    vec![line(0., 0., x1, 0.), line(x1, 0., x1, y1), line(x1, y1, 0., y1), line(0., y1, 0., 0.)]
}

/// A box of 8 by 4 with `more` in it.
fn boxed(more: &[PlanLine]) -> Plan {
    let lines = lines_of_box(8., 4.).into_iter().chain(more.iter().copied());
    Plan::new(lines.collect(), vec![]).expect("lines on a grid")
}

/// Whether some cell at `p` sees some cell at `q`.
fn joins(table: &Table, p: [f64; 2], q: [f64; 2]) -> bool {
    let seen = table.in_dimension().unwrap().at(p).inside().map(|at| at.visible_set());
    let at_q = table.in_dimension().unwrap().at(q).cells().to_vec();
    assert!(!at_q.is_empty(), "{q:?} is inside");
    let seen = seen.unwrap_or_else(|| panic!("{p:?} is inside"));
    at_q.iter().any(|&cell| seen.contains(cell))
}

// --- Which subdivision -------------------------------------------------------------------------------

/// What is used for a plan, by the summary and by the table's own word.
fn used(plan: &Plan, subdivide: Subdivide) -> (Subdivide, String, Option<String>) {
    let baked = bake(plan, subdivide);
    let value = |key: &str| baked.table.info_value(key).map(str::to_owned);
    (baked.report.subdivide, value("subdivide").expect("every table says how it was cut"), value("tau"))
}

#[test]
fn auto_follows_axes_by_kd_tree_and_anything_else_by_triangulation() {
    let kd = (Subdivide::KdTree, "kd".to_owned(), Some("0".to_owned()));
    let triangulation = (Subdivide::Triangulation, "triangulation".to_owned(), None);
    let axial = boxed(&[line(4., 0., 4., 3.)]);
    assert_eq!(used(&axial, Subdivide::Auto), kd);
    let slanted = boxed(&[line(4., 0., 5., 3.)]);
    assert_eq!(used(&slanted, Subdivide::Auto), triangulation);
    let grouped = boxed(&[PlanLine { left: Some(0), ..line(4., 0., 4., 3.) }]);
    assert_eq!(used(&grouped, Subdivide::Auto), triangulation);
    // An explicit choice is used.
    assert_eq!(used(&axial, Subdivide::Triangulation), triangulation);
    assert_eq!(used(&slanted, Subdivide::KdTree), kd);
}

#[test]
fn groups_are_in_the_table_of_a_triangulation() {
    let door = PlanLine { opaque: false, left: Some(3), right: Some(5), ..line(4., 0., 4., 4.) };
    let table = bake(&boxed(&[door]), Subdivide::Auto).table;
    let group = |p: [f64; 2]| table.cells()[table.in_dimension().unwrap().at(p).cells()[0].idx()].group;
    assert_eq!((group([2., 2.]), group([6., 2.])), (Some(3), Some(5)));
}

/// A wall that the k-d tree cannot follow does not block, which errs towards visible, and is counted.
#[test]
fn walls_that_a_kd_tree_cannot_follow_are_counted_and_do_not_block() {
    let plan = boxed(&[line(4., 0., 5., 4.)]);
    let (kd, exact) = (bake(&plan, Subdivide::KdTree), bake(&plan, Subdivide::Triangulation));
    assert_eq!((kd.report.n_ignored_walls, exact.report.n_ignored_walls), (1, 0));
    assert!(joins(&kd.table, [1., 2.], [7., 2.]));
    assert!(!joins(&exact.table, [1., 2.], [7., 2.]));
}

#[test]
fn names_of_subdivisions_are_read_and_written() {
    for subdivide in [Subdivide::Auto, Subdivide::KdTree, Subdivide::Triangulation] {
        assert_eq!(subdivide.to_string().parse(), Ok(subdivide));
    }
    let error = "bsp".parse::<Subdivide>().unwrap_err();
    assert_eq!(error.to_string(), "'bsp' is no subdivision: use auto, kd or triangulation");
}

/// The summary counts what is in the table.
#[test]
fn summaries_agree_with_tables() {
    let floor = office(OfficeOptions { rooms_x: 5, rooms_y: 2, ..OfficeOptions::default() }).unwrap();
    for subdivide in METHODS {
        let BakedPlan { table, report, graph } = bake(&floor, subdivide);
        assert_eq!((report.n_cells, report.n_portals), (table.n_cells(), table.portals().len()));
        let cells = || (0..table.n_cells() as u32).map(CellId);
        let n_seen = cells().flat_map(|a| (0..a.0).map(move |b| (a, CellId(b)))).filter(|&(a, b)| table.sees(a, b));
        assert_eq!(report.n_visible_pairs, n_seen.count() as u64);
        assert!(report.n_visible_pairs > 0 && report.n_pushes >= report.n_visits);
        assert_eq!((graph.n_cells(), graph.portals().len()), (report.n_cells, report.n_portals));
    }
}

// --- The same bytes ----------------------------------------------------------------------------------

/// Generated plans, each with the name to complain under.
fn scenes() -> Vec<(&'static str, Plan)> {
    vec![
        ("office", office(OfficeOptions { rooms_x: 6, rooms_y: 4, ..OfficeOptions::default() }).unwrap()),
        ("maze", maze(3, 8, 8).unwrap()),
        ("turned hall", turned_pillared_hall(3, 4, 3).unwrap()),
        ("doom-like", doom_like(3, 3).unwrap()),
    ]
}

/// Invariant: neither threads nor chords nor somebody who watches change a byte.
#[test]
fn bytes_are_the_same_with_any_number_of_threads_and_chords() {
    let mut all = Vec::new();
    for (name, plan) in scenes() {
        let bytes = |threads, chords| {
            let options = PlanBakeOptions { threads, chords, ..PlanBakeOptions::default() };
            bake_plan(&plan, &options).unwrap().table.to_bytes()
        };
        let one = bytes(1, 8);
        for (threads, chords) in [(1, 8), (2, 8), (3, 8), (1, 0), (3, 0), (2, 31)] {
            assert!(bytes(threads, chords) == one, "{name} with {threads} threads and {chords} chords");
        }
        all.push(one);
    }
    // The comparison can fail: other plans give other bytes.
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), scenes().len());
}

#[test]
fn progress_counts_every_cell_once() {
    let calls = AtomicUsize::new(0);
    let largest = AtomicUsize::new(0);
    let progress = |Progress { done, total, .. }: Progress| {
        assert!(1 <= done && done <= total);
        calls.fetch_add(1, Relaxed);
        largest.fetch_max(done as usize, Relaxed);
        ControlFlow::Continue(())
    };
    let plan = maze(1, 4, 4).unwrap();
    let options = PlanBakeOptions { threads: 2, progress: Some(&progress), ..PlanBakeOptions::default() };
    let n_cells = bake_plan(&plan, &options).unwrap().report.n_cells;
    assert_eq!((calls.load(Relaxed), largest.load(Relaxed)), (n_cells, n_cells));
}

#[test]
fn a_cancelled_bake_gives_no_table() {
    let stop = |_: Progress| ControlFlow::Break(());
    for threads in [1, 3] {
        let options = PlanBakeOptions { threads, progress: Some(&stop), ..PlanBakeOptions::default() };
        assert_eq!(bake_plan(&maze(1, 4, 4).unwrap(), &options).unwrap_err(), BakeError::Cancelled(Cancelled));
    }
}

// --- From tables back to graphs ----------------------------------------------------------------------

/// The plan as the crates below cut it; `None` for plans without a region.
fn cut(plan: &Plan, subdivide: Subdivide) -> Option<CellGraph<Planar>> {
    if subdivide == Subdivide::KdTree {
        let options = sightlines_kdtree::KdOptions::default();
        sightlines_kdtree::subdivide_plan(plan, &options).ok().map(|cut| cut.graph)
    } else {
        sightlines_triangulation::subdivide(plan).ok().map(|(graph, _)| graph)
    }
}

/// What a file of the table gives back.
fn through_bytes(table: &Table) -> Option<CellGraph<Planar>> {
    planar_graph(&Table::from_bytes(&table.to_bytes()).expect("a table reads what it wrote"))
}

proptest! {
    /// Invariant: a table holds the graph that was cut, bit for bit, and so does a file of it; with
    /// rounded crossings too.
    #[test]
    fn tables_hold_the_graph_that_was_cut(plan in prop_oneof![axial_plan(1..9), small_grid_plan(1..9)]) {
        for subdivide in METHODS {
            let baked = bake_plan(&plan, &with(subdivide)).ok();
            let graph = cut(&plan, subdivide);
            prop_assert_eq!(baked.is_some(), graph.is_some());
            if let (Some(baked), Some(graph)) = (baked, graph) {
                prop_assert_eq!(through_bytes(&baked.table), Some(graph));
            }
        }
    }
}

#[test]
fn tables_hold_the_graphs_of_generated_plans() {
    for (name, plan) in scenes() {
        for subdivide in METHODS {
            let (found, expected) = (through_bytes(&bake(&plan, subdivide).table), cut(&plan, subdivide));
            assert!(found.is_some() && found == expected, "{name} by {subdivide}");
        }
    }
}

#[test]
fn stripped_tables_have_no_graph() {
    for subdivide in METHODS {
        let table = bake(&boxed(&[line(4., 0., 4., 3.)]), subdivide).table;
        assert!(through_bytes(&table).is_some());
        assert_eq!(through_bytes(&table.strip_geometry()), None);
    }
}

#[test]
fn tables_of_space_have_no_planar_graph() {
    let cell = CellRecord { min: [0.; 3], max: [1.; 3], group: None, polygon: vec![] };
    let parts = TableParts {
        locator: Locator::build(&[(cell.min, cell.max)], 3),
        rows: BitMatrix::identity(1),
        cells: vec![cell],
        cell_objects: vec![vec![]],
        ..TableParts::empty(3, TableKind::Unspecified)
    };
    assert_eq!(planar_graph(&Table::new(parts).expect("a box in space")), None);
}

/// Portals that a table accepts, as it answers nothing from them, but that join no cells.
#[test]
fn tables_with_portals_in_the_wrong_place_have_no_graph() {
    let table = bake(&boxed(&[line(4., 0., 4., 3.)]), Subdivide::KdTree).table;
    let spoiled = |spoil: &dyn Fn(&mut TableParts)| {
        let mut parts = table.clone().into_parts();
        spoil(&mut parts);
        planar_graph(&Table::new(parts).expect("portals are not checked so far"))
    };
    assert!(spoiled(&|_| ()).is_some());
    assert_eq!(spoiled(&|parts| parts.portals[0].points.reverse()), None, "left and right exchanged");
    assert_eq!(spoiled(&|parts| parts.portals[0].points[0][0] += 1.0), None, "off the boundary");
    assert_eq!(spoiled(&|parts| parts.portals[0].cells.reverse()), None, "the cells exchanged");
}

#[test]
fn information_is_sorted_and_rows_are_checked() {
    let graph = cut(&boxed(&[line(4., 0., 4., 3.)]), Subdivide::KdTree).expect("a region");
    let options = |keys: &[&str]| sightlines_bake::TableOptions {
        info: keys.iter().map(|k| ((*k).to_owned(), String::new())).collect(),
        ..sightlines_bake::TableOptions::new(TableKind::PlanKdTree)
    };
    let table = table_of(&graph, BitMatrix::identity(graph.n_cells()), options(&["b", "c", "a"])).unwrap();
    assert!(table.info().iter().map(|(key, _)| key.as_str()).eq(["a", "b", "c"]));
    assert!(table_of(&graph, BitMatrix::identity(graph.n_cells() + 1), options(&[])).is_err());
    assert!(table_of(&graph, BitMatrix::identity(graph.n_cells()), options(&["a", "a"])).is_err());
}

// --- Errors ------------------------------------------------------------------------------------------

#[test]
fn thresholds_outside_0_to_1_are_errors() {
    let plan = boxed(&[line(4., 0., 4., 3.)]);
    let bake_with = |tau| bake_plan(&plan, &PlanBakeOptions { tau, ..with(Subdivide::Auto) });
    for tau in [-0.1, 1.5, f64::INFINITY, f64::NAN] {
        let by_triangulation = bake_plan(&plan, &PlanBakeOptions { tau, ..with(Subdivide::Triangulation) });
        assert!(matches!(by_triangulation, Err(BakeError::KdTree(KdError::Tau(_)))));
        let error = bake_with(tau).unwrap_err();
        assert!(matches!(error, BakeError::KdTree(KdError::Tau(_))), "{error:?}");
        assert_eq!(error.to_string(), format!("obscuration threshold {tau} is not a number from 0 to 1"));
    }
    for tau in [0.0, 0.5, 1.0] {
        let baked = bake_with(tau).unwrap();
        assert_eq!(baked.table.info_value("tau"), Some(tau.to_string().as_str()));
    }
}

/// A threshold leaves walls over: cells are fewer, and more is visible, never less.
#[test]
fn thresholds_err_towards_visible() {
    let plan = maze(5, 5, 5).unwrap();
    let at = |tau| bake_plan(&plan, &PlanBakeOptions { tau, ..with(Subdivide::KdTree) }).unwrap().table;
    let (exact, coarse) = (at(0.0), at(0.6));
    assert!(coarse.n_cells() < exact.n_cells());
    let bounds = plan.bounds();
    let place = |i: u32, k: usize| bounds.min[k] + (bounds.max[k] - bounds.min[k]) * (f64::from(i) + 0.5) / 10.0;
    let points: Vec<[f64; 2]> = (0..100).map(|i| [place(i % 10, 0), place(i / 10, 1)]).collect();
    let mut n_more = 0;
    for &p in &points {
        for &q in &points {
            let (is, may) = (joins(&exact, p, q), joins(&coarse, p, q));
            assert!(may || !is, "{p:?} sees {q:?}");
            n_more += u32::from(may && !is);
        }
    }
    assert!(n_more > 0, "the threshold changed nothing");
}

#[test]
fn plans_without_a_region_are_errors() {
    let error = |lines: &[PlanLine], subdivide| {
        let plan = Plan::new(lines.to_vec(), vec![]).unwrap();
        bake_plan(&plan, &with(subdivide)).unwrap_err()
    };
    assert_eq!(error(&[], Subdivide::Auto), BakeError::KdTree(KdError::Empty));
    assert_eq!(error(&[], Subdivide::KdTree).to_string(), "the scene is empty");
    assert_eq!(error(&[], Subdivide::Triangulation), BakeError::Triangulation(TriangulationError::Empty));
    assert_eq!(error(&[], Subdivide::Triangulation).to_string(), "the plan has no lines");
    let upright = [line(2., 0., 2., 1.), line(2., 1., 2., 5.)];
    assert_eq!(error(&upright, Subdivide::Auto), BakeError::KdTree(KdError::Flat { axis: 0 }));
    assert_eq!(error(&upright, Subdivide::Triangulation), BakeError::Triangulation(TriangulationError::Flat));
    let slanted = [line(0., 0., 1., 2.), line(2., 4., 3., 6.)];
    assert_eq!(error(&slanted, Subdivide::Auto), BakeError::Triangulation(TriangulationError::Flat));
    assert_eq!(error(&slanted, Subdivide::Auto).to_string(), "all lines of the plan lie on one straight line");
    // Around slanted lines there is room for a box.
    assert!(bake_plan(&Plan::new(slanted.to_vec(), vec![]).unwrap(), &with(Subdivide::KdTree)).is_ok());
}

// --- Objects -----------------------------------------------------------------------------------------

fn object(name: &str, min: [f64; 2], max: [f64; 2]) -> PlanObject {
    PlanObject { name: name.to_owned(), bounds: Aabb { min, max } }
}

/// Two rooms without a door: objects are where they are, and are seen from there only.
#[test]
fn objects_land_in_the_cells_that_they_touch() {
    let mut lines = lines_of_box(8., 4.);
    lines.push(line(4., 0., 4., 4.));
    let objects = vec![
        object("west", [1., 1.], [2., 2.]),
        object("east", [5., 1.], [5., 1.]),
        object("across", [3., 3.], [5., 3.]),
        object("on the wall", [4., 1.], [4., 1.]),
        object("outside", [9., 1.], [10., 2.]),
    ];
    let plan = Plan::new(lines, objects).unwrap();
    for subdivide in METHODS {
        let table = bake(&plan, subdivide).table;
        let names = |at: [f64; 2]| {
            let seen = table.in_dimension().unwrap().at(at).inside().expect("inside").visible_objects();
            seen.iter().map(|&o| table.objects()[o.idx()].name.as_str()).collect::<Vec<_>>()
        };
        assert_eq!(names([1., 1.]), ["west", "across", "on the wall"], "{subdivide}");
        assert_eq!(names([7., 1.]), ["east", "across", "on the wall"], "{subdivide}");
        let stored = &table.objects()[0];
        assert_eq!((stored.min, stored.max), ([1., 1., 0.], [2., 2., 0.]));
    }
}

/// Whether a point is in a closed polygon, by areas: its triangles with the sides fill the polygon and
/// no more. Exact for corners on a small grid.
fn fills(polygon: &[Point2], p: Point2) -> bool {
    let n = polygon.len();
    let triangle = |i: usize| signed_area(&[p, polygon[i], polygon[(i + 1) % n]]).abs();
    (0..n).map(triangle).sum::<f64>() == signed_area(polygon)
}

/// Whether a closed box, which may be flat, and a closed polygon have a point in common: a corner of one
/// is in the other, or their sides meet.
fn touches(polygon: &[Point2], bounds: &Aabb<2>) -> bool {
    let [[x0, y0], [x1, y1]] = [bounds.min, bounds.max];
    let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(Point2::from);
    let sides = |of: &[Point2]| -> Vec<Segment2> {
        let next = of.iter().cycle().skip(1);
        of.iter().zip(next).filter(|(a, b)| a != b).map(|(&a, &b)| Segment2::new(a, b)).collect()
    };
    let sides_of_box = sides(&corners);
    corners.iter().any(|&c| fills(polygon, c))
        || polygon.iter().any(|c| bounds.contains([c.x, c.y]))
        || sides(polygon).iter().any(|s| sides_of_box.iter().any(|t| s.meets(t)))
}

/// Boxes and points, half a unit apart, on the grid of the plans.
fn boxes() -> impl Strategy<Value = Vec<Aabb<2>>> {
    let one = (0i32..17, 0i32..17, 0i32..5, 0i32..5).prop_map(|(x, y, w, h)| {
        let [min, max] = [[x, y], [x + w, y + h]].map(|p| p.map(|k| 0.5 * f64::from(k)));
        Aabb { min, max }
    });
    prop::collection::vec(one, 1..9)
}

proptest! {
    /// Invariant: a cell lists an object if and only if the two have a point in common.
    #[test]
    fn objects_of_cells_are_those_that_touch(
        plan in prop_oneof![axial_plan(2..7), small_grid_plan(2..7)],
        boxes in boxes(),
    ) {
        let objects = boxes.iter().map(|b| object("box", b.min, b.max)).collect();
        let plan = Plan::new(plan.lines().to_vec(), objects).unwrap();
        for subdivide in METHODS {
            let Ok(baked) = bake_plan(&plan, &with(subdivide)) else { continue };
            if baked.report.n_rounded_crossings > 0 {
                continue; // the oracle's areas would be rounded
            }
            for (id, cell) in (0u32..).map(CellId).zip(baked.table.cells()) {
                let polygon: Vec<Point2> = cell.polygon.iter().map(|&c| Point2::from(c)).collect();
                let touching = (0u32..).zip(&boxes).filter(|(_, b)| touches(&polygon, b)).map(|(i, _)| i);
                prop_assert_eq!(baked.table.objects_of(id), touching.map(ObjectId).collect::<Vec<_>>(), "{:?}", polygon);
            }
        }
    }
}

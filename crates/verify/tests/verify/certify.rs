//! Proofs of tables, checked against the tables: every wrong pair of cells is caught.

use sightlines_bake::{
    Certified, CertifyError, PlanBakeOptions, PrtOptions, SceneBakeOptions, TableGraph, bake_plan, bake_prt,
    bake_scene, certify_table, from_table,
};
use sightlines_cells::{Plan, Scene};
use sightlines_certificates::Refusal;
use sightlines_certificates::convex::ConvexProofs;
use sightlines_formats::quake::Prt;
use sightlines_formats::quake::prt::parse_prt;
use sightlines_geometry::Aabb;
use sightlines_pvs::{BitMatrix, CellId, SceneMethods, Table, TableKind, TableParts};
use sightlines_scenes::world::{BspWorldOptions, QuakeLikeOptions, World, bsp_world, corridor, quake_like};
use sightlines_scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines_stabtree::CertifyOptions;
use sightlines_testkit::{draw, small_grid_plan};
use sightlines_verify::{
    ProofError, ProofFindings, ProofViolation, can_be_proven, check_proofs, check_walls_in_space, check_walls_of_plan,
    convex_of,
};
use std::sync::LazyLock;

fn proofs_of(table: &Table) -> Vec<u8> {
    certified(table, &CertifyOptions::default()).expect("the table has cells and portals").proofs.to_bytes()
}

fn certified(table: &Table, options: &CertifyOptions<'_>) -> Result<Certified, CertifyError> {
    let graph = from_table::graph(table).ok_or(CertifyError::NoGraph)?;
    certify_table(table, &graph, options)
}

fn flipped(table: &Table, a: u32, b: u32) -> Table {
    let mut parts: TableParts = table.parts().clone();
    let bit = !table.sees(CellId(a), CellId(b));
    parts.rows.set(a as usize, b as usize, bit);
    parts.rows.set(b as usize, a as usize, bit);
    Table::new(parts).expect("a table with a wrong pair is a table")
}

/// Proves a table whole, objects too, then each table with one wrong pair wrong; returns how many pairs are visible and hidden. A
/// scene in space that shows a pair that is hidden shows too much: that is counted.
fn assert_every_flip_is_caught(table: &Table, bytes: &[u8]) -> [u64; 2] {
    let found = check_proofs(table, bytes).expect("proofs of the table");
    let n = table.n_cells() as u64;
    let all = n * n.saturating_sub(1) / 2;
    let (n_visible, n_hidden_objects) = (found.n_visible, n_hidden_objects(table));
    let whole = ProofFindings { n_visible, n_hidden: all - n_visible, n_hidden_objects, ..Default::default() };
    assert_eq!(found, whole, "all pairs are proven, and nothing else is found");
    assert!(found.is_true(true));
    let mut n_caught = 0;
    for a in 0..n as u32 {
        for b in a + 1..n as u32 {
            let other = flipped(table, a, b);
            let found = check_proofs(&other, bytes).expect("proofs of a table with these cells");
            let pair = [CellId(a), CellId(b)];
            n_caught += 1;
            if is_scene(table) && !table.sees(pair[0], pair[1]) {
                assert_eq!((found.n_excess, found.n_violations, found.n_hidden), (1, 0, whole.n_hidden - 1));
                continue;
            }
            let expected =
                if table.sees(pair[0], pair[1]) { ProofViolation::Joined(pair) } else { ProofViolation::Apart(pair) };
            assert_eq!(found.violations, [expected]);
            assert!(found.n_violations == 1 && found.n_excess == 0 && !found.is_true(false));
        }
    }
    assert_eq!(n_caught, all);
    [found.n_visible, found.n_hidden]
}

fn is_scene(table: &Table) -> bool {
    table.dimension() == 3 && !table.kind().is_quake()
}

/// Pairs of a cell and an object that a table hides.
fn n_hidden_objects(table: &Table) -> u64 {
    let n_objects = table.objects().len() as u64;
    (0..table.n_cells() as u32).map(|cell| n_objects - table.visible_objects(CellId(cell)).len() as u64).sum()
}

/// Every table that hides an object from one cell more is noticed: there is no proof of that. One that shows an object more is not wrong.
#[test]
fn every_object_too_few_is_noticed() {
    let (table, bytes) = (storey(), proofs_of_storey());
    let whole = check_proofs(table, bytes).expect("proofs of the table");
    let rows = table.parts().objects_seen.clone().expect("own rows of objects");
    let (mut n_noticed, mut n_shown) = (0, 0);
    for (cell, object) in (0..table.n_cells()).flat_map(|cell| (0..rows.n_cols()).map(move |object| (cell, object))) {
        let mut other = rows.clone();
        let sees = rows.get(cell, object);
        other.set(cell, object, !sees);
        let parts = TableParts { objects_seen: Some(other), ..table.parts().clone() };
        // A cell sees what touches it; a table that says otherwise is none.
        let Ok(table) = Table::new(parts) else { continue };
        let found = check_proofs(&table, bytes).expect("proofs of a table with these cells");
        let counts = (found.n_hidden_objects, found.n_unproven_hidden_objects, found.is_true(true));
        if sees {
            assert_eq!(counts, (whole.n_hidden_objects, 1, false));
            n_noticed += 1;
        } else {
            assert_eq!(counts, (whole.n_hidden_objects - 1, 0, true));
            n_shown += 1;
        }
    }
    assert!(n_noticed > 20 && n_shown > 20, "{n_noticed} {n_shown}");
    // Proofs about other objects are not about these.
    let mut parts = table.parts().clone();
    parts.objects[0].max[0] += 0.5;
    let found = check_proofs(&Table::new(parts).expect("a table"), bytes).expect("proofs of a table with these cells");
    assert_eq!(found.violations, [ProofViolation::Refused(Refusal::OtherObjects)]);
}

fn baked(plan: &Plan) -> Option<Table> {
    bake_plan(plan, &PlanBakeOptions { threads: 1, ..PlanBakeOptions::default() }).ok().map(|baked| baked.table)
}

#[test]
fn every_flipped_pair_of_an_office_is_caught() {
    let plan = office(OfficeOptions { seed: 5, rooms_x: 5, rooms_y: 3, ..OfficeOptions::default() }).unwrap();
    let table = baked(&plan).unwrap();
    let [visible, hidden] = assert_every_flip_is_caught(&table, &proofs_of(&table));
    assert!(visible > 20 && hidden > 20, "{visible} {hidden}");
}

#[test]
fn every_flipped_pair_of_small_plans_is_caught() {
    let mut sum = [0, 0];
    for plan in draw(&small_grid_plan(3..12), 24) {
        if let Some(table) = baked(&plan) {
            let [visible, hidden] = assert_every_flip_is_caught(&table, &proofs_of(&table));
            sum = [sum[0] + visible, sum[1] + hidden];
        }
    }
    assert!(sum[0] > 100 && sum[1] > 50, "{sum:?}");
}

/// A storey of a few rooms.
fn rooms() -> Scene {
    let small = TowerOptions { seed: 3, floors: 1, rooms_x: 2, rooms_y: 1, ..TowerOptions::default() };
    tower(TowerOptions { furniture: 0, windows: false, ..small }).unwrap()
}

/// Its table, made once.
fn storey() -> &'static Table {
    static STOREY: LazyLock<Table> = LazyLock::new(|| {
        bake_scene(&rooms(), &SceneBakeOptions { threads: 1, ..SceneBakeOptions::default() }).unwrap().table
    });
    &STOREY
}

/// The proofs of this table, made once.
fn proofs_of_storey() -> &'static [u8] {
    static PROOFS: LazyLock<Vec<u8>> = LazyLock::new(|| proofs_of(storey()));
    &PROOFS
}

#[test]
fn every_flipped_pair_of_a_storey_is_caught() {
    let [visible, hidden] = assert_every_flip_is_caught(storey(), proofs_of_storey());
    assert!(visible > 20 && hidden > 20, "{visible} {hidden}");
}

/// The table of a world's portals, as a portal file has them; `None` where a pair is undecided.
fn table_of(world: &World) -> Option<Table> {
    let mut prt = Prt::new(world.graph.n_cells() as u32).expect("some cells");
    for portal in world.graph.portals() {
        prt.push_portal(portal.cells.map(|cell| cell.0), portal.shape.corners()).expect("a polygon");
    }
    let baked = bake_prt(&prt, PrtOptions::default()).expect("portals between cells");
    baked.report.seen.undecided.is_empty().then_some(baked.table)
}

fn level() -> Table {
    let options = QuakeLikeOptions { seed: 1, rooms_x: 2, rooms_y: 1, floors: 1 };
    table_of(&quake_like(options).expect("few rooms")).expect("nothing is undecided")
}

#[test]
fn every_flipped_pair_of_maps_is_caught() {
    let mut sum = [0, 0];
    let bent = [([1, 2], 7), ([3, 1], 9), ([1, 0], 5)];
    let bent = bent.map(|(bends, width)| corridor(9, bends, width).expect("a short corridor"));
    let leafs = |seed| bsp_world(BspWorldOptions { seed, leafs: 16, solid_percent: 45, tilted_percent: 60 });
    let worlds = bent.into_iter().chain((0..6).map(|seed| leafs(seed).expect("options within their ranges")));
    for table in worlds.filter_map(|world| table_of(&world)).chain([level()]) {
        let [visible, hidden] = assert_every_flip_is_caught(&table, &proofs_of(&table));
        sum = [sum[0] + visible, sum[1] + hidden];
    }
    assert!(sum[0] > 150 && sum[1] > 80, "{sum:?}");
}

/// Proofs of another table, or of none, are distinguished from wrong ones.
#[test]
fn proofs_of_something_else_are_refused() {
    let plan = |seed| {
        let plan = office(OfficeOptions { seed, rooms_x: 4, rooms_y: 2, ..OfficeOptions::default() }).unwrap();
        baked(&plan).unwrap()
    };
    let (table, other, space) = (plan(1), plan(2), storey());
    let found = check_proofs(&table, &proofs_of(&other)).unwrap();
    assert!(!found.is_true(false) && matches!(found.violations[..], [ProofViolation::Refused(_)]), "{found:?}");
    let error = |table: &Table, bytes: &[u8]| check_proofs(table, bytes).unwrap_err();
    assert!(matches!(error(space, &proofs_of(&table)), ProofError::Kind { .. }));
    assert!(matches!(error(&table, proofs_of_storey()), ProofError::Kind { .. }));
    let map = level();
    for (table, bytes) in [(&map, &proofs_of(&table)[..]), (&map, proofs_of_storey()), (space, &proofs_of(&map)[..])] {
        assert!(matches!(error(table, bytes), ProofError::Kind { .. }));
    }
    assert_eq!(error(&map.strip_geometry(), &proofs_of(&map)), ProofError::NoGraph);
    assert!(matches!(error(&table, b"SLPVS"), ProofError::Read(_)));
    assert_eq!(error(&table.strip_geometry(), &proofs_of(&table)), ProofError::NoGraph);
    assert_eq!(from_table::graph(&table.strip_geometry()), None);
    let boxes = TableGraph::Boxes(Vec::new());
    let error = certify_table(&table, &boxes, &CertifyOptions::default()).unwrap_err();
    assert!(matches!(error, CertifyError::OtherGraph(_)), "{error}");
    let given = TableGraph::Boxes(table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect());
    let given = certify_table(&table.strip_geometry(), &given, &CertifyOptions::default());
    assert_eq!(given.unwrap_err(), CertifyError::NoGraph);
}

/// Without effort little is proven; that is reported, and only strict mode counts it as a violation.
#[test]
fn what_is_not_proven_is_counted() {
    let plan = office(OfficeOptions { seed: 5, rooms_x: 8, rooms_y: 4, ..OfficeOptions::default() }).unwrap();
    for table in [baked(&plan).unwrap(), storey().clone(), level()] {
        let options = CertifyOptions { most_steps: 0, most_steps_in_all: 0, chords: 0, ..CertifyOptions::default() };
        let bytes = certified(&table, &options).unwrap().proofs.to_bytes();
        let found = check_proofs(&table, &bytes).unwrap();
        assert!(found.is_true(false) && !found.is_true(true), "{found:?}");
        assert!(found.n_unproven_hidden > 0 && found.n_violations == 0 && !found.unproven_hidden.is_empty());
    }
}

/// The same table, as if a from-region method had taken part, of the kind of cells that is asked for.
fn by_regions(table: &Table, kind: fn(SceneMethods) -> TableKind) -> Table {
    let hidden_by = SceneMethods { sightlines: true, from_region: true, only_in_air: false };
    Table::new(TableParts { kind: kind(hidden_by), ..table.parts().clone() }).expect("a table of a scene in space")
}

/// What a from-region method hides past portals is no contradiction: it is counted, and only strict mode refuses it.
#[test]
fn what_regions_hide_is_proven_or_counted() {
    let table = by_regions(storey(), |hidden_by| TableKind::SceneKdTree { hidden_by });
    let bytes = proofs_of(&table);
    let whole = check_proofs(&table, &bytes).expect("proofs of the table");
    assert!(whole.is_true(true) && whole.n_hidden > 20 && whole.n_hidden_past_portals == 0, "{whole:?}");
    let n = table.n_cells() as u32;
    let (mut n_counted, mut n_caught) = (0, 0);
    for (a, b) in (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b))) {
        let pair = [CellId(a), CellId(b)];
        let found = check_proofs(&flipped(&table, a, b), &bytes).expect("proofs of a table with these cells");
        if table.sees(pair[0], pair[1]) {
            assert!(found.is_true(false) && !found.is_true(true), "{found:?}");
            assert_eq!((found.n_unproven_hidden, found.n_hidden_past_portals), (1, 1));
            assert_eq!((&found.unproven_hidden[..], found.n_hidden), (&[pair][..], whole.n_hidden));
            n_counted += 1;
        } else {
            assert_eq!((found.n_excess, found.n_violations), (1, 0));
            n_caught += 1;
        }
    }
    assert!(n_counted > 20 && n_caught > 20, "{n_counted} {n_caught}");
}

/// Nothing is known of what is between given boxes, so no proof about portals is one about them, and all is counted.
#[test]
fn nothing_is_proven_of_given_boxes() {
    let storey = storey();
    assert!(can_be_proven(storey));
    let mut parts = storey.parts().clone();
    parts.portals.clear();
    // Even where nothing is seen, so that no portal is missed.
    let dark = TableParts { rows: BitMatrix::identity(storey.n_cells()), ..parts.clone() };
    let (n, proofs) = (storey.n_cells() as u64, proofs_of_storey());
    for (parts, n_seen) in [(parts, None), (dark, Some(0))] {
        let table =
            by_regions(&Table::new(parts).expect("a table"), |hidden_by| TableKind::SceneGivenCells { hidden_by });
        assert!(!can_be_proven(&table));
        assert_eq!(check_proofs(&table, proofs).unwrap_err(), ProofError::NoGraph);
        let found = ProofFindings::without_proofs(&table);
        assert_eq!(found.n_unproven_visible + found.n_unproven_hidden, n * (n - 1) / 2);
        assert_eq!((found.n_visible, found.n_hidden, found.n_violations), (0, 0, 0));
        assert!(n_seen.is_none_or(|n_seen| found.n_unproven_visible == n_seen));
        assert!(found.is_true(false) && !found.is_true(true));
    }
}

/// What proofs take for walls is covered by the plan; without any one of its lines that the cells touch, it is not.
#[test]
fn walls_of_plans_are_those_of_the_plan() {
    let plan = office(OfficeOptions { seed: 5, rooms_x: 4, rooms_y: 3, ..OfficeOptions::default() }).unwrap();
    let table = baked(&plan).unwrap();
    let found = check_walls_of_plan(&table, &plan);
    assert!(found.n_bare == 0 && found.bare.is_empty() && found.n_walls > 20, "{found:?}");
    let mut n_noticed = 0;
    for k in 0..plan.lines().len() {
        let mut lines = plan.lines().to_vec();
        lines.remove(k);
        let other = Plan::new(lines, Vec::new()).unwrap();
        n_noticed += usize::from(check_walls_of_plan(&table, &other).n_bare > 0);
    }
    // Lines on the outer border are not missed.
    assert!(n_noticed + 8 >= plan.lines().len() && n_noticed > 4, "{n_noticed} of {}", plan.lines().len());
    for plan in draw(&small_grid_plan(3..12), 24) {
        if let Some(table) = bake_plan(&plan, &PlanBakeOptions { threads: 1, ..PlanBakeOptions::default() })
            .ok()
            .filter(|baked| baked.report.n_rounded_crossings == 0)
        {
            let found = check_walls_of_plan(&table.table, &plan);
            assert_eq!(found.n_bare, 0, "{found:?}");
        }
    }
}

/// The same in space, without each object.
#[test]
fn walls_in_space_are_those_of_the_scene() {
    let (scene, table) = (rooms(), storey());
    let found = check_walls_in_space(table, &scene);
    assert!(found.n_bare == 0 && found.n_walls > 25, "{found:?}");
    let mut n_noticed = 0;
    for k in 0..scene.objects().len() {
        let mut objects = scene.objects().to_vec();
        objects.remove(k);
        let other = Scene::new(objects).unwrap();
        let found = check_walls_in_space(table, &other);
        n_noticed += usize::from(found.n_bare > 0 && !found.bare.is_empty());
    }
    assert!(n_noticed > 2, "{n_noticed} of {}", scene.objects().len());
}

/// A real map: nearly every pair is proven, nothing that the witness table shows is proven to be hidden, and wrong pairs are caught. The
/// sibling on generated maps is [`every_flipped_pair_of_maps_is_caught`].
#[test]
fn a_real_map_is_proven() {
    let Some(folder) = std::env::var_os("SIGHTLINES_DATA").map(std::path::PathBuf::from) else {
        eprintln!("SKIPPED a_real_map_is_proven: SIGHTLINES_DATA is not set");
        return;
    };
    let read = |name: &str| std::fs::read(folder.join("quake").join(name)).expect("a file of e1m7");
    let prt = parse_prt(&read("e1m7.prt")).expect("portals");
    let table = bake_prt(&prt, PrtOptions::default()).expect("clusters").table;
    let bytes = proofs_of(&table);
    let found = check_proofs(&table, &bytes).expect("proofs of the table");
    assert!(found.is_true(false), "{found:?}");
    assert!(found.n_unproven_hidden <= 10 && found.n_unproven_visible <= 30, "{found:?}");
    let n = table.n_cells() as u32;
    let proven = ConvexProofs::from_bytes(&bytes).unwrap().check(&convex_of(&table).unwrap()).unwrap();
    let words: Vec<u64> =
        read("e1m7.seen.bin").chunks_exact(8).map(|b| u64::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(words[0], u64::from(n));
    let witnessed =
        |a: u32, b: u32| words[1 + a as usize * n.div_ceil(64) as usize + b as usize / 64] >> (b % 64) & 1 == 1;
    let pairs = || (0..n).flat_map(|a| (a + 1..n).map(move |b| (a, b))).filter(|&(a, b)| witnessed(a, b));
    assert!(pairs().count() > 1000 && pairs().all(|(a, b)| !proven.hidden.has(a, b)));
    let mut n_caught = [0, 0];
    for (a, b) in (0..n).map(|a| (a, (a * 7 + 3) % n)).filter(|(a, b)| a < b).step_by(16) {
        let shown = table.sees(CellId(a), CellId(b));
        if proven.visible.has(a, b) || proven.hidden.has(a, b) {
            let found = check_proofs(&flipped(&table, a, b), &bytes).expect("proofs of a table with these cells");
            assert_eq!(found.n_violations, 1, "{a} {b}");
            n_caught[usize::from(shown)] += 1;
        }
    }
    assert!(n_caught.into_iter().all(|n| n > 0), "{n_caught:?}");
}

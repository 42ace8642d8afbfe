//! Tables of portal files, maps with visibility, and searches that are stopped and taken up again.

use proptest::prelude::*;
use sightlines_bake::from_table::{axial_graph, convex_graph, planar_graph};
use sightlines_bake::quake::state::{HASH_LEN, decode, encode, with_hash};
use sightlines_bake::quake::{StateError, StateKey};
use sightlines_bake::{PrtBakeError, PrtOptions, bake_prt, bake_scene, vis_map};
use sightlines_cells::{CellGraph, CellId, Convex, Portal3};
use sightlines_formats::quake::visibility::{VisibilityError, read_visibility};
use sightlines_formats::quake::{Bsp, BspError, BspFormat, Prt, graph_of_prt, prt::parse_prt};
use sightlines_pvs::{BitMatrix, Table};
use sightlines_scenes::{TowerOptions, tower};
use sightlines_stabtree::{ConvexCounters, ConvexOptions, ConvexSearch, ConvexState, ConvexVisibility};
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};

#[path = "../../../formats/tests/formats/common/quake.rs"]
#[expect(dead_code, reason = "other tests use the rest")]
mod quake_files;

use quake_files::{SMALL_PRTS, difference_besides_visibility, small_bsps};

/// Rooms of 8 by 8 in a row of rows, with a window in each wall between two, at a place that differs from wall
/// to wall.
fn grid(columns: u32, rows: u32) -> Prt {
    let mut prt = Prt::new(columns * rows).unwrap();
    let mut random = SplitMix::new(u64::from(columns * 100 + rows));
    let mut place = || 1.0 + random.below(5) as f64;
    for y in 0..rows {
        for x in 0..columns {
            let (cell, x0, y0) = (y * columns + x, 8.0 * f64::from(x), 8.0 * f64::from(y));
            let (u, v) = (place(), place());
            if x + 1 < columns {
                let at = |b: f64, c: f64| [x0 + 8.0, y0 + b, c];
                prt.push_portal([cell, cell + 1], &[at(u, v), at(u + 2.0, v), at(u + 2.0, v + 2.0), at(u, v + 2.0)])
                    .unwrap();
            }
            if y + 1 < rows {
                let at = |a: f64, c: f64| [x0 + a, y0 + 8.0, c];
                prt.push_portal(
                    [cell + columns, cell],
                    &[at(u, v), at(u + 2.0, v), at(u + 2.0, v + 2.0), at(u, v + 2.0)],
                )
                .unwrap();
            }
        }
    }
    prt
}

fn search(prt: &Prt, threads: usize, fast: bool) -> ConvexVisibility {
    let search = ConvexOptions { threads, fast };
    bake_prt(prt, PrtOptions { search, ..PrtOptions::default() }).unwrap().report.seen
}

#[test]
fn a_table_has_the_graph_of_the_portals() {
    let mut n_portals = 0;
    for prt in SMALL_PRTS.iter().map(|text| parse_prt(text.as_bytes()).unwrap()).chain([grid(4, 3), grid(1, 1)]) {
        let baked = bake_prt(&prt, PrtOptions::default()).unwrap();
        let (table, graph) = (&baked.table, graph_of_prt(&prt));
        assert_eq!((table.dimension(), table.n_cells()), (3, prt.n_clusters() as usize));
        assert_eq!(convex_graph(table).as_ref(), Some(&graph), "to the bit");
        assert_eq!(Table::from_bytes(&table.to_bytes()).as_ref(), Ok(table));
        for cell in (0..prt.n_clusters()).map(CellId) {
            let row: Vec<usize> = table.visible(cell).map(|other| other.idx()).collect();
            assert_eq!(row, baked.report.seen.cells.iter_ones(cell.idx()).collect::<Vec<_>>());
        }
        assert_eq!(table.info_value("source"), Some(format!("portal file {}", prt.dialect()).as_str()));
        let joined = baked.report.n_visible_pairs() > 0;
        assert_eq!(convex_graph(&table.strip_geometry()).is_none(), joined);
        n_portals += graph.portals().len();
    }
    assert!(n_portals > 20);
}

/// A square at 45 degrees with rounding errors: which axis it faces most depends on where one begins.
#[test]
fn slanted_portals_come_back() {
    let mut n_portals = 0;
    for k in 0..64u32 {
        let noise = |bit: u32| if k >> bit & 1 == 1 { 2.3e-13 } else { 0.0 };
        let points = [
            [1000.0 + noise(0), 0.0, 5.0],
            [1000.0, noise(1), 9.0 + noise(2)],
            [1008.0 + noise(3), 8.0, 9.0],
            [1008.0, 8.0 + noise(4), 5.0 + noise(5)],
        ];
        let mut prt = Prt::new(2).unwrap();
        prt.push_portal([0, 1], &points).unwrap();
        let table = bake_prt(&prt, PrtOptions::default()).unwrap().table;
        n_portals += usize::from(convex_graph(&table).unwrap() == graph_of_prt(&prt));
    }
    assert_eq!(n_portals, 64);
}

/// As seen from the first cell, corners go round counter-clockwise, in tables of portals as in those of boxes.
#[test]
fn portals_of_a_table_are_turned_like_those_of_other_tables() {
    let towards_first = |table: &Table| {
        table.portals().iter().all(|portal| {
            let [a, b, c] = [portal.points[0], portal.points[1], portal.points[2]];
            let side = |k: usize| [b[k] - a[k], c[k] - b[k]];
            let cross = |i: usize, j: usize| side(i)[0] * side(j)[1] - side(j)[0] * side(i)[1];
            let normal = [cross(1, 2), cross(2, 0), cross(0, 1)];
            // The middle of the first cell's box is on its side of the portal.
            let cell = &table.cells()[portal.cells[0].idx()];
            let out = |k: usize| 0.5 * (cell.min[k] + cell.max[k]) - a[k];
            (0..3).map(|k| normal[k] * out(k)).sum::<f64>() > 0.0
        })
    };
    // Every room of these has another opening, so that its box is on its side.
    let rooms = bake_prt(&grid(2, 2), PrtOptions::default()).unwrap().table;
    let scene = tower(TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, ..TowerOptions::default() }).unwrap();
    let boxes = bake_scene(&scene, &Default::default()).unwrap().table;
    assert!(towards_first(&rooms) && towards_first(&boxes) && !rooms.portals().is_empty());
    let mut turned = rooms.clone().into_parts();
    turned.portals[1].points.reverse();
    assert!(!towards_first(&Table::new(turned).unwrap()), "the impostor");
    assert!(convex_graph(&boxes).is_none() && axial_graph(&rooms).is_none() && planar_graph(&rooms).is_none());
}

#[test]
fn maps_get_their_visibility() {
    let prts: Vec<Prt> = SMALL_PRTS.iter().map(|text| parse_prt(text.as_bytes()).unwrap()).collect();
    let mut n_written = 0;
    for (bytes, prt) in small_bsps().into_iter().flat_map(|bytes| prts.iter().map(move |prt| (bytes.clone(), prt))) {
        let before = Bsp::parse(bytes).unwrap();
        match vis_map(&before, prt, PrtOptions::default()) {
            Ok(map) => {
                let after = Bsp::parse(map.bytes.clone()).unwrap();
                assert_eq!(difference_besides_visibility(&before, &after), None);
                let read = read_visibility(&after, &prt.leaf_clusters()).unwrap();
                assert_eq!(read.as_ref(), Some(&map.clusters.seen.cells));
                assert_eq!(map.clusters.seen.cells, search(prt, 2, false).cells);
                // What is there already is replaced by the same.
                assert_eq!(vis_map(&after, prt, PrtOptions::default()).unwrap().bytes, map.bytes);
                n_written += 1;
            }
            // Leafs of a map of Quake are no clusters, and a PRT1 does not list them.
            Err(PrtBakeError::Visibility(VisibilityError::Leafs { portals: 3, map: 4 })) => {}
            Err(error) => panic!("{error}"),
        }
    }
    // Two files of each format, and of those with clusters all portals go with them.
    let n_listing = prts.iter().filter(|prt| prt.listed_leafs().is_some()).count();
    let n_with = BspFormat::ALL.iter().filter(|format| format.has_clusters()).count();
    assert_eq!(n_written, 2 * (BspFormat::ALL.len() - n_with) * n_listing + 2 * n_with * prts.len());
}

/// Leafs under another lump cannot change: found before the search, not after it.
#[test]
fn leafs_under_another_lump_are_found_before_the_search() {
    let prt = parse_prt(SMALL_PRTS[1].as_bytes()).unwrap();
    let mut n_refused = 0;
    for mut bytes in small_bsps() {
        let bsp = Bsp::parse(bytes.clone()).unwrap();
        if bsp.format().has_clusters() {
            continue;
        }
        let mut n_steps = 0;
        let mut run = |bytes: &[u8]| {
            let mut count = |_: &ConvexSearch| n_steps += 1;
            let options = PrtOptions { after_step: Some(&mut count), ..PrtOptions::default() };
            let done = vis_map(&Bsp::parse(bytes.to_vec()).unwrap(), &prt, options);
            (done, n_steps)
        };
        let (done, n_before) = run(&bytes);
        assert!(done.is_ok() && n_before > 0);
        // The entities begin in the second leaf.
        let start = bsp.lumps()[bsp.format().leaf_lump()].start as u32 + 50;
        bytes[4..8].copy_from_slice(&start.to_le_bytes());
        let (refused, n_after) = run(&bytes);
        assert!(matches!(refused, Err(PrtBakeError::Bsp(BspError::Shared { .. }))), "{refused:?}");
        assert_eq!(n_after, n_before, "no step was taken");
        n_refused += 1;
    }
    assert_eq!(n_refused, 10);
}

#[test]
fn several_clusters_without_portals_are_refused() {
    let error = bake_prt(&Prt::new(3).unwrap(), PrtOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "there are 3 clusters, but no portals between them");
    assert!(bake_prt(&Prt::new(1).unwrap(), PrtOptions::default()).is_ok());
}

/// Stopped after any number of steps, kept as bytes, read and taken up again with another number of threads, a
/// search gives the same answer, counts included.
#[test]
fn a_search_can_be_stopped_anywhere() {
    let prt = grid(7, 6);
    let graph = graph_of_prt(&prt);
    let mut n_stops = 0;
    for fast in [false, true] {
        let key = StateKey::new(b"grid", fast);
        let options = |threads| ConvexOptions { fast, threads };
        let whole = search(&prt, 1, fast);
        assert_eq!(search(&prt, 2, fast), whole);
        assert_eq!(search(&prt, 8, fast), whole);
        let mut one = ConvexSearch::new(&graph, options(1));
        loop {
            let bytes = encode(&key, one.state());
            let state = decode(&key, &graph, &bytes).unwrap();
            assert_eq!(&state, one.state());
            let options = PrtOptions { search: options(1 + n_stops % 3), from: Some(state), ..PrtOptions::default() };
            assert_eq!(bake_prt(&prt, options).unwrap().report.seen, whole, "stopped after {n_stops}");
            // Through bytes after every step.
            n_stops += 1;
            let state = decode(&key, &graph, &bytes).unwrap();
            one = ConvexSearch::resume(&graph, self::options(fast), state).unwrap();
            if !one.advance() {
                break;
            }
        }
        assert_eq!(one.finish(), whole);
    }
    assert!(n_stops >= 5, "{n_stops}");
}

fn options(fast: bool) -> ConvexOptions {
    ConvexOptions { fast, threads: 2 }
}

#[test]
fn a_state_of_something_else_is_refused() {
    let graph = graph_of_prt(&grid(3, 3));
    let state = started(&graph);
    let key = StateKey::new(b"text", false);
    let bytes = encode(&key, &state);
    let error = |key: &StateKey, bytes: &[u8]| decode(key, &graph, bytes).unwrap_err().to_string();
    let other = "the state is of another portal file, or the file has changed since";
    assert_eq!(error(&StateKey::new(b"texts", false), &bytes), other);
    assert_eq!(error(&StateKey::new(b"text", true), &bytes), "the state is of a full search, which this is not");
    assert!(
        decode(&key, &graph_of_prt(&grid(4, 2)), &bytes)
            .unwrap_err()
            .to_string()
            .ends_with("it is for another number of cells")
    );
    assert_eq!(error(&key, b"PRT1\n3\n"), "this is no state of a search");
    assert_eq!(error(&key, b""), "this is no state of a search");
    let mut newer = bytes.clone();
    newer[8] += 1;
    assert_eq!(error(&key, &newer), "the state is of version 2, this program continues version 1");
    let cut = error(&key, &bytes[..bytes.len() - 1]);
    assert!(cut.contains("cut off"), "{cut}");
    let options = PrtOptions { from: Some(state), ..PrtOptions::default() };
    let error = bake_prt(&grid(3, 2), options).unwrap_err();
    assert_eq!(error, PrtBakeError::State(StateError::Unfit));
}

/// Some state of a search of this graph.
fn started(graph: &CellGraph<Convex>) -> ConvexState {
    let mut search = ConvexSearch::new(graph, ConvexOptions::default());
    search.advance();
    search.state().clone()
}

/// No byte of a state can be lost or changed.
#[test]
fn damaged_states_are_refused() {
    let key = StateKey::new(b"text", true);
    let graph = graph_of_prt(&grid(3, 2));
    let bytes = encode(&key, &started(&graph));
    assert!(decode(&key, &graph, &bytes).is_ok());
    (0..bytes.len()).for_each(|len| assert!(decode(&key, &graph, &bytes[..len]).is_err(), "{len} bytes"));
    let n_flips = flipped_bits(&bytes).map(|b| assert!(decode(&key, &graph, &b).is_err())).count();
    assert_eq!(n_flips, 8 * bytes.len());
    assert!(decode(&key, &graph, &[&bytes[..], &[0]].concat()).is_err());
}

/// The same bytes with a length and a hash that are right, so that what is inside is looked at.
fn hashed(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.truncate(bytes.len().saturating_sub(HASH_LEN));
    with_hash(&bytes)
}

/// Cells in a row, and some state of a search of them.
fn state_of(n: usize, pairs: &[(usize, usize, u8)], numbers: [u64; 3]) -> (CellGraph<Convex>, ConvexState) {
    let corners = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let door = Portal3::around(&corners).unwrap();
    let doors = (1..n as u32).map(|b| ([CellId(b - 1), CellId(b)], door.clone()));
    let graph = CellGraph::of_portals(n, doors.collect());
    let (mut visible, mut possible) = (BitMatrix::identity(n), BitMatrix::identity(n));
    let mut through = BitMatrix::new(2 * (n - 1), n);
    let mut undecided = Vec::new();
    for &(a, b, kind) in pairs {
        let (a, b) = (a % n, b % n);
        for (a, b) in [(a, b), (b, a)] {
            if kind == 0 {
                visible.set(a, b, true);
            }
            possible.set(a, b, true);
        }
        if n > 1 {
            through.set((a * 7 + b) % (2 * (n - 1)), b, true);
        }
        if kind == 2 && a != b {
            undecided.push([a.min(b) as u32, a.max(b) as u32]);
        }
    }
    let [done, clips, lines] = numbers;
    let counters = ConvexCounters { clips, lines, ..ConvexCounters::default() };
    let (stage, done) = (done as u32 % 5, done % n as u64);
    (graph, ConvexState { stage, done, visible, possible, through, undecided, counters })
}

proptest! {
    /// States are read as written; broken ones with right hashes are an error or a sound state, and no panic.
    #[test]
    fn states_read_as_written(
        n in 1usize..140,
        pairs in proptest::collection::vec((0usize..140, 0usize..140, 0u8..3), 0..80),
        numbers in any::<[u64; 3]>(),
        seed in any::<u64>(),
    ) {
        let (graph, state) = state_of(n, &pairs, numbers);
        let key = StateKey::new(b"text", false);
        let bytes = encode(&key, &state);
        prop_assert_eq!(&decode(&key, &graph, &bytes).unwrap(), &state);
        let mut random = SplitMix::new(seed);
        for _ in 0..20 {
            let broken = hashed(mutate(&bytes, &mut random));
            if let Ok(read) = decode(&key, &graph, &broken) {
                prop_assert!(read.visible.is_symmetric() && read.possible.is_symmetric());
                prop_assert!((0..n).all(|a| read.visible.get(a, a)));
                let is_part = |a: usize| read.visible.iter_ones(a).all(|b| read.possible.get(a, b));
                prop_assert!((0..n).all(is_part));
                prop_assert!(read.undecided.iter().all(|p| p[0] < p[1] && (p[1] as usize) < n));
            }
        }
    }
}

/// Whatever counts a state claims, memory is taken only for the cells that are there.
#[test]
fn claims_of_a_state_are_not_believed() {
    let key = StateKey::new(b"text", false);
    let (graph, state) = state_of(5, &[(0, 1, 0)], [1, 2, 3]);
    let sound = encode(&key, &state);
    let mut n_refused = 0;
    for at in (40..sound.len() - 20).step_by(4) {
        for claim in [u32::MAX, u32::MAX / 8, 1 << 16] {
            let mut bytes = sound.clone();
            bytes[at..at + 4].copy_from_slice(&claim.to_le_bytes());
            n_refused += usize::from(matches!(decode(&key, &graph, &hashed(bytes)), Err(StateError::Unsound { .. })));
        }
    }
    assert!(n_refused > 10, "{n_refused}");
}

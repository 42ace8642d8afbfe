//! Tables of portal files, maps with visibility, and searches that are stopped and taken up again.

use sightlines_bake::from_table::{axial_graph, convex_graph, planar_graph};
use sightlines_bake::{PrtBakeError, PrtOptions, bake_prt, bake_scene, vis_map};
use sightlines_cells::CellId;
use sightlines_formats::quake::visibility::{VisibilityError, read_visibility};
use sightlines_formats::quake::{Bsp, BspFormat, Prt, graph_of_prt, prt::parse_prt};
use sightlines_progress::Units;
use sightlines_pvs::Table;
use sightlines_scenes::{TowerOptions, tower};
use sightlines_stabtree::{ConvexOptions, ConvexVisibility};
use sightlines_testkit::mutate::SplitMix;
use sightlines_testkit::units::Memory;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

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
        let n_reports = AtomicUsize::new(0);
        let run = |bytes: &[u8]| {
            let count = |_| {
                n_reports.fetch_add(1, Relaxed);
                ControlFlow::Continue(())
            };
            let options = PrtOptions { progress: Some(&count), ..PrtOptions::default() };
            let done = vis_map(&Bsp::parse(bytes.to_vec()).unwrap(), &prt, options);
            (done, n_reports.load(Relaxed))
        };
        let (done, n_before) = run(&bytes);
        assert!(done.is_ok() && n_before > 1);
        // The entities begin in the second leaf.
        let start = bsp.lumps()[bsp.format().leaf_lump()].start as u32 + 50;
        bytes[4..8].copy_from_slice(&start.to_le_bytes());
        let (refused, n_after) = run(&bytes);
        let text = "lump 10 (leafs) has to change, but lump 0 (entities) lies over it";
        assert!(matches!(&refused, Err(PrtBakeError::Bsp(error)) if error.to_string() == text), "{refused:?}");
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

/// Stopped after any number of units and taken up again with another number of threads, a search gives the same answer, counts included; and what it
/// finds is what a search finds that keeps nothing.
#[test]
fn a_search_can_be_stopped_anywhere() {
    let prt = grid(7, 6);
    let mut n_stops = 0;
    for fast in [false, true] {
        let with = |memory: &Memory, threads| {
            let search = ConvexOptions { fast, threads };
            let options = PrtOptions { search, units: Units(Some(memory)), ..PrtOptions::default() };
            bake_prt(&prt, options).map(|baked| baked.report.seen)
        };
        let without = search(&prt, 1, fast);
        assert_eq!([search(&prt, 2, fast), search(&prt, 8, fast)], [without.clone(), without.clone()]);
        let memory = Memory::default();
        let whole = with(&memory, 1).unwrap();
        assert_eq!((&whole.cells, &whole.undecided), (&without.cells, &without.undecided));
        let results = memory.into_results();
        for n in 1..results.len() {
            let stopping = Memory::default().stopping_after(n);
            let stopped = with(&stopping, 1).unwrap_err();
            assert!(matches!(stopped, PrtBakeError::Cancelled(_) | PrtBakeError::Halted(_)), "{stopped}");
            assert_eq!(with(&Memory::with(&stopping.into_results()), 1 + n % 3).unwrap(), whole, "{n} results");
            n_stops += 1;
        }
        assert_eq!(with(&Memory::with(&results), 2).unwrap(), whole);
    }
    assert!(n_stops >= 5, "{n_stops}");
}

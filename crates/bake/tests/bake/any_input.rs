//! One call for any input: the tables of the functions for one kind of input, byte for byte, with the graph beside them.

use sightlines_bake::methods::{Backend, OcclusionMethod};
use sightlines_bake::{
    BakeError, BakeInput, BakeRequest, Baked, BufferRequest, CellsFrom, CertifyError, PlanBakeOptions, PrtOptions,
    Report, Runtime, SceneBakeOptions, SceneMethod, TableGraph, bake, bake_plan, bake_prt, bake_scene, from_table,
};
use sightlines_formats::quake::prt::parse_prt;
use sightlines_progress::Progress;
use sightlines_scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines_stabtree::CertifyOptions;
use std::ops::ControlFlow;
use std::sync::Mutex;

/// Three rooms in a row.
const ROOMS: &[u8] = b"PRT1\n3\n2\n4 0 1 (8 0 0) (8 2 0) (8 2 2) (8 0 2)\n4 1 2 (16 0 0) (16 2 0) (16 2 2) (16 0 2)\n";

/// The graph is that of the table, as a stored table gives it back.
fn check_graph(baked: &Baked) {
    let stored = from_table::graph(&baked.table).expect("the table stores its graph");
    match (&baked.graph, &stored) {
        // A table has one group for a cell, a graph all.
        (TableGraph::Planar(kept), TableGraph::Planar(stored)) => {
            assert_eq!(kept.portals(), stored.portals());
            let polygons = kept.cells().iter().zip(stored.cells());
            assert!(polygons.into_iter().all(|(a, b)| a.polygon == b.polygon));
        }
        (kept, stored) => assert_eq!(kept, stored),
    }
}

#[test]
fn one_call_bakes_what_each_function_bakes() {
    let floor = office(OfficeOptions { rooms_x: 4, rooms_y: 2, ..OfficeOptions::default() }).unwrap();
    let scene = tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, ..TowerOptions::default() }).unwrap();
    let rooms = parse_prt(ROOMS).unwrap();
    let expected = [
        bake_plan(&floor, &PlanBakeOptions::default()).unwrap().table,
        bake_scene(&scene, &SceneBakeOptions::default()).unwrap().table,
        bake_prt(&rooms, PrtOptions::default()).unwrap().table,
    ];
    let inputs: [BakeInput<'_>; 3] = [(&floor).into(), (&scene).into(), (&rooms).into()];
    for (input, expected) in inputs.into_iter().zip(expected) {
        // What suits the input is chosen, and is the default for all of these.
        for method in [None, Some(SceneMethod::Auto)] {
            let runtime = Runtime { threads: 2, ..Runtime::default() };
            let baked = runtime.bake(input, &BakeRequest { method, ..BakeRequest::default() }).unwrap();
            assert_eq!(baked.table.to_bytes(), expected.to_bytes());
            check_graph(&baked);
        }
    }
}

#[test]
fn scenes_take_every_method_and_all_cells() {
    let walls = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
    let scene = tower(TowerOptions { windows: false, ..walls }).unwrap();
    let buffers = BufferRequest { planes: Some(1), texels: Some(16), ..BufferRequest::default() };
    let mut n_regions = 0;
    for method in SceneMethod::all() {
        assert_eq!(method.to_string().parse(), Ok(method));
        for cells in [CellsFrom::KdTree, CellsFrom::Grid([2, 1, 2])] {
            let has_buffers =
                [SceneMethod::Both, SceneMethod::FromRegion(OcclusionMethod::Multifocal)].contains(&method);
            if method == SceneMethod::FromRegion(OcclusionMethod::Multifocal) && cells == CellsFrom::KdTree {
                continue; // takes long
            }
            let request = BakeRequest { method: Some(method), cells: Some(cells), ..BakeRequest::default() };
            let with_buffers = BakeRequest { buffers, ..request.clone() };
            // Buffers mean nothing for the others.
            assert_eq!(with_buffers.prepare(&scene, &Runtime::default()).is_ok(), has_buffers, "{method}");
            let request = if has_buffers { with_buffers } else { request };
            let prepared = request.prepare(&scene, &Runtime::default()).unwrap();
            let options = prepared.recipe();
            let baked = prepared.run(&Runtime::default()).unwrap();
            check_graph(&baked);
            let takes_regions = matches!(baked.report, Report::Regions(_));
            assert_eq!(
                takes_regions,
                options.takes_regions() && method != SceneMethod::Auto || options.has_given_cells()
            );
            assert_eq!(matches!(baked.graph, TableGraph::Boxes(_)), options.has_given_cells());
            n_regions += u32::from(takes_regions);
        }
    }
    assert!(n_regions >= 8, "{n_regions}");
    assert!("view".parse::<SceneMethod>().is_err());
}

#[test]
fn what_cannot_be_prepared_is_refused() {
    let scene = tower(TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, ..TowerOptions::default() }).unwrap();
    let error = |options: BakeRequest| bake(&scene, &options).unwrap_err();
    let cells = Some(CellsFrom::Grid([0, 1, 1]));
    assert!(matches!(error(BakeRequest { cells, ..BakeRequest::default() }), BakeError::Grid(_)));
    let cells = Some(CellsFrom::Grid([1, 1, 1]));
    let method = Some(SceneMethod::Both);
    let buffers = BufferRequest { planes: Some(256), texels: Some(8192), ..BufferRequest::default() };
    assert!(matches!(
        error(BakeRequest { cells: cells.clone(), method, buffers, ..BakeRequest::default() }),
        BakeError::Method(_)
    ));
    let buffers = BufferRequest { backend: Some(Backend::Gpu), ..BufferRequest::default() };
    let gpu = bake(&scene, &BakeRequest { method, cells, buffers, ..BakeRequest::default() });
    assert_eq!(gpu.is_ok(), cfg!(feature = "multifocal-gpu"));
    match gpu {
        Ok(_) => {}
        Err(error) => {
            let text = "the backend gpu is not part of this build: it needs the feature multifocal-gpu";
            assert_eq!(error.to_string(), text);
        }
    }
}

/// Proofs are reported unit by unit and can be cancelled; an observer changes nothing.
#[test]
fn proofs_are_observed() {
    let floor = office(OfficeOptions { rooms_x: 3, rooms_y: 2, ..OfficeOptions::default() }).unwrap();
    let scene = tower(TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, ..TowerOptions::default() }).unwrap();
    let rooms = parse_prt(ROOMS).unwrap();
    let inputs: [BakeInput<'_>; 3] = [(&floor).into(), (&scene).into(), (&rooms).into()];
    for input in inputs {
        let baked = bake(input, &BakeRequest::default()).unwrap();
        let reports = Mutex::new(Vec::new());
        let watch = |progress: Progress| {
            reports.lock().unwrap().push((progress.done, progress.total, progress.share));
            ControlFlow::Continue(())
        };
        let watched =
            baked.certify(&CertifyOptions { threads: 2, progress: Some(&watch), ..CertifyOptions::default() });
        let alone = baked.certify(&CertifyOptions::default()).unwrap();
        assert_eq!(watched.unwrap().proofs.to_bytes(), alone.proofs.to_bytes());
        let mut reports = reports.into_inner().unwrap();
        reports.sort_by_key(|report| report.0);
        let total = reports[0].1;
        assert!(reports.iter().map(|report| report.0).eq(1..=total), "{reports:?}");
        assert!(reports.iter().all(|report| report.1 == total) && reports.last().unwrap().2 == 1.0, "{reports:?}");
        let stop = |_: Progress| ControlFlow::Break(());
        let stopped = baked.certify(&CertifyOptions { progress: Some(&stop), ..CertifyOptions::default() });
        assert!(matches!(stopped, Err(CertifyError::Cancelled(_))), "{stopped:?}");
    }
}

//! Bakes whose results are kept by units of work: stopped and taken up again, or shared by processes, they end with the same bytes.

use crate::limit::building;
use crate::places::city_of_boxes;
use sightlines_bake::methods::{BufferOptions, OcclusionMethod, OcclusionMethodFactory};
use sightlines_bake::region::{PackRegionsError, pack_regions};
use sightlines_bake::{
    BakeError, BakeInput, BakeRequest, Baked, BufferRequest, CellsFrom, CertifyError, RegionBakeOptions, Report,
    Runtime, SceneMethod, StabBakeError, StabOptions, TableGraph, bake, bake_regions, with_stab_trees,
};
use sightlines_certificates::axial::AxialProofs;
use sightlines_certificates::convex::ConvexProofs;
use sightlines_certificates::planar::PlanarProofs;
use sightlines_formats::quake::Prt;
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_packed::{PackOptions, SizeClass, pack};
use sightlines_progress::{Halt, Units};
use sightlines_pvs::CellId;
use sightlines_scenes::{CityOptions, OfficeOptions, TowerOptions, city_crossings, office, tower};
use sightlines_stabtree::{CertifyOptions, axial_network, convex_network, planar_network};
use sightlines_testkit::units::{Memory, Results, check_impostor, check_units};
use std::collections::BTreeSet;

/// A bake by units.
fn baked<'a>(
    input: BakeInput<'a>,
    options: &'a BakeRequest,
) -> impl Fn(Units<'_>, usize) -> Result<Vec<u8>, BakeError> + 'a {
    move |units, threads| Ok(Runtime { units, threads, ..Runtime::default() }.bake(input, options)?.table.to_bytes())
}

fn scene() -> sightlines_cells::Scene {
    tower(TowerOptions { floors: 2, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() }).unwrap()
}

#[test]
fn sightlines_of_a_scene() {
    let (scene, options) = (scene(), BakeRequest::default());
    let phases = check_units(baked((&scene).into(), &options));
    assert_eq!(phases.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["pairs", "objects"]);
    assert!(phases.iter().all(|(_, n)| *n > 20), "{phases:?}");
    check_impostor(baked((&scene).into(), &options), "pairs");
    check_impostor(baked((&scene).into(), &options), "objects");
}

/// Eyes so far beside the crossings of a city of so many blocks.
fn streets([blocks_x, blocks_z]: [u32; 2], beside: &[f64]) -> CellsFrom {
    let crossings = city_crossings(CityOptions { blocks_x, blocks_z, ..CityOptions::default() }).unwrap();
    let moved = |by: &f64| {
        let along =
            |b: &Aabb<3>| Aabb { min: [b.min[0] + by, b.min[1], b.min[2]], max: [b.max[0] + by, b.max[1], b.max[2]] };
        crossings.iter().map(along).collect::<Vec<_>>()
    };
    let boxes: Vec<Aabb<3>> = beside.iter().flat_map(moved).collect();
    let cell = |(k, bounds): (usize, Aabb<3>)| ViewCell { id: k.to_string(), bounds };
    CellsFrom::Boxes(ViewCells { cells: boxes.into_iter().enumerate().map(cell).collect(), axes: None })
}

#[test]
fn cells_by_from_region_methods() {
    // Few triangles: a scene is prepared anew for each way.
    let blocks = [3, 3];
    let scene = city_of_boxes(blocks);
    let small = BufferRequest { planes: Some(2), texels: Some(32), ..BufferRequest::default() };
    for method in [OcclusionMethod::Multifocal, OcclusionMethod::Shafts] {
        let options = BakeRequest {
            method: Some(SceneMethod::FromRegion(method)),
            cells: Some(streets(blocks, &[0.0, 8.0, 16.0])),
            buffers: if method == OcclusionMethod::Multifocal { small } else { BufferRequest::default() },
            ..BakeRequest::default()
        };
        assert_eq!(check_units(baked((&scene).into(), &options)), [("cells", 12)]);
        check_impostor(baked((&scene).into(), &options), "cells");
    }
}

#[test]
fn both_methods_one_after_the_other() {
    let buffers = BufferRequest { planes: Some(1), texels: Some(16), ..BufferRequest::default() };
    let method = Some(SceneMethod::Both);
    let scene = building(false);
    let options = BakeRequest { method, cells: Some(CellsFrom::Grid([3, 2, 1])), buffers, ..BakeRequest::default() };
    let phases = check_units(baked((&scene).into(), &options));
    assert_eq!(phases, [("cells", 6), ("boxes", 6)]);
    check_impostor(baked((&scene).into(), &options), "boxes");
    let walls = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
    let scene = tower(TowerOptions { windows: false, ..walls }).unwrap();
    let options = BakeRequest { cells: Some(CellsFrom::KdTree), ..options };
    let phases: Vec<_> = check_units(baked((&scene).into(), &options)).into_iter().map(|(name, _)| name).collect();
    assert_eq!(phases, ["pairs", "objects", "cells"]);
}

/// Rooms in rows, with a window in each wall at a place that differs.
fn rooms(columns: u32, rows: u32) -> Prt {
    let mut prt = Prt::new(columns * rows).unwrap();
    let mut state = 7u32;
    let mut place = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        1.0 + f64::from(state >> 29)
    };
    for (x, y) in (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y))) {
        let (cell, x0, y0) = (y * columns + x, 12.0 * f64::from(x), 12.0 * f64::from(y));
        let (u, v) = (place(), place());
        let square =
            |at: &dyn Fn(f64, f64) -> [f64; 3]| [at(u, v), at(u + 2.0, v), at(u + 2.0, v + 2.0), at(u, v + 2.0)];
        if x + 1 < columns {
            prt.push_portal([cell, cell + 1], &square(&|b, c| [x0 + 12.0, y0 + b, c])).unwrap();
        }
        if y + 1 < rows {
            prt.push_portal([cell + columns, cell], &square(&|a, c| [x0 + a, y0 + 12.0, c])).unwrap();
        }
    }
    prt
}

#[test]
fn clusters_of_a_portal_file() {
    let prt = rooms(14, 9);
    let phases = check_units(baked((&prt).into(), &BakeRequest::default()));
    assert_eq!((phases.len(), phases[0], phases[1].0), (8, ("first", 1), "beams"));
    check_impostor(baked((&prt).into(), &BakeRequest::default()), "beams");
    let fast = BakeRequest { fast: true, ..BakeRequest::default() };
    let whole = Memory::default();
    let with = |units: Units<'_>| baked((&prt).into(), &fast)(units, 1);
    assert_eq!(with(Units(Some(&whole))), with(Units::default()));
    assert_eq!(whole.into_results().keys().map(|key| key.0).collect::<BTreeSet<_>>(), BTreeSet::from(["first"]));
}

/// Stab trees of the cells of a table, in a table.
fn trees(baked: &Baked<TableGraph, Report>) -> impl Fn(Units<'_>, usize) -> Result<Vec<u8>, StabBakeError> + '_ {
    |units, threads| {
        let options = StabOptions { max_nodes: Some(12), threads, units, ..StabOptions::default() };
        let made = with_stab_trees(baked.table.clone(), &baked.graph, &options)?;
        assert!(made.report.trees.n_cut_cells > 0 && made.report.trees.n_sequences > 0, "{:?}", made.report);
        let report = format!("{:?}", made.report.trees);
        Ok([made.table.to_bytes(), report.into_bytes()].concat())
    }
}

#[test]
fn stab_trees_of_cells() {
    let options = OfficeOptions { rooms_x: 6, rooms_y: 3, block: 3, ..OfficeOptions::default() };
    let (plan, scene, prt) = (office(options).unwrap(), scene(), rooms(6, 4));
    for input in [BakeInput::from(&plan), (&scene).into(), (&prt).into()] {
        let baked = bake(input, &BakeRequest::default()).unwrap();
        assert_eq!(check_units(trees(&baked)), [("stab-trees", baked.table.n_cells())]);
        check_impostor(trees(&baked), "stab-trees");
    }
}

/// Proofs of a table.
fn proofs(baked: &Baked<TableGraph, Report>) -> impl Fn(Units<'_>, usize) -> Result<Vec<u8>, CertifyError> + '_ {
    |units, threads| {
        let options = CertifyOptions { threads, units, ..CertifyOptions::default() };
        Ok(baked.certify(&options)?.proofs.to_bytes())
    }
}

/// Proofs are many units: lines and walks build on each other, what is hidden in space does not.
#[test]
fn proofs_of_tables() {
    let options = OfficeOptions { rooms_x: 3, rooms_y: 1, block: 2, ..OfficeOptions::default() };
    let (plan, prt) = (office(options).unwrap(), rooms(4, 2));
    let scene =
        tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() }).unwrap();
    for (input, phases, least) in [
        (BakeInput::from(&plan), &["proofs"][..], 60),
        ((&scene).into(), &["proofs", "object-proofs", "line-proofs"], 40),
        ((&prt).into(), &["proofs"], 60),
    ] {
        let baked = bake(input, &BakeRequest::default()).unwrap();
        let found = check_units(proofs(&baked));
        assert_eq!(found.iter().map(|(name, _)| *name).collect::<Vec<_>>(), phases);
        assert!(found.iter().all(|(_, n)| *n > least), "{found:?}");
        phases.iter().for_each(|phase| check_impostor(proofs(&baked), phase));
    }
}

/// Each result of a unit is checked again: those of other tables, and with any byte changed, prove nothing wrong.
#[test]
fn kept_proofs_are_not_trusted() {
    let bakes = |rooms_x: u32| {
        let options = OfficeOptions { rooms_x, rooms_y: 1, block: 2, ..OfficeOptions::default() };
        let tower_options = TowerOptions { floors: 1, rooms_x: rooms_x - 1, rooms_y: 1, ..TowerOptions::default() };
        let tower_options = TowerOptions { furniture: 1, ..tower_options };
        let (plan, scene, prt) = (office(options).unwrap(), tower(tower_options).unwrap(), rooms(rooms_x, 2));
        [BakeInput::from(&plan), (&scene).into(), (&prt).into()]
            .map(|input| bake(input, &BakeRequest::default()).unwrap())
    };
    let kept = |baked: &Baked<TableGraph, Report>| {
        let store = Memory::default();
        let bytes = proofs(baked)(Units(Some(&store)), 1).unwrap();
        (bytes, store.into_results())
    };
    let (mut n_refused, mut n_harmless) = (0, 0);
    for (own, other) in bakes(2).iter().zip(&bakes(3)) {
        let (plain, results) = kept(own);
        let with = |changed: &Results| proofs(own)(Units(Some(&Memory::with(changed))), 1);
        let mut check = |changed: &Results| match with(changed) {
            Err(CertifyError::Halted(Halt::Store(text))) => {
                assert!(text.starts_with("the kept result of unit "), "{text}");
                assert!(text.ends_with("does not fit these cells"), "{text}");
                n_refused += 1;
            }
            // Other proofs, which hold.
            Ok(bytes) => {
                check_proofs(own, &bytes);
                n_harmless += usize::from(bytes != plain);
            }
            Err(error) => panic!("{error}"),
        };
        // All results of another table that have a place here.
        let foreign: Results = kept(other).1.into_iter().filter(|(key, _)| results.contains_key(key)).collect();
        check(&results.iter().chain(&foreign).map(|(key, bytes)| (*key, bytes.clone())).collect());
        // Lines that are not shot: one is taken, the step to which is larger than all that there are.
        let first = *results
            .keys()
            .filter(|key| ["proofs", "line-proofs"].contains(&key.0))
            .min_by_key(|key| (key.0, key.1))
            .unwrap();
        for far in [&[1, 0xFE, 0xFF, 0xFF, 0x0F][..], &[1, 0xFE, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F]] {
            let mut changed = results.clone();
            changed.insert(first, far.to_vec());
            check(&changed);
        }
        // Every result that says something, with a byte changed.
        for (k, (key, bytes)) in results.iter().filter(|(_, bytes)| bytes.len() > 3).enumerate().step_by(5) {
            let mut changed = results.clone();
            let mut bytes = bytes.clone();
            let at = (k * 7) % bytes.len();
            bytes[at] ^= 1 << (k % 8);
            changed.insert(*key, bytes);
            check(&changed);
        }
    }
    assert!(n_refused > 30 && n_harmless > 0, "{n_refused} refused, {n_harmless} others");
}

/// Proofs hold, and prove nothing that the table contradicts.
fn check_proofs(baked: &Baked<TableGraph, Report>, bytes: &[u8]) {
    let table = &baked.table;
    let proven = match &baked.graph {
        TableGraph::Planar(graph) => PlanarProofs::from_bytes(bytes).unwrap().check(&planar_network(graph).unwrap()),
        TableGraph::Axial(graph) => {
            let boxes: Vec<_> = table.objects().iter().map(|object| [object.min, object.max]).collect();
            let network = axial_network(graph).unwrap().with_objects(&boxes);
            AxialProofs::from_bytes(bytes).unwrap().check(&network)
        }
        TableGraph::Convex(graph) => ConvexProofs::from_bytes(bytes).unwrap().check(&convex_network(graph).unwrap()),
        _ => panic!("cells without portals"),
    };
    let proven = proven.expect("proofs hold");
    for a in 0..table.n_cells() as u32 {
        for b in (0..a).filter(|&b| proven.hidden.has(a, b)) {
            assert!(!table.sees(CellId(a), CellId(b)), "cells {a} and {b} see each other");
        }
    }
}

/// Row by row the packed table is written that the whole one gives.
#[test]
fn rows_one_by_one_make_the_same_packed_table() {
    let (scene, cells) = (city_of_boxes([3, 3]), streets([3, 3], &[0.0, 8.0, 16.0, 24.0]));
    let factory = OcclusionMethodFactory::new(OcclusionMethod::Shafts, &scene, &BufferOptions::default()).unwrap();
    let make = || factory.instance();
    let options = RegionBakeOptions { method: Some(&make), sightlines: false, ..RegionBakeOptions::new(&cells) };
    let table = bake_regions(&scene, &options).unwrap().table;
    let (bytes, report, _) = pack_regions(&scene, &options, &|_| {}, Vec::new()).unwrap();
    let large = PackOptions { class: Some(SizeClass::Large), ..PackOptions::default() };
    assert!(bytes == pack(&table, &large).unwrap());
    let n = table.n_cells() as u64;
    assert!(report.n_visible_pairs > n && report.n_visible_pairs < n * (n - 1) / 2 * 9 / 10, "nothing is hidden");
    // Sightlines decide pairs in doubt of all cells at once.
    let both = RegionBakeOptions { sightlines: true, ..options };
    assert!(matches!(pack_regions(&scene, &both, &|_| {}, Vec::new()), Err(PackRegionsError::NeedsPairs)));
}

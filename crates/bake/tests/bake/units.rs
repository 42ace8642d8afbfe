//! Bakes whose results are kept by units of work: stopped and taken up again, or shared by processes, they end with the same bytes.

use crate::limit::building;
use sightlines_bake::methods::{BufferOptions, OcclusionMethod, OcclusionMethodFactory};
use sightlines_bake::region::{PackRegionsError, pack_regions};
use sightlines_bake::{
    BakeError, BakeInput, BakeOptions, Baked, CellsFrom, CertifyError, RegionBakeOptions, Report, SceneMethod,
    StabBakeError, StabOptions, TableGraph, bake, bake_regions, with_stab_trees,
};
use sightlines_formats::quake::Prt;
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_packed::{PackOptions, SizeClass, pack};
use sightlines_progress::{Halt, Units};
use sightlines_scenes::{CityOptions, OfficeOptions, TowerOptions, city, city_crossings, office, tower};
use sightlines_stabtree::CertifyOptions;
use sightlines_testkit::units::{Memory, check_impostor, check_units};
use std::collections::BTreeSet;

/// A bake by units.
fn baked<'a>(
    input: BakeInput<'a>,
    options: &'a BakeOptions<'a>,
) -> impl Fn(Units<'_>, usize) -> Result<Vec<u8>, BakeError> + 'a {
    move |units, threads| Ok(bake(input, &BakeOptions { units, threads, ..options.clone() })?.table.to_bytes())
}

fn scene() -> sightlines_cells::Scene {
    tower(TowerOptions { floors: 2, rooms_x: 4, rooms_y: 3, furniture: 1, ..TowerOptions::default() }).unwrap()
}

#[test]
fn sightlines_of_a_scene() {
    let (scene, options) = (scene(), BakeOptions::default());
    let phases = check_units(baked((&scene).into(), &options));
    assert_eq!(phases.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["pairs", "objects"]);
    assert!(phases.iter().all(|(_, n)| *n > 20), "{phases:?}");
    check_impostor(baked((&scene).into(), &options), "pairs");
    check_impostor(baked((&scene).into(), &options), "objects");
}

/// Eyes at the crossings of a city and beside them.
fn streets(city: CityOptions) -> CellsFrom {
    let crossings = city_crossings(city).unwrap();
    let beside = |by: f64| {
        let moved = move |b: &Aabb<3>| Aabb {
            min: [b.min[0] + by, b.min[1], b.min[2]],
            max: [b.max[0] + by, b.max[1], b.max[2]],
        };
        crossings.iter().map(moved).collect::<Vec<_>>()
    };
    let boxes = [0.0, 8.0, 16.0, 24.0].map(beside).concat();
    let cell = |(k, bounds): (usize, Aabb<3>)| ViewCell { id: k.to_string(), bounds };
    CellsFrom::Boxes(ViewCells { cells: boxes.into_iter().enumerate().map(cell).collect(), axes: None })
}

#[test]
fn cells_by_from_region_methods() {
    let options = CityOptions { blocks_x: 4, blocks_z: 4, ..CityOptions::default() };
    let scene = city(options).unwrap();
    let buffers = BufferOptions { planes: 2, texels: 64, ..BufferOptions::default() };
    for method in [OcclusionMethod::Multifocal, OcclusionMethod::Voxels] {
        let options = BakeOptions {
            method: SceneMethod::FromRegion(method),
            cells: streets(options),
            buffers,
            ..BakeOptions::default()
        };
        assert_eq!(check_units(baked((&scene).into(), &options)), [("cells", 36)]);
        check_impostor(baked((&scene).into(), &options), "cells");
    }
}

#[test]
fn both_methods_one_after_the_other() {
    let buffers = BufferOptions { planes: 1, texels: 16, ..BufferOptions::default() };
    let method = SceneMethod::Both;
    let scene = building(false);
    let options = BakeOptions { method, cells: CellsFrom::Grid([3, 2, 1]), buffers, ..BakeOptions::default() };
    let phases = check_units(baked((&scene).into(), &options));
    assert_eq!(phases, [("cells", 6), ("boxes", 6)]);
    check_impostor(baked((&scene).into(), &options), "boxes");
    let scene =
        tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() }).unwrap();
    let options = BakeOptions { cells: CellsFrom::KdTree, ..options };
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
    let phases = check_units(baked((&prt).into(), &BakeOptions::default()));
    assert_eq!((phases.len(), phases[0], phases[1].0), (8, ("first", 1), "beams"));
    check_impostor(baked((&prt).into(), &BakeOptions::default()), "beams");
    let fast = BakeOptions { fast: true, ..BakeOptions::default() };
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
        let baked = bake(input, &BakeOptions::default()).unwrap();
        assert_eq!(check_units(trees(&baked)), [("stab-trees", baked.table.n_cells())]);
        check_impostor(trees(&baked), "stab-trees");
    }
}

/// Proofs are one unit: kept once they are found, by one of several processes.
#[test]
fn proofs_of_tables() {
    let options = OfficeOptions { rooms_x: 4, rooms_y: 2, block: 2, ..OfficeOptions::default() };
    let (plan, prt) = (office(options).unwrap(), rooms(4, 3));
    let scene =
        tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() }).unwrap();
    let mut others: Vec<Vec<u8>> = Vec::new();
    for input in [BakeInput::from(&plan), (&scene).into(), (&prt).into()] {
        let baked = bake(input, &BakeOptions::default()).unwrap();
        let proofs = |store: &Memory| {
            let options = CertifyOptions { threads: 1, units: Units(Some(store)), ..CertifyOptions::default() };
            baked.certify(&options).map(|made| made.proofs.to_bytes())
        };
        let plain = baked.certify(&CertifyOptions::default()).unwrap().proofs.to_bytes();
        let store = Memory::default();
        assert_eq!(proofs(&store).unwrap(), plain);
        assert_eq!(store.phases(), [("proofs", vec![1.0])]);
        let results = store.into_results();
        assert_eq!(proofs(&Memory::with(&results).stopping_after(0)).unwrap(), plain);
        let stopped = proofs(&Memory::default().stopping_after(0));
        assert!(matches!(stopped, Err(CertifyError::Cancelled(_))), "{stopped:?}");
        let of_other = proofs(&Memory::default().of_part(1, 3));
        assert_eq!(of_other, Err(CertifyError::Halted(Halt::Shared)));
        // What is cut short, or of another table, is noticed.
        others.push(plain[..plain.len() / 2].to_vec());
        for other in &others {
            let wrong = proofs(&Memory::with(&[(("proofs", 0), other.clone())].into()));
            assert!(matches!(wrong, Err(CertifyError::Halted(Halt::Store(_)))), "{wrong:?}");
        }
        others.push(plain);
    }
}

/// Row by row the packed table is written that the whole one gives.
#[test]
fn rows_one_by_one_make_the_same_packed_table() {
    let options = CityOptions { blocks_x: 4, blocks_z: 4, ..CityOptions::default() };
    let (scene, cells) = (city(options).unwrap(), streets(options));
    let factory = OcclusionMethodFactory::new(OcclusionMethod::Voxels, &scene, &BufferOptions::default()).unwrap();
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

//! Bakes whose results are kept by units of work: stopped and taken up again, or shared by processes, they end with the same bytes.

use crate::limit::building;
use sightlines_bake::methods::{BufferOptions, OcclusionMethod, OcclusionMethodFactory};
use sightlines_bake::region::{PackRegionsError, pack_regions};
use sightlines_bake::{
    BakeError, BakeInput, BakeOptions, CellsFrom, RegionBakeOptions, SceneMethod, bake, bake_regions,
};
use sightlines_formats::quake::Prt;
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_packed::{PackOptions, SizeClass, pack};
use sightlines_progress::{Cancelled, Halt, Phase, UnitStore, Units};
use sightlines_scenes::{CityOptions, TowerOptions, city, city_crossings, tower};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

/// Keeps results in memory, and does a part of them.
#[derive(Default)]
struct Memory {
    results: Mutex<BTreeMap<(&'static str, usize), Vec<u8>>>,
    sizes: Mutex<Vec<(&'static str, Vec<f64>)>>,
    n_saved: Mutex<usize>,
    /// Ends the bake after so many results.
    stop_after: Option<usize>,
    /// Which of how many processes this is.
    part: Option<(usize, usize)>,
}

impl UnitStore for Memory {
    fn begin(&self, phase: &Phase<'_>) -> Result<(), Halt> {
        assert!(phase.costs.iter().all(|cost| cost.is_finite() && *cost >= 0.0));
        let mut sizes = self.sizes.lock().unwrap();
        assert!(sizes.iter().all(|(name, _)| *name != phase.name), "{} begins twice", phase.name);
        sizes.push((phase.name, phase.costs.to_vec()));
        Ok(())
    }

    fn wants(&self, _: &'static str, unit: usize) -> bool {
        self.part.is_none_or(|(part, of)| unit % of == part)
    }

    fn load(&self, phase: &'static str, unit: usize) -> Result<Option<Vec<u8>>, Halt> {
        Ok(self.results.lock().unwrap().get(&(phase, unit)).cloned())
    }

    fn save(&self, phase: &'static str, unit: usize, result: &[u8]) -> Result<(), Halt> {
        let mut n = self.n_saved.lock().unwrap();
        if self.stop_after.is_some_and(|most| *n >= most) {
            return Err(Cancelled.into());
        }
        *n += 1;
        assert!(self.results.lock().unwrap().insert((phase, unit), result.to_vec()).is_none(), "{phase} {unit} twice");
        Ok(())
    }

    fn end(&self, phase: &'static str) -> Result<(), Halt> {
        let results = self.results.lock().unwrap();
        let size = self.sizes.lock().unwrap().last().map(|(name, costs)| (*name, costs.len()));
        let n = size.filter(|(name, _)| *name == phase).expect("a phase that has begun").1;
        if (0..n).all(|unit| results.contains_key(&(phase, unit))) { Ok(()) } else { Err(Halt::Shared) }
    }
}

impl Memory {
    fn with(results: &BTreeMap<(&'static str, usize), Vec<u8>>) -> Self {
        Self { results: Mutex::new(results.clone()), ..Self::default() }
    }

    fn into_results(self) -> BTreeMap<(&'static str, usize), Vec<u8>> {
        self.results.into_inner().unwrap()
    }
}

fn bytes(
    input: BakeInput<'_>,
    options: &BakeOptions<'_>,
    store: Option<&Memory>,
    threads: usize,
) -> Result<Vec<u8>, BakeError> {
    let units = Units(store.map(|store| store as &dyn UnitStore));
    Ok(bake(input, &BakeOptions { units, threads, ..options.clone() })?.table.to_bytes())
}

/// Bakes in every way and compares; returns the phases, each with its number of units.
fn check(input: BakeInput<'_>, options: &BakeOptions<'_>) -> Vec<(&'static str, usize)> {
    let plain = bytes(input, options, None, 2).unwrap();
    let whole = Memory::default();
    assert_eq!(bytes(input, options, Some(&whole), 2).unwrap(), plain);
    let phases = whole.sizes.lock().unwrap().iter().map(|(name, costs)| (*name, costs.len())).collect();
    let all = whole.into_results();

    // Nothing is computed twice where everything is kept, and every result counts: one of another unit is noticed, or changes nothing.
    let kept = Memory { stop_after: Some(0), ..Memory::with(&all) };
    assert_eq!(bytes(input, options, Some(&kept), 1).unwrap(), plain);

    // Stopped again and again.
    let (mut results, mut n_stops) = (BTreeMap::new(), 0);
    let step = all.len() / 5 + 1;
    let resumed = loop {
        let store = Memory { stop_after: Some(step), ..Memory::with(&results) };
        let answer = bytes(input, options, Some(&store), 1 + n_stops % 2);
        results = store.into_results();
        match answer {
            Ok(bytes) => break bytes,
            Err(error) => assert_eq!(error.to_string(), Cancelled.to_string()),
        }
        n_stops += 1;
        assert!(n_stops < 9);
    };
    assert!(resumed == plain && n_stops > 2, "{n_stops} stops");

    // Shared by three processes that know only what earlier phases have found.
    let (mut results, mut rounds) = (BTreeMap::new(), 0);
    let merged = loop {
        let mut found = BTreeMap::new();
        for part in 0..3 {
            let store = Memory { part: Some((part, 3)), ..Memory::with(&results) };
            let answer = bytes(input, options, Some(&store), 1);
            assert!(matches!(answer, Err(BakeError::Halted(Halt::Shared))) || answer.is_ok() || is_shared(&answer));
            found.extend(store.into_results());
        }
        results = found;
        let store = Memory { part: Some((usize::MAX, usize::MAX)), stop_after: Some(0), ..Memory::with(&results) };
        match bytes(input, options, Some(&store), 1) {
            Ok(bytes) => break bytes,
            Err(error) => assert!(is_shared(&Err::<Vec<u8>, _>(error))),
        }
        rounds += 1;
        assert!(rounds < 12);
    };
    assert_eq!(merged, plain);
    phases
}

fn is_shared(answer: &Result<Vec<u8>, BakeError>) -> bool {
    answer.as_ref().is_err_and(|error| error.to_string() == Halt::Shared.to_string())
}

/// A kept result is used: with another one in its place the table is another, or the bake fails.
fn check_impostor(input: BakeInput<'_>, options: &BakeOptions<'_>, phase: &str) {
    let whole = Memory::default();
    let plain = bytes(input, options, Some(&whole), 2).unwrap();
    let all = whole.into_results();
    let of_phase: Vec<_> = all.iter().filter(|((name, _), _)| *name == phase).collect();
    let longest = of_phase.iter().max_by_key(|(_, bytes)| bytes.len()).expect("a result").0;
    let others = of_phase.iter().filter(|(key, bytes)| *key != longest && **bytes != all[longest]).take(20);
    let is_noticed = |other: &Vec<u8>| {
        let mut wrong = all.clone();
        wrong.insert(*longest, other.clone());
        bytes(input, options, Some(&Memory::with(&wrong)), 1) != Ok(plain.clone())
    };
    let n_noticed = others.filter(|(_, other)| is_noticed(other)).count();
    assert!(n_noticed > 0, "no result of {phase} counts");
}

fn scene() -> sightlines_cells::Scene {
    tower(TowerOptions { floors: 2, rooms_x: 4, rooms_y: 3, furniture: 1, ..TowerOptions::default() }).unwrap()
}

#[test]
fn sightlines_of_a_scene() {
    let (scene, options) = (scene(), BakeOptions::default());
    let phases = check((&scene).into(), &options);
    assert_eq!(phases.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["pairs", "objects"]);
    assert!(phases.iter().all(|(_, n)| *n > 20), "{phases:?}");
    check_impostor((&scene).into(), &options, "pairs");
    check_impostor((&scene).into(), &options, "objects");
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
        assert_eq!(check((&scene).into(), &options), [("cells", 36)]);
        check_impostor((&scene).into(), &options, "cells");
    }
}

#[test]
fn both_methods_one_after_the_other() {
    let buffers = BufferOptions { planes: 1, texels: 16, ..BufferOptions::default() };
    let method = SceneMethod::Both;
    let scene = building(false);
    let options = BakeOptions { method, cells: CellsFrom::Grid([3, 2, 1]), buffers, ..BakeOptions::default() };
    let phases = check((&scene).into(), &options);
    assert_eq!(phases, [("cells", 6), ("boxes", 6)]);
    check_impostor((&scene).into(), &options, "boxes");
    let scene =
        tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() }).unwrap();
    let options = BakeOptions { cells: CellsFrom::KdTree, ..options };
    let phases: Vec<_> = check((&scene).into(), &options).into_iter().map(|(name, _)| name).collect();
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
    let phases = check((&prt).into(), &BakeOptions::default());
    assert_eq!((phases.len(), phases[0], phases[1].0), (8, ("first", 1), "beams"));
    check_impostor((&prt).into(), &BakeOptions::default(), "beams");
    let fast = BakeOptions { fast: true, ..BakeOptions::default() };
    let whole = Memory::default();
    assert_eq!(bytes((&prt).into(), &fast, Some(&whole), 1), bytes((&prt).into(), &fast, None, 1));
    assert_eq!(whole.into_results().keys().map(|key| key.0).collect::<BTreeSet<_>>(), BTreeSet::from(["first"]));
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

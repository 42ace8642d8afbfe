//! Places: they tile what is not solid, and what viewers in them see is in the table.

use proptest::prelude::*;
use sightlines_bake::places::{PlaceOptions, Places, PlacesError, observed_places, places};
use sightlines_bake::{BakeError, BakeRequest, CellsFrom, Report, Runtime, SceneMethod, TableGraph, bake};
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_kdtree::{Matter, SceneOptions};
use sightlines_multifocal::{RaySampler, Split};
use sightlines_progress::{Cancelled, Progress};
use sightlines_pvs::BitMatrix;
use sightlines_scenes::{CityOptions, TowerOptions, city, tower};
use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

const QUADS: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

/// A box with its fronts outwards, turned about z by a rotation with rational cosine or not.
pub(crate) fn block(b: &Aabb<3>, turned: bool) -> SceneObject {
    let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] }) };
    let turn = |p: Point3| if turned { [0.8 * p[0] - 0.6 * p[1], 0.6 * p[0] + 0.8 * p[1], p[2]] } else { p };
    let triangles = QUADS.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: String::new(), vertices: (0..8).map(|i| turn(corner(i))).collect(), triangles }
}

pub(crate) fn scene(objects: Vec<SceneObject>) -> Scene {
    Scene::new(objects).expect("a scene")
}

fn boxed(min: Point3, max: Point3) -> Aabb<3> {
    Aabb { min, max }
}

/// Blocks at places of a small grid, upright or turned, which may touch and overlap.
fn blocks() -> impl Strategy<Value = (Vec<(Aabb<3>, bool)>, u32)> {
    let one = ([0i32..9, 0i32..9, 0i32..5], [1i32..5, 1i32..5, 1i32..4], any::<bool>());
    let one = one.prop_map(|(min, size, turned)| {
        let max = std::array::from_fn(|k| f64::from(min[k] + size[k]));
        (boxed(min.map(f64::from), max), turned)
    });
    (prop::collection::vec(one, 1..8), 1u32..20)
}

/// A city of so many blocks, each house of which is a box of twelve triangles.
pub(crate) fn city_of_boxes([blocks_x, blocks_z]: [u32; 2]) -> Scene {
    let city = city(CityOptions { blocks_x, blocks_z, ..CityOptions::default() }).expect("a city");
    let as_box = |house: &SceneObject| SceneObject {
        name: house.name.clone(),
        ..block(&Aabb::around(house.vertices.iter().copied()), false)
    };
    scene(city.objects().iter().map(as_box).collect())
}

fn cut(scene: &Scene, n_cells: u32) -> Places {
    let how = PlaceOptions { n_cells: Some(n_cells), cell_size: None };
    places(scene, &SceneOptions::default(), &how).expect("places")
}

fn volume(b: &Aabb<3>) -> f64 {
    (0..3).map(|k| b.max[k] - b.min[k]).product()
}

/// The cells that overlap, and those longer than the bound.
fn faults(places: &Places) -> usize {
    let overlap = |a: &Aabb<3>, b: &Aabb<3>| (0..3).all(|k| a.min[k] < b.max[k] && b.min[k] < a.max[k]);
    let cells = &places.cells;
    let pairs = (0..cells.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    let size = |b: &Aabb<3>| (0..3).map(|k| b.max[k] - b.min[k]).fold(0.0, f64::max);
    pairs.filter(|&(i, j)| overlap(&cells[i], &cells[j])).count()
        + cells.iter().filter(|b| size(b) > places.summary.cell_size || volume(b) <= 0.0).count()
}

/// Points of the scene's box that are in no cell and not strictly inside of one of `solids`, of so many.
fn lost(scene: &Scene, cells: &[Aabb<3>], solids: &[(Aabb<3>, bool)], n: u32) -> usize {
    let mut random = Random::new(u64::from(n));
    let bounds = scene.bounds();
    let inside = |p: Point3| {
        solids.iter().any(|(b, turned)| {
            let q = if *turned { [0.8 * p[0] + 0.6 * p[1], 0.8 * p[1] - 0.6 * p[0], p[2]] } else { p };
            (0..3).all(|k| b.min[k] - 1e-9 < q[k] && q[k] < b.max[k] + 1e-9)
        })
    };
    let points = (0..n).map(|_| random.point(&bounds));
    points.filter(|p| !cells.iter().any(|b| b.contains(*p)) && !inside(*p)).count()
}

proptest! {
    /// Cells do not overlap, none is too long, and every place outside of the blocks is in one.
    #[test]
    fn places_tile_what_is_not_solid((solids, n_cells) in blocks()) {
        let scene = scene(solids.iter().map(|(b, turned)| block(b, *turned)).collect());
        let places = cut(&scene, n_cells);
        prop_assert_eq!(faults(&places), 0, "places_tile_what_is_not_solid: {:?}", places);
        prop_assert_eq!(lost(&scene, &places.cells, &solids, 200), 0, "places_tile_what_is_not_solid: {:?}", places);
        // The impostor: without one of its cells a scene has places in none, unless that cell is hardly any of it.
        let largest = places.cells.iter().map(volume).fold(0.0, f64::max);
        let rest: Vec<Aabb<3>> = places.cells.iter().filter(|b| volume(b) < largest).copied().collect();
        prop_assert!(lost(&scene, &rest, &[], 2000) > 0, "places_tile_what_is_not_solid: {:?}", places);
        // What is left out is solid, in parts each of which one query proves.
        let left_out = volume(&scene.bounds()) - places.cells.iter().map(volume).sum::<f64>();
        prop_assert!(places.summary.n_solid > 0 || left_out < 1e-9 * volume(&scene.bounds()));
    }
}

/// A rock that fills half of the scene, and three trees beside it.
fn rock(missing: Option<usize>) -> Scene {
    let mut rock = block(&boxed([0.0; 3], [8.0, 8.0, 4.0]), false);
    rock.triangles = (0..12).filter(|i| Some(*i) != missing).map(|i| rock.triangles[i]).collect();
    let tree = |x: f64| block(&boxed([x, 7.0, 4.0], [x + 0.5, 7.5, 8.0]), false);
    scene(vec![rock, tree(1.0), tree(3.0), tree(5.0)])
}

#[test]
fn the_insides_of_solids_are_left_out() {
    for n_cells in [1, 8, 100] {
        let places = cut(&rock(None), n_cells);
        let held: f64 = places.cells.iter().map(volume).sum();
        // Nothing of the rock stays, and nothing else goes but, at most, the trees.
        assert!(places.cells.iter().all(|b| b.min[2] >= 4.0), "{places:?}");
        assert!((253.0..=256.0 + 1e-9).contains(&held), "{held}");
        assert!(places.summary.n_solid > 0 && faults(&places) == 0);
    }
    let kept = SceneOptions { keep_solid: true, ..SceneOptions::default() };
    let kept = places(&rock(None), &kept, &PlaceOptions::default()).expect("places");
    let held: f64 = kept.cells.iter().map(volume).sum();
    assert!((held - 512.0).abs() < 1e-9 && kept.summary.n_solid == 0, "{held}");
}

/// Where all is solid, all is a place, whether it is cut or not.
#[test]
fn a_region_in_solid_matter_has_cells() {
    let cube = scene(vec![block(&boxed([0.0; 3], [8.0; 3]), false)]);
    for n_cells in [1, 64] {
        let held: f64 = cut(&cube, n_cells).cells.iter().map(volume).sum();
        assert!((held - 512.0).abs() < 1e-9, "{n_cells}: {held}");
    }
}

/// A rock without one triangle is no certain solid.
#[test]
fn the_insides_of_what_is_open_are_places() {
    for missing in 0..12 {
        let open = rock(Some(missing));
        let places = cut(&open, 20);
        let in_rock: f64 =
            places.cells.iter().map(|b| volume(&boxed(b.min, [b.max[0], b.max[1], b.max[2].min(4.0)])).max(0.0)).sum();
        assert_eq!(in_rock, 256.0, "without triangle {missing}");
        assert!(!Matter::of(&open).holds(&boxed([1.0; 3], [2.0; 3])));
    }
}

/// Hilly ground halfway up a box, with posts on it.
fn ground(upwards: bool) -> Scene {
    let at = |x: i32, y: i32| [f64::from(x), f64::from(y), 3.5 + 0.5 * f64::from((x * 5 + y * 3) % 3 - 1)];
    let mut land = SceneObject { name: String::new(), vertices: Vec::new(), triangles: Vec::new() };
    for (x, y) in (0..8).flat_map(|x| (0..8).map(move |y| (x, y))) {
        let first = land.vertices.len() as u32;
        land.vertices.extend([at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)]);
        land.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    if !upwards {
        land.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    }
    let post = |x: f64, z: [f64; 2]| block(&boxed([x, 1.0, z[0]], [x + 0.5, 1.5, z[1]]), false);
    scene(vec![
        land,
        post(1.0, [3.5, 8.0]),
        post(6.0, [3.5, 6.0]),
        block(&boxed([7.5, 7.5, 0.0], [8.0, 8.0, 8.0]), false),
    ])
}

/// Nobody is below ground that has a front alone.
#[test]
fn what_is_behind_backs_is_left_out() {
    let below = |places: &Places| -> f64 {
        places.cells.iter().map(|b| volume(&boxed(b.min, [b.max[0], b.max[1], b.max[2].min(2.9)])).max(0.0)).sum()
    };
    let single = ground(true).with_single_sided(vec![0]).expect("an object");
    let places = cut(&single, 40);
    assert_eq!((places.cells.len(), faults(&places)), (40, 0));
    assert!(below(&places) < 40.0 && places.summary.n_behind > 0, "{places:?}");
    // Above ground nothing is lost.
    let mut random = Random::new(5);
    let above = boxed([0.0, 0.0, 4.25], [8.0; 3]);
    let is_in = |p: Point3| places.cells.iter().any(|b| b.contains(p));
    assert!((0..2000).all(|_| is_in(random.point(&above))));
    // Two sides, mostly backs, or the wish to keep it: all is a place, but for what is in the posts.
    let inside_out = ground(false).with_single_sided(vec![0]).expect("an object");
    let kept = SceneOptions { keep_solid: true, ..SceneOptions::default() };
    let how = PlaceOptions { n_cells: Some(40), cell_size: None };
    for (name, other) in [
        ("two sides", cut(&ground(true), 40)),
        ("kept", sightlines_bake::places::places(&single, &kept, &how).expect("places")),
    ] {
        assert!(below(&other) > 180.0 && other.summary.n_behind == 0, "{name}: {:?}", other.summary);
    }
    let seen_from_below = cut(&inside_out, 40);
    assert!(below(&seen_from_below) > 150.0, "{:?}", seen_from_below.summary);
}

/// Rooms in a row behind turned walls with doors, and a thing in each.
fn rooms() -> Scene {
    let mut objects = Vec::new();
    for i in 0..5 {
        let x = 6.0 * f64::from(i);
        let side = if i % 2 == 0 { [-12.0, 2.0] } else { [-2.0, 12.0] };
        objects.push(block(&boxed([x, side[0], 0.0], [x + 0.5, side[1], 3.0]), true));
        objects.push(block(&boxed([x + 3.0, -0.5, 0.0], [x + 3.5, 0.5, 1.0]), true));
    }
    scene(objects)
}

/// Objects that rays from anywhere in a cell hit first though the table has them hidden there; and how many rays hit.
fn hidden_wrongly(scene: &Scene, cells: &[Aabb<3>], seen: &BitMatrix) -> (usize, usize) {
    let objects: Vec<Vec<[Point3; 3]>> = scene.objects().iter().map(|o| o.corners().collect()).collect();
    let rays = RaySampler::new(objects.iter().map(|o| &o[..]));
    let mut random = Random::new(1);
    let (mut wrong, mut n_hits) = (0, 0);
    for (cell, b) in cells.iter().enumerate() {
        for _ in 0..400 {
            if let Some(object) = rays.first_hit(random.point(b), random.direction()) {
                n_hits += 1;
                wrong += usize::from(!seen.get(cell, object as usize));
            }
        }
    }
    (wrong, n_hits)
}

#[test]
fn scenes_without_walls_along_axes_have_sound_tables_of_places() {
    let scene = rooms();
    let split = Some(Split { n_rays: 1024, ..Split::default() });
    let with = |threads| {
        let runtime = Runtime { threads, ..Runtime::default() };
        runtime.bake(&scene, &BakeRequest { split, ..BakeRequest::default() }).expect("a table")
    };
    let baked = with(1);
    let (TableGraph::Boxes(cells), Report::Regions(report)) = (&baked.graph, &baked.report) else {
        panic!("places are boxes")
    };
    let summary = report.places.expect("places were cut");
    assert_eq!((summary.n_cells, summary.n_cells), (cells.len(), baked.table.n_cells()));
    assert!(cells.len() > 100 && summary.n_by_views + summary.n_along_walls > 20, "{summary:?}");
    let seen = baked.table.parts().objects_seen.clone().expect("objects are seen");
    let (wrong, n_hits) = hidden_wrongly(&scene, cells, &seen);
    assert!(wrong == 0 && n_hits > 5_000, "{wrong} of {n_hits}");
    // Tight: of all pairs some are hidden, and more than if one cell sees everything.
    let share = seen.count_ones() as f64 / (cells.len() * scene.objects().len()) as f64;
    assert!(share < 0.9, "{share}");
    // The impostor: whatever is seen from a cell in the middle is forgotten.
    let mut forgotten = seen;
    (0..scene.objects().len()).for_each(|o| forgotten.set(cells.len() / 2, o, false));
    assert!(hidden_wrongly(&scene, cells, &forgotten).0 > 0);
    let again = with(3);
    assert_eq!(again.table.to_bytes(), baked.table.to_bytes(), "threads change nothing");
}

/// Walls along axes are cut by a k-d tree unless places are named.
#[test]
fn axial_buildings_keep_their_cells() {
    let tower =
        tower(TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() }).unwrap();
    let by = |method| bake(&tower, &BakeRequest { method, ..BakeRequest::default() }).unwrap().table.to_bytes();
    let ways = [None, Some(SceneMethod::Auto), Some(SceneMethod::Sightlines)].map(by);
    assert!(ways[0] == ways[1] && ways[1] == ways[2]);
    let cells = Some(CellsFrom::Places(PlaceOptions { n_cells: Some(12), cell_size: None }));
    let named = bake(&tower, &BakeRequest { cells, ..BakeRequest::default() }).unwrap();
    let Report::Regions(report) = &named.report else { panic!("places are boxes") };
    let summary = report.places.expect("places were cut");
    assert!(summary.n_along_walls > summary.n_by_views, "{summary:?}");
}

#[test]
fn sizes_and_numbers_are_kept() {
    let city = city_of_boxes([3, 3]);
    let how = |n_cells, cell_size| PlaceOptions { n_cells, cell_size };
    let cut = |how: PlaceOptions| places(&city, &SceneOptions::default(), &how);
    for n_cells in [1, 7, 64, 150] {
        let places = cut(how(Some(n_cells), None)).expect("places");
        assert_eq!((places.cells.len(), faults(&places)), (n_cells as usize, 0), "{n_cells}: {:?}", places.summary);
        assert_eq!(places, cut(how(Some(n_cells), None)).expect("places"), "the same again");
    }
    let longest = (0..3).map(|k| city.bounds().max[k] - city.bounds().min[k]).fold(0.0, f64::max);
    let small = cut(how(Some(1), Some(longest / 10.0))).expect("places");
    assert!(small.cells.len() > 100 && faults(&small) == 0, "{:?}", small.summary);
    assert_eq!(
        cut(how(None, Some(0.0))).unwrap_err().to_string(),
        "cells of at most 0 units: this is not a number above 0"
    );
    assert_eq!(cut(how(Some(0), None)).unwrap_err().to_string(), "0 cells were asked for; there has to be one");
    let few = SceneOptions { max_cells: 50, ..SceneOptions::default() };
    let refused = |how: PlaceOptions| places(&city, &few, &how).unwrap_err().to_string();
    assert!(
        refused(how(None, Some(longest / 10.0))).contains(" units was stopped at more than 50, which is the limit")
    );
    // Before any work: there is no time for so many. But it is no more than likely that there are too many.
    let far = refused(how(None, Some(longest / 1e6)));
    assert!(
        far.ends_with(
            " units, fewer where it is solid; the limit is 50. Nothing was cut: raise the limit, or take larger cells"
        ),
        "{far}"
    );
    assert!(refused(how(Some(u32::MAX), None)).starts_with("4294967295 cells were asked for, and 50 are the limit"));
    assert_eq!(places(&city, &few, &how(None, None)).expect("places").cells.len(), 50);
    let empty = places(&scene(Vec::new()), &SceneOptions::default(), &PlaceOptions::default()).unwrap_err();
    assert_eq!(empty.to_string(), "the scene is empty");
    let flat = SceneObject { triangles: vec![[0, 2, 3]], ..block(&boxed([0.0; 3], [1.0, 1.0, 0.0]), false) };
    let error = places(&scene(vec![flat]), &SceneOptions::default(), &PlaceOptions::default()).unwrap_err();
    assert_eq!(error.to_string(), "the scene has no extent along axis 2");
    let region = boxed([0.0; 3], [5.0, 6.0, 7.0]);
    let within = SceneOptions { view_region: Some(region), keep_solid: true, ..SceneOptions::default() };
    let places = places(&city, &within, &PlaceOptions::default()).expect("places");
    assert_eq!(Aabb::around(places.cells.iter().flat_map(|b| [b.min, b.max])), region);
}

/// Long cuts tell how far they are, and can be cancelled; who looks on changes nothing.
#[test]
fn cutting_is_observed() {
    let city = city_of_boxes([3, 3]);
    let how = PlaceOptions { n_cells: Some(40), cell_size: None };
    let seen = Mutex::new(Vec::new());
    let stop_at = AtomicU64::new(u64::MAX);
    let observer = |progress: Progress| {
        seen.lock().expect("no panic").push(progress);
        let is_over = progress.phase == "cuts" && progress.done >= stop_at.load(Relaxed);
        if is_over { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let cut = || observed_places(&city, &SceneOptions::default(), &how, Some(&observer));
    assert_eq!(cut(), places(&city, &SceneOptions::default(), &how), "nobody changes what they see");
    let reports = std::mem::take(&mut *seen.lock().expect("no panic"));
    assert_eq!(reports[0].phase, "solid matter");
    let shares: Vec<f64> = reports.iter().filter(|p| p.phase == "cuts").map(|p| p.share).collect();
    assert!(shares.len() >= 40 && shares[0] < 0.1 && shares.last() == Some(&1.0), "{shares:?}");
    assert!(reports.iter().all(|p| p.done <= p.total && (0.0..=1.0).contains(&p.share)));
    stop_at.store(7, Relaxed);
    assert_eq!(cut(), Err(PlacesError::Cancelled(Cancelled)));
    assert!(seen.lock().expect("no panic").iter().all(|p| p.done <= 7), "not a cut more");
    // The bake ends as it does when any other stage is cancelled.
    let request = BakeRequest { cells: Some(CellsFrom::Places(how)), ..BakeRequest::default() };
    let observed = Runtime { progress: Some(&observer), ..Runtime::default() };
    assert_eq!(observed.bake(&city, &request).map(|_| ()), Err(BakeError::Cancelled(Cancelled)));
}

/// What is reported of cutting: the reports of its phase, and the places.
fn reports_of(scene: &Scene, how: &PlaceOptions, keep_solid: bool) -> (Vec<Progress>, Places) {
    let seen = Mutex::new(Vec::new());
    let observer = |progress: Progress| {
        seen.lock().expect("no panic").push(progress);
        ControlFlow::Continue(())
    };
    let options = SceneOptions { keep_solid, ..SceneOptions::default() };
    let places = observed_places(scene, &options, how, Some(&observer)).expect("places");
    let reports = seen.into_inner().expect("no panic");
    (reports.into_iter().filter(|p| p.phase == "cuts").collect(), places)
}

/// Cuts are never taken back, though boxes are; and all are made when that is reported, not before.
#[test]
fn the_progress_of_cuts_never_falls_and_ends_when_they_do() {
    let wall = |x: f64| block(&boxed([x, 0.0, 0.0], [x + 4.0, 4.0, 8.0]), false);
    let post = |z: f64| block(&boxed([3.0, 6.0, z], [4.0, 7.0, z + 1.0]), false);
    // Two blocks that fill the lower half together: both halves of it are solid, and cells become fewer.
    let shared =
        scene(vec![wall(0.0), wall(4.0), post(0.0), post(7.0), block(&boxed([0.0, 7.5, 0.0], [8.0; 3]), false)]);
    // All is solid, which is found late: then nothing is, and all is cut once more.
    let filled = scene(vec![wall(0.0), wall(4.0)]);
    let city = city_of_boxes([3, 3]);
    let size = |size: f64| PlaceOptions { n_cells: Some(1), cell_size: Some(size) };
    let n = |n: u32| PlaceOptions { n_cells: Some(n), cell_size: None };
    let longest = (0..3).map(|k| city.bounds().max[k] - city.bounds().min[k]).fold(0.0, f64::max);
    let (mut n_reports, mut n_grown) = (0, 0);
    for (scene, how, keep_solid) in [
        (&shared, size(1.5), false),
        (&shared, n(30), false),
        (&filled, size(2.0), false),
        (&city, size(longest / 8.0), false),
        (&city, size(longest / 8.0), true),
        (&city, n(60), false),
        (&city, PlaceOptions::default(), true),
    ] {
        let (reports, places) = reports_of(scene, &how, keep_solid);
        let (first, last) = (reports[0], reports[reports.len() - 1]);
        let cuts = places.summary.n_along_walls + places.summary.n_by_views + places.summary.n_by_size;
        assert!(first.done == 0 && first.total > 0 && first.share == 0.0, "{first:?}");
        // Of what was cut twice, the summary has the second time.
        assert!(last.done >= cuts as u64 && last.done == last.total && last.share == 1.0, "{last:?}");
        assert!(reports.iter().all(|p| p.done <= p.total && (p.share < 1.0 || p.done == last.done)), "{how:?}");
        for pair in reports.windows(2) {
            assert!(pair[0].done <= pair[1].done && pair[0].share <= pair[1].share, "{pair:?}");
            n_grown += usize::from(pair[0].total < pair[1].total);
        }
        // Where nothing is solid, and only the number counts, the first total is right.
        if keep_solid && how.cell_size.is_none() {
            assert!(reports.iter().all(|p| p.total == last.total), "{how:?}");
        }
        n_reports += reports.len();
    }
    assert!(n_reports > 500 && n_grown > 5, "{n_reports}, {n_grown}");
}

/// A choice by measurements that take long tells which is being made.
#[test]
fn choices_are_observed() {
    let seen = Mutex::new(Vec::new());
    let observer = |progress: Progress| {
        seen.lock().expect("no panic").push(progress.phase);
        ControlFlow::Break(())
    };
    // Screens that stand alone in the open: all is measured.
    let screen = |x: f64| SceneObject {
        name: String::new(),
        vertices: vec![[x, 0.0, 0.0], [x + 1.0, 2.0, 0.0], [x, 0.0, 3.0], [x + 1.0, 2.0, 3.0]],
        triangles: vec![[0, 1, 2], [1, 3, 2]],
    };
    let screens = scene((0..4).map(|i| screen(f64::from(i))).collect());
    let choice = |runtime: &Runtime<'_>| {
        BakeRequest::default().prepare(&screens, runtime).expect("a choice").decisions().choice.clone()
    };
    let observed = choice(&Runtime { progress: Some(&observer), ..Runtime::default() });
    assert!(observed.is_some() && observed == choice(&Runtime::default()), "it cannot be cancelled");
    assert_eq!(*seen.lock().expect("no panic"), ["loose surfaces", "openness"]);
}

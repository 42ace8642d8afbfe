//! The eye-to-cell methods of pages against those of `eye-to-cell`, in a browser.

use serde_json::{Value, json};
use sightlines::bake::{BakeRequest, Bakeable, bake};
use sightlines::cells::Plan;
use sightlines::eye_to_cell::{Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph};
use sightlines::formats::Source;
use sightlines::pvs::{CellId, Place, Table};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines::viewer::Page;
use sightlines_testkit::browser::{Opened, chromium};
use sightlines_testkit::mutate::SplitMix;
use sightlines_tests::data_folder;
use std::collections::BTreeSet;
use std::path::Path;

const FOV: f64 = 1.2;
const ASPECT: f64 = 1.5;

const LOOK: &str = r"
ready.then((app) => {
  const plain = ({ cells, objects, answered }) => ({ cells: [...cells], objects: [...objects], answered });
  tell(given.map(({ eye, dir, fov, aspect }) => app.methodsAt(eye, dir, fov, aspect).map(plain)));
});";

/// Eyes in cells, with a direction for each.
fn poses(table: &Table, n: usize) -> Vec<([f64; 3], [f64; 3])> {
    let mut random = SplitMix::new(5);
    let mut share = || (random.next() >> 11) as f64 / (1u64 << 53) as f64;
    let mut list = Vec::new();
    while list.len() < n {
        let cell = &table.cells()[(share() * table.n_cells() as f64) as usize];
        let p: [f64; 3] = std::array::from_fn(|k| cell.min[k] + (0.01 + 0.98 * share()) * (cell.max[k] - cell.min[k]));
        let angle = share() * std::f64::consts::TAU;
        let up = if table.dimension() == 2 { [0.0, 0.0] } else { [0.6 * share() - 0.3, 1.0] };
        let eye = table.frame().map_or(p, |frame| frame.to_scene(p));
        let level = [angle.cos(), angle.sin()];
        // Scenes in space of these tests have y or z upwards; both directions are good for either.
        let dir = if table.dimension() == 2 { [level[0], level[1], 0.0] } else { [level[0], up[0], level[1]] };
        if matches!(table.place_at(eye), Place::Inside(_)) {
            list.push((eye, dir));
        }
    }
    list
}

/// Cells and objects by each method, as the crate finds them.
fn expected(table: &Table, eye: [f64; 3], dir: [f64; 3], up: [f64; 3]) -> Vec<[BTreeSet<u32>; 2]> {
    let view = match table.dimension() {
        2 => View::planar([eye[0], eye[1]], [dir[0], dir[1]], FOV),
        _ => View::perspective_horizontal(eye, dir, up, FOV, ASPECT),
    };
    let (view, doors) = (view.expect("a view"), Doors::all_open());
    let Place::Inside(here) = table.place_at(eye) else { panic!("the eye is in a cell") };
    let cells = TableCells::new(table.clone());
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    let subgraph = |cell: &CellId| VisibleSubgraph::prepare(&cells, *cell).expect("a table in memory");
    let subgraphs: Vec<_> = here.cells().iter().map(subgraph).collect();
    let mut by = |method: Method| {
        seen.clear(table.n_cells(), table.objects().len());
        for subgraph in &subgraphs {
            method.look(subgraph, &view, &doors, &mut scratch, &mut seen);
        }
        [seen.cells().iter().map(|id| id.0).collect(), seen.objects().iter().map(|id| id.0).collect()]
    };
    Method::ALL.map(&mut by).to_vec()
}

fn numbers(list: &Value) -> BTreeSet<u32> {
    list.as_array().expect("a list").iter().map(|x| x.as_u64().expect("a number") as u32).collect()
}

/// Compares `n` views; without stab trees, along which the crate goes and pages do not.
fn compare(browser: &Path, name: &str, table: &Table, n: usize) {
    let mut parts = table.clone().into_parts();
    parts.stab = None;
    let table = Table::new(parts).expect("a table");
    let up =
        table.up().map_or([0.0, 1.0, 0.0], |axis| std::array::from_fn(|k| f64::from(u8::from(k == axis as usize))));
    let html = Page::new("Methods", "t.pvs", &table).html().expect("a page").html;
    let poses = poses(&table, n);
    let given = json!(
        poses
            .iter()
            .map(|(eye, dir)| json!({ "eye": eye, "dir": dir, "fov": FOV, "aspect": ASPECT }))
            .collect::<Vec<_>>()
    );
    let told = Opened { html: &html, script: LOOK, given: &given, size: [900, 700], link: "" }.result(browser);
    // Cells more and fewer than the crate's, views in which any method gave up, objects fewer, and all cells of the crate.
    let (mut more, mut fewer, mut fewer_objects, mut gave_up, mut all) = ([0; 5], [0; 5], [0; 5], 0, [0; 5]);
    for (&(eye, dir), answers) in poses.iter().zip(told.as_array().expect("a list")) {
        let mut before: Option<BTreeSet<u32>> = None;
        for (k, (answer, [cells, objects])) in
            answers.as_array().expect("five").iter().zip(expected(&table, eye, dir, up)).enumerate()
        {
            let found = numbers(&answer["cells"]);
            gave_up += usize::from(answer["answered"] != Method::ALL[k].name());
            more[k] += found.difference(&cells).count();
            fewer[k] += cells.difference(&found).count();
            fewer_objects[k] += objects.difference(&numbers(&answer["objects"])).count();
            all[k] += cells.len();
            assert!(before.is_none_or(|before| found.is_subset(&before)), "{name}: each is within the one before");
            before = Some(found);
        }
    }
    println!(
        "{name}: {all:?} cells, {more:?} more, {fewer:?} fewer, objects fewer {fewer_objects:?}; {gave_up} gave up"
    );
    assert!(gave_up * 50 <= n, "{name}");
    assert_eq!((fewer, fewer_objects), ([0; 5], [0; 5]), "{name}: nothing that may be seen is left out");
    // On the borders of views rounding decides, and the gap of a frame, within which the eye is not trusted; towards visible in both.
    assert!((0..4).all(|k| more[k] * 1000 <= all[k]) && more[4] * 100 <= all[4], "{name}: {more:?} of {all:?}");
    assert!(all[4] < all[0] * 2 / 3, "{name}: a view keeps less than the table");
    // The comparison can fail: by the answer for another direction.
    let (eye, dir) = poses[0];
    let back = dir.map(|x| -x);
    assert_ne!(expected(&table, eye, dir, up)[4], expected(&table, eye, back, up)[4], "{name}");
}

#[test]
fn methods_of_pages_are_those_of_the_crate() {
    let Some(browser) = chromium() else { return };
    let plan: Plan = office(OfficeOptions { seed: 3, ..OfficeOptions::default() }).expect("an office");
    compare(&browser, "plan", &bake(&plan, &BakeRequest::default()).expect("a table").table, 300);
    let scene = tower(TowerOptions { floors: 2, ..TowerOptions::default() }).expect("a tower");
    compare(&browser, "tower", &bake(&scene, &BakeRequest::default()).expect("a table").table, 200);
}

#[test]
fn methods_of_pages_of_real_scenes_are_those_of_the_crate() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    let Some(browser) = chromium() else { return };
    for name in ["doom/freedoom1_E1M1.wad", "scenes/whale_large/whale_large.glb"] {
        let read = Bakeable::read(&Source::File(&data.join(name)), None).expect("real input is read");
        compare(&browser, name, &bake(&read, &BakeRequest::default()).expect("a table").table, 150);
    }
}

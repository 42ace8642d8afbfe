//! Pages of tables in a real browser: the sets that the page's own code finds are those of the table, nothing is asked from outside,
//! and names of a scene stay names. Without Chromium these tests do not run, and say so.

use serde_json::{Value, json};
use sightlines::bake::{BakeRequest, Bakeable, bake};
use sightlines::cells::{Plan, Scene, SceneObject};
use sightlines::formats::Source;
use sightlines::formats::quake::{Bsp, BspFormat};
use sightlines::pvs::{CellId, ObjectId, Place, Table};
use sightlines::scenes::world::{QuakeLikeOptions, quake_like};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines::viewer::{Figure, Line, Page, Reasons};
use sightlines_testkit::browser::{Opened, chromium};
use sightlines_testkit::mutate::SplitMix;
use sightlines_tests::data_folder;
use sightlines_tests::world_files::{bsp_bytes, prt_of_world};
use std::path::Path;

/// Eyes that are looked from in each table.
const N_EYES: usize = 1000;

/// Compares the sets of all eyes, and gathers what went wrong on the page.
const CHECK: &str = include_str!("viewer_check.js");

/// What the check says of a page.
fn open(browser: &Path, html: &str, eyes: &Value, width: u32) -> Value {
    Opened { html, script: CHECK, given: eyes, size: [width, 700], link: "" }.result(browser)
}

/// Random eyes in and around the cells, some on borders, with what the table says.
fn eyes(table: &Table, n: usize) -> Value {
    let mut random = SplitMix::new(11);
    let mut share = || (random.next() >> 11) as f64 / (1u64 << 53) as f64;
    let mut list = Vec::new();
    for k in 0..n {
        let cell = &table.cells()[(share() * table.n_cells() as f64) as usize];
        let p: [f64; 3] = std::array::from_fn(|axis| {
            let (low, high) = (cell.min[axis], cell.max[axis]);
            match k % 8 {
                0 if axis == 0 => low,
                1 => low + (1.4 * share() - 0.2) * (high - low),
                _ => low + share() * (high - low),
            }
        });
        let eye = table.frame().map_or(p, |frame| frame.to_scene(p));
        let (mut at, mut cells, mut objects) = (Vec::new(), Vec::<CellId>::new(), Vec::<ObjectId>::new());
        if let Place::Inside(here) = table.place_at(eye) {
            at = here.cells().to_vec();
            cells = here.visible_cells().collect();
            objects = here.visible_objects();
        }
        let ids = |list: &[CellId]| list.iter().map(|id| id.0).collect::<Vec<_>>();
        let objects: Vec<u32> = objects.iter().map(|id| id.0).collect();
        list.push(json!({ "eye": eye, "at": ids(&at), "cells": ids(&cells), "objects": objects }));
    }
    json!(list)
}

fn inside(eyes: &Value) -> usize {
    eyes.as_array().expect("a list").iter().filter(|eye| !eye["at"].as_array().expect("a list").is_empty()).count()
}

/// Opens the page of a table and checks everything; with a pair removed, the sets differ.
fn check(browser: &Path, table: &Table, figure: Option<&Figure>) {
    let page = Page { figure, ..Page::new("A <b>title</b>", "t.pvs", table) }.html().expect("a page");
    let eyes = eyes(table, N_EYES);
    let n_inside = inside(&eyes);
    assert!(n_inside > N_EYES / 3, "{n_inside} of {N_EYES} eyes in cells");
    let result = open(browser, &page.html, &eyes, 1000);
    assert_eq!(result["wrong"], 0, "{result}");
    assert_eq!(result["problems"], json!([]), "{result}");
    assert_eq!(result["requests"], 0, "{result}");
    for what in ["walked", "locked", "helped", "tapped", "dragged", "pinched", "asked", "isSvg", "wide"] {
        assert_eq!(result[what], true, "{what}: {result}");
    }
    assert!(result["found"].as_u64() > Some(0) && result["worst"].as_u64() > Some(0), "{result}");
    assert_eq!(result["notice"], Value::Null, "{result}");

    // The impostor: a page of a table that hides one pair more.
    let mut parts = table.clone().into_parts();
    let pair = (0..table.n_cells()).find_map(|a| {
        let sees = table.visible(CellId(a as u32)).map(CellId::idx).find(|&b| b > a)?;
        let is_used = |cell: usize| eyes.as_array().expect("a list").iter().any(|eye| eye["at"] == json!([cell]));
        is_used(a).then_some((a, sees))
    });
    let (a, b) = pair.expect("some eye is in a cell that sees another");
    parts.rows.set(a, b, false);
    parts.rows.set(b, a, false);
    parts.stab = None;
    let less = Table::new(parts).expect("a table");
    let page = Page { figure, ..Page::new("less", "t.pvs", &less) }.html().expect("a page");
    let result = open(browser, &page.html, &eyes, 320);
    assert!(result["wrong"].as_u64() > Some(0), "{result}");
    assert_eq!(result["wide"], true, "at 320 pixels nothing sticks out: {result}");
}

/// A table that does not fit is refused with its size, and lines give way before that.
#[test]
fn tables_that_do_not_fit_are_refused() {
    let plan: Plan = office(OfficeOptions { seed: 3, ..OfficeOptions::default() }).expect("an office");
    let table = bake(&plan, &BakeRequest::default()).expect("a table").table;
    let line = Line { cells: vec![0, 1], portals: vec![0], ends: Some([[0.0; 3], [1.0; 3]]) };
    let reasons = Reasons { lines: vec![line; 10], hidden: vec![], n_pairs: 10, n_joined: 10 };
    let page = |max_bytes: usize| Page { max_bytes, reasons: Some(&reasons), ..Page::new("t", "t.pvs", &table) }.html();
    let whole = page(Page::MAX_BYTES).expect("it fits");
    assert_eq!(whole.n_lines, 10);
    let less = page(whole.html.len() - 1).expect("it fits without lines");
    assert!(less.n_lines == 0 && less.html.len() < whole.html.len());
    let error = page(less.html.len() - 100).expect_err("it does not fit");
    assert!(error.to_string().contains("bytes without any triangle, and may have"), "{error}");
}

#[test]
fn the_page_of_a_plan_finds_what_the_table_says() {
    let Some(browser) = chromium() else { return };
    let plan: Plan = office(OfficeOptions { seed: 3, ..OfficeOptions::default() }).expect("an office");
    let table = bake(&plan, &BakeRequest::default()).expect("a table").table;
    check(&browser, &table, Some(&Figure::of_plan(&plan)));
}

#[test]
fn the_page_of_a_building_finds_what_the_table_says() {
    let Some(browser) = chromium() else { return };
    let scene = tower(TowerOptions { floors: 2, ..TowerOptions::default() }).expect("a tower");
    let table = bake(&scene, &BakeRequest::default()).expect("a table").table;
    check(&browser, &table, Some(&Figure::of_scene(&scene)));
    check(&browser, &table, None);
}

#[test]
fn the_page_of_a_quake_map_finds_what_the_table_says() {
    let Some(browser) = chromium() else { return };
    let world = quake_like(QuakeLikeOptions { seed: 5, rooms_x: 3, rooms_y: 2, floors: 2 }).expect("few rooms");
    let bsp = Bsp::parse(bsp_bytes(&world, BspFormat::Bsp29)).expect("a map");
    let prt = prt_of_world(&world);
    let table = bake((&bsp, &prt), &BakeRequest::default()).expect("a table").table;
    check(&browser, &table, None);
}

/// A scene whose names and title are markup: none of it becomes any.
#[test]
fn hostile_names_run_nothing() {
    let Some(browser) = chromium() else { return };
    let hostile = "</script><script>injected = 1</script><img src=x onerror=\"injected = 2\">";
    let objects: Vec<SceneObject> = tower(TowerOptions { floors: 1, ..TowerOptions::default() })
        .expect("a tower")
        .objects()
        .iter()
        .enumerate()
        .map(|(k, object)| SceneObject { name: format!("{k} {hostile}"), ..object.clone() })
        .collect();
    let scene = Scene::new(objects).expect("a scene");
    let table = bake(&scene, &BakeRequest::default()).expect("a table").table;
    let page = Page::new(hostile, hostile, &table).html().expect("a page");
    assert!(!page.html.contains(hostile) && page.html.contains("default-src 'none'"));
    let result = open(&browser, &page.html, &eyes(&table, 50), 1000);
    assert_eq!([&result["injected"], &result["problems"]], [&json!("undefined"), &json!([])], "{result}");
    assert!(result["found"].as_u64() > Some(0), "names are listed: {result}");
}

#[test]
fn pages_of_real_scenes_find_what_the_tables_say() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    let Some(browser) = chromium() else { return };
    for name in
        ["plans/duplex_0.geojson", "doom/freedoom1_E1M1.wad", "scenes/whale_large/whale_large.glb", "quake/e1m7.bsp"]
    {
        let path = data.join(name);
        let read = Bakeable::read(&Source::File(&path), None).expect("real input is read");
        let table = bake(&read, &BakeRequest::default()).expect("a table").table;
        let figure = match &read {
            Bakeable::Plan { plan, .. } => Some(Figure::of_plan(plan)),
            Bakeable::Scene(file) => Some(Figure::of_scene(&file.scene)),
            Bakeable::Map(bsp, _) => {
                let faces = bsp.world_faces().expect("faces");
                Some(Figure::of_polygons((0..faces.n_faces()).map(|k| faces.polygons(k))))
            }
            Bakeable::Portals(_) => None,
        };
        check(&browser, &table, figure.as_ref());
    }
}

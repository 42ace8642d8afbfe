//! Isovists that pages draw under the pointer, against those of the crate. Without Chromium these tests do not run, and say so.

use serde_json::{Value, json};
use sightlines::bake::{BakeRequest, bake};
use sightlines::cells::Plan;
use sightlines::formats::geojson::read_plan;
use sightlines::geometry::{Point2, Random};
use sightlines::isovist::WallMesh;
use sightlines::pvs::{Place, Table};
use sightlines::scenes::{OfficeOptions, office};
use sightlines::viewer::{Figure, Page};
use sightlines_testkit::browser::{Opened, chromium};
use sightlines_tests::data_folder;

const SCRIPT: &str = include_str!("viewer_isovist.js");

/// Points inside of one cell each, from which no view leaves the plan, and the areas that they see.
fn eyes(plan: &Plan, table: &Table) -> Vec<([f64; 3], f64)> {
    let mesh = WallMesh::new(plan).expect("a mesh");
    let (bounds, mut random) = (plan.bounds(), Random::new(5));
    let mut eyes = Vec::new();
    for _ in 0..2000 {
        let mut at = |k: usize| bounds.min[k] + random.unit() * (bounds.max[k] - bounds.min[k]);
        let p = [at(0), at(1), 0.0];
        let isovist = mesh.isovist(Point2::new(p[0], p[1])).expect("inside the frame");
        let leaves = isovist.boundaries().contains(&sightlines::isovist::Boundary::Frame);
        if !leaves && matches!(table.place_at(p), Place::Inside(here) if here.cells().len() == 1) {
            eyes.push((p, isovist.measures().area));
        }
    }
    eyes
}

fn check(plan: &Plan) {
    let Some(browser) = chromium() else { return };
    let table = bake(plan, &BakeRequest::default()).expect("a table").table;
    let eyes = eyes(plan, &table);
    assert!(eyes.len() > 50, "{} eyes", eyes.len());
    let open = |table: &Table| -> Value {
        let page =
            Page { figure: Some(&Figure::of_plan(plan)), ..Page::new("t", "t.pvs", table) }.html().expect("a page");
        let given = json!(eyes.iter().map(|(p, _)| p).collect::<Vec<_>>());
        Opened { html: &page.html, script: SCRIPT, given: &given, size: [1000, 700], link: "" }.result(&browser)
    };
    let wrong = |result: &Value| {
        let areas = result["areas"].as_array().expect("a list");
        assert_eq!(areas.len(), eyes.len());
        let off = |(found, (_, area)): &(&Value, &([f64; 3], f64))| {
            (found.as_f64().unwrap_or(f64::NAN) - area).abs().partial_cmp(&(1e-6 * area))
                != Some(std::cmp::Ordering::Less)
        };
        areas.iter().zip(&eyes).filter(off).count()
    };
    let result = open(&table);
    assert_eq!(wrong(&result), 0);
    assert_eq!(result["isDrawn"], true, "{result}");
    assert!(result["text"].as_str().is_some_and(|text| text.starts_with("area ")), "{result}");
    // The impostor: a table that lacks half of its portals has smaller isovists.
    let mut parts = table.into_parts();
    parts.portals.truncate(parts.portals.len() / 2);
    parts.stab = None;
    let result = open(&Table::new(parts).expect("a table"));
    assert!(wrong(&result) > 0, "missing portals are not noticed");
}

#[test]
fn isovists_of_pages_have_the_areas_of_the_crate() {
    check(&office(OfficeOptions { seed: 3, ..OfficeOptions::default() }).expect("an office"));
}

#[test]
fn isovists_of_pages_of_real_plans_have_the_areas_of_the_crate() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    check(&read_plan(data.join("plans/mlstruct_fp_test_0.geojson")).expect("a plan"));
}

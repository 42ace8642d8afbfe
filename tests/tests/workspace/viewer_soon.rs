//! How soon cells may see a place, as pages colour them, against the reaches of the crate. Without Chromium these tests do not run, and say so.

use serde_json::{Value, json};
use sightlines::bake::{BakeRequest, bake};
use sightlines::pvs::{CellId, Table};
use sightlines::relevance::{ReachOptions, Reaches};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines::viewer::Page;
use sightlines_testkit::browser::{Opened, chromium};

/// Ways from some cells to all, what is shown of them, and colours.
const SCRIPT: &str = r#"
ready.then(({ model }) => {
const heat = document.getElementById("heat");
heat.value = "soon";
heat.dispatchEvent(new Event("change"));
const ways = given.map((cell) => {
  model.see([cell]);
  model.changed();
  return [...model.ways()].map((way) => (Number.isFinite(way) ? way : 1e300));
});
const slider = document.getElementById("reach");
slider.value = 0;
slider.dispatchEvent(new Event("input"));
const few = document.getElementById("scale").textContent;
slider.value = 1;
slider.dispatchEvent(new Event("input"));
const all = document.getElementById("scale").textContent;
tell({ ways, few, all, isShown: !document.getElementById("reach-row").hidden, reach: model.reach, size: model.size });
});
"#;

fn check(table: &Table, options: &ReachOptions) {
    let Some(browser) = chromium() else { return };
    let reaches = Reaches::of(table, options).expect("a table with places");
    let n = table.n_cells() as u32;
    let from: Vec<u32> = (0..n).step_by((n as usize / 12).max(1)).collect();
    let page = Page::new("t", "t.pvs", table).html().expect("a page");
    let open = |html: &str| -> Value {
        Opened { html, script: SCRIPT, given: &json!(from), size: [1000, 700], link: "" }.result(&browser)
    };
    let found = open(&page.html);
    // Of all pairs those that the page has at another rung than the crate; the page may be a step of rounding below.
    let wrong = |found: &Value, ladder: &[f64]| {
        let mut n_wrong = [0, 0];
        for (row, &a) in found["ways"].as_array().expect("rows").iter().zip(&from) {
            for (way, b) in row.as_array().expect("a row").iter().zip(0..n) {
                let way = way.as_f64().expect("a number");
                let rung = ladder.partition_point(|reach| *reach < way);
                let own = reaches.rung(CellId(a), CellId(b));
                // Cells that touch the one that a body is in are reached by no move at all.
                n_wrong[0] += usize::from(rung > own);
                n_wrong[1] += usize::from(rung < own && !(rung == 0 && own == 1));
            }
        }
        n_wrong
    };
    let ladder = reaches.ladder().to_vec();
    assert_eq!(wrong(&found, &ladder), [0, 0]);
    let halves: Vec<f64> = ladder.iter().map(|reach| reach / 2.0).collect();
    assert!(wrong(&found, &halves)[0] > 20, "a ladder of half the reaches goes unnoticed");
    assert_eq!(found["isShown"], true);
    let [few, all] = ["few", "all"].map(|key| found[key].as_str().expect("a text").to_owned());
    assert!(few.contains("not within it (") && few != all && all.contains("(0 cells"), "{few}; {all}");
}

#[test]
fn ways_to_sight_on_pages_are_reaches() {
    let plan = office(OfficeOptions { seed: 5, ..OfficeOptions::default() }).expect("an office");
    let options = ReachOptions { ladder: vec![0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0], ..ReachOptions::default() };
    check(&bake(&plan, &BakeRequest::default()).expect("a table").table, &options);
    let small = TowerOptions { floors: 2, rooms_x: 3, rooms_y: 2, furniture: 1, ..TowerOptions::default() };
    let scene = tower(small).expect("a tower");
    check(&bake(&scene, &BakeRequest::default()).expect("a table").table, &options);
}

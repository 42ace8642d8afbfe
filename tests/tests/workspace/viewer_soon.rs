//! How soon bodies in cells may see one at the eye, as pages colour it, against the crate. Without Chromium these tests do not run, and say so.

use serde_json::json;
use sightlines::bake::{BakeRequest, bake};
use sightlines::geometry::{Aabb, Random};
use sightlines::pvs::Table;
use sightlines::relevance::{Body, ReachOptions, Reaches, Relevance, RelevanceOptions};
use sightlines::scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines::viewer::Page;
use sightlines_testkit::browser::{Opened, chromium};

/// Ways from some eyes to all cells, and what is said of them.
const SCRIPT: &str = r#"
ready.then(({ model }) => {
  const heat = document.getElementById("heat");
  heat.value = "soon";
  heat.dispatchEvent(new Event("change"));
  const ways = given.map((eye) => {
    model.look(eye);
    return [...model.ways()].map((way) => (Number.isFinite(way) ? way : 1e300));
  });
  const slider = document.getElementById("reach");
  const textAt = (value) => {
    slider.value = value;
    slider.dispatchEvent(new Event("input"));
    return document.getElementById("scale").textContent;
  };
  tell({ ways, few: textAt(0), all: textAt(1), isShown: !document.getElementById("reach-row").hidden });
});
"#;

fn check(table: &Table) {
    let Some(browser) = chromium() else { return };
    let reaches = Reaches::of(table, &ReachOptions::default()).expect("a table with places");
    let mut relevance = Relevance::new(table.clone(), reaches, RelevanceOptions::of(table));
    let mut random = Random::new(7);
    let mut inside = || {
        let cell = &table.cells()[random.below(table.n_cells())];
        std::array::from_fn(|k| cell.min[k] + random.unit() * (cell.max[k] - cell.min[k]))
    };
    let eyes: Vec<[f64; 3]> = (0..12).map(|_| inside()).filter(|&p| table.place_at(p).inside().is_some()).collect();
    let page = Page::new("t", "t.pvs", table).html().expect("a page");
    let given = json!(eyes);
    let found =
        Opened { html: &page.html, script: SCRIPT, given: &given, size: [1000, 700], link: "" }.result(&browser);
    // Of all eyes and cells those that the page shows later than the crate, at all, and earlier: by more than rounding.
    let mut wrong = |scale: f64| {
        let (mut n, mut n_late, mut n_early) = (0, 0, 0);
        for (row, &eye) in found["ways"].as_array().expect("rows").iter().zip(&eyes) {
            for (way, cell) in row.as_array().expect("a row").iter().zip(table.cells()) {
                let way = way.as_f64().expect("a number") * scale;
                let middle = std::array::from_fn(|k| (cell.min[k] + cell.max[k]) / 2.0);
                let [at, there] = [eye, middle].map(|p| Aabb { min: p, max: p });
                let mut may = |reach: f64| {
                    let body = |b| Body { reach, ..Body::new(b, b) };
                    relevance.may_see_within(&body(at), &body(there))
                };
                let (below, above) = (way * (1.0 - 1e-9) - 1e-9, way * (1.0 + 1e-9) + 1e-9);
                n += 1;
                n_late += usize::from(below > 0.0 && may(below.min(1e6)));
                n_early += usize::from(above < 1e6 && !may(above));
            }
        }
        [n, n_late, n_early]
    };
    let [n, n_late, n_early] = wrong(1.0);
    assert!(n > 500 && [n_late, n_early] == [0, 0], "{n_late} late, {n_early} early of {n}");
    assert!(wrong(1.5)[1] > 20 && wrong(0.5)[2] > 20, "ways of another length go unnoticed");
    let [few, all] = ["few", "all"].map(|key| found[key].as_str().expect("a text").to_owned());
    assert!(few.contains("not within it (") && all.contains("(0 cells") && few != all, "{few}; {all}");
    assert_eq!(found["isShown"], true);
}

#[test]
fn ways_to_sight_on_pages_are_those_of_the_crate() {
    let plan = office(OfficeOptions { seed: 5, ..OfficeOptions::default() }).expect("an office");
    check(&bake(&plan, &BakeRequest::default()).expect("a table").table);
    let small = TowerOptions { floors: 2, rooms_x: 3, rooms_y: 2, furniture: 1, ..TowerOptions::default() };
    check(&bake(&tower(small).expect("a tower"), &BakeRequest::default()).expect("a table").table);
}

//! Tables that are put together wrongly, each in one way.

use crate::tables::common::{Case, cases, changed, check};
use sightlines_pvs::{Locator, TableParts};
use sightlines_verify::VerifyOptions;

fn case(name: &str) -> &'static Case {
    cases().find(|c| c.name == name).expect("a case of this name")
}

/// The kinds of violations of a table that was changed, without rays.
fn kinds(case: &Case, change: impl FnOnce(&mut TableParts)) -> Vec<&'static str> {
    let none = VerifyOptions { rays: 0, pairs: 0, segments: 0, ..VerifyOptions::default() };
    let wrong = changed(&case.table, change);
    check(&wrong, &case.real, &none).by_kind.into_keys().collect()
}

#[test]
fn defects_of_plans_are_found() {
    let case = case("office by triangulation");
    assert_eq!(kinds(case, |_| {}), [""; 0]);
    let of_portal = |parts: &TableParts| parts.portals[0].cells.map(|c| c.idx());
    let hidden = kinds(case, |parts| {
        let [a, b] = of_portal(parts);
        parts.rows.set(a, b, false);
        parts.rows.set(b, a, false);
    });
    assert_eq!(hidden, ["hidden-neighbour"]);
    let off = kinds(case, |parts| parts.portals[0].points.iter_mut().for_each(|p| p[0] += 0.125));
    assert_eq!(off, ["missing-portal", "off-border"]);
    let turned = kinds(case, |parts| parts.portals[0].points.reverse());
    assert_eq!(turned, ["off-border"]);
    assert_eq!(kinds(case, |parts| parts.objects[3].name.push('x')), ["object-name"]);
    assert!(kinds(case, |parts| parts.objects[3].max[0] += 0.5).contains(&"object-box"));
    let unlisted = kinds(case, |parts| {
        let list = parts.cell_objects.iter_mut().find(|list| !list.is_empty()).expect("an object");
        list.remove(0);
    });
    assert_eq!(unlisted, ["unlisted-object"]);
    let overlapping = kinds(case, |parts| {
        let cell = parts.cells[0].clone();
        parts.cells[1] = cell;
        parts.locator = Locator::build(&parts.cell_bounds(), 2);
    });
    assert!(overlapping.contains(&"overlap"), "{overlapping:?}");
    let outside = kinds(case, |parts| {
        let cell = &mut parts.cells[0];
        cell.max[0] += 1000.0;
        cell.polygon.iter_mut().for_each(|p| p[0] += 1000.0);
        cell.min[0] += 1000.0;
        parts.locator = Locator::build(&parts.cell_bounds(), 2);
    });
    assert!(outside.contains(&"out-of-scene"), "{outside:?}");
}

#[test]
fn defects_of_scenes_are_found() {
    let case = case("tower by sightlines");
    assert_eq!(kinds(case, |_| {}), [""; 0]);
    assert_eq!(kinds(case, |parts| parts.objects[0].name.push('x')), ["object-name"]);
    assert_eq!(kinds(case, |parts| parts.object_polygons[0] += 1), ["object-box"]);
    let off = kinds(case, |parts| parts.portals[0].points.iter_mut().for_each(|p| *p = p.map(|x| x + 0.125)));
    assert_eq!(off, ["missing-portal", "off-border"]);
    let overlapping = kinds(case, |parts| {
        parts.cells[1] = parts.cells[0].clone();
        parts.locator = Locator::build(&parts.cell_bounds(), 3);
    });
    assert!(overlapping.contains(&"overlap"), "{overlapping:?}");
    let fewer = kinds(case, |parts| {
        parts.objects.push(parts.objects[0].clone());
        parts.object_polygons.push(1);
        let n = parts.objects.len();
        let mut seen = sightlines_pvs::BitMatrix::new(parts.cells.len(), n);
        let old = parts.objects_seen.take().expect("objects are seen");
        (0..old.n_rows()).for_each(|row| old.iter_ones(row).for_each(|o| seen.set(row, o, true)));
        parts.objects_seen = Some(seen);
    });
    assert_eq!(fewer, ["count"]);
}

#[test]
fn defects_of_maps_are_found() {
    let case = case("portal file");
    assert_eq!(kinds(case, |_| {}), [""; 0]);
    assert_eq!(kinds(case, |parts| parts.portals[0].points[0][1] += 1.0), ["unlike-portal"]);
    let fewer = kinds(case, |parts| {
        parts.portals.pop();
    });
    assert_eq!(fewer, ["count"]);
}

//! Tables that are wrong all over.

use crate::tables::common::{Real, an_office, cases, changed, check, quick, small_tower};
use sightlines_bake::{PlanBakeOptions, bake_plan};
use sightlines_pvs::BitMatrix;
use sightlines_scenes::{OfficeOptions, office};
use sightlines_verify::{Truth, VerifyError, VerifyOptions, verify};

/// A table in which every cell sees itself alone has the maximum number of listed violations, and they are found
/// quickly.
#[test]
fn a_table_that_hides_everything_is_wrong_everywhere() {
    for case in cases() {
        let blind = changed(&case.table, |parts| {
            parts.rows = BitMatrix::identity(parts.cells.len());
        });
        let found = check(&blind, &case.real, &VerifyOptions { rays: 3_000, ..quick() });
        let kinds: Vec<_> = found.by_kind.keys().copied().collect();
        assert!(kinds.contains(&"hidden-cell"), "{}: {kinds:?}", case.name);
        assert_eq!(kinds.contains(&"hidden-neighbour"), !case.table.portals().is_empty(), "{}: {kinds:?}", case.name);
        assert!(found.by_kind["hidden-cell"] > 10, "{}: {:?}", case.name, found.by_kind);
    }
}

/// A row of objects that is empty but for what touches the cell.
#[test]
fn a_blind_row_of_objects_is_wrong() {
    for case in cases() {
        if case.table.parts().objects_seen.is_none() {
            continue;
        }
        let n = |cell: u32| case.table.visible_objects(sightlines_pvs::CellId(cell)).len();
        let cell = (0..case.table.n_cells() as u32).max_by_key(|&c| n(c)).expect("some cells") as usize;
        let blind = changed(&case.table, |parts| {
            let touching = parts.cell_objects[cell].clone();
            let seen = parts.objects_seen.as_mut().expect("asked before");
            (0..seen.n_cols()).for_each(|o| seen.set(cell, o, touching.contains(&sightlines_pvs::ObjectId(o as u32))));
        });
        let found = check(&blind, &case.real, &quick());
        assert!(found.by_kind.get("hidden-object").is_some_and(|&n| n > 3), "{}: {:?}", case.name, found.by_kind);
    }
}

#[test]
fn a_table_of_another_scene_is_noticed() {
    let table = bake_plan(&an_office(), &PlanBakeOptions::default()).expect("an office").table;
    let other = OfficeOptions { seed: 77, rooms_x: 4, rooms_y: 3, ..OfficeOptions::default() };
    let other = Real::Plan(office(other).expect("an office"));
    let found = check(&table, &other, &quick());
    assert!(!found.is_true() && found.by_kind.contains_key("count"), "{:?}", found.by_kind);
    assert_eq!(found.no_rays, Some("the table is not of this scene"));
    // Without objects, the rays tell.
    let bare = |seed: u64| {
        office(OfficeOptions { seed, rooms_x: 4, rooms_y: 3, ..OfficeOptions::default() }).expect("an office")
    };
    let table = bake_plan(&bare(1), &PlanBakeOptions::default()).expect("an office").table;
    let strip =
        |plan: &sightlines_cells::Plan| sightlines_cells::Plan::new(plan.lines().to_vec(), Vec::new()).expect("lines");
    let table = changed(&table, |parts| {
        parts.objects.clear();
        parts.object_polygons.clear();
        parts.cell_objects.iter_mut().for_each(Vec::clear);
    });
    let found = check(&table, &Real::Plan(strip(&bare(77))), &quick());
    assert!(!found.is_true(), "{:?}", found.by_kind);
    assert!(check(&table, &Real::Plan(strip(&bare(1))), &quick()).is_true());
}

#[test]
fn tables_of_other_kinds_are_refused() {
    let scene = small_tower();
    let plan = an_office();
    let table = bake_plan(&plan, &PlanBakeOptions::default()).expect("an office").table;
    let error = verify(&table, &Truth::Scene(&scene), &quick()).unwrap_err();
    assert_eq!(error, VerifyError::Dimension { table: 2, scene: 3 });
    assert_eq!(error.to_string(), "the table has 2 dimensions, the scene 3");
    for case in cases() {
        let of_map = matches!(case.real, Real::Portals(_) | Real::Map(..));
        if case.table.dimension() == 3 {
            assert_eq!(
                verify(&case.table, &Truth::Scene(&scene), &VerifyOptions { rays: 0, pairs: 0, ..quick() }).is_err(),
                of_map
            );
        }
    }
}

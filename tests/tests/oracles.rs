//! Tables of small plans against brute force, both ways: nothing visible is hidden, nothing hidden is
//! called visible. And tables of larger plans against random chords.

use proptest::prelude::*;
use sightlines::bake::{BakeOptions, Subdivide, bake_plan, see_groups};
use sightlines::cells::{CellId, Plan, PlanLine};
use sightlines::geometry::Point2;
use sightlines::pvs::Table;
use sightlines::scenes;
use sightlines::stabtree::SearchOptions;
use sightlines_testkit::{
    axial_plan, clear_chords, sampled_sector_visibility, sector_visibility_brute_force, sees_brute_force,
    small_grid_plan, small_sector_plan,
};

/// Pairs that one case compares; more cells than that are sampled by stepping through them.
const PAIRS: usize = 60;

fn polygon(table: &Table, cell: CellId) -> Vec<Point2> {
    table.cells()[cell.idx()].polygon.iter().map(|&[x, y]| Point2::new(x, y)).collect()
}

/// The first pair that the table and brute force disagree about.
fn disagreement(plan: &Plan, table: &Table) -> Option<(CellId, CellId)> {
    let n = table.n_cells();
    let pairs = (0..n).flat_map(|a| (0..a).map(move |b| (CellId(a as u32), CellId(b as u32))));
    let step = (n * n / 2).div_ceil(PAIRS).max(1);
    pairs
        .step_by(step)
        .find(|&(a, b)| table.sees(a, b) != sees_brute_force(plan, &polygon(table, a), &polygon(table, b)))
}

fn bake(plan: &Plan, subdivide: Subdivide) -> Option<Table> {
    let options = BakeOptions { subdivide, threads: 1, ..BakeOptions::default() };
    let baked = bake_plan(plan, &options).ok()?;
    // Where a crossing was rounded, cells are those of walls bent by a rounding error, and the exact
    // oracle sees through the slivers between; noding has its own tests.
    (baked.summary.n_rounded_crossings == 0).then_some(baked.table)
}

proptest! {
    /// Invariant: cells of a triangulation see each other if and only if brute force says so.
    #[test]
    fn tables_by_triangulation_are_exact(plan in small_grid_plan(1..8)) {
        if let Some(table) = bake(&plan, Subdivide::Triangulation) {
            prop_assert_eq!(disagreement(&plan, &table), None);
        }
    }

    /// Invariant: cells of a k-d tree see each other if and only if brute force says so.
    #[test]
    fn tables_by_kd_tree_are_exact(plan in axial_plan(1..9)) {
        if let Some(table) = bake(&plan, Subdivide::KdTree) {
            prop_assert_eq!(disagreement(&plan, &table), None);
        }
    }

    /// Invariant: sectors see each other if and only if brute force says so: the flat model exactly.
    #[test]
    fn sectors_are_exact(plan in small_sector_plan()) {
        let expected = sector_visibility_brute_force(&plan);
        let (seen, _) = see_groups(&plan, plan.n_groups(), &SearchOptions::default()).unwrap();
        for (a, row) in expected.iter().enumerate() {
            for (b, &visible) in row.iter().enumerate() {
                prop_assert_eq!(seen.get(a, b), visible || a == b, "sectors {} and {}", a, b);
            }
        }
    }
}

/// Any lines on a small grid, opaque or not, naming any groups on either side: unclosed sectors,
/// lines that cross, groups named towards the outside.
fn any_sector_plan() -> impl Strategy<Value = Plan> {
    let point = || (0i32..6, 0i32..6).prop_map(|(x, y)| Point2::new(f64::from(x), f64::from(y)));
    let group = || prop::option::of(0u32..5);
    let line = (point(), point(), any::<bool>(), group(), group());
    let line = line.prop_filter("of some length", |(a, b, ..)| a != b);
    let line = line.prop_map(|(a, b, opaque, left, right)| PlanLine { a, b, opaque, left, right });
    prop::collection::vec(line, 1..9).prop_map(|lines| Plan::new(lines, vec![]).expect("lines on a grid"))
}

proptest! {
    /// Invariant: whatever the lines say, nothing that brute force sees is hidden; and without rounded
    /// crossings nothing else is shown.
    #[test]
    fn sectors_of_any_lines_are_sound_and_exact_without_rounding(plan in any_sector_plan()) {
        let expected = sector_visibility_brute_force(&plan);
        let (seen, summary) = see_groups(&plan, plan.n_groups(), &SearchOptions::default()).unwrap();
        for (a, row) in expected.iter().enumerate() {
            for (b, &visible) in row.iter().enumerate().filter(|&(b, _)| a != b) {
                prop_assert!(seen.get(a, b) || !visible, "sector {} sees {}", a, b);
                prop_assert!(visible || !seen.get(a, b) || summary.n_rounded_crossings > 0, "{} does not see {}", a, b);
            }
        }
    }
}

/// The impostor of the comparisons above: with one pair of a table hidden, or one shown, they fail.
#[test]
fn a_wrong_pair_is_noticed() {
    let plan = scenes::maze(1, 3, 3).unwrap();
    let table = bake(&plan, Subdivide::Triangulation).expect("a plan on a grid");
    assert_eq!(disagreement(&plan, &table), None);
    let n = table.n_cells();
    let changed = |from: bool| {
        let mut parts = table.clone().into_parts();
        for a in 0..n {
            for b in 0..a {
                if parts.rows.get(a, b) == from {
                    parts.rows.set(a, b, !from);
                    parts.rows.set(b, a, !from);
                }
            }
        }
        Table::new(parts).unwrap()
    };
    assert!(disagreement(&plan, &changed(true)).is_some(), "hiding is noticed");
    assert!(disagreement(&plan, &changed(false)).is_some(), "showing is noticed");
}

fn all_scenes() -> Vec<(String, Plan)> {
    let mut all = vec![
        ("office".to_owned(), scenes::office(scenes::OfficeOptions::default()).unwrap()),
        ("maze".to_owned(), scenes::maze(7, 12, 12).unwrap()),
        ("hall".to_owned(), scenes::pillared_hall(7, 5, 5).unwrap()),
        ("turned hall".to_owned(), scenes::turned_pillared_hall(7, 5, 5).unwrap()),
        ("doom-like".to_owned(), scenes::doom_like(7, 5).unwrap()),
    ];
    all.extend(scenes::degenerate::all().into_iter().map(|(name, plan)| (name.to_owned(), plan)));
    all
}

/// Invariant: what a clear chord joins, the table joins, for every subdivision.
#[test]
fn chords_of_generated_scenes_are_in_the_table() {
    let mut n_checked = 0;
    for (name, plan) in all_scenes() {
        for subdivide in [Subdivide::Auto, Subdivide::KdTree, Subdivide::Triangulation] {
            let options = BakeOptions { subdivide, ..BakeOptions::default() };
            let Ok(baked) = bake_plan(&plan, &options) else {
                assert!(plan.lines().len() < 3 || !plan.is_axial(), "{name} by {subdivide}");
                continue;
            };
            for chord in clear_chords(&plan, 3, 2_000) {
                let from = baked.table.visible_from(&[chord.from.x, chord.from.y]);
                for cell in baked.table.locate(&[chord.to.x, chord.to.y]) {
                    if !baked.table.locate(&[chord.from.x, chord.from.y]).is_empty() {
                        assert!(from.contains(cell), "{name} by {subdivide}: {chord:?}");
                        n_checked += 1;
                    }
                }
            }
        }
    }
    assert!(n_checked > 10_000, "{n_checked} chords");
}

/// Invariant: sectors that a clear chord joins are never rejected.
#[test]
fn chords_of_doom_like_plans_join_visible_sectors() {
    let mut n_seen = 0;
    for seed in 0..6 {
        let plan = scenes::doom_like(seed, 4).unwrap();
        let (seen, _) = see_groups(&plan, plan.n_groups(), &SearchOptions::default()).unwrap();
        let sampled = sampled_sector_visibility(&plan, seed, 4_000);
        for (a, row) in sampled.iter().enumerate() {
            for (b, _) in row.iter().enumerate().filter(|(_, v)| **v) {
                assert!(seen.get(a, b), "seed {seed}: sector {a} sees {b}");
                n_seen += 1;
            }
        }
    }
    assert!(n_seen > 1_000, "{n_seen} pairs");
}

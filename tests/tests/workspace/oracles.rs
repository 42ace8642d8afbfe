//! Tables of small plans against brute force, both ways: nothing visible is hidden, nothing hidden is
//! called visible. And tables of larger plans against random chords.

use proptest::prelude::*;
use sightlines::bake::{PlanBakeOptions, Subdivide, bake_plan, see_groups};
use sightlines::cells::{CellId, Plan, PlanLine};
use sightlines::geometry::Point2;
use sightlines::pvs::{Place, Table};
use sightlines::scenes;
use sightlines::stabtree::SearchOptions;
use sightlines_testkit::{
    axial_plan, clear_chords, draw, sampled_sector_visibility, sector_visibility_brute_force, sees_brute_force,
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
    let options = PlanBakeOptions { subdivide, threads: 1, ..PlanBakeOptions::default() };
    let baked = bake_plan(plan, &options).ok()?;
    // Where a crossing was rounded, cells are those of walls bent by a rounding error, and the exact
    // oracle sees through the slivers between; noding has its own tests.
    (baked.report.n_rounded_crossings == 0).then_some(baked.table)
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

/// Lines on a grid of tenths, ends moved by up to two units in the last place: crossings that need
/// rounding, ends a hair before or behind other lines, several crossings in almost one point.
fn jittered_plan() -> impl Strategy<Value = Plan> {
    let coordinate = (0i32..8, -2i64..3, prop::bool::ANY).prop_map(|(n, ulps, third)| {
        let x = f64::from(n) * if third { 1.0 / 3.0 } else { 0.1 } + 1.0;
        f64::from_bits(x.to_bits().wrapping_add_signed(ulps))
    });
    let point = (coordinate.clone(), coordinate).prop_map(|(x, y)| Point2::new(x, y));
    let group = || prop::option::of(0u32..4);
    let line = (point.clone(), point, prop::bool::weighted(0.7), group(), group());
    let line = line.prop_filter("of some length", |(a, b, ..)| a != b);
    let line = line.prop_map(|(a, b, opaque, left, right)| PlanLine { a, b, opaque, left, right });
    prop::collection::vec(line, 2..7).prop_map(|lines| Plan::new(lines, vec![]).expect("lines of some length"))
}

/// The first pair of groups that brute force sees and the table hides.
fn hidden_though_seen(plan: &Plan) -> Option<(usize, usize)> {
    let expected = sector_visibility_brute_force(plan);
    let (seen, _) = see_groups(plan, plan.n_groups(), &SearchOptions::default()).unwrap();
    let n = expected.len();
    (0..n * n).map(|i| (i / n, i % n)).find(|&(a, b)| expected[a][b] && !seen.get(a, b))
}

proptest! {
    /// Invariant: rounding hides nothing that brute force, in exact fractions, sees.
    #[test]
    fn sectors_of_lines_that_need_rounding_are_sound(plan in jittered_plan()) {
        prop_assert_eq!(hidden_though_seen(&plan), None);
    }
}

/// The comparisons of tables compare: most plans that are drawn give a table without rounding, with pairs
/// that see each other and pairs that do not.
#[test]
fn drawn_plans_give_tables_to_compare() {
    let plans = draw(&small_grid_plan(1..8), 200);
    let tables: Vec<Table> = plans.iter().filter_map(|p| bake(p, Subdivide::Triangulation)).collect();
    assert!(tables.len() > 60, "{} of 200 by triangulation", tables.len());
    let mixed = |t: &&Table| (0.0..1.0).contains(&t.mean_visible_share()) && t.n_cells() > 3;
    let n_mixed = tables.iter().filter(mixed).count();
    assert!(n_mixed > 30, "{n_mixed} of {} with hidden pairs", tables.len());
    let n_axial = draw(&axial_plan(1..9), 200).iter().filter(|p| bake(p, Subdivide::KdTree).is_some()).count();
    assert!(n_axial > 100, "{n_axial} of 200 by k-d tree");
}

/// The strategy above does what it is for: it makes plans with rounded crossings.
#[test]
fn jittered_plans_need_rounding() {
    let plans = draw(&jittered_plan(), 300);
    let summary = |p: &Plan| see_groups(p, p.n_groups(), &SearchOptions::default()).unwrap().1;
    let rounded = plans.iter().filter(|p| summary(p).n_rounded_crossings > 0).count();
    assert!(rounded > 100, "{rounded} of 300 plans");
}

fn named_walls(walls: &[([f64; 4], Option<u32>, Option<u32>)]) -> Plan {
    let line = |&([ax, ay, bx, by], left, right): &([f64; 4], Option<u32>, Option<u32>)| PlanLine {
        a: Point2::new(ax, ay),
        b: Point2::new(bx, by),
        opaque: true,
        left,
        right,
    };
    Plan::new(walls.iter().map(line).collect(), vec![]).unwrap()
}

/// A wall that rounding makes unsafe stops blocking, and its sides still name their groups.
#[test]
fn a_wall_that_is_given_up_still_names_its_groups() {
    let plan = named_walls(&[
        ([2.9999999999999996, 2.0000000000000004, 1.9999999999999998, 4.000000000000002], None, None),
        ([3.999999999999999, 5.999999999999998, 2.000000000000001, 4.000000000000001], None, None),
        ([5., 3.9999999999999996, 1.9999999999999996, 3.999999999999999], Some(1), Some(2)),
    ]);
    assert_eq!(hidden_though_seen(&plan), None);
}

/// A wall whose end pokes through another by less than rounding names a group there.
#[test]
fn a_stub_shorter_than_rounding_still_names_its_group() {
    let q = 0.30000000000000004;
    let plan = named_walls(&[
        ([q, 0.2, 0.2, q], None, Some(1)),
        ([0., 0.2, 0.4, 0.4], None, None),
        ([0.5, 0.1, 0.2, 0.], Some(2), None),
        ([0.2, 0., 0.4, 0.4], None, None),
    ]);
    assert_eq!(hidden_though_seen(&plan), None);
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
            let options = PlanBakeOptions { subdivide, ..PlanBakeOptions::default() };
            let Ok(baked) = bake_plan(&plan, &options) else {
                assert!(plan.lines().len() < 3 || !plan.is_axial(), "{name} by {subdivide}");
                continue;
            };
            for chord in clear_chords(&plan, 3, 2_000) {
                let query = baked.table.in_dimension().unwrap();
                let Place::Inside(from) = query.at([chord.from.x, chord.from.y]) else { continue };
                for &cell in query.at([chord.to.x, chord.to.y]).cells() {
                    assert!(from.sees(cell), "{name} by {subdivide}: {chord:?}");
                    n_checked += 1;
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

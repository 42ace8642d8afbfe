//! Random segments at hidden pairs: how little of a pair may be free before it is missed.

use crate::tables::common::{Case, Real, cases, changed, check, quick};
use sightlines_geometry::{Point2, Point3, Random, Segment2, ray_triangle};
use sightlines_pvs::{CellId, Table};
use sightlines_verify::{Sampled, VerifyOptions, Violation};

/// Only random segments.
fn segments(segments: u32, seed: u64) -> VerifyOptions<'static> {
    VerifyOptions { rays: 0, pairs: 0, segments, seed, ..quick() }
}

/// A place in a cell of a plan or a scene, each as likely as another.
fn place(case: &Case, cell: CellId, random: &mut Random) -> Point3 {
    let record = &case.table.cells()[cell.idx()];
    loop {
        let p: Point3 = std::array::from_fn(|k| record.min[k] + (record.max[k] - record.min[k]) * random.unit());
        let sides = record.polygon.iter().zip(record.polygon.iter().cycle().skip(1));
        let is_left = |(a, b): (&[f64; 2], &[f64; 2])| (b[0] - a[0]) * (p[1] - a[1]) > (b[1] - a[1]) * (p[0] - a[0]);
        if sides.into_iter().all(is_left) {
            return p;
        }
    }
}

/// Whether nothing is between two places, by loops over everything.
fn is_free(case: &Case, p: Point3, q: Point3) -> bool {
    match &case.real {
        Real::Plan(plan) => {
            let ray = Segment2::new(Point2::new(p[0], p[1]), Point2::new(q[0], q[1]));
            plan.lines().iter().filter(|l| l.opaque).all(|l| !ray.meets(&Segment2::new(l.a, l.b)))
        }
        Real::Scene(scene) => scene.occluding_triangles().all(|t| {
            let [x, y, t] = ray_triangle(&t, p, std::array::from_fn(|k| q[k] - p[k]));
            !(x >= 0.0 && y >= 0.0 && x + y <= 1.0 && (0.0..=1.0).contains(&t))
        }),
        _ => unreachable!("plans and scenes alone"),
    }
}

/// The share of free segments of a pair, of so many.
fn share(case: &Case, [a, b]: [CellId; 2], n: u32) -> f64 {
    let mut random = Random::new(u64::from(a.0) << 32 | u64::from(b.0));
    let free = (0..n).filter(|_| {
        let (p, q) = (place(case, a, &mut random), place(case, b, &mut random));
        is_free(case, p, q)
    });
    f64::from(free.count() as u32) / f64::from(n)
}

fn hide(table: &Table, [a, b]: [CellId; 2]) -> Table {
    changed(table, |parts| {
        parts.rows.set(a.idx(), b.idx(), false);
        parts.rows.set(b.idx(), a.idx(), false);
    })
}

fn is_found(table: &Table, case: &Case, pair: [CellId; 2], options: &VerifyOptions<'_>) -> bool {
    let found = check(table, &case.real, options);
    let is_it = |v: &Violation| matches!(v, Violation::HiddenCell { cells, .. } if *cells == pair);
    // Of a hidden pair of neighbours the structure tells as well; nothing but this pair is wrong.
    assert!(found.violations.iter().all(|v| is_it(v) || v.object().is_some()), "{:?}", found.violations);
    found.violations.iter().any(is_it)
}

/// Pairs of a table of which a small share of segments is free.
fn narrow(case: &Case, n: usize) -> Vec<([CellId; 2], f64)> {
    let n_cells = case.table.n_cells();
    let mut random = Random::new(5);
    let mut any = || CellId(random.below(n_cells) as u32);
    let mut found: Vec<([CellId; 2], f64)> = Vec::new();
    for _ in 0..20_000 {
        let pair = [any(), any()];
        let [a, b] = pair;
        if a >= b || !case.table.sees(a, b) || found.iter().any(|known| known.0 == pair) {
            continue;
        }
        // Few segments first, then as many as tell a hundredth from two.
        let rough = share(case, pair, 200);
        if rough > 0.0 && rough < 0.15 {
            let share = share(case, pair, 5_000);
            found.extend((0.01..0.1).contains(&share).then_some((pair, share)));
        }
        if found.len() == n {
            break;
        }
    }
    found
}

/// Invariant: a hidden pair of which one segment in a hundred is free is found in 99 of 100 runs. The shares are measured by loops over the scene.
#[test]
fn pairs_with_one_free_segment_in_a_hundred_are_found() {
    let (mut n_runs, mut n_missed, mut n_missed_by_few) = (0, 0, 0);
    let options = VerifyOptions::default().segments;
    for case in cases().filter(|case| matches!(case.real, Real::Plan(_) | Real::Scene(_))) {
        for (pair, share) in narrow(case, 3) {
            let wrong = hide(&case.table, pair);
            for seed in 0..8 {
                n_runs += 1;
                n_missed += usize::from(!is_found(&wrong, case, pair, &segments(options, seed)));
                n_missed_by_few += usize::from(!is_found(&wrong, case, pair, &segments(4, seed)));
            }
            println!("{}: {pair:?}, {:.1} % free", case.name, 100.0 * share);
        }
    }
    println!("{n_missed} of {n_runs} missed, {n_missed_by_few} with four segments");
    // One run in a hundred of the narrowest pairs, and most have several times as much.
    assert!(n_runs >= 100 && 50 * n_missed <= n_runs, "{n_missed} of {n_runs} missed");
    // The impostor: with four segments most are missed, so the pairs are not found for another reason.
    assert!(2 * n_missed_by_few > n_runs, "{n_missed_by_few} of {n_runs}");
}

#[test]
fn the_share_that_is_found_follows_from_the_number_of_segments() {
    let share = |n_each| Sampled { n_pairs: 1, n_each }.share_found();
    assert_eq!((share(0), share(1)), (1.0, 0.99));
    assert!(share(459) < 0.01 && share(458) > 0.01);
    for n in [3, 100, 100_000] {
        assert!(((1.0 - share(n)).powi(n as i32) - 0.01).abs() < 1e-9, "{n}");
    }
}

/// Objects are sampled too: one hidden from a cell that sees more than a tenth of it is found by random segments alone, and one that is hidden in fact is not.
#[test]
fn hidden_objects_are_found() {
    let (mut n_found, mut n_all) = (0, 0);
    for case in cases().filter(|case| matches!(case.real, Real::Scene(_))) {
        let Some(seen) = &case.table.parts().objects_seen else { continue };
        assert!(check(&case.table, &case.real, &segments(459, 1)).is_true(), "{}", case.name);
        let mut random = Random::new(3);
        for _ in 0..12 {
            let (cell, object) = (random.below(seen.n_rows()), random.below(seen.n_cols()));
            let touches = case.table.objects_of(CellId(cell as u32)).iter().any(|o| o.idx() == object);
            if touches || !seen.get(cell, object) {
                continue;
            }
            let wrong = changed(&case.table, |parts| {
                parts.objects_seen.as_mut().expect("asked before").set(cell, object, false);
            });
            let found = check(&wrong, &case.real, &segments(459, 1));
            let is_it = |v: &Violation| v.object() == Some(object as u32) && v.cells() == [CellId(cell as u32)];
            assert!(found.violations.iter().all(is_it), "{:?}", found.violations);
            n_found += found.n_violations;
            n_all += 1;
        }
    }
    println!("{n_found} of {n_all} hidden objects found");
    // The methods show some objects that no segment reaches.
    assert!(n_all >= 10 && 2 * n_found >= n_all, "{n_found} of {n_all}");
}

/// Where cells leave gaps, a table that hides two groups of them from each other has no pair next to a visible one; all hidden pairs are looked at.
#[test]
fn cells_with_gaps_between_them_are_sampled() {
    let case = cases().find(|case| case.table.kind().leaves_gaps()).expect("given cells");
    let n = case.table.n_cells();
    let blind = changed(&case.table, |parts| {
        (0..n).for_each(|a| (0..n).filter(|&b| a != b).for_each(|b| parts.rows.set(a, b, false)));
    });
    let found = check(&blind, &case.real, &segments(459, 1));
    let n_pairs = (n * (n - 1) / 2) as u64;
    assert!(found.sampled.n_pairs >= n_pairs && found.sampled.n_each == 459, "{:?}", found.sampled);
    assert!(found.by_kind["hidden-cell"] > n / 2, "{:?}", found.by_kind);
}

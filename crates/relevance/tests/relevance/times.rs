//! Times until sight, deadlines and paths.

use crate::grid::{body, cell, grids, point, square, world};
use proptest::prelude::*;
use sightlines_geometry::Random;
use sightlines_pvs::CellId;
use sightlines_relevance::{ReachOptions, Reaches, Relevance, RelevanceOptions};

proptest! {
    /// The time is that of the best pair of cells, and no look within it finds anything.
    #[test]
    fn times_are_those_of_the_definition(grid in grids(), seed: u64) {
        let table = grid.table();
        let reaches = Reaches::of(&table, &ReachOptions { ladder: vec![1.0, 2.0], ..ReachOptions::default() }).expect("reaches");
        let mut told = Relevance::new(table.clone(), reaches, RelevanceOptions::of(&table));
        let (mut random, all) = (Random::new(seed), world(&table));
        let [p, q] = [random.point(&all), random.point(&all)];
        let speeds = [random.below(3) as f64, random.below(3) as f64];
        let time = |p: [f64; 3], i: usize, speed: f64| {
            let far = square(&point(p), &cell(&table, i)).sqrt();
            if far == 0.0 { 0.0 } else { far / speed }
        };
        let n = table.n_cells();
        let pairs = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).filter(|&(i, j)| table.sees(CellId(i as u32), CellId(j as u32)));
        let expected = pairs.map(|(i, j)| time(p, i, speeds[0]).max(time(q, j, speeds[1]))).fold(f64::INFINITY, f64::min);
        let (a, b) = (body(p), body(q));
        let found = told.time_to_sight(&a, &b, speeds);
        prop_assert!(found <= expected && (found == expected || found >= expected * (1.0 - 1e-9)), "{} for {}", found, expected);
        if found > 0.0 && found.is_finite() {
            let within = |t: f64, told: &mut Relevance| told.may_see_within(&a.moving(speeds[0], t), &b.moving(speeds[1], t));
            prop_assert!(!within(found * 0.999, &mut told));
            prop_assert!(within(found * 1.001, &mut told), "not later than it says, but for rounding");
        }
        // Objects of this grid are its cells.
        let deadlines = told.deadlines(&a, 2.0);
        for (object, &found) in deadlines.iter().enumerate() {
            let seen = (0..n).filter(|&i| table.sees(CellId(i as u32), CellId(object as u32)));
            let expected = seen.map(|i| time(p, i, 2.0)).fold(f64::INFINITY, f64::min);
            prop_assert!(found <= expected && found >= expected * (1.0 - 1e-9));
        }
    }
}

#[test]
fn paths_are_exposed_where_they_are_seen() {
    let table = crate::grid::Grid { size: [4, 1, 1], seed: 1, blind: usize::MAX }.table();
    let reaches = Reaches::of(&table, &ReachOptions::default()).expect("reaches");
    let mut told = Relevance::new(table.clone(), reaches, RelevanceOptions::of(&table));
    let middle = |i: usize| std::array::from_fn(|k| (table.cells()[i].min[k] + table.cells()[i].max[k]) / 2.0);
    // Cells see themselves alone here: the walk is seen while it touches that of the watcher.
    let path: Vec<_> = (0..=3).map(|i| (f64::from(i), point(middle(i as usize)))).collect();
    let exposure = told.exposure(&path, &[body(middle(1))], 0.0);
    assert_eq!((exposure.first(), exposure.seconds()), (Some(0.0), 2.0));
    let exposure = told.exposure(&path, &[body(middle(3)), body(middle(3))], 0.0);
    assert_eq!((exposure.first(), exposure.seconds()), (Some(2.0), 1.0));
    assert_eq!(told.exposure(&path, &[], 9.0).spans, []);
    assert_eq!(told.exposure(&path, &[body(middle(3))], 100.0).seconds(), 3.0);
    assert_eq!(told.exposure(&path, &[body([1e9; 3])], 0.0).seconds(), 3.0, "outside of all cells");
}

//! Wrong answers, and that they are noticed.

use crate::eye_to_cell::ask::{Answers, Asker, missed, not_nested};
use crate::eye_to_cell::plan_families::bake;
use crate::eye_to_cell::plans::{fan, judge};
use sightlines::bake::Subdivide;
use sightlines::eye_to_cell::{Doors, View};
use sightlines::geometry::Point2;
use std::f64::consts::TAU;

/// An answer that lacks one cell that is seen is noticed, whichever cell and method; so is one that shows
/// everything, and one that is not within the one before.
#[test]
fn wrong_answers_about_a_maze_are_noticed() {
    let plan = sightlines::scenes::maze(5, 4, 4).expect("a small maze");
    let table = bake(&plan, Subdivide::Triangulation).expect("a plan on a grid");
    let eye = Point2::new(plan.bounds().min[0] + 0.5625, plan.bounds().min[1] + 0.4375);
    let roots = table.in_dimension().unwrap().at([eye.x, eye.y]).cells().to_vec();
    let view = View::all_round([eye.x, eye.y, 0.0]).expect("a finite eye");
    let answers = Asker::new(&table).all(&roots, &view, &Doors::all_open());
    let fan = fan(&plan, &table, &[], eye).expect("a plan on a grid");
    assert!(judge(&table, &roots, &answers, &answers[4], &fan, (0.0, TAU)).is_ok());

    let (mut n_noticed, mut n_bounded) = (0, 0);
    let seen = fan.seen(0.0, TAU);
    for &cell in &seen {
        for method in 0..5 {
            // Less from here on, so that only the missing cell is wrong.
            let mut less: Answers = answers.clone();
            less[method..].iter_mut().for_each(|answer| assert!(answer.cells.remove(&cell)));
            assert_eq!(not_nested(&less), None);
            n_noticed += usize::from(judge(&table, &roots, &less, &answers[4], &fan, (0.0, TAU)).is_err());
            // A bounded answer that misses something is noticed, too.
            n_bounded += usize::from(judge(&table, &roots, &answers, &less[4], &fan, (0.0, TAU)).is_err());
        }
    }
    assert!(
        seen.len() > 3 && n_noticed == 5 * seen.len() && n_bounded == n_noticed,
        "{n_noticed} and {n_bounded} of {}",
        seen.len()
    );

    let everything: Answers = std::array::from_fn(|_| answers[0].clone());
    assert!(
        judge(&table, &roots, &everything, &answers[4], &fan, (0.0, TAU))
            .is_err_and(|wrong| wrong.contains("no ray touches"))
    );
    let mut swapped = answers;
    swapped.swap(0, 4);
    assert!(not_nested(&swapped).is_some() && missed(&swapped, &Default::default()).is_none());
}

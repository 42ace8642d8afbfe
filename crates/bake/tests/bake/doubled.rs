//! Plans with lines that are there twice: what is decided does not depend on them.

use sightlines_bake::{PlanBakeOptions, bake_plan};
use sightlines_cells::{LineId, Plan, PlanLine};
use sightlines_formats::geojson::{parse_plan_file, write_plan};
use sightlines_scenes::{OfficeOptions, doom_like, maze, office, pillared_hall, turned_pillared_hall};

/// The table as a file, but for the digest of the lines as they are listed.
fn table(plan: &Plan) -> Vec<u8> {
    let baked = bake_plan(plan, &PlanBakeOptions { threads: 1, ..PlanBakeOptions::default() }).expect("a small plan");
    baked.table.with_digest(None).to_bytes()
}

/// The plan with every third line again at the end, every other one of these turned round.
fn with_doubles(plan: &Plan) -> (Plan, usize) {
    let again = plan.lines().iter().enumerate().step_by(3).map(|(k, &line)| match k % 2 {
        0 => line,
        _ => PlanLine { a: line.b, b: line.a, left: line.right, right: line.left, ..line },
    });
    let again: Vec<PlanLine> = again.collect();
    let n = again.len();
    let lines = plan.lines().iter().copied().chain(again).collect();
    (Plan::new(lines, plan.objects().to_vec()).expect("lines of a plan"), n)
}

#[test]
fn tables_of_plans_with_doubled_lines_are_the_same_without_them() {
    let small = OfficeOptions { rooms_x: 3, rooms_y: 2, ..OfficeOptions::default() };
    let plans = [
        maze(3, 5, 4),
        doom_like(2, 1),
        doom_like(5, 1),
        office(small),
        pillared_hall(1, 3, 3),
        turned_pillared_hall(1, 3, 2),
    ];
    for plan in plans.map(|plan| plan.expect("valid options")) {
        let (doubled, n) = with_doubles(&plan);
        let read = parse_plan_file(write_plan(&doubled).as_bytes()).expect("what was written is read");
        assert!(n > 0 && read.dropped.n_doubled >= n, "{n}");
        assert!(table(&doubled) == table(&read.plan));
        // Impostors: where a line that is not there twice is missed, that shows.
        let without = |k: usize| {
            let lines = read.plan.lines().iter().enumerate().filter(|(idx, _)| *idx != k).map(|(_, line)| *line);
            Plan::new(lines.collect(), read.plan.objects().to_vec()).unwrap()
        };
        let (right, n) = (table(&read.plan), read.plan.lines().len());
        assert!((0..n).step_by((n / 8).max(1)).any(|k| table(&without(k)) != right));
    }
}

#[test]
fn a_mirror_that_is_there_twice_is_one() {
    let plan = maze(3, 3, 3).unwrap();
    let (doubled, _) = with_doubles(&plan);
    // The first line of the maze, and its double.
    let twice = [0, plan.lines().len() as u32].map(LineId);
    let doubled = doubled.with_mirrors(twice.to_vec()).unwrap();
    let read = parse_plan_file(write_plan(&doubled).as_bytes()).unwrap().plan;
    assert_eq!(read, plan.with_mirrors(vec![LineId(0)]).unwrap());
}

//! Many points: more than one batch of searches, any number of threads, progress and cancellation.

use crate::dense::{Matrix, Walls, global, is_near};
use sightlines_progress::Progress;
use sightlines_visibility_graph::{
    Analysis, AnalysisOptions, Group, Measure, PixelGrid, Points, VisibilityGraph, WorkOptions,
};
use std::collections::BTreeSet;
use std::ops::ControlFlow;
use std::sync::Mutex;

/// Two rooms that are joined by a door, and one that is shut: some 560 points.
fn rooms() -> (Walls, Points, Matrix) {
    let walls = Walls(vec![
        [[1, 1], [61, 1]],
        [[61, 1], [61, 41]],
        [[61, 41], [1, 41]],
        [[1, 41], [1, 1]],
        [[21, 1], [21, 18]],
        [[21, 23], [21, 41]],
        [[45, 1], [45, 41]],
        [[5, 9], [16, 13]],
        [[25, 31], [41, 27]],
    ]);
    of_walls(walls)
}

/// The same with fewer points, some 300: more than one batch.
pub(crate) fn small_rooms() -> (Walls, Points, Matrix) {
    let walls = Walls(vec![
        [[1, 1], [45, 1]],
        [[45, 1], [45, 29]],
        [[45, 29], [1, 29]],
        [[1, 29], [1, 1]],
        [[21, 1], [21, 12]],
        [[21, 17], [21, 29]],
        [[37, 1], [37, 29]],
        [[5, 9], [16, 13]],
        [[25, 23], [33, 21]],
    ]);
    of_walls(walls)
}

fn of_walls(walls: Walls) -> (Walls, Points, Matrix) {
    let points = PixelGrid::over(&walls.plan(), 2.0).unwrap().enclosed().unwrap();
    let at: Vec<[i64; 2]> = points.coordinates().iter().map(|p| [p.x as i64, p.y as i64]).collect();
    let matrix = Matrix::of(&walls, &at);
    (walls, points, matrix)
}

fn analysis(graph: &VisibilityGraph, points: &Points, effort: &WorkOptions<'_>) -> Analysis {
    Analysis::of(graph, points, &Measure::ALL, &AnalysisOptions::default(), effort).unwrap()
}

#[test]
fn threads_change_nothing() {
    let (_, points, matrix) = rooms();
    let run = |threads: usize| {
        let effort = WorkOptions { threads, ..WorkOptions::default() };
        let graph = matrix.graph(&effort).unwrap();
        let all = analysis(&graph, &points, &effort);
        (graph, all)
    };
    let one = run(1);
    assert!(points.len() > 512, "more than two batches: {}", points.len());
    assert!(run(2) == one && run(7) == one);
    let values = |measure: Measure| one.1.values(measure).unwrap();
    for measure in Measure::ALL {
        let values = values(measure);
        assert_eq!(values.len(), points.len());
        assert!(values.iter().any(|&x| x != values[0]), "{measure:?} is the same everywhere");
        assert!(values.iter().all(|&x| x >= 0.0 || x == -1.0), "{measure:?}");
    }
}

/// Points of several batches have the depths of the matrix; the shut room counts for itself.
#[test]
fn batches_are_right() {
    let (_, points, matrix) = small_rooms();
    assert!(points.len() > 256, "more than one batch: {}", points.len());
    let graph = matrix.graph(&WorkOptions::default()).unwrap();
    let found = analysis(&graph, &points, &WorkOptions::default()).global.unwrap();
    for (i, depths) in matrix.depths().iter().enumerate() {
        let expected = global(depths, None);
        let row = [f64::from(found.node_count[i]), found.mean_depth[i], found.integration_hh[i], found.entropy[i]];
        let expected = [expected[0], expected[1], expected[2], expected[5]];
        assert!(row.into_iter().zip(expected).all(|(a, b)| is_near(a, b)), "{i}: {row:?} {expected:?}");
    }
    let counts: BTreeSet<u32> = found.node_count.iter().copied().collect();
    assert_eq!(counts.len(), 2, "two components");
}

#[test]
fn groups_are_reported_and_can_be_cancelled() {
    let (_, points, matrix) = small_rooms();
    let graph = matrix.graph(&WorkOptions::default()).unwrap();
    let phases = Mutex::new(BTreeSet::new());
    let observer = |progress: Progress| {
        phases.lock().unwrap().insert(progress.phase);
        ControlFlow::Continue(())
    };
    analysis(&graph, &points, &WorkOptions { threads: 2, observer: Some(&observer), ..WorkOptions::default() });
    assert_eq!(phases.lock().unwrap().len(), 4, "a phase for each group");
    for group in Group::ALL {
        let measures: Vec<Measure> = Measure::ALL.into_iter().filter(|measure| measure.group() == group).collect();
        let stop = |_: Progress| ControlFlow::Break(());
        let effort = WorkOptions { threads: 2, observer: Some(&stop), ..WorkOptions::default() };
        assert!(Analysis::of(&graph, &points, &measures, &AnalysisOptions::default(), &effort).is_err());
        let some = Analysis::of(&graph, &points, &measures[..1], &AnalysisOptions::default(), &WorkOptions::default())
            .unwrap();
        let computed: Vec<Group> =
            Measure::ALL.into_iter().filter(|&m| some.values(m).is_some()).map(Measure::group).collect();
        assert!(computed.iter().all(|&other| other == group) && computed.len() == measures.len());
    }
}

#[test]
fn names_are_unique() {
    let names: BTreeSet<&str> = Measure::ALL.iter().map(|measure| measure.name()).collect();
    let titles: BTreeSet<&str> = Measure::ALL.iter().map(|measure| measure.title()).collect();
    assert_eq!([names.len(), titles.len()], [Measure::ALL.len(); 2]);
    assert!(Group::ALL.iter().all(|group| !names.contains(group.name())));
}

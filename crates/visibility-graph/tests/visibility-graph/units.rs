//! Analyses whose results are kept by units of work end with the same bits.

use crate::dense::{Matrix, Walls};
use crate::threads::small_rooms;
use sightlines_progress::{Halt, Units};
use sightlines_testkit::units::{check_impostor, check_units};
use sightlines_visibility_graph::{Analysis, AnalysisOptions, GraphError, Measure, Points, WorkOptions};

/// The graph and all measures as bytes.
fn analysed((_, points, matrix): &(Walls, Points, Matrix), effort: &WorkOptions<'_>) -> Result<Vec<u8>, GraphError> {
    let graph = matrix.graph(effort)?;
    let all = Analysis::of(&graph, points, &Measure::ALL, &AnalysisOptions::default(), effort)?;
    let rows = (0..points.len() as u32).map(|point| format!("{:?}", graph.row(point)));
    let values = |measure: Measure| all.values(measure).unwrap().into_iter().map(|x| format!("{:x}", x.to_bits()));
    Ok(rows.chain(Measure::ALL.into_iter().flat_map(values)).collect::<Vec<_>>().join("\n").into_bytes())
}

#[test]
fn all_groups() {
    let rooms = small_rooms();
    let n = rooms.1.len();
    let [few, many] = [n.div_ceil(256), n.div_ceil(64)];
    let expected =
        [("sight", few), ("local-measures", few), ("depths", few), ("metric-paths", many), ("angular-paths", many)];
    assert_eq!(
        check_units(|units, threads| analysed(&rooms, &WorkOptions { threads, units, ..WorkOptions::default() })),
        expected
    );
}

#[test]
fn other_results_are_noticed() {
    let rooms = small_rooms();
    for phase in ["sight", "local-measures", "depths", "metric-paths", "angular-paths"] {
        check_impostor(
            |units, threads| analysed(&rooms, &WorkOptions { threads, units, ..WorkOptions::default() }),
            phase,
        );
    }
}

/// An error of a point is not kept.
#[test]
fn a_wrong_row_is_none() {
    let store = sightlines_testkit::units::Memory::default();
    let effort = WorkOptions { threads: 2, units: Units(Some(&store)), ..WorkOptions::default() };
    let seen = |point: u32, list: &mut Vec<u32>| list.extend((point == 700 || point == 300).then_some(9000));
    let found = sightlines_visibility_graph::VisibilityGraph::build(1000, seen, &effort);
    assert_eq!(found, Err(GraphError::Row { point: 300, n_points: 1000 }));
    assert!(store.into_results().keys().all(|key| [("sight", 0), ("sight", 3)].contains(key)));
    assert_eq!(GraphError::from(Halt::Shared).to_string(), Halt::Shared.to_string());
}

//! Explanations: for every pair of a table of each kind, what is found agrees with the table, and depends on no row of it.

use crate::stab::tables;
use sightlines_bake::explain::{
    Answer, Blocks, ExactLine, ExplainError, ExplainOptions, Explanation, Reason, SightLine, explain,
};
use sightlines_bake::{BakeRequest, CellsFrom, GraphKind, SceneMethod, bake, stated_methods};
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_pvs::{BitMatrix, CellId, Table};
use sightlines_scenes::{TowerOptions, tower};

const OPTIONS: ExplainOptions = ExplainOptions {
    max_visits: 1_000_000,
    max_programs: 20_000,
    max_questions: 10_000,
    n_rays: 300,
    max_blocked: 2,
    check: true,
};

fn pairs(table: &Table, step: usize) -> Vec<[CellId; 2]> {
    let cells = || (0u32..).take(table.n_cells()).map(CellId);
    cells().flat_map(|a| cells().map(move |b| [a, b])).step_by(step).collect()
}

/// What holds of every line.
fn check_line(table: &Table, [a, b]: [CellId; 2], line: &SightLine, exact: &ExactLine) {
    assert_eq!((line.cells.first(), line.cells.last()), (Some(&a), Some(&b)));
    assert_eq!(line.cells.len(), line.portals.len() + 1);
    assert_eq!(exact.crossings().len(), line.portals.len());
    for (k, portal) in line.portals.iter().enumerate() {
        let mut joined = table.portals()[portal.idx()].cells;
        let mut passed = [line.cells[k], line.cells[k + 1]];
        joined.sort();
        passed.sort();
        assert_eq!(joined, passed);
    }
}

/// What holds of every reason.
fn check_reason(kind: GraphKind, reason: &Reason) {
    match (kind, reason) {
        (_, Reason::NotConnected) => {}
        (GraphKind::Axial, Reason::Walls(found)) => {
            let n_steps = found.n_steps();
            assert!(!found.walls.is_empty() && n_steps.iter().all(|n| *n > 0));
            assert!(found.most_important().is_sorted_by(|a, b| a.1 >= b.1));
        }
        (GraphKind::Planar | GraphKind::Convex, Reason::Blocked { n_blocked, blocked, .. }) => {
            assert_eq!(blocked.len() as u64, (*n_blocked).min(2));
            for found in blocked {
                assert_eq!(found.way.portals.len(), found.way.cells.len());
                assert_eq!(matches!(found.proof, Blocks::Corners { .. }), kind == GraphKind::Planar);
            }
        }
        _ => panic!("{reason:?} of {kind:?}"),
    }
}

#[test]
fn explanations_agree_with_tables_of_each_kind() {
    for (name, table, _) in tables() {
        // Nothing is read from the rows.
        let mut parts = table.clone().into_parts();
        parts.rows = BitMatrix::identity(table.n_cells());
        parts.stab = None;
        let blind = Table::new(parts).expect("symmetric");
        let (mut n_seen, mut n_hidden, mut n_contradicted) = (0, 0, 0);
        for pair in pairs(&table, 3) {
            let Explanation { cells, answer, checked } = explain(&blind, None, pair, &OPTIONS).expect("it has shapes");
            assert_eq!(cells, GraphKind::of(&table));
            assert_eq!(checked, (cells == GraphKind::Convex).then_some(true), "{name}: {pair:?}");
            assert_eq!(answer == Answer::Same, pair[0] == pair[1]);
            match &answer {
                Answer::Visible(line, exact) => {
                    n_seen += 1;
                    check_line(&table, pair, line, exact);
                }
                Answer::Hidden(reason) => {
                    n_hidden += 1;
                    check_reason(cells, reason);
                }
                _ => {}
            }
            let verdict = answer.verdict().unwrap_or(true);
            assert_eq!(verdict, table.sees(pair[0], pair[1]), "{name}: {pair:?}");
            n_contradicted += usize::from(verdict != blind.sees(pair[0], pair[1]));
        }
        assert!(n_seen > 10 && n_hidden > 10, "{name}: {n_seen} seen, {n_hidden} hidden");
        assert!(n_contradicted > 10, "{name}");
    }
}

#[test]
fn limits_leave_pairs_open_and_what_has_no_shapes_is_refused() {
    for (name, table, _) in tables() {
        let none = ExplainOptions { max_visits: 0, max_programs: 0, max_questions: 0, ..OPTIONS };
        let open = |pair: &[CellId; 2]| {
            let found = explain(&table, None, *pair, &none).expect("it has shapes").answer;
            matches!(found, Answer::GivenUp(0))
        };
        assert!(pairs(&table, 1).iter().any(open), "{name}");
        let n_cells = table.n_cells();
        let cell = CellId(n_cells as u32);
        let no_such = Err(ExplainError::NoSuchCell { cell, n_cells });
        assert_eq!(explain(&table, None, [CellId(0), cell], &OPTIONS), no_such);
        assert_eq!(
            explain(&table.strip_geometry(), None, [CellId(0), CellId(1)], &OPTIONS),
            Err(ExplainError::NoShapes),
            "{name}"
        );
    }
}

#[test]
fn cells_without_portals_have_a_ray_or_methods() {
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
    let scene = tower(options).expect("options in range");
    let boxes = bake(&scene, &BakeRequest::default()).expect("a table").table;
    let cell = |c: &sightlines_pvs::CellRecord| ViewCell { id: String::new(), bounds: Aabb { min: c.min, max: c.max } };
    let cells = boxes.cells().iter().step_by(3).take(20).map(cell).collect();
    let cells = Some(CellsFrom::Boxes(ViewCells { cells, axes: None }));
    let request = BakeRequest { cells, method: Some(SceneMethod::Both), ..BakeRequest::default() };
    let table = bake(&scene, &request).expect("a table").table;
    let stated = stated_methods(&table).expect("a scene's table");
    assert!(stated.sightlines && stated.is_repeatable);
    let name = stated.from_region.expect("both took part");
    assert!(name.starts_with("multifocal"), "{name}");
    let (mut n_joined, mut n_hidden) = (0, 0);
    for pair in pairs(&table, 7) {
        let listed = table.sees(pair[0], pair[1]);
        let alone = explain(&table, None, pair, &OPTIONS).expect("cells").answer;
        let with = explain(&table, Some(&scene), pair, &OPTIONS).expect("the scene of the table").answer;
        if pair[0] == pair[1] {
            assert_eq!((alone, with), (Answer::Same, Answer::Same));
            continue;
        }
        let both = vec!["sightlines".to_owned(), name.clone()];
        let hidden_by = if listed { Vec::new() } else { both.clone() };
        assert_eq!(alone, Answer::Unknown { n_rays: None, hidden_by });
        match with {
            Answer::Visible(line, ExactLine::Segment) => {
                n_joined += 1;
                assert!(listed);
                for (p, cell) in line.ends.expect("it has ends").iter().zip(pair) {
                    let cell = &table.cells()[cell.idx()];
                    assert!((0..3).all(|k| cell.min[k] < p[k] && p[k] < cell.max[k]));
                }
            }
            Answer::Unknown { n_rays, hidden_by } => {
                n_hidden += usize::from(!listed);
                assert_eq!(n_rays, Some(300));
                assert_eq!(hidden_by.len(), usize::from(!listed));
                assert!(hidden_by.iter().all(|method| both.contains(method)));
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(n_joined > 0 && n_hidden > 0, "{n_joined} joined, {n_hidden} hidden");
}

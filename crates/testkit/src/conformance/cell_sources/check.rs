//! What a source answers, and what has to hold of it.

use super::{Clause, Report, Violation};
use sightlines_eye_to_cell::{CellSource, MirrorPiece, PortalEdge};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, MirrorId, ObjectId, PortalId};
use std::fmt::Debug;

/// Nodes of stab trees that are followed.
const MOST_NODES: usize = 100_000;

/// A portal of a cell.
#[derive(Debug, Clone, PartialEq)]
struct Edge {
    portal: PortalId,
    forward: bool,
    to: CellId,
    corners: Vec<[f64; 3]>,
}

/// All answers about one cell.
#[derive(Debug, Clone, PartialEq)]
struct Cell {
    bounds: Aabb<3>,
    visible: Vec<CellId>,
    edges: Vec<Edge>,
    touching: Vec<ObjectId>,
    seen: Vec<ObjectId>,
    mirrors: Vec<(MirrorId, Vec<[f64; 3]>)>,
    roots: Vec<u32>,
    is_root_open: Option<bool>,
}

/// All answers of a source but the nodes of trees.
pub(super) struct Answers {
    n_corners: usize,
    cells: Vec<Cell>,
    objects: Vec<Aabb<3>>,
}

impl Cell {
    fn of<S: CellSource>(source: &S, cell: CellId) -> Result<Self, S::Error> {
        // Whatever is in a buffer has to go.
        let (mut visible, mut touching, mut seen, mut roots) =
            (vec![CellId(u32::MAX); 3], vec![ObjectId(u32::MAX); 3], vec![ObjectId(u32::MAX); 3], vec![u32::MAX; 3]);
        source.visible(cell, &mut visible)?;
        source.objects_of(cell, &mut touching)?;
        source.objects_seen(cell, &mut seen)?;
        let is_root_open = source.stab_roots(cell, &mut roots)?;
        let (mut edges, mut mirrors) = (Vec::new(), Vec::new());
        source.portal_edges(cell, &mut |PortalEdge { portal, forward, to, corners }| {
            edges.push(Edge { portal, forward, to, corners: corners.to_vec() });
        })?;
        source.mirrors(cell, &mut |MirrorPiece { mirror, corners }| mirrors.push((mirror, corners.to_vec())))?;
        Ok(Self { bounds: source.cell_box(cell)?, visible, edges, touching, seen, mirrors, roots, is_root_open })
    }
}

/// Whether a box is finite and its sides are in order.
fn is_box(b: &Aabb<3>) -> bool {
    (0..3).all(|k| b.min[k].is_finite() && b.max[k].is_finite() && b.min[k] <= b.max[k])
}

fn ascends<T: PartialOrd>(list: &[T]) -> bool {
    list.windows(2).all(|pair| pair[0] < pair[1])
}

/// What is asked of the source as a whole.
const WHOLE: &str = "the whole source";

fn of_cell(cell: CellId) -> String {
    format!("cell {cell}")
}

impl Answers {
    /// Asks about everything, twice, and checks what can be checked cell by cell.
    pub(super) fn of<S: CellSource>(source: &S, report: &Report) -> Result<Self, Violation> {
        let n_corners = match source.dimension() {
            n @ (2 | 3) => usize::from(n),
            n => return Err(report.broken(Clause::Ranges, WHOLE, "dimension 2 or 3", n)),
        };
        let ask = |cell: CellId| {
            Cell::of(source, cell).map_err(|_| report.broken(Clause::Done, of_cell(cell), "answers", "an error"))
        };
        let ids = || (0..source.n_cells() as u32).map(CellId);
        let cells = ids().map(ask).collect::<Result<_, _>>()?;
        let objects = (0..source.n_objects() as u32).map(|object| source.object_box(ObjectId(object)));
        let objects: Result<_, _> = objects.collect();
        let objects = objects.map_err(|_| report.broken(Clause::Done, WHOLE, "boxes of objects", "an error"))?;
        let answers = Self { n_corners, cells, objects };
        for (cell, first) in ids().zip(&answers.cells) {
            answers.check_cell(cell, first, report)?;
            if ask(cell)? != *first {
                return Err(report.broken(Clause::Repeatable, of_cell(cell), "the first answers again", "others"));
            }
        }
        if let Some(object) = answers.objects.iter().find(|b| !is_box(b)) {
            return Err(report.broken(Clause::Shapes, WHOLE, "boxes of objects", format!("{object:?}")));
        }
        Ok(answers)
    }

    pub(super) fn count(&self, report: &mut Report) {
        report.count("cells", self.cells.len());
        report.count("objects", self.objects.len());
        for cell in &self.cells {
            report.count("visible cells", cell.visible.len());
            report.count("portals of cells", cell.edges.len());
            report.count("visible objects", cell.seen.len());
            report.count("mirrors", cell.mirrors.len());
        }
    }

    fn check_cell(&self, id: CellId, cell: &Cell, report: &Report) -> Result<(), Violation> {
        let check = |clause, holds: bool, expected: &str, found: &dyn Debug| {
            if holds { Ok(()) } else { Err(report.broken(clause, of_cell(id), expected, format!("{found:?}"))) }
        };
        let portals: Vec<(PortalId, bool)> = cell.edges.iter().map(|edge| (edge.portal, !edge.forward)).collect();
        check(Clause::Ordered, ascends(&cell.visible), "ascending visible cells", &cell.visible)?;
        check(Clause::Ordered, cell.visible.contains(&id), "itself among visible cells", &cell.visible)?;
        check(Clause::Ordered, ascends(&cell.touching), "ascending objects that touch it", &cell.touching)?;
        check(Clause::Ordered, ascends(&cell.seen), "ascending visible objects", &cell.seen)?;
        check(Clause::Ordered, ascends(&portals), "ascending portals", &portals)?;
        check(Clause::Ordered, ascends(&cell.roots), "ascending roots of stab trees", &cell.roots)?;
        let has_cell = |cell: &CellId| cell.idx() < self.cells.len();
        let has_object = |object: &ObjectId| object.idx() < self.objects.len();
        check(Clause::Ranges, cell.visible.iter().all(has_cell), "visible cells that exist", &cell.visible)?;
        check(Clause::Ranges, cell.edges.iter().all(|e| has_cell(&e.to)), "portals to cells that exist", &cell.edges)?;
        check(Clause::Ranges, cell.touching.iter().all(has_object), "objects that exist", &cell.touching)?;
        check(Clause::Ranges, cell.seen.iter().all(has_object), "visible objects that exist", &cell.seen)?;
        check(Clause::Shapes, is_box(&cell.bounds), "a box", &cell.bounds)?;
        let is_shape = |corners: &Vec<[f64; 3]>| {
            let has_enough = if self.n_corners == 2 { corners.len() == 2 } else { corners.len() >= 3 };
            has_enough && corners.iter().flatten().all(|x| x.is_finite())
        };
        let mut shapes = cell.edges.iter().map(|e| &e.corners).chain(cell.mirrors.iter().map(|(_, corners)| corners));
        let wrong = shapes.find(|corners| !is_shape(corners));
        check(Clause::Shapes, wrong.is_none(), "enough finite corners", &wrong)?;
        let inside =
            |p: &&[f64; 3]| (0..self.n_corners).all(|k| cell.bounds.min[k] <= p[k] && p[k] <= cell.bounds.max[k]);
        let outside = cell.edges.iter().flat_map(|e| &e.corners).find(|p| !inside(p));
        check(Clause::Shapes, outside.is_none(), "portals within its box", &outside)
    }

    /// Portals lead both ways.
    pub(super) fn check_edges(&self, report: &Report) -> Result<(), Violation> {
        for (cell, answers) in (0u32..).map(CellId).zip(&self.cells) {
            let broken = |expected, edge| {
                Err(report.broken(Clause::TwoSided, of_cell(cell), expected, format!("only {edge:?}")))
            };
            for edge in &answers.edges {
                let back = Edge { forward: !edge.forward, to: cell, ..edge.clone() };
                if !self.cells[edge.to.idx()].edges.contains(&back) {
                    return broken("a portal that leads back", edge);
                }
                if answers.visible.binary_search(&edge.to).is_err() {
                    return broken("to see the cell behind a portal", edge);
                }
            }
        }
        Ok(())
    }

    /// Stab trees follow portals.
    pub(super) fn check_trees<S: CellSource>(&self, source: &S, report: &mut Report) -> Result<(), Violation> {
        let has_trees = |cell: &&Cell| cell.is_root_open.is_some();
        let n_trees = self.cells.iter().filter(has_trees).count();
        if ![0, self.cells.len()].contains(&n_trees) {
            return Err(report.broken(Clause::Trees, WHOLE, "stab trees of all cells or of none", n_trees));
        }
        for (root, answers) in (0u32..).map(CellId).zip(&self.cells).filter(|(_, cell)| has_trees(cell)) {
            let mut stack: Vec<(CellId, u32)> = answers.roots.iter().map(|&node| (root, node)).collect();
            while let Some((cell, node)) = stack.pop() {
                if report["nodes of stab trees"] == MOST_NODES {
                    return Ok(());
                }
                report.count("nodes of stab trees", 1);
                let broken = |clause, expected: &str, found: String| {
                    report.broken(clause, format!("{} of the stab tree of {root}", of_cell(cell)), expected, found)
                };
                let mut children = vec![u32::MAX; 3];
                let step = source.stab_node(node, &mut children);
                let step = step.map_err(|_| broken(Clause::Done, "a node", "an error".to_owned()))?;
                let edge = self.cells[cell.idx()].edges.iter().find(|edge| edge.portal == step.portal);
                let Some(edge) = edge else {
                    return Err(broken(Clause::Trees, "a portal of the cell", format!("portal {}", step.portal)));
                };
                if !ascends(&children) {
                    return Err(broken(Clause::Trees, "ascending children", format!("{children:?}")));
                }
                stack.extend(children.into_iter().map(|child| (edge.to, child)));
            }
        }
        Ok(())
    }

    /// Nothing that may be seen is missing, and everything else is the same.
    pub(super) fn compare(&self, truth: &Self, report: &mut Report) -> Result<(), Violation> {
        let sizes = |answers: &Self| (answers.n_corners, answers.cells.len(), answers.objects.len());
        if sizes(self) != sizes(truth) || self.objects != truth.objects {
            let expected = "the dimension, cells and objects of the reference";
            return Err(report.broken(Clause::Conservative, WHOLE, expected, "others"));
        }
        for (cell, (own, truth)) in (0u32..).map(CellId).zip(self.cells.iter().zip(&truth.cells)) {
            report.count("cells compared", 1);
            let broken = |expected, found| Err(report.broken(Clause::Conservative, of_cell(cell), expected, found));
            let same = (own.bounds, &own.edges, &own.touching, &own.mirrors)
                == (truth.bounds, &truth.edges, &truth.touching, &truth.mirrors);
            if !same {
                return broken("the cell of the reference", "another");
            }
            let cells = truth.visible.iter().all(|other| own.visible.binary_search(other).is_ok());
            if !cells || !truth.seen.iter().all(|object| own.seen.binary_search(object).is_ok()) {
                return broken("all that it sees in the reference", "less");
            }
        }
        Ok(())
    }
}

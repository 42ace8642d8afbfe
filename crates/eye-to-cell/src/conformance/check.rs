//! What a source answers, and what has to hold of it.

use super::{Clause, Report, Violation};
use crate::{CellSource, MirrorPiece, PortalEdge};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, MirrorId, ObjectId, PortalId};

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

fn wrong(clause: Clause, cell: CellId, what: &'static str) -> Violation {
    Violation::Cell { clause, cell, what }
}

fn whole(clause: Clause, what: &'static str) -> Violation {
    Violation::Whole { clause, what }
}

fn unreadable<E>(_: E) -> Violation {
    whole(Clause::Readable, "the source gave an error")
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

impl Answers {
    /// Asks about everything, twice, and checks what can be checked cell by cell.
    pub(super) fn of<S: CellSource>(source: &S, report: &mut Report) -> Result<Self, Violation> {
        let n_corners = match source.dimension() {
            2 => 2,
            3 => 3,
            _ => return Err(whole(Clause::Ranges, "the dimension is neither 2 nor 3")),
        };
        let ids = || (0..source.n_cells() as u32).map(CellId);
        let cells: Vec<Cell> =
            ids().map(|cell| Cell::of(source, cell)).collect::<Result<_, _>>().map_err(unreadable)?;
        let objects = (0..source.n_objects() as u32).map(|object| source.object_box(ObjectId(object)));
        let objects: Vec<Aabb<3>> = objects.collect::<Result<_, _>>().map_err(unreadable)?;
        let answers = Self { n_corners, cells, objects };
        for (cell, first) in ids().zip(&answers.cells) {
            answers.check_cell(cell, first)?;
            if Cell::of(source, cell).map_err(unreadable)? != *first {
                return Err(wrong(Clause::Repeatable, cell, "another answer the second time"));
            }
            report.visible += first.visible.len();
            report.edges += first.edges.len();
            report.objects_seen += first.seen.len();
            report.mirrors += first.mirrors.len();
        }
        if !answers.objects.iter().all(is_box) {
            return Err(whole(Clause::Shapes, "the box of an object is none"));
        }
        (report.cells, report.objects) = (answers.cells.len(), answers.objects.len());
        Ok(answers)
    }

    fn check_cell(&self, id: CellId, cell: &Cell) -> Result<(), Violation> {
        let check = |clause, holds: bool, what| if holds { Ok(()) } else { Err(wrong(clause, id, what)) };
        let portals: Vec<(PortalId, bool)> = cell.edges.iter().map(|edge| (edge.portal, !edge.forward)).collect();
        check(Clause::Ordered, ascends(&cell.visible), "visible cells do not ascend")?;
        check(Clause::Ordered, cell.visible.contains(&id), "it does not see itself")?;
        check(Clause::Ordered, ascends(&cell.touching) && ascends(&cell.seen), "objects do not ascend")?;
        check(Clause::Ordered, ascends(&portals), "portals do not ascend")?;
        check(Clause::Ordered, ascends(&cell.roots), "roots of stab trees do not ascend")?;
        let has_cell = |cell: &CellId| cell.idx() < self.cells.len();
        let has_object = |object: &ObjectId| object.idx() < self.objects.len();
        check(Clause::Ranges, cell.visible.iter().all(has_cell), "it sees a cell that does not exist")?;
        check(Clause::Ranges, cell.edges.iter().all(|e| has_cell(&e.to)), "a portal leads nowhere")?;
        check(
            Clause::Ranges,
            cell.touching.iter().chain(&cell.seen).all(has_object),
            "it sees or touches an object that does not exist",
        )?;
        check(Clause::Shapes, is_box(&cell.bounds), "its box is none")?;
        let is_shape = |corners: &[[f64; 3]]| {
            let has_enough = if self.n_corners == 2 { corners.len() == 2 } else { corners.len() >= 3 };
            has_enough && corners.iter().flatten().all(|x| x.is_finite())
        };
        let shapes = cell.edges.iter().map(|e| &e.corners).chain(cell.mirrors.iter().map(|(_, corners)| corners));
        check(Clause::Shapes, shapes.clone().all(|corners| is_shape(corners)), "corners are missing or not finite")?;
        let inside =
            |p: &[f64; 3]| (0..self.n_corners).all(|k| cell.bounds.min[k] <= p[k] && p[k] <= cell.bounds.max[k]);
        check(Clause::Shapes, cell.edges.iter().flat_map(|e| &e.corners).all(inside), "a portal reaches out of its box")
    }

    /// Portals lead both ways.
    pub(super) fn check_edges(&self) -> Result<(), Violation> {
        for (cell, answers) in (0u32..).map(CellId).zip(&self.cells) {
            for edge in &answers.edges {
                let back = Edge { forward: !edge.forward, to: cell, ..edge.clone() };
                if !self.cells[edge.to.idx()].edges.contains(&back) {
                    return Err(wrong(Clause::TwoSided, cell, "a portal does not lead back"));
                }
                if answers.visible.binary_search(&edge.to).is_err() {
                    return Err(wrong(Clause::TwoSided, cell, "it does not see the cell behind a portal"));
                }
            }
        }
        Ok(())
    }

    /// Stab trees follow portals.
    pub(super) fn check_trees<S: CellSource>(&self, source: &S, report: &mut Report) -> Result<(), Violation> {
        let has_trees = |cell: &Cell| cell.is_root_open.is_some();
        if self.cells.iter().any(has_trees) != self.cells.iter().all(has_trees) {
            return Err(whole(Clause::Trees, "some cells have stab trees, others do not"));
        }
        for (root, answers) in (0u32..).map(CellId).zip(&self.cells) {
            if !has_trees(answers) {
                continue;
            }
            let mut stack: Vec<(CellId, u32)> = answers.roots.iter().map(|&node| (root, node)).collect();
            while let Some((cell, node)) = stack.pop() {
                if report.nodes == MOST_NODES {
                    return Ok(());
                }
                report.nodes += 1;
                let mut children = vec![u32::MAX; 3];
                let step = source.stab_node(node, &mut children).map_err(unreadable)?;
                let edge = self.cells[cell.idx()].edges.iter().find(|edge| edge.portal == step.portal);
                let Some(edge) = edge else {
                    return Err(wrong(Clause::Trees, root, "its stab tree crosses a portal of another cell"));
                };
                if !ascends(&children) {
                    return Err(wrong(Clause::Trees, root, "children in its stab tree do not ascend"));
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
            return Err(whole(Clause::Conservative, "dimension, cells or objects are not those of the reference"));
        }
        for (cell, (own, truth)) in (0u32..).map(CellId).zip(self.cells.iter().zip(&truth.cells)) {
            report.compared += 1;
            let same = (own.bounds, &own.edges, &own.touching, &own.mirrors)
                == (truth.bounds, &truth.edges, &truth.touching, &truth.mirrors);
            if !same {
                return Err(wrong(Clause::Conservative, cell, "it is another cell than that of the reference"));
            }
            let cells = truth.visible.iter().all(|other| own.visible.binary_search(other).is_ok());
            if !cells || !truth.seen.iter().all(|object| own.seen.binary_search(object).is_ok()) {
                return Err(wrong(Clause::Conservative, cell, "something that it sees is missing"));
            }
        }
        Ok(())
    }
}

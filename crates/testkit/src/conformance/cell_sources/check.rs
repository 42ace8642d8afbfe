//! What a source answers, and what has to hold of it.

use super::{Clause, Report, Violation};
use sightlines_eye_to_cell::{CellSource, MirrorPiece, PortalEdge};
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
    dimension: usize,
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
        let error = |_: S::Error| report.broken(Clause::Done, WHOLE, "answers", "an error");
        let dimension = usize::from(source.dimension());
        report.check((2..=3).contains(&dimension), Clause::Ranges, WHOLE, "dimension 2 or 3", dimension)?;
        let ask = |cell| Cell::of(source, cell).map_err(error);
        let cells = (0..source.n_cells() as u32).map(|cell| ask(CellId(cell))).collect::<Result<_, _>>()?;
        let object = |object| source.object_box(ObjectId(object)).map_err(error);
        let objects = (0..source.n_objects() as u32).map(object).collect::<Result<_, _>>()?;
        let answers = Self { dimension, cells, objects };
        for (id, cell) in answers.cells() {
            answers.check_cell(id, cell, report)?;
            let is_same = ask(id)? == *cell;
            report.check(is_same, Clause::Repeatable, of_cell(id), "the first answers again", "others")?;
        }
        let wrong = answers.objects.iter().find(|b| !is_box(b));
        report.check(wrong.is_none(), Clause::Shapes, WHOLE, "boxes of objects", format_args!("{wrong:?}"))?;
        Ok(answers)
    }

    fn cells(&self) -> impl Iterator<Item = (CellId, &Cell)> {
        (0u32..).map(CellId).zip(&self.cells)
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
        let Cell { bounds, visible, edges, touching, seen, mirrors, roots, .. } = cell;
        let portals: Vec<(PortalId, bool)> = edges.iter().map(|edge| (edge.portal, !edge.forward)).collect();
        let has_cell = |cell: &CellId| cell.idx() < self.cells.len();
        let has_object = |object: &ObjectId| object.idx() < self.objects.len();
        let is_shape = |corners: &Vec<[f64; 3]>| {
            let has_enough = if self.dimension == 2 { corners.len() == 2 } else { corners.len() >= 3 };
            has_enough && corners.iter().flatten().all(|x| x.is_finite())
        };
        let mut shapes = edges.iter().map(|edge| &edge.corners).chain(mirrors.iter().map(|(_, corners)| corners));
        let is_inside = |p: &[f64; 3]| (0..self.dimension).all(|k| bounds.min[k] <= p[k] && p[k] <= bounds.max[k]);
        let checks = [
            (Clause::Ordered, ascends(visible), "ascending visible cells"),
            (Clause::Ordered, visible.contains(&id), "itself among visible cells"),
            (Clause::Ordered, ascends(touching) && ascends(seen), "ascending objects"),
            (Clause::Ordered, ascends(&portals), "ascending portals"),
            (Clause::Ordered, ascends(roots), "ascending roots of stab trees"),
            (Clause::Ranges, visible.iter().all(has_cell), "visible cells that exist"),
            (Clause::Ranges, edges.iter().all(|edge| has_cell(&edge.to)), "portals to cells that exist"),
            (Clause::Ranges, touching.iter().chain(seen).all(has_object), "objects that exist"),
            (Clause::Shapes, is_box(bounds), "a box"),
            (Clause::Shapes, shapes.all(is_shape), "enough finite corners"),
            (Clause::Shapes, edges.iter().flat_map(|edge| &edge.corners).all(is_inside), "portals within its box"),
        ];
        let check =
            |(clause, holds, expected)| report.check(holds, clause, of_cell(id), expected, format_args!("{cell:?}"));
        checks.into_iter().try_for_each(check)
    }

    /// Portals lead both ways.
    pub(super) fn check_edges(&self, report: &Report) -> Result<(), Violation> {
        for (id, cell) in self.cells() {
            let check = |holds, expected| report.check(holds, Clause::TwoSided, of_cell(id), expected, "none");
            for edge in &cell.edges {
                let back = Edge { forward: !edge.forward, to: id, ..edge.clone() };
                let leads_back = self.cells[edge.to.idx()].edges.contains(&back);
                check(leads_back, format!("the other side of {edge:?}"))?;
                check(cell.visible.contains(&edge.to), format!("sight through {edge:?}"))?;
            }
        }
        Ok(())
    }

    /// Stab trees follow portals.
    pub(super) fn check_trees<S: CellSource>(&self, source: &S, report: &mut Report) -> Result<(), Violation> {
        let n_trees = self.cells.iter().filter(|cell| cell.is_root_open.is_some()).count();
        let is_fair = [0, self.cells.len()].contains(&n_trees);
        report.check(is_fair, Clause::Trees, WHOLE, "stab trees of all cells or of none", n_trees)?;
        for (root, answers) in self.cells().take(n_trees) {
            let case = format!("the stab tree of cell {root}");
            let mut stack: Vec<(CellId, u32)> = answers.roots.iter().map(|&node| (root, node)).collect();
            while let Some((cell, node)) = stack.pop() {
                if report["nodes of stab trees"] == MOST_NODES {
                    return Ok(());
                }
                report.count("nodes of stab trees", 1);
                let mut children = vec![u32::MAX; 3];
                let step = source.stab_node(node, &mut children);
                let step = step.map_err(|_| report.broken(Clause::Done, &case, "a node", "an error"))?;
                let edge = self.cells[cell.idx()].edges.iter().find(|edge| edge.portal == step.portal);
                let edge = edge.ok_or_else(|| {
                    report.broken(Clause::Trees, &case, format_args!("a portal of cell {cell}"), step.portal)
                })?;
                let found = format_args!("{children:?}");
                report.check(ascends(&children), Clause::Trees, &case, "ascending children", found)?;
                stack.extend(children.into_iter().map(|child| (edge.to, child)));
            }
        }
        Ok(())
    }

    /// Nothing that may be seen is missing, and everything else is the same.
    pub(super) fn compare(&self, truth: &Self, report: &mut Report) -> Result<(), Violation> {
        let whole = |answers: &Self| (answers.dimension, answers.cells.len(), answers.objects.clone());
        let is_same = whole(self) == whole(truth);
        report.check(
            is_same,
            Clause::Conservative,
            WHOLE,
            "dimension, cells and objects of the reference",
            "others",
        )?;
        for ((id, own), truth) in self.cells().zip(&truth.cells) {
            report.count("cells compared", 1);
            let same = (own.bounds, &own.edges, &own.touching, &own.mirrors)
                == (truth.bounds, &truth.edges, &truth.touching, &truth.mirrors);
            report.check(same, Clause::Conservative, of_cell(id), "the cell of the reference", "another")?;
            let sees_all = truth.visible.iter().all(|cell| own.visible.contains(cell))
                && truth.seen.iter().all(|object| own.seen.contains(object));
            report.check(sees_all, Clause::Conservative, of_cell(id), "all that it sees in the reference", "less")?;
        }
        Ok(())
    }
}

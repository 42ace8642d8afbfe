//! Why one cell sees another, or why it does not.

use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;
use sightlines_bake::TableGraph;
use sightlines_bake::lines::ends_in_plan;
use sightlines_cells::{CellGraph, CellId, Convex, Planar, PortalId};
use sightlines_pvs::Table;
use sightlines_sightline::{Branch, Verdict};
use sightlines_stabtree::{
    Barrier, BlockedSequence, ConvexPath, MOST_EXPLAINED, PlanarPath, Sight, AxialPath, AxialProof, explain as in_plan,
    explain_convex, explain_axial,
};

/// After so many cells entered in a plan, and linear programs in space, a pair is given up.
const MAX_VISITS: u64 = 20_000_000;
const MAX_PROGRAMS: u32 = 20_000;
/// Blocked ways that are kept.
const MAX_BLOCKED: usize = 8;

/// What was found about two cells.
#[pyclass(frozen, module = "sightlines._native")]
pub(crate) struct Explanation {
    dimension: usize,
    found: Found,
}

#[derive(Default)]
struct Found {
    visible: Option<bool>,
    text: String,
    /// Two points of a line, along the axes of the scene.
    line: Option<[[f64; 3]; 2]>,
    cells: Vec<u32>,
    portals: Vec<u32>,
    blocked: Vec<Vec<u32>>,
    /// Boxes along the axes of the table.
    walls: Vec<[[f64; 3]; 2]>,
}

#[pymethods]
impl Explanation {
    /// `None` if it was not decided.
    #[getter]
    fn visible(&self) -> Option<bool> {
        self.found.visible
    }

    #[getter]
    fn text(&self) -> &str {
        &self.found.text
    }

    fn line<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let d = self.dimension;
        let flat = |line: [[f64; 3]; 2]| line.into_iter().flat_map(|p| p.into_iter().take(d)).collect();
        self.found.line.map(|line| crate::arrays::matrix(py, flat(line), [2, d])).transpose()
    }

    /// The cells that the line passes, in order.
    #[getter]
    fn cells(&self) -> Vec<u32> {
        self.found.cells.clone()
    }

    /// The portals between them.
    #[getter]
    fn portals(&self) -> Vec<u32> {
        self.found.portals.clone()
    }

    /// Sequences of portals that no line passes.
    #[getter]
    fn blocked(&self) -> Vec<Vec<u32>> {
        self.found.blocked.clone()
    }

    /// Walls of which every line meets one, as boxes.
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let flat: Vec<f64> = self.found.walls.iter().flatten().flatten().copied().collect();
        crate::arrays::cube(py, flat, [self.found.walls.len(), 2, 3])
    }
}

/// Explains two cells of a table by its graph.
pub(crate) fn explain(table: &Table, graph: Option<&TableGraph>, [a, b]: [CellId; 2]) -> Explanation {
    let mut found = if a == b {
        Found { visible: Some(true), text: format!("both are cell {a}, and a cell sees itself"), ..Found::default() }
    } else {
        match graph {
            Some(TableGraph::Planar(graph)) => plan(graph, [a, b]),
            Some(TableGraph::Axial(graph)) => {
                found([a, b], explain_axial(graph, &[], a, b, MAX_PROGRAMS), |path| space_line(a, path), space_walls)
            }
            Some(TableGraph::Convex(graph)) => convex(graph, [a, b]),
            Some(TableGraph::Boxes(_)) => silent([a, b], table, "the cells of this table have no portals"),
            None => silent([a, b], table, "this table does not have the shapes of its cells and portals"),
        }
    };
    if let (Some(line), Some(frame)) = (&mut found.line, table.frame()) {
        *line = line.map(|p| frame.to_scene(p));
    }
    if let Some([p, q]) = found.line {
        let d = usize::from(table.dimension());
        let place = |p: [f64; 3]| p.iter().take(d).map(ToString::to_string).collect::<Vec<_>>().join(", ");
        found.text.push_str(&format!(", along the line from ({}) to ({})", place(p), place(q)));
    }
    Explanation { dimension: usize::from(table.dimension()), found }
}

fn silent([a, b]: [CellId; 2], table: &Table, why: &str) -> Found {
    let listed = if table.sees(a, b) { "may see" } else { "does not see" };
    Found {
        text: format!("by the table, cell {a} {listed} cell {b}; {why}, so there is no reason"),
        ..Found::default()
    }
}

fn numbers(portals: &[PortalId]) -> Vec<u32> {
    portals.iter().map(|portal| portal.0).collect()
}

fn found<Path, Proof, Doubt>(
    [a, b]: [CellId; 2],
    explanation: Verdict<Sight<Path>, Barrier<Proof>, Doubt>,
    line: impl FnOnce(Path) -> Found,
    proof: impl FnOnce(Proof) -> Found,
) -> Found {
    match explanation {
        Verdict::Visible(Sight::SameCell) => Found { visible: Some(true), ..Found::default() },
        Verdict::Visible(Sight::Along(path)) => {
            let found = line(path);
            let n = match found.portals.len() {
                1 => "1 portal".to_owned(),
                n => format!("{n} portals"),
            };
            Found { visible: Some(true), text: format!("cell {a} sees cell {b} through {n}"), ..found }
        }
        Verdict::Hidden(Barrier::NotConnected) => {
            let text = format!("cell {a} does not see cell {b}: no way through portals joins them");
            Found { visible: Some(false), text, ..Found::default() }
        }
        Verdict::Hidden(Barrier::Blocked(why)) => {
            let found = proof(why);
            let text = format!("cell {a} does not see cell {b}: {}", found.text);
            Found { visible: Some(false), text, ..found }
        }
        Verdict::Undecided(_) => {
            let text = format!("cell {a} and cell {b}: given up, neither a line nor a proof was found");
            Found { text, ..Found::default() }
        }
    }
}

fn blocked_ways(n: u64, blocked: Vec<Vec<u32>>) -> Found {
    let text = format!("every way passes one of {n} sequences of portals that no line passes");
    Found { text, blocked, ..Found::default() }
}

fn plan(graph: &CellGraph<Planar>, [a, b]: [CellId; 2]) -> Found {
    let line = |path: PlanarPath| {
        let mut cells = vec![a];
        for portal in &path.portals {
            let [one, other] = graph.portal(*portal).cells;
            cells.push(if cells.last() == Some(&one) { other } else { one });
        }
        let polygons = [a, b].map(|cell| &graph.cell(cell).polygon[..]);
        let ends = ends_in_plan(polygons, &path.doors, &path.witness);
        Found {
            line: ends.map(|ends| ends.map(|p| [p.x, p.y, 0.0])),
            cells: cells.iter().map(|cell| cell.0).collect(),
            portals: numbers(&path.portals),
            ..Found::default()
        }
    };
    found([a, b], in_plan(graph, a, b, MAX_BLOCKED, MAX_VISITS), line, |proof| {
        let ways = proof.blocked.iter().map(|BlockedSequence { portals, .. }| numbers(portals));
        blocked_ways(proof.n_blocked, ways.collect())
    })
}

fn space_line(from: CellId, path: AxialPath) -> Found {
    // Without points in the cells, those in the first and the last portal.
    let crossing = |k: usize| path.witness.crossing(path.doors.get(k)?);
    let line = path.ends.or_else(|| Some([crossing(0)?, crossing(path.doors.len().checked_sub(1)?)?]));
    let cells = std::iter::once(from).chain(path.cells).map(|cell| cell.0).collect();
    Found { line, cells, portals: numbers(&path.portals), ..Found::default() }
}

fn space_walls(AxialProof { proof, walls, .. }: AxialProof) -> Found {
    fn count(branch: &Branch, n: &mut [usize]) {
        if let Branch::Past { rectangle, ways, .. } = branch {
            n[*rectangle as usize] += 1;
            ways.iter().for_each(|(_, branch)| count(branch, n));
        }
    }
    let mut n = vec![0; walls.len()];
    proof.octants.iter().for_each(|(_, branch)| count(branch, &mut n));
    let mut order: Vec<usize> = (0..walls.len()).collect();
    order.sort_by_key(|&k| std::cmp::Reverse(n[k]));
    let text = match walls.len() {
        1 => "every line meets one wall".to_owned(),
        n => format!("every line meets one of {n} walls"),
    };
    let walls = order.into_iter().map(|k| [walls[k].min, walls[k].max]).collect();
    Found { text, walls, ..Found::default() }
}

fn convex(graph: &CellGraph<Convex>, [a, b]: [CellId; 2]) -> Found {
    let line = |ConvexPath { gates, line }: ConvexPath| {
        let first = gates.iter().take(1).map(|gate| gate.cells(graph)[0]);
        let cells = first.chain(gates.iter().map(|gate| gate.cells(graph)[1])).map(|cell| cell.0).collect();
        let portals = gates.iter().map(|gate| gate.portal.0).collect();
        Found { line: Some([line.a, line.b]), cells, portals, ..Found::default() }
    };
    found([a, b], explain_convex(graph, a, b, MOST_EXPLAINED), line, |proof| {
        let ways = proof.blocked.iter().map(|way| way.gates.iter().map(|gate| gate.portal.0).collect());
        blocked_ways(proof.blocked.len() as u64, ways.take(MAX_BLOCKED).collect())
    })
}

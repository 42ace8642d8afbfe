//! Why one cell sees another, or why it does not.

use numpy::{PyArray2, PyArray3};
use pyo3::prelude::*;
use sightlines_bake::TableGraph;
use sightlines_bake::explain::{Answer, ExactLine, ExplainError, ExplainOptions, Explainer, Reason, SightLine};
use sightlines_cells::{CellId, PortalId, Scene};
use sightlines_pvs::Table;

/// What was found about two cells.
#[pyclass(frozen, module = "sightlines._native")]
#[derive(Default)]
pub(crate) struct Explanation {
    /// `None` if it was not decided.
    #[pyo3(get)]
    visible: Option<bool>,
    #[pyo3(get)]
    text: String,
    /// Two points of a line, along the axes of the scene.
    line: Option<[[f64; 3]; 2]>,
    /// The cells that the line passes, in order.
    #[pyo3(get)]
    cells: Vec<u32>,
    /// The portals between them.
    #[pyo3(get)]
    portals: Vec<u32>,
    /// Sequences of portals that no line passes.
    #[pyo3(get)]
    blocked: Vec<Vec<u32>>,
    /// Boxes along the axes of the table, of which every line meets one.
    walls: Vec<[[f64; 3]; 2]>,
    dimension: usize,
}

#[pymethods]
impl Explanation {
    fn line<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let d = self.dimension;
        let flat = |line: [[f64; 3]; 2]| line.into_iter().flat_map(|p| p.into_iter().take(d)).collect();
        self.line.map(|line| crate::arrays::matrix(py, flat(line), [2, d])).transpose()
    }

    /// Walls of which every line meets one, as boxes.
    fn walls<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let flat: Vec<f64> = self.walls.iter().flatten().flatten().copied().collect();
        crate::arrays::cube(py, flat, [self.walls.len(), 2, 3])
    }
}

/// Explains two cells of a table by its graph, or by the scene that it was made of if they have no portals.
pub(crate) fn explain(
    table: &Table,
    graph: Option<&TableGraph>,
    scene: Option<&Scene>,
    [a, b]: [CellId; 2],
) -> Result<Explanation, ExplainError> {
    let options = ExplainOptions::default();
    let mut found = match (graph, graph.and_then(Explainer::new)) {
        _ if a == b => of_answer([a, b], Answer::Same),
        (_, Some(explainer)) => of_answer([a, b], explainer.explain([a, b], &options).answer),
        (None, None) => {
            silent([a, b], table, "why is not known: the table does not have the shapes of its cells and portals")
        }
        (Some(_), None) if scene.is_none() => {
            let why = "its cells have no portals to look through: with scene=, the file that it was made of, rays look for a line";
            silent([a, b], table, why)
        }
        (Some(_), None) => of_answer([a, b], sightlines_bake::explain::explain(table, scene, [a, b], &options)?.answer),
    };
    if let (Some(line), Some(frame)) = (&mut found.line, table.frame()) {
        *line = line.map(|p| frame.to_scene(p));
    }
    if let Some([p, q]) = found.line {
        let d = usize::from(table.dimension());
        let place = |p: [f64; 3]| p.iter().take(d).map(ToString::to_string).collect::<Vec<_>>().join(", ");
        found.text.push_str(&format!(", along the line from ({}) to ({})", place(p), place(q)));
    }
    Ok(Explanation { dimension: usize::from(table.dimension()), ..found })
}

fn silent([a, b]: [CellId; 2], table: &Table, why: &str) -> Explanation {
    let listed = if table.sees(a, b) { "may see" } else { "does not see" };
    Explanation { text: format!("by the table, cell {a} {listed} cell {b}; {why}"), ..Explanation::default() }
}

fn numbers(portals: &[PortalId]) -> Vec<u32> {
    portals.iter().map(|portal| portal.0).collect()
}

fn of_answer([a, b]: [CellId; 2], answer: Answer) -> Explanation {
    let visible = answer.verdict();
    match answer {
        Answer::Same => Explanation {
            visible,
            text: format!("both are cell {a}, and a cell sees itself"),
            ..Explanation::default()
        },
        Answer::Visible(SightLine { cells, portals, ends }, exact) => {
            let through = match (&exact, portals.len()) {
                (ExactLine::Segment, _) => String::new(),
                (_, 1) => " through 1 portal".to_owned(),
                (_, n) => format!(" through {n} portals"),
            };
            let line = match exact {
                ExactLine::Convex(points, _) => Some(points),
                // Without points in the cells, those in the first and the last portal.
                _ => ends.or_else(|| exact.outer_crossings()),
            };
            Explanation {
                visible,
                text: format!("cell {a} sees cell {b}{through}"),
                line,
                cells: cells.iter().map(|cell| cell.0).collect(),
                portals: numbers(&portals),
                ..Explanation::default()
            }
        }
        Answer::Hidden(reason) => {
            let (why, blocked, walls) = of_reason(&reason);
            Explanation {
                visible,
                text: format!("cell {a} does not see cell {b}: {why}"),
                blocked,
                walls,
                ..Explanation::default()
            }
        }
        Answer::GivenUp(_) | Answer::Undecided(_) => {
            let text = format!("cell {a} and cell {b}: given up, neither a line nor a proof was found");
            Explanation { text, ..Explanation::default() }
        }
        Answer::Unknown { n_rays, hidden_by } => {
            let n = n_rays.unwrap_or_default();
            let by =
                if hidden_by.is_empty() { String::new() } else { format!("; hidden by {}", hidden_by.join(" or ")) };
            let text = format!(
                "cell {a} and cell {b}: {n} rays from each found no line between them, which proves nothing{by}"
            );
            Explanation { text, ..Explanation::default() }
        }
    }
}

/// A text, sequences of portals, and rectangles.
type Said = (String, Vec<Vec<u32>>, Vec<[[f64; 3]; 2]>);

/// In words, with the blocked ways or the walls as boxes.
fn of_reason(reason: &Reason) -> Said {
    match reason {
        Reason::NotConnected => ("no way through portals joins them".to_owned(), Vec::new(), Vec::new()),
        Reason::Blocked { n_blocked, blocked, .. } => {
            let text = format!("every way passes one of {n_blocked} sequences of portals that no line passes");
            (text, blocked.iter().map(|blocked| numbers(&blocked.way.portals)).collect(), Vec::new())
        }
        Reason::Walls(found) => {
            let text = match found.walls.len() {
                1 => "every line meets one wall".to_owned(),
                n => format!("every line meets one of {n} walls"),
            };
            let walls = found.most_important();
            (text, Vec::new(), walls.iter().map(|(wall, _)| [wall.min, wall.max]).collect())
        }
    }
}

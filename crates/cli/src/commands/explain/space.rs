//! The answer of `explain` in space, for people and for programs.

use crate::output::count;
use serde::Serialize;
use serde_json::{Value, json};
use sightlines::cells::CellId;
use sightlines::geometry::{Aabb, AxialDoor};
use sightlines::sightline::{AxialWitness, BlockedProof, Branch, BranchRow, Bypass, Contradiction, ProofSize};
use sightlines::stabtree::SpaceExplanation;
use std::fmt;

/// The explanation of two cells in space.
#[derive(Debug, Serialize)]
pub(crate) struct ToldInSpace {
    from: u32,
    to: u32,
    /// What the table says of the two.
    listed: bool,
    #[serde(flatten)]
    reason: Reason,
    /// How many walls are shown to people; programs get them all.
    #[serde(skip)]
    n_shown: usize,
}

#[derive(Debug, Serialize)]
#[serde(tag = "answer", rename_all = "lowercase")]
enum Reason {
    /// They are one cell.
    Same,
    Visible {
        portals: Vec<u32>,
        /// The cells entered, one for each portal.
        cells: Vec<u32>,
        /// Where the line crosses each portal, rounded.
        points: Vec<Option<[f64; 3]>>,
        /// Two points of the line, in the first cell and in the last.
        ends: Option<[[f64; 3]; 2]>,
        line: Box<Line>,
    },
    Hidden {
        /// Whether portals lead from one to the other; if not, that is the reason.
        connected: bool,
        #[serde(flatten)]
        walls: Option<Box<Walls>>,
    },
    /// The search was given up.
    Unknown { max_programs: u32 },
}

/// A point of a line and its direction, exactly, as fractions.
#[derive(Debug, Serialize)]
struct Line {
    point: [String; 3],
    direction: [String; 3],
}

/// What stops all lines.
#[derive(Debug, Serialize)]
struct Walls {
    /// Rectangles that all walls between cells were put together to.
    n_blockers: usize,
    /// Rectangles gone past in the proof, each as often as that happens.
    n_nodes: usize,
    /// Contradictions that end the proof's branches.
    n_contradictions: usize,
    /// Most rectangles gone past one after the other.
    depth: usize,
    walls: Vec<Wall>,
    proof: Value,
}

/// A rectangle in the way.
#[derive(Debug, Serialize)]
struct Wall {
    min: [f64; 3],
    max: [f64; 3],
    /// How often it is gone past in the proof.
    n_nodes: usize,
}

impl ToldInSpace {
    pub(crate) fn new([from, to]: [CellId; 2], explanation: SpaceExplanation, listed: bool, n_shown: usize) -> Self {
        let reason = match explanation {
            SpaceExplanation::Same => Reason::Same,
            SpaceExplanation::Visible { portals, cells, doors, witness, ends } => Reason::Visible {
                portals: portals.iter().map(|p| p.0).collect(),
                cells: cells.iter().map(|c| c.0).collect(),
                points: crossings(&witness, &doors),
                ends,
                line: Box::new(Line {
                    point: witness.point().each_ref().map(ToString::to_string),
                    direction: witness.direction().each_ref().map(ToString::to_string),
                }),
            },
            SpaceExplanation::Hidden { proof, walls, n_blockers } => {
                Reason::Hidden { connected: true, walls: Some(Box::new(Walls::new(&proof, &walls, n_blockers))) }
            }
            SpaceExplanation::NotConnected => Reason::Hidden { connected: false, walls: None },
            SpaceExplanation::Undecided { budget } => Reason::Unknown { max_programs: budget },
        };
        Self { from: from.0, to: to.0, listed, reason, n_shown }
    }

    /// Whether there is a line; what the table says if the search was given up.
    pub(crate) fn is_visible(&self) -> bool {
        match self.reason {
            Reason::Same | Reason::Visible { .. } => true,
            Reason::Hidden { .. } => false,
            Reason::Unknown { .. } => self.listed,
        }
    }
}

fn crossings(witness: &AxialWitness, doors: &[AxialDoor]) -> Vec<Option<[f64; 3]>> {
    doors.iter().map(|door| witness.crossing(door)).collect()
}

impl Walls {
    fn new(proof: &BlockedProof, rectangles: &[Aabb<3>], n_blockers: usize) -> Self {
        let mut n_nodes = vec![0; rectangles.len()];
        proof.octants.iter().for_each(|(_, branch)| count_nodes(branch, &mut n_nodes));
        let wall = |(b, n_nodes): (&Aabb<3>, usize)| Wall { min: b.min, max: b.max, n_nodes };
        let walls = rectangles.iter().zip(n_nodes).map(wall).collect();
        let octant = |(signs, branch): &([bool; 3], Branch)| json!({"forward": signs, "branch": tree(branch)});
        let ProofSize { n_nodes, n_leaves, depth, .. } = proof.size();
        let proof = proof.octants.iter().map(octant).collect();
        Self { n_blockers, n_nodes, n_contradictions: n_leaves, depth, walls, proof }
    }
}

fn count_nodes(branch: &Branch, n_nodes: &mut [usize]) {
    if let Branch::Past { rectangle, ways, .. } = branch {
        n_nodes[*rectangle as usize] += 1;
        ways.iter().for_each(|(_, branch)| count_nodes(branch, n_nodes));
    }
}

/// A branch of a proof for programs.
fn tree(branch: &Branch) -> Value {
    match branch {
        Branch::Empty(terms) => json!({"contradiction": rows(terms)}),
        Branch::Past { rectangle, ways, rest } => {
            let ways: Vec<Value> =
                ways.iter().map(|(w, branch)| json!({"way": way(*w), "branch": tree(branch)})).collect();
            json!({"wall": rectangle, "ways": ways, "rest": rest.as_ref().map(rows)})
        }
    }
}

fn way(way: Bypass) -> Value {
    match way {
        Bypass::Beside { axis, entering } => json!({"beside": axis, "entering": entering}),
        Bypass::Before => json!("before"),
        Bypass::After => json!("after"),
    }
}

/// Rows with their multipliers, which may have any number of digits.
fn rows(terms: &Contradiction) -> Value {
    let row = |(row, weight): &(BranchRow, _)| {
        let row = match row {
            BranchRow::End { second, early, late } => json!({"end": u8::from(*second), "early": early, "late": late}),
            BranchRow::Taken { depth, row } => json!({"taken": depth, "row": row}),
            BranchRow::NotTaken { depth, way: w } => json!({"not_taken": depth, "way": way(*w)}),
        };
        json!({"row": row, "times": ToString::to_string(weight)})
    };
    terms.iter().map(row).collect()
}

impl fmt::Display for ToldInSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { from, to, .. } = self;
        match &self.reason {
            Reason::Same => writeln!(f, "both are in cell {from}, and a cell sees itself")?,
            Reason::Visible { portals, cells, points, ends, line } => {
                writeln!(f, "cell {from} sees cell {to} through {}", count(portals.len() as u64, "portal"))?;
                for ((portal, cell), at) in portals.iter().zip(cells).zip(points) {
                    let at = at.map_or(String::new(), |at| format!(" at {}", place(at)));
                    writeln!(f, "  portal {portal} into cell {cell}{at}")?;
                }
                match ends {
                    Some([start, stop]) => writeln!(f, "along the line from {} to {}", place(*start), place(*stop))?,
                    None => {
                        let [point, direction] = [&line.point, &line.direction].map(|x| x.join(", "));
                        writeln!(f, "along the line through ({point}) in direction ({direction})")?;
                    }
                }
            }
            Reason::Hidden { walls: Some(walls), .. } => self.hidden(f, walls)?,
            Reason::Hidden { walls: None, .. } => {
                writeln!(f, "cell {from} does not see cell {to}: no way through portals joins them")?;
            }
            Reason::Unknown { max_programs } => {
                writeln!(
                    f,
                    "cell {from} and cell {to}: no line was found, and no proof that there is none, with the digits of \
                     doubles and in {}; see --max-programs",
                    count(*max_programs, "linear program")
                )?;
            }
        }
        match (&self.reason, self.listed) {
            (Reason::Unknown { .. }, true) => writeln!(f, "the table assumes that they see each other"),
            (Reason::Unknown { .. }, false) => writeln!(f, "the table says that they do not see each other"),
            (Reason::Hidden { .. }, true) => writeln!(f, "the table lists them as visible all the same"),
            (Reason::Visible { .. }, false) => writeln!(f, "the table says that they do not: it is wrong"),
            _ => Ok(()),
        }
    }
}

impl ToldInSpace {
    fn hidden(&self, f: &mut fmt::Formatter<'_>, told: &Walls) -> fmt::Result {
        let Self { from, to, n_shown, .. } = self;
        let n_walls = told.walls.len();
        let walls = if n_walls == 1 { "one wall".to_owned() } else { format!("one of {n_walls} walls") };
        writeln!(f, "cell {from} does not see cell {to}: every line meets {walls} (of {})", told.n_blockers)?;
        let mut order: Vec<usize> = (0..n_walls).collect();
        order.sort_by_key(|&i| std::cmp::Reverse(told.walls[i].n_nodes));
        for &i in order.iter().take(*n_shown) {
            let Wall { min, max, n_nodes } = &told.walls[i];
            let extent = |k: usize| {
                let name = ["x", "y", "z"][k];
                if min[k] == max[k] {
                    format!("{name} = {}", min[k])
                } else {
                    format!("{name} from {} to {}", min[k], max[k])
                }
            };
            writeln!(f, "  wall {}, in {}", [0, 1, 2].map(extent).join(", "), count(*n_nodes as u64, "step"))?;
        }
        if n_walls > *n_shown && *n_shown > 0 {
            writeln!(f, "  and {} more", n_walls - n_shown)?;
        }
        let (steps, ends) = (count(told.n_nodes as u64, "step"), count(told.n_contradictions as u64, "contradiction"));
        writeln!(f, "the proof goes past walls in {steps}, {} deep, and ends in {ends}", told.depth)
    }
}

fn place([x, y, z]: [f64; 3]) -> String {
    format!("({x}, {y}, {z})")
}

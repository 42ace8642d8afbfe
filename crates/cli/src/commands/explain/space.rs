//! The answer of `explain` in space, for people and for programs.

use super::report::Reason;
use crate::output::count;
use serde::Serialize;
use serde_json::{Value, json};
use sightlines::geometry::{Aabb, AxialDoor};
use sightlines::sightline::{AxialWitness, BlockedProof, Branch, BranchRow, Bypass, Contradiction, ProofSize, Verdict};
use sightlines::stabtree::{AxialExplanation, AxialPath, AxialProof, Barrier, SearchLimit, Sight};
use std::fmt;

/// What was found about two cells in space.
#[derive(Debug, Serialize)]
#[serde(tag = "answer", rename_all = "lowercase")]
pub(super) enum SpaceReason {
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
    Unknown { max_programs: u64 },
}

/// A point of a line and its direction, exactly, as fractions.
#[derive(Debug, Serialize)]
pub(super) struct Line {
    point: [String; 3],
    direction: [String; 3],
}

/// What stops all lines.
#[derive(Debug, Serialize)]
pub(super) struct Walls {
    /// Rectangles that all walls between cells were merged into.
    n_blockers: usize,
    /// Rectangles that the proof goes past, each as often as that happens.
    n_nodes: usize,
    /// Contradictions that end the proof's branches.
    n_contradictions: usize,
    /// The most rectangles gone past one after the other.
    depth: usize,
    walls: Vec<Wall>,
    proof: Value,
}

/// A rectangle in the way.
#[derive(Debug, Serialize)]
pub(super) struct Wall {
    min: [f64; 3],
    max: [f64; 3],
    /// How often it is gone past in the proof.
    n_nodes: usize,
}

impl SpaceReason {
    pub(super) fn new(explanation: AxialExplanation) -> Self {
        match explanation {
            Verdict::Visible(Sight::SameCell) => Self::Same,
            Verdict::Visible(Sight::Along(AxialPath { portals, cells, doors, witness, ends })) => Self::Visible {
                portals: portals.iter().map(|p| p.0).collect(),
                cells: cells.iter().map(|c| c.0).collect(),
                points: crossings(&witness, &doors),
                ends,
                line: Box::new(Line {
                    point: witness.point().each_ref().map(ToString::to_string),
                    direction: witness.direction().each_ref().map(ToString::to_string),
                }),
            },
            Verdict::Hidden(Barrier::Blocked(AxialProof { proof, walls, n_blockers })) => {
                Self::Hidden { connected: true, walls: Some(Box::new(Walls::new(&proof, &walls, n_blockers))) }
            }
            Verdict::Hidden(Barrier::NotConnected) => Self::Hidden { connected: false, walls: None },
            Verdict::Undecided(SearchLimit(limit)) => Self::Unknown { max_programs: limit },
        }
    }
}

impl SpaceReason {
    /// Two points of the line of sight, if one was found and they are known, and the portals that it passes.
    pub(super) fn line(&self) -> (Option<[[f64; 3]; 2]>, Vec<usize>) {
        match self {
            Self::Visible { ends, portals, .. } => (*ends, portals.iter().map(|&portal| portal as usize).collect()),
            _ => (None, Vec::new()),
        }
    }

    /// The rectangles that block all lines.
    pub(super) fn walls(&self) -> Vec<[[f64; 3]; 2]> {
        match self {
            Self::Hidden { walls: Some(found), .. } => found.walls.iter().map(|wall| [wall.min, wall.max]).collect(),
            _ => Vec::new(),
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

impl Reason for SpaceReason {
    const UNDECIDED_BUT_LISTED: &'static str = "the table assumes that they see each other";

    fn verdict(&self) -> Option<bool> {
        match self {
            Self::Same | Self::Visible { .. } => Some(true),
            Self::Hidden { .. } => Some(false),
            Self::Unknown { .. } => None,
        }
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, [from, to]: [u32; 2], n_shown: usize) -> fmt::Result {
        match self {
            Self::Same => writeln!(f, "both are in cell {from}, and a cell sees itself")?,
            Self::Visible { portals, cells, points, ends, line } => {
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
            Self::Hidden { walls: Some(walls), .. } => hidden(f, [from, to], n_shown, walls)?,
            Self::Hidden { walls: None, .. } => {
                writeln!(f, "cell {from} does not see cell {to}: no way through portals joins them")?;
            }
            Self::Unknown { max_programs } => {
                writeln!(
                    f,
                    "cell {from} and cell {to}: no line was found, and no proof that there is none, with the digits of \
                     doubles and in {}; see --max-programs",
                    count(*max_programs, "linear program")
                )?;
            }
        }
        Ok(())
    }
}

fn hidden(f: &mut fmt::Formatter<'_>, [from, to]: [u32; 2], n_shown: usize, found: &Walls) -> fmt::Result {
    let n_walls = found.walls.len();
    let walls = if n_walls == 1 { "one wall".to_owned() } else { format!("one of {n_walls} walls") };
    writeln!(f, "cell {from} does not see cell {to}: every line meets {walls} (of {})", found.n_blockers)?;
    let mut order: Vec<usize> = (0..n_walls).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(found.walls[i].n_nodes));
    for &i in order.iter().take(n_shown) {
        let Wall { min, max, n_nodes } = &found.walls[i];
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
    if n_walls > n_shown && n_shown > 0 {
        writeln!(f, "  and {} more", n_walls - n_shown)?;
    }
    let (steps, ends) = (count(found.n_nodes as u64, "step"), count(found.n_contradictions as u64, "contradiction"));
    writeln!(f, "the proof goes past walls in {steps}, {} deep, and ends in {ends}", found.depth)
}

fn place([x, y, z]: [f64; 3]) -> String {
    format!("({x}, {y}, {z})")
}

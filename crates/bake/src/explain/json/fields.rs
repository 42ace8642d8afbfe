//! What the fields of an explanation are.

use super::proof::{certificate, tree};
use super::{
    BlockedClusters, BlockedInPlan, End, Explained, InPlan, InScene, OfBoxes, OfClusters, Pair, Passed, PlanLine, Ray,
    Through, Wall, Walls,
};
use crate::explain::{Answer, BlockedWay, Blocks, Corner, ExactLine, Explanation, Reason, SightLine, Way};
use crate::graph::GraphKind;
use serde_json::json;
use sightlines_cells::{CellId, PortalId};
use sightlines_sightline::Branch;
use sightlines_stabtree::AxialProof;

impl Explained {
    /// The fields of an explanation of two cells. O(size of the explanation).
    ///
    /// * `listed`: whether a table lists the pair as visible; `None` without a table
    pub fn new(explanation: &Explanation, pair: [CellId; 2], listed: Option<bool>) -> Self {
        let of = Fields { explanation, pair, listed };
        match explanation.cells {
            GraphKind::Planar => Self::Plan(Box::new(of.in_plan())),
            GraphKind::Axial => Self::Scene(Box::new(of.in_scene())),
            GraphKind::Convex => Self::Clusters(Box::new(of.of_clusters())),
            GraphKind::Boxes => Self::Boxes(Box::new(of.of_boxes())),
        }
    }
}

/// What the fields are made of.
struct Fields<'a> {
    explanation: &'a Explanation,
    pair: [CellId; 2],
    listed: Option<bool>,
}

impl Fields<'_> {
    fn pair(&self) -> Pair {
        let answer = match &self.explanation.answer {
            Answer::Same => "same",
            Answer::Visible(..) => "visible",
            Answer::Hidden(_) => "hidden",
            Answer::GivenUp(_) | Answer::Unknown { .. } => "unknown",
            Answer::Undecided(_) => "undecided",
        };
        Pair { from: self.pair[0].0, to: self.pair[1].0, listed: self.listed, answer }
    }

    fn line(&self) -> Option<(&SightLine, &ExactLine)> {
        match &self.explanation.answer {
            Answer::Visible(line, exact) => Some((line, exact)),
            _ => None,
        }
    }

    fn reason(&self) -> Option<&Reason> {
        match &self.explanation.answer {
            Answer::Hidden(reason) => Some(reason),
            _ => None,
        }
    }

    fn limit(&self) -> Option<u64> {
        match self.explanation.answer {
            Answer::GivenUp(limit) => Some(limit),
            _ => None,
        }
    }

    /// The blocked ways, and how many there are.
    fn blocked(&self) -> Option<(u64, &[BlockedWay])> {
        match self.reason()? {
            Reason::Blocked { n_blocked, blocked, .. } => Some((*n_blocked, blocked)),
            _ => Some((0, &[])),
        }
    }

    fn in_plan(&self) -> InPlan {
        let line = self.line();
        let blocked = self.blocked();
        let planar = |[x, y, _]: [f64; 3]| [x, y];
        InPlan {
            pair: self.pair(),
            through: line.map(|(line, _)| Through::new(line)),
            points: line.map(|(_, exact)| exact.crossings().into_iter().flatten().map(planar).collect()),
            line: line.and_then(|(_, exact)| match exact {
                ExactLine::Planar(witness, _) => {
                    let [a, b, c] = witness.coefficients().map(ToString::to_string);
                    Some(PlanLine { a, b, c })
                }
                _ => None,
            }),
            connected: self.reason().map(|reason| *reason != Reason::NotConnected),
            n_blocked: blocked.map(|(n, _)| n),
            blocked: blocked.map(|(_, ways)| ways.iter().filter_map(BlockedInPlan::new).collect()),
            max_visits: self.limit(),
        }
    }

    fn in_scene(&self) -> InScene {
        let line = self.line();
        InScene {
            pair: self.pair(),
            through: line.map(|(line, _)| Through::new(line)),
            points: line.map(|(_, exact)| exact.crossings()),
            ends: line.and_then(|(line, _)| line.ends),
            line: line.and_then(|(_, exact)| match exact {
                ExactLine::Axial(witness, _) => Some(Ray {
                    point: witness.point().each_ref().map(ToString::to_string),
                    direction: witness.direction().each_ref().map(ToString::to_string),
                }),
                _ => None,
            }),
            connected: self.reason().map(|reason| *reason != Reason::NotConnected),
            walls: self.reason().and_then(|reason| match reason {
                Reason::Walls(proof) => Some(Walls::new(proof)),
                _ => None,
            }),
            max_programs: self.limit(),
        }
    }

    fn of_boxes(&self) -> OfBoxes {
        let (n_rays, hidden_by) = match &self.explanation.answer {
            Answer::Unknown { n_rays, hidden_by } => (*n_rays, hidden_by.clone()),
            _ => (None, Vec::new()),
        };
        OfBoxes { pair: self.pair(), segment: self.line().and_then(|(line, _)| line.ends), n_rays, hidden_by }
    }

    fn of_clusters(&self) -> OfClusters {
        let line = self.line();
        let blocked = self.blocked();
        let passed = |(line, exact): (&SightLine, &ExactLine)| {
            let portals = line.portals.iter().zip(entered(line)).zip(exact.crossings());
            portals.map(|((portal, cell), at)| Passed { portal: portal.0, cell, at }).collect()
        };
        OfClusters {
            pair: self.pair(),
            checked: self.explanation.checked,
            portals: match &self.explanation.answer {
                Answer::Undecided(way) => Some(all_passed(way)),
                _ => line.map(passed),
            },
            line: line.and_then(|(_, exact)| match exact {
                ExactLine::Convex(points, _) => Some(*points),
                _ => None,
            }),
            start: self.reason().map(|reason| match reason {
                Reason::Blocked { start, .. } => start.0,
                _ => self.pair[0].0,
            }),
            n_blocked: blocked.map(|(n, _)| n),
            blocked: blocked.map(|(_, ways)| ways.iter().filter_map(BlockedClusters::new).collect()),
            max_questions: self.limit(),
        }
    }
}

fn all_passed(way: &Way) -> Vec<Passed> {
    let portals = way.portals.iter().zip(&way.cells);
    portals.map(|(portal, cell)| Passed { portal: portal.0, cell: cell.0, at: None }).collect()
}

fn numbers(portals: &[PortalId]) -> Vec<u32> {
    portals.iter().map(|portal| portal.0).collect()
}

/// The cells behind the portals of a line.
fn entered(line: &SightLine) -> Vec<u32> {
    line.cells.iter().skip(1).map(|cell| cell.0).collect()
}

impl BlockedInPlan {
    fn new(BlockedWay { way, proof }: &BlockedWay) -> Option<Self> {
        let Blocks::Corners { lefts, rights } = proof else { return None };
        let end = |c: &Corner| End { portal: c.portal.0, point: [c.point.x, c.point.y] };
        let [lefts, rights] = [lefts, rights].map(|corners| corners.iter().map(end).collect());
        Some(Self { portals: numbers(&way.portals), lefts, rights })
    }
}

impl BlockedClusters {
    fn new(BlockedWay { way, proof }: &BlockedWay) -> Option<Self> {
        let Blocks::Convex(why) = proof else { return None };
        Some(Self { portals: all_passed(way), certificate: certificate(why) })
    }
}

impl Walls {
    fn new(found: &AxialProof) -> Self {
        let size = found.proof.size();
        let walls = found.walls.iter().zip(found.n_steps());
        let octant = |(signs, branch): &([bool; 3], Branch)| json!({"forward": signs, "branch": tree(branch)});
        Self {
            n_blockers: found.n_blockers,
            n_nodes: size.n_nodes,
            n_contradictions: size.n_leaves,
            depth: size.depth,
            walls: walls.map(|(wall, n_nodes)| Wall { min: wall.min, max: wall.max, n_nodes }).collect(),
            proof: found.proof.octants.iter().map(octant).collect(),
        }
    }
}

impl Through {
    fn new(line: &SightLine) -> Self {
        Self { portals: numbers(&line.portals), cells: entered(line) }
    }
}

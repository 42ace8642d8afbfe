//! The reason of `explain` in plans, for people and for programs.

use super::report::Reason;
use crate::output::count;
use serde::Serialize;
use sightlines::cells::{CellGraph, CellId, Planar, PortalId};
use sightlines::geometry::{Point2, Portal2};
use sightlines::sightline::{End, PlanarCertificate, Verdict};
use sightlines::stabtree::{Barrier, BlockedSequence, PlanarExplanation, PlanarPath, SearchLimit, Sight};
use std::fmt;

/// What was found about two cells of a plan.
#[derive(Debug, Serialize)]
#[serde(tag = "answer", rename_all = "lowercase")]
pub(super) enum PlanReason {
    /// They are one cell.
    Same,
    Visible {
        portals: Vec<u32>,
        /// The cells entered, one for each portal.
        cells: Vec<u32>,
        /// Where the line crosses each portal, rounded.
        points: Vec<[f64; 2]>,
        line: Line,
    },
    Hidden {
        connected: bool,
        n_blocked: u64,
        blocked: Vec<Way>,
    },
    /// The search was given up.
    Unknown {
        max_visits: u64,
    },
}

/// The exact coefficients of the line `a x + b y + c = 0`, as fractions.
#[derive(Debug, Serialize)]
pub(super) struct Line {
    a: String,
    b: String,
    c: String,
}

/// A sequence of portals that no line passes, and the ends that no line separates.
#[derive(Debug, Serialize)]
pub(super) struct Way {
    portals: Vec<u32>,
    lefts: Vec<Corner>,
    rights: Vec<Corner>,
}

/// An end of a portal.
#[derive(Debug, Serialize)]
pub(super) struct Corner {
    portal: u32,
    point: [f64; 2],
}

impl PlanReason {
    pub(super) fn new(graph: &CellGraph<Planar>, from: CellId, explanation: &PlanarExplanation) -> Self {
        match explanation {
            Verdict::Visible(Sight::SameCell) => Self::Same,
            Verdict::Visible(Sight::Along(path)) => visible(graph, from, path),
            Verdict::Hidden(Barrier::NotConnected) => {
                Self::Hidden { connected: false, n_blocked: 0, blocked: Vec::new() }
            }
            Verdict::Hidden(Barrier::Blocked(proof)) => Self::Hidden {
                connected: true,
                n_blocked: proof.n_blocked,
                blocked: proof.blocked.iter().map(|way| blocked_way(graph, from, way)).collect(),
            },
            Verdict::Undecided(SearchLimit(limit)) => Self::Unknown { max_visits: *limit },
        }
    }
}

fn pair(p: Point2) -> [f64; 2] {
    [p.x, p.y]
}

/// The cells that are entered by going from `from` through `portals`, and the doors as seen on the way.
fn walk(graph: &CellGraph<Planar>, from: CellId, portals: &[PortalId]) -> Vec<(CellId, Portal2)> {
    let mut here = from;
    let step = |id: &PortalId| {
        let portal = graph.portal(*id);
        let forward = portal.cells[0] == here;
        here = portal.cells[usize::from(forward)];
        (here, if forward { portal.shape } else { portal.shape.reversed() })
    };
    portals.iter().map(step).collect()
}

fn visible(graph: &CellGraph<Planar>, from: CellId, path: &PlanarPath) -> PlanReason {
    let PlanarPath { portals, doors, witness } = path;
    let [a, b, c] = witness.coefficients().map(ToString::to_string);
    PlanReason::Visible {
        portals: portals.iter().map(|p| p.0).collect(),
        cells: walk(graph, from, portals).iter().map(|(cell, _)| cell.0).collect(),
        points: doors.iter().map(|&door| pair(witness.crossing(door))).collect(),
        line: Line { a, b, c },
    }
}

fn blocked_way(graph: &CellGraph<Planar>, from: CellId, way: &BlockedSequence) -> Way {
    let walked = walk(graph, from, &way.portals);
    let corner = |end: &End| {
        let door = walked[end.portal].1;
        Corner { portal: way.portals[end.portal].0, point: pair(if end.left { door.left } else { door.right }) }
    };
    let PlanarCertificate { lefts, rights } = &way.certificate;
    Way {
        portals: way.portals.iter().map(|p| p.0).collect(),
        lefts: lefts.iter().map(corner).collect(),
        rights: rights.iter().map(corner).collect(),
    }
}

impl Reason for PlanReason {
    fn verdict(&self) -> Option<bool> {
        match self {
            Self::Same | Self::Visible { .. } => Some(true),
            Self::Hidden { .. } => Some(false),
            Self::Unknown { .. } => None,
        }
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, [from, to]: [u32; 2], _: usize) -> fmt::Result {
        match self {
            Self::Same => writeln!(f, "both are in cell {from}, and a cell sees itself")?,
            Self::Visible { portals, cells, points, line } => {
                writeln!(f, "cell {from} sees cell {to} through {}", count(portals.len() as u64, "portal"))?;
                for ((portal, cell), [x, y]) in portals.iter().zip(cells).zip(points) {
                    writeln!(f, "  portal {portal} into cell {cell} at ({x}, {y})")?;
                }
                let Line { a, b, c } = line;
                writeln!(f, "along the line a x + b y + c = 0 with")?;
                writeln!(f, "  a = {a}\n  b = {b}\n  c = {c}")?;
            }
            Self::Hidden { connected: false, .. } => {
                writeln!(f, "cell {from} does not see cell {to}: no way through portals joins them")?;
            }
            Self::Hidden { n_blocked, blocked, .. } => hidden(f, [from, to], *n_blocked, blocked)?,
            Self::Unknown { max_visits } => {
                writeln!(f, "cell {from} and cell {to}: given up after {max_visits} cells; see --max-visits")?;
            }
        }
        Ok(())
    }
}

fn hidden(f: &mut fmt::Formatter<'_>, [from, to]: [u32; 2], n_blocked: u64, ways: &[Way]) -> fmt::Result {
    let n = count(n_blocked, "way");
    writeln!(f, "cell {from} does not see cell {to}: {n} through portals lead that way, and all are blocked")?;
    for way in ways {
        let portals: Vec<String> = way.portals.iter().map(u32::to_string).collect();
        writeln!(f, "  blocked: portals {}", portals.join(" "))?;
        writeln!(f, "    a line would have to pass {}", side("on the right of the left end", &way.lefts))?;
        writeln!(f, "    and {}", side("on the left of the right end", &way.rights))?;
        writeln!(f, "    but no line separates these points")?;
    }
    if n_blocked > ways.len() as u64 && !ways.is_empty() {
        writeln!(f, "  and {} more", n_blocked - ways.len() as u64)?;
    }
    Ok(())
}

/// One side of a certificate in words.
fn side(what: &str, corners: &[Corner]) -> String {
    let corner = |c: &Corner| format!("of portal {} at ({}, {})", c.portal, c.point[0], c.point[1]);
    let list = corners.iter().map(corner).collect::<Vec<_>>().join(", ");
    let plural = if corners.len() == 1 { "" } else { "s" };
    format!("{what}{plural} {list}")
}

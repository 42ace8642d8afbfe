//! The answer of `explain` for clusters of a portal file, for people and for programs.

use super::Error;
use super::report::{ExplanationReport, Reason};
use crate::Answer;
use crate::output::count;
use crate::place::Place;
use serde::Serialize;
use serde_json::{Value, json};
use sightlines::cells::{CellGraph, CellId, Convex};
use sightlines::sightline::{ConvexCertificate, ConvexNode, ConvexTerm, HullProof, Line3, Verdict};
use sightlines::stabtree::{
    Barrier, BlockedConvex, Blocking, ConvexDoubt, ConvexExplanation, ConvexGate, ConvexPath, ConvexProof, SearchLimit,
    Sight, check_convex, explain_convex,
};
use std::fmt;
use std::path::Path;

/// The source of the clusters, and the query.
#[derive(Debug)]
pub(super) struct ClusterQuery<'a> {
    pub(super) path: &'a Path,
    pub(super) graph: &'a CellGraph<Convex>,
    pub(super) places: [&'a Place; 2],
    pub(super) limit: u64,
    /// How many of the blocked sequences are shown to people; programs get them all.
    pub(super) n_shown: usize,
    pub(super) json: bool,
}

impl ClusterQuery<'_> {
    /// Explains and prints; `listed` is what a table says of two cells.
    pub(super) fn answer(&self, listed: impl Fn(CellId, CellId) -> Option<bool>) -> Result<Answer, Error> {
        let n_clusters = self.graph.n_cells();
        let cluster = |place: &Place| match *place {
            Place::Cell(id) if (id as usize) < n_clusters => Ok(CellId(id)),
            Place::Cell(cluster) => Err(Error::NoSuchCluster { path: self.path.to_owned(), cluster, n_clusters }),
            Place::Point(_) => Err(Error::NoPoints(self.path.to_owned())),
        };
        let (from, to) = (cluster(self.places[0])?, cluster(self.places[1])?);
        let explanation = explain_convex(self.graph, from, to, self.limit);
        let report = ExplanationReport {
            from: from.0,
            to: to.0,
            listed: listed(from, to),
            has_regions: false,
            checked: Some(check_convex(self.graph, from, to, &explanation)),
            reason: reason(self.graph, from, &explanation),
            n_shown: self.n_shown,
        };
        Ok(report.print(self.json)?)
    }
}

/// What was found about two clusters.
#[derive(Debug, Serialize)]
#[serde(tag = "answer", rename_all = "lowercase")]
enum ConvexReason {
    /// They are one cluster.
    Same,
    Visible {
        /// The portals passed, in order.
        portals: Vec<Passed>,
        /// Two points of the line: exact, as it was checked with these.
        line: [[f64; 3]; 2],
    },
    Hidden {
        /// From which cluster the sequences lead, to the other.
        start: u32,
        n_blocked: usize,
        blocked: Vec<Blocked>,
    },
    /// The search was given up.
    Unknown { max_questions: u64 },
    /// A sequence about which it could not be decided.
    Undecided { portals: Vec<Passed> },
}

/// A portal on the way.
#[derive(Debug, Serialize)]
struct Passed {
    portal: u32,
    /// The cluster behind it.
    cell: u32,
    /// Where the line crosses it, rounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<[f64; 3]>,
}

/// A sequence that no line passes.
#[derive(Debug, Serialize)]
struct Blocked {
    portals: Vec<Passed>,
    certificate: Value,
    #[serde(skip)]
    words: String,
}

fn passed(graph: &CellGraph<Convex>, gate: ConvexGate, line: Option<&Line3>) -> Passed {
    let at = line.map(|line| gate.crossing(graph, line));
    Passed { portal: gate.portal.0, cell: gate.cells(graph)[1].0, at }
}

fn reason(graph: &CellGraph<Convex>, from: CellId, explanation: &ConvexExplanation) -> ConvexReason {
    match explanation {
        Verdict::Visible(Sight::SameCell) => ConvexReason::Same,
        Verdict::Visible(Sight::Along(ConvexPath { gates, line })) => ConvexReason::Visible {
            portals: gates.iter().map(|&gate| passed(graph, gate, Some(line))).collect(),
            line: [line.a, line.b],
        },
        Verdict::Hidden(Barrier::NotConnected) => {
            ConvexReason::Hidden { start: from.0, n_blocked: 0, blocked: Vec::new() }
        }
        Verdict::Hidden(Barrier::Blocked(ConvexProof { start, blocked })) => ConvexReason::Hidden {
            start: start.0,
            n_blocked: blocked.len(),
            blocked: blocked.iter().map(|b| blocked_way(graph, b)).collect(),
        },
        Verdict::Undecided(ConvexDoubt::Limit(SearchLimit(limit))) => ConvexReason::Unknown { max_questions: *limit },
        Verdict::Undecided(ConvexDoubt::Chain(gates)) => {
            ConvexReason::Undecided { portals: gates.iter().map(|&gate| passed(graph, gate, None)).collect() }
        }
    }
}

fn blocked_way(graph: &CellGraph<Convex>, blocked: &BlockedConvex) -> Blocked {
    let certificate = match &blocked.reason {
        Blocking::Behind => None,
        Blocking::Certificate(certificate) => Some(&**certificate),
    };
    let (certificate, words) = match certificate {
        None => (json!("behind"), "one of the two is not ahead of the other".to_owned()),
        Some(ConvexCertificate::Plane(plane)) => (
            json!({"plane": {"edge": plane.edge, "corner": plane.corner, "stops": plane.stops}}),
            "a plane has the first, the next and the last of them on alternate sides".to_owned(),
        ),
        Some(certificate @ ConvexCertificate::Boxes(proof)) => {
            let blocks: Vec<Value> =
                proof.blocks.iter().map(|b| json!({"corner": b.corner, "edges": b.edges})).collect();
            let nodes: Vec<Value> = proof.nodes.iter().map(node).collect();
            let n = count(certificate.n_leaves() as u64, "part");
            (
                json!({"boxes": {"portals": proof.portals, "blocks": blocks, "nodes": nodes}}),
                format!("sums of edges are negative for all lines, in {n}"),
            )
        }
        Some(ConvexCertificate::Hulls(HullProof { portals, terms })) => (
            json!({"hulls": {"portals": portals, "terms": terms.iter().map(term).collect::<Vec<_>>()}}),
            "a sum of edges is positive for no line".to_owned(),
        ),
        Some(_) => (Value::Null, "a certificate of another kind".to_owned()),
    };
    Blocked { portals: blocked.gates.iter().map(|&gate| passed(graph, gate, None)).collect(), certificate, words }
}

fn node(node: &ConvexNode) -> Value {
    match node {
        ConvexNode::Split { axis, at, parts } => json!({"axis": axis, "at": at, "parts": parts}),
        ConvexNode::Leaf(terms) => terms.iter().map(term).collect(),
    }
}

fn term(term: &ConvexTerm) -> Value {
    json!({"portal": term.portal, "edge": term.edge, "times": term.multiplier})
}

fn place([x, y, z]: [f64; 3]) -> String {
    format!("({x}, {y}, {z})")
}

fn list(portals: &[Passed]) -> String {
    portals.iter().map(|p| p.portal.to_string()).collect::<Vec<_>>().join(" ")
}

impl Reason for ConvexReason {
    fn verdict(&self) -> Option<bool> {
        match self {
            Self::Same | Self::Visible { .. } => Some(true),
            Self::Hidden { .. } => Some(false),
            Self::Unknown { .. } | Self::Undecided { .. } => None,
        }
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, [from, to]: [u32; 2], n_shown: usize) -> fmt::Result {
        match self {
            Self::Same => writeln!(f, "both are cluster {from}, and a cluster sees itself")?,
            Self::Visible { portals, line } => {
                writeln!(f, "cluster {from} sees cluster {to} through {}", count(portals.len() as u64, "portal"))?;
                for Passed { portal, cell, at } in portals {
                    let at = at.map_or(String::new(), |at| format!(" at {}", place(at)));
                    writeln!(f, "  portal {portal} into cluster {cell}{at}")?;
                }
                writeln!(f, "along the line from {} to {}", place(line[0]), place(line[1]))?;
            }
            Self::Hidden { blocked, .. } if blocked.is_empty() => {
                writeln!(f, "cluster {from} does not see cluster {to}: no way through portals joins them")?;
            }
            Self::Hidden { start, n_blocked, blocked } => {
                let n = count(*n_blocked as u64, "sequence");
                writeln!(
                    f,
                    "cluster {from} does not see cluster {to}: every way from cluster {start} passes one of {n} of \
                     portals that no line passes"
                )?;
                for way in blocked.iter().take(n_shown) {
                    writeln!(f, "  blocked: portals {}: {}", list(&way.portals), way.words)?;
                }
                if blocked.len() > n_shown && n_shown > 0 {
                    writeln!(f, "  and {} more", blocked.len() - n_shown)?;
                }
            }
            Self::Unknown { max_questions } => {
                let n = count(*max_questions, "question");
                writeln!(f, "cluster {from} and cluster {to}: given up after {n}; see --max-questions")?;
            }
            Self::Undecided { portals } => {
                let ways = list(portals);
                writeln!(f, "cluster {from} and cluster {to}: undecided whether a line passes portals {ways}")?;
            }
        }
        Ok(())
    }
}

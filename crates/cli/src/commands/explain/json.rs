//! An explanation for programs. `docs/json.md` describes the fields, which depend on the kind of the cells.

use super::report::Report;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};
use sightlines::bake::GraphKind;
use sightlines::bake::explain::{Answer, BlockedWay, Blocks, Corner, ExactLine, Reason, SightLine, Way};
use sightlines::cells::PortalId;
use sightlines::sightline::{Branch, BranchRow, Bypass, Contradiction, ConvexCertificate, ConvexNode, ConvexTerm};
use sightlines::stabtree::{AxialProof, Blocking};

impl Serialize for Report<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("from", &self.pair[0].0)?;
        map.serialize_entry("to", &self.pair[1].0)?;
        map.serialize_entry("listed", &self.listed)?;
        if let Some(checked) = self.explanation.checked {
            map.serialize_entry("checked", &checked)?;
        }
        let name = match &self.explanation.answer {
            Answer::Same => "same",
            Answer::Visible(..) => "visible",
            Answer::Hidden(_) => "hidden",
            Answer::GivenUp(_) | Answer::Unknown { .. } => "unknown",
            Answer::Undecided(_) => "undecided",
        };
        map.serialize_entry("answer", name)?;
        self.write_fields(&mut map)?;
        map.end()
    }
}

impl Report<'_> {
    fn write_fields<M: SerializeMap>(&self, map: &mut M) -> Result<(), M::Error> {
        let cells = self.explanation.cells;
        match &self.explanation.answer {
            Answer::Same => Ok(()),
            Answer::Visible(line, exact) => write_line(map, line, exact),
            Answer::Hidden(reason) => self.write_hidden(map, reason),
            Answer::GivenUp(limit) => {
                let name = match cells {
                    GraphKind::Planar => "max_visits",
                    GraphKind::Convex => "max_questions",
                    _ => "max_programs",
                };
                map.serialize_entry(name, limit)
            }
            Answer::Undecided(way) => map.serialize_entry("portals", &all_passed(way)),
            Answer::Unknown { n_rays, hidden_by } => {
                n_rays.iter().try_for_each(|n| map.serialize_entry("n_rays", n))?;
                if hidden_by.is_empty() { Ok(()) } else { map.serialize_entry("hidden_by", hidden_by) }
            }
        }
    }

    fn write_hidden<M: SerializeMap>(&self, map: &mut M, reason: &Reason) -> Result<(), M::Error> {
        match (self.explanation.cells, reason) {
            (GraphKind::Convex, Reason::Blocked { start, .. }) => map.serialize_entry("start", &start.0)?,
            (GraphKind::Convex, _) => map.serialize_entry("start", &self.pair[0].0)?,
            _ => map.serialize_entry("connected", &(*reason != Reason::NotConnected))?,
        }
        let (n_blocked, blocked) = match reason {
            Reason::Walls(walls) => return write_walls(map, walls),
            Reason::NotConnected if self.explanation.cells == GraphKind::Axial => return Ok(()),
            Reason::NotConnected => (0, &[][..]),
            Reason::Blocked { n_blocked, blocked, .. } => (*n_blocked, &blocked[..]),
        };
        map.serialize_entry("n_blocked", &n_blocked)?;
        map.serialize_entry("blocked", &blocked.iter().map(Blocked::new).collect::<Vec<_>>())
    }
}

/// A portal of a cluster on the way.
#[derive(Serialize)]
struct Passed {
    portal: u32,
    cell: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<[f64; 3]>,
}

fn all_passed(way: &Way) -> Vec<Passed> {
    way.portals
        .iter()
        .zip(&way.cells)
        .map(|(portal, cell)| Passed { portal: portal.0, cell: cell.0, at: None })
        .collect()
}

fn numbers(portals: &[PortalId]) -> Vec<u32> {
    portals.iter().map(|portal| portal.0).collect()
}

/// A line through boxes: a point and a direction, as fractions.
#[derive(Serialize)]
struct Ray {
    point: [String; 3],
    direction: [String; 3],
}

fn write_line<M: SerializeMap>(map: &mut M, line: &SightLine, exact: &ExactLine) -> Result<(), M::Error> {
    let entered: Vec<u32> = line.cells.iter().skip(1).map(|cell| cell.0).collect();
    let crossings = exact.crossings();
    match exact {
        ExactLine::Planar(witness, _) => {
            map.serialize_entry("portals", &numbers(&line.portals))?;
            map.serialize_entry("cells", &entered)?;
            let points: Vec<[f64; 2]> = crossings.iter().flatten().map(|&[x, y, _]| [x, y]).collect();
            map.serialize_entry("points", &points)?;
            let [a, b, c] = witness.coefficients().map(ToString::to_string);
            map.serialize_entry("line", &json!({"a": a, "b": b, "c": c}))
        }
        ExactLine::Axial(witness, _) => {
            map.serialize_entry("portals", &numbers(&line.portals))?;
            map.serialize_entry("cells", &entered)?;
            map.serialize_entry("points", &crossings)?;
            map.serialize_entry("ends", &line.ends)?;
            let point = witness.point().each_ref().map(ToString::to_string);
            let direction = witness.direction().each_ref().map(ToString::to_string);
            map.serialize_entry("line", &Ray { point, direction })
        }
        ExactLine::Convex(points, _) => {
            let portals = line.portals.iter().zip(entered).zip(crossings);
            let portals = portals.map(|((portal, cell), at)| Passed { portal: portal.0, cell, at });
            map.serialize_entry("portals", &portals.collect::<Vec<_>>())?;
            map.serialize_entry("line", points)
        }
        ExactLine::Segment => map.serialize_entry("segment", &line.ends),
    }
}

/// A sequence of portals that no line passes.
#[derive(Serialize)]
#[serde(untagged)]
enum Blocked {
    /// In a plan, with the ends that no line separates.
    Plan {
        portals: Vec<u32>,
        lefts: Vec<End>,
        rights: Vec<End>,
    },
    Clusters {
        portals: Vec<Passed>,
        certificate: Value,
    },
}

/// An end of a portal.
#[derive(Serialize)]
struct End {
    portal: u32,
    point: [f64; 2],
}

impl Blocked {
    fn new(BlockedWay { way, proof }: &BlockedWay) -> Self {
        match proof {
            Blocks::Corners { lefts, rights } => {
                let end = |c: &Corner| End { portal: c.portal.0, point: [c.point.x, c.point.y] };
                let [lefts, rights] = [lefts, rights].map(|corners| corners.iter().map(end).collect());
                Self::Plan { portals: numbers(&way.portals), lefts, rights }
            }
            Blocks::Convex(why) => Self::Clusters { portals: all_passed(way), certificate: certificate(why) },
        }
    }
}

fn certificate(why: &Blocking) -> Value {
    let Blocking::Certificate(certificate) = why else { return json!("behind") };
    match &**certificate {
        ConvexCertificate::Plane(plane) => {
            json!({"plane": {"edge": plane.edge, "corner": plane.corner, "stops": plane.stops}})
        }
        ConvexCertificate::Boxes(proof) => {
            let blocks: Vec<Value> =
                proof.blocks.iter().map(|b| json!({"corner": b.corner, "edges": b.edges})).collect();
            let nodes: Vec<Value> = proof.nodes.iter().map(node).collect();
            json!({"boxes": {"portals": proof.portals, "blocks": blocks, "nodes": nodes}})
        }
        ConvexCertificate::Hulls(proof) => {
            json!({"hulls": {"portals": proof.portals, "terms": proof.terms.iter().map(term).collect::<Vec<_>>()}})
        }
        _ => Value::Null,
    }
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

/// A rectangle in the way.
#[derive(Serialize)]
struct Wall {
    min: [f64; 3],
    max: [f64; 3],
    n_nodes: usize,
}

fn write_walls<M: SerializeMap>(map: &mut M, found: &AxialProof) -> Result<(), M::Error> {
    let size = found.proof.size();
    map.serialize_entry("n_blockers", &found.n_blockers)?;
    map.serialize_entry("n_nodes", &size.n_nodes)?;
    map.serialize_entry("n_contradictions", &size.n_leaves)?;
    map.serialize_entry("depth", &size.depth)?;
    let walls = found.walls.iter().zip(found.n_steps());
    let walls = walls.map(|(wall, n_nodes)| Wall { min: wall.min, max: wall.max, n_nodes });
    map.serialize_entry("walls", &walls.collect::<Vec<_>>())?;
    let octant = |(signs, branch): &([bool; 3], Branch)| json!({"forward": signs, "branch": tree(branch)});
    map.serialize_entry("proof", &found.proof.octants.iter().map(octant).collect::<Value>())
}

/// A branch of a proof.
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

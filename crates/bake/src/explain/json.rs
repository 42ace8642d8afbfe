//! An explanation as JSON, for programs; the fields depend on the kind of the cells.

use super::{Answer, BlockedWay, Blocks, Corner, ExactLine, Explanation, Reason, SightLine, Way};
use crate::graph::GraphKind;
#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::{Value, json};
use sightlines_cells::{CellId, PortalId};
use sightlines_sightline::{Branch, BranchRow, Bypass, Contradiction, ConvexCertificate, ConvexNode, ConvexTerm};
use sightlines_stabtree::{AxialProof, Blocking};

/// An explanation, by the kind of the cells.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
#[serde(untagged)]
pub enum Explained {
    /// Of a plan.
    Plan(Box<InPlan>),
    /// Of boxes that portals join.
    Scene(Box<InScene>),
    /// Of cells without portals.
    Boxes(Box<OfBoxes>),
    /// Of clusters.
    Clusters(Box<OfClusters>),
}

/// Pair of cells
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Pair {
    /// The first cell.
    from: u32,
    /// The second cell.
    to: u32,
    /// Whether the table lists the pair as visible; null without a table.
    listed: Option<bool>,
    /// `same` (one cell), `visible`, `hidden`, `unknown` (the limit of work was reached, or nothing was found between cells without portals) or
    /// `undecided` (only of clusters). Fields that only some answers have name them.
    answer: &'static str,
}

/// What a line passes.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Through {
    /// Visible: the portals that the line passes, in order.
    portals: Vec<u32>,
    /// Visible: the cell entered through each portal.
    cells: Vec<u32>,
}

impl Through {
    fn new(line: &SightLine) -> Self {
        Self { portals: numbers(&line.portals), cells: entered(line) }
    }
}

/// Exit code 1 for a hidden pair.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct InPlan {
    #[serde(flatten)]
    pair: Pair,
    #[serde(flatten)]
    through: Option<Through>,
    /// Visible: where the line crosses each portal, rounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<[f64; 2]>>,
    /// Visible: the line a x + b y + c = 0, exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<PlanLine>,
    /// Hidden: whether any way through portals joins the cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    connected: Option<bool>,
    /// Hidden: sequences of portals that lead that way, all of them blocked.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_blocked: Option<u64>,
    /// Hidden: some of the blocked sequences.
    #[serde(skip_serializing_if = "Option::is_none")]
    blocked: Option<Vec<BlockedInPlan>>,
    /// Unknown: the limit of entered cells.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_visits: Option<u64>,
}

/// Line in a plan
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct PlanLine {
    /// The coefficient a, as a fraction.
    a: String,
    /// The coefficient b, as a fraction.
    b: String,
    /// The coefficient c, as a fraction.
    c: String,
}

/// Blocked sequence of portals in a plan
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct BlockedInPlan {
    /// The portals, in order.
    portals: Vec<u32>,
    /// Left ends of portals: a line would have to pass on their right.
    lefts: Vec<End>,
    /// Right ends of portals: a line would have to pass on their left. No line separates the two lists.
    rights: Vec<End>,
}

/// Corner
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct End {
    /// The portal.
    portal: u32,
    /// Its end.
    point: [f64; 2],
}

/// Exit code 1 for a hidden pair. The line leads through portals. If a from-region method took part in the table and `listed` is false, it
/// hides the pair by walls that are no borders of cells, which the line may meet; then the exit code is 1 all the same.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct InScene {
    #[serde(flatten)]
    pair: Pair,
    #[serde(flatten)]
    through: Option<Through>,
    /// Visible: where the line crosses each portal, rounded; null for a portal that the line lies in.
    #[serde(skip_serializing_if = "Option::is_none")]
    points: Option<Vec<Option<[f64; 3]>>>,
    /// Visible: a point of the line in the first cell and one in the last.
    #[serde(skip_serializing_if = "Option::is_none")]
    ends: Option<[[f64; 3]; 2]>,
    /// Visible: the line, exactly.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<Ray>,
    /// Hidden: whether any way through portals joins the cells; if not, `n_blockers`, `n_nodes`, `n_contradictions`, `depth`, `walls` and `proof`
    /// are absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    connected: Option<bool>,
    #[serde(flatten)]
    walls: Option<Walls>,
    /// Unknown: the limit of linear programs.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_programs: Option<u64>,
}

/// Line through boxes
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Ray {
    /// A point, as fractions.
    point: [String; 3],
    /// The direction, as fractions.
    direction: [String; 3],
}

/// Walls in the way of all lines
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Walls {
    /// Hidden: rectangles that the walls were merged into.
    n_blockers: usize,
    /// Hidden: rectangles passed in the proof, each as often as it is passed.
    n_nodes: usize,
    /// Hidden: contradictions that end branches of the proof.
    n_contradictions: usize,
    /// Hidden: the most rectangles passed in one branch.
    depth: usize,
    /// Hidden: the rectangles in the way.
    walls: Vec<Wall>,
    /// Hidden: a tree for each octant of directions. Its element has `forward`, whether lines go forward along each axis, and `branch`. A branch is
    /// a `contradiction`, a list of rows, each with `times`, its exact multiplier; or it has `wall` (index into `walls`), `ways`, a list of objects
    /// with `way` (`before`, `after`, or an object with `beside`, the axis, and `entering`) and `branch`, and `rest`, rows or null. A `row` is one
    /// of {`end`, `early`, `late`}, {`taken`, `row`}, {`not_taken`, `way`}.
    proof: Vec<Value>,
}

/// Rectangle in the way
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Wall {
    /// Lower corner.
    min: [f64; 3],
    /// Upper corner.
    max: [f64; 3],
    /// How often the proof passes it.
    n_nodes: usize,
}

/// Of given cells, and of places. Exit code 1 for a pair that the table hides, unless a line joins it.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct OfBoxes {
    #[serde(flatten)]
    pair: Pair,
    /// Visible: from inside one cell to inside the other; nothing in the scene touches it, which is decided exactly. Along the axes of the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    segment: Option<[[f64; 3]; 2]>,
    /// Unknown, with `--scene`: about how many rays from each cell found no line, which proves nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_rays: Option<u32>,
    /// Unknown, of a pair that the table hides: the methods of which at least one hid it; with `--scene` the one, unless that takes too many cells.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    hidden_by: Vec<String>,
}

/// Of portal files, and of tables of portal files and Quake maps. Exit code 1 for a hidden pair.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct OfClusters {
    #[serde(flatten)]
    pair: Pair,
    /// Whether the independent checker accepts the reason.
    #[serde(skip_serializing_if = "Option::is_none")]
    checked: Option<bool>,
    /// Visible: the portals that the line passes, in order. Undecided: a sequence that was not decided.
    #[serde(skip_serializing_if = "Option::is_none")]
    portals: Option<Vec<Passed>>,
    /// Visible: two points of the line.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<[[f64; 3]; 2]>,
    /// Hidden: the cluster from which the sequences lead to the other.
    #[serde(skip_serializing_if = "Option::is_none")]
    start: Option<u32>,
    /// Hidden: sequences of portals, all of them blocked.
    #[serde(skip_serializing_if = "Option::is_none")]
    n_blocked: Option<u64>,
    /// Hidden: all of the blocked sequences.
    #[serde(skip_serializing_if = "Option::is_none")]
    blocked: Option<Vec<BlockedClusters>>,
    /// Unknown: the limit of tested sequences.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_questions: Option<u64>,
}

/// Passed portal
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct Passed {
    /// The portal.
    portal: u32,
    /// The cluster behind it.
    cell: u32,
    /// Visible: where the line crosses the portal, rounded.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<[f64; 3]>,
}

/// Blocked sequence of portals between clusters
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
struct BlockedClusters {
    /// The portals, in order.
    portals: Vec<Passed>,
    /// Why no line passes: `behind` (one of the portals is not ahead of another); or `plane`, with the `edge`, `corner` and `stops` that give it; or
    /// `boxes`, with `portals`, `blocks` (`corner`, `edges`) and `nodes`, each a split (`axis`, `at`, `parts`) or a list of terms (`portal`, `edge`,
    /// `times`); or `hulls`, with `portals` and `terms`, whose sum is positive for no line from the hull of the one portal to that of the other.
    certificate: Value,
}

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

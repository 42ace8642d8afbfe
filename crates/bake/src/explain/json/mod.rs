//! An explanation as JSON, for programs; the fields depend on the kind of the cells.

mod fields;
mod proof;

#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;

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

/// Exit code 1 for a hidden pair. The line leads through portals. If a from-region method took part in the table, or walls that hide from one side
/// only, and `listed` is false, the line may meet walls that are no borders of cells or hide from one side; then the exit code is 1 all the same.
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

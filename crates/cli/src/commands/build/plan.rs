//! What was built from a plan.

use super::brief::{Brief, of_cells};
use crate::facts::times;
use crate::output::{JsonSchema, Serialize, bytes, count, percent};
use sightlines::bake::{PlanReport, stated_gap};
use sightlines::pvs::Table;
use sightlines::report::Summary;
use std::fmt;
use std::path::Path;

pub(super) fn warn(path: &Path, report: &PlanReport) {
    let say = |n: usize, noun: &str, what: &str| {
        if n > 0 {
            tracing::warn!("{}: {} {what}", path.display(), count(n as u64, noun));
        }
    };
    say(report.n_ignored_walls, "wall", "do not block sight: the k-d tree does not follow them");
    say(report.n_lost_mirrors, "mirror", "do not reflect everywhere: a part is on no border of a cell");
    say(report.n_dropped_pieces, "piece", "of walls do not block sight: rounding could have closed a gap beside them");
    say(
        report.n_near_misses,
        "end",
        "of walls miss others by little: if they were meant to meet, --gap WIDTH joins those within WIDTH; `draw --joints` shows where they are",
    );
    if report.n_rounded_crossings > 0 {
        let n = count(report.n_rounded_crossings as u64, "crossing");
        tracing::info!("{}: {n} of lines had to be rounded, towards visible", path.display());
    }
    if report.n_disputed_cells > 0 {
        let n = count(report.n_disputed_cells as u64, "cell");
        tracing::info!("{}: {n} where lines disagree about the group", path.display());
    }
}

/// The table of a plan.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The table that was written.
    out: String,
    /// Name of the WAD's map; null for other plans.
    map: Option<String>,
    /// How cells were made: `kd` or `triangulation`.
    subdivide: String,
    #[serde(flatten)]
    pub(crate) table: Summary,
    /// Openings of walls up to this width were closed, in units of the plan; 0 if coordinates were taken exactly as they are.
    gap: f64,
    /// Joints that close such openings.
    n_joints: usize,
    /// Ends of walls that miss others by little, and yet by more than the gap.
    n_near_misses: usize,
    /// Walls that block nothing because the k-d tree cannot follow them.
    n_ignored_walls: usize,
    /// Crossings of lines whose point was rounded, towards visible.
    n_rounded_crossings: usize,
    /// Pieces of walls that block nothing because rounding could have closed a gap beside them.
    n_dropped_pieces: usize,
    /// Cells in regions whose lines disagree about the group.
    n_disputed_cells: usize,
    /// Seconds to make the cells.
    cut_seconds: f64,
    /// Seconds to find the visible pairs.
    see_seconds: f64,
}

impl Outcome {
    pub(crate) fn new(out: &Path, map: Option<String>, table: &Table, did: &PlanReport) -> Self {
        Self {
            out: out.display().to_string(),
            map,
            subdivide: did.subdivide.to_string(),
            table: Summary::of(table),
            gap: stated_gap(table),
            n_joints: did.n_joints,
            n_near_misses: did.n_near_misses,
            n_ignored_walls: did.n_ignored_walls,
            n_rounded_crossings: did.n_rounded_crossings,
            n_dropped_pieces: did.n_dropped_pieces,
            n_disputed_cells: did.n_disputed_cells,
            cut_seconds: did.cut_time.as_secs_f64(),
            see_seconds: did.see_time.as_secs_f64(),
        }
    }

    pub(super) fn brief(&self) -> Brief {
        let table = &self.table;
        let map = self.map.as_ref().map_or("a plan".to_owned(), |name| format!("map {name}"));
        let groups = |n: usize| if n > 0 { format!(", in {}", count(n as u64, "group")) } else { String::new() };
        let objects = |n: usize| if n > 0 { format!(", {}", count(n as u64, "object")) } else { String::new() };
        let cells = of_cells(table.n_cells, "cell", table.n_portals);
        Brief {
            kind: "plan",
            taken: format!("{map}{}", objects(table.n_objects)),
            method: format!("{}, exact planar stabbing", self.subdivision()),
            cells: format!("{cells}{}", groups(table.n_groups)),
            out: self.out.clone(),
            n_bytes: table.n_bytes,
            visible: format!("a viewer has {} of the floor on average", percent(table.mean_floor_share)),
            seconds: self.cut_seconds + self.see_seconds,
        }
    }

    pub(crate) fn subdivision(&self) -> &'static str {
        if self.subdivide == "kd" { "a k-d tree" } else { "a constrained triangulation" }
    }

    pub(crate) fn times(&self) -> String {
        times(self.cut_seconds, "plan", self.see_seconds)
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let map = self.map.as_ref().map_or(String::new(), |name| format!(" of map {name}"));
        writeln!(f, "wrote {}{map}, {}", self.out, bytes(self.table.n_bytes as u64))?;
        writeln!(f, "method         {} in the plane, exact planar stabbing", self.subdivision())?;
        if self.gap > 0.0 {
            let joints = count(self.n_joints as u64, "joint");
            writeln!(f, "precision      {joints} where walls miss each other by no more than {:.2e} units", self.gap)?;
        }
        write!(f, "{}", self.table)?;
        writeln!(f, "time           {}", self.times())
    }
}

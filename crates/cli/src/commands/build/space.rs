//! What was built from a scene in space, by sightlines.

use super::brief::{Brief, of_cells, of_viewer, write_viewer};
use super::limit::brief;
use crate::facts::{Stated, times};
use crate::output::{JsonSchema, Serialize, bytes, count};
use sightlines::bake::{DoorPortals, LimitReport, SceneReport};
use sightlines::cells::{Scene, SceneObject};
use sightlines::formats::SceneFile;
use sightlines::pvs::Table;
use sightlines::report::{Summary, ViewerShare};
use std::fmt;
use std::path::Path;

pub(super) fn warn(path: &Path, report: &SceneReport) {
    let say = |n: usize, noun: &str, what: &str| {
        if n > 0 {
            tracing::warn!("{}: {} of mirrors {what}", path.display(), count(n as u64, noun));
        }
    };
    say(report.n_other_mirror_triangles, "triangle", "do not reflect: they are not perpendicular to an axis");
    say(report.n_moving_mirrors, "object", "do not reflect: they move");
    say(report.n_lost_mirrors, "rectangle", "do not reflect everywhere: a part is in no cell");
}

/// Door of a scene, and the portals that it closes while it stands as it does in the file.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Door {
    /// The object, counted from 0.
    object: u32,
    /// Its name; names may repeat.
    name: String,
    /// The portals that it closes while it stands as it does in the file; the table takes it to be open.
    portals: Vec<u32>,
}

impl Door {
    pub(super) fn new(scene: &Scene, found: &DoorPortals) -> Self {
        let DoorPortals { object, portals } = found;
        let name = scene.objects()[*object as usize].name.clone();
        Self { object: *object, name, portals: portals.iter().map(|portal| portal.0).collect() }
    }
}

/// The table of a scene by sightlines alone; other methods and given cells are below. Of the triangles, each is either axis-aligned or hides
/// nothing; those that are detail are of both kinds.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outcome {
    /// The table that was written.
    out: String,
    #[serde(flatten)]
    stated: Stated,
    /// How cells were made: `kd`.
    subdivide: &'static str,
    /// Triangles.
    n_triangles: usize,
    /// Triangles perpendicular to an axis.
    n_axial_triangles: usize,
    /// Triangles that hide nothing because they are not perpendicular to an axis.
    n_other_triangles: usize,
    /// Triangles without area, which were left out.
    n_degenerate_triangles: usize,
    /// Triangles of detail objects; also counted in `n_axial_triangles` or `n_other_triangles`.
    n_detail_triangles: usize,
    /// Detail objects: too small to be used as occluders.
    n_detail_objects: usize,
    /// Size below which an object is detail.
    detail_below: f64,
    /// Rectangles that the scene was cut along.
    n_faces: usize,
    /// Pieces of these rectangles (`n_faces`) that hide nothing because of `--tau`.
    n_unfollowed: usize,
    /// Cells left out because they are inside solids.
    n_solid: usize,
    /// Cells left out because they are closed and show only back sides.
    n_hollow: usize,
    /// Cells left out because no way leads to them from the view region.
    n_unreachable: usize,
    #[serde(flatten)]
    pub(crate) table: Summary,
    /// What may be visible from a cell, on average.
    pub(crate) viewer: ViewerShare,
    /// If the scene has doors: all of them, in the order of the objects.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    doors: Vec<Door>,
    /// Rectangles that the walls were merged into.
    n_blockers: usize,
    /// Tests whether two boxes see each other; this, `n_programs`, `n_exact` and `n_assumed` may vary from run to run with several threads.
    n_asked: u64,
    /// Linear programs solved in doubles.
    n_programs: u64,
    /// Linear programs decided in exact numbers because doubles were too close to call.
    n_exact: u64,
    /// Pairs that count as visible because the limit of work was reached, or 106 bits were too few.
    n_assumed: u64,
    /// If there was a time limit and it was reached.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_limit: Option<LimitReport>,
    /// Seconds to make the cells.
    cut_seconds: f64,
    /// Seconds to find the visible pairs.
    see_seconds: f64,
}

impl Outcome {
    pub(crate) fn new(out: &Path, file: &SceneFile, table: &Table, report: &SceneReport) -> Self {
        let (cut, did) = (&report.cut, &report.counters);
        let triangles: Vec<u64> = file.scene.objects().iter().map(|o| o.triangles.len() as u64).collect();
        Self {
            out: out.display().to_string(),
            stated: Stated::new(&file.info),
            subdivide: "kd",
            n_triangles: file.info.n_triangles,
            n_axial_triangles: cut.n_axial_triangles,
            n_other_triangles: cut.n_other_triangles,
            n_degenerate_triangles: file.info.n_degenerate_triangles,
            n_detail_triangles: n_detail_triangles(&file.scene, cut.detail_below),
            n_detail_objects: cut.n_detail_objects,
            detail_below: cut.detail_below,
            n_faces: cut.n_faces,
            n_unfollowed: cut.n_unfollowed,
            n_solid: cut.n_solid,
            n_hollow: cut.n_hollow,
            n_unreachable: cut.n_unreachable,
            table: Summary::of(table),
            viewer: ViewerShare::of(table, &triangles),
            doors: report.doors.iter().map(|door| Door::new(&file.scene, door)).collect(),
            n_blockers: report.n_blockers,
            n_asked: did.n_asked,
            n_programs: did.n_programs,
            n_exact: did.n_exact,
            n_assumed: report.n_assumed,
            time_limit: report.limit,
            cut_seconds: report.cut_time.as_secs_f64(),
            see_seconds: report.see_time.as_secs_f64(),
        }
    }

    pub(super) fn brief(&self) -> Brief {
        let objects = count(self.table.n_objects as u64, "object");
        let triangles = count(self.n_triangles as u64, "triangle");
        let walls = match self.n_axial_triangles {
            n if n == self.n_triangles => "all".to_owned(),
            n => format!("{n} of them"),
        };
        Brief {
            kind: "scene",
            taken: format!("{}: {objects}, {triangles}, {walls} axis-aligned", self.stated),
            method: "sightlines".to_owned(),
            cells: of_cells(self.table.n_cells, "cell", self.table.n_portals) + " along walls",
            out: self.out.clone(),
            n_bytes: self.table.n_bytes,
            visible: of_viewer(&self.viewer) + &brief(self.time_limit),
            seconds: self.cut_seconds + self.see_seconds,
        }
    }

    /// All lines but the first, which says what was written.
    pub(crate) fn write_facts(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let o = self;
        writeln!(f, "scene          {}", o.stated)?;
        writeln!(f, "method         a k-d tree in space, exact axial stabbing of exact portals")?;
        let [n, axial, others] = [o.n_triangles, o.n_axial_triangles, o.n_other_triangles];
        writeln!(f, "triangles      {n}: {axial} axis-aligned, {others} others that hide nothing")?;
        if o.n_degenerate_triangles > 0 {
            writeln!(f, "left out       {} without area", count(o.n_degenerate_triangles as u64, "triangle"))?;
        }
        let objects = count(o.n_detail_objects as u64, "object");
        let small = count(o.n_detail_triangles as u64, "triangle");
        writeln!(f, "detail         {objects} below {} units with {small}, which hide nothing", o.detail_below)?;
        if o.n_unfollowed > 0 {
            writeln!(f, "given up       {} of faces, for --tau", count(o.n_unfollowed as u64, "piece"))?;
        }
        let [solid, hollow, far] = [o.n_solid, o.n_hollow, o.n_unreachable];
        writeln!(f, "not cells      {solid} boxes of solid matter, {hollow} hollow, {far} out of reach")?;
        write!(f, "{}", o.table)?;
        if !o.doors.is_empty() {
            let n_closing = o.doors.iter().filter(|door| !door.portals.is_empty()).count();
            writeln!(f, "doors          {}, open; {n_closing} close portals when shut", o.doors.len())?;
        }
        write_viewer(f, &o.viewer)?;
        let [asked, programs, exact, assumed] = [o.n_asked, o.n_programs, o.n_exact, o.n_assumed];
        writeln!(f, "effort         {asked} questions, {programs} linear programs, {exact} decided in integers")?;
        if assumed > 0 {
            writeln!(f, "assumed        {} visible, as too hard to decide", count(assumed, "pair"))?;
        }
        o.time_limit.iter().try_for_each(|left| writeln!(f, "time limit     {left}"))?;
        writeln!(f, "time           {}", times(o.cut_seconds, "scene", o.see_seconds))
    }
}

/// Triangles of objects that are smaller in every direction than detail may be.
fn n_detail_triangles(scene: &Scene, detail_below: f64) -> usize {
    let is_small = |o: &&SceneObject| {
        let b = o.bounds();
        (0..3).all(|k| b.max[k] - b.min[k] < detail_below)
    };
    scene.occluders().map(|(_, object)| object).filter(is_small).map(|o| o.triangles.len()).sum()
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.table.n_bytes as u64))?;
        self.write_facts(f)
    }
}

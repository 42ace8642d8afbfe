//! How a scene in space is baked, as arguments, and what was built by from-region queries.

use super::brief::{Brief, of_cells, of_viewer, write_viewer};
use super::limit::brief;
use super::space::Door;
use crate::buffers::BufferArgs;
use crate::error::Result;
use crate::facts::Stated;
use crate::named::one_of;
use crate::output::{JsonSchema, Serialize, bytes, count, seconds_of};
use sightlines::bake::eye_level::{EyeLevelOptions, EyeLevelSummary, UnitsFrom};
use sightlines::bake::places::{PlaceOptions, PlaceSummary};
use sightlines::bake::{BakeRequest, CellsFrom, LimitReport, RegionReport, SceneMethod};
use sightlines::formats::view_cells::read_view_cells;
use sightlines::formats::{ReadError, SceneFile};
use sightlines::multifocal::Split;
use sightlines::pvs::Table;
use sightlines::report::{Summary, ViewerShare};
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What decides which cells and objects are visible, for scenes in space.
#[derive(Debug, Clone, clap::Args)]
pub(crate) struct RegionArgs {
    /// Scenes in space: what decides which cells and objects are visible. All methods err towards visible: a weaker one
    /// shows more, and hides nothing wrongly. With sightlines only axis-aligned walls hide; with the others any surface may hide, from a whole
    /// cell at once; both hides what either hides. auto measures the input and chooses; -v prints the reasons. What auto calls sheets is
    /// both --planes 0. Without --grid, --cells, --n-cells and --cell-size, cells are cut along axis-aligned walls; where there are few of these, cells
    /// are at the height of eyes (--eye-height), or, for a method that is named, in a view region, and if the file does not say what is up,
    /// boxes anywhere (--n-cells)
    /// [default: auto; sightlines with --certify and --stab-trees]
    #[arg(long, value_name = "HOW", value_parser = one_of(&SceneMethod::all(), SceneMethod::name, SceneMethod::about))]
    method: Option<SceneMethod>,
    /// Scenes in space: use these boxes as cells, as JSON: {"cells":[{"id":"hall","min":[0,0,0],"max":[4,2.5,6]}]}
    #[arg(long, help_heading = "Cells", value_name = "FILE.json")]
    cells: Option<PathBuf>,
    /// Scenes in space: use a grid of boxes as cells, in the view region or the box of the scene
    #[arg(long, value_name = "NX,NY,NZ", value_parser = counts, conflicts_with = "cells")]
    grid: Option<[u32; 3]>,
    /// Scenes in space: so many boxes as cells, anywhere in the scene, cut where rays show that views differ; solid matter, and what is
    /// behind the backs of single-sided faces, is in none. For viewers who fly
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..), conflicts_with_all = ["cells", "grid"])]
    n_cells: Option<u32>,
    /// Scenes in space: the width of cells, at most, in scene units: of those at the height of eyes; with --n-cells, and where viewers may fly or
    /// most walls are axis-aligned, of boxes anywhere, no side of which is longer then, and of which there are as many as that needs
    #[arg(long, value_name = "SIZE", value_parser = crate::numbers::above_zero, allow_hyphen_values = true, conflicts_with_all = ["cells", "grid"])]
    cell_size: Option<f64>,
    /// Scenes in space: cells above floors, where eyes are from LOW to HIGH units above the ground, and 1, 2, 4 m wide or more, as their number
    /// allows, or by --cell-size. Shadows are propagated from cell to cell; viewers elsewhere see everything. The default for scenes with few
    /// axis-aligned walls, from 0 to 2.5 m
    #[arg(long, value_name = "LOW,HIGH", value_parser = heights, conflicts_with_all = ["cells", "grid", "n_cells"])]
    eye_height: Option<[f64; 2]>,
    /// Scenes in space: split objects of more than N triangles into parts of at most N, and find which cells may see each part. A part is a range of
    /// the object's triangles in file order, so an engine draws it by an offset and a count. Occluders are not split
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    parts: Option<u32>,
    #[command(flatten)]
    buffers: BufferArgs,
    /// Methods that look from whole cells: how often a cell may be halved where much is in doubt [default: 0]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=12))]
    split: Option<u32>,
}

fn parts<T: FromStr, const N: usize>(text: &str) -> Option<[T; N]> {
    let parts: Option<Vec<T>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    parts?.try_into().ok()
}

fn counts(text: &str) -> Result<[u32; 3], String> {
    let three = parts(text).filter(|n| n.iter().all(|&n| n > 0));
    three.ok_or("not three numbers from 1 on, with commas between; only scenes in space have a grid".to_owned())
}

fn heights(text: &str) -> Result<[f64; 2], String> {
    let two = parts(text).filter(|[low, high]: &[f64; 2]| low < high && low.is_finite() && high.is_finite());
    two.ok_or("not two numbers, the lower one first, with a comma between".to_owned())
}

impl RegionArgs {
    /// Puts these arguments into a request. Reads the file of view cells.
    ///
    /// # Errors
    /// [`ReadError`] with the file's name and the place in it.
    pub(crate) fn put_into(&self, request: &mut BakeRequest) -> Result<(), ReadError> {
        let Self { method, cells, grid, n_cells, cell_size, eye_height, parts, buffers, split } = self;
        let eye_level =
            EyeLevelOptions { cell_size: *cell_size, eye_height: *eye_height, ..EyeLevelOptions::default() };
        let places = PlaceOptions { n_cells: *n_cells, cell_size: *cell_size };
        request.cells = match (cells.as_ref().map(read_view_cells).transpose()?, grid) {
            (Some(cells), _) => Some(CellsFrom::Boxes(cells)),
            (None, Some(n)) => Some(CellsFrom::Grid(*n)),
            (None, None) if eye_height.is_some() => Some(CellsFrom::EyeLevel(eye_level)),
            (None, None) => n_cells.is_some().then_some(CellsFrom::Places(places)),
        };
        request.parts = *parts;
        request.cell_size = cell_size.filter(|_| request.cells.is_none());
        (request.method, request.buffers, request.split) =
            (*method, buffers.request(), split.map(|depth| Split { depth, ..Split::default() }));
        Ok(())
    }

    /// Whether a file of view cells was given.
    pub(crate) fn names_a_file(&self) -> bool {
        self.cells.is_some()
    }
}

/// With a `--method` of from-region occlusion, with given cells (`--grid`, `--cells`), with places (`--n-cells`) or with cells at the height of
/// eyes, as scenes with few axis-aligned walls have.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Outcome {
    /// The table that was written.
    out: String,
    #[serde(flatten)]
    stated: Stated,
    /// How cells were made: `kd`, `places`, `eye-level`, or `boxes` if they were given.
    subdivide: &'static str,
    /// How cells were cut, if they are places.
    #[serde(skip_serializing_if = "Option::is_none")]
    places: Option<Cuts>,
    /// How cells were cut, if they are at the height of eyes.
    #[serde(skip_serializing_if = "Option::is_none")]
    eye_level: Option<EyeLevel>,
    /// The methods that found what is hidden.
    method: String,
    /// Triangles.
    n_triangles: usize,
    #[serde(flatten)]
    pub(super) table: Summary,
    /// What may be visible from a cell, on average.
    pub(super) viewer: ViewerShare,
    /// Pairs of a cell and an object that may be visible from it.
    n_objects_seen: u64,
    /// Volumes that were tested: cells, and parts of cells.
    n_volumes: u64,
    /// Tests whether a box or a triangle is hidden from a volume.
    n_asked: u64,
    /// If the scene has doors and the cells are those of a k-d tree: all doors, in the order of the objects.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    doors: Vec<Door>,
    /// If there was a time limit and it was reached.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_limit: Option<LimitReport>,
    /// Of `seconds`, those to cut cells, which a time limit does not shorten.
    cut_seconds: f64,
    /// Seconds to find what is visible.
    seconds: f64,
}

/// Cells at the height of eyes.
#[derive(Debug, Serialize, JsonSchema)]
struct EyeLevel {
    /// The most cells above each other.
    n_layers: usize,
    /// Width of cells, at most, in scene units.
    cell_size: f64,
    /// Scene units that were taken for a metre.
    units_per_metre: f64,
    /// How that number was found.
    units_from: &'static str,
}

impl EyeLevel {
    fn new(of: EyeLevelSummary) -> Self {
        let units_from = match of.units_from {
            UnitsFrom::Clearances(_) => "the room below ceilings",
            UnitsFrom::Objects(_) => "the sizes of objects",
            UnitsFrom::Metres => "the file",
            _ => "the options",
        };
        let EyeLevelSummary { n_layers, cell_size, units_per_metre, .. } = of;
        Self { n_layers, cell_size, units_per_metre, units_from }
    }
}

impl fmt::Display for EyeLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { n_layers, cell_size, units_per_metre, units_from } = self;
        write!(f, "cells at eyes  at most {cell_size:.4} units wide, up to {n_layers} above each other; ")?;
        writeln!(f, "{units_per_metre} units are a metre, by {units_from}")
    }
}

/// Cuts of places.
#[derive(Debug, Serialize, JsonSchema)]
struct Cuts {
    /// Places.
    n_cells: usize,
    /// Longest side of a place.
    cell_size: f64,
    /// Cuts along walls.
    n_along_walls: usize,
    /// Other cuts where rays show that views differ.
    n_by_views: usize,
    /// Other cuts, of long boxes.
    n_by_size: usize,
    /// Boxes inside of solid matter, which are no cells.
    n_solid: usize,
    /// Boxes behind the backs of single-sided faces, which are no cells.
    n_behind: usize,
}

impl Cuts {
    fn new(cut: PlaceSummary) -> Self {
        let PlaceSummary { n_cells, cell_size, n_along_walls, n_by_views, n_by_size, n_solid, n_behind, .. } = cut;
        Self { n_cells, cell_size, n_along_walls, n_by_views, n_by_size, n_solid, n_behind }
    }
}

impl fmt::Display for Cuts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [walls, views, size] = [self.n_along_walls, self.n_by_views, self.n_by_size];
        let (size_of, cells) = (self.cell_size, count(self.n_cells as u64, "place"));
        let Self { n_solid, n_behind, .. } = self;
        write!(f, "cells          {cells} of at most {size_of:.4} units: cut {walls} times along walls, ")?;
        writeln!(f, "{views} where views differ, {size} for size; {n_solid} solid, {n_behind} behind backs")
    }
}

impl Outcome {
    pub(super) fn new(out: &Path, file: &SceneFile, given_cells: bool, table: &Table, report: &RegionReport) -> Self {
        let triangles: Vec<u64> = file.scene.objects().iter().map(|o| o.triangles.len() as u64).collect();
        let asked = &report.effort.queries;
        Self {
            out: out.display().to_string(),
            stated: Stated::new(&file.info),
            subdivide: match (report.places, report.eye_level, given_cells) {
                (Some(_), ..) => "places",
                (None, Some(_), _) => "eye-level",
                (None, None, true) => "boxes",
                (None, None, false) => "kd",
            },
            places: report.places.map(Cuts::new),
            eye_level: report.eye_level.map(EyeLevel::new),
            method: table.info_value("method").unwrap_or_default().to_owned(),
            n_triangles: file.info.n_triangles,
            table: Summary::of(table),
            viewer: ViewerShare::of(table, &triangles),
            n_objects_seen: report.n_objects_seen,
            n_volumes: report.effort.n_volumes,
            n_asked: asked.groups + asked.boxes + asked.triangles,
            doors: report.doors.iter().map(|door| Door::new(&file.scene, door)).collect(),
            time_limit: report.limit,
            cut_seconds: report.cut_time.as_secs_f64(),
            seconds: report.time.as_secs_f64(),
        }
    }

    pub(super) fn brief(&self) -> Brief {
        let Summary { n_cells, n_portals, n_objects, n_bytes, .. } = self.table;
        let cells = match (self.subdivide, &self.places) {
            ("kd", _) => of_cells(n_cells, "cell", n_portals) + " along walls",
            (_, Some(cut)) => format!("{} of at most {:.4} units", of_cells(n_cells, "place", 0), cut.cell_size),
            ("eye-level", _) => of_cells(n_cells, "cell", 0) + " at the height of eyes",
            _ => of_cells(n_cells, "given cell", 0),
        };
        let objects = count(n_objects as u64, "object");
        Brief {
            kind: "scene",
            taken: format!("{}: {objects}, {}", self.stated, count(self.n_triangles as u64, "triangle")),
            method: self.method.clone(),
            cells,
            out: self.out.clone(),
            n_bytes,
            visible: of_viewer(&self.viewer) + &brief(self.time_limit),
            seconds: self.seconds,
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "wrote {}, {}", self.out, bytes(self.table.n_bytes as u64))?;
        writeln!(f, "scene          {}", self.stated)?;
        let cells = match self.subdivide {
            "kd" => "the cells of a k-d tree",
            "places" => "places as cells",
            "eye-level" => "cells at the height of eyes",
            _ => "boxes as cells",
        };
        writeln!(f, "method         {}, {cells}", self.method)?;
        self.places.iter().try_for_each(|cuts| write!(f, "{cuts}"))?;
        self.eye_level.iter().try_for_each(|cells| write!(f, "{cells}"))?;
        writeln!(f, "triangles      {}", self.n_triangles)?;
        write!(f, "{}", self.table)?;
        write_viewer(f, &self.viewer)?;
        writeln!(f, "objects        {} of cells and objects may be seen", count(self.n_objects_seen, "pair"))?;
        if self.n_volumes > 0 {
            writeln!(f, "effort         {}, {} questions", count(self.n_volumes, "volume"), self.n_asked)?;
        }
        self.time_limit.iter().try_for_each(|left| writeln!(f, "time limit     {left}"))?;
        let [cut, all] = [self.cut_seconds, self.seconds].map(seconds_of);
        writeln!(f, "time           {all}, {cut} of it to cut cells")
    }
}

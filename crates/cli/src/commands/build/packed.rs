//! A table in packed form, as `build` writes it under a name that ends in `.pvz`.

use super::announce;
use super::brief::{Brief, of_cells};
use super::limit::{self, Clock};
use super::source::Source;
use crate::buffers::method_failed;
use crate::error::{ErrorAbout, Result, anyhow};
use crate::facts::Stated;
use crate::kept::Kept;
use crate::output::{self, JsonSchema, Serialize, count};
use crate::progress::Bar;
use sightlines::bake::region::PackRegionsError;
use sightlines::bake::{BakeError, Bakeable, LimitReport, PreparedBake, Recipe, RegionReport, Runtime, SceneMethod};
use sightlines::formats::SceneFile;
use sightlines::packed::format::MAX_SMALL_CELLS;
use sightlines::packed::{PackOptions, PackReport, SizeClass, pack};
use sightlines::pvs::Table;
use std::fmt;
use std::path::Path;

/// How the name of a packed output ends.
pub(super) const ENDING: &str = "pvz";

pub(super) fn bytes_of(table: &Table, path: &Path, out: &Path, class: Option<SizeClass>) -> Result<Vec<u8>> {
    if !output::has_ending(out, ENDING) {
        return Ok(table.to_bytes());
    }
    let options = PackOptions { class, ..PackOptions::default() };
    pack(table, &options).in_file(path)
}

/// The scene, if its table is large and can be written row by row.
pub(super) fn of_rows<'s>(
    source: &'s Source,
    recipe: &Recipe,
    (out, class): (&Path, Option<SizeClass>),
) -> Option<&'s SceneFile> {
    let Bakeable::Scene(file) = &source.content else { return None };
    let n = recipe.cells.most()?;
    let is_large = class.map_or(n > MAX_SMALL_CELLS as u64, |class| class == SizeClass::Large);
    let is_by_cell = matches!(recipe.method, SceneMethod::FromRegion(_));
    (is_large && is_by_cell && output::has_ending(out, ENDING)).then_some(file)
}

pub(super) fn write_rows(
    path: &Path,
    file: &SceneFile,
    (prepared, runtime): (&PreparedBake<'_>, &Runtime<'_>),
    plan: announce::Plan,
    (out, show_progress, clock): (&Path, bool, &Clock),
    kept: &Kept<'_>,
) -> Result<Outcome> {
    let bar = Bar::new("visibility", show_progress);
    let announcer = announce::Announcer::new(&bar, &plan, show_progress);
    let runtime = Runtime { progress: Some(&announcer), ..*runtime };
    // Rows are small in comparison with what it takes to find them.
    let made = prepared.run_packed(Vec::new(), &runtime);
    drop(bar);
    let (bytes, report, packed) = made.map_err(|error| match error {
        PackRegionsError::Bake(BakeError::Method(source)) => method_failed(path, source),
        error => anyhow!("{}: {error}", path.display()),
    })?;
    clock.warn(path, report.limit, report.cut_time);
    kept.before_writing()?;
    output::save(out, &bytes)?;
    Ok(Outcome::new(out, file, &report, &packed))
}

/// Of packed tables in the large layout: more than 65,536 cells without portals, or `--class large`.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct Outcome {
    /// The table that was written.
    out: String,
    #[serde(flatten)]
    stated: Stated,
    /// The method that found what is hidden.
    method: String,
    /// Triangles.
    n_triangles: usize,
    /// Cells.
    n_cells: usize,
    /// Objects.
    n_objects: usize,
    /// Bytes of the file.
    n_bytes: u64,
    /// Of these, bytes of the rows.
    n_row_bytes: u64,
    /// Unordered pairs of different cells that may see each other.
    n_visible_pairs: u64,
    /// Pairs of a cell and an object that may be visible from it.
    n_objects_seen: u64,
    /// If there was a time limit and it was reached.
    #[serde(skip_serializing_if = "Option::is_none")]
    time_limit: Option<LimitReport>,
    /// Seconds for everything.
    seconds: f64,
    /// What a cell is.
    #[serde(skip)]
    noun: &'static str,
}

impl Outcome {
    fn new(out: &Path, file: &SceneFile, report: &RegionReport, packed: &PackReport) -> Self {
        Self {
            out: out.display().to_string(),
            stated: Stated::new(&file.info),
            method: report.method.clone().unwrap_or_default(),
            n_triangles: file.info.n_triangles,
            n_cells: packed.n_classes,
            n_objects: file.scene.objects().len(),
            n_bytes: packed.bytes,
            n_row_bytes: packed.row_bytes,
            n_visible_pairs: report.n_visible_pairs,
            n_objects_seen: report.n_objects_seen,
            time_limit: report.limit,
            seconds: report.time.as_secs_f64(),
            noun: match (report.places, report.eye_level) {
                (Some(_), _) => "place",
                (None, Some(_)) => "cell",
                (None, None) => "given cell",
            },
        }
    }

    fn means(&self) -> [f64; 2] {
        let n = self.n_cells.max(1) as f64;
        [(2.0 * self.n_visible_pairs as f64 + n) / n, self.n_objects_seen as f64 / n]
    }

    pub(super) fn brief(&self) -> Brief {
        let [cells, objects] = self.means();
        Brief {
            kind: "scene",
            taken: format!(
                "{}: {}, {}",
                self.stated,
                count(self.n_objects as u64, "object"),
                count(self.n_triangles as u64, "triangle")
            ),
            method: self.method.clone(),
            cells: of_cells(self.n_cells, self.noun, 0),
            out: self.out.clone(),
            n_bytes: usize::try_from(self.n_bytes).unwrap_or(usize::MAX),
            visible: format!("a cell sees {cells:.0} cells and {objects:.0} objects on average")
                + &limit::brief(self.time_limit),
            seconds: self.seconds,
        }
    }
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [cells, objects] = self.means();
        writeln!(f, "cells          {}", of_cells(self.n_cells, self.noun, 0))?;
        writeln!(f, "method         {}", self.method)?;
        writeln!(f, "visible        {cells:.1} cells and {objects:.1} objects from a cell on average")?;
        writeln!(f, "wrote          {}, {} bytes, {} of them rows", self.out, self.n_bytes, self.n_row_bytes)?;
        self.time_limit.iter().try_for_each(|left| writeln!(f, "time limit     {left}"))
    }
}

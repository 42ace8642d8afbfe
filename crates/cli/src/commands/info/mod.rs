//! `info`: what a file holds.

pub(crate) mod packed;
pub(crate) mod plan;
pub(crate) mod quake;
pub(crate) mod scene;
pub(crate) mod wad;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use crate::facts::{DigestFacts, DoorFacts, Facts, FrameFacts, Source, StabFacts, write_doors};
use crate::input;
use crate::output::{JsonSchema, Serialize, bytes, count};
use crate::plans::PlanArgs;
use crate::surfaces::SurfaceArgs;
use sightlines::formats::InputKind;
use sightlines::pvs::{CellRecord, ObjectId, Table};
use sightlines::report::Summary;
use std::fmt;
use std::path::{Path, PathBuf};

/// Arguments of `info`.
#[derive(Debug, clap::Args)]
pub(crate) struct InfoArgs {
    /// A table (plain or packed), a WAD, a GeoJSON or DXF floor plan, a scene as GLB, glTF or OBJ, a Quake map, or a portal
    /// file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    #[command(flatten)]
    plans: PlanArgs,
    /// Tables: also list the objects, with node and primitive in the glTF that the table was made of
    #[arg(long, help_heading = "Output")]
    objects: bool,
    #[command(flatten)]
    json: JsonArg,
}

pub(crate) fn run(args: &InfoArgs, _: Verbosity) -> Result<Done> {
    let path = &args.file;
    let kind = input::kind_of(path)?;
    if kind.is_some_and(|kind| kind != InputKind::Scene) {
        input::refuse(path, &args.surfaces.given(), "scenes in space", "none")?;
    }
    if !matches!(kind, Some(InputKind::Table | InputKind::Packed)) {
        input::refuse(path, &[("--objects", args.objects)], "tables", "none")?;
    }
    let reading = args.plans.options(path)?;
    let json = args.json;
    Ok(match kind {
        Some(InputKind::Table) => Done::new(json, TableInfo::new(path, &input::table(path)?, args.objects)),
        Some(InputKind::Packed) => Done::new(json, packed::PackedInfo::read(path, args.objects)?),
        Some(InputKind::Wad) => Done::new(json, wad::WadInfo::read(path)?),
        Some(InputKind::Plan) => Done::new(json, plan::PlanInfo::read(path, &reading)?),
        Some(InputKind::Scene) => Done::new(json, scene::SceneInfo::read(path, &args.surfaces.options())?),
        Some(InputKind::Prt) => Done::new(json, quake::PrtInfo::read(path)?),
        Some(InputKind::Bsp) => Done::new(json, quake::BspInfo::read(path)?),
        _ => {
            let expected =
                "a table nor a WAD nor a GeoJSON or DXF plan nor a GLB, glTF or OBJ nor a Quake map or portal file";
            return Err(input::neither(path, expected));
        }
    })
}

/// What a table holds.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct TableInfo {
    /// The file.
    file: String,
    /// `table`.
    kind: &'static str,
    #[serde(flatten)]
    summary: Summary,
    /// The box around its cells, its lower corner and its upper one, along the axes of the table; null for a table of a portal file.
    extent: Option<[[f64; 3]; 2]>,
    /// Its stab trees, if it has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    stab: Option<StabFacts>,
    /// Objects of which node and primitive are known.
    n_objects_with_source: usize,
    /// Its doors.
    doors: Vec<DoorFacts>,
    /// With `--objects`: all objects.
    #[serde(skip_serializing_if = "Option::is_none")]
    objects: Option<Vec<Object>>,
    /// Its frame, if it has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<FrameFacts>,
    /// Digests of what the table was made of, as hexadecimal numbers of 128 bits; older tables have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    digests: Option<DigestFacts>,
    /// Keys and values that the table has for people: how it was made. All values are texts.
    #[serde(serialize_with = "as_map")]
    #[schemars(with = "std::collections::BTreeMap<String, String>")]
    info: Vec<(String, String)>,
}

/// An object of a table.
#[derive(Debug, Serialize, JsonSchema)]
struct Object {
    /// The object.
    id: u32,
    /// Its name.
    name: String,
    /// If it is known.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    source: Option<Source>,
}

impl fmt::Display for Object {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "  {:>5} {}", self.id, self.name)?;
        self.source.iter().try_for_each(|source| write!(f, ", {source}"))
    }
}

/// The line about the objects that can be found again.
fn write_sources(f: &mut fmt::Formatter<'_>, n: usize) -> fmt::Result {
    if n == 0 {
        return Ok(());
    }
    writeln!(f, "found again    {}, by node and primitive", count(n as u64, "object"))
}

/// The box around all cells.
fn extent_of(table: &Table) -> Option<[[f64; 3]; 2]> {
    let cells = Some(table.cells()).filter(|cells| table.has_places() && !cells.is_empty())?;
    let around = |end: fn(f64, f64) -> f64, corner: fn(&CellRecord) -> [f64; 3]| {
        let corners = cells.iter().map(corner);
        corners.reduce(|a, b| std::array::from_fn(|k| end(a[k], b[k]))).unwrap_or_default()
    };
    Some([around(f64::min, |cell| cell.min), around(f64::max, |cell| cell.max)])
}

fn as_map<S: serde::Serializer>(pairs: &[(String, String)], out: S) -> Result<S::Ok, S::Error> {
    out.collect_map(pairs.iter().map(|(key, value)| (key, value)))
}

impl TableInfo {
    fn new(path: &Path, table: &Table, with_objects: bool) -> Self {
        let file = path.display().to_string();
        let mut summary = Summary::of(table);
        if input::is_of_portals(table) {
            // The boxes are around portals, not around cells: volumes are unknown. Null in JSON.
            (summary.mean_floor_share, summary.floor) = (f64::NAN, f64::NAN);
        }
        let (stab, frame) = (StabFacts::of(table), table.frame().map(FrameFacts::from));
        let digests = table.digest().map(DigestFacts::from);
        let ids = || (0..table.objects().len() as u32).map(ObjectId);
        let object = |id: ObjectId| Object {
            id: id.0,
            name: table.objects()[id.idx()].name.clone(),
            source: table.source_of(id).map(Source::from),
        };
        Self {
            file,
            kind: "table",
            summary,
            extent: extent_of(table),
            stab,
            n_objects_with_source: ids().filter(|&id| table.source_of(id).is_some()).count(),
            doors: table.doors().iter().map(DoorFacts::from).collect(),
            objects: with_objects.then(|| ids().map(object).collect()),
            frame,
            digests,
            info: table.info().to_vec(),
        }
    }
}

impl fmt::Display for TableInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dimension = self.summary.dimension;
        writeln!(f, "{}: visibility table in {dimension}D, {}", self.file, bytes(self.summary.n_bytes as u64))?;
        write!(f, "{}", Facts(&self.summary))?;
        if let Some([low, high]) = self.extent {
            let [low, high] = [low, high].map(|corner| corner[..usize::from(dimension)].to_vec());
            writeln!(f, "extent         {low:?} to {high:?}")?;
        }
        self.stab.iter().try_for_each(|stab| write!(f, "{stab}"))?;
        write_sources(f, self.n_objects_with_source)?;
        write_doors(f, &self.doors)?;
        self.objects.iter().flatten().try_for_each(|object| writeln!(f, "{object}"))?;
        self.frame.iter().try_for_each(|frame| writeln!(f, "frame          {frame}"))?;
        self.digests.iter().try_for_each(|digests| write!(f, "{digests}"))?;
        self.info.iter().try_for_each(|(key, value)| writeln!(f, "{key:<14} {value}"))
    }
}

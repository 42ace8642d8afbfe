//! `info`: what a file holds.

pub(crate) mod packed;
pub(crate) mod plan;
pub(crate) mod quake;
pub(crate) mod scene;
pub(crate) mod wad;

use crate::command::{Done, JsonArg, Verbosity};
use crate::error::Result;
use crate::input;
use crate::output::{JsonSchema, Serialize, bytes};
use crate::plans::PlanArgs;
use crate::surfaces::SurfaceArgs;
use sightlines::formats::InputKind;
use sightlines::report::{self, Summary};
use std::fmt;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct InfoArgs {
    #[arg(value_name = "FILE", help = crate::input::with_formats(
        "A table (plain or packed), a WAD, a {plans} floor plan, a scene as {scenes}, a Quake map, or a portal file"
    ))]
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
        Some(InputKind::Table) => Done::new(json, TableInfo::read(path, args.objects)?),
        Some(InputKind::Packed) => Done::new(json, packed::PackedInfo::read(path, args.objects)?),
        Some(InputKind::Wad) => Done::new(json, wad::WadInfo::read(path)?),
        Some(InputKind::Plan) => Done::new(json, plan::PlanInfo::read(path, &reading)?),
        Some(InputKind::Scene) => Done::new(json, scene::SceneInfo::read(path, &args.surfaces.options())?),
        Some(InputKind::Prt) => Done::new(json, quake::PrtInfo::read(path)?),
        Some(InputKind::Bsp) => Done::new(json, quake::BspInfo::read(path)?),
        _ => {
            let expected = "a table nor a WAD nor a {plans} plan nor a {scenes} nor a Quake map or portal file";
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
    info: report::TableInfo,
}

impl TableInfo {
    fn read(path: &Path, with_objects: bool) -> Result<Self> {
        let info = report::TableInfo::of(&input::table(path)?, with_objects);
        Ok(Self { file: path.display().to_string(), kind: "table", info })
    }
}

impl fmt::Display for TableInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Summary { dimension, n_bytes, .. } = self.info.summary;
        writeln!(f, "{}: visibility table in {dimension}D, {}", self.file, bytes(n_bytes as u64))?;
        write!(f, "{}", self.info)
    }
}

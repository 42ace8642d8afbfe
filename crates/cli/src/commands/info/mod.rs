//! `info`: what a file holds.

mod packed;
mod plan;
mod quake;
mod scene;
mod wad;

use crate::Answer;
use crate::error::InputError;
use crate::facts::{DigestFacts, Facts, FrameFacts, StabFacts};
use crate::file_error::{FileError, from_file_error};
use crate::input;
use crate::output::{self, bytes};
use crate::surfaces::SurfaceArgs;
use serde::Serialize;
use sightlines::formats::InputKind;
use sightlines::pvs::Table;
use sightlines::report::Summary;
use std::fmt;
use std::path::{Path, PathBuf};

/// Why `info` fails; exit code 2.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A file cannot be read, used or written.
    #[error(transparent)]
    File(FileError),
}

from_file_error!(Error);

/// Arguments of `info`.
#[derive(Debug, clap::Args)]
pub(crate) struct InfoArgs {
    /// A table (plain or packed), a WAD, a GeoJSON floor plan, a scene as GLB, glTF or OBJ, a Quake map, or a portal
    /// file
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    surfaces: SurfaceArgs,
    /// Print the result as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(crate) fn run(args: &InfoArgs) -> Result<Answer, Error> {
    let path = &args.file;
    let kind = input::kind_of(path)?;
    if kind.is_some_and(|kind| kind != InputKind::Scene) {
        input::refuse(path, &args.surfaces.given(), "scenes in space", "none")?;
    }
    match kind {
        Some(InputKind::Table) => output::print(args.json, &TableInfo::new(path, &input::table(path)?))?,
        Some(InputKind::Packed) => output::print(args.json, &packed::PackedInfo::read(path)?)?,
        Some(InputKind::Wad) => output::print(args.json, &wad::WadInfo::read(path)?)?,
        Some(InputKind::Plan) => output::print(args.json, &plan::PlanInfo::read(path)?)?,
        Some(InputKind::Scene) => output::print(args.json, &scene::SceneInfo::read(path, &args.surfaces.options())?)?,
        Some(InputKind::Prt) => output::print(args.json, &quake::PrtInfo::read(path)?)?,
        Some(InputKind::Bsp) => output::print(args.json, &quake::BspInfo::read(path)?)?,
        _ => {
            let expected = "a table nor a WAD nor a GeoJSON plan nor a GLB, glTF or OBJ nor a Quake map or portal file";
            return Err(InputError::Kind { path: path.clone(), expected }.into());
        }
    }
    Ok(Answer::Yes)
}

/// What a table holds.
#[derive(Debug, Serialize)]
struct TableInfo {
    file: String,
    kind: &'static str,
    #[serde(flatten)]
    summary: Summary,
    /// If the table has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    stab: Option<StabFacts>,
    /// If the table stands along axes of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<FrameFacts>,
    /// If the table has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    digests: Option<DigestFacts>,
    /// How the table was made, as it states.
    #[serde(serialize_with = "as_map")]
    info: Vec<(String, String)>,
}

fn as_map<S: serde::Serializer>(pairs: &[(String, String)], out: S) -> Result<S::Ok, S::Error> {
    out.collect_map(pairs.iter().map(|(key, value)| (key, value)))
}

impl TableInfo {
    fn new(path: &Path, table: &Table) -> Self {
        let file = path.display().to_string();
        let mut summary = Summary::of(table);
        if input::is_of_portals(table) {
            // The boxes are around portals, not around cells: volumes are unknown. Null in JSON.
            (summary.mean_floor_share, summary.floor) = (f64::NAN, f64::NAN);
        }
        let (stab, frame) = (StabFacts::of(table), table.frame().map(FrameFacts::from));
        let digests = table.digest().map(DigestFacts::from);
        Self { file, kind: "table", summary, stab, frame, digests, info: table.info().to_vec() }
    }
}

impl fmt::Display for TableInfo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let dimension = self.summary.dimension;
        writeln!(f, "{}: visibility table in {dimension}D, {}", self.file, bytes(self.summary.n_bytes as u64))?;
        write!(f, "{}", Facts(&self.summary))?;
        self.stab.iter().try_for_each(|stab| write!(f, "{stab}"))?;
        self.frame.iter().try_for_each(|frame| writeln!(f, "frame          {frame}"))?;
        self.digests.iter().try_for_each(|digests| write!(f, "{digests}"))?;
        self.info.iter().try_for_each(|(key, value)| writeln!(f, "{key:<14} {value}"))
    }
}

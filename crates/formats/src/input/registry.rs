//! All formats that are read, a line for each.

use super::format::{Format, InputKind, Sign};
use super::{Folder, Input, Neighbours, Source};
use crate::error::{Malformed, ReadErrorKind};
use crate::quake::prt::{self, PrtDialect};
use crate::quake::{Bsp, BspFormat};
use crate::scene::{GLB_MAGIC, SceneReadOptions, parse_gltf_with, parse_obj_with};
use crate::{PlanReadOptions, SceneFile, Wad, dxf, geojson, levels, view_cells};
use sightlines_pvs::{Table, format};
use std::path::Path;

/// The formats that are read. What lies further up is recognised first.
#[rustfmt::skip]
pub static FORMATS: [Format; 12] = [
    Format { name: "wad", titles: &["WAD"], noun: "a WAD", extensions: &["wad"], sign: Sign::Magic(&[b"IWAD", b"PWAD"]), kind: InputKind::Wad, read: |s| Ok(Input::Wad(Wad::parse(s.bytes()?.into_owned())?)) },
    Format { name: "pvs", titles: &["PVS"], noun: "a table", extensions: &["pvs"], sign: Sign::Magic(&[&format::MAGIC]), kind: InputKind::Table, read: |s| Ok(Input::Table(Box::new(Table::from_bytes(&s.bytes()?)?))) },
    Format { name: "pvz", titles: &["PVZ"], noun: "a packed table", extensions: &["pvz"], sign: Sign::Magic(&[PACKED]), kind: InputKind::Packed, read: |_| Ok(Input::Packed) },
    Format { name: "proofs", titles: &["CERT"], noun: "proofs of a table", extensions: &["cert"], sign: Sign::Magic(&[PROOFS]), kind: InputKind::Proofs, read: |_| Ok(Input::Proofs) },
    Format { name: "gltf", titles: &["GLB", "glTF"], noun: "a scene", extensions: &["glb", "gltf"], sign: Sign::MagicOrNamedJson(GLB_MAGIC), kind: InputKind::Scene, read: |s| scene(s, parse_gltf_with) },
    Format { name: "obj", titles: &["OBJ"], noun: "a scene", extensions: &["obj"], sign: Sign::Name, kind: InputKind::Scene, read: |s| scene(s, parse_obj_with) },
    Format { name: "prt", titles: &["PRT"], noun: "a portal file", extensions: &["prt"], sign: Sign::Magic(&PrtDialect::MAGICS), kind: InputKind::Prt, read: |s| Ok(Input::Prt(prt::parse_prt(&s.bytes()?)?)) },
    Format { name: "bsp", titles: &["BSP"], noun: "a Quake map", extensions: &["bsp"], sign: Sign::Magic(&BspFormat::MAGICS), kind: InputKind::Bsp, read: |s| Ok(Input::Bsp(Bsp::parse(s.bytes()?.into_owned())?)) },
    Format { name: "levels", titles: &["JSON"], noun: "an index of levels", extensions: &["json"], sign: Sign::JsonMember("sightlines_levels"), kind: InputKind::Levels, read: |s| Ok(Input::Levels(levels::parse_levels_index(&s.bytes()?)?)) },
    Format { name: "view-cells", titles: &["JSON"], noun: "view cells", extensions: &["json"], sign: Sign::JsonMember("cells"), kind: InputKind::ViewCells, read: |s| Ok(Input::ViewCells(view_cells::parse_view_cells(&s.bytes()?)?)) },
    Format { name: "geojson", titles: &["GeoJSON"], noun: "JSON, such as a floor plan", extensions: &["geojson", "json", "geojsonl", "geojsons", "ndjson", "jsonl"], sign: Sign::Json, kind: InputKind::Plan, read: plan },
    Format { name: "dxf", titles: &["DXF"], noun: "a DXF drawing", extensions: &["dxf"], sign: Sign::Dxf, kind: InputKind::Plan, read: |s| Ok(Input::Plan(dxf::parse_dxf(&s.bytes()?, &PlanReadOptions::default())?)) },
];

/// The first bytes of a packed table: `sightlines_packed::format::MAGIC`, which this crate does not use.
const PACKED: &[u8] = b"\x89PVP\r\n\x1a\n";
/// The first bytes of proofs: those that `sightlines_certificates` writes, which this crate does not use.
const PROOFS: &[u8] = b"SLPROOFS";

/// The format of a file that has this name and begins with these bytes; `None` if no format recognises it.
///
/// * `head`: all of the file, or at least its first [`HEAD`](super::HEAD) bytes.
///
/// The content decides. Portals of Half-Life begin with a number, which decides nothing. Where it is JSON, which many formats are, and where it decides nothing, the extension of the name does.
pub fn detect(name: &Path, head: &[u8]) -> Option<&'static Format> {
    let by_content = FORMATS.iter().find(|format| format.sign.is_in(head));
    // Formats of JSON are distinguished by content, so the last of them is what a name means without any.
    let by_name = FORMATS.iter().rfind(|format| format.is_name(name));
    match (by_content, by_name) {
        (Some(content), Some(named)) if content.sign.is_json() && named.sign.is_named_before_json() => Some(named),
        (Some(content), _) => Some(content),
        (None, named) => named,
    }
}

/// The formats that hold such content, as one says them: `GLB, glTF or OBJ`.
pub fn titles(kind: InputKind) -> String {
    let mut all: Vec<&str> =
        FORMATS.iter().filter(|format| format.kind == kind).flat_map(|f| f.titles).copied().collect();
    let last = all.pop().unwrap_or_default();
    if all.is_empty() { last.to_owned() } else { format!("{} or {last}", all.join(", ")) }
}

fn scene(
    source: &Source<'_>,
    parse: impl Fn(&[u8], Option<&dyn Neighbours>, &SceneReadOptions) -> Result<SceneFile, Malformed>,
) -> Result<Input, ReadErrorKind> {
    let (bytes, options) = (source.bytes()?, SceneReadOptions::default());
    Ok(Input::Scene(match *source {
        Source::File(path) => parse(&bytes, Some(&Folder::of(path)), &options),
        Source::Memory { beside, .. } => parse(&bytes, beside, &options),
    }?))
}

/// A plan in a file is read as it goes: a large file that is no plan costs no memory.
fn plan(source: &Source<'_>) -> Result<Input, ReadErrorKind> {
    Ok(Input::Plan(match *source {
        Source::File(path) => geojson::read_plan_file(path).map_err(|error| error.kind)?,
        Source::Memory { bytes, .. } => geojson::parse_plan_file(bytes)?,
    }))
}

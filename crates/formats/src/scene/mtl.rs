//! Wavefront MTL: which materials of an OBJ let light through.

use crate::bytes::text_lines;
use std::collections::BTreeMap;

/// Why each material of a library lets light through; `None` for one that is opaque. Of several with a name, one that lets
/// light through counts: readers differ in which of them they take.
///
/// See-through are materials with `d` below 1, `Tr` above 0, `map_d` or `map_Tr`, and an `illum` that names glass or
/// refraction (4, 6, 7, 9), or what only catches shadows (10). A number that is not known or cannot be read counts as see-through. `Tf` only colours what one of these lets
/// through, so alone it lets nothing through; many programs write it for every material. Textures are not read: alpha in one
/// that `map_Kd` names is not weighed.
///
/// # Source
/// Wavefront Technologies, Advanced Visualizer manual, the format of `.mtl`; `Tr` as most programs write it, 1 - `d`.
///
/// Names are as they stand in the line, `#` included; see [`before_comment`].
pub(super) fn parse_mtl(bytes: &[u8]) -> BTreeMap<String, Option<String>> {
    let mut materials = BTreeMap::new();
    let mut current: Option<&mut Option<String>> = None;
    for line in text_lines(bytes) {
        // What is not UTF-8 becomes marks, as it does in the OBJ.
        let line = String::from_utf8_lossy(line);
        let line = line.trim();
        let (keyword, rest) = line.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((line, ""));
        if keyword == "newmtl" {
            current = Some(materials.entry(rest.trim().to_owned()).or_insert(None));
            continue;
        }
        let keyword = before_comment(keyword);
        let rest = before_comment(rest);
        let Some(found) = current.as_deref_mut() else { continue };
        // `d -halo 0.5` has its number last.
        let number = || rest.split_ascii_whitespace().next_back().and_then(|word| word.parse::<f64>().ok());
        let lets_through = match keyword.to_ascii_lowercase().as_str() {
            "d" => !number().is_some_and(|d| d >= 1.0) || rest.contains("-halo"),
            "tr" => !number().is_some_and(|tr| tr <= 0.0),
            "map_d" | "map_tr" => true,
            "illum" => number().is_none_or(|illum| ![0.0, 1.0, 2.0, 3.0, 5.0, 8.0].contains(&illum)),
            _ => false,
        };
        if lets_through && found.is_none() {
            let value = if keyword.starts_with("map") { "" } else { rest };
            *found = Some(format!("{keyword} {value}").trim_end().to_owned());
        }
    }
    materials
}

/// What stands before a `#`. Behind a number it begins a comment; in a name it may be a part of it, as programs write `Material #25`.
pub(super) fn before_comment(text: &str) -> &str {
    text.split('#').next().unwrap_or_default().trim()
}

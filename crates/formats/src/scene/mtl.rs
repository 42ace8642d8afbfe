//! Wavefront MTL: which materials of an OBJ let light through.

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
    for line in bytes.split(|&b| b == b'\n') {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glass_is_told_from_walls() {
        let text = "# materials\nd 0.1\nnewmtl wall\nKd 1 1 1\nTf 0.6 0.6 0.6\nd 1.0\nTr 0\nillum 2\nnewmtl glass\r\n  d 0.25\r\n\
                    newmtl water\nTr 0.5 # half\nnewmtl leaf\nmap_d leaf mask.png\nnewmtl pane\nillum 4\nnewmtl halo\nd -halo 1\n\
                    newmtl odd\nd\nnewmtl old glass\nd 1\nnewmtl old glass\nd 0.9";
        let found = parse_mtl(text.as_bytes());
        let why = |name: &str| found[name].as_deref();
        assert_eq!([why("wall"), why("glass"), why("water")], [None, Some("d 0.25"), Some("Tr 0.5")]);
        assert_eq!([why("leaf"), why("pane"), why("halo")], [Some("map_d"), Some("illum 4"), Some("d -halo 1")]);
        assert_eq!((why("odd"), why("old glass"), found.len()), (Some("d"), Some("d 0.9"), 8));
        for (illum, is_glass) in
            [(0, false), (3, false), (5, false), (8, false), (6, true), (9, true), (10, true), (11, true)]
        {
            let found = parse_mtl(format!("newmtl a\nillum {illum} # why").as_bytes());
            assert_eq!(found["a"].is_some(), is_glass, "illum {illum}");
        }
        let names =
            parse_mtl(b"newmtl Material #25\nd 0.5 # half\n#newmtl x\nnewmtl Material #26 # a wall\nd 1#\n# d 0");
        assert_eq!(names["Material #25"].as_deref(), Some("d 0.5"));
        assert_eq!((&names["Material #26 # a wall"], names.len()), (&None, 2));
        assert!(parse_mtl(b"").is_empty() && parse_mtl(b"\xFF\xFE d 0").is_empty());
    }
}

//! Writing: a feature per line and per object, one on each row of the text.

use crate::PlanFile;
use sightlines_cells::{LineId, Plan, PlanLine, PlanObject};
use std::fmt::Write;

/// The member that states how precise coordinates are.
pub(super) const PRECISION: &str = "sightlines_precision";

/// A plan as a GeoJSON FeatureCollection, which [`super::parse_plan`] reads back as the same plan.
///
/// Lines come first, then objects, in the plan's order: lines as LineStrings, objects as Points, or as
/// MultiPoints of two corners if they have extent. Numbers are the shortest decimals that mean them.
/// Only groups below [`super::MAX_GROUPS`] are read back.
///
/// What the plan [states](Plan::stated_precision) of its precision becomes the member `sightlines_precision`; joints are not written.
///
/// Of a plan with doubled lines, which [`Plan::new`] allows, they are dropped when it is read again.
pub fn write_plan(plan: &Plan) -> String {
    write_with(plan, None)
}

/// As [`write_plan`], with the member `crs` of the plan's file as it was.
pub fn write_plan_file(file: &PlanFile) -> String {
    write_with(&file.plan, file.crs.as_deref())
}

fn write_with(plan: &Plan, crs: Option<&str>) -> String {
    let is_mirror = |id: LineId| plan.mirrors().binary_search(&id).is_ok();
    let lines = (0u32..).map(LineId).zip(plan.lines()).map(|(id, line)| line_feature(line, is_mirror(id)));
    let features = lines.chain(plan.objects().iter().map(object_feature));
    let mut text = String::from("{\"type\":\"FeatureCollection\",");
    if let Some(crs) = crs {
        text.extend(["\"crs\":", crs, ","]);
    }
    if let Some(precision) = plan.stated_precision() {
        // Writing to a String cannot fail.
        _ = write!(text, "\"{PRECISION}\":{precision:?},");
    }
    text.push_str("\"features\":[");
    for (index, feature) in features.enumerate() {
        text.push_str(if index == 0 { "\n" } else { ",\n" });
        text.push_str(&feature);
    }
    text.push_str("\n]}\n");
    text
}

fn line_feature(line: &PlanLine, is_mirror: bool) -> String {
    let mut properties = Vec::new();
    if !line.opaque {
        properties.push("\"sight\":\"transparent\"".to_owned());
    }
    if is_mirror {
        properties.push("\"mirror\":true".to_owned());
    }
    for (name, group) in [("left_group", line.left), ("right_group", line.right)] {
        properties.extend(group.map(|group| format!("\"{name}\":{group}")));
    }
    feature(&properties.join(","), "LineString", &list(&[line.a.to_array(), line.b.to_array()]))
}

fn object_feature(object: &PlanObject) -> String {
    let name = format!("\"name\":{}", quoted(&object.name));
    let [min, max] = [object.bounds.min, object.bounds.max];
    if min == max {
        feature(&name, "Point", &position(min))
    } else {
        feature(&format!("{name},\"object\":\"box\""), "MultiPoint", &list(&[min, max]))
    }
}

fn feature(properties: &str, kind: &str, coordinates: &str) -> String {
    format!(
        "{{\"type\":\"Feature\",\"properties\":{{{properties}}},\
         \"geometry\":{{\"type\":\"{kind}\",\"coordinates\":{coordinates}}}}}"
    )
}

fn list(positions: &[[f64; 2]]) -> String {
    let positions: Vec<String> = positions.iter().copied().map(position).collect();
    format!("[{}]", positions.join(","))
}

fn position([x, y]: [f64; 2]) -> String {
    format!("[{x:?},{y:?}]")
}

/// A JSON string: quotes, backslashes and control characters escaped.
fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            // Writing to a String cannot fail.
            c if c < ' ' => _ = write!(out, "\\u{:04x}", u32::from(c)),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

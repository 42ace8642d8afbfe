//! Plans as GeoJSON: what is read and where, what is refused, and that a plan is read as it was written.

use proptest::prelude::*;
use sightlines_cells::{LineId, Plan, PlanLine, PlanObject};
use sightlines_formats::geojson::{
    MAX_GROUPS, parse_plan, parse_plan_file, read_plan, read_plan_file, write_plan, write_plan_file,
};
use sightlines_formats::{DroppedLines, PlanFile};
use sightlines_geometry::{Aabb, Point2};
use std::collections::BTreeSet;

fn error(text: &str) -> String {
    parse_plan(text.as_bytes()).unwrap_err().to_string()
}

/// A collection of features with these geometries and properties.
fn collection(features: &[(&str, &str)]) -> String {
    let feature = |(geometry, properties): &(&str, &str)| {
        format!(r#"{{"type":"Feature","geometry":{geometry},"properties":{properties}}}"#)
    };
    let features: Vec<String> = features.iter().map(feature).collect();
    format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(","))
}

fn walls(text: &str) -> Vec<[f64; 4]> {
    let plan = parse_plan(text.as_bytes()).unwrap();
    assert!(plan.lines().iter().all(|l| l.opaque));
    plan.lines().iter().map(|l| [l.a.x, l.a.y, l.b.x, l.b.y]).collect()
}

const OTHER: &str = r#"{"type":"LineString","coordinates":[[0,2],[1,2]]}"#;
const LINE: &str = r#"{"type":"LineString","coordinates":[[0,0],[1,0]]}"#;

#[test]
fn every_kind_of_geometry_is_read() {
    let line = [[0., 0., 1., 0.]];
    let ring = [[0., 0., 2., 0.], [2., 0., 2., 2.], [2., 2., 0., 0.]];
    assert_eq!(walls(LINE), line);
    assert_eq!(walls(r#"{"coordinates":[[[0,0,7],[1,0,7,8]],[[0,1],[1,1]]],"type":"MultiLineString"}"#).len(), 2);
    for closing in ["", ",[0,0]"] {
        let rings = format!("[[[0,0],[2,0],[2,2]{closing}]]");
        assert_eq!(walls(&format!(r#"{{"type":"Polygon","coordinates":{rings}}}"#)), ring);
        assert_eq!(walls(&format!(r#"{{"type":"MultiPolygon","coordinates":[{rings}]}}"#)), ring);
    }
    let nested = format!(
        r#"{{"geometries":[{LINE},{{"type":"GeometryCollection","geometries":[{OTHER}]}}],"type":"GeometryCollection"}}"#
    );
    assert_eq!(walls(&nested).len(), 2);
    assert_eq!(walls(&format!(r#"{{"properties":null,"geometry":{nested},"type":"Feature"}}"#)).len(), 2);
    let third = r#"{"type":"LineString","coordinates":[[0,3],[1,3]]}"#;
    assert_eq!(walls(&collection(&[(third, "{}"), ("null", "null"), (&nested, "{}")])).len(), 3);
    for kind in ["LineString", "Polygon", "MultiPoint", "MultiLineString", "MultiPolygon"] {
        let empty = format!(r#"{{"type":"{kind}","coordinates":[]}}"#);
        let file = parse_plan_file(empty.as_bytes()).unwrap();
        assert!(file.plan.lines().is_empty() && file.dropped == DroppedLines::default());
    }
    assert_eq!(walls(&format!("\u{FEFF} {LINE} ")), line);
}

#[test]
fn repeated_positions_and_lines_without_length_are_dropped() {
    let text = r#"{"type":"LineString","coordinates":[[0,0],[0,-0.0],[1,0],[1,0],[1,1]]}"#;
    assert_eq!(walls(text), [[0., 0., 1., 0.], [1., 0., 1., 1.]]);
    assert!(parse_plan_file(text.as_bytes()).unwrap().warnings.is_empty());
    for (kind, coordinates) in [
        ("LineString", "[[1,2],[1,2]]"),
        ("LineString", "[[1,2]]"),
        ("Polygon", "[[[1,2],[1,2],[1,2]]]"),
        ("MultiLineString", "[[[1,2],[1,2]]]"),
    ] {
        let geometry = format!(r#"{{"type":"{kind}","coordinates":{coordinates}}}"#);
        let text = collection(&[(LINE, "{}"), (&geometry, r#"{"mirror":true}"#), (OTHER, r#"{"mirror":true}"#)]);
        let file = parse_plan_file(text.as_bytes()).unwrap();
        assert_eq!(file.dropped, DroppedLines { n_without_length: 1, n_doubled: 0 }, "{geometry}");
        assert_eq!((file.plan.lines().len(), file.plan.mirrors()), (2, &[LineId(1)][..]));
        assert_eq!(file.warnings, ["dropped 1 line without length"]);
    }
}

#[test]
fn lines_that_repeat_others_are_dropped() {
    let line = |a: u8, b: u8| format!(r#"{{"type":"LineString","coordinates":[[{a},0],[{b},0]]}}"#);
    let (there, back) = (line(0, 1), line(1, 0));
    let n_kept = |properties: [&str; 2], second: &str| {
        let text = collection(&[(&there, properties[0]), (second, properties[1])]);
        let PlanFile { plan, dropped, warnings, .. } = parse_plan_file(text.as_bytes()).unwrap();
        assert_eq!(plan.lines().len() + dropped.n_doubled, 2);
        assert_eq!(warnings.len(), dropped.n_doubled);
        plan.lines().len()
    };
    for same in [&there, &back] {
        assert_eq!(n_kept(["{}", "{}"], same), 1);
        assert_eq!(n_kept([r#"{"mirror":true}"#; 2], same), 1);
        assert_eq!(n_kept([r#"{"sight":"transparent"}"#; 2], same), 1);
        // What differs stays.
        assert_eq!(n_kept(["{}", r#"{"sight":"transparent"}"#], same), 2);
        assert_eq!(n_kept(["{}", r#"{"mirror":true}"#], same), 2);
        assert_eq!(n_kept(["{}", r#"{"left_group":0}"#], same), 2);
    }
    // Left and right are those of the direction.
    let groups = [r#"{"left_group":1,"right_group":2}"#, r#"{"left_group":2,"right_group":1}"#];
    assert_eq!([n_kept(groups, &there), n_kept(groups, &back)], [2, 1]);
    assert_eq!([n_kept([groups[0]; 2], &there), n_kept([groups[0]; 2], &back)], [1, 2]);
    assert_eq!(n_kept(["{}", "{}"], &line(0, 2)), 2);
    let thrice = collection(&[(&there, "{}"), (&back, "{}"), (&there, "{}")]);
    let file = parse_plan_file(thrice.as_bytes()).unwrap();
    assert_eq!(file.warnings, ["dropped 2 lines that repeat others"]);
}

#[test]
fn the_reference_system_passes_through() {
    let crs = "{ \"type\": \"name\",\n  \"properties\": {\"name\": \"urn:ogc:def:crs:EPSG::25832\", \"x\": 1e999} }";
    for whole in [LINE.to_owned(), format!(r#"{{"type":"Feature","geometry":{LINE}}}"#), collection(&[(LINE, "{}")])] {
        for crs in [crs, "null", "\"EPSG:25832\""] {
            let with = whole.replacen('{', &format!("{{\"crs\": {crs} ,"), 1);
            let file = parse_plan_file(with.as_bytes()).unwrap();
            assert_eq!((file.crs.as_deref(), &file.warnings[..]), (Some(crs), &[][..]));
            assert_eq!(file.plan, parse_plan(whole.as_bytes()).unwrap());
            let written = write_plan_file(&file);
            assert_eq!(parse_plan_file(written.as_bytes()).unwrap(), file);
            // A file is read as a text is.
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("a.geojson"), &with).unwrap();
            assert_eq!(read_plan_file(folder.path().join("a.geojson")).unwrap(), file);
            // Without it the same is written as before.
            assert_eq!(write_plan_file(&PlanFile { crs: None, ..file.clone() }), write_plan(&file.plan));
            assert_ne!(written, write_plan(&file.plan));
        }
    }
    // Coordinates of a national grid stay what they are.
    let grid = r#"{"crs":{},"type":"LineString","coordinates":[[565432.125,5934321.0625],[565433,5934321.1]]}"#;
    assert_eq!(walls(grid), [[565432.125, 5934321.0625, 565433.0, 5934321.1]]);
    assert!(error(&grid.replacen('{', "{\"crs\":1,", 1)).ends_with("there are two members \"crs\""));
    assert!(error(&grid.replacen("{}", "{]", 1)).ends_with("not JSON that can be read"));
}

#[test]
fn properties_say_what_blocks_sight() {
    let opaque = |properties: &str| parse_plan(collection(&[(LINE, properties)]).as_bytes()).unwrap().lines()[0].opaque;
    for properties in
        ["{}", "null", r#"{"sight":"opaque"}"#, r#"{"opaque":true,"sight":null}"#, r#"{"kind":[1,{"sight":2}]}"#]
    {
        assert!(opaque(properties), "{properties}");
    }
    for properties in [r#"{"sight":"transparent"}"#, r#"{"opaque":false}"#, r#"{"opaque":false,"sight":"opaque"}"#] {
        assert!(!opaque(properties), "{properties}");
    }
    let refused = |properties: &str| error(&collection(&[(LINE, "{}"), (LINE, properties)]));
    assert!(
        refused(r#"{"sight":"misty"}"#).ends_with(r#"feature 1: property "sight" is not "opaque" or "transparent""#)
    );
    assert!(refused(r#"{"opaque":"no"}"#).ends_with(r#"feature 1: property "opaque" is not true or false"#));
    assert!(refused(r#"{"left_group":-1}"#).ends_with(r#"property "left_group" is not a whole number from 0"#));
    assert!(refused(r#"{"right_group":4294967295}"#).ends_with("group 4294967295 is not below 1048576"));
    let plan = parse_plan(collection(&[(LINE, r#"{"left_group":3,"right_group":1048575}"#)]).as_bytes()).unwrap();
    assert_eq!((plan.lines()[0].left, plan.lines()[0].right), (Some(3), Some(1_048_575)));
}

#[test]
fn points_become_objects() {
    let point = r#"{"type":"Point","coordinates":[3,4,5]}"#;
    let points = r#"{"type":"MultiPoint","coordinates":[[3,4],[1,6]]}"#;
    let text = collection(&[
        (point, r#"{"name":"lamp","id":4}"#),
        (point, r#"{"id":4}"#),
        (point, "null"),
        (points, r#"{"name":"seat"}"#),
        (points, r#"{"name":"table","object":"box"}"#),
    ]);
    let plan = parse_plan(text.as_bytes()).unwrap();
    let names: Vec<&str> = plan.objects().iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["lamp", "4", "object 2", "seat #0", "seat #1", "table"]);
    assert_eq!(plan.objects()[4].bounds, Aabb { min: [1., 6.], max: [1., 6.] });
    assert_eq!(plan.objects()[5].bounds, Aabb { min: [1., 4.], max: [3., 6.] });
    let by_feature_id = format!(r#"{{"type":"Feature","id":"x9","geometry":{point}}}"#);
    assert_eq!(parse_plan(by_feature_id.as_bytes()).unwrap().objects()[0].name, "x9");
}

#[test]
fn errors_have_their_place() {
    let with = |bad: &str| {
        let rings = format!(r#"{{"type":"Polygon","coordinates":[[[0,0],[1,0],[1,1]],[[5,5],{bad}]]}}"#);
        error(&collection(&[(LINE, "{}"), (&rings, "{}")]))
    };
    let place = "feature 1: part 1: position 1: ";
    for (bad, what) in [
        ("[NaN,0]", "not JSON that can be read"),
        ("[Infinity,0]", "not JSON that can be read"),
        ("[1e999,0]", "not JSON that can be read"),
        ("[1e300,0]", "coordinate 1e300 is neither 0 nor between 2^-140 and 2^200 in magnitude"),
        ("[0,1e-300]", "coordinate 1e-300 is neither 0 nor between 2^-140 and 2^200 in magnitude"),
        ("[null,0]", "the coordinates are not lists of positions of two numbers or more, all equally deep"),
    ] {
        let found = with(bad);
        assert!(found.starts_with("line 1 column 2") && found.ends_with(&format!(": {place}{what}")), "{bad}: {found}");
    }
    for bad in ["[]", "[1]", "[[1,2],[3,4]]", "[\"1\",2]", "7", "{}", "[1,[2]]"] {
        assert!(with(bad).contains("the coordinates are not lists"), "{bad}: {}", with(bad));
    }
    let collection =
        format!(r#"{{"type":"GeometryCollection","geometries":[{LINE},{{"type":"Point","coordinates":[[1,2]]}}]}}"#);
    assert!(
        error(&collection).ends_with("feature 0: geometry 1: the coordinates are not those of a Point"),
        "{}",
        error(&collection)
    );
    assert_eq!(error("{\n \"type\": \"Feature\",\n \"geometry\" null}").split(": ").next(), Some("line 3 column 13"));
}

#[test]
fn what_is_no_geojson_is_refused() {
    for (text, what) in [
        ("", "the text ends too early"),
        ("[1,2]", "not a JSON object"),
        ("null", "not a JSON object"),
        ("{}", r#"there is no "type""#),
        (r#"{"type":7}"#, r#""type" is not text"#),
        (r#"{"type":"Topology"}"#, r#""type" is not a type of GeoJSON"#),
        (r#"{"type":"FeatureCollection"}"#, r#"there is no "features""#),
        (r#"{"type":"FeatureCollection","features":{}}"#, r#""features" is not a list"#),
        (r#"{"type":"FeatureCollection","features":[3]}"#, "feature 0: not a JSON object"),
        (r#"{"type":"FeatureCollection","features":[null]}"#, "feature 0: not a JSON object"),
        (r#"{"type":"FeatureCollection","features":[{"type":"Point"}]}"#, r#"feature 0: "type" is not "Feature""#),
        (r#"{"type":"Feature","features":[]}"#, r#""type" is not "FeatureCollection", though there are "features""#),
        (r#"{"type":"Feature"}"#, r#"there is no "geometry""#),
        (r#"{"type":"Feature","properties":[]}"#, r#""properties" is not an object"#),
        (r#"{"type":"LineString"}"#, r#"there is no "coordinates""#),
        (r#"{"type":"LineString","coordinates":5}"#, "equally deep"),
        (r#"{"type":"LineString","coordinates":[1,2]}"#, "the coordinates are not those of a LineString"),
        (r#"{"type":"LineString","coordinates":[[[[[1,2]]]]]}"#, "equally deep"),
        (r#"{"type":"GeometryCollection","geometries":3}"#, r#""geometries" is not a list"#),
        (r#"{"type":"GeometryCollection","geometries":[null]}"#, "geometry 0: not a JSON object"),
        (r#"{"type":"Point","type":"Point"}"#, r#"there are two members "type""#),
        (r#"{"type":"Point","coordinates":[1,2]} x"#, "not JSON that can be read"),
    ] {
        assert!(error(text).starts_with("line ") && error(text).ends_with(what), "{text}: {}", error(text));
    }
    let deep = "[".repeat(1 << 20);
    assert!(error(&format!(r#"{{"type":"Point","junk":{deep}"#)).contains("the text ends too early"));
    assert!(error(&format!(r#"{{"type":"Point","coordinates":{deep}"#)).contains("equally deep"));
    let deep = r#"{"type":"GeometryCollection","geometries":["#.repeat(1 << 16);
    assert!(error(&deep).contains("not JSON that can be read"));
}

#[test]
fn hostile_files_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("junk.geojson");
    std::fs::File::create(&path).unwrap().set_len(100 << 20).unwrap();
    let found = read_plan(&path).unwrap_err().to_string();
    assert!(found.ends_with("junk.geojson: line 1 column 1: not JSON that can be read"), "{found}");
    std::fs::write(&path, format!("\u{FEFF}{LINE}")).unwrap();
    assert_eq!(read_plan(&path).unwrap().lines().len(), 1);
    assert!(read_plan(folder.path()).unwrap_err().to_string().contains(&folder.path().display().to_string()));
}

fn coordinate() -> impl Strategy<Value = f64> {
    let odd = prop::num::f64::NORMAL.prop_filter("in range", |x| sightlines_geometry::check_coordinate(*x).is_ok());
    prop_oneof![(-4i32..5).prop_map(f64::from), odd, (-9i32..9).prop_map(|n| f64::from(n) / 10.0)]
}

fn point() -> impl Strategy<Value = Point2> {
    (coordinate(), coordinate()).prop_map(|(x, y)| Point2::new(x, y))
}

fn plans() -> impl Strategy<Value = Plan> {
    let group = || prop::option::of(prop_oneof![0u32..9, 0..MAX_GROUPS]);
    let line = (point(), point(), any::<bool>(), group(), group())
        .prop_filter("has extent", |(a, b, ..)| a != b)
        .prop_map(|(a, b, opaque, left, right)| PlanLine { a, b, opaque, left, right });
    let object = (any::<String>(), point(), point())
        .prop_map(|(name, a, b)| PlanObject { name, bounds: Aabb::around([a.to_array(), b.to_array()]) });
    (prop::collection::vec(line, 0..8), prop::collection::vec(object, 0..4), any::<u8>()).prop_map(
        |(mut lines, objects, marks)| {
            // Of lines with the same ends one is kept.
            let mut seen = BTreeSet::new();
            lines.retain(|line| {
                let mut ends = [line.a, line.b].map(|p| [p.x, p.y].map(|x| (x + 0.0).to_bits()));
                ends.sort_unstable();
                seen.insert(ends)
            });
            let walls = (0u32..).zip(&lines).filter(|(k, line)| line.opaque && marks >> k & 1 == 1);
            let mirrors = walls.map(|(k, _)| LineId(k)).collect();
            Plan::new(lines, objects).unwrap().with_mirrors(mirrors).unwrap()
        },
    )
}

proptest! {
    /// Invariant: what is written is read back as the same plan, bit for bit, and is written once more
    /// as the same text.
    #[test]
    fn geojson_round_trips_exactly(plan in plans()) {
        let text = write_plan(&plan);
        let again = parse_plan(text.as_bytes()).unwrap();
        prop_assert_eq!(&again, &plan);
        prop_assert_eq!(write_plan(&again), text);
    }

    /// Invariant: another library reads the written text and finds the same numbers.
    #[test]
    fn geojson_is_what_others_read(plan in plans()) {
        let others = write_plan(&plan).parse::<::geojson::GeoJson>().unwrap();
        let ::geojson::GeoJson::FeatureCollection(others) = others else { panic!("a collection") };
        prop_assert_eq!(others.features.len(), plan.lines().len() + plan.objects().len());
        for (feature, line) in others.features.iter().zip(plan.lines()) {
            let ends = vec![line.a.to_array().to_vec(), line.b.to_array().to_vec()];
            let expected = ::geojson::GeometryValue::new_line_string(ends);
            prop_assert_eq!(&feature.geometry.as_ref().unwrap().value, &expected);
        }
    }
}

#[test]
fn mirrors_are_marked() {
    let feature = |properties: &'static str| {
        move |k: usize| {
            format!(
                r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"LineString","coordinates":[[{k},0],[4,{k}],[4,9]]}}}}"#
            )
        }
    };
    let all = |features: &[&'static str]| {
        let features: Vec<String> = features.iter().enumerate().map(|(k, f)| feature(f)(k)).collect();
        parse_plan(format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(",")).as_bytes())
    };
    let plan = all(&["{}", r#"{"mirror":true}"#, r#"{"mirror":false}"#, r#"{"mirror":null}"#]).unwrap();
    assert_eq!((plan.lines().len(), plan.mirrors()), (8, &[LineId(2), LineId(3)][..]));
    for (bad, text) in [
        (r#"{"mirror":1}"#, "property \"mirror\" is not true or false"),
        (r#"{"mirror":true,"sight":"transparent"}"#, "property \"mirror\" is not false where lines do not block sight"),
    ] {
        let error = all(&["{}", bad]).unwrap_err();
        assert!(error.what.contains(text), "{error}");
    }
}

#[test]
fn impostor_one_bit_is_noticed() {
    let plan = Plan::from_walls([(Point2::new(0.1, 0.2), Point2::new(0.3, 0.4))]).unwrap();
    let text = write_plan(&plan).replace("0.3", "0.30000000000000004");
    assert_ne!(parse_plan(text.as_bytes()).unwrap(), plan);
}

#[test]
fn written_text_is_pinned() {
    let mut line = PlanLine::wall(Point2::new(0.0, -1.5), Point2::new(1e60, 2.0));
    let wall = line;
    (line.opaque, line.right) = (false, Some(7));
    let lamp = PlanObject { name: "a \"lamp\"\n".to_owned(), bounds: Aabb::around([[1.0, 2.0]]) };
    let text = write_plan(&Plan::new(vec![wall, line], vec![lamp]).unwrap());
    let expected = r#"{"type":"FeatureCollection","features":[
{"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[0.0,-1.5],[1e60,2.0]]}},
{"type":"Feature","properties":{"sight":"transparent","right_group":7},"geometry":{"type":"LineString","coordinates":[[0.0,-1.5],[1e60,2.0]]}},
{"type":"Feature","properties":{"name":"a \"lamp\"\u000a"},"geometry":{"type":"Point","coordinates":[1.0,2.0]}}
]}
"#;
    assert_eq!(text, expected);
}

/// Plans in degrees are noticed, and others are not.
#[test]
fn plans_in_degrees_are_noticed() {
    let warnings = |[x, y]: [f64; 2], size: f64, crs: &str| {
        let crs = if crs.is_empty() {
            String::new()
        } else {
            format!(r#""crs": {{"type": "name", "properties": {{"name": "{crs}"}}}},"#)
        };
        let (a, b) = (x + size, y + size);
        let text = format!(
            r#"{{"type": "Feature", {crs} "geometry": {{"type": "Polygon", "coordinates": [[[{x}, {y}], [{a}, {y}], [{a}, {b}], [{x}, {y}]]]}}}}"#
        );
        parse_plan_file(text.as_bytes()).unwrap().warnings
    };
    for (at, zone) in
        [([8.54, 47.37], "32632"), ([-70.6, -33.4], "32719"), ([179.9, 1.5], "32660"), ([-180.0, 1.5], "32601")]
    {
        let found = warnings(at, 0.0005, "");
        assert_eq!(found.len(), 1, "{at:?}");
        let text = format!(
            "the plan seems to be in degrees, 0.000500 by 0.000500: it is read as one in a plane, where distances, angles and areas of degrees are wrong; `ogr2ogr -t_srs EPSG:{zone} OUT.geojson IN.geojson` projects it to metres"
        );
        assert_eq!(found, [text]);
    }
    assert_eq!(warnings([1.0, 2.0], 9.0, "urn:ogc:def:crs:OGC:1.3:CRS84").len(), 1);
    assert_eq!(warnings([1.0, 2.0], 9.0, "urn:ogc:def:crs:EPSG::4326").len(), 1);
    // A room, something small around the origin, numbers that no degrees have, and another system.
    for (at, size, crs) in [
        ([8.54, 47.37], 6.0, ""),
        ([-0.1, 0.0], 0.2, ""),
        ([181.0, 0.0], 0.1, ""),
        ([8.5, 91.0], 0.1, ""),
        ([8.54, 47.37], 0.001, "EPSG:25832"),
    ] {
        assert_eq!(warnings(at, size, crs), [""; 0], "{at:?}");
    }
}

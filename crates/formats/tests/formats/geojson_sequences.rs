//! Plans as several GeoJSON texts, one a line or each behind a record separator, against the same as one collection.

use proptest::prelude::*;
use sightlines_formats::geojson::{parse_plan_file, read_plan_file};
use sightlines_formats::{PlanFile, ReadErrorKind};
use std::fs;

/// A feature of a line, or of a point.
fn feature([x, y, dx, dy]: [i32; 4]) -> String {
    let geometry = if dx == 0 {
        format!(r#"{{"type":"Point","coordinates":[{x},{y}]}}"#)
    } else {
        format!(r#"{{"type":"LineString","coordinates":[[{x},{y}],[{},{}]]}}"#, x + dx, y + dy)
    };
    format!(r#"{{"type":"Feature","properties":{{"id":{y}}},"geometry":{geometry}}}"#)
}

fn read(text: &str) -> PlanFile {
    parse_plan_file(text.as_bytes()).unwrap()
}

fn error(text: &str) -> String {
    parse_plan_file(text.as_bytes()).unwrap_err().to_string()
}

fn sequence(features: &[String]) -> String {
    features.iter().map(|feature| format!("\x1E{feature}\n")).collect()
}

proptest! {
    /// A sequence holds what the collection of its features holds, from memory and from a file; one without its last feature does not.
    #[test]
    fn sequences_are_the_collection_of_their_features(
        features in prop::collection::vec(prop::array::uniform4(0..3_i32), 2..12),
        separators in prop::sample::select(vec!["\n", "\r\n", "\n\n", "\n  "]),
    ) {
        let features: Vec<String> = features.into_iter().map(feature).collect();
        let whole = read(&format!(r#"{{"type":"FeatureCollection","features":[{}]}}"#, features.join(",")));
        let folder = tempfile::tempdir().unwrap();
        for text in [features.join(separators), features.join(separators) + "\n", sequence(&features), format!("\u{FEFF}{}", sequence(&features))] {
            prop_assert_eq!(&read(&text), &whole);
            let path = folder.path().join("plan.geojsonl");
            fs::write(&path, &text).unwrap();
            prop_assert_eq!(&read_plan_file(&path).unwrap(), &whole);
        }
        // The impostor: each feature makes something, or is counted as dropped.
        let less = read(&sequence(&features[1..]));
        prop_assert_ne!(less, whole);
    }
}

#[test]
fn texts_may_be_of_any_kind() {
    let line = r#"{"type":"LineString","coordinates":[[0,0],[1,0]]}"#;
    let collection = r#"{"type":"FeatureCollection","features":[]}"#;
    assert_eq!(read(&format!("{line}\n{collection}\n{}", feature([2, 2, 1, 1]))).plan.lines().len(), 2);
}

/// Of a reference system, the texts agree, or some have none.
#[test]
fn texts_have_one_reference_system() {
    let with = |crs: &str, y: i32| feature([0, y, 1, 0]).replacen('{', &format!("{{\"crs\":{crs},"), 1);
    let [none, a, b] = [feature([0, 0, 1, 0]), with("\"EPSG:25832\"", 1), with("\"EPSG:25832\"", 2)];
    for texts in [[&a, &b, &none], [&none, &a, &b], [&a, &none, &b]] {
        let text: Vec<&str> = texts.map(String::as_str).to_vec();
        assert_eq!(read(&text.join("\n")).crs.as_deref(), Some("\"EPSG:25832\""));
    }
    let other = with("\"EPSG:25833\"", 3);
    for text in [format!("{a}\n{other}"), format!("{a}\n{none}\n{other}")] {
        assert!(error(&text).ends_with("another \"crs\" than that of the texts before"), "{}", error(&text));
    }
}

#[test]
fn errors_name_text_and_place() {
    let [good, point] = [feature([0, 0, 1, 0]), r#"{"type":"Point","coordinates":[0]}"#.to_owned()];
    let begins = |text: &str, line: &str| assert!(error(text).starts_with(line), "{}", error(text));
    begins(&format!("{good}\n{good}\n{point}"), "line 3 column 33: feature 2");
    begins(&sequence(&[good.clone(), point]), "line 2 column 34: feature 1");
    // What is no value at all is in no feature.
    begins(&format!("{good}\n]"), "line 2 column 1: not JSON that can be read");
    begins(&format!("{good}\n7"), "line 2 column 1: not a JSON object");
    // Texts that are cut off, whatever is behind them.
    let mut n_cut = 0;
    for end in 1..good.len() {
        for text in [format!("\x1E{}\n\x1E{good}\n", &good[..end]), format!("{good}\n{}", &good[..end])] {
            assert!(parse_plan_file(text.as_bytes()).is_err(), "{text}");
            n_cut += 1;
        }
    }
    assert!(n_cut > 100, "{n_cut}");
    // A separator within a text, and a file with nothing behind one.
    assert!(parse_plan_file(format!("\x1E{}", good.replace("Feature", "Fea\x1Eture")).as_bytes()).is_err());
    assert!(parse_plan_file(b"\x1E\n").is_err());
    let missing = read_plan_file("no such file.geojsonl").unwrap_err();
    assert!(matches!(missing.kind, ReadErrorKind::Io(_)));
}

//! Points as CSV and GeoJSON.

use proptest::prelude::*;
use sightlines_formats::points::{parse_points, read_points};

fn read(text: &str) -> Vec<(f64, f64, Option<String>)> {
    let points = parse_points(text.as_bytes()).unwrap_or_else(|error| panic!("{text}: {error}"));
    points.into_iter().map(|p| (p.point.x, p.point.y, p.name)).collect()
}

fn error(text: &str) -> String {
    parse_points(text.as_bytes()).unwrap_err().to_string()
}

#[test]
fn points_are_read_with_any_separator() {
    let expected = vec![(1.5, -2.0, Some("door".to_owned())), (3e2, 0.0, None)];
    for separator in [",", ";", "\t"] {
        for end in ["\n", "\r\n"] {
            for header in ["", "x,y,name", "# places", "\u{FEFF}X , Y,Name", "#a\n\n  \nx,y,name\n#b"] {
                let body = "1.5,-2,door,300 , -0".replace("door,", "door\n");
                let text = format!("{header}\n{body}").replace(',', separator).replace('\n', end);
                assert_eq!(read(&text), expected, "{text:?}");
            }
        }
    }
    let by_name = "id,name,Y,x\n7,\"a, \"\"b\"\"\",2,1\n8,,4,3\n";
    assert_eq!(read(by_name), [(1.0, 2.0, Some("a, \"b\"".to_owned())), (3.0, 4.0, None)]);
    // The strongest separator of the first line decides; a name may have others.
    assert_eq!(read("1;2;a,b\n3;4\n"), [(1.0, 2.0, Some("a,b".to_owned())), (3.0, 4.0, None)]);
}

#[test]
fn geojson_points_are_points() {
    let feature = |kind: &str, coordinates: &str, properties: &str| {
        format!(
            r#"{{"type":"Feature","properties":{properties},"geometry":{{"type":"{kind}","coordinates":{coordinates}}}}}"#
        )
    };
    let all =
        |features: &[String]| format!("\n{{\"type\":\"FeatureCollection\",\"features\":[{}]}}", features.join(","));
    let (door, two) = (feature("Point", "[1,2]", r#"{"name":"door"}"#), feature("MultiPoint", "[[3,4],[5,6]]", "{}"));
    let expected = [
        (1.0, 2.0, Some("door".to_owned())),
        (3.0, 4.0, Some("object 1".to_owned())),
        (5.0, 6.0, Some("object 2".to_owned())),
    ];
    assert_eq!(read(&all(&[door.clone(), two])), expected);
    let wall = feature("LineString", "[[0,0],[1,0]]", "{}");
    assert_eq!(
        error(&all(&[door.clone(), wall])),
        "line 1 column 1: there are lines in the file, which should hold points only"
    );
    let boxed = feature("MultiPoint", "[[3,4],[5,6]]", r#"{"name":"desk","object":"box"}"#);
    assert_eq!(error(&all(&[door, boxed])), "line 1 column 1: the object \"desk\" is a box, not a point");
    assert_eq!(error("{\n\"type\": 7}"), "line 2 column 10: \"type\" is not text");
}

#[test]
fn errors_name_line_and_column() {
    for (text, what) in [
        ("1,2\n3\n", "line 2 column 2: there is no y"),
        ("1,2\n,3\n", "line 2 column 1: there is no x"),
        ("1,2\n3, \n", "line 2 column 4: there is no y"),
        ("1,2\n3,NaN,a\n", "line 2 column 3: coordinate NaN is not a finite number"),
        ("NaN,1\n", "line 1 column 1: coordinate NaN is not a finite number"),
        ("nan,inf\n", "line 1 column 1: coordinate NaN is not a finite number"),
        ("1,-inf\n", "line 1 column 3: coordinate -inf is not a finite number"),
        ("1,1e999\n", "line 1 column 3: coordinate inf is not a finite number"),
        ("1,2\n\n#\n3,4m\n", "line 4 column 3: '4m' is not a number"),
        ("1,5;2,5\n", "line 1 column 1: '1,5' is not a number"),
        ("1,2,a,b\n", "line 1 column 7: there are more values than x, y and a name"),
        ("l,2\n", "line 1 column 1: 'l' is not a number"),
        ("east,north\n1,2\n", "line 1 column 1: the header names no column x"),
        ("x,n\n1,2\n", "line 1 column 1: the header names no column y"),
        ("x,y,x\n1,2\n", "line 1 column 5: the header names two columns x"),
        ("x,y\n", "line 1 column 1: there are no points in the file"),
        ("", "line 1 column 1: there are no points in the file"),
        ("1,2,\"a\n", "line 1 column 5: the quotes are not closed at the end of the value"),
        ("1,2,\"a\"b\n", "line 1 column 5: the quotes are not closed at the end of the value"),
        ("x,y\na,b\n", "line 2 column 1: 'a' is not a number"),
    ] {
        assert_eq!(error(text), what, "{text:?}");
    }
    assert_eq!(parse_points(b"1,2\n3,4,K\xFCche\n").unwrap_err().to_string(), "line 2 column 6: this is not UTF-8");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("places.csv");
    std::fs::write(&path, "1,2\n3;4\n").unwrap();
    assert!(
        read_points(&path).unwrap_err().to_string().ends_with("places.csv: line 2 column 1: '3;4' is not a number")
    );
    assert!(read_points(folder.path()).is_err());
}

proptest! {
    /// Invariant: what is written with any separator is read as it was, bit for bit; a changed digit is noticed.
    #[test]
    fn written_points_are_read(
        points in prop::collection::vec((-1e9f64..1e9, -1e9f64..1e9, "[a-z ,;#\"]{0,6}"), 1..9),
        separator in prop_oneof![Just(','), Just(';'), Just('\t')],
        header: bool,
    ) {
        let mut text = if header { format!("x{separator}y{separator}name\n") } else { String::new() };
        for (x, y, name) in &points {
            text.push_str(&format!("{x:?}{separator}{y:?}{separator}\"{}\"\n", name.replace('"', "\"\"")));
        }
        // The first line decides, so that its name may not have a stronger separator.
        prop_assume!(header || separator == '\t' || !points[0].2.contains(';') );
        let found = read(&text);
        prop_assert_eq!(found.len(), points.len());
        for ((x, y, name), (fx, fy, found)) in points.iter().zip(&found) {
            prop_assert_eq!((x + 0.0, y + 0.0), (*fx, *fy));
            prop_assert_eq!(name, &found.clone().unwrap_or_default());
        }
        let moved = text.replacen('.', ".1", 1);
        prop_assert!(read(&moved) != found || !text.contains('.'));
    }

    /// Invariant: whatever bytes come, they are points or refused.
    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(prop_oneof![Just(b','), Just(b'"'), Just(b'\n'), Just(b'1'), any::<u8>()], 0..60)) {
        if let Ok(points) = parse_points(&bytes) {
            prop_assert!(!points.is_empty() && points.iter().all(|p| p.point.x.is_finite() && p.point.y.is_finite()));
        }
    }
}

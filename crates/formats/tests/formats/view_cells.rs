//! View cells: against an oracle that looks at the whole text as a tree of values.

use proptest::prelude::*;
use serde_json::Value;
use sightlines_formats::view_cells::{ViewCell, ViewCells, parse_view_cells, read_view_cells};
use sightlines_geometry::{Aabb, check_coordinate};
use sightlines_testkit::mutate::{SplitMix, flipped_bits, mutate};

fn parsed(text: &str) -> ViewCells {
    parse_view_cells(text.as_bytes()).unwrap_or_else(|error| panic!("{text}: {error}"))
}

fn error(text: &str) -> String {
    parse_view_cells(text.as_bytes()).unwrap_err().to_string()
}

/// A list of a good cell and this one.
fn second(cell: &str) -> String {
    format!(r#"{{"cells":[{{"id":"a","min":[0,0,0],"max":[1,1,1]}},{cell}]}}"#)
}

/// Members in any order, some that mean nothing, a flat cell, numbers in all forms, a text with an escape.
const SMALL: &str = r#"{"up":"y","cells":[
{"id":"room0_Living Room","min":[0.53266,7.062e-2,-12],"max":[6.084339999999996,2.54838,17.28733999999999],"fill":1.0},
{"max":[1,2,3],"min":[-1.5E1,2,-0.0],"note":{"id":7,"min":[]},"id":"K\u00fcche"}],"cells_before":[null]}"#;

#[test]
fn cells_are_read() {
    let found = parsed(SMALL);
    let cell = |id: &str, min, max| ViewCell { id: id.to_owned(), bounds: Aabb { min, max } };
    let first = cell(
        "room0_Living Room",
        [0.532_66, 0.070_62, -12.0],
        [6.084_339_999_999_996, 2.548_38, 17.287_339_999_999_99],
    );
    assert_eq!(found.cells, [first, cell("Küche", [-15.0, 2.0, 0.0], [1.0, 2.0, 3.0])]);
    assert_eq!(found.cells[1].bounds.min[2].to_bits(), 0, "no negative zero");
    assert_eq!(parsed(&format!("\u{FEFF}{SMALL}\n ")), found);
}

#[test]
fn errors_have_their_place() {
    let found = error(&second(r#"{"id":"b","min":[0,0,0],"max":[1,-1,1]}"#));
    assert_eq!(found, r#"line 1 column 88: cell 1 ("b"): "min" is above "max" in y: 0 and -1"#);
    let found = error(&second("\n{\"min\":[0,0,0],\n \"max\":[1,1]}"));
    assert_eq!(found, r#"line 3 column 12: cell 1: "max" is not a list of three numbers"#);
    let found = parse_view_cells(second(r#"{"id":"b","min":3}"#).as_bytes()).unwrap_err();
    assert!(found.place.starts_with("line 1 column ") && found.place.ends_with(": cell 1 (\"b\")"), "{found}");
    for (cell, what) in [
        (r#"{"id":"","min":[0,0,0],"max":[1,1,1]}"#, "cell 1: the id is empty"),
        (r#"{"id":"a","min":[0,0,0],"max":[1,1,1]}"#, r#"cell 1 ("a"): cell 0 has the same id"#),
        (r#"{"id":"\u0061","min":[0,0,0],"max":[1,1,1]}"#, r#"cell 1 ("a"): cell 0 has the same id"#),
        (r#"{"min":[0,0,0],"max":[1,1,1]}"#, r#"cell 1: there is no "id""#),
        (r#"{"id":"b\n","max":[1,1,1]}"#, r#"cell 1 ("b\n"): there is no "min""#),
        (r#"{"id":"b","min":[1,1,1]}"#, r#"cell 1 ("b"): there is no "max""#),
        (r#"{"id":"b","id":"b"}"#, r#"cell 1 ("b"): there are two members "id""#),
        (r#"{"id":"b","min":[1,1,1],"min":[1,1,1]}"#, r#"cell 1 ("b"): there are two members "min""#),
        (r#"{"max":[1,1,1],"max":[1,1,1]}"#, r#"cell 1: there are two members "max""#),
        (r#"{"id":7}"#, r#"cell 1: "id" is not text"#),
        (r#"{"id":null}"#, r#"cell 1: "id" is not text"#),
        (r#"{"id":["b"]}"#, r#"cell 1: "id" is not text"#),
        (
            r#"{"id":"b","min":[1e300,0,0]}"#,
            r#"cell 1 ("b"): "min": coordinate 1e300 is neither 0 nor between 2^-140 and 2^200 in magnitude"#,
        ),
        (
            r#"{"max":[0,0,-1e-300]}"#,
            r#"cell 1: "max": coordinate -1e-300 is neither 0 nor between 2^-140 and 2^200 in magnitude"#,
        ),
        (r#"{"max":[0,0,1e999]}"#, "cell 1: not JSON that can be read"),
        (r#"{"max":[0,0,NaN]}"#, "cell 1: not JSON that can be read"),
        (r#"{"max":[0,0,-Infinity]}"#, "cell 1: not JSON that can be read"),
        ("[]", "cell 1: not a JSON object"),
        ("null", "cell 1: not a JSON object"),
        ("", "cell 1: not JSON that can be read"),
    ] {
        let found = error(&second(cell));
        assert!(found.starts_with("line 1 column ") && found.ends_with(&format!(": {what}")), "{cell}: {found}");
    }
    for bad in [
        "null",
        "{}",
        "\"1\"",
        "1",
        "[]",
        "[1]",
        "[1,2]",
        "[1,2,3,4]",
        "[1,2,null]",
        "[1,\"2\",3]",
        "[[1,2,3]]",
        "[true,1,1]",
    ] {
        for corner in ["min", "max"] {
            let found = error(&second(&format!(r#"{{"id":"b","{corner}":{bad}}}"#)));
            let what = format!(r#"cell 1 ("b"): "{corner}" is not a list of three numbers"#);
            assert!(found.ends_with(&what), "{bad}: {found}");
        }
    }
}

#[test]
fn what_has_no_cells_is_refused() {
    for (text, what) in [
        ("", "the text ends too early"),
        (" ", "the text ends too early"),
        ("null", "not a JSON object"),
        ("[]", "not a JSON object"),
        ("7", "not a JSON object"),
        ("{}", r#"there is no "cells""#),
        (r#"{"Cells":[]}"#, r#"there is no "cells""#),
        (r#"{"cells":[]}"#, "there are no cells in the list"),
        (r#"{"cells":{}}"#, r#""cells" is not a list"#),
        (r#"{"cells":null}"#, r#""cells" is not a list"#),
        (r#"{"cells":[1]}"#, "cell 0: not a JSON object"),
        (r#"{"cells":[],"cells":[]}"#, r#"there are two members "cells""#),
        (r#"{"cells":["#, "the text ends too early"),
        ("{\"cells\":[]} x", "there are no cells in the list"),
        ("\u{FEFF}\u{FEFF}{}", "not JSON that can be read"),
    ] {
        assert!(error(text).starts_with("line ") && error(text).ends_with(what), "{text}: {}", error(text));
    }
    for behind in ["x", "{}", ",", "\0", "]"] {
        let found = error(&format!("{SMALL}{behind}"));
        assert!(found.starts_with("line 3 ") && found.ends_with(": not JSON that can be read"), "{found}");
        assert!(!found.contains("cell "), "what follows is in no cell: {found}");
    }
    // Nesting without end costs neither stack nor a panic, wherever it is.
    let deep = "[".repeat(1 << 20);
    assert!(error(&format!(r#"{{"junk":{deep}"#)).ends_with("the text ends too early"));
    assert!(error(&format!(r#"{{"cells":{deep}"#)).ends_with("cell 0: not a JSON object"));
    assert!(error(&second(&format!(r#"{{"min":{deep}"#))).ends_with("is not a list of three numbers"));
}

#[test]
fn files_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cells.json");
    std::fs::write(&path, SMALL).unwrap();
    assert_eq!(read_view_cells(&path).unwrap(), parsed(SMALL));
    std::fs::write(&path, r#"{"cells":[{"id":""}]}"#).unwrap();
    let found = read_view_cells(&path).unwrap_err().to_string();
    assert!(found.ends_with("cells.json: line 1 column 19: cell 0: the id is empty"), "{found}");
    assert!(read_view_cells(folder.path()).unwrap_err().to_string().contains(&folder.path().display().to_string()));
    assert!(read_view_cells(folder.path().join("none.json")).unwrap_err().to_string().contains("none.json: "));
}

/// The oracle: the whole as a tree of values, looked at afterwards. It cannot detect duplicate members.
fn by_value(text: &[u8]) -> Option<ViewCells> {
    let text = text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text);
    let whole: Value = serde_json::from_slice(text).ok()?;
    let corner = |value: &Value| -> Option<[f64; 3]> {
        let xs: Option<Vec<f64>> = value.as_array()?.iter().map(Value::as_f64).collect();
        let xs: [f64; 3] = xs?.try_into().ok()?;
        xs.iter().all(|&x| check_coordinate(x).is_ok()).then_some(xs.map(|x| x + 0.0))
    };
    let cell = |value: &Value| -> Option<ViewCell> {
        let (min, max) = (corner(value.get("min")?)?, corner(value.get("max")?)?);
        let sound = (0..3).all(|k| min[k] <= max[k]);
        Some(ViewCell { id: value.get("id")?.as_str()?.to_owned(), bounds: Aabb { min, max } }).filter(|_| sound)
    };
    let list = whole.get("cells")?.as_array()?;
    let cells: Vec<ViewCell> = list.iter().map(cell).collect::<Option<_>>()?;
    let mut ids: Vec<&str> = cells.iter().map(|cell| cell.id.as_str()).collect();
    ids.sort_unstable();
    let sound = !cells.is_empty() && !ids[0].is_empty() && ids.windows(2).all(|pair| pair[0] != pair[1]);
    let axes = match whole.get("axes") {
        Some(axes) => {
            let axes: Vec<[f64; 3]> = axes.as_array()?.iter().map(corner).collect::<Option<_>>()?;
            let axes: [[f64; 3]; 3] = axes.try_into().ok()?;
            let product = |i: usize, j: usize| (0..3).map(|k| axes[i][k] * axes[j][k]).sum::<f64>();
            let wanted = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
            let are_right = (0..9).all(|n| (product(n / 3, n % 3) - wanted(n / 3, n % 3)).abs() <= 1e-3);
            Some(Some(axes)).filter(|_| are_right)?
        }
        None => None,
    };
    sound.then_some(ViewCells { cells, axes })
}

/// Whether the reader takes a text; both the reader and the oracle must say the same, to the last bit.
fn agree(text: &[u8]) -> Result<bool, String> {
    // In what means nothing, numbers too large and texts that are not UTF-8 are skipped; the oracle keeps all values.
    let can_be_skipped = || serde_json::from_slice::<serde::de::IgnoredAny>(text).is_ok();
    match (parse_view_cells(text), by_value(text)) {
        (Ok(ours), Some(other)) if ours == other => Ok(true),
        (Err(_), None) => Ok(false),
        (Ok(_), None) if serde_json::from_slice::<Value>(text).is_err() && can_be_skipped() => Ok(true),
        // A member that is there twice.
        (Err(error), Some(_)) if error.what.starts_with("there are two members ") => Ok(false),
        (ours, other) => Err(format!("{}: {ours:?}, the oracle {other:?}", String::from_utf8_lossy(text))),
    }
}

fn coordinate() -> impl Strategy<Value = f64> {
    let odd = prop::num::f64::NORMAL.prop_filter("in range", |x| check_coordinate(*x).is_ok());
    prop_oneof![(-4i32..5).prop_map(f64::from), odd, (-9i32..9).prop_map(|n| f64::from(n) / 10.0)]
}

fn corner() -> impl Strategy<Value = [f64; 3]> {
    [coordinate(), coordinate(), coordinate()]
}

fn view_cells() -> impl Strategy<Value = ViewCells> {
    prop::collection::btree_map(".{1,6}", (corner(), corner()), 1..9).prop_map(|cells| {
        let cell = |(id, (a, b))| ViewCell { id, bounds: Aabb::around([a, b]) };
        ViewCells { cells: cells.into_iter().map(cell).collect(), axes: None }
    })
}

fn written(cells: &ViewCells) -> String {
    let cell = |cell: &ViewCell| {
        let Aabb { min, max } = cell.bounds;
        serde_json::json!({"id": cell.id, "min": min, "max": max})
    };
    serde_json::json!({"cells": cells.cells.iter().map(cell).collect::<Vec<_>>()}).to_string()
}

proptest! {
    /// Invariant: what another library writes is read as the same cells, bit for bit, and any one corner moved out of
    /// place is noticed.
    #[test]
    fn view_cells_are_what_others_write(cells in view_cells(), which in any::<prop::sample::Index>(), axis in 0usize..3) {
        let text = written(&cells);
        prop_assert_eq!(agree(text.as_bytes()), Ok(true));
        let found = parsed(&text);
        let bits = |cells: &ViewCells| -> Vec<u64> {
            cells.cells.iter().flat_map(|c| c.bounds.min.into_iter().chain(c.bounds.max)).map(|x| (x + 0.0).to_bits()).collect()
        };
        prop_assert_eq!(bits(&found), bits(&cells));
        prop_assert_eq!(&found, &cells);
        let mut spoilt = cells.clone();
        let at = which.index(cells.cells.len());
        let bounds = &mut spoilt.cells[at].bounds;
        (bounds.min[axis], bounds.max[axis]) = (1e60, -1e60);
        let found = parse_view_cells(written(&spoilt).as_bytes()).unwrap_err();
        let axis = ["x", "y", "z"][axis];
        prop_assert_eq!(found.what, format!("\"min\" is above \"max\" in {axis}: {} and {}", 1e60, -1e60));
        prop_assert!(found.place.contains(&format!(": cell {at} (")), "{}", found.place);
    }

    /// Invariant: a second cell with an id is refused, and the first is named.
    #[test]
    fn ids_are_different(cells in view_cells(), from in any::<prop::sample::Index>()) {
        let first = from.index(cells.cells.len());
        let mut twice = cells.clone();
        twice.cells.push(cells.cells[first].clone());
        let found = parse_view_cells(written(&twice).as_bytes()).unwrap_err();
        prop_assert_eq!(found.what, format!("cell {first} has the same id"));
        let place = format!(": cell {} ({:?})", cells.cells.len(), cells.cells[first].id);
        prop_assert!(found.place.ends_with(&place), "{}", found.place);
    }

    /// Invariant: whatever the bytes, the reader and the oracle agree, and nothing panics.
    #[test]
    fn garbage_is_refused(bytes in prop::collection::vec(any::<u8>(), 0..60)) {
        prop_assert_eq!(agree(&bytes), Ok(false));
    }
}

/// Thousands of damaged texts: read or refused as the oracle does.
#[test]
fn damaged_texts_are_read_or_refused() {
    let (mut n_read, mut n_refused) = (0, 0);
    for number in 0..20_000 {
        match agree(&mutate(SMALL.as_bytes(), &mut SplitMix::new(number))) {
            Ok(true) => n_read += 1,
            Ok(false) => n_refused += 1,
            Err(difference) => panic!("seed {number}: {difference}"),
        }
    }
    assert!(n_read > 500 && n_refused > 5000, "{n_read} read, {n_refused} refused");
}

#[test]
fn every_prefix_and_flipped_bit_is_read_or_refused() {
    let (mut n_read, mut n_refused) = (0, 0);
    for text in flipped_bits(SMALL.as_bytes()) {
        *(if agree(&text).unwrap() { &mut n_read } else { &mut n_refused }) += 1;
    }
    assert!(n_read > 100 && n_refused > 500, "{n_read} read, {n_refused} refused");
    for len in 0..SMALL.len() {
        assert_eq!(agree(&SMALL.as_bytes()[..len]), Ok(false), "{len} bytes");
    }
}

/// The comparison can fail: an oracle with another text differs.
#[test]
fn impostor_one_bit_is_noticed() {
    let other = SMALL.replace("0.53266", "0.5326600000000001");
    assert_ne!(by_value(other.as_bytes()), parse_view_cells(SMALL.as_bytes()).ok());
    assert_eq!(by_value(SMALL.as_bytes()), parse_view_cells(SMALL.as_bytes()).ok());
}

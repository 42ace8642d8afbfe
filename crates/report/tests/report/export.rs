//! The export and the summary say what the table says.

use crate::common::{nothing, rooms};
use sightlines_pvs::{Frame, Table, TableKind, TableParts};
use sightlines_report::{Summary, export_json, write_json};

#[test]
fn the_export_has_the_keys_of_the_contract_in_their_order() {
    let expected = concat!(
        r#"{"format":"sightlines-export","version":1,"dimension":2,"cells":["#,
        r#"{"id":0,"min":[-3.0,0.0],"max":[5.0,2.0],"polygon":[[-3.0,0.0],[5.0,0.0],[5.0,2.0],[-3.0,2.0]],"group":7},"#,
        r#"{"id":1,"min":[-3.0,2.0],"max":[2.0,4.0],"polygon":[[-3.0,2.0],[2.0,2.0],[2.0,4.0],[-3.0,4.0]],"group":null},"#,
        r#"{"id":2,"min":[2.0,2.0],"max":[5.0,4.0],"polygon":[[2.0,2.0],[5.0,2.0],[5.0,4.0],[2.0,4.0]],"group":3}],"#,
        r#""portals":[{"id":0,"cells":[0,1],"points":[[-1.0,2.0],[0.1,2.0]]}],"#,
        r#""visible":[[0,1],[0,1],[2]],"#,
        r#""objects":[{"id":0,"name":"de\"sk","min":[-2.0,0.5],"max":[-1.0,1.0]},"#,
        r#"{"id":1,"name":"safe","min":[4.5,3.5],"max":[4.5,3.5]}],"cell_objects":[[0],[0],[1]]}"#,
    );
    assert_eq!(export_json(&rooms(false)), expected);
    assert_ne!(export_json(&rooms(true)), expected, "one more pair shows");
    let mut bytes = Vec::new();
    write_json(&rooms(false), &mut bytes).unwrap();
    assert_eq!(bytes, expected.as_bytes());
}

/// Names stand behind the ids, and change nothing else.
#[test]
fn names_of_cells_are_exported_where_there_are_any() {
    let bare = rooms(false);
    let mut parts = bare.clone().into_parts();
    parts.cell_names = ["Küche", "", "a \"b\""].map(str::to_owned).to_vec();
    let named = Table::new(parts).unwrap();
    let text = export_json(&named);
    assert!(text.contains(r#"{"id":0,"name":"Küche","min":[-3.0,0.0]"#), "{text}");
    assert!(
        text.contains(r#"{"id":1,"name":"","min":"#) && text.contains(r#"{"id":2,"name":"a \"b\"","min":"#),
        "{text}"
    );
    let without = [r#""name":"Küche","#, r#""name":"","#, r#""name":"a \"b\"","#];
    let without = without.into_iter().fold(text, |text, name| text.replacen(name, "", 1));
    assert_eq!(without, export_json(&bare));
    let [named, bare] = [named, bare].map(|table| Summary::of(&table));
    assert!(named.has_cell_names && !bare.has_cell_names);
    assert!(named.n_bytes > bare.n_bytes);
}

#[test]
fn an_empty_table_is_exported() {
    let json: serde_json::Value = serde_json::from_str(&export_json(&nothing())).unwrap();
    assert!(
        ["cells", "portals", "visible", "objects", "cell_objects"].iter().all(|k| json[k] == serde_json::json!([]))
    );
}

/// A cell that is its box has the box's corners; portals that were stripped are gone.
#[test]
fn a_stripped_table_is_exported_with_its_boxes() {
    let json: serde_json::Value = serde_json::from_str(&export_json(&rooms(false).strip_geometry())).unwrap();
    assert_eq!(json["cells"][2]["polygon"], serde_json::json!([[2.0, 2.0], [5.0, 2.0], [5.0, 4.0], [2.0, 4.0]]));
    assert_eq!(json["portals"], serde_json::json!([]));
}

#[test]
fn the_summary_counts_and_weighs() {
    let table = rooms(false);
    let summary = Summary::of(&table);
    assert_eq!((summary.n_cells, summary.n_portals, summary.n_objects, summary.n_groups), (3, 1, 2, 2));
    assert_eq!((summary.n_visible_pairs, summary.most_visible, summary.floor), (1, 2, 32.0));
    assert_eq!(summary.visible_share, 1.0 / 3.0);
    // The large rooms see 16 + 10 of 32 square units, the closed one its own 6.
    let floor = (26.0 * 26.0 + 6.0 * 6.0) / (32.0 * 32.0);
    assert!((summary.mean_floor_share - floor).abs() < 1e-12, "{}", summary.mean_floor_share);
    assert_eq!(summary.n_bytes, table.to_bytes().len());
    assert_eq!(Summary::of(&rooms(true)).n_visible_pairs, 2);
    let empty = Summary::of(&nothing());
    assert_eq!((empty.n_cells, empty.visible_share, empty.mean_floor_share), (0, 0.0, 0.0));
}

/// A frame stands behind the dimension, and changes nothing else but the version.
#[test]
fn frames_are_exported() {
    let plain = Table::new(TableParts::empty(3, TableKind::Unspecified)).unwrap();
    let frame = Frame::new([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]], 0.25).unwrap();
    let text = export_json(&plain.clone().with_frame(Some(frame)).unwrap());
    let own = r#","frame":{"axes":[[0.8,0.6,0.0],[-0.6,0.8,0.0],[0.0,0.0,1.0]],"gap":0.25}"#;
    assert!(text.contains(&format!(r#""dimension":3{own},"cells""#)), "{text}");
    let without = text.replacen(own, "", 1).replacen(r#""version":2"#, r#""version":1"#, 1);
    assert_eq!(without, export_json(&plain));
    assert!(text.contains(r#""version":2"#), "{text}");
}

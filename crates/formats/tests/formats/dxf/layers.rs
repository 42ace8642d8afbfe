//! Layers: what is frozen, off, chosen; and the layer 0 in blocks.

use super::{lines, read};
use crate::common::dxf::Dxf;
use sightlines_formats::dxf::parse_dxf;
use sightlines_formats::{PlanFile, PlanReadOptions};

/// A line for each layer, whose x is its number; 4 and 5 are in a block on layer 0 and `Walls`, 6 in one that is inserted on `Old`.
fn drawing() -> Vec<u8> {
    let layers = Dxf::layers(&[("0", 0, 7), ("Walls", 0, 1), ("Old", 1, 2), ("Hidden", 0, -3)]);
    let at = |layer: &str, x: f64| Dxf::new().line(layer, [x, 0.0], [x, 1.0]);
    let door = at("0", 4.0).add(&at("Walls", 5.0)).as_block("door", [0.0; 2]);
    let insert = |layer: &str, at: [f64; 2]| Dxf::new().entity("INSERT", layer).put(2, "door").at(10, at);
    let model = at("0", 0.0).add(&at("Walls", 1.0)).add(&at("Old", 2.0)).add(&at("Hidden", 3.0));
    let model =
        model.add(&insert("Hidden", [0.0, 0.0])).add(&insert("Old", [10.0, 0.0])).add(&insert("Walls", [20.0, 0.0]));
    let undeclared =
        at("Möbel", 6.0).line("0", [7.0, 0.0], [7.0, 1.0]).put(67, 1).line("0", [8.0, 0.0], [8.0, 1.0]).put(60, 1);
    layers.add(&door.as_section("BLOCKS")).add(&model.add(&undeclared).as_section("ENTITIES")).as_file()
}

fn with(names: &[&str]) -> PlanFile {
    let names = names.iter().map(|&name| name.to_owned()).collect();
    parse_dxf(&drawing(), &PlanReadOptions { layers: Some(names), deviation: None }).unwrap()
}

fn places(file: &PlanFile) -> Vec<f64> {
    lines(file).iter().map(|line| line[0]).collect()
}

#[test]
fn what_is_not_drawn_is_left_out() {
    let file = read(&drawing());
    // Of an insert on a layer that is off, what is on a layer of its own is drawn; of one on a frozen layer nothing is.
    assert_eq!(places(&file), [0.0, 1.0, 5.0, 24.0, 25.0, 6.0]);
    assert_eq!(file.layers, ["0", "Walls", "Old", "Hidden", "Möbel"]);
    assert_eq!(
        file.warnings,
        [
            "left out 4 entities on layers that are frozen or off: Old, Hidden",
            "left out 1 entity in paper space",
            "left out 1 entity marked as invisible"
        ]
    );
}

#[test]
fn layers_are_chosen_by_name() {
    assert_eq!(places(&with(&["walls"])), [1.0, 5.0, 15.0, 24.0, 25.0]);
    assert_eq!(places(&with(&["OLD", "MÖBEL"])), [2.0, 14.0, 6.0]);
    assert_eq!(places(&with(&["Hidden"])), [3.0, 4.0]);
    assert_eq!(places(&with(&["0"])), [0.0]);
    assert_eq!(with(&["0"]).layers, read(&drawing()).layers);
    assert!(places(&with(&[])).is_empty());
    let options = PlanReadOptions { layers: Some(vec!["walls".into(), "Wals".into(), "".into()]), deviation: None };
    let error = parse_dxf(&drawing(), &options).unwrap_err().to_string();
    assert_eq!(error, "there is no layer Wals, ; there are 0, Walls, Old, Hidden, Möbel");
}

#[test]
fn names_are_decoded() {
    let layer = |name: &[u8]| {
        let text = String::from_utf8(Dxf::new().line("NAME", [0.0; 2], [1.0, 0.0]).model(&Dxf::new())).unwrap();
        let [before, behind] = text.split("NAME").collect::<Vec<_>>()[..] else { panic!("{text}") };
        read(&[before.as_bytes(), name, behind.as_bytes()].concat()).layers
    };
    assert_eq!(layer(b"W\xC3\xA4nde"), ["Wände"]);
    assert_eq!(layer(b"W\xE4nde"), ["Wände"]);
    assert_eq!(layer(br"W\U+00E4nde\U+00E"), ["Wände\\U+00E"]);
    assert_eq!(layer(br"\U+D800\U+\U+0041"), ["\\U+D800\\U+A"]);
    // Without regard to case.
    let both = Dxf::new().line("WÄNDE", [0.0; 2], [1.0, 0.0]).line("wände", [0.0; 2], [2.0, 0.0]);
    assert_eq!(read(&both.model(&Dxf::new())).layers, ["WÄNDE"]);
}

/// Lines may end as on other systems.
#[test]
fn line_ends_are_those_of_any_system() {
    let text = String::from_utf8(drawing()).unwrap();
    let expected = read(text.as_bytes());
    for end in ["\r\n", "\r"] {
        assert_eq!(read(text.replace('\n', end).as_bytes()), expected);
    }
}

//! The index of levels.

use crate::common::line_of;
use proptest::prelude::*;
use sightlines_formats::levels::{
    INDEX_NAME, LevelFile, LevelsIndex, parse_levels_index, read_levels_index, write_levels_index,
};

fn level(k: usize) -> LevelFile {
    let file = format!("level_{k}.glb");
    LevelFile { file, n_triangles: 10 + k as u64, n_bytes: 280, bound: 0.0009765625, occluder: k == 0 }
}

fn small() -> LevelsIndex {
    LevelsIndex {
        n_triangles: 12,
        budget: 0.001,
        levels: vec![level(0), level(1)],
        cells: vec![Some(1), None, Some(0)],
    }
}

#[test]
fn an_index_is_written_as_the_documentation_says() {
    let text = write_levels_index(&small());
    let expected = "{\n  \"sightlines_levels\": 1,\n  \"triangles\": 12,\n  \"budget\": 0.001,\n  \"levels\": [\n    \
                    {\"file\":\"level_0.glb\",\"triangles\":10,\"bytes\":280,\"bound\":0.0009765625,\"occluder\":true},\n    \
                    {\"file\":\"level_1.glb\",\"triangles\":11,\"bytes\":280,\"bound\":0.0009765625,\"occluder\":false}\n  ],\n  \
                    \"cells\": [1,null,0]\n}\n";
    assert_eq!(text, expected);
    assert_eq!(parse_levels_index(text.as_bytes()).unwrap(), small());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(INDEX_NAME);
    std::fs::write(&path, [b"\xEF\xBB\xBF", text.as_bytes()].concat()).unwrap();
    assert_eq!(read_levels_index(&path).unwrap(), small());
    std::fs::write(&path, "{}").unwrap();
    let error = read_levels_index(&path).unwrap_err().to_string();
    assert!(error.ends_with("index.json: line 1 column 2: missing field `sightlines_levels`"), "{error}");
}

#[test]
fn what_is_wrong_is_reported_with_its_place() {
    let spoilt = |from: &str, to: &str, says: &str| {
        let text = write_levels_index(&small());
        assert!(text.contains(from), "{from}");
        let error = parse_levels_index(text.replacen(from, to, 1).as_bytes()).unwrap_err();
        assert_eq!(error.to_string(), says);
    };
    spoilt("levels\": 1", "levels\": 2", "version 2 of the index is not 1");
    spoilt("0.001", "1.5", "\"budget\" is a share from 0 to 1, not 1.5");
    spoilt("0.0009765625", "-1", "level 0: \"bound\" is a share from 0 to 1, not -1");
    spoilt("level_1.glb", "../x.glb", "level 1: \"../x.glb\" is no name of a file beside the index");
    spoilt("level_1.glb", "level_0.glb", "level 1: level 0 is in the same file, \"level_0.glb\"");
    spoilt(":11", ":13", "level 1: 13 triangles are more than the 12 of the scene");
    spoilt("[1,null,0]", "[1,null,2]", "cell 2: there is no level 2, there are 2");
    spoilt("[1,null,0]", "[1,-1,0]", "line 9 column 16: invalid value: integer `-1`, expected u32");
    // Where reading stopped.
    let stops = |from: &str, to: &str, says: &str| {
        let text = write_levels_index(&small()).replacen(from, to, 1);
        let error = parse_levels_index(text.as_bytes()).unwrap_err();
        assert!(line_of(&error) > 1, "{error}");
        assert!(error.to_string().ends_with(says), "{error}");
    };
    stops("\"budget\": 0.001,", "", ": missing field `budget`");
    stops("}\n", "} x\n", ": expected `,` or `]`");
    stops("\"budget\"", "\"triangles\": 1, \"budget\"", ": duplicate field `triangles`");
}

#[test]
fn every_prefix_is_refused() {
    let text = write_levels_index(&small());
    let whole = text.trim_end().len();
    assert!((0..whole).all(|len| parse_levels_index(&text.as_bytes()[..len]).is_err()));
}

proptest! {
    /// Invariant: what is written is read as the same; no byte that differs causes a panic.
    #[test]
    fn what_is_written_is_read(
        n in 0..5usize,
        cells in prop::collection::vec(prop::option::of(any::<u32>()), 0..9),
        budget in 0.0..=1.0f64,
        at in any::<prop::sample::Index>(),
        bit in 0..8u32,
    ) {
        let levels: Vec<LevelFile> = (0..n).map(level).collect();
        let within = |l: u32| l.checked_rem(n as u32);
        let cells = cells.into_iter().map(|level| level.and_then(within)).collect();
        let index = LevelsIndex { n_triangles: 100, budget, levels, cells };
        let mut bytes = write_levels_index(&index).into_bytes();
        prop_assert_eq!(&parse_levels_index(&bytes).unwrap(), &index);
        let at = at.index(bytes.len());
        bytes[at] ^= 1 << bit;
        if let Err(error) = parse_levels_index(&bytes) {
            prop_assert!(!error.to_string().is_empty());
        }
    }
}

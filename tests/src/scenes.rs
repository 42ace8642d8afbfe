//! Scenes in space with tables of what was seen in them.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A box where an eye can be, and what was seen from it.
#[derive(Debug, Clone, PartialEq)]
pub struct CellWitness {
    /// What the data calls it; unique in its scene.
    pub id: String,
    /// Lower corner.
    pub min: [f64; 3],
    /// Upper corner.
    pub max: [f64; 3],
    /// Ids of objects that rays from inside were seen to hit, ascending: a lower bound of what is
    /// visible.
    pub objects: Vec<u32>,
}

/// The folders of `data/scenes`, sorted by name.
///
/// # Panics
/// If there are none.
pub fn scene_folders(data: &Path) -> Vec<PathBuf> {
    let scenes = data.join("scenes");
    let entries = std::fs::read_dir(&scenes).unwrap_or_else(|e| panic!("{}: {e}", scenes.display()));
    let mut folders: Vec<PathBuf> = entries.map(|e| e.expect("a folder entry").path()).filter(|p| p.is_dir()).collect();
    folders.sort();
    assert!(!folders.is_empty(), "no folder in {}", scenes.display());
    folders
}

/// What was seen in the scene of a folder: all `seen_*.json`, joined with the `cells_*.json` that each
/// names, in the order of file names and then of the files. Cells without a row of what was seen are
/// left out; a scene without any `seen_*.json` gives nothing.
///
/// # Panics
/// If the folder or a file cannot be read, or holds something else than expected: a broken table must
/// not pass for one in which nothing was seen.
pub fn scene_witness(folder: &Path) -> Vec<CellWitness> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut names: Vec<String> = entries
        .map(|e| e.expect("a folder entry").file_name().to_string_lossy().into_owned())
        .filter(|name| name.starts_with("seen_") && name.ends_with(".json"))
        .collect();
    names.sort();
    let mut cells: Vec<CellWitness> = Vec::new();
    for name in names {
        let found = witness_file(folder, &name);
        assert!(!found.is_empty(), "{name} in {} has no cells", folder.display());
        cells.extend(found);
    }
    cells
}

/// The cells of one `seen_*.json`.
fn witness_file(folder: &Path, name: &str) -> Vec<CellWitness> {
    let seen = read(&folder.join(name));
    let boxes_name = text(&seen["cells"], name);
    let boxes = read(&folder.join(boxes_name));
    let mut by_id: BTreeMap<&str, &Value> = BTreeMap::new();
    for cell in list(&boxes["cells"], boxes_name) {
        let id = text(&cell["id"], boxes_name);
        assert!(by_id.insert(id, cell).is_none(), "{boxes_name}: two cells are called {id}");
    }
    let n_objects = number(&seen["n_objects"], name) as u64;
    let row = |row: &Value| {
        let id = text(&row["id"], name);
        let cell = by_id.get(id).unwrap_or_else(|| panic!("{name}: {boxes_name} has no cell {id}"));
        let [min, max] = ["min", "max"].map(|corner| point(&cell[corner], boxes_name));
        assert!((0..3).all(|k| min[k] <= max[k]), "{boxes_name}: cell {id} is a box");
        let object = |o: &Value| {
            let object = o.as_u64().filter(|&o| o < n_objects);
            u32::try_from(object.unwrap_or_else(|| panic!("{name}: {o} is no object, in {id}"))).expect("few objects")
        };
        let objects: Vec<u32> = list(&row["objects"], name).iter().map(object).collect();
        assert!(objects.is_sorted(), "{name}: objects of {id} ascend");
        CellWitness { id: id.to_owned(), min, max, objects }
    };
    list(&seen["seen"], name).iter().map(row).collect()
}

fn read(path: &Path) -> Value {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    serde_json::from_slice(&bytes).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn list<'a>(value: &'a Value, file: &str) -> &'a [Value] {
    value.as_array().unwrap_or_else(|| panic!("{file}: a list is missing"))
}

fn text<'a>(value: &'a Value, file: &str) -> &'a str {
    value.as_str().unwrap_or_else(|| panic!("{file}: a text is missing"))
}

fn number(value: &Value, file: &str) -> f64 {
    value.as_f64().filter(|x| x.is_finite()).unwrap_or_else(|| panic!("{file}: a number is missing"))
}

fn point(value: &Value, file: &str) -> [f64; 3] {
    let numbers: Vec<f64> = list(value, file).iter().map(|x| number(x, file)).collect();
    numbers.try_into().unwrap_or_else(|_| panic!("{file}: a corner has three coordinates"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::write;

    const CELLS: &str = r#"{"cells": [{"id": "a", "min": [0, 0, 0], "max": [1, 2.5, 1]},
        {"id": "b", "min": [1, 0, 0], "max": [2, 2.5, 1], "fill": 1.0}]}"#;
    const SEEN: &str = r#"{"scene": "s.glb", "cells": "cells_x.json", "n_objects": 9, "rays_per_cell": 10,
        "seen": [{"id": "b", "objects": [0, 4, 8]}]}"#;

    /// What is read from a folder with these two files.
    fn witness(cells: &str, seen: &str) -> Vec<CellWitness> {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path().join("cells_x.json"), cells).unwrap();
        write(folder.path().join("seen_x.json"), seen).unwrap();
        scene_witness(folder.path())
    }

    #[test]
    fn witnesses_join_boxes_and_what_was_seen() {
        let b = CellWitness { id: "b".to_owned(), min: [1., 0., 0.], max: [2., 2.5, 1.], objects: vec![0, 4, 8] };
        assert_eq!(witness(CELLS, SEEN), [b]);
        assert!(scene_witness(tempfile::tempdir().unwrap().path()).is_empty());
    }

    /// The impostors: nothing that is broken passes for an empty table.
    #[test]
    fn witnesses_that_are_broken_are_refused() {
        let broken = |cells: String, seen: String| std::panic::catch_unwind(|| witness(&cells, &seen)).is_err();
        assert!(!broken(CELLS.to_owned(), SEEN.to_owned()));
        for (from, to) in
            [("\"b\"", "\"c\""), ("[0, 4, 8]", "[0, 4, 9]"), ("[0, 4, 8]", "[4, 0]"), ("\"seen\"", "\"s\"")]
        {
            assert!(broken(CELLS.to_owned(), SEEN.replace(from, to)), "{from} -> {to}");
        }
        assert!(broken(CELLS.to_owned(), SEEN.replace(r#"{"id": "b", "objects": [0, 4, 8]}"#, "")));
        for (from, to) in [("\"b\"", "\"a\""), ("[1, 0, 0]", "[1, 0]"), ("[1, 0, 0]", "[3, 0, 0]"), ("2.5", "\"2\"")] {
            assert!(broken(CELLS.replace(from, to), SEEN.to_owned()), "{from} -> {to}");
        }
    }

    /// All scenes of the data folder: something was seen in most of them.
    #[test]
    fn witnesses_of_real_scenes_are_read() {
        let Some(data) = crate::data_folder("SIGHTLINES_DATA") else { return };
        let mut n_scenes = 0;
        for folder in scene_folders(&data) {
            let cells = scene_witness(&folder);
            n_scenes += usize::from(!cells.is_empty());
            assert!(cells.iter().filter(|c| !c.objects.is_empty()).count() * 2 >= cells.len(), "{}", folder.display());
        }
        assert!(n_scenes >= 7, "only {n_scenes} scenes with witnesses");
    }
}

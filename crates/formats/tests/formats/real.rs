//! Real files: Freedoom's maps, floor plans of buildings, view cells of scenes.

use crate::common::{data_folder, difference_besides_reject, files};
use sightlines_formats::doom::{MapLump, list_maps};
use sightlines_formats::geojson::{parse_plan, read_plan_file, write_plan};
use sightlines_formats::view_cells::read_view_cells;
use sightlines_formats::{DoomMap, RejectTable, Wad};
use std::path::Path;

/// Reads all maps of a WAD, checks them, writes their tables again in several ways; returns how many.
fn check_wad(path: &Path) -> usize {
    let wad = Wad::read(path).unwrap_or_else(|e| panic!("{e}"));
    let maps = list_maps(&wad);
    let parsed: Vec<DoomMap> = maps.iter().map(|m| DoomMap::parse(&wad, m).unwrap_or_else(|e| panic!("{e}"))).collect();
    for map in &parsed {
        check_map(map);
    }
    let same: Vec<_> = maps.iter().zip(&parsed).map(|(m, map)| (m, map.reject().unwrap().to_vec())).collect();
    assert!(wad.with_rejects(&same).unwrap() == wad.as_bytes(), "{}: the same tables, other bytes", path.display());

    let zeros: Vec<_> = same.iter().map(|(m, table)| (*m, vec![0; table.len()])).collect();
    let in_place = Wad::parse(wad.with_rejects(&zeros).unwrap()).unwrap();
    assert_eq!(in_place.as_bytes().len(), wad.as_bytes().len());
    let ranges = |w: &Wad| w.lumps().iter().map(|l| l.range()).collect::<Vec<_>>();
    assert_eq!(ranges(&in_place), ranges(&wad));
    assert_eq!(difference_besides_reject(&wad, &in_place), None);

    let longer: Vec<_> = same.iter().map(|(m, table)| (*m, vec![1; table.len() + 1])).collect();
    let laid_out = Wad::parse(wad.with_rejects(&longer).unwrap()).unwrap();
    assert_eq!(difference_besides_reject(&wad, &laid_out), None);
    for (map, (_, table)) in list_maps(&laid_out).iter().zip(&longer) {
        assert!(laid_out.lump_bytes(map.lump(MapLump::Reject).unwrap()) == table);
    }
    maps.len()
}

/// A real map has the full table of a node builder, and sectors lie on the sides that lines say.
fn check_map(map: &DoomMap) {
    let table = RejectTable::from_bytes(map.n_sectors(), map.reject().unwrap()).unwrap();
    assert_eq!(Some(table.as_bytes()), map.reject());
    assert!(!table.has_hand_made_effects(), "{}", map.name());
    let plan = map.plan().unwrap();
    assert!(plan.is_axial() || plan.small_grid().is_some());
    // Twice the area of all sectors together, as their lines say it: each has its sector on the right,
    // so lines run clockwise around sectors. On the wrong hand the sum would be negative.
    let wedge = |l: &sightlines_cells::PlanLine| l.b.x * l.a.y - l.a.x * l.b.y;
    let side =
        |l: &sightlines_cells::PlanLine| f64::from(u8::from(l.right.is_some())) - f64::from(u8::from(l.left.is_some()));
    let area: f64 = plan.lines().iter().map(|l| side(l) * wedge(l)).sum();
    assert!(area > 0.0, "{}: area {area}", map.name());
}

#[test]
fn maps_are_read_and_written_again() {
    let Some(data) = data_folder("SIGHTLINES_DATA", "maps_are_read_and_written_again") else { return };
    let wads = files(&data.join("doom"), "wad");
    assert!(!wads.is_empty(), "no maps in the data folder");
    for path in &wads {
        assert_eq!(check_wad(path), 1, "{}", path.display());
    }
}

#[test]
fn witnesses_fit_their_maps() {
    let Some(data) = data_folder("SIGHTLINES_DATA", "witnesses_fit_their_maps") else { return };
    for path in files(&data.join("doom"), "wad") {
        let wad = Wad::read(&path).unwrap_or_else(|e| panic!("{e}"));
        let map = DoomMap::parse(&wad, &list_maps(&wad)[0]).unwrap();
        let seen = std::fs::read(path.with_extension("seen.bin")).unwrap();
        let seen = RejectTable::from_bytes(map.n_sectors(), &seen).unwrap();
        let shipped = RejectTable::from_bytes(map.n_sectors(), map.reject().unwrap()).unwrap();
        let disagree = |shipped: &[u8]| -> u64 {
            seen.as_bytes().iter().zip(shipped).map(|(a, b)| u64::from((a & b).count_ones())).sum()
        };
        let few = seen.n_rejected() / 10;
        assert!(seen.is_symmetric(), "{}", path.display());
        // Shipped tables are wrong in few places.
        assert!(disagree(shipped.as_bytes()) < few, "{}", path.display());
        // An impostor with the bits of each byte in the other order is wrong in many.
        let impostor: Vec<u8> = shipped.as_bytes().iter().map(|b| b.reverse_bits()).collect();
        assert!(disagree(&impostor) > few, "{}", path.display());
    }
}

#[test]
fn floor_plans_are_read_and_written_again() {
    let Some(data) = data_folder("SIGHTLINES_DATA", "floor_plans_are_read_and_written_again") else { return };
    let plans = files(&data.join("plans"), "geojson");
    assert!(!plans.is_empty(), "no plans in the data folder");
    for path in &plans {
        let file = read_plan_file(path).unwrap_or_else(|e| panic!("{e}"));
        let (plan, dropped) = (file.plan, file.dropped);
        let text = std::fs::read_to_string(path).unwrap();
        let n_read = plan.lines().len() + dropped.n_doubled + dropped.n_without_length;
        assert_eq!(n_read, text.matches("LineString").count(), "{}", path.display());
        assert_eq!(parse_plan(text.as_bytes()).unwrap(), plan);
        assert_eq!(parse_plan(write_plan(&plan).as_bytes()).unwrap(), plan);
    }
}

/// The view cells of every scene: as many as the text has ids, and all where it says, in the unit of the scene.
#[test]
fn view_cells_are_read() {
    let Some(data) = data_folder("SIGHTLINES_DATA", "view_cells_are_read") else { return };
    let (mut n_files, mut n_cells) = (0, 0);
    for scene in std::fs::read_dir(data.join("scenes")).unwrap().map(|entry| entry.unwrap().path()) {
        if !scene.is_dir() {
            continue;
        }
        for path in files(&scene, "json") {
            if !path.file_name().unwrap().to_str().unwrap().starts_with("cells_") {
                continue;
            }
            let found = read_view_cells(&path).unwrap_or_else(|e| panic!("{e}"));
            let text = std::fs::read_to_string(&path).unwrap();
            assert_eq!(found.cells.len(), text.matches("\"id\"").count(), "{}", path.display());
            let whole: serde_json::Value = serde_json::from_str(&text).unwrap();
            for (cell, value) in found.cells.iter().zip(whole["cells"].as_array().unwrap()) {
                let corner = |member: &str| [0, 1, 2].map(|k| value[member][k].as_f64().unwrap());
                assert_eq!((cell.bounds.min, cell.bounds.max), (corner("min"), corner("max")), "{}", path.display());
                assert!(value["id"] == cell.id.as_str() && !cell.bounds.is_empty());
            }
            eprintln!("{}: {} view cells", path.display(), found.cells.len());
            (n_files, n_cells) = (n_files + 1, n_cells + found.cells.len());
        }
    }
    assert!(n_files > 0 && n_cells > n_files, "{n_files} files with {n_cells} view cells");
    eprintln!("{n_files} files with {n_cells} view cells");
}

/// `SIGHTLINES_FREEDOOM` names a folder with `freedoom1.wad`, `freedoom2.wad` and `freedm.wad` of 0.12.1.
#[test]
fn all_of_freedoom_is_read_and_written_again() {
    let Some(folder) = data_folder("SIGHTLINES_FREEDOOM", "all_of_freedoom_is_read_and_written_again") else { return };
    let counts = ["freedoom1.wad", "freedoom2.wad", "freedm.wad"].map(|file| check_wad(&folder.join(file)));
    assert_eq!(counts, [36, 32, 32]);
}

//! What the program writes stays the same, byte for byte, until somebody decides otherwise.
//!
//! A table is compared by its JSON export and not by its file, so that a new version of the format is no difference.
//! `BLESS=1` writes the list anew: look at what changed, and say in the commit why.

use crate::common::{DEMO, DEMO_TOWER, Folder};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// The length and the checksum of a file.
type Digest = (usize, u32);

fn digest(bytes: &[u8]) -> Digest {
    (bytes.len(), crc32fast::hash(bytes))
}

fn list() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/golden/same_bytes.txt")
}

/// Lines such as `demo/plan.json 1234 0a1b2c3d`.
fn parse(text: &str) -> BTreeMap<String, Digest> {
    let line = |line: &str| {
        let mut words = line.split(' ');
        let name = words.next()?.to_owned();
        let length = words.next()?.parse().ok()?;
        Some((name, (length, u32::from_str_radix(words.next()?, 16).ok()?)))
    };
    text.lines().map(|l| line(l).unwrap_or_else(|| panic!("a name, a length and a checksum: {l}"))).collect()
}

fn write(digests: &BTreeMap<String, Digest>) -> String {
    digests.iter().fold(String::new(), |mut text, (name, (length, checksum))| {
        writeln!(text, "{name} {length} {checksum:08x}").expect("a string takes any text");
        text
    })
}

/// Names whose digest is not the one on the list, and names that are not on it.
fn differences(found: &BTreeMap<String, Digest>, expected: &BTreeMap<String, Digest>) -> Vec<String> {
    found.iter().filter(|(name, digest)| expected.get(*name) != Some(digest)).map(|(name, _)| name.clone()).collect()
}

/// Compares with the list, or enters into it what was found. `prefix` is that of all the names: none of the list that begins
/// so may be missing.
fn compare(prefix: &str, found: &BTreeMap<String, Digest>) {
    assert!(found.keys().all(|name| name.starts_with(prefix)));
    let mut expected = parse(&std::fs::read_to_string(list()).unwrap_or_default());
    if std::env::var("BLESS").is_ok_and(|v| v == "1") {
        expected.retain(|name, _| !name.starts_with(prefix));
        expected.extend(found.clone());
        std::fs::write(list(), write(&expected)).expect("the list can be written");
        return;
    }
    assert_eq!(differences(found, &expected), Vec::<String>::new(), "these changed; see the head of this file");
    let missing: Vec<_> = expected.keys().filter(|n| n.starts_with(prefix) && !found.contains_key(*n)).collect();
    assert!(missing.is_empty(), "these were not made: {missing:?}");
    assert!(!found.is_empty());
}

/// The export and a drawing of the table that `build` makes of a file.
fn table(folder: &Folder, name: &str, input: &str, options: &[&str], found: &mut BTreeMap<String, Digest>) {
    folder.run(&[&["build", input, "-o", "t.pvs"], options].concat()).expect(0);
    exported(folder, name, "t.pvs", found);
}

fn exported(folder: &Folder, name: &str, table: &str, found: &mut BTreeMap<String, Digest>) {
    folder.run(&["export", table, "-o", "t.json"]).expect(0);
    found.insert(format!("{name}.json"), digest(&folder.read("t.json")));
}

fn picture(folder: &Folder, name: &str, options: &[&str], found: &mut BTreeMap<String, Digest>) {
    folder.run(&[&["draw", "t.pvs", "-o", "t.svg"], options].concat()).expect(0);
    found.insert(format!("{name}.svg"), digest(&folder.read("t.svg")));
}

#[test]
fn generated_scenes_give_the_same_bytes() {
    let mut found = BTreeMap::new();
    let folder = Folder::new();
    folder.write_all("office", &DEMO.1);
    folder.write_all("tower", &DEMO_TOWER[0].1);
    let made = ["office/plan.geojson", "office/plan.svg", "office/seen-typical.svg", "tower/tower.glb"];
    for file in made.into_iter().chain(["tower/tower-floor.svg", "tower/tower-cells.svg"]) {
        found.insert(format!("generated/{file}"), digest(&folder.read(file)));
    }
    exported(&folder, "generated/office/plan", "office/plan.pvs", &mut found);
    exported(&folder, "generated/tower/tower", "tower/tower.pvs", &mut found);
    table(&folder, "generated/office-kd", "office/plan.geojson", &["--subdivide", "kd"], &mut found);
    for method in ["multifocal", "both", "shafts"] {
        let options = ["--method", method, "--grid", "2,2,1"];
        table(&folder, &format!("generated/tower-{method}"), "tower/tower.glb", &options, &mut found);
    }
    let maps = Folder::with_wad();
    maps.run(&["reject", "maps.wad", "-o", "new.wad", "--force"]).expect(0);
    found.insert("generated/maps.wad".to_owned(), digest(&maps.read("new.wad")));
    table(&maps, "generated/map01", "maps.wad", &["--map", "MAP01"], &mut found);
    compare("generated/", &found);
}

fn data(test: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os("SIGHTLINES_DATA").map(PathBuf::from) else {
        eprintln!("SKIPPED {test}: SIGHTLINES_DATA is not set");
        return None;
    };
    assert!(folder.is_dir(), "SIGHTLINES_DATA names no folder: {}", folder.display());
    Some(folder)
}

/// The files of a folder with this extension, sorted, each with its name without the extension.
fn files(folder: &Path, extension: &str) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|e| e.expect("an entry").path());
    let mut files: Vec<_> = entries.filter(|p| p.extension().is_some_and(|e| e == extension)).collect();
    files.sort();
    let text = |part: Option<&std::ffi::OsStr>| part.and_then(|p| p.to_str()).expect("a plain name").to_owned();
    files.iter().map(|p| (text(p.file_stem()), text(Some(p.as_os_str())))).collect()
}

#[test]
fn real_plans_give_the_same_bytes() {
    let Some(data) = data("real_plans_give_the_same_bytes") else { return };
    let (folder, mut found) = (Folder::new(), BTreeMap::new());
    for (name, plan) in files(&data.join("plans"), "geojson") {
        table(&folder, &format!("plans/{name}"), &plan, &[], &mut found);
        picture(&folder, &format!("plans/{name}"), &[], &mut found);
    }
    compare("plans/", &found);
}

#[test]
fn real_doom_maps_give_the_same_bytes() {
    let Some(data) = data("real_doom_maps_give_the_same_bytes") else { return };
    let (folder, mut found) = (Folder::new(), BTreeMap::new());
    for (name, wad) in files(&data.join("doom"), "wad") {
        folder.run(&["reject", &wad, "-o", "new.wad", "--force"]).expect(0);
        found.insert(format!("doom/{name}.wad"), digest(&folder.read("new.wad")));
    }
    let map = data.join("doom/freedm_MAP01.wad");
    table(&folder, "doom/freedm_MAP01", map.to_str().expect("a plain name"), &[], &mut found);
    compare("doom/", &found);
}

#[test]
fn real_quake_maps_give_the_same_bytes() {
    let Some(data) = data("real_quake_maps_give_the_same_bytes") else { return };
    let (folder, mut found) = (Folder::new(), BTreeMap::new());
    for map in ["e1m7", "start"] {
        let path = |extension: &str| data.join("quake").join(map).with_extension(extension).display().to_string();
        folder.run(&["vis", &path("bsp"), "--prt", &path("prt"), "-o", "new.bsp"]).expect(0);
        found.insert(format!("quake/{map}.bsp"), digest(&folder.read("new.bsp")));
        table(&folder, &format!("quake/{map}"), &path("bsp"), &[], &mut found);
    }
    compare("quake/", &found);
}

#[test]
fn real_buildings_give_the_same_bytes() {
    let Some(data) = data("real_buildings_give_the_same_bytes") else { return };
    let (folder, mut found) = (Folder::new(), BTreeMap::new());
    let path = |scene: &str| data.join("scenes").join(scene).join(scene).with_extension("glb").display().to_string();
    // A street of slanted houses is cut into places by default, which takes long.
    for (scene, options) in [("whale_tall", &[][..]), ("whale_large", &[]), ("delft", &["--method", "sightlines"])] {
        table(&folder, &format!("scenes/{scene}"), &path(scene), options, &mut found);
        picture(&folder, &format!("scenes/{scene}"), &["--height", "1.5"], &mut found);
    }
    table(&folder, "scenes/whale_large-exact", &path("whale_large"), &["--gap", "0"], &mut found);
    let rooms = data.join("scenes/duplex/cells_rooms.json").display().to_string();
    table(&folder, "scenes/duplex-rooms", &path("duplex"), &["--cells", &rooms], &mut found);
    compare("scenes/", &found);
}

/// One bit of one file, and one file that is not on the list, are noticed.
#[test]
fn a_difference_is_noticed() {
    let list = BTreeMap::from([("a".to_owned(), digest(&[1, 2, 3])), ("b".to_owned(), digest(&[]))]);
    assert_eq!(parse(&write(&list)), list);
    assert!(differences(&list, &list).is_empty());
    let mut other = list.clone();
    other.insert("a".to_owned(), digest(&[1, 2, 2]));
    other.insert("c".to_owned(), digest(&[]));
    assert_eq!(differences(&other, &list), ["a", "c"]);
}

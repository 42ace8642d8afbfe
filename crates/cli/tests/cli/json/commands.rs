//! Commands with `--json`, and what they print.

use crate::common::looks::table;
use crate::common::picture::DRAWN;
use crate::common::quake::{rooms, row_of_leafs};
use crate::common::{DEMO, DEMO_TOWER, Folder, doom_map, levels, maze_text};
use serde_json::Value;
use sightlines::formats::LumpName;
use sightlines::formats::doom::{DoomMapSource, write_doom_map};
use sightlines::formats::quake::BspFormat;
use sightlines::formats::scene::{read_scene, write_glb};
use sightlines::formats::wad::{WadBuilder, WadKind};
use sightlines::pvs::{CellId, Table};

/// A room of 8 by 5 by 3, turned by the angle whose cosine and sine are 4/5 and 3/5.
const TURNED: &str = "o room
v 0 0 0\nv 6.4 4.8 0\nv -3 4 0\nv 3.4 8.8 0\nv 0 0 3\nv 6.4 4.8 3\nv -3 4 3\nv 3.4 8.8 3
f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4
";

/// Two squares, one behind the other, and two triangles that are objects of their own.
const BOARDS: &str =
    "v -1 -1 5\nv 1 -1 5\nv 1 1 5\nv -1 1 5\nv -1 -1 9\nv 1 -1 9\nv 1 1 9\nv -1 1 9\nf 1 2 3 4\nf 5 6 7 8\n";
const TRIANGLES: &str = "o a\nv -1 -1 5\nv 1 -1 5\nv 1 1 5\nf 1 2 3\no b\nv -1 -1 9\nv 1 -1 9\nv 1 1 9\nf 4 5 6\n";
const VOLUME: &str = "-0.5,-0.5,-0.5,0.5,0.5,0.5";

/// Results of commands, each with the heading of its section.
#[derive(Default)]
pub(super) struct Results(Vec<(&'static str, Value)>);

impl Results {
    /// Those of all commands that have `--json`, in enough ways that every field is in one of them.
    pub(super) fn of_all_commands() -> Vec<(&'static str, Value)> {
        let mut all = Self::default();
        plans(&mut all);
        scenes(&mut all);
        maps(&mut all);
        jobs(&mut all);
        all.0
    }

    /// Runs a command that finds something: exit code 0, 1 if the answer is no, or 3 if a job is not complete.
    fn add(&mut self, folder: &Folder, heading: &'static str, args: &[&str]) {
        let run = folder.run(&[args, &["--json"]].concat());
        assert!(run.code < 2 || run.code == 3, "{args:?}: {}", run.err);
        self.0.push((heading, run.json()));
    }

    /// As `add`, with the arguments as a line.
    fn line(&mut self, folder: &Folder, heading: &'static str, line: &str) {
        self.add(folder, heading, &line.split(' ').collect::<Vec<_>>());
    }
}

/// A wrong table: cell 0 sees only itself, and an object has another name.
fn wrong(table: &Table) -> Vec<u8> {
    let mut parts = table.clone().into_parts();
    parts.objects[0].name = "another".to_owned();
    for k in 1..parts.cells.len() {
        parts.rows.set(0, k, false);
        parts.rows.set(k, 0, false);
    }
    Table::new(parts).expect("symmetric").to_bytes()
}

/// Cell 0, the first cell visible from it, the last, and the first that is hidden.
fn some_cells(table: &Table) -> Vec<usize> {
    let (seen, hidden): (Vec<usize>, Vec<usize>) =
        (1..table.n_cells()).partition(|&k| table.sees(CellId(0), CellId(k as u32)));
    [Some(&0), seen.first(), seen.last(), hidden.first()].into_iter().flatten().copied().collect()
}

fn plans(all: &mut Results) {
    let folder = Folder::with_office();
    folder.write("p.csv", "3,3\n");
    let mut add = |heading, line: &str| all.line(&folder, heading, line);
    add(
        "build of a plan",
        "build office.geojson -o o.pvs --certify --stab-trees=64 --method auto --door all=0,0,99,99",
    );
    add("info of a table", "info o.pvs");
    add("info of a plan", "info office.geojson");
    add("plan", "plan office.geojson -o copy.geojson");
    add("isovist of a plan", "isovist office.geojson --at 3,3 -o i.geojson");
    add("vga", "vga office.geojson --spacing 2 --measures all -o o.csv");
    add("vga", "vga office.geojson --spacing 2 --measure clustering -o o.svg");
    add("vga", "vga office.geojson --points p.csv -o p.geojson");
    add("verify", "verify o.pvs office.geojson --rays 100 --pairs 10");
    add("build of a plan", "build office.geojson -o gap.pvs --gap 1e-6");
    add("verify", "verify gap.pvs office.geojson --rays 100 --pairs 10");
    add("query of a point", "query o.pvs --eye 3,3");
    add("query of a point", "query o.pvs --eye 1e5,3");
    add("query of a view", "query o.pvs --eye 1e5,3 --dir 1,0");
    add("query of a view", "query o.pvs --eye 3,3 --method all");
    add("walk", "walk o.pvs --random 20");
    add("view", "view o.pvs -o o.html");
    add("relevance", "relevance o.pvs -o o.rel --by-walking");
    add("pack", "pack o.pvs -o o.pvz");
    add("walk", "walk o.pvz --random 20");
    add("info of a packed table", "info o.pvz");
    add("unpack", "unpack o.pvz -o back.pvs");
    add("explain outside every cell", "explain o.pvs 1e5,3 0");
    let table = table(&folder, "o.pvs");
    for cell in some_cells(&table) {
        add("explain in a plan", &format!("explain o.pvs 0 {cell}"));
        add("explain in a plan", &format!("explain o.pvs 0 {cell} --max-visits 1"));
    }
    folder.write("wrong.pvs", wrong(&table));
    let draw = format!("verify wrong.pvs office.geojson --rays 5000 --pairs 500 --draw v.{DRAWN}");
    all.line(&folder, "verify", &draw);
    folder.write("other.geojson", maze_text(1));
    all.line(&folder, "verify", "verify o.pvs other.geojson --rays 100 --pairs 10");
    let mut parts = table.into_parts();
    parts.cell_names = (0..parts.cells.len()).map(|k| format!("room {k}")).collect();
    folder.write("named.pvs", Table::new(parts).expect("a sound table").to_bytes());
    all.line(&folder, "query of a point", "query named.pvs --eye 3,3");
    all.line(&folder, "query of a view", "query named.pvs --eye 3,3 --method all");
    all.0.push(("demo of the office", DEMO.0.json()));

    let line = |points: &str, mirror: bool| {
        let geometry = format!(r#"{{"type": "LineString", "coordinates": {points}}}"#);
        format!(r#"{{"type": "Feature", "properties": {{"mirror": {mirror}}}, "geometry": {geometry}}}"#)
    };
    let lines = [line("[[8,0],[8,4],[5,4],[5,8],[3,8],[3,4],[0,4],[0,0]]", false), line("[[0,0],[8,0]]", true)];
    folder.write("hall.geojson", format!(r#"{{"type": "FeatureCollection", "features": [{}]}}"#, lines.join(",")));
    folder.run(&["build", "hall.geojson", "-o", "hall.pvs"]).expect(0);
    let mut parts = crate::common::looks::table(&folder, "hall.pvs").into_parts();
    parts.cell_names = (0..parts.cells.len()).map(|k| format!("room {k}")).collect();
    folder.write("hall.pvs", Table::new(parts).expect("a sound table").to_bytes());
    // An office has objects, and the hall a mirror.
    let look = ["--dir", "0,-1", "--bounces", "1"];
    all.add(&folder, "query of a view", &[&["query", "hall.pvs", "--eye", "0.5,2"][..], &look].concat());
    all.add(&folder, "query of a view", &["query", "o.pvs", "--eye", "3,3", "--method", "exact"]);
    all.add(&folder, "query of a view", &["query", "hall.pvs", "--eye", "0.5,2", "--method", "all", "--bounces", "1"]);
}

/// Four slanted, flat squares, far from one another.
fn slanted() -> String {
    let square = |i: u32| {
        let (z, n) = (3.0 * f64::from(i), 4 * i);
        let corners = [(0.0, 0.0, z), (2.0, 0.0, z + 1.0), (2.0, 2.0, z + 1.5), (0.0, 2.0, z + 0.5)];
        let corners: String = corners.iter().map(|(x, y, z)| format!("v {x} {y} {z}\n")).collect();
        format!("o s{i}\n{corners}f {} {} {}\nf {} {} {}\n", n + 1, n + 2, n + 3, n + 1, n + 3, n + 4)
    };
    (0..4).map(square).collect()
}

fn jobs(all: &mut Results) {
    let folder = Folder::with_bare_tower();
    let mut add = |heading, line: &str| all.line(&folder, heading, line);
    add(
        "job plan",
        "job plan --json -o j --shards 3 build tower.glb --method shafts --grid 3,1,1 -o o.pvs --threads 1",
    );
    add("job submit --dry-run", "job submit j --dry-run");
    add("job shard", "job shard j 0");
    add("job merge", "job merge j");
    folder.write("j/parts/1.part", "no part");
    add("job merge", "job merge j");
    add("job status", "job status j");
    add("job work", "job work j");
    folder.write("j/parts/1.part", "no part");
    add("job submit", "job submit j --workers 1");
    add("job work", "job work j");
    add("job merge", "job merge j");
    // Nothing of a plan in the plane is shared.
    folder.write("maze.geojson", maze_text(1));
    add("job plan", "job plan --json -o n build maze.geojson -o n.pvs");
    // The next phase of a job.
    let map = rooms(4, 3);
    folder.write("map.bsp", map.bsp);
    folder.write("map.prt", map.prt);
    folder.run(&["job", "plan", "-o", "k", "vis", "map.bsp", "-o", "out.bsp"]).expect(0);
    folder.run(&["job", "shard", "k", "0"]).expect(0);
    add("job merge", "job merge k");
}

fn scenes(all: &mut Results) {
    let folder = Folder::with_tower();
    folder.write("boards.obj", BOARDS);
    folder.write("triangles.obj", TRIANGLES);
    folder.write("slanted.obj", slanted());
    folder.write("turned.obj", TURNED);
    folder.write("extras.glb", levels::blender_with_extras());
    folder.write("doors.glb", levels::with_doors());
    folder.write("path.json", r#"{"frames": [{"eye": [1, 1, 1], "dir": [1, 0, 0]}]}"#);
    let cell = r#"{"id": "a", "min": [1, 4, 1], "max": [2, 5, 2]}"#;
    folder
        .write("across.json", format!(r#"{{"axes": [[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]], "cells": [{cell}]}}"#));
    let mut add = |heading, line: &str| all.line(&folder, heading, line);
    let least = "--floors 1 --rooms-x 1 --rooms-y 1 --furniture 0";
    add("generate tower", &format!("generate tower -o least.glb {least}"));
    add("generate world", "generate world --blocks 2 --per-tile 1 -o city");
    crate::tiles::thin(&folder, 8);
    add("tiles build", "tiles build city/world.json --method shafts -o tiles");
    add("tiles query", "tiles query tiles --eye 42,1.7,44");
    add("tiles query", "tiles query tiles --eye -100,0,0");
    add("tiles check", "tiles check tiles");
    add("plan", "plan tower.glb --height 1.2 -o tower.geojson");
    add("isovist of a scene", "isovist tower.glb --at 3,1.5,3 --rays 200 -o tower.csv");
    add("build of a scene", "build least.glb -o least.pvs --door all=-99,-99,-99,99,99,99");
    add("query of a point", "query least.pvs --eye 2,1,2");
    add("query of a view", "query least.pvs --eye 2,1,2 --closed all");
    add("query of a view", "query least.pvs --eye 2,1,2 --method all");
    add("pack", "pack least.pvs -o least.pvz");
    add("info of a table", "info least.pvs --objects");
    add("info of a packed table", "info least.pvz --objects");
    add("build of a scene", "build triangles.obj -o t.pvs --method auto --certify --stab-trees=16");
    add("build of a scene by regions", "build slanted.obj -o s.pvs --method auto");
    add(
        "build of a scene by regions",
        "build least.glb -o r.pvs --method shafts --grid 2,1,2 --door all=-9,-9,-9,9,9,9",
    );
    add("verify", "verify r.pvs least.glb --rays 100 --pairs 10");
    add("build of a scene by regions", "build least.glb -o parts.pvs --grid 2,1,2 --parts 4");
    add("query of a point", "query parts.pvs --eye 2,1,2");
    add("query of a view", "query parts.pvs --eye 2,1,2 --method all");
    let row_by_row = "build of a scene row by row";
    add(row_by_row, "build least.glb -o r.pvz --class large --method shafts --grid 2,1,2");
    add(row_by_row, "build least.glb -o r.pvz --class large --method shafts --grid 2,1,2 --time-limit 0");
    add(row_by_row, "build turned.obj -o t.pvz --class large --gap 1e-5 --method shafts --grid 2,1,1");
    add("build of a scene by regions", "build triangles.obj -o r.pvs --method shafts --stab-trees=16 --certify");
    let least = read_scene(folder.path("least.glb")).expect("a scene").scene;
    let objects = (0..least.objects().len() as u32).collect();
    let single = least.with_single_sided(objects).expect("objects of the scene");
    folder.write("single.glb", write_glb(&single).expect("single precision"));
    add("build of a scene", "build single.glb -o single.pvs --backs culled");
    // A sky around two things.
    let sky =
        "v -99 -99 -99\nv 99 -99 -99\nv 99 99 -99\nv -99 99 -99\nv -99 -99 99\nv 99 -99 99\nv 99 99 99\nv -99 99 99
f 7 8 9 10\nf 11 14 13 12\nf 7 11 12 8\nf 8 12 13 9\nf 9 13 14 10\nf 10 14 11 7\n";
    folder.write("sky.obj", format!("{TRIANGLES}o sky\n{sky}"));
    add("build of a scene", "build sky.obj -o sky.pvs");
    add("build of a scene by regions", "build sky.obj -o sky.pvs --n-cells 2");
    add("build of a scene by regions", "build tower.glb -o eyes.pvs --eye-height 0,2.2 --cell-size 8");
    add("build of a scene by regions", "build single.glb -o single.pvs --method shafts --grid 2,1,2 --backs culled");
    add("info of a scene", "info tower.glb");
    add("build of a scene", "build turned.obj -o turned.pvs --gap 1e-5");
    add("info of a scene", "info extras.glb");
    add("build of a scene", "build doors.glb -o doors.pvs");
    add("build of a scene", "build doors.glb -o doors.pvs --time-limit 0");
    add("build of a scene by regions", "build doors.glb -o doors.pvs --method both");
    add("build of a scene by regions", "build slanted.obj -o s.pvs --method auto --time-limit 0");
    add("build of a scene", "build extras.glb -o extras.pvs");
    add("build of a scene by regions", "build extras.glb -o extras.pvs --method shafts --grid 2,1,1");
    add("build of a scene by regions", "build turned.obj -o g.pvs --gap 1e-5 --method shafts --grid 2,1,1");
    add("build of a scene by regions", "build turned.obj -o c.pvs --gap 1e-5 --cells across.json");
    add("verify", "verify turned.pvs turned.obj --rays 100 --pairs 10");
    add("info of a table", "info turned.pvs");
    add("pack", "pack turned.pvs -o turned.pvz");
    add("info of a packed table", "info turned.pvz");
    // Some of it is glass.
    add("info of a scene", "info slanted.obj --see-through s1");
    add("build of a scene", "build triangles.obj -o g.pvs --see-through *");
    add("build of a scene by regions", "build slanted.obj -o g.pvs --method shafts --see-through s? --opaque s2");
    for cell in some_cells(&table(&folder, "tower.pvs")) {
        add("explain in a scene", &format!("explain tower.pvs 0 {cell}"));
        add("explain in a scene", &format!("explain tower.pvs 0 {cell} --max-programs 0"));
    }
    folder.run(&["build", "tower.glb", "--grid", "6,3,6", "-o", "boxes.pvs"]).expect(0);
    for cell in some_cells(&table(&folder, "boxes.pvs")) {
        for scene in ["", " --scene tower.glb --rays 100"] {
            add("explain of cells without portals", &format!("explain boxes.pvs 0 {cell}{scene}"));
        }
    }
    add("strip", "strip triangles.obj -o stripped.obj --triangles");
    add("generate gearbox", "generate gearbox --gears 1 -o g.glb");
    add("strip", "strip g.glb -o stripped.glb --explain *");
    add("levels", "levels least.glb --table least.pvs -o levels --method none");
    add("walk", "walk least.pvs --path path.json --levels levels");
    let simplify = format!("simplify triangles.obj --volume={VOLUME} -o s.glb --method none");
    add("simplify", &simplify);
    add("simplify", &format!("{simplify} --report"));
    folder.write("decimals.obj", TRIANGLES.replace("-1 -1 ", "-1.1 -1 "));
    add("simplify", &simplify.replace("triangles", "decimals"));
    add("build of a scene", "build decimals.obj -o decimals.pvs");
    add("levels", "levels decimals.obj --table decimals.pvs -o decimals --method none");
    let look = "--size 16x12 --eye 0,0,0 --look-at 0,0,5";
    add("render", &format!("render boards.obj -o r.png --method zbuffer --far 20 {look}"));
    add("render", &format!("render boards.obj -o r.png --compare --cull frustum {look}"));
    add("light", &format!("light boards.obj --light=-1,8,1,1,8,2 -o l.png {look}"));
    let multifocal = format!("multifocal boards.obj --volume={VOLUME} --plane z=20 --texels 8 -o m.png --backend cpu");
    add("multifocal", &multifocal);
    add("multifocal", &format!("{multifocal} --distance d.png"));
    all.0.push(("demo tower", DEMO_TOWER[1].0.json()));
}

/// A WAD of two maps; the second has a line to nowhere.
fn one_bad_map() -> Vec<u8> {
    let mut builder = WadBuilder::new(WadKind::Patch);
    let [good, mut bad] = [1, 2].map(doom_map);
    bad.lines[0].v2 = 60_000;
    for (map, name) in [(good, "MAP01"), (bad, "MAP02")] {
        map.add_to(&mut builder, LumpName::new(name).expect("a short name")).expect("a small map");
    }
    builder.finish().expect("a small file")
}

fn maps(all: &mut Results) {
    let folder = Folder::with_wad();
    all.line(&folder, "reject", "reject maps.wad -o out.wad");
    all.line(&folder, "info of a WAD", "info out.wad");
    folder.write("some.wad", one_bad_map());
    all.line(&folder, "reject", "reject some.wad -o others.wad");
    crate::reject_folder::add_wads(&folder);
    folder.write("wads/noise.wad", "no WAD");
    all.line(&folder, "reject of a folder", "reject wads -o new-wads");
    all.line(&folder, "build of a plan", "build maps.wad --map MAP01 -o o.pvs");
    let (name, source) = (LumpName::new("MAP01").expect("a short name"), doom_map(4));
    let n = usize::from(source.n_sectors);
    folder.write("plain.wad", write_doom_map(name, &source).expect("a small map"));
    let all_hidden = DoomMapSource { reject: Some(vec![0xff; (n * n).div_ceil(8)]), ..source };
    folder.write("bad.wad", write_doom_map(name, &all_hidden).expect("a small map"));
    all.line(&folder, "verify", "verify bad.wad plain.wad --rays 2000 --pairs 200");

    let folder = Folder::new();
    let map = rooms(5, 3);
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    let mut add = |heading, line: &str| all.line(&folder, heading, line);
    add("vis", "vis map.bsp -o out.bsp");
    add("vis", "vis map.bsp -o out.bsp --certify 3");
    add("vis", "vis map.bsp -o out.bsp --visdist 20");
    folder.write("pairs.txt", "show 1 2\n");
    add("vis", "vis map.bsp -o out.bsp --overrides pairs.txt");
    add("info of a Quake map", "info map.bsp");
    add("info of a Quake map", "info out.bsp");
    add("info of a portal file", "info map.prt");
    let door = "--door all=-999,-999,-999,999,999,999";
    let build = format!("build map.prt -o p.pvs --method auto --certify --stab-trees=64 {door}");
    add("build of a portal file", &build);
    add("verify", "verify p.pvs map.prt --rays 100 --pairs 10");
    for cell in some_cells(&table(&folder, "p.pvs")).into_iter().chain([14]) {
        add("explain of clusters", &format!("explain map.prt 0 {cell}"));
        add("explain of clusters", &format!("explain p.pvs 0 {cell} --max-questions 1"));
    }

    // With the tree and the faces that a table of a map needs.
    let folder = Folder::new();
    let map = row_of_leafs(BspFormat::Bsp29);
    folder.write("map.bsp", &map.bsp);
    folder.write("map.prt", &map.prt);
    all.line(&folder, "portals", "portals map.bsp -o made.prt");
    folder.run(&["vis", "map.bsp", "-o", "seen.bsp"]).expect(0);
    let mut add = |heading, line: &str| all.line(&folder, heading, line);
    add("verify", "verify seen.bsp map.bsp --rays 100 --pairs 10");
    add("build of a Quake map", &format!("build map.bsp -o m.pvs --method auto --certify --stab-trees=64 {door}"));
}

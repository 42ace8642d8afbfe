//! What commands print with `--json`: every object has a version, and `docs/json.md` lists its fields, no more and no less.

use crate::common::looks::table;
use crate::common::picture::DRAWN;
use crate::common::quake::{rooms, row_of_leafs};
use crate::common::{Folder, doom_map, levels, maze_text};
use serde_json::{Map, Value};
use sightlines::formats::LumpName;
use sightlines::formats::doom::{DoomMapSource, write_doom_map};
use sightlines::formats::quake::BspFormat;
use sightlines::pvs::{CellId, Table};
use std::collections::{BTreeMap, BTreeSet};

const PAGE: &str = include_str!("../../../../docs/json.md");
/// The section of the fields that all objects have.
const COMMON: &str = "Every command";

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

/// A field of the page.
#[derive(Debug, Clone)]
struct Field {
    /// The kinds of JSON values that it may have: `null`, `boolean`, `integer`, `number`, `text`, `list` or `object`.
    kinds: Vec<String>,
    /// Whether it may be absent.
    optional: bool,
    /// Whether the fields below it are not on the page.
    free: bool,
}

impl Field {
    fn new(cell: &str) -> Self {
        let kind = |part: &str| part.split([' ', ',']).next().unwrap_or_default().to_owned();
        let says = |word: &str| cell.split(", ").any(|part| part == word);
        Self { kinds: cell.split(" or ").map(kind).collect(), optional: says("optional"), free: says("free keys") }
    }

    fn fits(&self, value: &Value) -> bool {
        let is = |kind: &String| match (kind.as_str(), value) {
            ("integer", Value::Number(n)) => n.is_u64() || n.is_i64(),
            ("null", Value::Null)
            | ("boolean", Value::Bool(_))
            | ("number", Value::Number(_))
            | ("text", Value::String(_))
            | ("list", Value::Array(_))
            | ("object", Value::Object(_)) => true,
            _ => false,
        };
        self.kinds.iter().any(is)
    }
}

/// The fields of a section by their paths: `a.b` is below the object `a`, `a[].b` below each element of the list `a`.
type Section = BTreeMap<String, Field>;

/// A row of a section: a field, or the anchor of a part whose fields are below it, or both.
type Row<'a> = (Option<&'a str>, Option<&'a str>, &'a str);

/// The rows of all sections of the page, by headings without code marks.
fn rows(page: &str) -> BTreeMap<String, Vec<Row<'_>>> {
    let (mut all, mut heading) = (BTreeMap::<String, Vec<Row<'_>>>::new(), String::new());
    for line in page.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            heading = title.replace('`', "");
        }
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let [_, first, kind, meaning, _] = cells[..] else { continue };
        let field = first.strip_prefix('`').and_then(|rest| rest.split_once('`')).map(|(field, _)| field);
        let part = first.split_once("](#").map(|(_, rest)| rest.trim_end_matches(')'));
        if field.is_some() || part.is_some() {
            assert!(field.is_none() || !(kind.is_empty() || meaning.is_empty()), "{heading}: {line}");
            all.entry(heading.clone()).or_default().push((field, part, kind));
        }
    }
    all
}

/// Where a link to a heading leads.
fn anchor(heading: &str) -> String {
    let letters = heading.to_lowercase().replace(' ', "-");
    letters.chars().filter(|c| c.is_alphanumeric() || *c == '-').collect()
}

/// The sections of all commands, with the fields of parts in their places.
fn sections(page: &str) -> BTreeMap<String, Section> {
    fn add(heading: &str, below: &str, all: &BTreeMap<String, Vec<Row<'_>>>, out: &mut Section) {
        for &(field, part, kind) in all.get(heading).into_iter().flatten() {
            if let Some(field) = field {
                let path = format!("{below}{}", field.trim_end_matches("[]"));
                assert!(out.insert(path.clone(), Field::new(kind)).is_none(), "{heading}: {path} twice");
            }
            if let Some(part) = part {
                let part = all.keys().find(|other| anchor(other) == part).expect("the part of a link");
                let below = field.map_or(below.to_owned(), |field| format!("{below}{field}."));
                add(part, &below, all, out);
            }
        }
    }
    let all = rows(page);
    let commands = all.keys().filter(|heading| !heading.starts_with("Part: ") && *heading != COMMON);
    let section = |heading: &String| {
        let mut out = Section::new();
        [COMMON, heading].into_iter().for_each(|heading| add(heading, "", &all, &mut out));
        (heading.clone(), out)
    };
    commands.map(section).collect()
}

/// Compares an object, or the list of objects, at a path with the page; `seen` gets the paths that are there.
fn compare(section: &Section, value: &Value, at: &str, seen: &mut BTreeSet<String>, wrong: &mut BTreeSet<String>) {
    match value {
        Value::Array(list) => list.iter().for_each(|value| compare(section, value, &format!("{at}[]"), seen, wrong)),
        Value::Object(members) => {
            let below = if at.is_empty() { String::new() } else { format!("{at}.") };
            missing(section, members, &below, wrong);
            for (name, value) in members {
                let path = format!("{below}{name}");
                seen.insert(path.clone());
                match section.get(&path) {
                    None => _ = wrong.insert(format!("{path} is not on the page")),
                    Some(field) if !field.fits(value) => _ = wrong.insert(format!("{path} is {value}")),
                    Some(field) if field.free => {}
                    Some(_) => compare(section, value, &path, seen, wrong),
                }
            }
        }
        _ => {}
    }
}

/// The fields that must be in an object and are not.
fn missing(section: &Section, members: &Map<String, Value>, below: &str, wrong: &mut BTreeSet<String>) {
    for (path, _) in section.iter().filter(|(_, field)| !field.optional) {
        if let Some(name) = path.strip_prefix(below).filter(|name| !name.contains('.'))
            && !members.contains_key(name)
        {
            wrong.insert(format!("{path} is missing"));
        }
    }
}

/// Everything in which the page and results differ: also fields, optional ones too, that no result has.
fn differences(page: &str, results: &[(&str, Value)]) -> Vec<String> {
    let sections = sections(page);
    let mut all = Vec::new();
    let names: BTreeSet<&str> =
        sections.keys().map(String::as_str).chain(results.iter().map(|(name, _)| *name)).collect();
    for name in names {
        let of_name = || results.iter().filter(|(other, _)| *other == name).map(|(_, value)| value);
        let Some(section) = sections.get(name).filter(|_| of_name().next().is_some()) else {
            all.push(format!("{name}: not both a section and a result"));
            continue;
        };
        let (mut seen, mut wrong) = (BTreeSet::new(), BTreeSet::new());
        for value in of_name() {
            compare(section, value, "", &mut seen, &mut wrong);
            if value["version"] != 2 {
                wrong.insert("the version is not 1".to_owned());
            }
        }
        wrong.extend(section.keys().filter(|path| !seen.contains(*path)).map(|path| format!("{path} is in no result")));
        all.extend(wrong.into_iter().map(|what| format!("{name}: {what}")));
    }
    all
}

/// Results of commands, each with the heading of its section.
#[derive(Default)]
struct Results(Vec<(&'static str, Value)>);

impl Results {
    /// Runs a command that finds something: exit code 0, or 1 if the answer is no.
    fn add(&mut self, folder: &Folder, heading: &'static str, args: &[&str]) {
        let run = folder.run(&[args, &["--json"]].concat());
        assert!(run.code < 2, "{args:?}: {}", run.err);
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
    let mut add = |heading, line: &str| all.line(&folder, heading, line);
    add("build of a plan", "build office.geojson -o o.pvs --certify --stab-trees=64 --method auto");
    add("info of a table", "info o.pvs");
    add("info of a plan", "info office.geojson");
    add("verify", "verify o.pvs office.geojson --rays 100 --pairs 10");
    add("query of a point", "query o.pvs --eye 3,3");
    add("query of a point", "query o.pvs --eye 1e5,3");
    add("query of a view", "query o.pvs --eye 1e5,3 --dir 1,0");
    add("query of a view by all methods", "query o.pvs --eye 3,3 --method all");
    add("walk", "walk o.pvs --random 20");
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
    all.line(&folder, "query of a view by all methods", "query named.pvs --eye 3,3 --method all");
    all.line(&folder, "demo of the office", "demo --out demo");

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
    all.add(
        &folder,
        "query of a view by all methods",
        &["query", "hall.pvs", "--eye", "0.5,2", "--method", "all", "--bounces", "1"],
    );
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
    add("build of a scene", "build least.glb -o least.pvs");
    add("build of a scene", "build triangles.obj -o t.pvs --method auto --certify --stab-trees=16");
    add("build of a scene by regions", "build slanted.obj -o s.pvs --method auto");
    add("build of a scene by regions", "build least.glb -o r.pvs --method shafts --grid 2,1,2");
    add("verify", "verify r.pvs least.glb --rays 100 --pairs 10");
    add("build of a scene by regions", "build triangles.obj -o r.pvs --method shafts --stab-trees=16 --certify");
    add("info of a scene", "info tower.glb");
    add("build of a scene", "build turned.obj -o turned.pvs --gap 1e-5");
    add("info of a scene", "info extras.glb");
    add("build of a scene", "build doors.glb -o doors.pvs");
    add("build of a scene", "build doors.glb -o doors.pvs --time-limit 0");
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
    add("levels", "levels least.glb --table least.pvs -o levels --method none");
    add("walk", "walk least.pvs --path path.json --levels levels");
    let simplify = format!("simplify triangles.obj --volume={VOLUME} -o s.glb --method none");
    add("simplify", &simplify);
    add("simplify", &format!("{simplify} --report"));
    let look = "--size 16x12 --eye 0,0,0 --look-at 0,0,5";
    add("render", &format!("render boards.obj -o r.png --method zbuffer --far 20 {look}"));
    add("render", &format!("render boards.obj -o r.png --compare --cull frustum {look}"));
    add("light", &format!("light boards.obj --light=-1,8,1,1,8,2 -o l.png {look}"));
    let multifocal = format!("multifocal boards.obj --volume={VOLUME} --plane z=20 --texels 8 -o m.png --backend cpu");
    add("multifocal", &multifocal);
    add("multifocal", &format!("{multifocal} --distance d.png"));
    add("demo tower", "demo tower --out demo");
}

fn maps(all: &mut Results) {
    let folder = Folder::with_wad();
    all.line(&folder, "reject", "reject maps.wad -o out.wad");
    all.line(&folder, "info of a WAD", "info out.wad");
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
    add("info of a Quake map", "info map.bsp");
    add("info of a Quake map", "info out.bsp");
    add("info of a portal file", "info map.prt");
    add("build of a portal file", "build map.prt -o p.pvs --method auto --certify --stab-trees=64");
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
    folder.run(&["vis", "map.bsp", "-o", "seen.bsp"]).expect(0);
    let mut add = |heading, line: &str| all.line(&folder, heading, line);
    add("verify", "verify seen.bsp map.bsp --rays 100 --pairs 10");
    add("build of a Quake map", "build map.bsp -o m.pvs --method auto --certify --stab-trees=64");
}

#[test]
fn results_have_a_version_and_the_fields_on_the_page() {
    let mut all = Results::default();
    plans(&mut all);
    scenes(&mut all);
    maps(&mut all);
    let results = all.0;
    let wrong = differences(PAGE, &results);
    assert!(wrong.is_empty(), "{} differences:\n{}", wrong.len(), wrong.join("\n"));
    assert!(results.len() > 60 && sections(PAGE).len() > 30, "{} results", results.len());

    // Impostors. A page without a row: its field is noticed.
    let lines: Vec<&str> = PAGE.lines().collect();
    let is_row = |line: &str| line.starts_with("| `");
    let fields: Vec<usize> = (0..lines.len()).filter(|&k| is_row(lines[k])).collect();
    assert!(fields.len() > 400, "{} rows", fields.len());
    for k in fields.into_iter().step_by(17) {
        let without = [&lines[..k], &lines[k + 1..]].concat().join("\n");
        let found = differences(&without, &results);
        assert!(found.iter().any(|what| what.contains("is not on the page")), "{}: {found:?}", lines[k]);
        // With one more, optional or not.
        for kind in ["integer", "integer, optional"] {
            let more = format!("| `no_such_field` | {kind} | none |");
            let with = [&lines[..k], &[more.as_str()], &lines[k..]].concat().join("\n");
            let found = differences(&with, &results);
            assert!(
                !found.is_empty() && found.iter().all(|what| what.contains("no_such_field is")),
                "{}: {found:?}",
                lines[k]
            );
        }
    }
    // A field of another type; a result without a version, with another, or with one field more deep inside.
    assert!(!differences(&PAGE.replacen("| `seconds` | number |", "| `seconds` | text |", 1), &results).is_empty());
    assert!(!differences(&PAGE.replacen("## `vis`", "## `viz`", 1), &results).is_empty());
    let changed = |change: &dyn Fn(&mut Value)| {
        let mut results = results.clone();
        results.iter_mut().filter(|(name, _)| *name == "render").for_each(|(_, value)| change(value));
        differences(PAGE, &results)
    };
    assert_eq!(changed(&|_| ()), [""; 0]);
    assert!(!changed(&|value| _ = value.as_object_mut().map(|members| members.remove("version"))).is_empty());
    assert!(!changed(&|value| value["version"] = 1.into()).is_empty());
    assert_eq!(changed(&|value| value["pictures"][0]["new"] = 1.into()), ["render: pictures[].new is not on the page"]);
}

/// Every command that has `--json` has a section, and the other way round.
#[test]
fn every_command_with_json_is_on_the_page() {
    fn first(line: &str) -> Option<&str> {
        line.strip_prefix("  ").filter(|l| !l.starts_with(' ')).and_then(|l| l.split(' ').next())
    }
    let folder = Folder::new();
    let help = folder.run(&["--help"]).expect(0).out;
    let list = help.split_once("Commands:").expect("a list of commands").1;
    let of_json = |command: &&str| {
        let args = if *command == "generate" { &["generate", "tower", "--help"][..] } else { &[*command, "--help"] };
        folder.run(args).expect(0).out.contains("--json")
    };
    let listed = list.lines().skip(1).take_while(|line| !line.is_empty()).filter_map(first);
    let commands: BTreeSet<&str> = listed.filter(|command| *command != "help").filter(of_json).collect();
    let sections = sections(PAGE);
    let on_page: BTreeSet<&str> = sections.keys().filter_map(|heading| heading.split(' ').next()).collect();
    assert_eq!(commands, on_page);
    assert!(commands.len() > 14, "{commands:?}");
}

#[test]
fn a_table_is_not_written_as_json() {
    let folder = Folder::with_office();
    for out in ["x.json", "x.JSON"] {
        let error = folder.refused(&["build", "office.geojson", "-o", out]);
        assert!(error.starts_with(&format!("{out}: `build` writes a table, which is not JSON: ")), "{error}");
        let command = format!("sightlines export x.pvs -o {out}");
        assert!(error.ends_with(&command), "{error}");
        assert!(!folder.path(out).exists() && !folder.path("x.pvs").exists());
    }
    // What the error names works.
    folder.run(&["build", "office.geojson", "-o", "x.pvs"]).expect(0);
    folder.run(&["export", "x.pvs", "-o", "x.json"]).expect(0);
    assert!(folder.path("x.json").exists());
}

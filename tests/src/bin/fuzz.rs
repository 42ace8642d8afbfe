//! Fuzzes every reader, and what follows it: damaged files must be read or refused, never panic, and
//! whatever is read must be consistent.
//!
//! Each target begins with small files, breaks them at random, and checks. A failure prints the seed
//! that replays it. Run by `cargo xtask fuzz`.

use dxf_files::Dxf;
use sightlines::bake::from_table::{convex_graph, planar_graph};
use sightlines::bake::quake::portals_of_map;
use sightlines::bake::reject::{RejectOptions, reject_wad};
use sightlines::bake::{PlanBakeOptions, PortalMode, PrtOptions, SceneBakeOptions, bake_plan, bake_prt, bake_scene};
use sightlines::cells::Scene;
use sightlines::formats::doom::{DoomMap, DoomMapSource, ML_TWOSIDED, SourceLine, SourceThing, list_maps};
use sightlines::formats::dxf::parse_dxf;
use sightlines::formats::geojson::{parse_plan, write_plan};
use sightlines::formats::input::{FORMATS, Source, detect};
use sightlines::formats::levels::{LevelFile, LevelsIndex, parse_levels_index, write_levels_index};
use sightlines::formats::points::{NamedPoint, parse_points};
use sightlines::formats::quake::prt::{parse_prt, write_prt};
use sightlines::formats::quake::vis_patch::{parse_vis_patches, write_vis_patches};
use sightlines::formats::quake::{Bsp, BspFormat, graph_of_prt};
use sightlines::formats::scene::{SceneFile, parse_glb, parse_glb_with_source, parse_obj, write_glb};
use sightlines::formats::view_cells::parse_view_cells;
use sightlines::formats::wad::WadKind;
use sightlines::formats::{LumpName, PlanReadOptions, Wad, WadBuilder};
use sightlines::geometry::check_coordinate;
use sightlines::kdtree::{SceneOptions, subdivide_scene};
use sightlines::pvs::{CellId, PlaceBuffer, Table};
use sightlines::relevance::{ReachOptions, Reaches, WhoMoves};
use sightlines::scenes::world::{BspWorldOptions, bsp_world};
use sightlines::scenes::{self, TowerOptions, tower};
use sightlines::stabtree::{Zones, shoot_axial_chords};
use sightlines_capi::fuzz::drive;
use sightlines_packed::{PackOptions, Packed, SizeClass, pack};
use sightlines_testkit::mutate::{SplitMix, mutate};
use sightlines_tests::certificates;
use sightlines_tests::simplified::SmallMesh;
use sightlines_tests::stored;
use sightlines_tests::surfaces::SmallShot;
use sightlines_tests::volumes::SmallWorld;
use sightlines_tests::world_files::bsp_bytes;
use std::panic::catch_unwind;
use std::process::ExitCode;
use std::time::{Duration, Instant};

#[path = "../../../crates/formats/tests/formats/common/dxf.rs"]
mod dxf_files;
#[path = "../../../crates/formats/tests/formats/common/quake.rs"]
mod quake_files;
#[path = "../../../crates/formats/tests/formats/common/udmf.rs"]
mod udmf_files;

/// What is broken and how it is checked; `true` if the broken file was read.
struct Target {
    name: &'static str,
    seeds: fn() -> Vec<Vec<u8>>,
    check: fn(&[u8]) -> bool,
}

const TARGETS: [Target; 27] = [
    Target { name: "wad", seeds: wads, check: check_wad },
    Target { name: "reject", seeds: wads, check: check_reject },
    Target { name: "textmap", seeds: texts, check: check_text },
    Target { name: "geojson", seeds: plans, check: check_geojson },
    Target { name: "dxf", seeds: drawings, check: check_dxf },
    Target { name: "points", seeds: point_files, check: check_points },
    Target { name: "glb", seeds: glbs, check: check_glb },
    Target { name: "obj", seeds: objs, check: check_obj },
    Target { name: "view-cells", seeds: view_cells, check: check_view_cells },
    Target { name: "bake", seeds: plans, check: check_bake },
    Target { name: "scene", seeds: buildings, check: check_building },
    Target { name: "volumes", seeds: small_worlds, check: check_volumes },
    Target { name: "levels-index", seeds: levels_indexes, check: check_levels_index },
    Target { name: "simplify", seeds: small_worlds, check: check_simplified },
    Target { name: "surfaces", seeds: small_worlds, check: check_surfaces },
    Target { name: "pvs", seeds: tables, check: check_pvs },
    Target { name: "packed", seeds: packed_tables, check: check_packed },
    Target { name: "reaches", seeds: reaches, check: check_reaches },
    Target { name: "prt", seeds: prts, check: check_prt },
    Target { name: "bsp", seeds: maps, check: check_map },
    Target { name: "portals", seeds: map_worlds, check: check_made_portals },
    Target { name: "journal", seeds: stored::journals, check: stored::check_journal },
    Target { name: "part", seeds: stored::parts, check: stored::check_part },
    Target { name: "manifest", seeds: stored::manifests, check: stored::check_manifest },
    Target { name: "certificates", seeds: certificates::seeds, check: certificates::check },
    Target { name: "capi", seeds: calls, check: check_calls },
    Target { name: "garbage", seeds: garbage, check: check_anything },
];

/// Bytes that stand for sequences of calls across the border to C.
fn calls() -> Vec<Vec<u8>> {
    let mut random = SplitMix::new(11);
    (0..8).map(|_| (0..3000).map(|_| random.next() as u8).collect()).collect()
}

/// What C may call in any order is a status or an answer; some of it is an answer.
fn check_calls(bytes: &[u8]) -> bool {
    drive(bytes) > 0
}

/// Bytes that stand for small worlds of triangles.
fn small_worlds() -> Vec<Vec<u8>> {
    let mut random = SplitMix::new(7);
    (0..8).map(|_| (0..140).map(|_| random.next() as u8).collect()).collect()
}

fn check_volumes(bytes: &[u8]) -> bool {
    let Some(world) = SmallWorld::from_bytes(bytes) else { return false };
    world.check_backends();
    world.check_hidden(4000);
    true
}

fn check_surfaces(bytes: &[u8]) -> bool {
    SmallShot::from_bytes(bytes).is_some_and(|shot| {
        shot.check();
        true
    })
}

fn check_simplified(bytes: &[u8]) -> bool {
    SmallMesh::from_bytes(bytes).is_some_and(|mesh| {
        mesh.check();
        true
    })
}

fn source(hexen: bool) -> DoomMapSource {
    let line = |v1, v2, right, left: Option<u16>| {
        let flags = if left.is_some() { ML_TWOSIDED } else { 1 };
        SourceLine { v1, v2, flags, right: Some(right), left }
    };
    DoomMapSource {
        vertices: vec![[0, 0], [64, 0], [128, 0], [128, 64], [64, 64], [0, 64]],
        lines: vec![
            line(1, 0, 0, None),
            line(0, 5, 0, None),
            line(5, 4, 0, None),
            line(4, 3, 1, None),
            line(3, 2, 1, None),
            line(2, 1, 1, None),
            line(1, 4, 1, Some(0)),
        ],
        n_sectors: 2,
        things: vec![SourceThing { x: 32, y: 32, kind: 1 }],
        reject: Some(vec![0]),
        hexen,
    }
}

fn wads() -> Vec<Vec<u8>> {
    let wad = |hexen| {
        let mut builder = WadBuilder::new(WadKind::Patch);
        let map = LumpName::new("MAP01").expect("a lump name");
        source(hexen).add_to(&mut builder, map).expect("a sound map");
        builder.finish().expect("a small file")
    };
    vec![wad(false), wad(true)]
}

fn plans() -> Vec<Vec<u8>> {
    let small = scenes::maze(1, 3, 2).into_iter().chain(scenes::doom_like(1, 1));
    let families = scenes::degenerate::all().into_iter().map(|(_, plan)| plan);
    small.chain(families).map(|plan| write_plan(&plan).into_bytes()).collect()
}

/// A drawing with every entity that is read, and one with lines only, in which more of the damage is survived.
fn drawings() -> Vec<Vec<u8>> {
    let lines = scenes::maze(1, 3, 2).into_iter().flat_map(|plan| plan.lines().to_vec());
    let lines = lines.fold(Dxf::new(), |dxf, line| dxf.line("Walls", line.a.to_array(), line.b.to_array()));
    vec![dxf_files::small_drawing(), lines.model(&Dxf::new())]
}

/// Points as CSV in two forms, and as GeoJSON.
fn point_files() -> Vec<Vec<u8>> {
    let plain = "1.5,2,door\n# none\n-3e1,0.25\n7,8,\"a, \"\"b\"\"\"\n";
    let named = "name;Y;x;floor\nK\u{fc}che;2;1;0\n;4.5;-3;1\n";
    let json = r#"{"type":"Feature","id":3,"geometry":{"type":"MultiPoint","coordinates":[[1,2],[3.5,-4]]}}"#;
    [plain, named, json].map(|text| text.as_bytes().to_vec()).to_vec()
}

/// A triangle in glTF as text, through all that a document may hold: nested nodes, a buffer inside the text,
/// sparse positions, indices.
const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"a","children":[1],"matrix":[2,0,0,0,0,2,0,0,0,0,2,0,5,6,7,1]},
{"mesh":0,"translation":[1,2,3],"rotation":[0,0.5,0,0.5],"scale":[1,-1,1]}],
"meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],
"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"sparse":{"count":1,
"indices":{"bufferView":1,"componentType":5121},"values":{"bufferView":0,"byteOffset":24}}},
{"bufferView":1,"byteOffset":1,"componentType":5121,"type":"SCALAR","count":3}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":4}],
"buffers":[{"byteLength":40,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAgABAg=="}]}"#;

/// Two objects, a face with a notch, and everything else that lines can be.
const OBJ: &str = "v 0 0 0\nv 4 1 0 1\nv 0 4 0 0 0 1\nv 1 1 0\no a\nf 1 2 3 4\nusemtl x\nf 1/1 2//1 3/1/1\n\
    o b # c\nv 1 2 3\nf -1 -2 \\\n-3\nl 1 2\n";

fn glbs() -> Vec<Vec<u8>> {
    let scene = parse_obj(OBJ.as_bytes()).expect("a sound scene").scene;
    assert!(parse_glb(GLTF.as_bytes(), None).is_ok());
    vec![write_glb(&scene).expect("small whole numbers"), GLTF.into()]
}

fn objs() -> Vec<Vec<u8>> {
    vec![OBJ.into()]
}

/// Two view cells, one of them flat, with members that mean nothing.
fn view_cells() -> Vec<Vec<u8>> {
    let small = r#"{"up":"y","cells":[{"id":"a","min":[0.5,-2e0,-0.0],"max":[6.25,2.5,12],"fill":1.0},
{"max":[1,2,3],"min":[-15,2,0],"note":{"id":7,"min":[]},"id":"K\u00fcche"}]}"#;
    assert!(parse_view_cells(small.as_bytes()).is_ok());
    vec![small.into()]
}

/// Two levels for three cells, one of which has none.
fn levels_indexes() -> Vec<Vec<u8>> {
    let level = |k: u64| LevelFile {
        file: format!("level_{k}.glb"),
        n_triangles: 10 * k,
        n_bytes: 280 * k,
        bound: 5e-4,
        occluder: k == 1,
    };
    let levels = vec![level(0), level(1)];
    let index = LevelsIndex { n_triangles: 99, budget: 1e-3, levels, cells: vec![Some(1), None, Some(0)] };
    vec![write_levels_index(&index).into_bytes()]
}

fn check_levels_index(bytes: &[u8]) -> bool {
    parse_levels_index(bytes).is_ok_and(|index| {
        assert!(index.cells.iter().flatten().all(|&level| (level as usize) < index.levels.len()));
        let again = parse_levels_index(write_levels_index(&index).as_bytes()).expect("what was written is read");
        assert_eq!(again, index);
        true
    })
}

/// A scene as OBJ text, in which a broken digit moves a wall.
fn obj_of(scene: &Scene) -> Vec<u8> {
    let mut text = String::new();
    let mut n = 0;
    for object in scene.objects() {
        text.push_str(&format!("o {}\n", object.name));
        for corners in object.corners() {
            corners.iter().for_each(|[x, y, z]| text.push_str(&format!("v {x} {y} {z}\n")));
            text.push_str(&format!("f {} {} {}\n", n + 1, n + 2, n + 3));
            n += 3;
        }
    }
    text.into_bytes()
}

fn buildings() -> Vec<Vec<u8>> {
    let options = TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, furniture: 0, ..TowerOptions::default() };
    let house = tower(options).expect("valid options");
    let room = "o room\nv 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 0\nv 0 0 9\nv 4 0 9\nv 4 3 9\nv 0 3 9\n\
        f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 4 3 7 8\nf 1 4 8 5\nf 2 3 7 6\n\
        o wall\nv 0 0 4\nv 3 0 4\nv 3 3 4\nv 0 3 4\nf 9 10 11 12\n\
        o bar\nv 1 0 6\nv 4 0 6\nv 4 2 6\nv 1 2 6\nf 13 14 15 16\n";
    vec![obj_of(&house), room.into()]
}

fn tables() -> Vec<Vec<u8>> {
    let bake = |plan| bake_plan(&plan, &PlanBakeOptions::default()).map(|b| b.table.to_bytes());
    scenes::maze(1, 3, 2).into_iter().chain(scenes::doom_like(1, 1)).flat_map(bake).collect()
}

fn packed_tables() -> Vec<Vec<u8>> {
    let table = |bytes: Vec<u8>| Table::from_bytes(&bytes).expect("a table");
    let pack = |table: &Table, class| {
        pack(table, &PackOptions { max_bytes: None, class: Some(class) }).expect("a small table")
    };
    let both = |table: Table| [SizeClass::Small, SizeClass::Large].map(|class| pack(&table, class));
    tables().into_iter().map(table).flat_map(both).collect()
}

/// A small table, of which the reaches are.
fn table_of_reaches() -> Table {
    Table::from_bytes(&tables()[0]).expect("a table")
}

fn reaches() -> Vec<Vec<u8>> {
    let table = table_of_reaches();
    let of = |movers| Reaches::of(&table, &ReachOptions { movers, ..ReachOptions::default() }).expect("reaches");
    [WhoMoves::Both, WhoMoves::One].map(|movers| of(movers).to_bytes()).into()
}

/// Reaches, also with a right checksum, are refused, or tell who sees whom as the table does and come back as they are.
fn check_reaches(bytes: &[u8]) -> bool {
    let table = table_of_reaches();
    let mut patched = bytes.to_vec();
    if let Some(end) = patched.len().checked_sub(4) {
        let crc = crc32fast::hash(&patched[..end]);
        patched[end..].copy_from_slice(&crc.to_le_bytes());
    }
    let ids = || (0..table.n_cells() as u32).map(CellId);
    [bytes, &patched].into_iter().any(|bytes| {
        let Ok(reaches) = Reaches::from_bytes(bytes, &table) else { return false };
        assert!(ids().all(|a| ids().all(|b| (reaches.rung(a, b) == 0) == table.sees(a, b))));
        assert_eq!(Reaches::from_bytes(&reaches.to_bytes(), &table), Ok(reaches));
        true
    })
}

fn prts() -> Vec<Vec<u8>> {
    quake_files::SMALL_PRTS.iter().map(|text| text.as_bytes().to_vec()).collect()
}

fn garbage() -> Vec<Vec<u8>> {
    vec![vec![], b"PWAD".to_vec(), b"{\"type\":".to_vec(), (0..=255).collect()]
}

/// TEXTMAP lumps of small maps.
fn texts() -> Vec<Vec<u8>> {
    let text = |bytes| {
        let wad = Wad::parse(udmf_files::as_text(&Wad::parse(bytes).expect("a sound WAD"))).expect("a sound WAD");
        wad.lump_bytes(1).to_vec()
    };
    wads().into_iter().map(text).collect()
}

/// A damaged text is refused, or its map has a REJECT lump that stays what it is; every other lump is as it was.
fn check_text(bytes: &[u8]) -> bool {
    let file = udmf_files::wad_of_text(bytes, &[("ZNODES", b"XGLN")]);
    let wad = Wad::parse(file.clone()).expect("a sound WAD around the text");
    let Ok(map) = DoomMap::parse(&wad, &list_maps(&wad)[0]) else { return false };
    let plan = map.plan().expect("a checked map has a plan");
    assert_eq!(plan.lines().len() + map.n_lines_without_length(), map.lines().len());
    check_reject(&file)
}

fn check_wad(bytes: &[u8]) -> bool {
    let Ok(wad) = Wad::parse(bytes.to_vec()) else { return false };
    assert_eq!(wad.with_rejects(&[]).expect("nothing changes"), bytes);
    list_maps(&wad).iter().filter(|m| DoomMap::parse(&wad, m).is_ok()).count() > 0
}

fn check_reject(bytes: &[u8]) -> bool {
    let Ok(wad) = Wad::parse(bytes.to_vec()) else { return false };
    let options = RejectOptions { force: true, threads: 1, ..RejectOptions::default() };
    let Ok(outcome) = reject_wad(&wad, &options) else { return false };
    let again = Wad::parse(outcome.bytes.clone()).expect("what was written is read");
    let second = reject_wad(&again, &options).expect("a written file is done again");
    assert_eq!(second.bytes, outcome.bytes, "the second time changes nothing");
    true
}

fn check_geojson(bytes: &[u8]) -> bool {
    let Ok(plan) = parse_plan(bytes) else { return false };
    assert_eq!(parse_plan(write_plan(&plan).as_bytes()).expect("what was written is read"), plan);
    true
}

/// What is read of a drawing is a plan that GeoJSON keeps, with curves as coarse as they are by themselves, and with finer ones.
fn check_dxf(bytes: &[u8]) -> bool {
    let Ok(file) = parse_dxf(bytes, &PlanReadOptions::default()) else { return false };
    assert_eq!(parse_plan(write_plan(&file.plan).as_bytes()).expect("what was written is read"), file.plan);
    let all = PlanReadOptions { layers: Some(file.layers), deviation: Some(1e-3) };
    if let Ok(all) = parse_dxf(bytes, &all) {
        assert!(all.plan.points().all(|p| check_coordinate(p.x).is_ok() && check_coordinate(p.y).is_ok()));
    }
    true
}

/// Points are read or refused with their place; those that are read are in range.
fn check_points(bytes: &[u8]) -> bool {
    match parse_points(bytes) {
        Ok(points) => {
            let is_sound = |p: &NamedPoint| [p.point.x, p.point.y].into_iter().all(|x| check_coordinate(x).is_ok());
            assert!(!points.is_empty() && points.iter().all(is_sound));
            true
        }
        Err(error) => {
            assert!(error.place.starts_with("line ") || bytes.is_empty(), "{error}");
            false
        }
    }
}

fn check_scene(file: &SceneFile) -> bool {
    assert_eq!(file.info.n_triangles, file.scene.n_triangles());
    if let Ok(bytes) = write_glb(&file.scene) {
        let again = parse_glb(&bytes, None).expect("what was written is read");
        assert_eq!((again.info.n_objects, again.info.n_triangles), (file.info.n_objects, file.info.n_triangles));
    }
    true
}

fn check_glb(bytes: &[u8]) -> bool {
    let Ok((file, source)) = parse_glb_with_source(bytes.to_vec(), None) else { return false };
    // Every other triangle goes; what cannot be kept is refused.
    let half = |triangles: &Vec<[u32; 3]>| triangles.iter().step_by(2).copied().collect::<Vec<_>>();
    let left: Vec<_> = file.scene.objects().iter().map(|o| Some(half(&o.triangles))).collect();
    if let Ok(bytes) = source.rewrite(&left, None)
        && let Ok(again) = parse_glb(&bytes, None)
    {
        let n: usize = left.iter().flatten().map(Vec::len).sum();
        assert_eq!(again.info.n_triangles, n);
    }
    check_scene(&file)
}

fn check_obj(bytes: &[u8]) -> bool {
    parse_obj(bytes).is_ok_and(|file| check_scene(&file))
}

fn check_view_cells(bytes: &[u8]) -> bool {
    let found = match parse_view_cells(bytes) {
        Ok(found) => found,
        Err(error) => {
            assert!(error.place.starts_with("line ") || bytes.is_empty(), "{error}");
            return false;
        }
    };
    assert!(!found.cells.is_empty());
    let mut ids: Vec<&str> = found.cells.iter().map(|cell| cell.id.as_str()).collect();
    ids.sort_unstable();
    ids.dedup();
    assert!(ids.len() == found.cells.len() && !ids[0].is_empty());
    for cell in &found.cells {
        let corners = cell.bounds.min.into_iter().chain(cell.bounds.max);
        assert!(!cell.bounds.is_empty() && corners.into_iter().all(|x| check_coordinate(x).is_ok()));
    }
    true
}

fn check_bake(bytes: &[u8]) -> bool {
    let Ok(plan) = parse_plan(bytes) else { return false };
    let Ok(baked) = bake_plan(&plan, &PlanBakeOptions { threads: 1, ..PlanBakeOptions::default() }) else {
        return false;
    };
    let graph = planar_graph(&baked.table).expect("a baked table has its graph");
    graph.assert_well_formed();
    let decoded = Table::from_bytes(&baked.table.to_bytes()).expect("what was written is read");
    assert_eq!(decoded, baked.table);
    true
}

fn check_building(bytes: &[u8]) -> bool {
    let Ok(file) = parse_obj(bytes) else { return false };
    let cut = SceneOptions { detail_below: Some(0.0), max_cells: 300, ..SceneOptions::default() };
    let bake = |portals| {
        let options = SceneBakeOptions { cut, portals, threads: 1, ..SceneBakeOptions::default() };
        bake_scene(&file.scene, &options).map(|baked| baked.table)
    };
    let Ok(exact) = bake(PortalMode::Exact) else { return false };
    let wide = bake(PortalMode::Bounding).expect("the same cells");
    let graph = subdivide_scene(&file.scene, &cut).expect("it was cut before").graph;
    let chords = shoot_axial_chords(&graph, &Zones::cells(&graph), 4);
    for row in 0..exact.n_cells() {
        let cell = CellId(row as u32);
        assert!(chords.iter_ones(row).all(|col| exact.sees(cell, CellId(col as u32))), "a chord is hidden");
        assert!(exact.visible(cell).all(|other| wide.sees(cell, other)), "less is seen through larger portals");
        let objects = wide.visible_objects(cell);
        assert!(exact.visible_objects(cell).iter().all(|o| objects.binary_search(o).is_ok()));
    }
    assert_eq!(Table::from_bytes(&exact.to_bytes()).expect("what was written is read"), exact);
    true
}

fn check_pvs(bytes: &[u8]) -> bool {
    let Ok(table) = Table::from_bytes(bytes) else { return false };
    assert_eq!(table.to_bytes(), bytes);
    if let Some(graph) = planar_graph(&table) {
        graph.assert_well_formed();
    }
    true
}

/// A packed table answers or refuses, as it is and with right checksums; one that passes all checks is packed again.
fn check_packed(bytes: &[u8]) -> bool {
    let mut patched = bytes.to_vec();
    fix_checksums(&mut patched);
    [bytes.to_vec(), patched].into_iter().any(|bytes| {
        let Ok(packed) = Packed::open(bytes, 1 << 12) else { return false };
        let (mut cells, mut numbers) = (Vec::new(), Vec::new());
        for cell in (0..packed.n_cells().min(50) as u32).map(CellId) {
            let is_small = packed.size_class() == SizeClass::Small;
            let (min, _) = packed.cell_box(cell).unwrap_or_else(|_| {
                assert!(!is_small, "boxes are resident");
                Default::default()
            });
            assert!(packed.cells_at(min, &mut PlaceBuffer::new()).is_ok() || !is_small, "places are resident");
            packed.coarse(cell, &mut cells).expect("and the coarse table");
            let _ = packed.exits(cell, &mut |_, _, to, _| assert!(to.idx() < packed.n_cells()));
            let _ = packed.objects_seen(cell, &mut numbers);
            if packed.visible(cell, &mut cells).is_ok() {
                assert!(cells.iter().all(|cell| cell.idx() < packed.n_cells()));
            }
        }
        assert!(packed.bytes_in_use() <= 1 << 12);
        if packed.verify().is_err() {
            return false;
        }
        let table = packed.to_table().expect("it was verified");
        for class in [SizeClass::Small, SizeClass::Large] {
            let again = pack(&table, &PackOptions { max_bytes: None, class: Some(class) }).expect("a small table");
            assert_eq!(Packed::open(again, 0).and_then(|packed| packed.to_table()).expect("it was packed"), table);
        }
        true
    })
}

/// Makes the checksums of sections and header right again, as far as they can be found.
fn fix_checksums(bytes: &mut [u8]) {
    let number = |bytes: &[u8], at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?) as usize);
    if bytes.ends_with(&sightlines_packed::format::END) {
        return fix_checksums_of_large(bytes);
    }
    let n = number(bytes, 12).unwrap_or(0).min(bytes.len() / 24);
    for at in (0..n).map(|i| 24 + 24 * i) {
        let place = number(bytes, at + 8).zip(number(bytes, at + 16));
        let Some(section) = place.and_then(|(begin, n)| bytes.get(begin..begin.checked_add(n)?)) else { continue };
        let crc = crc32fast::hash(section);
        if let Some(field) = bytes.get_mut(at + 20..at + 24) {
            field.copy_from_slice(&crc.to_le_bytes());
        }
    }
    let end = 24 + 24 * n;
    if end + 4 <= bytes.len() {
        let crc = crc32fast::hash(&bytes[..end]);
        bytes[end..end + 4].copy_from_slice(&crc.to_le_bytes());
    }
}

/// The same for a large packed table, whose section table is near its end.
fn fix_checksums_of_large(bytes: &mut [u8]) {
    let number = |bytes: &[u8], at: usize| Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk()?) as usize);
    let Some(tail) = bytes.len().checked_sub(32) else { return };
    let n = number(bytes, tail + 16).unwrap_or(0);
    let Some(table) = n.checked_mul(24).and_then(|n| tail.checked_sub(n)).filter(|&table| table >= 24) else { return };
    for at in (table..tail).step_by(24) {
        let place = number(bytes, at + 8).zip(number(bytes, at + 16));
        let Some(section) = place.and_then(|(begin, n)| bytes.get(begin..begin.checked_add(n)?)) else { continue };
        let crc = crc32fast::hash(section);
        bytes[at + 20..at + 24].copy_from_slice(&crc.to_le_bytes());
    }
    let sealed = [&bytes[..24], &bytes[table..tail + 20]].concat();
    bytes[tail + 20..tail + 24].copy_from_slice(&crc32fast::hash(&sealed).to_le_bytes());
}

/// Portals are read or refused, and what is read is seen through: the table is written and read again.
fn check_prt(bytes: &[u8]) -> bool {
    if !quake_files::check_prt(bytes) {
        return false;
    }
    let prt = parse_prt(bytes).expect("it was read before");
    // A digit more is a table of a gigabyte.
    if prt.n_clusters() > 100 {
        return true;
    }
    let Ok(baked) = bake_prt(&prt, PrtOptions::default()) else { return true };
    // Portals far from flat may not come back.
    if let Some(graph) = convex_graph(&baked.table) {
        assert_eq!(graph.cells(), graph_of_prt(&prt).cells());
    }
    assert_eq!(Table::from_bytes(&baked.table.to_bytes()).expect("what was written is read"), baked.table);
    true
}

fn maps() -> Vec<Vec<u8>> {
    [quake_files::small_bsps(), quake_files::small_worlds()].concat()
}

fn check_map(bytes: &[u8]) -> bool {
    quake_files::check_bsp(bytes) | quake_files::check_world(bytes)
}

/// Maps with trees and faces, of each format.
fn map_worlds() -> Vec<Vec<u8>> {
    let worlds =
        (0..2).map(|seed| bsp_world(BspWorldOptions { seed, ..BspWorldOptions::default() }).expect("a small world"));
    let files = worlds.flat_map(|world| BspFormat::ALL.map(|format| bsp_bytes(&world, format)));
    quake_files::small_worlds().into_iter().chain(files).collect()
}

fn check_made_portals(bytes: &[u8]) -> bool {
    let Ok(bsp) = Bsp::parse(bytes.to_vec()) else { return false };
    let Ok(made) = portals_of_map(&bsp) else { return false };
    let again = parse_prt(write_prt(&made.prt).as_bytes()).expect("what was made is read");
    assert_eq!(again, made.prt);
    true
}

fn check_anything(bytes: &[u8]) -> bool {
    let text = check_prt(bytes) | check_map(bytes);
    text | certificates::check(bytes)
        | check_reject(bytes)
        | check_text(bytes)
        | check_bake(bytes)
        | check_pvs(bytes)
        | check_packed(bytes)
        | check_glb(bytes)
        | check_obj(bytes)
        | check_view_cells(bytes)
        | check_registry(bytes)
        | check_vis_patches(bytes)
}

/// What is read of visibility without its map is written as it was.
fn check_vis_patches(bytes: &[u8]) -> bool {
    let Ok(patches) = parse_vis_patches(bytes) else { return false };
    let written = write_vis_patches(&patches).expect("no more than was read");
    assert_eq!(parse_vis_patches(&written), Ok(patches));
    true
}

/// Whether any format of the registry reads the bytes; whatever it is taken for, what is recognised has to be among the formats.
fn check_registry(bytes: &[u8]) -> bool {
    let mut is_read = false;
    for format in &FORMATS {
        let name = format!("some.{}", format.extensions[0]);
        let source = Source::Memory { name: name.as_ref(), bytes, beside: None };
        assert!(detect(name.as_ref(), bytes).is_some(), "{name} has an ending that is known");
        is_read |= source.read_as(format).is_ok() | source.read().is_ok();
    }
    is_read
}

struct Settings {
    target: Option<String>,
    seconds: u64,
    seed: u64,
    list: bool,
}

fn settings() -> Result<Settings, String> {
    let mut settings = Settings { target: None, seconds: 10, seed: 0, list: false };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or_else(|| format!("{word} wants a value"));
        let number = |text: String| text.parse::<u64>().map_err(|e| format!("{text}: {e}"));
        match word.as_str() {
            "--target" => settings.target = Some(value()?),
            "--seconds" => settings.seconds = number(value()?)?,
            "--seed" => settings.seed = number(value()?)?,
            "--list" => settings.list = true,
            _ => return Err(format!("{word} is no option")),
        }
    }
    Ok(settings)
}

/// Breaks and checks for some seconds, at least one file; the seed of the first failure if there is one.
fn fuzz(target: &Target, settings: &Settings) -> Result<(u64, u64), u64> {
    let seeds = (target.seeds)();
    assert!(!seeds.is_empty(), "{} has nothing to break", target.name);
    let start = Instant::now();
    let (mut n_files, mut n_read) = (0, 0);
    loop {
        let number = settings.seed + n_files;
        let mut random = SplitMix::new(number);
        let broken = mutate(&seeds[random.below(seeds.len())], &mut random);
        match catch_unwind(|| (target.check)(&broken)) {
            Ok(read) => n_read += u64::from(read),
            Err(_) => return Err(number),
        }
        n_files += 1;
        if start.elapsed() >= Duration::from_secs(settings.seconds) {
            return Ok((n_files, n_read));
        }
    }
}

fn main() -> ExitCode {
    let settings = match settings() {
        Ok(settings) => settings,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(2);
        }
    };
    if settings.list {
        TARGETS.iter().for_each(|t| println!("{}", t.name));
        return ExitCode::SUCCESS;
    }
    let chosen: Vec<&Target> =
        TARGETS.iter().filter(|t| settings.target.as_deref().is_none_or(|name| name == t.name)).collect();
    if chosen.is_empty() {
        eprintln!("error: no such target; --list names them");
        return ExitCode::from(2);
    }
    for target in chosen {
        match fuzz(target, &settings) {
            Ok((n_files, n_read)) => println!("{}: {n_files} files, {n_read} read, no failure", target.name),
            Err(seed) => {
                eprintln!("{} failed: replay with --target {} --seed {seed} --seconds 0", target.name, target.name);
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_of_targets_is_complete() {
        let listed: Vec<&str> = include_str!("../../fuzz-targets.txt").lines().collect();
        assert_eq!(listed, TARGETS.each_ref().map(|target| target.name));
    }
}

//! From the bytes of a file and its name to a table.

use sightlines_bake::{BakeRequest, Bakeable, BakeableError, bake};
use sightlines_formats::doom::{DoomMapSource, MapChoiceError, SourceLine};
use sightlines_formats::input::Neighbours;
use sightlines_formats::scene::{Simplification, write_glb, write_simplified_glb};
use sightlines_formats::wad::{WadBuilder, WadKind};
use sightlines_formats::{LumpName, Source, geojson};
use sightlines_scenes::{OfficeOptions, TowerOptions, office, tower};
use std::io;
use std::path::Path;

fn read(name: &str, bytes: &[u8], map: Option<&str>) -> Result<Bakeable, BakeableError> {
    Bakeable::read(&Source::Memory { name: Path::new(name), bytes, beside: None }, map)
}

fn table(bakeable: &Bakeable) -> Vec<u8> {
    bake(bakeable, &BakeRequest::default()).expect("it can be baked").table.to_bytes()
}

#[test]
fn plans_and_scenes_are_those_of_the_file() {
    let plan = office(OfficeOptions { rooms_x: 3, rooms_y: 2, ..OfficeOptions::default() }).unwrap();
    let read_plan = read("plan.geojson", geojson::write_plan(&plan).as_bytes(), None).unwrap();
    assert_eq!(table(&read_plan), bake(&plan, &BakeRequest::default()).unwrap().table.to_bytes());

    let scene = tower(TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, ..TowerOptions::default() }).unwrap();
    let read_scene = read("tower.glb", &write_glb(&scene).unwrap(), None).unwrap();
    let Bakeable::Scene(file) = &read_scene else { panic!("{read_scene:?}") };
    assert_eq!(table(&read_scene), bake(file, &BakeRequest::default()).unwrap().table.to_bytes());
}

/// A scene whose triangles were moved hides what can be seen.
#[test]
fn moved_scenes_are_refused() {
    let scene = tower(TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, ..TowerOptions::default() }).unwrap();
    let glb = |occluder| write_simplified_glb(&scene, Simplification { occluder }).unwrap();
    assert!(read("inside.glb", &glb(true), None).is_ok());
    assert!(matches!(read("moved.glb", &glb(false), None), Err(BakeableError::Moved)));
}

#[test]
fn maps_of_wads_are_chosen_by_name() {
    let wall = |v1, v2| SourceLine { v1, v2, flags: 1, right: Some(0), left: None };
    let room = DoomMapSource {
        vertices: vec![[0, 0], [0, 64], [64, 64], [64, 0]],
        lines: vec![wall(0, 1), wall(1, 2), wall(2, 3), wall(3, 0)],
        n_sectors: 1,
        things: Vec::new(),
        reject: None,
        hexen: false,
    };
    let wad = |names: &[&str]| {
        let mut builder = WadBuilder::new(WadKind::Patch);
        names.iter().for_each(|name| room.add_to(&mut builder, LumpName::new(name).unwrap()).unwrap());
        builder.finish().unwrap()
    };
    let name_of = |bakeable: Result<Bakeable, BakeableError>| match bakeable {
        Ok(Bakeable::Plan { map, .. }) => map.map(|name| name.to_string()),
        other => panic!("{other:?}"),
    };
    let (one, two) = (wad(&["MAP07"]), wad(&["MAP01", "MAP02"]));
    assert_eq!(name_of(read("one.wad", &one, None)).as_deref(), Some("MAP07"));
    assert_eq!(name_of(read("two.wad", &two, Some("map02"))).as_deref(), Some("MAP02"));
    let choice = |map| match read("two.wad", &two, map) {
        Err(BakeableError::Choice(error)) => error,
        other => panic!("{other:?}"),
    };
    assert_eq!(choice(None).to_string(), "there are 2 maps, and none was named: MAP01, MAP02");
    assert_eq!(choice(Some("E1M1")).to_string(), "there is no map E1M1; there are MAP01, MAP02");
    let none = read("none.wad", &wad(&[]), None);
    assert!(matches!(none, Err(BakeableError::Choice(MapChoiceError::NoMaps))), "{none:?}");
}

/// A file that lies beside every map.
#[derive(Debug)]
struct Beside(&'static str);

impl Neighbours for Beside {
    fn read(&self, path: &Path) -> io::Result<Option<Vec<u8>>> {
        if path == Path::new(self.0) { Ok(Some(PORTALS.to_vec())) } else { Err(io::ErrorKind::NotFound.into()) }
    }
}

/// Three rooms in a row.
const PORTALS: &[u8] =
    b"PRT1\n3\n2\n4 0 1 (8 0 0) (8 2 0) (8 2 2) (8 0 2)\n4 1 2 (16 0 0) (16 2 0) (16 2 2) (16 0 2)\n";

#[test]
fn portals_are_read_from_beside_a_map() {
    let beside = Beside("e1m1.prt");
    let portals = |name: &str, beside: Option<&dyn Neighbours>| {
        Source::Memory { name: Path::new(name), bytes: b"", beside }
            .portals()
            .map(|prt| prt.map(|prt| prt.n_clusters()))
    };
    assert_eq!(portals("maps/e1m1.bsp", Some(&beside)).unwrap(), Some(3));
    assert_eq!(portals("e1m2.bsp", Some(&beside)).unwrap(), None);
    assert_eq!(portals("e1m1.bsp", None).unwrap(), None);
    assert_eq!(table(&read("rooms.prt", PORTALS, None).unwrap()).get(1..4), Some(&b"PVS"[..]));
}

#[test]
fn what_is_not_baked_is_refused() {
    let noise = read("noise", b"noise", None);
    assert!(matches!(noise, Err(BakeableError::Kind)), "{noise:?}");
    let cells = br#"{"cells":[{"id":"a","min":[0,0,0],"max":[1,1,1]}]}"#;
    assert!(matches!(read("cells.json", cells, None), Err(BakeableError::Kind)));
    assert!(matches!(read("cut.wad", b"PWAD", None), Err(BakeableError::Read(_))));
}

//! Doors of tables, and where objects are in their file: true ones have no violation, and each that was changed is found.

use crate::tables::common::{self, Real, changed, check, quick};
use sightlines_bake::{SceneBakeOptions, bake_scene};
use sightlines_cells::{Scene, SceneObject};
use sightlines_frame::Moved;
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_pvs::{DoorBox, DoorRecord, Frame, ObjectId, ObjectSource, PortalId, PortalRecord, Table, TableParts};
use sightlines_verify::VerifyOptions;

/// How often each kind of damage is done.
const TRIES: usize = 25;
/// The objects that are doors.
const DOORS: [u32; 4] = [7, 8, 9, 10];

/// A box; from the inside if `is_room`.
fn cuboid(name: &str, min: Point3, max: Point3, is_room: bool) -> SceneObject {
    let corner = |k: usize| std::array::from_fn(|axis| if k >> axis & 1 == 1 { max[axis] } else { min[axis] });
    let sides = (0..3).flat_map(|axis| {
        let [a, b, c]: [u32; 3] = std::array::from_fn(|k| 1 << ((axis + k) % 3));
        [[0, c, b], [b, c, b | c], [a, a | b, a | c], [a | b, a | b | c, a | c]]
    });
    let turned = sides.map(|[p, q, r]| if is_room { [p, r, q] } else { [p, q, r] });
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles: turned.collect() }
}

/// Three rooms in a row. In the first wall is a door of one leaf, in the second a door with two wings, each of which fills a half of its
/// own, and a hatch that leaves a crack.
fn rooms() -> Scene {
    let solid = |name: &str, min, max| cuboid(name, min, max, false);
    let objects = vec![
        cuboid("hull", [0.0; 3], [13.0, 4.0, 3.0], true),
        solid("left", [4.0, 0.0, 0.0], [5.0, 1.0, 3.0]),
        solid("right", [4.0, 2.0, 0.0], [5.0, 4.0, 3.0]),
        solid("lintel", [4.0, 1.0, 2.0], [5.0, 2.0, 3.0]),
        solid("left", [8.0, 0.0, 0.0], [9.0, 1.0, 3.0]),
        solid("post", [8.0, 1.75, 0.0], [9.0, 2.25, 3.0]),
        solid("right", [8.0, 3.0, 0.0], [9.0, 4.0, 3.0]),
        solid("front", [4.25, 1.0, 0.0], [4.5, 2.0, 2.0]),
        solid("wing", [8.25, 1.0, 0.0], [8.5, 1.75, 3.0]),
        solid("wing", [8.25, 2.25, 0.0], [8.5, 3.0, 3.0]),
        solid("hatch", [1.0, 0.0, 0.0], [1.25, 4.0, 2.5]),
    ];
    let source = |k: u32| (k != 3).then_some(ObjectSource { node: 2 * k, primitive: k % 2 });
    let sources = (0..objects.len() as u32).map(source).collect();
    let scene = Scene::new(objects).and_then(|scene| scene.with_see_through(DOORS.to_vec()));
    let scene = scene.and_then(|scene| scene.with_doors(DOORS.to_vec()));
    scene.and_then(|scene| scene.with_sources(sources)).expect("a good scene")
}

fn table_of(scene: &Scene) -> Table {
    let mut options = SceneBakeOptions::default();
    options.cut.detail_below = Some(0.0);
    bake_scene(scene, &options).expect("a scene").table
}

/// The rooms upright, and turned by an angle whose sine and cosine are 3/5 and 4/5, with the frame that stands along them.
fn cases() -> [(&'static str, Table, Scene); 2] {
    let upright = rooms();
    let frame = Frame::new([[0.8, 0.6, 0.0], [-0.6, 0.8, 0.0], [0.0, 0.0, 1.0]], 1e-6).expect("a frame");
    let turned = |o: &SceneObject| SceneObject {
        vertices: o.vertices.iter().map(|&p| frame.to_scene(p)).collect(),
        ..o.clone()
    };
    let scene = Scene::new(upright.objects().iter().map(turned).collect()).expect("finite corners");
    let scene = scene.with_see_through(DOORS.to_vec()).and_then(|scene| scene.with_doors(DOORS.to_vec()));
    let scene = scene.and_then(|scene| scene.with_sources(upright.sources().to_vec())).expect("objects of the scene");
    let moved = Moved::new(&scene, &frame).expect("a wide gap").scene;
    let table = table_of(&moved).with_frame(Some(frame)).expect("a table in space").with_digest(Some(scene.digest()));
    [("upright", table_of(&upright), upright), ("turned", table, scene)]
}

fn options() -> VerifyOptions<'static> {
    VerifyOptions { rays: 500, pairs: 100, ..quick() }
}

#[test]
fn true_doors_have_no_violation() {
    for (name, table, scene) in cases() {
        let n_portals: Vec<usize> = table.doors().iter().map(|door| door.portals.len()).collect();
        assert!(n_portals[..3].iter().all(|&n| n > 0) && n_portals[3] == 0, "{name}: {n_portals:?}");
        assert_eq!(table.objects_of_node(14).collect::<Vec<_>>(), [ObjectId(7)], "{name}");
        let found = check(&table, &Real::Scene(scene), &VerifyOptions { rays: 20_000, ..quick() });
        assert_eq!((found.violations, found.n_doors), (vec![], 4), "{name}");
        let remarks = [found.remarks.doors_as_boxes, found.remarks.unlisted_door_portals];
        assert_eq!(remarks, [0, 0], "{name}");
    }
}

/// A way to damage a table, with the kind of violation that it has to be found as; `false` if nothing was changed.
type Damage = (&'static str, &'static str, fn(&mut TableParts, &mut Random) -> bool);

const KINDS: [Damage; 8] = [
    ("a door closes a portal more", "open-door", |parts, random| {
        let [door, portal] = [parts.doors.len(), parts.portals.len()].map(|n| random.below(n));
        insert(&mut parts.doors[door], PortalId(portal as u32))
    }),
    ("a door closes a portal of another", "open-door", |parts, random| {
        let [door, other] = [(); 2].map(|()| random.below(parts.doors.len()));
        let portal = parts.doors[other].portals.first().copied();
        portal.is_some_and(|portal| insert(&mut parts.doors[door], portal))
    }),
    ("a door is another one of its name", "open-door", |parts, random| {
        let [door, other] = if random.below(2) == 0 { [1, 2] } else { [2, 1] };
        parts.doors[door].object = parts.doors[other].object;
        true
    }),
    ("a door is another one", "door-name", |parts, random| {
        let [door, other] = [(); 2].map(|()| random.below(parts.doors.len()));
        let is_other = parts.doors[door].name != parts.doors[other].name;
        parts.doors[door].object = parts.doors[other].object;
        is_other
    }),
    ("a door is no door", "no-door", |parts, random| {
        let [door, wall] = [parts.doors.len(), 7].map(|n| random.below(n));
        parts.doors[door].object = Some(ObjectId(wall as u32));
        true
    }),
    ("a door has another name", "door-name", |parts, random| {
        let door = random.below(parts.doors.len());
        parts.doors[door].name.push('s');
        true
    }),
    ("an object has another name", "object-name", |parts, random| {
        let object = random.below(parts.objects.len());
        parts.objects[object].name.push('s');
        true
    }),
    ("an object is elsewhere in its file", "object-source", |parts, random| {
        let object = random.below(parts.objects.len());
        let source = parts.object_sources[object];
        parts.object_sources[object] = match random.below(3) {
            0 => source.map(|source| ObjectSource { node: source.node + 1, ..source }),
            1 => source.map(|source| ObjectSource { primitive: source.primitive + 1, ..source }),
            _ => source.xor(Some(ObjectSource { node: 0, primitive: 0 })),
        };
        parts.object_sources[object] != source
    }),
];

/// Adds a portal to a door, unless the door closes it already.
fn insert(door: &mut DoorRecord, portal: PortalId) -> bool {
    let place = door.portals.binary_search(&portal);
    if let Err(k) = place {
        door.portals.insert(k, portal);
    }
    place.is_err()
}

/// Invariant: every door and every object that is not as in the scene is found, and named as what it is.
#[test]
fn damaged_doors_are_found() {
    let mut n_caught = 0;
    for (name, table, scene) in cases() {
        let real = Real::Scene(scene);
        for (what, kind, damage) in KINDS {
            for seed in 0..TRIES as u64 {
                let mut random = Random::new(seed);
                let wrong = changed(&table, |parts| {
                    (0..100).find(|_| damage(parts, &mut random)).expect("a place for it");
                });
                let findings = check(&wrong, &real, &VerifyOptions { pairs: 0, ..options() });
                assert!(findings.by_kind.contains_key(kind), "{name}, {what}, try {seed}: {:?}", findings.by_kind);
                n_caught += 1;
            }
        }
    }
    assert_eq!(n_caught, 2 * KINDS.len() * TRIES);
}

/// The tightness twin: a door that closes less than it could is no violation, and is counted; so is one that the scene does not have.
#[test]
fn doors_that_close_less_are_counted() {
    for (name, table, scene) in cases() {
        let n: u64 = table.doors().iter().map(|door| door.portals.len() as u64).sum();
        let open = changed(&table, |parts| parts.doors.iter_mut().for_each(|door| door.portals.clear()));
        let real = Real::Scene(scene);
        let found = check(&open, &real, &options());
        assert_eq!((found.n_violations, found.remarks.unlisted_door_portals), (0, n), "{name}");
        let given = changed(&table, |parts| {
            parts.doors.push(DoorRecord { name: "gate".to_owned(), object: None, portals: vec![PortalId(0)] });
        });
        let found = check(&given, &real, &options());
        assert_eq!((found.n_violations, found.remarks.doors_as_boxes, found.n_doors), (0, 1, 5), "{name}");
    }
}

/// Doors that were given as boxes close what these contain: a portal more is a violation, one less is counted.
#[test]
fn doors_that_are_boxes_are_compared_with_these() {
    for (name, table, scene) in cases() {
        let real = Real::Scene(scene);
        let frame = table.frame().copied();
        let wider = frame.map_or(0.0, |frame| 2.0 * frame.gap());
        let around = |portal: &PortalRecord| {
            let in_scene = portal.points.iter().map(|&p| frame.map_or(p, |frame| frame.to_scene(p)));
            let b = Aabb::<3>::around(in_scene);
            DoorBox { name: "gate".to_owned(), min: b.min.map(|x| x - wider), max: b.max.map(|x| x + wider) }
        };
        let boxes: Vec<DoorBox> = table.portals().iter().take(3).map(around).collect();
        let (n, one) = (table.doors().len(), &boxes[..1]);
        let given = table.clone().with_door_boxes(one).with_door_boxes(&boxes);
        assert_eq!(given.door_boxes().len(), 4, "{name}");
        assert!(given.doors()[n..].iter().all(|door| !door.portals.is_empty()), "{name}");
        let found = |table: &Table| {
            let found = check(table, &real, &options());
            (found.n_violations, found.remarks.doors_as_boxes, found.remarks.unlisted_door_portals)
        };
        assert_eq!(found(&given), (0, 0, 0), "{name}");
        let closed = &given.doors()[n].portals;
        let other = (0..).map(PortalId).find(|portal| !closed.contains(portal)).expect("more portals than one");
        let more = changed(&given, |parts| assert!(insert(&mut parts.doors[n], other)));
        assert_eq!(found(&more), (1, 0, 0), "{name}");
        let less = changed(&given, |parts| parts.doors[n].portals.clear());
        assert_eq!(found(&less), (0, 0, closed.len() as u64), "{name}");
        // Boxes that are not stated for each door are those of none.
        for text in ["", "0,0,0,1,1,1", "0,0,0,1,1,1\n1\n2\n3", "0,0,0,1,1,x\n\n\n"] {
            let unstated = changed(&given, |parts| {
                let (_, value) = parts.info.iter_mut().find(|(key, _)| key == "door-boxes").expect("stated");
                *value = text.to_owned();
            });
            assert_eq!(found(&unstated), (0, 4, 0), "{name}");
        }
    }
}

/// Plans and maps have no leafs: their doors are counted, objects or not.
#[test]
fn doors_of_plans_and_maps_are_counted() {
    let mut n_objects = 0;
    for case in common::cases().filter(|case| !matches!(case.real, Real::Scene(_))) {
        let object = (!case.table.objects().is_empty()).then_some(ObjectId(0));
        n_objects += usize::from(object.is_some());
        let table = changed(&case.table, |parts| {
            parts.doors =
                [object, None].map(|object| DoorRecord { object, name: String::new(), portals: vec![] }).into();
        });
        let found = check(&table, &case.real, &VerifyOptions { rays: 10, pairs: 0, ..quick() });
        assert_eq!((found.remarks.doors_as_boxes, found.n_doors), (2, 2), "{}", case.name);
    }
    assert!(n_objects > 1, "{n_objects}");
}

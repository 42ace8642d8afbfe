use super::*;
use crate::stroke::merge;
use std::collections::BTreeMap;

type Corners = [[i64; 3]; 3];

/// The corners of an object's triangles in mesh steps; fails unless all are multiples of 1/64.
fn corners(object: &SceneObject) -> Vec<Corners> {
    let whole = |x: f64| {
        assert_eq!((x * 64.0).fract(), 0.0, "{}: {x} is no multiple of 1/64", object.name);
        (x * 64.0) as i64
    };
    object.corners().map(|t| t.map(|p| p.map(whole))).collect()
}

fn cross([a, b, c]: &Corners) -> [i64; 3] {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// The defect of a mesh: a triangle without area, an edge that its two triangles traverse in the same direction or that
/// has only one, a part that faces inwards. Flat parts face both ways.
fn fault(object: &SceneObject) -> Option<&'static str> {
    let triangles = corners(object);
    let mut edges: BTreeMap<[[i64; 3]; 2], i64> = BTreeMap::new();
    let mut part: Vec<usize> = (0..object.vertices.len()).collect();
    let mut volume: BTreeMap<usize, (i64, bool)> = BTreeMap::new();
    for t in &object.triangles {
        let parts = t.map(|i| part[i as usize]);
        part.iter_mut().filter(|p| parts.contains(p)).for_each(|p| *p = parts[0]);
    }
    for (t, c) in object.triangles.iter().zip(&triangles) {
        let n = cross(c);
        if n == [0; 3] {
            return Some("a triangle without area");
        }
        for k in 0..3 {
            let (a, b) = (c[k], c[(k + 1) % 3]);
            *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
        let first =
            triangles[object.triangles.iter().position(|s| part[s[0] as usize] == part[t[0] as usize]).unwrap()][0];
        let entry = volume.entry(part[t[0] as usize]).or_insert((0, true));
        let heights: Vec<i64> = c.iter().map(|p| (0..3).map(|k| n[k] * (p[k] - first[k])).sum()).collect();
        entry.0 += heights[0];
        entry.1 &= heights[0] == 0;
    }
    if edges.values().any(|&n| n != 0) {
        return Some("an open edge");
    }
    volume.values().any(|&(v, flat)| v < 0 || (v == 0 && !flat)).then_some("a part that faces inwards")
}

fn checksum(scene: &Scene) -> u64 {
    let mut hash = 0xCBF2_9CE4_8422_2325_u64;
    let mut eat =
        |bytes: &[u8]| bytes.iter().for_each(|&b| hash = (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01B3));
    for o in scene.objects() {
        eat(o.name.as_bytes());
        o.vertices.iter().flatten().for_each(|x| eat(&x.to_bits().to_le_bytes()));
        o.triangles.iter().flatten().for_each(|i| eat(&i.to_le_bytes()));
    }
    hash
}

fn small(seed: u64, wall_thickness: f64) -> TowerOptions {
    TowerOptions { seed, floors: 3, rooms_x: 3, rooms_y: 5, wall_thickness, ..TowerOptions::default() }
}

const THICKNESSES: [f64; 3] = [0.0, 0.25, 0.5];

fn is_structure(name: &str) -> bool {
    ["wall_", "lintel_", "sill_", "pillar_"].iter().any(|kind| name.contains(kind))
}

#[test]
fn tower_is_deterministic() {
    let sums = THICKNESSES.map(|t| checksum(&tower(small(1, t)).unwrap()));
    assert_eq!(sums, PINNED);
    assert_ne!(sums[0], checksum(&tower(small(2, 0.0)).unwrap()));
}

const PINNED: [u64; 3] = [2820285175157762066, 10580169781782470862, 12051303231592109815];

#[test]
fn tower_lower_floors_do_not_depend_on_higher_ones() {
    let (low, high) = (tower(small(1, 0.25)).unwrap(), tower(TowerOptions { floors: 5, ..small(1, 0.25) }).unwrap());
    let floors = |s: &Scene| -> Vec<SceneObject> {
        let names = ["floor0/", "floor1/"];
        s.objects().iter().filter(|o| names.iter().any(|n| o.name.starts_with(n))).cloned().collect()
    };
    assert!(floors(&low).len() > 100 && floors(&low) == floors(&high));
}

#[test]
fn tower_objects_are_closed_and_face_outwards() {
    for (furniture, thickness) in [(1, 0.0), (2, 0.25), (3, 0.5)] {
        let scene = tower(TowerOptions { furniture, ..small(7, thickness) }).unwrap();
        for object in scene.objects() {
            assert_eq!(fault(object), None, "{}", object.name);
        }
        let mut names: Vec<&str> = scene.objects().iter().map(|o| o.name.as_str()).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|w| w[0] != w[1]), "names are unique");
    }
}

/// The impostors: a hole, a reversed triangle, a box turned inside out, a sliver.
#[test]
fn tower_faults_are_found() {
    let mut mesh = Mesh::new(false);
    mesh.cuboid([0, 0, 0], [8, 16, 8]);
    let good = mesh.object("box".to_owned(), 0);
    assert_eq!(fault(&good), None);
    let mut bad = good.clone();
    bad.triangles.pop();
    assert_eq!(fault(&bad), Some("an open edge"));
    let mut bad = good.clone();
    bad.triangles[3].swap(0, 1);
    assert_eq!(fault(&bad), Some("an open edge"));
    let mut bad = good.clone();
    bad.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    assert_eq!(fault(&bad), Some("a part that faces inwards"));
    let mut bad = good;
    bad.triangles.push([1, 1, 2]);
    assert_eq!(fault(&bad), Some("a triangle without area"));
}

#[test]
fn tower_walls_are_axial_rectangles_of_two_triangles() {
    for thickness in THICKNESSES {
        let scene = tower(small(4, thickness)).unwrap();
        // The diagonal along which rectangles are cut, recognized by the slope of the longest edge.
        let mut diagonals = [0, 0];
        for object in scene.objects().iter().filter(|o| is_structure(&o.name)) {
            let flat = thickness == 0.0 && !object.name.contains("pillar");
            assert_eq!(object.triangles.len(), if flat { 4 } else { 12 }, "{}", object.name);
            for c in corners(object) {
                assert_eq!(cross(&c).iter().filter(|&&x| x != 0).count(), 1, "{} is axial", object.name);
                assert!(c.iter().flatten().all(|x| x % 8 == 0), "{}: multiples of 1/8", object.name);
                let slopes =
                    (0..3).map(|k| (c[k], c[(k + 1) % 3])).map(|(a, b)| (a[0] + a[2] - b[0] - b[2]) * (a[1] - b[1]));
                slopes.filter(|&s| s != 0).for_each(|s| diagonals[usize::from(s > 0)] += 1);
            }
        }
        assert!(diagonals.iter().all(|&n| n > 100), "{diagonals:?}");
    }
    let oblique = |o: &&SceneObject| corners(o).iter().any(|c| cross(c).iter().filter(|&&x| x != 0).count() == 3);
    let scene = tower(small(4, 0.25)).unwrap();
    let n = scene.objects().iter().filter(|o| o.name.contains("room_")).filter(oblique).count();
    assert!(n > 100, "only {n} pieces of furniture are not axial");
}

/// How often each square of the layout's grid is covered, in a box that contains the whole floor.
fn cover(outer: Rect, rects: impl Iterator<Item = Rect>) -> Vec<u8> {
    let width = (outer.x1 + 16) as usize;
    let mut covered = vec![0; width * (outer.y1 + 16) as usize];
    for r in rects {
        for y in r.y0 + 8..r.y1 + 8 {
            let row = y as usize * width;
            covered[row + (r.x0 + 8) as usize..row + (r.x1 + 8) as usize].iter_mut().for_each(|n| *n += 1);
        }
    }
    covered
}

/// The parts of walls cover the area of thick walls exactly once; windows leave gaps at their height.
#[test]
fn tower_walls_tile() {
    for (seed, thickness) in [(1, 0.25), (2, 0.5), (3, 0.5), (4, 0.25)] {
        let options = TowerOptions { rooms_x: 9, ..small(seed, thickness) };
        let plan = TowerPlan::new(&options).unwrap();
        let layout = &plan.floors[1].layout;
        let walls = merge(layout.strokes.iter().chain(&layout.doors).copied().collect());
        let whole: Vec<u8> =
            cover(layout.outer, walls.iter().map(|w| w.thick(plan.half))).iter().map(|&n| n.min(1)).collect();
        let at = |windows, height: i32| {
            let parts = wall_parts(layout, plan.half, windows);
            let meets = |p: &&WallPart| p.heights[0] <= height && height < p.heights[1];
            cover(layout.outer, parts.iter().filter(meets).map(|p| p.rect).collect::<Vec<_>>().into_iter())
        };
        assert!(at(false, CEILING - 1) == whole && at(true, CEILING - 1) == whole, "lintels close doors and windows");
        let count = |cover: Vec<u8>| {
            assert!(cover.iter().zip(&whole).all(|(a, b)| a <= b), "no overlap");
            cover.iter().filter(|&&n| n > 0).count()
        };
        let [all, doors, sills, windows] =
            [count(whole.clone()), count(at(false, 0)), count(at(true, 0)), count(at(true, 10))];
        assert!(all > doors && doors == sills && sills > windows, "{all} {doors} {sills} {windows}");
    }
}

/// Marks of the lattice points, an eighth of a unit apart, that can be reached from `start` without
/// touching a wall or slab, inside the box around the tower.
struct Reached {
    n: [usize; 3],
    min: [f64; 3],
    marks: Vec<bool>,
}

impl Reached {
    fn from(scene: &Scene, start: [f64; 3]) -> Self {
        let b = scene.bounds();
        let n = [0, 1, 2].map(|k| ((b.max[k] - b.min[k]) * 8.0) as usize + 17);
        let mut it = Self { n, min: b.min.map(|x| x - 1.0), marks: vec![false; n.iter().product()] };
        for object in scene.objects() {
            if is_structure(&object.name) {
                it.block(object.bounds());
            } else if object.name.ends_with("/slab") {
                // What lies below its upper side: boxes below triangles that are halves of rectangles.
                let up = object.corners().zip(corners(object)).filter(|(_, c)| cross(c)[1] > 0);
                let low = object.bounds().min[1];
                up.for_each(|(t, _)| it.block(Aabb::around(t).with([t[0][0], low, t[0][2]])));
            }
        }
        let blocked = it.marks.clone();
        let mut stack = vec![it.at(start)];
        while let Some(c) = stack.pop() {
            if !std::mem::replace(&mut it.marks[c], true) {
                let steps = [1, n[0], n[0] * n[1]];
                stack.extend(
                    steps
                        .iter()
                        .flat_map(|s| [c.checked_sub(*s), Some(c + s)])
                        .flatten()
                        .filter(|&c| c < blocked.len()),
                );
            }
        }
        it.marks.iter_mut().zip(blocked).for_each(|(m, blocked)| *m &= !blocked);
        it
    }

    fn at(&self, p: [f64; 3]) -> usize {
        let [i, j, k] = [0, 1, 2].map(|k| ((p[k] - self.min[k]) * 8.0).floor() as usize);
        (k * self.n[1] + j) * self.n[0] + i
    }

    fn block(&mut self, b: Aabb<3>) {
        let (low, high) = (self.at(b.min), self.at(b.max));
        let [nx, ny, _] = self.n;
        let split = |c: usize| [c % nx, c / nx % ny, c / nx / ny];
        let (low, high) = (split(low), split(high));
        for (y, z) in (low[1]..=high[1]).flat_map(|y| (low[2]..=high[2]).map(move |z| (y, z))) {
            let row = (z * ny + y) * nx;
            self.marks[row + low[0]..=row + high[0]].fill(true);
        }
    }
}

/// A point above the middle of a room's floor, over head height so that no stairs matter.
fn middle(room: &TowerRoom) -> [f64; 3] {
    let b = room.bounds;
    [(b.min[0] + b.max[0]) / 2.0, b.min[1] + 1.0, (b.min[2] + b.max[2]) / 2.0]
}

#[test]
fn tower_rooms_are_all_reached_by_doors_and_stairs() {
    for (seed, thickness) in [(1, 0.0), (2, 0.25), (3, 0.5)] {
        let options = TowerOptions { windows: false, furniture: 0, ..small(seed, thickness) };
        let (scene, rooms) = (tower(options).unwrap(), tower_rooms(options).unwrap());
        assert!(rooms.len() >= 3 * 10);
        let reached = Reached::from(&scene, middle(&rooms[0]));
        for room in &rooms {
            assert!(reached.marks[reached.at(middle(room))], "{} of seed {seed}, walls of {thickness}", room.name);
        }
        assert!(!reached.marks[0], "the tower is closed");
        // With windows the outside is reached too.
        let open = tower(TowerOptions { windows: true, ..options }).unwrap();
        assert!(Reached::from(&open, middle(&rooms[0])).marks[0]);
    }
}

/// The impostors: with a door walled up, or no hole in a slab, something is not reached.
#[test]
fn tower_closed_doors_and_slabs_are_noticed() {
    let options = TowerOptions { windows: false, furniture: 0, ..small(1, 0.25) };
    let (scene, rooms) = (tower(options).unwrap(), tower_rooms(options).unwrap());
    let unreached = |objects: Vec<SceneObject>| {
        let reached = Reached::from(&Scene::new(objects).unwrap(), middle(&rooms[0]));
        rooms.iter().filter(|r| !reached.marks[reached.at(middle(r))]).count()
    };
    // Some rooms have a second door, but not all.
    let cut_off = scene.objects().iter().filter(|o| o.name.starts_with("floor1/lintel")).any(|lintel| {
        let mut wall = lintel.clone();
        wall.name = "floor1/wall_in_a_door".to_owned();
        wall.vertices[0][1] = 3.0;
        unreached(scene.objects().iter().cloned().chain([wall]).collect()) > 0
    });
    assert!(cut_off, "a walled-up door is noticed");
    let mut closed = scene.objects().to_vec();
    let slab = closed.iter().position(|o| o.name == "floor2/slab").unwrap();
    let whole = TowerPlan::new(&options).unwrap().slab(false).object("floor2/slab".to_owned(), height_of(2));
    closed[slab] = whole;
    let n_above = rooms.iter().filter(|r| r.name.starts_with("floor2")).count();
    assert_eq!(unreached(closed), n_above, "the highest floor is cut off");
}

#[test]
fn tower_furniture_stands_in_its_room() {
    for thickness in THICKNESSES {
        let options = small(5, thickness);
        let rooms: BTreeMap<String, Aabb<3>> =
            tower_rooms(options).unwrap().into_iter().map(|r| (r.name, r.bounds)).collect();
        let scene = tower(options).unwrap();
        let mut kinds: BTreeMap<&str, usize> = BTreeMap::new();
        for object in scene.objects().iter().filter(|o| o.name.contains("/room_")) {
            let (room, piece) = object.name.rsplit_once('/').unwrap();
            let (room, b) = (rooms[room], object.bounds());
            assert!(room.contains(b.min) && room.contains(b.max), "{}: {b:?} in {room:?}", object.name);
            *kinds.entry(piece.rsplit_once('_').unwrap().0).or_default() += 1;
        }
        assert_eq!(kinds.len(), 7, "{kinds:?}");
    }
}

#[test]
fn tower_sizes_scale() {
    let n = |floors, furniture| {
        let scene = tower(TowerOptions { floors, furniture, ..Default::default() }).unwrap();
        (scene.n_triangles() as f64, scene.objects().len() as f64)
    };
    let (t16, o16) = n(16, 2);
    assert!(t16 >= 250_000.0, "{t16} triangles");
    let (t8, o8) = n(8, 2);
    assert!((1.8..2.2).contains(&(t16 / t8)) && (1.8..2.2).contains(&(o16 / o8)));
    let by_level = [0, 1, 2, 3].map(|level| n(4, level).0);
    assert!(by_level.is_sorted() && by_level[2] > 2.0 * by_level[0], "{by_level:?}");
    // The furniture of a room does not depend on the level of detail.
    assert_eq!(n(4, 1).1, n(4, 3).1);
    let least = TowerOptions { floors: 1, rooms_x: 1, rooms_y: 1, ..Default::default() };
    assert!(tower(least).unwrap().objects().len() > 10);
}

#[test]
fn tower_options_are_checked() {
    let d = TowerOptions::default();
    let bad = |o: TowerOptions| {
        assert_eq!(tower_rooms(o).unwrap_err(), tower(o).unwrap_err());
        tower(o).unwrap_err().to_string()
    };
    assert_eq!(bad(TowerOptions { floors: 0, ..d }), "floors is 0, but must be from 1 to 256");
    assert_eq!(bad(TowerOptions { rooms_x: 129, ..d }), "rooms_x is 129, but must be from 1 to 128");
    assert_eq!(bad(TowerOptions { rooms_y: u32::MAX, ..d }), "rooms_y is 4294967295, but must be from 1 to 128");
    assert_eq!(bad(TowerOptions { furniture: 4, ..d }), "furniture is 4, but must be from 0 to 3");
    let message = "floors * rooms_x * rooms_y is 65536, but must be from 1 to 32768";
    assert_eq!(bad(TowerOptions { floors: 4, rooms_x: 128, rooms_y: 128, ..d }), message);
    let message = "wall thickness 0.3 is not one of 0, 0.25 and 0.5";
    assert_eq!(bad(TowerOptions { wall_thickness: 0.3, ..d }), message);
}

//! Levels as other programs export them: from Blender, from a BIM, and from a scan.

use serde_json::{Value, json};
use sightlines::cells::{Point3, Scene, SceneObject};
use sightlines::formats::scene::write_glb;
use std::collections::BTreeMap;

/// Thickness of walls and slabs, and height of a floor.
const THICK: f64 = 0.25;
const HIGH: f64 = 3.0;
/// The walls beside the corridor: where they stand, and the doors in them.
const CORRIDOR: [(f64, [[f64; 2]; 3]); 2] =
    [(3.75, [[1.0, 2.0], [5.0, 6.0], [10.0, 11.0]]), (5.5, [[2.0, 3.0], [6.5, 7.5], [9.0, 10.0]])];
const TABLES: [[f64; 2]; 6] = [[1.0, 1.0], [6.0, 2.0], [10.0, 2.0], [1.5, 7.0], [6.0, 8.0], [10.0, 7.0]];

/// A box along the axes, y up, in metres.
#[derive(Debug, Clone)]
struct Block {
    kind: &'static str,
    min: Point3,
    max: Point3,
}

impl Block {
    fn object(&self, name: String, place: impl Fn(Point3) -> Point3) -> SceneObject {
        let corner =
            |k: usize| std::array::from_fn(|axis| if k >> axis & 1 == 1 { self.max[axis] } else { self.min[axis] });
        let sides = (0..3).flat_map(|axis| {
            let [a, b, c]: [u32; 3] = std::array::from_fn(|k| 1 << ((axis + k) % 3));
            [[0, c, b], [b, c, b | c], [a, a | b, a | c], [a | b, a | b | c, a | c]]
        });
        SceneObject { name, vertices: (0..8).map(|k| single(place(corner(k)))).collect(), triangles: sides.collect() }
    }
}

/// As a glTF holds it.
fn single(p: Point3) -> Point3 {
    p.map(|x| f64::from(x as f32))
}

/// What of `[a, b]` is left between holes.
fn between(a: f64, b: f64, holes: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let ends = holes.iter().map(|hole| hole[0]).chain([b]);
    let starts = std::iter::once(a).chain(holes.iter().map(|hole| hole[1]));
    starts.zip(ends).filter(|(start, end)| start < end).map(|(start, end)| [start, end]).collect()
}

/// Six rooms on both sides of a corridor, 12 by 9 metres: slabs, walls, lintels and tables.
///
/// * `window`: the walls between the first two rooms have an opening from z = 1 to 3
fn rooms(window: bool) -> Vec<Block> {
    let block = |kind, min, max| Block { kind, min, max };
    let mut all = vec![
        block("Slab", [0.0, -THICK, 0.0], [12.0, 0.0, 9.0]),
        block("Slab", [0.0, HIGH, 0.0], [12.0, HIGH + THICK, 9.0]),
        block("Wall", [0.0, 0.0, 0.0], [12.0, HIGH, THICK]),
        block("Wall", [0.0, 0.0, 9.0 - THICK], [12.0, HIGH, 9.0]),
        block("Wall", [0.0, 0.0, THICK], [THICK, HIGH, 9.0 - THICK]),
        block("Wall", [12.0 - THICK, 0.0, THICK], [12.0, HIGH, 9.0 - THICK]),
    ];
    for (z, doors) in CORRIDOR {
        for [a, b] in between(THICK, 12.0 - THICK, &doors) {
            all.push(block("Wall", [a, 0.0, z], [b, HIGH, z + THICK]));
        }
        all.extend(doors.map(|[a, b]| block("Lintel", [a, 2.0, z], [b, HIGH, z + THICK])));
    }
    for (x, [near, far]) in [4.0, 8.0].into_iter().flat_map(|x| [(x, [THICK, 3.75]), (x, [5.75, 9.0 - THICK])]) {
        let holes: &[[f64; 2]] = if window && x == 4.0 && near < 1.0 { &[[1.0, 3.0]] } else { &[] };
        for [a, b] in between(near, far, holes) {
            all.push(block("Wall", [x, 0.0, a], [x + THICK, HIGH, b]));
        }
        for &[a, b] in holes {
            all.push(block("Wall", [x, 0.0, a], [x + THICK, 1.0, b]));
            all.push(block("Wall", [x, 2.0, a], [x + THICK, HIGH, b]));
        }
    }
    all.extend(TABLES.map(|[x, z]| block("Table", [x, 0.0, z], [x + 1.5, 0.75, z + 0.75])));
    all
}

fn glb(objects: Vec<SceneObject>, single_sided: bool) -> Vec<u8> {
    let n = objects.len() as u32;
    let scene = Scene::new(objects).expect("finite corners");
    let scene = scene.with_single_sided(if single_sided { (0..n).collect() } else { Vec::new() });
    write_glb(&scene.expect("objects of the scene")).expect("single precision")
}

/// A level with a pane that its file calls opaque, a trigger around the corridor, and a hull of a table for physics.
pub(crate) fn blender() -> Vec<u8> {
    let mut blocks = rooms(true);
    blocks.push(Block { kind: "Window glass", min: [4.1, 1.0, 1.0], max: [4.15, 2.0, 3.0] });
    blocks.push(Block { kind: "Alarm-noimp", min: [4.5, 0.0, 4.0], max: [7.5, 3.0, 5.5] });
    let objects = blocks.iter().enumerate().map(|(k, block)| block.object(format!("{}.{k:03}", block.kind), |p| p));
    glb(objects.collect(), false)
}

/// A building in millimetres, z up, turned by 30 degrees: walls of panels with gaps of a millimetre that end a centimetre below the
/// ceiling, and closed doors.
pub(crate) fn bim() -> Vec<u8> {
    let turned = |[x, y, z]: Point3| {
        let [x, y, z] = [1000.0 * x, -1000.0 * z, 1000.0 * y];
        let [sine, cosine] = [0.5, 0.75_f64.sqrt()];
        [cosine * x - sine * y, sine * x + cosine * y, z]
    };
    let mut blocks = Vec::new();
    for block in rooms(false) {
        if block.kind != "Wall" {
            blocks.push(block);
            continue;
        }
        let axis = if block.max[0] - block.min[0] > block.max[2] - block.min[2] { 0 } else { 2 };
        let length = block.max[axis] - block.min[axis];
        let n = (length / 1.2).ceil().max(1.0);
        let mut panel = block.clone();
        panel.max[1] -= 0.01;
        for k in 0..n as u32 {
            let at = |k: u32, off: f64| match k {
                0 => block.min[axis],
                k if f64::from(k) == n => block.max[axis],
                k => block.min[axis] + length * f64::from(k) / n + off,
            };
            (panel.min[axis], panel.max[axis]) = (at(k, 0.0005), at(k + 1, -0.0005));
            blocks.push(panel.clone());
        }
    }
    blocks.extend(leaves("Door"));
    let objects = blocks.iter().enumerate().map(|(k, block)| block.object(format!("Ifc{}_{k}", block.kind), turned));
    glb(objects.collect(), true)
}

/// Blocks of houses with streets between, 32 by 32 metres, as a surface with bumps and holes: one object, or one for each square of
/// eight metres.
pub(crate) fn scan(is_cut: bool) -> Vec<u8> {
    const SIDE: u32 = 32;
    let noise = |i: u32, j: u32, k: u32| {
        let mixed = (i.wrapping_mul(73_856_093) ^ j.wrapping_mul(19_349_663) ^ k.wrapping_mul(83_492_791))
            .wrapping_mul(2_654_435_761);
        let mixed = (mixed ^ (mixed >> 15)).wrapping_mul(2_246_822_519);
        f64::from(mixed ^ (mixed >> 13)) / f64::from(u32::MAX) - 0.5
    };
    let place = |i: u32, j: u32| {
        let is_house = i % 16 >= 4 && j % 16 >= 4;
        let roof = if is_house { 9.0 + 2.0 * noise(i / 16, j / 16, 7) } else { 0.0 };
        let off = |k: u32| 0.15 * noise(i, j, k);
        single([f64::from(i) + off(1), roof + off(2), f64::from(j) + off(3)])
    };
    let mut pieces: BTreeMap<[u32; 2], Vec<[u32; 2]>> = BTreeMap::new();
    for [i, j] in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| [i, j])) {
        if noise(i, j, 9) < 0.49 {
            pieces.entry(if is_cut { [i / 8, j / 8] } else { [0, 0] }).or_default().push([i, j]);
        }
    }
    let object = |([a, b], squares): ([u32; 2], Vec<[u32; 2]>)| {
        let (mut vertices, mut ids) = (Vec::new(), BTreeMap::new());
        let mut id = |i: u32, j: u32| {
            *ids.entry([i, j]).or_insert_with(|| {
                vertices.push(place(i, j));
                vertices.len() as u32 - 1
            })
        };
        let quad = |[i, j]: [u32; 2]| {
            let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
            [[a, c, b], [a, d, c]]
        };
        let triangles = squares.into_iter().flat_map(quad).collect();
        SceneObject { name: format!("piece {a} {b}"), vertices, triangles }
    };
    glb(pieces.into_iter().map(object).collect(), true)
}

/// The level from Blender, with extras: viewers are where the alarm is, one table is a lift, and the pane a door.
pub(crate) fn blender_with_extras() -> Vec<u8> {
    edited(&blender(), |document| {
        let nodes = document["nodes"].as_array_mut().expect("a list of nodes");
        let mut state = |kind: &str, stated: Value| {
            let of_kind = |node: &&mut Value| node["name"].as_str().is_some_and(|name| name.starts_with(kind));
            let node = nodes.iter_mut().find(of_kind).unwrap_or_else(|| panic!("no {kind}"));
            node["extras"] = json!({ "sightlines": stated });
        };
        state("Alarm", json!({"role": "view-volume"}));
        state("Table", json!({"moves": 1}));
        state("Window", json!({"role": "door"}));
    })
}

/// The level from Blender, where viewers are to be on a plane.
pub(crate) fn with_flat_view_volume() -> Vec<u8> {
    edited(&blender_with_extras(), |document| {
        for node in document["nodes"].as_array_mut().expect("a list of nodes") {
            if node["extras"]["sightlines"]["role"] == "view-volume" {
                node["scale"] = json!([1.0, 0.0, 1.0]);
            }
        }
    })
}

/// The rooms with a shut door in each opening, which extras call a door.
pub(crate) fn with_doors() -> Vec<u8> {
    let mut blocks = rooms(false);
    blocks.extend(leaves("Leaf"));
    let objects = blocks.iter().enumerate().map(|(k, block)| block.object(format!("{}.{k:03}", block.kind), |p| p));
    edited(&glb(objects.collect(), false), |document| {
        for node in document["nodes"].as_array_mut().expect("a list of nodes") {
            if node["name"].as_str().is_some_and(|name| name.starts_with("Leaf")) {
                node["extras"] = json!({"sightlines": {"role": "door"}});
            }
        }
    })
}

/// What fills the openings at the corridor.
fn leaves(kind: &'static str) -> impl Iterator<Item = Block> {
    let leaf = move |z: f64, [a, b]: [f64; 2]| Block { kind, min: [a, 0.0, z + 0.1], max: [b, 2.0, z + 0.15] };
    CORRIDOR.into_iter().flat_map(move |(z, doors)| doors.map(|door| leaf(z, door)))
}

/// A GLB with another document.
fn edited(glb: &[u8], edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    let length = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().expect("four bytes")) as usize;
    let end = 20 + length(12);
    let mut document = serde_json::from_slice(&glb[20..end]).expect("a document");
    edit(&mut document);
    let mut text = serde_json::to_vec(&document).expect("JSON");
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = (20 + text.len() + glb.len() - end) as u32;
    [&glb[..8], &total.to_le_bytes(), &(text.len() as u32).to_le_bytes(), &glb[16..20], &text, &glb[end..]].concat()
}

//! Cuts a furnished tower made of triangles; `cargo run --release --example furnished -- 64` for 64 floors.

use sightlines_cells::{Scene, SceneObject};
use sightlines_kdtree::{SceneOptions, SceneSubdivision, subdivide_scene};
use std::time::Instant;

/// A closed box of twelve triangles, seen from outside, added to an object.
fn add_box(object: &mut SceneObject, min: [f64; 3], max: [f64; 3]) {
    let first = object.vertices.len() as u32;
    let corner = |i: usize| std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] });
    object.vertices.extend((0..8).map(corner));
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for [a, b, c, d] in sides.map(|side| side.map(|i: u32| first + i)) {
        object.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

fn new_object(name: &str) -> SceneObject {
    SceneObject { name: name.to_owned(), vertices: Vec::new(), triangles: Vec::new() }
}

fn solid(name: &str, min: [f64; 3], max: [f64; 3]) -> SceneObject {
    let mut out = new_object(name);
    add_box(&mut out, min, max);
    out
}

/// A wall along x from `x` on, with a doorway.
fn wall_with_door(x: f64, y: f64, z: f64) -> [SceneObject; 3] {
    [
        solid("wall", [x, y, z], [x + 3.0, y + 0.2, z + 2.75]),
        solid("wall", [x + 4.0, y, z], [x + 5.75, y + 0.2, z + 2.75]),
        solid("lintel", [x + 3.0, y, z + 2.0], [x + 4.0, y + 0.2, z + 2.75]),
    ]
}

/// A shelf full of books, below the size of rooms: 60 boxes.
fn shelf(x: f64, y: f64, z: f64) -> SceneObject {
    let mut out = new_object("shelf");
    for i in 0..60u32 {
        let (column, row) = (f64::from(i % 12), f64::from(i / 12));
        let at = [x + column / 16.0, y, z + row / 4.0];
        add_box(&mut out, at, [at[0] + 0.05, at[1] + 0.25, at[2] + 0.2]);
    }
    out
}

/// A floor: a corridor with five rooms on each side, all furnished.
fn floor(level: u32, out: &mut Vec<SceneObject>) {
    let z = f64::from(level) * 3.0;
    out.push(solid("slab", [0.0, 0.0, z - 0.25], [30.0, 20.0, z]));
    for x in (0..=5).map(|i| f64::from(i) * 5.95) {
        out.push(solid("wall", [x, 0.0, z], [x + 0.25, 9.0, z + 2.75]));
        out.push(solid("wall", [x, 11.2, z], [x + 0.25, 20.0, z + 2.75]));
    }
    for x in (0..5).map(|i| f64::from(i) * 5.95 + 0.25) {
        out.extend(wall_with_door(x, 8.8, z));
        out.extend(wall_with_door(x, 11.2, z));
        for (y, i) in [0.5, 2.0, 3.5, 5.0, 13.0, 15.0, 17.0, 18.5].into_iter().zip(0u32..) {
            out.push(shelf(x + 0.5 + f64::from(i % 4), y, z));
            out.push(shelf(x + 2.5 + f64::from(i % 3), y + 0.5, z));
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let n_floors = std::env::args().nth(1).map_or(Ok(2), |n| n.parse())?;
    let mut objects = Vec::new();
    (0..n_floors).for_each(|level| floor(level, &mut objects));
    let scene = Scene::new(objects)?;
    let start = Instant::now();
    let SceneSubdivision { summary, .. } = subdivide_scene(&scene, &SceneOptions::default())?;
    println!("{} triangles in {} objects", scene.n_triangles(), scene.objects().len());
    println!("{summary:#?}");
    eprintln!("{:.2} s", start.elapsed().as_secs_f64());
    Ok(())
}

//! A door is shut by its name, and what is seen is found again in the file that the table was made of.
//!
//! Two rooms with a wall between them, an opening in the wall, a door that stands shut in the scene, and a chair in each room. A game would read
//! table and scene from files.

use sightlines_bake::{SceneBakeOptions, bake_scene};
use sightlines_cells::{Scene, SceneError, SceneObject};
use sightlines_eye_to_cell::{Method, TableCells, View};
use sightlines_pvs::{ObjectSource, Table};
use sightlines_walkthrough::{WalkOptions, Walkthrough};
use std::error::Error;
use std::sync::Arc;

/// A box; from the inside if it is the hull of the rooms.
fn cuboid(name: &str, min: [f64; 3], max: [f64; 3]) -> SceneObject {
    let corner = |k: usize| std::array::from_fn(|axis| if k >> axis & 1 == 1 { max[axis] } else { min[axis] });
    let sides = (0..3).flat_map(|axis| {
        let [a, b, c]: [u32; 3] = std::array::from_fn(|k| 1 << ((axis + k) % 3));
        [[0, c, b], [b, c, b | c], [a, a | b, a | c], [a | b, a | b | c, a | c]]
    });
    let turned = sides.map(|[p, q, r]| if name == "hull" { [p, r, q] } else { [p, q, r] });
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles: turned.collect() }
}

/// As a reader of glTF returns it: object `k` is the first primitive of node `10 + k`.
fn house() -> Result<Scene, SceneError> {
    let objects = vec![
        cuboid("hull", [0.0; 3], [9.0, 4.0, 3.0]),
        cuboid("wall", [4.0, 0.0, 0.0], [5.0, 1.0, 3.0]),
        cuboid("wall", [4.0, 2.0, 0.0], [5.0, 4.0, 3.0]),
        cuboid("lintel", [4.0, 1.0, 2.0], [5.0, 2.0, 3.0]),
        cuboid("chair", [1.0, 1.25, 0.0], [1.5, 1.75, 1.0]),
        cuboid("chair", [7.0, 1.25, 0.0], [7.5, 1.75, 1.0]),
        cuboid("Front door", [4.25, 1.0, 0.0], [4.5, 2.0, 2.0]),
    ];
    let sources = (10..).map(|node| Some(ObjectSource { node, primitive: 0 })).take(objects.len()).collect();
    // A door hides nothing while the table is made, as it may be open.
    Scene::new(objects)?.with_see_through(vec![6])?.with_doors(vec![6])?.with_sources(sources)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut options = SceneBakeOptions::default();
    options.cut.detail_below = Some(0.0);
    let bytes = bake_scene(&house()?, &options)?.table.to_bytes();

    let table = Arc::new(Table::from_bytes(&bytes)?);
    let cells = TableCells::new(Arc::clone(&table));
    let how = WalkOptions { has_thread: false, ..WalkOptions::default() };
    let mut walk = Walkthrough::new(cells.clone(), cells, how);
    let view = View::all_round([3.0, 1.5, 1.5])?;
    for is_shut in [false, true] {
        // Names may repeat, as those of the wings of a door.
        for door in table.door("Front door") {
            if is_shut {
                walk.close_door(table.doors(), door);
            } else {
                walk.open_door(door);
            }
        }
        println!("the front door is {}:", if is_shut { "shut" } else { "open" });
        for &object in walk.frame(&view, Method::Exact).seen.objects() {
            let name = &table.objects()[object.idx()].name;
            match table.source_of(object) {
                Some(ObjectSource { node, primitive }) => println!("  {name}: node {node}, primitive {primitive}"),
                None => println!("  {name}"),
            }
        }
    }
    Ok(())
}

//! A door that closes and a wall that moves: the table follows.

use sightlines_bake::{LiveScene, SceneBakeOptions, bake_scene};
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Aabb;
use sightlines_scenes::{TowerOptions, tower};
use std::error::Error;
use std::time::Instant;

/// A closed box that faces outwards.
fn block(name: &str, b: &Aabb<3>) -> SceneObject {
    let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 1 { b.max[k] } else { b.min[k] });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
}

fn main() -> Result<(), Box<dyn Error>> {
    let scene = tower(TowerOptions { floors: 2, ..TowerOptions::default() })?;
    let options = SceneBakeOptions::default();
    let mut live = LiveScene::new(scene.clone(), &options)?;
    println!("{} cells, {} objects", live.table().n_cells(), live.table().objects().len());

    // A door as high and wide as the opening under the lintel.
    let lintel = scene.objects().iter().find(|o| o.name == "floor1/lintel_4").ok_or("the tower has no such lintel")?;
    let opening = Aabb {
        min: [0, 1, 2].map(|k| if k == 1 { 3.0 } else { lintel.bounds().min[k] }),
        max: {
            let b = lintel.bounds();
            [b.max[0], b.min[1], b.max[2]]
        },
    };
    let mut with_door = scene.objects().to_vec();
    with_door.push(block("door", &opening));
    let mut moved = scene.objects().to_vec();
    for object in moved.iter_mut().filter(|o| o.name == "floor1/wall_12") {
        object.vertices.iter_mut().for_each(|p| p[2] += 0.25);
    }
    let steps =
        [("a door closes", Scene::new(with_door)?), ("it opens", scene.clone()), ("a wall moves", Scene::new(moved)?)];
    for (what, scene) in steps {
        let start = Instant::now();
        let update = live.update(scene.clone())?;
        let updated = start.elapsed();
        let start = Instant::now();
        let anew = bake_scene(&scene, &options)?;
        let rebuilt = start.elapsed();
        assert!(anew.table.to_bytes() == live.table().to_bytes() || anew.report.n_assumed > 0, "the tables are equal");
        println!(
            "{what}: {} of {} lines cut, {} cells new, {updated:.1?} instead of {rebuilt:.1?}",
            update.space.n_lines_cut, update.space.n_lines, update.space.n_cells_new
        );
    }
    Ok(())
}

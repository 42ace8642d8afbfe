//! Two walls with a gap between them, and a post behind the gap: what a street hides from a place in front of it.
//!
//! `cargo run -p sightlines-from-region --example fused_blockers`

use sightlines_cells::{Scene, SceneObject};
use sightlines_from_region::{ViewShafts, VoxelOptions, Voxels};
use sightlines_geometry::Aabb;
use sightlines_multifocal::mesh::{PatchOptions, patches};
use sightlines_multifocal::{FromRegion, Volume};
use std::error::Error;

/// A closed box.
fn cuboid(name: &str, x: [f64; 2], z: [f64; 2]) -> SceneObject {
    let corner = |i: usize| [x[i & 1], [-8.0, 8.0][i >> 1 & 1], z[i >> 2]];
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
}

/// Which boxes of 16 units, behind everything and each one unit further to the right, are hidden: `#` for those, `.` for the others.
fn row(method: &mut dyn FromRegion, eyes: &Volume) -> Result<String, Box<dyn Error>> {
    let mut umbra = method.umbra(eyes)?;
    let place = |x: i32| Aabb { min: [f64::from(x), -1.0, 40.0], max: [f64::from(x) + 16.0, 1.0, 41.0] };
    Ok((-38..=22).map(|x| if umbra.hides(&place(x)) { '#' } else { '.' }).collect())
}

fn main() -> Result<(), Box<dyn Error>> {
    let walls = [cuboid("left", [-30.0, -1.0], [10.0, 14.0]), cuboid("right", [1.0, 30.0], [10.0, 14.0])];
    let post = cuboid("post", [-5.0, 5.0], [20.0, 24.0]);
    let eyes = Volume::new(Aabb { min: [-1.0, -0.5, 0.0], max: [1.0, 0.5, 1.0] })?;
    println!("from the middle, 40 away, 61 boxes from left to right (# is hidden):");
    let scenes = [("walls", walls.to_vec()), ("post", vec![post.clone()]), ("both", [&walls[..], &[post]].concat())];
    for (name, objects) in scenes {
        let triangles: Vec<_> = objects.iter().flat_map(|o| o.corners()).collect();
        let scene = Scene::new(objects)?;
        let mut shafts = ViewShafts::new(patches(&triangles, &PatchOptions::default()));
        let mut voxels = Voxels::new(&scene, VoxelOptions { n_longest: 120, ..VoxelOptions::default() })?;
        println!("{name:6} shafts {}", row(&mut shafts, &eyes)?);
        println!("{name:6} voxels {}", row(&mut voxels, &eyes)?);
    }
    Ok(())
}

//! Cuts a scene into cells at the height of eyes, and finds out which of given places are in one.
//!
//! Run as `cargo run --release -p sightlines-bake --example eye_level -- SCENE [CELLS [SCALE]]`: the middles of the boxes in CELLS are the places,
//! all coordinates are multiplied by SCALE.

use sightlines_bake::eye_level::{EyeLevelOptions, eye_level_cells};
use sightlines_cells::{Scene, SceneObject};
use sightlines_formats::scene::read_scene;
use sightlines_formats::view_cells::read_view_cells;
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [path, rest @ ..] = &args[..] else { return Err("a scene is needed".into()) };
    let file = read_scene(path)?;
    let by: f64 = rest.get(1).map_or(Ok(1.0), |by| by.parse())?;
    let scaled =
        |o: &SceneObject| SceneObject { vertices: o.vertices.iter().map(|p| p.map(|x| x * by)).collect(), ..o.clone() };
    let scene = if by == 1.0 {
        file.scene
    } else {
        Scene::new(file.scene.objects().iter().map(scaled).collect())?
            .with_see_through(file.scene.see_through().to_vec())?
            .with_single_sided(file.scene.single_sided().to_vec())?
            .with_front_occluders(file.scene.front_occluders().to_vec())?
    };
    let start = Instant::now();
    let found = eye_level_cells(&scene, file.info.up, None, &EyeLevelOptions::default(), 1 << 20, None)?;
    println!("{path}: {} triangles, {:.2} s", scene.n_triangles(), start.elapsed().as_secs_f64());
    println!("  {:?}", found.summary);
    let up = file.info.up.idx();
    let mut tall: Vec<f64> =
        found.cells.iter().map(|b| (b.max[up] - b.min[up]) / found.summary.units_per_metre).collect();
    tall.sort_by(f64::total_cmp);
    println!("  heights of cells: {:?}", [0, 1, 5, 9, 10].map(|i| tall[(tall.len() - 1) * i / 10]));
    if let Some(cells) = rest.first().filter(|p| !p.is_empty()) {
        let eyes = read_view_cells(cells)?
            .cells
            .into_iter()
            .map(|cell| [0, 1, 2].map(|k| (cell.bounds.min[k] + cell.bounds.max[k]) / 2.0 * by));
        let eyes: Vec<_> = eyes.collect();
        let inside = eyes.iter().filter(|&&eye| found.cells.iter().any(|b| b.contains(eye))).count();
        println!("  {inside} of {} eyes in cells", eyes.len());
    }
    Ok(())
}

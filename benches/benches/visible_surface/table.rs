//! What a table of what is potentially visible saves the traversal of a BSP tree, front to back.

use sightlines::bake::{SceneBakeOptions, bake_scene};
use sightlines::scenes::{TowerOptions, tower, tower_rooms};
use sightlines::visible_surface::{
    BspOptions, Camera, FaceBsp, FaceMask, Faces, RenderInput, VisibleSurface, ZBuffer, cull,
};
use std::error::Error;
use std::time::Instant;

/// Prints fragments and times of a walk through a tower, with and without its table; both must show the same.
pub(crate) fn print(test: bool, size: [u32; 2]) -> Result<(), Box<dyn Error>> {
    let options = if test {
        TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() }
    } else {
        TowerOptions { floors: 2, ..TowerOptions::default() }
    };
    let scene = tower(options)?;
    let table = bake_scene(&scene, &SceneBakeOptions::default())?.table;
    let faces = Faces::of_scene(&scene)?;
    let start = Instant::now();
    let bsp = FaceBsp::build(&faces, &BspOptions::default()).front_to_back();
    let built = start.elapsed().as_secs_f64();
    let all = FaceMask::all(&faces);
    let (mut totals, mut n_eyes) = ([[0.0; 4]; 2], 0u32);
    for (k, room) in tower_rooms(options)?.iter().enumerate().step_by(if test { 1 } else { 5 }) {
        let b = room.bounds;
        let eye = [0, 1, 2].map(|i| b.min[i] + [0.43, 0.57, 0.51][i] * (b.max[i] - b.min[i]));
        if table.in_dimension().expect("it is of space").at(eye).is_outside() {
            // In a piece of furniture.
            continue;
        }
        let (sin, cos) = (k as f64).sin_cos();
        let camera = Camera::look_at(eye, [eye[0] + cos, eye[1] - 0.1, eye[2] + sin], [0.0, 1.0, 0.0], 60.0, size)?;
        let seen = table
            .in_dimension()
            .expect("it is of space")
            .at(eye)
            .inside()
            .map_or(Vec::new(), |at| at.visible_objects().iter().map(|o| o.0).collect());
        let mut chosen = all.clone();
        cull::objects(&faces, &mut chosen, |object| seen.binary_search(&object).is_ok());
        let mut images = Vec::new();
        for (total, chosen) in totals.iter_mut().zip([&all, &chosen]) {
            let shot = RenderInput { faces: &faces, camera: &camera, mask: chosen };
            let start = Instant::now();
            let (image, counters) = bsp.picture(&shot);
            total[0] += counters.fragments as f64;
            total[1] += counters.written as f64;
            total[2] += start.elapsed().as_secs_f64() * 1e3;
            let start = Instant::now();
            let other = ZBuffer::default().picture(&shot).0;
            total[3] += start.elapsed().as_secs_f64() * 1e3;
            images.extend([image, other]);
        }
        assert!(images.iter().all(|i| *i == images[0]), "the table hides nothing that is seen, and methods agree");
        n_eyes += 1;
    }
    assert!(totals[1][0] < totals[0][0], "with the table fewer fragments are drawn");
    println!(
        "\nA tower of {} triangles, {n_eyes} eyes in its rooms; means. The tree took {built:.2} s.\n",
        faces.len()
    );
    println!("| faces | BSP front to back: fragments | pixels | ms | z-buffer: ms |");
    println!("| --- | --: | --: | --: | --: |");
    for (name, total) in ["all", "those of the table"].iter().zip(totals) {
        let [fragments, written, bsp, z] = total.map(|x| x / f64::from(n_eyes));
        println!("| {name} | {fragments:.0} | {written:.0} | {bsp:.1} | {z:.1} |");
    }
    Ok(())
}

//! What each kind of culling leaves of a scene, and what hierarchical z adds: `hierarchical_z [FILE [EYE_X EYE_Y EYE_Z
//! AT_X AT_Y AT_Z]]`.
//!
//! Without a file a generated city is looked at from one of its streets. With a file and no eye, from the middle of the
//! scene along its longest side.

use sightlines_scenes::{CityOptions, city};
use sightlines_visible_surface::cull::{self, object_boxes};
use sightlines_visible_surface::hierarchical::{self, DepthPyramid, Neighbours};
use sightlines_visible_surface::{Camera, DepthFormat, FaceMask, Faces, RenderInput, VisibleSurface, ZBuffer};
use std::error::Error;
use std::time::Instant;

const SIZE: [u32; 2] = [640, 480];

fn timed<T>(what: &str, make: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let made = make();
    println!("{what:44} {:9.3} ms", start.elapsed().as_secs_f64() * 1e3);
    made
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let scene = match args.first() {
        Some(path) => sightlines_formats::scene::read_scene(path)?.scene,
        None => city(CityOptions::default())?,
    };
    let numbers = args.iter().skip(1).map(|x| x.parse()).collect::<Result<Vec<f64>, _>>()?;
    let faces = Faces::of_scene(&scene)?;
    let b = scene.bounds();
    // What is read and what is generated has y up.
    let up = 1;
    let (eye, at) = match numbers[..] {
        [a, b, c, d, e, f] => ([a, b, c], [d, e, f]),
        [] => {
            let middle = [0, 1, 2].map(|k| (b.min[k] + b.max[k]) / 2.0);
            let level = [0, 1, 2].into_iter().filter(|&k| k != up);
            let longest = level.max_by(|&i, &j| (b.max[i] - b.min[i]).total_cmp(&(b.max[j] - b.min[j]))).unwrap_or(0);
            let mut at = middle;
            at[longest] = b.max[longest];
            (middle, at)
        }
        _ => return Err("an eye and what it looks at are six numbers".into()),
    };
    let mut upwards = [0.0; 3];
    upwards[up] = 1.0;
    let camera = Camera::look_at(eye, at, upwards, 60.0, SIZE)?;
    println!("{} faces, {} objects, {SIZE:?} pixels", faces.len(), scene.objects().len());

    let all = FaceMask::all(&faces);
    let draw = |chosen: &FaceMask| {
        ZBuffer::new(DepthFormat::Exact).picture(&RenderInput { faces: &faces, camera: &camera, mask: chosen }).0
    };
    let picture = timed("z-buffer, all faces", || draw(&all));

    let mut kept = all.clone();
    let outside = timed("cull: outside of the view volume", || cull::frustum(&faces, &camera, &mut kept));
    let mut front = all.clone();
    let backs = timed("cull: back faces", || cull::backface(&faces, &camera, &mut front));
    println!("  {outside} faces outside, {backs} seen from the back");

    let neighbours = timed("faces that share edges, once for a scene", || Neighbours::of(&faces));
    let pyramids = [
        timed("pyramid from the picture", || DepthPyramid::sampled(&faces, &camera, &picture)),
        timed("pyramid from pixels that are covered wholly", || {
            DepthPyramid::with_neighbours(&faces, &neighbours, &camera, &kept)
        }),
    ];
    let boxes = object_boxes(&faces, &all);
    let visible: std::collections::BTreeSet<u32> =
        picture.faces().iter().filter(|&&f| (f as usize) < faces.len()).map(|&f| faces.object(f)).collect();
    let volume = cull::Frustum::of(&camera);
    let outside: Vec<bool> = boxes.iter().map(|b| volume.of_box(b) == cull::Cover::Outside).collect();
    let n_outside = outside.iter().filter(|o| **o).count();
    println!("  of {} objects {} are in the picture, {n_outside} boxes are outside", boxes.len(), visible.len());
    for pyramid in &pyramids {
        println!("{:?}:", pyramid.rays());
        let n_closed = pyramid.levels()[0].nearness().iter().filter(|&&w| w > 0.0).count();
        let hidden: Vec<bool> = timed("  all boxes of objects", || boxes.iter().map(|b| pyramid.hides(b)).collect());
        let hidden = hidden.iter().zip(&outside).filter(|(hidden, outside)| **hidden && !**outside).count();
        let mut left = kept.clone();
        let gone = timed("  boxes, then faces", || hierarchical::cull(&faces, &mut left, pyramid));
        let again = timed("  z-buffer, what is left", || draw(&left));
        println!(
            "  {n_closed} pixels closed, {hidden} more objects hidden, {gone} faces hidden of {}, {} left",
            kept.len(),
            left.len()
        );
        if again != picture {
            return Err("what was hidden was seen".into());
        }
    }
    Ok(())
}

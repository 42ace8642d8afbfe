//! What choices of planes make of a scene: splits, depth, and the time of building and of a walk.
//!
//! `cargo run --release -p sightlines-visible-surface --example bsp_order -- [SCENE | N]`: a glTF or OBJ file, or that many random triangles.

use sightlines_formats::scene::read_scene;
use sightlines_visible_surface::bsp::{BspOptions, FaceBsp, Heuristic};
use sightlines_visible_surface::schumacker::{Schumacker, SchumackerOptions};
use sightlines_visible_surface::{Camera, Counters, FaceMask, Faces, RenderInput, VisibleSurface};
use std::error::Error;
use std::time::Instant;

fn main() -> Result<(), Box<dyn Error>> {
    let of = std::env::args().nth(1).unwrap_or_else(|| "1000".to_owned());
    let faces = match of.parse() {
        Ok(n) => soup(n)?,
        Err(_) => Faces::of_scene(&read_scene(&of)?.scene)?,
    };
    let camera = overview(&faces)?;
    let chosen = FaceMask::all(&faces);
    let input = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    println!("{of}: {} faces", faces.len());
    let default = BspOptions::default();
    let mut all = vec![("weighted", default), ("only faces' planes", BspOptions { axis_above: usize::MAX, ..default })];
    if faces.len() <= 2000 {
        for (name, heuristic) in [
            ("first face", Heuristic::FirstFace),
            ("random", Heuristic::Random { seed: 1 }),
            ("fewest splits", Heuristic::FewestSplits),
            ("balanced", Heuristic::Balanced),
        ] {
            all.push((name, BspOptions { heuristic, axis_above: usize::MAX, ..default }));
        }
    } else if faces.len() > 200_000 {
        all.truncate(1);
    }
    for (name, options) in all {
        let start = Instant::now();
        let bsp = FaceBsp::build(&faces, &options);
        let built = start.elapsed();
        println!("  bsp, {name}: {:?}", bsp.stats());
        println!("    built in {built:.1?}; {}", walk(&bsp, &input));
        println!("    the nearest first: {}", walk(&bsp.front_to_back(), &input));
    }
    let start = Instant::now();
    let clusters = Schumacker::build(&faces, &SchumackerOptions::default());
    let built = start.elapsed();
    println!("  schumacker: {:?}", clusters.stats());
    println!("    built in {built:.1?}; {}", walk(&clusters, &input));
    Ok(())
}

fn walk(method: &dyn VisibleSurface, input: &RenderInput<'_>) -> String {
    let start = Instant::now();
    let _ = method.see(input, &mut Counters::default());
    let walked = start.elapsed();
    let start = Instant::now();
    let (_, counters) = method.picture(input);
    let drawn = start.elapsed();
    format!(
        "walked in {walked:.1?}; picture in {drawn:.1?}, {} fragments, overdraw {:.2}",
        counters.fragments,
        counters.overdraw()
    )
}

/// From a corner of the scene towards its middle.
fn overview(faces: &Faces) -> Result<Camera, Box<dyn Error>> {
    let points = || faces.corners().iter().flatten();
    let bound = |k: usize| points().fold([f64::INFINITY, f64::NEG_INFINITY], |b, p| [b[0].min(p[k]), b[1].max(p[k])]);
    let bounds = [0, 1, 2].map(bound);
    let at = |share: f64| bounds.map(|[low, high]| low + share * (high - low));
    Ok(Camera::look_at(at(0.3), at(0.7), [0.0, 1.0, 0.0], 60.0, [640, 480])?)
}

/// Triangles in a cube of 1024 units, smaller the more there are, so that they cross each other as often whatever their number.
fn soup(n: usize) -> Result<Faces, Box<dyn Error>> {
    let size = 1024.0 / (n.max(1) as f64).cbrt();
    let mut state = 1u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1u32 << 24)
    };
    let corners = (0..n).map(|_| {
        let at = [random(), random(), random()].map(|x| x * 1024.0);
        [0; 3].map(|_| at.map(|x| x + (2.0 * random() - 1.0) * size))
    });
    Ok(Faces::new(corners.collect())?)
}

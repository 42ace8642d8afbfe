//! Generated and real scenes: culling changes no picture, and takes away most of what is not in it.

use crate::culling::oracle::Chance;
use sightlines_cells::Scene;
use sightlines_formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines_scenes::{CityOptions, city};
use sightlines_visible_surface::hierarchical::{self, DepthPyramid, Neighbours};
use sightlines_visible_surface::{Camera, DepthFormat, FaceMask, Faces, RenderInput, VisibleSurface, ZBuffer, cull};
use std::path::PathBuf;

/// Faces in all, in the pictures, outside, hidden from centres, hidden from all rays; of some eyes.
fn counts(scene: &Scene, n_eyes: usize) -> [u64; 5] {
    let faces = Faces::of_scene(scene).unwrap();
    let neighbours = Neighbours::of(&faces);
    let b = scene.bounds();
    let mut chance = Chance(17);
    let mut place = |height: f64| {
        let part = [0; 3].map(|_| chance.below(1000) as f64 / 1000.0);
        [0, 1, 2].map(|k| b.min[k] + (b.max[k] - b.min[k]) * if k == 1 { height * part[k] } else { part[k] })
    };
    let mut sums = [0; 5];
    for _ in 0..n_eyes {
        let (eye, at) = (place(0.3), place(0.3));
        let camera = Camera::look_at(eye, at, [0.0, 1.0, 0.0], 60.0, [200, 150]).expect("it does not look up");
        let all = FaceMask::all(&faces);
        let draw = |chosen: &FaceMask| {
            ZBuffer::new(DepthFormat::Exact).picture(&RenderInput { faces: &faces, camera: &camera, mask: chosen }).0
        };
        let picture = draw(&all);
        let mut seen = picture.faces().to_vec();
        seen.sort_unstable();
        seen.dedup();
        let mut inside = all.clone();
        let outside = cull::frustum(&faces, &camera, &mut inside);
        assert_eq!(draw(&inside), picture, "{eye:?} {at:?}");
        let hidden = [
            DepthPyramid::sampled(&faces, &camera, &picture),
            DepthPyramid::with_neighbours(&faces, &neighbours, &camera, &inside),
        ]
        .map(|pyramid| {
            let mut left = inside.clone();
            let gone = hierarchical::cull(&faces, &mut left, &pyramid);
            assert_eq!(draw(&left), picture, "{:?} {eye:?} {at:?}", pyramid.rays());
            gone
        });
        let new = [all.len() as u64, seen.len() as u64 - 1, outside, hidden[0], hidden[1]];
        sums = [0, 1, 2, 3, 4].map(|k| sums[k] + new[k]);
    }
    sums
}

#[test]
fn a_city_from_its_streets() {
    let scene = city(CityOptions::default()).unwrap();
    let [all, seen, outside, hidden, surely] = counts(&scene, 6);
    eprintln!("city: {all} faces, {seen} seen, {outside} outside, {hidden} and {surely} hidden");
    // Most of what is inside of the view volume is hidden; and most of that is hidden from all rays.
    assert!(seen > 0 && (all - outside - seen) * 6 < hidden * 10, "{seen} {outside} {hidden} of {all}");
    assert!(surely * 2 > hidden, "{surely} of {hidden}");
}

#[test]
fn real_scenes_from_within() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA").map(PathBuf::from) else {
        eprintln!("SKIPPED real_scenes_from_within: SIGHTLINES_DATA is not set");
        return;
    };
    for name in ["sponza", "duplex", "delft"] {
        let path = data.join(format!("scenes/{name}/{name}.glb"));
        let scene = read_scene_with(&path, &SceneReadOptions::with_backs(BackFaces::Drawn))
            .unwrap_or_else(|e| panic!("{e}"))
            .scene;
        let [all, seen, outside, hidden, surely] = counts(&scene, 4);
        eprintln!("{name}: {all} faces, {seen} seen, {outside} outside, {hidden} and {surely} hidden");
        assert!(seen > 0 && outside > 0 && hidden > 0 && surely > 0);
    }
}

//! A real building.

use crate::check::check;
use crate::common::{triangles_of, volume};
use sightlines_area_light::{LightOptions, Shadows, Sides, shown};
use sightlines_formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines_geometry::Point3;
use sightlines_multifocal::mesh::SheetMethod;
use sightlines_visible_surface::{Camera, DepthFormat, FaceMask, Faces, RenderInput, VisibleSurface, ZBuffer};
use std::path::PathBuf;

/// The folder of real scenes; says loudly that a test skips without it.
fn scenes(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("SIGHTLINES_DATA").map(|data| PathBuf::from(data).join("scenes"));
    if folder.is_none() {
        eprintln!("SKIPPED {test}: SIGHTLINES_DATA is not set");
    }
    folder
}

/// Invariant: no ray of thousands contradicts the classification of an atrium under a panel, and a good part is
/// decided. `scenes` does the same with generated rooms.
#[test]
fn an_atrium_is_right() {
    let Some(folder) = scenes("an_atrium_is_right") else { return };
    let scene = read_scene_with(folder.join("sponza/sponza.glb"), &SceneReadOptions::with_backs(BackFaces::Drawn))
        .unwrap()
        .scene;
    let triangles = triangles_of(&scene);
    let faces = Faces::new(triangles.clone()).unwrap();
    let bounds = scene.bounds();
    println!("{} triangles in {bounds:?}", triangles.len());
    let middle: Point3 = std::array::from_fn(|k| (bounds.min[k] + bounds.max[k]) / 2.0);
    let light = volume(
        [middle[0] - 1.0, middle[1] + 1.0, middle[2] - 0.5],
        [middle[0] + 1.0, middle[1] + 1.0, middle[2] + 0.5],
    );
    let eye = [middle[0] - 6.0, middle[1] - 2.0, middle[2]];
    let mut method = SheetMethod::new(&triangles);

    let shadows = Shadows::new(&faces);
    let mut chosen = FaceMask::all(&faces);
    chosen.retain(|f| f % 40 == 0);
    let start = std::time::Instant::now();
    let options = LightOptions { max_depth: 3, sides: Sides::Both, ..LightOptions::default() };
    let lighting = shadows.classify(&chosen, &light, &mut method, &options).unwrap();
    let areas = *lighting.areas();
    println!("{:?}: {} pieces, {areas:?}, {:?}", start.elapsed(), lighting.pieces().len(), lighting.counters());
    let checked = check(&triangles, &lighting, 2, 3);
    assert!(checked.is_right(), "{checked:?}");
    assert!(checked.n_umbra > 4000 && checked.n_lit > 1000, "{} {}", checked.n_umbra, checked.n_lit);
    assert!(areas.umbra > 0.2 * areas.total() && areas.in_doubt < 0.7 * areas.total());

    let camera = Camera::look_at(eye, [middle[0], middle[1] - 3.0, middle[2]], [0., 1., 0.], 70.0, [96, 72]).unwrap();
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &FaceMask::all(&faces) };
    let image = ZBuffer::new(DepthFormat::Exact).picture(&shot).0;
    let options = LightOptions { max_depth: 6, min_size: 0.05, sides: Sides::Towards(eye) };
    let start = std::time::Instant::now();
    let lighting = shadows.classify(&shown(&faces, &image), &light, &mut method, &options).unwrap();
    println!(
        "{:?}: {} pieces, {:?}, {:?}",
        start.elapsed(),
        lighting.pieces().len(),
        lighting.areas(),
        lighting.counters()
    );
    assert!(check(&triangles, &lighting, 1, 4).is_right());
    let picture = shadows.picture(&lighting, &camera, &image, 16);
    println!("umbra, lit, traced {:?}; {} of {} rays", picture.counts(), picture.n_rays, picture.n_rays_else);
    let traced = shadows.traced(&light, &camera, &image, 16);
    // Rays in doubles against what is proven: all of a pixel's rays, but for one of a thousand pixels.
    let differ = picture.shades.iter().zip(&traced.shades).filter(|(a, b)| a.share() != b.share()).count();
    assert!(differ * 1000 <= picture.shades.len(), "{differ}");
    assert!(picture.n_rays < picture.n_rays_else);
}

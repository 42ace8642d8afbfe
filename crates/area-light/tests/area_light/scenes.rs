//! Generated scenes: a city, rooms, surfaces that are hard to tell apart, blocks over a floor.

use crate::check::{check, covers};
use crate::common::{Triangle, classify, cuboid, floor, method, multifocal, triangles_of, volume};
use sightlines_area_light::{LightOptions, Sides};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::Volume;
use sightlines_scenes::{
    CityOptions, SurfaceOptions, TowerOptions, city, city_crossings, slivers, soup, tower, tower_rooms,
};
use sightlines_visible_surface::Faces;

/// Shares of the area in umbra, lit, in doubt, after checking with rays.
fn shares(name: &str, triangles: &[Triangle], light: &Volume, options: &LightOptions, n_rays: u32) -> [f64; 3] {
    let faces = Faces::new(triangles.to_vec()).unwrap();
    let start = std::time::Instant::now();
    let lighting = classify(&faces, light, &mut method(triangles), options);
    let time = start.elapsed();
    let checked = check(triangles, &lighting, n_rays, 11);
    assert!(checked.is_right(), "{name}: {checked:?}");
    assert!(covers(triangles, &lighting), "{name}");
    let areas = lighting.areas();
    let shares = [areas.umbra, areas.lit, areas.in_doubt].map(|a| a / areas.total());
    println!(
        "{name}: {} triangles, {} pieces, umbra, lit, in doubt {shares:.3?} (mixed {:.3}) in {time:.2?}, {:?}; rays {} and {}",
        triangles.len(),
        lighting.pieces().len(),
        areas.mixed / areas.total(),
        lighting.counters(),
        checked.n_umbra,
        checked.n_lit
    );
    assert!(checked.n_umbra > 0 && checked.n_lit > 0, "{name}");
    shares
}

fn front(max_depth: u32) -> LightOptions {
    LightOptions { max_depth, sides: Sides::Front, ..LightOptions::default() }
}

#[test]
fn a_city_at_a_crossing() {
    let options = CityOptions { blocks_x: 2, blocks_z: 2, ..CityOptions::default() };
    let triangles = triangles_of(&city(options).unwrap());
    let b = city_crossings(options).unwrap()[0];
    let middle: Point3 = std::array::from_fn(|k| (b.min[k] + b.max[k]) / 2.0);
    // A street lamp, and a large panel above the roofs.
    let lamp = volume(middle.map(|x| x - 0.25), middle.map(|x| x + 0.25));
    let [umbra, lit, in_doubt] = shares("lamp", &triangles, &lamp, &front(2), 1);
    assert!(umbra > 0.5 && lit > 0.05 && in_doubt < 0.25);
    let panel = volume([middle[0] - 8.0, 90.0, middle[2] - 8.0], [middle[0] + 8.0, 90.0, middle[2] + 8.0]);
    let [umbra, lit, in_doubt] = shares("panel", &triangles, &panel, &front(3), 1);
    assert!(umbra > 0.2 && lit > 0.1 && in_doubt < 0.3);
}

#[test]
fn furnished_rooms() {
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let triangles = triangles_of(&tower(options).unwrap());
    let Aabb { min, max } = tower_rooms(options).unwrap()[0].bounds;
    // A lamp that is flush with the ceiling, beside the one that hangs from its middle.
    let middle = [0, 2].map(|k| min[k] + (max[k] - min[k]) / 4.0);
    let lamp = volume([middle[0] - 0.5, max[1], middle[1] - 0.25], [middle[0] + 0.5, max[1], middle[1] + 0.25]);
    let [umbra, lit, in_doubt] = shares("room", &triangles, &lamp, &front(5), 1);
    assert!(umbra > 0.5 && lit > 0.01 && in_doubt < 0.3);
}

#[test]
fn soups_and_slivers() {
    let options = SurfaceOptions { seed: 5, triangles: 150, layers: 2 };
    // Where the eye is for which they are hard to draw.
    let light = volume([-1.0, -1.0, -1.0], [1.0, 1.0, 0.0]);
    for (name, scene) in [("soup", soup(options)), ("slivers", slivers(options))] {
        let triangles = triangles_of(&scene.unwrap());
        let options = LightOptions { max_depth: 5, ..LightOptions::default() };
        let [umbra, lit, _] = shares(name, &triangles, &light, &options, 2);
        assert!(umbra > 0.1 && lit > 0.02, "{name}");
    }
}

#[test]
fn blocks_over_a_floor() {
    let blocks = [[-4.0, -4.0], [-4.0, 3.0], [0.0, -1.0], [3.0, 1.0], [2.0, -5.0]];
    let mut triangles = floor(9.0);
    for (i, [x, y]) in blocks.into_iter().enumerate() {
        let low = [0.0, 0.5, 1.0][i % 3];
        triangles.extend(cuboid([x, y, low], [x + 1.7, y + 1.3, low + 1.1 + 0.3 * i as f64]));
    }
    let light = volume([-1.3, -1.1, 7.0], [0.9, 1.4, 7.5]);
    let mut last = 1.0;
    for depth in [4, 8, 12] {
        let [.., in_doubt] = shares("blocks", &triangles, &light, &front(depth), 2);
        assert!(in_doubt < last);
        last = in_doubt;
    }
    assert!(last < 0.3);
    // Buffers, whose texels round: they are right as well. `closed_form` measures how much they find.
    let faces = Faces::new(triangles.clone()).unwrap();
    let lighting = classify(&faces, &light, &mut multifocal(&triangles), &front(9));
    let checked = check(&triangles, &lighting, 2, 12);
    assert!(checked.is_right() && checked.n_umbra > 0, "{checked:?}");
}

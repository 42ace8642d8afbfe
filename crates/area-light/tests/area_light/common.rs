//! Scenes and methods.

use sightlines_area_light::{LightOptions, Lighting, Shadows};
use sightlines_cells::{Scene, SceneObject};
use sightlines_from_region::ViewShafts;
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::mesh::{PatchOptions, SheetMethod, patches};
use sightlines_multifocal::{FromRegion, Layout, Multifocal, OccluderSelection, UnionMethod, Volume};
use sightlines_multifocal_cpu::Fast;
use sightlines_visible_surface::{FaceMask, Faces};
use std::sync::Arc;

pub(crate) type Triangle = [Point3; 3];

pub(crate) fn volume(min: Point3, max: Point3) -> Volume {
    Volume::new(Aabb { min, max }).expect("a box")
}

/// A closed box that faces outwards.
pub(crate) fn cuboid(min: Point3, max: Point3) -> Vec<Triangle> {
    let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }) };
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    sides.iter().flat_map(|&s| quad(s.map(corner))).collect()
}

pub(crate) fn quad([a, b, c, d]: [Point3; 4]) -> Vec<Triangle> {
    vec![[a, b, c], [a, c, d]]
}

/// A square floor at height 0 that faces up.
pub(crate) fn floor(half: f64) -> Vec<Triangle> {
    quad([[-half, -half, 0.0], [half, -half, 0.0], [half, half, 0.0], [-half, half, 0.0]])
}

pub(crate) fn triangles_of(scene: &Scene) -> Vec<Triangle> {
    scene.objects().iter().flat_map(|o| o.corners()).collect()
}

/// Triangles as one object.
pub(crate) fn scene_of(triangles: &[Triangle]) -> Scene {
    let vertices: Vec<Point3> = triangles.iter().flatten().copied().collect();
    let triangles = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Scene::new(vec![SceneObject { name: "all".to_owned(), vertices, triangles }]).expect("sound triangles")
}

pub(crate) fn shafts(triangles: &[Triangle]) -> ViewShafts {
    ViewShafts::new(patches(triangles, &PatchOptions::default()))
}

pub(crate) fn multifocal(triangles: &[Triangle]) -> Multifocal<Fast> {
    let occluders = Arc::new(OccluderSelection::new(patches(triangles, &PatchOptions::default()), 256));
    let bounds = Aabb::around(triangles.iter().flatten().copied());
    Multifocal::new(Fast::new(), occluders, bounds, Layout::default())
}

/// Shafts and sheets.
pub(crate) fn method(triangles: &[Triangle]) -> UnionMethod {
    UnionMethod::for_polygons(vec![Box::new(shafts(triangles)), Box::new(SheetMethod::new(triangles))])
}

/// All faces.
pub(crate) fn classify(faces: &Faces, light: &Volume, method: &mut dyn FromRegion, options: &LightOptions) -> Lighting {
    Shadows::new(faces).classify(&FaceMask::all(faces), light, method, options).expect("no device is needed")
}

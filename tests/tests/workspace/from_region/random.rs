//! Soundness on random scenes: nothing that is called hidden is reached by a ray.

use crate::from_region::common::{buffers, hidden, shipped, triangles};
use proptest::prelude::*;
use sightlines::cells::{Scene, SceneObject};
use sightlines::from_region::{ViewShafts, VoxelOptions, Voxels};
use sightlines::geometry::{Aabb, Point3};
use sightlines::multifocal::mesh::{PatchOptions, SheetMethod, patches};
use sightlines::multifocal::{FromRegion, Layout, Measure};
use sightlines_testkit::from_region::sampled_view;

const BOX: [[u32; 3]; 12] = [
    [0, 2, 1],
    [1, 2, 3],
    [4, 5, 6],
    [5, 7, 6],
    [0, 1, 4],
    [1, 5, 4],
    [2, 6, 3],
    [3, 6, 7],
    [0, 4, 2],
    [2, 4, 6],
    [1, 3, 5],
    [3, 7, 5],
];

fn corner(b: &Aabb<3>, i: usize) -> Point3 {
    std::array::from_fn(|k| if i >> k & 1 == 0 { b.min[k] } else { b.max[k] })
}

/// Boxes and single triangles on a small grid, so that they touch, overlap and lie in one plane often.
fn scene() -> impl Strategy<Value = Scene> {
    let point = || [-6i32..7, -6i32..7, -6i32..7].prop_map(|p| p.map(f64::from));
    let cuboid = (point(), [0i32..6, 0i32..6, 0i32..6]).prop_map(|(min, size)| {
        let b = Aabb { min, max: std::array::from_fn(|k| min[k] + f64::from(size[k])) };
        ((0..8).map(|i| corner(&b, i)).collect::<Vec<_>>(), BOX.to_vec())
    });
    let triangle = [point(), point(), point()].prop_map(|t| (t.to_vec(), vec![[0, 1, 2]]));
    let quad = (point(), [-5i32..6, -5i32..6, -5i32..6], [-5i32..6, -5i32..6, -5i32..6]).prop_map(|(o, u, v)| {
        let at = |s: f64, t: f64| std::array::from_fn(|k| o[k] + s * f64::from(u[k]) + t * f64::from(v[k]));
        (vec![at(0., 0.), at(1., 0.), at(1., 1.), at(0., 1.)], vec![[0, 1, 2], [0, 2, 3]])
    });
    let one = prop_oneof![3 => cuboid, 1 => triangle, 3 => quad];
    prop::collection::vec(one, 1..8).prop_map(|meshes| {
        let object = |(i, (vertices, triangles)): (usize, (Vec<Point3>, Vec<[u32; 3]>))| SceneObject {
            name: i.to_string(),
            vertices,
            triangles,
        };
        Scene::new(meshes.into_iter().enumerate().map(object).collect()).expect("small numbers")
    })
}

fn small_box() -> impl Strategy<Value = Aabb<3>> {
    ([-8i32..8, -8i32..8, -8i32..8], [0i32..3, 0i32..3, 0i32..3]).prop_map(|(min, size)| {
        let min = min.map(f64::from);
        Aabb { min, max: std::array::from_fn(|k| min[k] + f64::from(size[k]) * 0.5) }
    })
}

/// Far away, scaled, and as it is.
fn moved(scene: &Scene, boxes: &mut [Aabb<3>], by: f64, scale: f64) -> Scene {
    let place = |p: Point3| p.map(|x| (x * scale) + by);
    boxes.iter_mut().for_each(|b| *b = Aabb { min: place(b.min), max: place(b.max) });
    let objects = scene.objects().iter().map(|o| {
        let vertices = o.vertices.iter().map(|&p| place(p)).collect();
        SceneObject { vertices, ..o.clone() }
    });
    Scene::new(objects.collect()).expect("good numbers")
}

fn methods(scene: &Scene, around: Aabb<3>) -> Vec<Box<dyn FromRegion>> {
    let all = triangles(scene);
    let mut methods: Vec<Box<dyn FromRegion>> = Vec::new();
    for measure in [Measure::Euclid, Measure::VertexHeight, Measure::SectionHeight] {
        for planes in [1, 4] {
            for carry in [false, true] {
                if measure.is_height() || !carry {
                    let layout = Layout { planes, texels: 16, measure, carry, ..Layout::default() };
                    methods.push(Box::new(buffers(&all, around, layout)));
                }
            }
        }
    }
    methods.push(Box::new(SheetMethod::new(&all)));
    methods.push(Box::new(shipped(&all, around)));
    methods.push(Box::new(ViewShafts::new(patches(&all, &PatchOptions::default()))));
    let options = VoxelOptions { n_longest: 16, ..VoxelOptions::default() };
    methods.push(Box::new(Voxels::new(scene, options).expect("few voxels")));
    methods
}

proptest! {
    /// Invariant: what any method calls hidden from a volume, no ray from there reaches.
    #[test]
    fn hidden_is_hidden_from_the_whole_volume(
        scene in scene(),
        volume in small_box(),
        targets in prop::collection::vec(small_box(), 1..9),
        place in prop::sample::select(vec![(0.0, 1.0), (1e6, 1.0), (-3.7e5, 0.01), (0.1, 1.0 / 3.0)]),
        seed in any::<u64>(),
    ) {
        let mut boxes = targets;
        boxes.push(volume);
        let scene = moved(&scene, &mut boxes, place.0, place.1);
        let volume = boxes.pop().expect("it was put there");
        let around = crate::from_region::common::around(&scene, &boxes);
        let mut seen = None;
        for mut method in methods(&scene, around) {
            let hidden = hidden(&mut *method, &volume, &boxes);
            if hidden.is_empty() {
                continue;
            }
            let seen = seen.get_or_insert_with(|| sampled_view(&scene, &volume, &boxes, 8_000, seed));
            let wrong = seen.refuted(hidden);
            prop_assert!(wrong.is_empty(), "{} is wrong: {wrong:?}", method.name());
        }
    }
}

/// The twin: methods do find something on these scenes.
#[test]
fn random_scenes_hide_something_from_every_method() {
    let drawn = sightlines_testkit::draw(&(scene(), small_box(), prop::collection::vec(small_box(), 12)), 60);
    let mut found = std::collections::BTreeMap::<String, usize>::new();
    for (scene, volume, targets) in drawn {
        for mut method in methods(&scene, crate::from_region::common::around(&scene, &targets)) {
            *found.entry(method.name()).or_default() += hidden(&mut *method, &volume, &targets).len();
        }
    }
    println!("{found:?}");
    // Voxels of a sixteenth of the scene fit into few of these things.
    assert!(found.iter().all(|(name, &n)| n > 0 || name.contains("voxels")), "{found:?}");
}

/// An impostor: a method that takes the union of two umbrae for one is caught by the same rays.
#[test]
fn impostor_that_calls_all_behind_something_hidden_is_caught() {
    let drawn = sightlines_testkit::draw(&(scene(), small_box(), prop::collection::vec(small_box(), 12)), 40);
    let mut caught = 0;
    for (scene, volume, targets) in drawn {
        let rays = sightlines_testkit::RayScene::new(&scene);
        // From the middle of the volume alone.
        let eye: Point3 = std::array::from_fn(|k| (volume.min[k] + volume.max[k]) / 2.0);
        let behind = |b: &Aabb<3>| {
            (0..8).all(|i| {
                let to = corner(b, i);
                let way: Point3 = std::array::from_fn(|k| to[k] - eye[k]);
                let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
                length > 0.0 && rays.first_hit(eye, way.map(|x| x / length)).is_some_and(|hit| hit.t < length)
            })
        };
        let hidden: Vec<usize> = (0..targets.len()).filter(|&i| behind(&targets[i])).collect();
        caught += sampled_view(&scene, &volume, &targets, 20_000, 5).refuted(hidden).len();
    }
    assert!(caught > 3, "{caught}");
}

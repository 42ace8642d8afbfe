//! Methods of visible-surface determination against the ray caster, pixel by pixel: on generated scenes that each method does badly on, and on
//! real ones.

use sightlines::cells::Scene;
use sightlines::formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines::geometry::Point3;
use sightlines::scenes::surfaces::{self, DepthPairsOptions, SurfaceOptions};
use sightlines::scenes::{TowerOptions, tower};
use sightlines::visible_surface::{
    BspOptions, Camera, DepthFormat, FaceBsp, FaceMask, Faces, Image, Newell, Painter, RayCaster, RenderInput,
    Schumacker, SchumackerOptions, VisibleSurface, ZBuffer, compare, cull,
};
use sightlines_tests::data_folder;

/// What was compared.
#[derive(Debug, Default)]
struct Tally {
    pictures: u64,
    covered: u64,
    ties: u64,
}

/// All methods that promise to show what is seen.
fn exact_methods(faces: &Faces) -> Vec<Box<dyn VisibleSurface>> {
    let bsp = FaceBsp::build(faces, &BspOptions::default());
    vec![
        Box::new(ZBuffer::new(DepthFormat::Exact)),
        Box::new(Newell),
        Box::new(bsp.clone()),
        Box::new(bsp.front_to_back()),
        Box::new(Schumacker::build(faces, &SchumackerOptions::default())),
    ]
}

/// Every exact method, from each eye, as the ray caster; of all faces, and of those in the view that face the eye, where back faces may go.
fn agree(name: &str, faces: &Faces, cameras: &[Camera], tally: &mut Tally) {
    let (methods, caster) = (exact_methods(faces), RayCaster::build(faces));
    for camera in cameras {
        let all = FaceMask::all(faces);
        let mut in_view = all.clone();
        cull::frustum(faces, camera, &mut in_view);
        let shot = RenderInput { faces, camera, mask: &all };
        let reference = caster.picture(&shot).0;
        let culled = RenderInput { mask: &in_view, ..shot };
        assert_eq!(caster.picture(&culled).0, reference, "{name}: what is outside the view is not seen");
        for method in &methods {
            let found = compare(&shot, &reference, &method.picture(&culled).0);
            assert!(found.wrong.is_empty(), "{name}: {} is wrong at {:?} of {camera:?}", method.name(), found.wrong);
            tally.ties += found.ties;
            tally.pictures += 1;
            tally.covered += reference.n_covered();
        }
    }
}

fn generated_eye(size: [u32; 2]) -> Camera {
    Camera::look_at(surfaces::EYE, surfaces::AT, surfaces::UP, surfaces::ANGLE, size).unwrap()
}

fn generated(n: u32, seed: u64) -> Vec<(&'static str, Scene)> {
    let options = SurfaceOptions { seed, triangles: n, ..SurfaceOptions::default() };
    vec![
        ("soup", surfaces::soup(options).unwrap()),
        ("cycles", surfaces::cycles(n).unwrap()),
        ("lattice", surfaces::lattice(n / 2).unwrap()),
        ("split_worst", surfaces::split_worst(n / 2).unwrap()),
        ("coplanar", surfaces::coplanar(options).unwrap()),
        ("slivers", surfaces::slivers(options).unwrap()),
        ("interleaved", surfaces::interleaved(n).unwrap()),
        ("depth_pairs", surfaces::depth_pairs(DepthPairsOptions::default()).unwrap()),
    ]
}

/// From where scenes are looked at: the place they are made for, between the faces, and with a face's plane through the eye.
fn eyes(faces: &Faces, size: [u32; 2]) -> Vec<Camera> {
    let look = |eye: Point3, at: Point3| Camera::look_at(eye, at, [0.0, 1.0, 0.0], 75.0, size);
    let mean = |t: &[Point3; 3]| [0, 1, 2].map(|k| (t[0][k] + t[1][k] + t[2][k]) / 3.0);
    let [first, last] = [faces.of(0), faces.of(faces.len() as u32 - 1)];
    // A corner of a face, the middle of its longest side as far as rounding goes, and from behind it all.
    let [corner, middle] = [first[0], [0, 1, 2].map(|k| (last[0][k] + last[1][k]) / 2.0)];
    let others = [look(corner, mean(last)), look(middle, mean(first)), look(mean(last), surfaces::EYE)];
    std::iter::once(generated_eye(size)).chain(others.into_iter().flatten()).collect()
}

#[test]
fn methods_agree_on_generated_scenes() {
    let mut tally = Tally::default();
    for seed in 1..4 {
        for (name, scene) in generated(80, seed) {
            let faces = Faces::of_scene(&scene).unwrap();
            agree(name, &faces, &eyes(&faces, [41, 31]), &mut tally);
        }
    }
    let options = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 1, ..TowerOptions::default() };
    let faces = Faces::of_scene(&tower(options).unwrap()).unwrap();
    let eyes: Vec<Camera> = [([1.5, 1.6, 1.5], [3.0, 1.0, 2.5]), ([9.0, 1.7, 5.0], [1.0, 1.5, 1.0])]
        .into_iter()
        .map(|(eye, at)| Camera::look_at(eye, at, [0.0, 1.0, 0.0], 70.0, [96, 64]).unwrap())
        .collect();
    agree("tower", &faces, &eyes, &mut tally);
    assert!(tally.pictures > 400 && tally.covered > 200_000, "{tally:?}");
    // What is left out is nearly nothing, or the comparison would say nothing.
    assert!(tally.ties * 100 < tally.covered, "{tally:?}");
}

#[test]
fn methods_agree_on_real_scenes() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    let mut tally = Tally::default();
    for name in ["whale_tall", "duplex", "whale_large", "delft", "office_a", "pandora", "sponza"] {
        let file = data.join("scenes").join(name).join(format!("{name}.glb"));
        let scene = read_scene_with(&file, &SceneReadOptions::with_backs(BackFaces::Drawn)).unwrap().scene;
        let faces = Faces::of_scene(&scene).unwrap();
        let b = scene.bounds();
        let at = |part: [f64; 3]| [0, 1, 2].map(|k| b.min[k] + part[k] * (b.max[k] - b.min[k]));
        // Inside, in the exact middle, and from outside.
        let cameras: Vec<Camera> = [
            ([0.31, 0.37, 0.43], [0.83, 0.29, 0.71]),
            ([0.5, 0.5, 0.5], [1.0, 0.5, 0.5]),
            ([-0.3, 1.2, -0.4], [0.5, 0.4, 0.5]),
        ]
        .into_iter()
        .map(|(eye, to)| Camera::look_at(at(eye), at(to), [0.0, 1.0, 0.0], 70.0, [160, 120]).unwrap())
        .collect();
        agree(name, &faces, &cameras, &mut tally);
    }
    assert!(tally.pictures == 7 * 3 * 5 && tally.covered > 500_000, "{tally:?}");
    assert!(tally.ties * 100 < tally.covered, "{tally:?}");
}

/// The scene with a million faces, by the methods that need no tree of planes.
#[test]
fn methods_agree_on_a_million_faces() {
    let Some(data) = data_folder("SIGHTLINES_DATA") else { return };
    let scene = read_scene_with(data.join("scenes/castle/castle.glb"), &SceneReadOptions::with_backs(BackFaces::Drawn))
        .unwrap()
        .scene;
    let faces = Faces::of_scene(&scene).unwrap();
    let b = scene.bounds();
    let at = |part: [f64; 3]| [0, 1, 2].map(|k| b.min[k] + part[k] * (b.max[k] - b.min[k]));
    let camera = Camera::look_at(at([0.3, 0.4, 0.4]), at([0.8, 0.2, 0.7]), [0.0, 1.0, 0.0], 70.0, [160, 120]).unwrap();
    let chosen = FaceMask::all(&faces);
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let reference = RayCaster::build(&faces).picture(&shot).0;
    assert!(reference.n_covered() > 1000);
    let found = compare(&shot, &reference, &ZBuffer::default().picture(&shot).0);
    assert!(found.wrong.is_empty(), "{found:?}");
}

fn wrong(scene: &Scene, method: &dyn VisibleSurface) -> usize {
    let (faces, camera) = (Faces::of_scene(scene).unwrap(), generated_eye([480, 360]));
    let chosen = FaceMask::all(&faces);
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let reference: Image = RayCaster::build(&faces).picture(&shot).0;
    compare(&shot, &reference, &method.picture(&shot).0).wrong.len()
}

/// The painter shows what is hidden where mid-points mislead, and where fragments hide each other in a circle; Newell mends both.
#[test]
fn the_painter_errs_where_it_must() {
    for scene in [surfaces::cycles(30).unwrap(), surfaces::interleaved(30).unwrap()] {
        let n = wrong(&scene, &Painter);
        assert!(n > 50, "{n}");
        assert_eq!(wrong(&scene, &Newell), 0);
    }
}

/// Depths from 0 to 1 in few bits cannot tell what is far away; reversed floats tell most of it, and exact ones all.
#[test]
fn depths_err_by_their_precision() {
    let scene = surfaces::depth_pairs(DepthPairsOptions::default()).unwrap();
    let faces = Faces::of_scene(&scene).unwrap();
    let camera = generated_eye([160, 120]).with_depths(1.0 / 256.0, 8192.0).unwrap();
    let chosen = FaceMask::all(&faces);
    let shot = RenderInput { faces: &faces, camera: &camera, mask: &chosen };
    let reference = RayCaster::build(&faces).picture(&shot).0;
    let wrong = DepthFormat::ALL.map(|f| compare(&shot, &reference, &ZBuffer::new(f).picture(&shot).0).wrong.len());
    let [exact, double, f32, reversed, u24] = wrong;
    assert!(exact == 0 && double <= reversed && reversed * 4 < f32 && reversed * 4 < u24, "{wrong:?}");
}

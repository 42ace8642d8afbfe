//! Pictures before and after: a ray caster that shares no code with what decides shows the same in every pixel, from eyes that were not used to decide; from outside, in
//! boxes and where eyes walk. `SIGHTLINES_PICTURES` is how many pictures are taken of each scene.

use sightlines_cells::{Scene, SceneObject};
use sightlines_formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines_geometry::vector::{cross, length, sub};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_multifocal::Volume;
use sightlines_scenes::{GearboxOptions, Pipe, cupboard, gearbox, nested_voids};
use sightlines_strip::{Eyes, Fate, Grain, LineEffort, StripOptions, Stripped, strip};
use sightlines_testkit::meshes;
use sightlines_visible_surface::{Camera, FaceMask, Faces, RayCaster, RenderInput, VisibleSurface, compare};

/// Width and height of a picture.
const SIZE: [u32; 2] = [48, 48];

fn n_pictures(standard: usize) -> usize {
    let Ok(text) = std::env::var("SIGHTLINES_PICTURES") else { return standard };
    text.parse().unwrap_or_else(|_| panic!("SIGHTLINES_PICTURES is no number: {text}"))
}

/// Takes pictures of a scene, of all or of what is left.
struct Studio<'a> {
    scene: &'a Scene,
    faces: Faces,
    caster: RayCaster,
    /// The object of each face, and its place among the triangles of that.
    places: Vec<(u32, usize)>,
}

impl<'a> Studio<'a> {
    fn new(scene: &'a Scene) -> Self {
        let faces = Faces::of_scene(scene).expect("few faces");
        let of =
            |(k, object): (u32, &SceneObject)| (0..object.triangles.len()).map(move |t| (k, t)).collect::<Vec<_>>();
        let places = (0..).zip(scene.objects()).flat_map(of).collect();
        Self { scene, caster: RayCaster::build(&faces), faces, places }
    }

    /// How many pixels differ if faces are gone, from these eyes towards these points; and how many show something.
    fn judge(&self, views: &[[Point3; 2]], is_gone: impl Fn(u32, usize) -> bool) -> (usize, u64) {
        let (mut n_wrong, mut n_shown) = (0, 0);
        // What lets light through is seen, and hides nothing: the scene with it and without it.
        let with = [true, false].into_iter().take(1 + usize::from(!self.scene.see_through().is_empty()));
        for (with, [eye, at]) in with.flat_map(|with| views.iter().map(move |view| (with, view))) {
            let up = if eye[0] == at[0] && eye[1] == at[1] { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
            let camera = Camera::look_at(*eye, *at, up, 75.0, SIZE).expect("two points");
            let mut all = FaceMask::all(&self.faces);
            all.retain(|face| with || self.scene.is_opaque(self.places[face as usize].0));
            let mut left = all.clone();
            let n_gone = left.retain(|face| {
                let (object, t) = self.places[face as usize];
                !is_gone(object, t)
            });
            let input = |mask| RenderInput { faces: &self.faces, camera: &camera, mask };
            let before = self.caster.picture(&input(&all)).0;
            n_shown += before.n_covered();
            if n_gone > 0 {
                n_wrong += compare(&input(&all), &before, &self.caster.picture(&input(&left)).0).wrong.len();
            }
        }
        (n_wrong, n_shown)
    }
}

/// Eyes around a box, that look into it.
fn outside(bounds: &Aabb<3>, n: usize) -> Vec<[Point3; 2]> {
    let mut random = Random::new(77);
    let far = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max);
    let mut views = Vec::new();
    while views.len() < n {
        let (at, way) = (random.point(bounds), random.direction());
        let away = far * (0.3 + 2.0 * random.unit());
        let eye = [0, 1, 2].map(|k| at[k] + away * way[k]);
        if !bounds.contains(eye) {
            views.push([eye, at]);
        }
    }
    views
}

/// Eyes that free segments lead to from a point, found and checked by other code.
fn walked(scene: &Scene, from: Point3, n: usize) -> Vec<[Point3; 2]> {
    let rays = meshes::scene(&scene.occluding_triangles().collect::<Vec<_>>());
    let mut random = Random::new(78);
    let mut places = vec![from];
    while places.len() < 8 * n {
        let (start, way) = (places[random.below(places.len())], random.direction());
        let far = rays.first_hit(start, way).map_or(2.0, |hit| hit.t) * random.open_unit() * 0.99;
        let to = [0, 1, 2].map(|k| start[k] + far * way[k]);
        if rays.is_clear(start, to) {
            places.push(to);
        }
    }
    (0..n).map(|k| places[8 * k + 7]).map(|eye| [eye, random.point(&scene.bounds())]).collect()
}

/// Decides for objects and for triangles, and compares pictures; returns the first.
fn check(name: &str, scene: &Scene, eyes: &Eyes, views: &[[Point3; 2]], options: &StripOptions) -> [Stripped; 2] {
    let studio = Studio::new(scene);
    [Grain::Objects, Grain::Triangles].map(|grain| {
        let options = StripOptions { grain, ..options.clone() };
        let found = strip(scene, eyes, &options, None).expect("no mirrors");
        let (n_wrong, n_shown) = studio.judge(views, |object, t| found.objects[object as usize].hides(t));
        assert_eq!(n_wrong, 0, "{name}: {grain:?}");
        assert!(n_shown > 0, "{name}: nothing is shown");
        let counts = found.count_triangles(scene);
        eprintln!(
            "{name}: {} of {} triangles are hidden, {} undecided",
            counts.n_hidden(),
            counts.all,
            counts.undecided
        );
        found
    })
}

/// Turned by the angle of a triangle with the sides 3, 4 and 5, or skew, scaled and moved.
fn moved(scene: &Scene, scale: f64, shift: f64) -> Scene {
    let objects = scene.objects().iter().map(|object| {
        let mut object = object.clone();
        for p in &mut object.vertices {
            let [x, y, z] = *p;
            let [x, y] = [0.6 * x - 0.8 * y, 0.8 * x + 0.6 * y];
            let [y, z] = [0.6 * y - 0.8 * z, 0.8 * y + 0.6 * z];
            *p = [x, y, z].map(|x| x * scale + shift);
        }
        object
    });
    Scene::new(objects.collect()).expect("a scene")
}

fn assemblies() -> Vec<(&'static str, Scene)> {
    vec![
        ("gearbox", gearbox(GearboxOptions { gears: 2, seed: 5 }).expect("some gears").scene),
        ("voids", nested_voids(Pipe::FromOutside).scene),
        ("cupboard", cupboard(8).expect("a keyhole").scene),
    ]
}

fn little() -> StripOptions {
    let effort = LineEffort { shared_cells: 20_000, ..LineEffort::default() };
    StripOptions { effort, more_rays: 64, ..StripOptions::default() }
}

#[test]
fn pictures_of_assemblies_are_the_same_from_outside() {
    for (name, scene) in assemblies() {
        for (k, scene) in [moved(&scene, 1e-3, 0.0), moved(&scene, 70.0, 1e4), scene].iter().enumerate() {
            let views = outside(&scene.bounds(), n_pictures(12));
            let [objects, triangles] = check(&format!("{name} {k}"), scene, &Eyes::outside(), &views, &little());
            let n_hidden = [objects, triangles].map(|found| found.count_triangles(scene).n_hidden());
            assert!(n_hidden[1] > 0 && (name != "gearbox" || n_hidden[0] > 400), "{name} {k}: {n_hidden:?}");
        }
    }
}

#[test]
fn pictures_are_the_same_from_where_eyes_walk() {
    let pipe = nested_voids(Pipe::FromOuterVoid).scene;
    let from = [1.2, 6.5, 1.2];
    let eyes = Eyes::joined_to([Volume::new(Aabb { min: from, max: from }).expect("a point")]).expect("one");
    for (name, scene) in [("voids", pipe), ("closed voids", nested_voids(Pipe::None).scene)] {
        let [_, triangles] = check(name, &scene, &eyes, &walked(&scene, from, n_pictures(12)), &little());
        assert!(triangles.count_triangles(&scene).n_hidden() > 0, "{name}");
    }
}

/// One triangle more that is seen, and pictures differ.
#[test]
fn impostor_one_triangle_more_is_noticed() {
    let (mut n, mut n_noticed) = (0, 0);
    for (_, scene) in assemblies() {
        let options = StripOptions { grain: Grain::Triangles, ..little() };
        let found = strip(&scene, &Eyes::outside(), &options, None).expect("no mirrors");
        let studio = Studio::new(&scene);
        let views = outside(&scene.bounds(), 24);
        // The largest of each object.
        for (object, (of, fate)) in (0u32..).zip(scene.objects().iter().zip(&found.objects)).take(2) {
            let size = |&[a, b, c]: &[Point3; 3]| length(cross(sub(b, a), sub(c, a)));
            let seen = of.corners().enumerate().filter(|(t, _)| matches!(fate.triangles[*t], Fate::Seen(_)));
            let Some((largest, _)) = seen.max_by(|a, b| size(&a.1).total_cmp(&size(&b.1))) else { continue };
            let is_gone = |o: u32, t: usize| found.objects[o as usize].hides(t) || (o, t) == (object, largest);
            n += 1;
            n_noticed += usize::from(studio.judge(&views, is_gone).0 > 0);
        }
    }
    assert!(n >= 4 && n_noticed * 3 >= n * 2, "{n_noticed} of {n}");
}

#[test]
fn pictures_of_real_scenes_are_the_same() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED pictures_of_real_scenes_are_the_same: SIGHTLINES_DATA is not set");
        return;
    };
    for name in ["duplex", "whale_large"] {
        let path = std::path::Path::new(&data).join("scenes").join(format!("{name}/{name}.glb"));
        let read = SceneReadOptions::with_backs(BackFaces::Drawn);
        let scene = read_scene_with(path, &read).expect("a scene").scene;
        let views = outside(&scene.bounds(), n_pictures(6));
        let studio = Studio::new(&scene);
        let effort = LineEffort { first_cells: 20, shared_cells: 0, ..LineEffort::default() };
        let options =
            StripOptions { effort, first_rays: 8, more_rays: 0, ignore_mirrors: true, ..StripOptions::default() };
        let found = strip(&scene, &Eyes::outside(), &options, None).expect("mirrors are ignored");
        let (n_wrong, n_shown) = studio.judge(&views, |object, t| found.objects[object as usize].hides(t));
        assert!(n_wrong == 0 && n_shown > 0, "{name}: {n_wrong} of {n_shown}");
        eprintln!("{name}: {:?}", found.count_objects());
    }
}

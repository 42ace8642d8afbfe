//! Sides, glass, motion and mirrors: what shows an inside, each with its twin that hides it.

use crate::truth::{hidden, one_sided};
use proptest::prelude::*;
use sightlines_cells::{MovingObject, Scene, SceneObject};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::Volume;
use sightlines_scenes::{Pipe, nested_voids};
use sightlines_strip::{Eyes, Fate, Grain, HiddenReason, LineEffort, StripError, StripOptions, strip};
use sightlines_testkit::fronts::{Mixed, mixed};

/// A closed box, its fronts outwards.
pub(crate) fn block(name: &str, min: Point3, max: Point3) -> SceneObject {
    let vertices = Aabb { min, max }.corners().to_vec();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices, triangles }
}

/// A hull of which the sides are separate objects with equal corners, and a thing in it.
fn hull() -> Scene {
    let whole = block("", [0.0; 3], [4.0; 3]);
    let side = |k: usize| SceneObject {
        name: format!("Side {k}"),
        triangles: whole.triangles[2 * k..2 * k + 2].to_vec(),
        vertices: whole.vertices.clone(),
    };
    let mut objects: Vec<SceneObject> = (0..6).map(side).collect();
    objects.push(block("Thing", [1.0; 3], [2.0; 3]));
    Scene::new(objects).expect("a scene")
}

fn fate_of_thing(scene: &Scene, eyes: &Eyes) -> Fate {
    strip(scene, eyes, &StripOptions::default(), None).expect("no mirrors").objects[6].fate
}

#[test]
fn glass_motion_and_backs_show_what_is_in_a_hull() {
    let (outside, enclosed) = (Eyes::outside(), Fate::Hidden(HiddenReason::Enclosed));
    assert_eq!(fate_of_thing(&hull(), &outside), enclosed, "sides of several objects are closed together");
    let is_seen = |scene: Scene| matches!(fate_of_thing(&scene, &outside), Fate::Seen(_));
    assert!(is_seen(hull().with_see_through(vec![3]).expect("a side")), "a window");
    let moving = MovingObject { object: 3, within: Some(Aabb { min: [0.0; 3], max: [4.0; 3] }) };
    assert!(is_seen(hull().with_moving(vec![moving]).expect("a side")), "a side that moves");
    // One side that hides from its front only is one of no closed surface, and still nobody outside is behind it.
    let outwards = hull().with_front_occluders((0..6).collect()).expect("sides");
    assert!(fate_of_thing(&outwards, &outside).is_hidden());
    let mut objects = hull().objects().to_vec();
    objects[3].triangles.iter_mut().for_each(|t| t.swap(0, 1));
    let inwards = Scene::new(objects).expect("a scene").with_front_occluders((0..6).collect()).expect("sides");
    assert!(is_seen(inwards), "a back is not drawn");
    // What moves in a hull is hidden with all places that it moves to; one that leaves it is not.
    let with_motion = |max: f64| {
        let within = Some(Aabb { min: [0.5; 3], max: [max, 3.0, 3.0] });
        hull().with_moving(vec![MovingObject { object: 6, within }]).expect("the thing")
    };
    assert_eq!(fate_of_thing(&with_motion(3.0), &outside), enclosed);
    assert!(is_seen(with_motion(5.0)));
    assert_eq!(
        fate_of_thing(
            &hull().with_moving(vec![MovingObject { object: 6, within: None }]).expect("the thing"),
            &outside
        ),
        Fate::Kept
    );
}

#[test]
fn eyes_in_a_void_see_what_is_in_it_and_nothing_else() {
    let of = nested_voids(Pipe::None);
    let eyes =
        |min: Point3, max: Point3| Eyes::in_boxes([Volume::new(Aabb { min, max }).expect("a box")]).expect("one");
    let names = |scene: &Scene, eyes: &Eyes| -> Vec<String> {
        let found = strip(scene, eyes, &StripOptions::default(), None).expect("no mirrors");
        hidden(&found).iter().map(|&k| scene.objects()[k as usize].name.clone()).collect()
    };
    let outer = eyes([1.1, 6.5, 1.1], [1.3, 7.0, 1.5]);
    assert_eq!(names(&of.scene, &outer), ["Inner ball"]);
    let inner = eyes([4.05; 3], [4.1; 3]);
    assert_eq!(names(&of.scene, &inner), ["Block", "Outer ball"]);
    assert_eq!(names(&of.scene, &eyes([-3.0, 0.0, 0.0], [-2.0, 9.0, 9.0])), ["Core", "Inner ball", "Outer ball"]);
    // The sides of a void are backs of nothing: eyes in it see fronts.
    assert_eq!(names(&one_sided(&of.scene), &outer), ["Inner ball"]);
}

/// Nothing in a box of eyes is hidden by lines that leave the box: not what is in a pot, nor what lies free.
#[test]
fn what_is_among_the_eyes_is_not_hidden_by_lines() {
    let mut pot = hull().objects()[..5].to_vec();
    pot.extend([block("Thing", [1.0; 3], [2.0; 3]), block("Other", [5.0; 3], [5.5; 3])]);
    let open = Scene::new(pot).expect("a scene");
    let options = StripOptions { first_rays: 0, more_rays: 0, ..StripOptions::default() };
    let eyes = Eyes::in_boxes([Volume::new(Aabb { min: [-1.0; 3], max: [6.0; 3] }).expect("a box")]).expect("one");
    let found = strip(&open, &eyes, &options, None).expect("no mirrors");
    assert_eq!(hidden(&found), [0u32; 0]);
    // The twin: beside the eyes, and with a wall between.
    let wall = block("Wall", [-20.0, -20.0, 7.0], [20.0, 20.0, 7.5]);
    let behind = block("Behind", [1.0, 1.0, 8.0], [2.0, 2.0, 9.0]);
    let scene = Scene::new([open.objects(), &[wall, behind]].concat()).expect("a scene");
    assert_eq!(hidden(&strip(&scene, &eyes, &options, None).expect("no mirrors")), [8]);
}

/// What moves may come to where the eyes are, though the sides of the box that it does not leave are behind a hull around them.
#[test]
fn what_moves_around_eyes_is_not_hidden_by_the_hull_around_them() {
    let eyes = |min: f64| {
        let b = Aabb { min: [min; 3], max: [min + 0.5; 3] };
        Eyes::in_boxes([Volume::new(b).expect("a box")]).expect("one")
    };
    let moving = |min: f64, max: f64| {
        let within = Some(Aabb { min: [min; 3], max: [max; 3] });
        hull().with_moving(vec![MovingObject { object: 6, within }]).expect("the thing")
    };
    for gap in [0.0, 0.25] {
        let options = StripOptions { gap, ..StripOptions::default() };
        let is_hidden = |scene: &Scene, eyes: &Eyes| {
            strip(scene, eyes, &options, None).expect("no mirrors").objects[6].fate.is_hidden()
        };
        assert!(!is_hidden(&moving(-1.0, 5.0), &eyes(3.0)), "{gap}");
        // The twin: it stays in the hull, and the eyes outside.
        assert!(is_hidden(&moving(0.5, 3.0), &eyes(5.0)), "{gap}");
    }
}

#[test]
fn mirrors_are_refused_unless_they_are_ignored() {
    let scene = hull().with_mirrors(vec![2]).expect("a side");
    let options = StripOptions { ignore_mirrors: true, ..StripOptions::default() };
    let error = strip(&scene, &Eyes::outside(), &StripOptions::default(), None).unwrap_err();
    assert_eq!(error, StripError::Mirrors { n: 1 });
    assert!(strip(&scene, &Eyes::outside(), &options, None).is_ok());
    let keep = StripOptions { keep: vec![6], ..options };
    assert_eq!(strip(&scene, &Eyes::outside(), &keep, None).expect("ignored").objects[6].fate, Fate::Kept);
}

/// As a scene, each triangle an object; and whether exact segments of `testkit` reach what is said to be hidden.
fn contradiction(of: &Mixed, eyes: Option<&Aabb<3>>, grain: Grain) -> Option<String> {
    let object =
        |t: &[Point3; 3]| SceneObject { name: String::new(), vertices: t.to_vec(), triangles: vec![[0, 1, 2]] };
    let n = of.both_sides.len();
    let all: Vec<[Point3; 3]> = of.both_sides.iter().chain(&of.fronts).copied().collect();
    let scene = Scene::new(all.iter().map(object).collect()).expect("a scene");
    let scene = scene.with_front_occluders((n as u32..all.len() as u32).collect()).expect("objects");
    let around = eyes.map(|b| Eyes::in_boxes([Volume::new(*b).expect("a box")]).expect("one"));
    let effort = LineEffort { shared_cells: 20_000, ..LineEffort::default() };
    let options = StripOptions { grain, effort, first_rays: 0, more_rays: 0, threads: 1, ..StripOptions::default() };
    let found = strip(&scene, &around.unwrap_or(Eyes::outside()), &options, None).expect("no mirrors");
    let b = scene.bounds();
    // Without rays of its own, what is seen is found by line space or not at all.
    for (k, fate) in found.objects.iter().enumerate() {
        let others = |list: &[[Point3; 3]], first: usize| -> Vec<[Point3; 3]> {
            list.iter().enumerate().filter(|(i, _)| first + i != k).map(|(_, t)| *t).collect()
        };
        let walls = Mixed { both_sides: others(&of.both_sides, 0), fronts: others(&of.fronts, n) };
        if !fate.fate.is_hidden() {
            continue;
        }
        let [p, q, r] = all[k];
        let mut random = sightlines_geometry::Random::new(k as u64);
        for i in 0..300 {
            let (u, v) = (random.open_unit(), random.open_unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let point = [0, 1, 2].map(|j| p[j] + u * (q[j] - p[j]) + v * (r[j] - p[j]));
            let far = |d: Point3| [0, 1, 2].map(|j| point[j] + d[j] * 100.0);
            let way = random.direction();
            let eye = eyes.map_or_else(|| far(way), |b| random.point(b));
            let is_eye = eyes.is_some() || !b.contains(eye);
            if is_eye && walls.is_free([eye, point]) {
                return Some(format!(
                    "object {k}: {:?} is hidden, and free from {eye:?} to {point:?}, ray {i}",
                    fate.fate
                ));
            }
        }
    }
    None
}

proptest! {
    /// Invariant: no exact segment reaches what is hidden, from outside or from a box, whatever hides from which sides.
    #[test]
    fn nothing_hidden_is_reached(of in mixed(), from_box in any::<bool>(), triangles in any::<bool>(), at in [-6i32..12, -6i32..12, -6i32..12]) {
        let min = at.map(|x| f64::from(x) + 0.1);
        let eyes = Aabb { min, max: min.map(|x| x + 1.5) };
        let grain = if triangles { Grain::Triangles } else { Grain::Objects };
        let found = contradiction(&of, from_box.then_some(&eyes), grain);
        prop_assert!(found.is_none(), "{}", found.unwrap_or_default());
    }
}

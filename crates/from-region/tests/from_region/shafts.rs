//! View shafts.

use crate::common::{block, judge, open_line, volume};
use proptest::prelude::*;
use sightlines_cells::{Scene, SceneObject};
use sightlines_from_region::ViewShafts;
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{FromRegion, Guarantee, Occluder, Umbra, Volume};
use sightlines_testkit::rays::RayScene;

/// A convex polygon as an occluder, and its triangles as an object.
fn polygon(corners: Vec<Point3>) -> (Occluder, SceneObject) {
    let triangles = (2..corners.len() as u32).map(|i| [0, i - 1, i]).collect();
    surface(corners, triangles)
}

/// A surface as an occluder, and its triangles as an object.
fn surface(outline: Vec<Point3>, triangles: Vec<[u32; 3]>) -> (Occluder, SceneObject) {
    let object = SceneObject { name: String::new(), vertices: outline.clone(), triangles };
    let corners: Vec<_> = object.corners().collect();
    (Occluder::patch(outline, &corners).unwrap(), object)
}

/// A rectangle across the third axis.
fn wall(low: [f64; 2], high: [f64; 2], z: f64) -> Vec<Point3> {
    vec![[low[0], low[1], z], [high[0], low[1], z], [high[0], high[1], z], [low[0], high[1], z]]
}

/// A roof: two rectangles with a common edge. Convex to the one side.
fn roof(half: f64, z: f64, high: f64) -> (Occluder, SceneObject) {
    let p = |x: f64, y: f64| [x, y, if x == 0.0 { z + high } else { z }];
    let outline = vec![p(-half, -half), p(0., -half), p(half, -half), p(half, half), p(0., half), p(-half, half)];
    surface(outline, vec![[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4]])
}

fn made(parts: Vec<(Occluder, SceneObject)>) -> (ViewShafts, RayScene) {
    let (occluders, objects) = parts.into_iter().unzip();
    (ViewShafts::new(occluders), RayScene::new(&Scene::new(objects).unwrap()))
}

fn point(range: std::ops::Range<i32>) -> impl Strategy<Value = Point3> {
    prop::array::uniform3(range).prop_map(|p| p.map(f64::from))
}

/// Triangles and parallelograms, far apart and touching, in all directions.
fn occluder() -> impl Strategy<Value = Vec<Point3>> {
    (prop::array::uniform3(point(-7..8)), any::<bool>())
        .prop_filter("no area", |(t, _)| Occluder::triangle(*t).is_ok())
        .prop_map(
            |([a, b, c], four)| {
                if four { vec![a, b, std::array::from_fn(|k| b[k] + c[k] - a[k]), c] } else { vec![a, b, c] }
            },
        )
}

fn small_box(range: std::ops::Range<i32>) -> impl Strategy<Value = Aabb<3>> {
    (point(range), prop::array::uniform3(0i32..3))
        .prop_map(|(min, size)| Aabb { min, max: std::array::from_fn(|k| min[k] + f64::from(size[k]) / 2.0) })
}

type Case = (Vec<Vec<Point3>>, Aabb<3>, Vec<Aabb<3>>);

fn case() -> impl Strategy<Value = Case> {
    let target = small_box(-6..7);
    (prop::collection::vec(occluder(), 1..5), small_box(-6..7), prop::collection::vec(target, 30))
}

/// How many targets are hidden, and whether rays reach one of them.
fn judged((polygons, from, targets): &Case, n_halvings: u32) -> (usize, Option<String>) {
    let (shafts, rays) = made(polygons.iter().cloned().map(polygon).collect());
    let shafts = shafts.with_halvings(n_halvings);
    let v = Volume::new(*from).unwrap();
    judge(&mut shafts.umbra_of(&v), &rays, &v, targets, 60)
}

proptest! {
    /// Invariant: no ray from the volume reaches what is hidden, whole shafts or halves.
    #[test]
    fn shafts_no_ray_reaches_what_is_hidden(case in case(), n_halvings in 0u32..4) {
        let (_, wrong) = judged(&case, n_halvings);
        prop_assert!(wrong.is_none(), "{}", wrong.unwrap());
    }

    /// Invariant: halving only adds, and points are hidden if the box around them is.
    #[test]
    fn shafts_halves_and_points_are_nested((polygons, from, targets) in case()) {
        let (shafts, _) = made(polygons.into_iter().map(polygon).collect());
        let v = Volume::new(from).unwrap();
        let halved = shafts.clone().with_halvings(3);
        let (mut whole, mut parts) = (shafts.umbra_of(&v), halved.umbra_of(&v));
        for t in &targets {
            prop_assert!(!whole.hides(t) || parts.hides(t));
            prop_assert!(!whole.hides(t) || whole.hides_points(&Volume::new(*t).unwrap().corners()));
        }
    }
}

/// The property above looked at something: enough was hidden in its cases.
#[test]
fn shafts_cases_hide_something() {
    let cases = sightlines_testkit::draw(&case(), 400);
    let n: [usize; 2] = [0, 3].map(|n| cases.iter().map(|c| judged(c, n).0).sum());
    assert!(n[0] > 100 && n[1] > n[0], "{n:?} of {}", 30 * cases.len());
}

/// The twins: what one wall hides with room to spare, is hidden; and not what it leaves open.
#[test]
fn shafts_one_wall_hides_what_is_behind_it() {
    let (mut shafts, _) = made(vec![polygon(wall([-4., -4.], [4., 4.], 5.))]);
    assert_eq!((shafts.name().as_str(), shafts.guarantee()), ("shafts", Guarantee::Conservative));
    let v = volume([-1.; 3], [1.; 3]);
    let mut umbra = shafts.umbra(&v).unwrap();
    assert!(umbra.hides(&block([-1., -1., 6.], [1., 1., 8.])));
    // The umbra of this wall ends at x = 4 + 3 / 6 * (z - 5), for eyes at the corner (1, -1).
    assert!(umbra.hides(&block([4., 0., 9.], [5.75, 1., 9.])) && !umbra.hides(&block([4., 0., 9.], [6.25, 1., 9.])));
    for open in [
        block([-1., -1., 2.], [1., 1., 4.]),
        block([-1., -1., 4.], [1., 1., 6.]),
        block([-1., -1., 5.], [1., 1., 5.]),
        block([3., 0., 6.], [9., 1., 7.]),
        block([0.; 3], [0.; 3]),
        Aabb::EMPTY,
        block([f64::NAN, 0., 6.], [0., 0., 7.]),
    ] {
        assert!(!umbra.hides(&open), "{open:?}");
    }
    assert!(umbra.hides_points(&[[0., 0., 6.], [1., 1., 8.]]));
    assert!(!umbra.hides_points(&[]) && !umbra.hides_points(&[[0., 0., 6.], [f64::NAN, 1., 8.]]));
    assert!(!umbra.hides_points(&[[0., 0., 6.], [1., 1., 4.]]));
}

/// A surface that is not flat hides like a wall of the same outline, from both sides.
#[test]
fn shafts_a_roof_hides_as_a_whole() {
    for high in [1.0, -1.0] {
        let (shafts, rays) = made(vec![roof(4., 5., high)]);
        let target = block([-1., -1., 8.], [1., 1., 9.]);
        for v in [volume([-1., -1., 0.], [1., 1., 1.]), volume([-0.5, -0.5, 0.], [0.5, 0.5, 0.])] {
            assert!(shafts.umbra_of(&v).hides(&target));
            assert!(open_line(&rays, &v, &target, 1, 2000).is_none());
        }
        let (v, target) = (volume([-1., -1., 9.], [1., 1., 10.]), block([-1., -1., 0.], [1., 1., 1.]));
        assert!(shafts.umbra_of(&v).hides(&target));
    }
}

/// A wall of two triangles hides nothing across its diagonal, until the shaft is halved or the wall is one.
#[test]
fn shafts_two_triangles_are_not_a_wall() {
    let w = wall([-4., -4.], [4., 4.], 5.);
    let halves = || vec![polygon(vec![w[0], w[1], w[2]]), polygon(vec![w[0], w[2], w[3]])];
    let v = volume([-0.5, -0.5, 0.], [0.5, 0.5, 0.]);
    let across = block([-1., -1., 8.], [1., 1., 9.]);
    assert!(!made(halves()).0.umbra_of(&v).hides(&across));
    assert!(made(vec![polygon(w.clone())]).0.umbra_of(&v).hides(&across));
    // Each half alone is hidden by its triangle.
    let mut aside = made(halves()).0.umbra_of(&v).hides(&block([2., -2., 8.], [2.5, -1.5, 9.]));
    aside &= made(halves()).0.umbra_of(&v).hides(&block([-2.5, 1.5, 8.], [-2., 2., 9.]));
    assert!(aside);
    let both = block([-2.25, -2., 8.], [-1.75, -2., 8.]);
    let point = volume([0., 0., 0.], [0., 0., 0.]);
    assert!(!made(halves()).0.umbra_of(&point).hides(&both));
    let low = block([2., -4., 8.], [2., 1., 8.]);
    let long = block([2., -4., 8.], [2., 4., 8.]);
    let (shafts, rays) = made(halves());
    assert!(shafts.umbra_of(&point).hides(&low) && !shafts.umbra_of(&point).hides(&long));
    assert!(open_line(&rays, &point, &long, 0, 2000).is_none(), "it is hidden, but by two");
    // Cut at y = 2, where the diagonal's plane passes x = 2: two more cuts.
    assert!(shafts.with_halvings(2).umbra_of(&point).hides(&long));
}

/// The impostor: occluders put together over the corners are believed, and rays find it out.
#[test]
fn impostor_a_union_of_shadows_is_caught() {
    #[derive(Debug)]
    struct Union(Vec<Occluder>, Volume);
    impl Umbra for Union {
        fn hides(&mut self, target: &Aabb<3>) -> bool {
            let ends = Volume::new(*target).unwrap().corners();
            let eyes = self.1.corners();
            let cut = |v: Point3, p: Point3| {
                let one = ViewShafts::new(self.0.clone());
                let eye = Volume::new(block(v, v)).unwrap();
                one.umbra_of(&eye).hides_points(&[p])
            };
            eyes.iter().all(|&v| ends.iter().all(|&p| cut(v, p)))
        }
    }
    // A slit along x = 0: no segment between corners passes it, and many others do.
    let parts = vec![polygon(wall([-9., -9.], [-0.25, 9.], 5.)), polygon(wall([0.25, -9.], [9., 9.], 5.))];
    let occluders: Vec<_> = parts.iter().map(|p| p.0.clone()).collect();
    let (shafts, rays) = made(parts);
    let v = volume([-1., -1., 0.], [1., 1., 0.]);
    let target = block([-3., -1., 10.], [3., 1., 10.]);
    let (n, wrong) = judge(&mut Union(occluders, v), &rays, &v, &[target], 2000);
    assert!(n == 1 && wrong.is_some());
    assert!(!shafts.clone().umbra_of(&v).hides(&target) && !shafts.with_halvings(8).umbra_of(&v).hides(&target));
}

/// The same answers whatever was asked before.
#[test]
fn shafts_answers_do_not_depend_on_what_was_asked() {
    for (polygons, from, targets) in sightlines_testkit::draw(&case(), 60) {
        let (shafts, _) = made(polygons.into_iter().map(polygon).collect());
        let v = Volume::new(from).unwrap();
        let mut umbra = shafts.umbra_of(&v);
        let forth: Vec<bool> = targets.iter().map(|t| umbra.hides(t)).collect();
        let mut back: Vec<bool> = targets.iter().rev().map(|t| umbra.hides(t)).collect();
        back.reverse();
        let alone: Vec<bool> = targets.iter().map(|t| shafts.umbra_of(&v).hides(t)).collect();
        assert_eq!((&forth, &back), (&alone, &alone));
    }
}

//! Voxels with blocker extension.

use crate::common::{block, boxes, cuboid, judge, open_line, volume};
use proptest::prelude::*;
use sightlines_cells::{Scene, SceneObject};
use sightlines_from_region::{Interior, VoxelError, VoxelOptions, Voxels};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::{FromRegion, Guarantee, Umbra, Volume};
use sightlines_testkit::rays::RayScene;

fn voxels(scene: &Scene, n_longest: usize, interior: Interior) -> Voxels {
    Voxels::new(scene, VoxelOptions { n_longest, interior, ..VoxelOptions::default() }).unwrap()
}

fn closed(scene: &Scene, n_longest: usize) -> Voxels {
    voxels(scene, n_longest, Interior::Closed)
}

fn small_box(sizes: std::ops::Range<i32>) -> impl Strategy<Value = Aabb<3>> {
    (prop::array::uniform3(0i32..20), prop::array::uniform3(sizes)).prop_map(|(p, size)| {
        let min = p.map(f64::from);
        Aabb { min, max: std::array::from_fn(|k| min[k] + f64::from(size[k])) }
    })
}

/// Boxes that touch, cut and hold each other, some without a side; and triangles about them.
fn objects() -> impl Strategy<Value = Vec<SceneObject>> {
    let solid = (small_box(2..12), prop::option::weighted(0.3, 0usize..6), any::<bool>());
    let fin = prop::array::uniform3(prop::array::uniform3(0i32..24));
    (prop::collection::vec(solid, 1..5), prop::collection::vec(fin, 0..3)).prop_map(|(solids, fins)| {
        let solids = solids.into_iter().map(|(b, open, room)| {
            let mut object = cuboid(&b, open.as_slice());
            // Which way a surface faces does not matter.
            if room {
                object.triangles.iter_mut().for_each(|t| t.swap(0, 1));
            }
            object
        });
        let fin = |t: [[i32; 3]; 3]| SceneObject {
            name: String::new(),
            vertices: t.map(|p| p.map(f64::from)).to_vec(),
            triangles: vec![[0, 1, 2]],
        };
        solids.chain(fins.into_iter().map(fin)).collect()
    })
}

type Case = (Vec<SceneObject>, Aabb<3>, Vec<Aabb<3>>, usize);

fn case() -> impl Strategy<Value = Case> {
    (objects(), small_box(0..3), prop::collection::vec(small_box(0..3), 30), 8usize..24)
}

fn judged((objects, from, targets, n): &Case) -> (usize, Option<String>) {
    let scene = Scene::new(objects.clone()).unwrap();
    let v = Volume::new(Aabb { min: from.min.map(|x| x + 0.3), max: from.max.map(|x| x + 0.6) }).unwrap();
    let voxels = closed(&scene, *n);
    let rays = RayScene::new(&scene);
    let mut umbra = voxels.umbra_of(&v);
    // Targets off the whole numbers, so that rays to their corners do not run in walls.
    let off = |t: &Aabb<3>| Aabb { min: t.min.map(|x| x + 0.45), max: t.max.map(|x| x + 0.55) };
    let targets: Vec<_> = targets.iter().map(off).chain(umbra.blockers().iter().copied()).collect();
    judge(&mut umbra, &rays, &v, &targets, 60)
}

proptest! {
    /// Invariant: no ray from the volume reaches what is hidden, nor a blocker, wherever the volume is.
    #[test]
    fn voxels_no_ray_reaches_what_is_hidden(case in case()) {
        let (_, wrong) = judged(&case);
        prop_assert!(wrong.is_none(), "{}", wrong.unwrap());
    }

    /// Invariant: blockers are hidden themselves; what meets the volume never is; a flood finds no less.
    #[test]
    fn voxels_answers_fit_together((objects, from, targets, n) in case()) {
        let scene = Scene::new(objects).unwrap();
        let v = Volume::new(from).unwrap();
        let (closed, flooded) = (closed(&scene, n), voxels(&scene, n, Interior::Flooded));
        let (mut umbra, wider) = (closed.umbra_of(&v), flooded.umbra_of(&v));
        prop_assert!(umbra.n_opaque() <= umbra.n_hidden() && umbra.n_opaque() <= wider.n_opaque());
        for b in umbra.blockers().to_vec() {
            prop_assert!(umbra.hides(&b));
        }
        prop_assert!(!umbra.hides(v.bounds()));
        for t in &targets {
            let around = Aabb::around([t.min, t.max, v.bounds().max]);
            prop_assert!(!umbra.hides(&around));
            prop_assert!(!umbra.hides(t) || umbra.hides_points(&Volume::new(*t).unwrap().corners()));
        }
    }
}

/// The property above looked at something: enough was hidden in its cases.
#[test]
fn voxels_cases_hide_something() {
    let cases = sightlines_testkit::draw(&case(), 100);
    let n: usize = cases.iter().map(|c| judged(c).0).sum();
    assert!(n > 200, "{n} of {} cases", cases.len());
}

/// The twins: one thick wall hides what is behind it, and nothing else.
#[test]
fn voxels_a_thick_wall_hides_what_is_behind_it() {
    let scene = boxes(&[block([-10., -10., 8.], [10., 10., 12.]), block([-1., -1., 20.], [1., 1., 21.])]);
    let mut voxels = closed(&scene, 40);
    assert_eq!((voxels.name().as_str(), voxels.guarantee()), ("voxels-closed-40", Guarantee::Conservative));
    assert_eq!(voxels.n_surfaces(), 2);
    let mut umbra = voxels.umbra(&volume([-1., -1., 0.], [1., 1., 1.])).unwrap();
    for hidden in [
        block([-1., -1., 20.], [1., 1., 21.]),
        block([-9., -9., 14.], [9., 9., 21.]),
        // Beyond the voxels, by blockers alone.
        block([-9., -9., 90.], [9., 9., 100.]),
        // Inside the wall.
        block([-1., -1., 9.], [1., 1., 10.]),
    ] {
        assert!(umbra.hides(&hidden), "{hidden:?}");
    }
    assert!(umbra.hides_points(&[[0., 0., 20.], [30., 0., 90.], [0., 30., 90.]]));
    let nothing = [f64::NAN, 0., 20.];
    assert!(!umbra.hides_points(&[]) && !umbra.hides_points(&[[0., 0., 20.], nothing]));
    for open in [
        block([-1., -1., 4.], [1., 1., 7.]),
        block([-1., -1., 20.], [40., 1., 21.]),
        block([0., 0., 0.], [1., 1., 40.]),
        Aabb::EMPTY,
        block([f64::NEG_INFINITY, 0., 20.], [0., 0., 21.]),
    ] {
        assert!(!umbra.hides(&open), "{open:?}");
    }
    drop(umbra);
    // From behind, and from inside: a volume in the wall sees nothing of what is outside.
    assert!(umbra_hides(&voxels, [-1., -1., 22.], [1., 1., 23.], &block([-1., -1., 2.], [1., 1., 3.])));
    assert!(umbra_hides(&voxels, [-1., -1., 9.], [1., 1., 10.], &block([-1., -1., 2.], [1., 1., 3.])));
    // One that cuts the wall's surface sees both sides.
    assert!(!umbra_hides(&voxels, [-1., -1., 7.], [1., 1., 13.], &block([-1., -1., 2.], [1., 1., 3.])));
}

fn umbra_hides(voxels: &Voxels, min: Point3, max: Point3, target: &Aabb<3>) -> bool {
    voxels.umbra_of(&volume(min, max)).hides(target)
}

/// Two blockers side by side, and a third behind the gap between them: none hides the target alone, and no two do.
#[test]
fn voxels_blockers_fuse_through_hidden_space() {
    let sides = [block([-30., -8., 10.], [-1., 8., 14.]), block([1., -8., 10.], [30., 8., 14.])];
    let plug = block([-5., -8., 20.], [5., 8., 24.]);
    let target = block([-12., -1., 40.], [12., 1., 41.]);
    let v = volume([-1., -0.5, 0.], [1., 0.5, 1.]);
    let hides = |walls: &[Aabb<3>]| {
        let scene = boxes(&[walls, &[target]].concat());
        let hidden = umbra_hides(&closed(&scene, 90), v.bounds().min, v.bounds().max, &target);
        let front = block([-12., -1., 39.9], [12., 1., 39.9]);
        let seen = open_line(&RayScene::new(&scene), &v, &front, 5, 20_000).is_some();
        assert_eq!(hidden, !seen, "{walls:?}");
        hidden
    };
    assert!(hides(&[sides[0], sides[1], plug]));
    assert!(!hides(&[sides[0], sides[1]]) && !hides(&[sides[0], plug]) && !hides(&[sides[1], plug]) && !hides(&[plug]));
}

/// A house without a floor hides from eyes above its rim, and nothing from eyes that may look in from below.
#[test]
fn voxels_open_ends_are_used_where_lines_cannot() {
    let house = block([-10., 0., 8.], [10., 9., 16.]);
    let target = block([-1., 2., 25.], [1., 4., 26.]);
    let over = block([-1., 12., 11.], [1., 13., 12.]);
    for left_out in [vec![], vec![2], vec![2, 3], vec![4], vec![4, 5]] {
        let scene = Scene::new(vec![cuboid(&house, &left_out), cuboid(&target, &[])]).unwrap();
        let voxels = closed(&scene, 60);
        assert_eq!(voxels.n_surfaces(), 2, "{left_out:?}");
        // From the front at half height, lines use the front but neither floor nor roof.
        let before = umbra_hides(&voxels, [-1., 2., 0.], [1., 3., 1.], &target);
        assert_eq!(before, !left_out.contains(&4), "{left_out:?}");
        // From below, lines use the floor but neither front nor back.
        let below = umbra_hides(&voxels, [-1., -6., 11.], [1., -5., 12.], &over);
        assert_eq!(below, !left_out.contains(&2), "{left_out:?}");
    }
}

/// A leaky hall: closed at the size of voxels, and with a slit that lines pass.
fn leaky() -> (Scene, Volume, Aabb<3>) {
    let hall = block([-10., -10., 8.], [10., 10., 28.]);
    let slit = |z: f64| {
        // Both halves of a side, a fiftieth apart.
        let wall = |x: [f64; 2]| SceneObject {
            name: String::new(),
            vertices: vec![[x[0], -10., z], [x[1], -10., z], [x[1], 10., z], [x[0], 10., z]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        };
        [wall([-10., 0.]), wall([0.02, 10.])]
    };
    let objects = [vec![cuboid(&hall, &[4, 5])], slit(8.).to_vec(), slit(28.).to_vec()].concat();
    (Scene::new(objects).unwrap(), volume([-0.5, -0.5, 7.], [0.5, 0.5, 7.5]), block([-4., -4., 12.], [4., 4., 24.]))
}

/// The impostor, and what the guarantee of the flood is worth: on a leaky mesh it calls hidden what a ray reaches, and the
/// rays find it out. Closed surfaces keep their promise.
#[test]
fn impostor_a_flood_is_caught_where_the_mesh_leaks() {
    let (scene, v, inside) = leaky();
    let rays = RayScene::new(&scene);
    let flooded = voxels(&scene, 40, Interior::Flooded);
    assert!(matches!(flooded.guarantee(), Guarantee::ConservativeIf(_)));
    assert_eq!(flooded.name(), "voxels-flooded-40");
    let (n, wrong) = judge(&mut flooded.umbra_of(&v), &rays, &v, &[inside], 20_000);
    assert!(n == 1 && wrong.is_some());
    let closed = closed(&scene, 40);
    assert!(!closed.umbra_of(&v).hides(&inside));
    // A flood is stopped by walls that nothing else closes, and hides as well as they do where they do not leak.
    assert!(flooded.umbra_of(&v).n_opaque() > closed.umbra_of(&v).n_opaque());
}

#[test]
fn voxels_are_repeatable() {
    for (objects, from, targets, n) in sightlines_testkit::draw(&case(), 20) {
        let scene = Scene::new(objects).unwrap();
        let v = Volume::new(from).unwrap();
        let answers = || {
            let voxels = closed(&scene, n);
            let mut umbra = voxels.umbra_of(&v);
            let hidden: Vec<bool> = targets.iter().map(|t| umbra.hides(t)).collect();
            (hidden, umbra.blockers().to_vec(), umbra.n_hidden(), umbra.n_opaque())
        };
        assert_eq!(answers(), answers());
    }
}

#[test]
fn voxels_of_nothing_and_too_many_voxels() {
    let options = |n_longest| VoxelOptions { n_longest, ..VoxelOptions::default() };
    let empty = Voxels::new(&Scene::default(), options(8)).unwrap();
    assert!(!umbra_hides(&empty, [0.; 3], [1.; 3], &block([2.; 3], [3.; 3])));
    let scene = boxes(&[block([0.; 3], [1.; 3])]);
    for n in [0, 600, 1 << 40, usize::MAX] {
        assert_eq!(Voxels::new(&scene, options(n)).err(), Some(VoxelError::Count(n)));
    }
    let message = VoxelError::Count(0).to_string();
    assert_eq!(message, "0 voxels along the longest side are none, or more than 134217728 in all");
    // A scene that is one point, and one that is as far away as coordinates go.
    let point = Scene::new(vec![cuboid(&block([5.; 3], [5.; 3]), &[])]).unwrap();
    assert!(!umbra_hides(&closed(&point, 8), [0.; 3], [1.; 3], &block([6.; 3], [7.; 3])));
    let far = 2f64.powi(199);
    let scene = boxes(&[block([far; 3], [far * 1.5; 3])]);
    assert!(umbra_hides(&closed(&scene, 16), [far * 0.9; 3], [far * 0.91; 3], &block([far * 1.2; 3], [far * 1.3; 3])));
    // No more blockers than allowed.
    let scene = boxes(&[block([0., 0., 0.], [9., 2., 2.]), block([0., 6., 0.], [9., 8., 2.])]);
    let few = Voxels::new(&scene, VoxelOptions { max_blockers: 1, ..options(24) }).unwrap();
    assert_eq!(few.umbra_of(&volume([3., 0., -9.], [4., 8., -8.])).blockers().len(), 1);
}

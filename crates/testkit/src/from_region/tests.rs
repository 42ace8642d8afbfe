//! Clear segments against exact arithmetic, and how well slits are found.

use super::*;
use sightlines_cells::SceneObject;
use sightlines_geometry::orient3d;
use sightlines_scenes::{Occlusion, OcclusionOptions, occlusion};

/// Rectangles facing along z, as objects of two triangles.
fn rectangles(all: &[[f64; 5]]) -> Scene {
    let object = |&[x0, y0, x1, y1, z]: &[f64; 5]| SceneObject {
        name: "wall".to_owned(),
        vertices: vec![[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    };
    Scene::new(all.iter().map(object).collect()).unwrap()
}

const VOLUME: Aabb<3> = Aabb { min: [-0.5; 3], max: [0.5; 3] };

fn behind() -> Aabb<3> {
    Aabb { min: [-0.5, -0.5, 10.0], max: [0.5, 0.5, 11.0] }
}

/// Two walls from side to side with a slit between them at `x`, and another two with a slit at `y`.
fn slits(x: [f64; 2], y: [f64; 2]) -> Scene {
    rectangles(&[
        [-20., -20., x[0], 20., 4.],
        [x[1], -20., 20., 20., 4.],
        [-20., -20., 20., y[0], 7.],
        [-20., y[1], 20., 20., 7.],
    ])
}

/// Whether a segment meets a closed triangle, by exact signs; true where it lies in its plane.
fn meets([a, b, c]: [Point3; 3], p: Point3, q: Point3) -> bool {
    let side = |v: f64| if v > 0.0 { 1 } else { -i32::from(v < 0.0) };
    let [sp, sq] = [p, q].map(|v| side(orient3d(a, b, c, v)));
    if sp == sq {
        return sp == 0;
    }
    let around = [(a, b), (b, c), (c, a)].map(|(s, t)| side(orient3d(p, q, s, t)));
    around.iter().all(|&s| s >= 0) || around.iter().all(|&s| s <= 0)
}

fn assert_segments_are_clear(scene: &Scene, volume: &Aabb<3>, targets: &[Aabb<3>], view: &SampledView) -> usize {
    let mut n = 0;
    for (target, segment) in targets.iter().zip(&view.first) {
        let Some(ClearSegment { eye, point }) = *segment else { continue };
        assert!(volume.contains(eye) && target.contains(point), "{segment:?}");
        let blocked = scene.objects().iter().flat_map(SceneObject::corners).any(|t| meets(t, eye, point));
        assert!(!blocked, "{segment:?}");
        n += 1;
    }
    n
}

#[test]
fn what_a_wall_covers_is_not_seen_and_what_is_beside_it_is() {
    let beside = Aabb { min: [7.0, 0.0, 10.0], max: [8.0, 1.0, 11.0] };
    let scene = rectangles(&[[-3., -3., 3., 3., 5.]]);
    let targets = [behind(), beside, Aabb::EMPTY, Aabb { min: [0., 0., 2.], max: [0., 0., 2.] }];
    let found = sampled_view(&scene, &VOLUME, &targets, 20_000, 1);
    assert_eq!(found.unseen().collect::<Vec<_>>(), [0, 2]);
    assert_eq!(assert_segments_are_clear(&scene, &VOLUME, &targets, &found), 2);
    assert!((15_000..25_000).contains(&found.n_rays), "{}", found.n_rays);
    assert_eq!(found.refuted([0, 2]), []);
    // The impostor: who calls hidden what is beside the wall is refuted.
    assert_eq!(found.refuted([0, 1])[0].0, 1);
    // The back of the wall blocks like its front, and an eye may be a point.
    let back = Aabb { min: [-0.5, -0.5, -9.0], max: [0.5, 0.5, -9.0] };
    let eye = Aabb { min: [0., 0., 9.], max: [0., 0., 9.] };
    assert_eq!(sampled_view(&scene, &eye, &[back, beside], 5_000, 1).unseen().collect::<Vec<_>>(), [0]);
    assert_eq!(sampled_view(&scene, &Aabb::EMPTY, &[beside], 5_000, 1).n_rays, 0);
    let nothing = sampled_view(&Scene::default(), &eye, &[beside], 5_000, 1);
    assert_eq!((nothing.unseen().count(), nothing.n_rays), (0, 1));
}

/// Eyes in a closed room, up to its walls, see nothing outside, though those on an edge of the room could look along its outside.
#[test]
fn eyes_on_the_walls_around_them_see_nothing_behind_them() {
    let corner = |i: usize| [0, 1, 2].map(|k| f64::from((i >> k & 1) as u8));
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let room = SceneObject { name: "room".to_owned(), vertices: (0..8).map(corner).collect(), triangles };
    let scene = Scene::new(vec![room]).unwrap();
    let volume = Aabb { min: [0.0, 0.0, 0.0], max: [0.5, 0.5, 1.0] };
    let targets = [Aabb { min: [3.0, -1.0, 4.0], max: [3.5, -1.0, 4.0] }, Aabb { min: [0.7; 3], max: [0.8; 3] }];
    for seed in 0..20 {
        let found = sampled_view(&scene, &volume, &targets, 20_000, seed);
        assert_eq!(found.unseen().collect::<Vec<_>>(), [0], "{found:?}");
    }
}

/// Slits a hundredth wide, crossed: one uniform ray in more than 10,000 passes.
#[test]
fn slits_are_found() {
    for seed in 0..20 {
        let scene = slits([0.2, 0.21], [-0.11, -0.1]);
        let found = sampled_view(&scene, &VOLUME, &[behind()], 20_000, seed);
        assert_eq!(assert_segments_are_clear(&scene, &VOLUME, &[behind()], &found), 1, "seed {seed}");
        assert!(found.n_rays < 20_000, "seed {seed}");
    }
}

#[test]
fn cracks_are_no_slits() {
    for crack in [[0.2, 0.2], [0.2, 0.2 + 1e-6]] {
        let scene = slits(crack, [-0.11, -0.1]);
        let found = sampled_view(&scene, &VOLUME, &[behind()], 50_000, 3);
        assert_eq!(found.first, [None]);
    }
}

/// Behind a slit it is known which targets are seen: exactly those are, on every run, with any number of threads.
#[test]
fn segments_reach_all_that_is_seen_and_repeat() {
    let scene = slits([0.2, 0.21], [-0.4, 0.3]);
    let target = |i: i32| {
        let x = 0.15 * f64::from(i) - 3.0;
        Aabb { min: [x, -0.5, 9.0], max: [x + 0.1, 0.5, 12.0] }
    };
    let targets: Vec<Aabb<3>> = (0..40).map(target).collect();
    let ask = || sampled_view(&scene, &VOLUME, &targets, 100_000, 5);
    let many = ask();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(ask), many);
    let n_seen = assert_segments_are_clear(&scene, &VOLUME, &targets, &many);
    // The outermost lines, from the near face to the far end: from -0.5 through 0.21, and from 0.5 through 0.2.
    let is_seen = |b: &Aabb<3>| b.min[0] < 0.21 + 0.71 * 8.0 / 3.5 && b.max[0] > 0.2 - 0.3 * 8.0 / 3.5;
    let hidden: Vec<usize> = (0..40).filter(|&i| !is_seen(&targets[i])).collect();
    assert_eq!(many.unseen().collect::<Vec<_>>(), hidden);
    assert!(n_seen > 10 && hidden.len() > 20, "{n_seen} {}", hidden.len());
}

#[test]
fn segments_are_blocked_up_to_their_ends() {
    let rays = RayScene::new(&rectangles(&[[-3., -3., 3., 3., 5.]]));
    let blocked = |z: f64| rays.is_blocked([0.5, 0.25, 0.0], [1.0, 0.5, z]);
    assert_eq!([4.9, 5.0, 9.0, -9.0].map(blocked), [false, true, true, false]);
    // A segment that only grazes is no witness.
    assert!(!rays.is_blocked([3.000_001, 0., 0.], [3.000_001, 0., 9.]));
    assert!(!is_clear(&rays, [3.000_001, 0., 0.], [3.000_001, 0., 9.]));
    assert!(is_clear(&rays, [3.001, 0., 0.], [3.001, 0., 9.]) && is_clear(&rays, [0.; 3], [0.; 3]));
}

/// The benchmark: 30 to 60 % of its boxes are hidden from the smaller volume, fewer from the larger; and seven times the
/// rays see hardly more.
#[test]
fn the_benchmark_hides_about_half() {
    let mut n_seen = 0;
    for (tilt, seed) in [(0, 1), (0, 2), (0, 3), (30, 1), (60, 1), (60, 2)] {
        let made = occlusion(OcclusionOptions { seed, tilt, ..OcclusionOptions::default() }).unwrap();
        let n = made.occludees.len();
        let mut unseen = |half: f64, n_rays: u64| {
            let volume = Occlusion::volume(half);
            let found = sampled_view(&made.scene, &volume, &made.occludees, n_rays, seed);
            n_seen += assert_segments_are_clear(&made.scene, &volume, &made.occludees, &found);
            found.unseen().collect::<Vec<_>>()
        };
        let [small, more, large] = [(0.25, 60_000), (0.25, 400_000), (0.5, 60_000)].map(|(half, n)| unseen(half, n));
        assert!(3 * n <= 10 * more.len() && 10 * more.len() <= 6 * n, "tilt {tilt}, seed {seed}: {}", more.len());
        assert!(more.iter().all(|i| small.contains(i)) && small.len() - more.len() <= n / 25, "{}", small.len());
        assert!(large.len() < small.len() && 2 * large.len() > small.len(), "{} {}", large.len(), small.len());
    }
    assert!(n_seen > 2000, "{n_seen}");
}

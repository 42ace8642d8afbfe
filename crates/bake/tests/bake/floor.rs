//! Floor plans cut from scenes, against rays in the scenes: a level segment is blocked by triangles if and only if it is blocked by the
//! lines of the plan.

use sightlines_bake::{FloorCut, FloorCutError, floor_cut};
use sightlines_cells::{MovingObject, Plan, PlanLine, Scene, SceneObject};
use sightlines_formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines_geometry::{Point2, Point3};
use sightlines_pvs::Axis;
use sightlines_scenes::{CityOptions, TowerOptions, city, tower};
use sightlines_testkit::mutate::SplitMix;

/// The faces of a box.
fn boxed(name: &str, min: Point3, max: Point3) -> SceneObject {
    let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }) };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[p, q, r, s]| [[p, q, r], [p, r, s]]).collect();
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
}

fn lines(plan: &Plan) -> Vec<[f64; 4]> {
    let ordered = |l: &PlanLine| {
        let (a, b) = if (l.a.x, l.a.y) < (l.b.x, l.b.y) { (l.a, l.b) } else { (l.b, l.a) };
        [a.x, a.y, b.x, b.y]
    };
    let mut all: Vec<_> = plan.lines().iter().map(ordered).collect();
    all.sort_by(|a, b| a.partial_cmp(b).unwrap());
    all
}

#[test]
fn a_box_is_a_rectangle_at_every_height() {
    let scene = Scene::new(vec![boxed("a", [1.0, 2.0, 3.0], [5.0, 8.0, 10.0])]).unwrap();
    // x is x, and y is -z.
    let expected = [[1., -10., 1., -3.], [1., -10., 5., -10.], [1., -3., 5., -3.], [5., -10., 5., -3.]];
    for (height, n_flat, n_joined) in [(5.0, 0, 4), (2.0, 2, 0), (8.0, 2, 0), (2.1, 0, 4)] {
        let cut = floor_cut(&scene, Axis::Y, height).unwrap();
        assert_eq!(lines(&cut.plan), expected, "{height}");
        assert_eq!((cut.n_flat, cut.n_joined), (n_flat, n_joined), "{height}");
    }
    let sides = |up| lines(&floor_cut(&scene, up, 4.0).unwrap().plan);
    assert_eq!(sides(Axis::Z), [[1., 2., 1., 8.], [1., 2., 5., 2.], [1., 8., 5., 8.], [5., 2., 5., 8.]]);
    assert_eq!(sides(Axis::X), [[2., 3., 2., 10.], [2., 3., 8., 3.], [2., 10., 8., 10.], [8., 3., 8., 10.]]);
    let error = |height| floor_cut(&scene, Axis::Y, height).unwrap_err().to_string();
    assert_eq!(error(9.0), "nothing is cut at the height 9: the scene is from 2 to 8");
    assert_eq!(error(f64::NAN), "the height: coordinate NaN is not a finite number");
    let empty = floor_cut(&Scene::default(), Axis::Y, 1.0).unwrap_err();
    assert_eq!(empty, FloorCutError::Nothing { height: 1.0, extent: None });
}

#[test]
fn a_triangle_that_touches_gives_its_edge_and_no_corner() {
    let scene = |corners: [Point3; 3]| {
        Scene::new(vec![SceneObject { name: String::new(), vertices: corners.to_vec(), triangles: vec![[0, 1, 2]] }])
            .unwrap()
    };
    let at_two = |corners| floor_cut(&scene(corners), Axis::Z, 2.0).map(|cut| lines(&cut.plan));
    assert_eq!(at_two([[0., 0., 2.], [4., 1., 2.], [0., 4., 5.]]).unwrap(), [[0., 0., 4., 1.]]);
    assert_eq!(at_two([[0., 0., 2.], [4., 1., 3.], [0., 4., 1.]]).unwrap(), [[0., 0., 2., 2.5]]);
    for nothing in [[[0., 0., 2.], [4., 1., 3.], [0., 4., 5.]], [[0., 0., 2.], [4., 1., 2.], [0., 4., 2.]]] {
        assert!(at_two(nothing).is_err());
    }
}

#[test]
fn see_through_things_are_transparent_and_doors_and_movers_are_left_out() {
    let at = |x: f64| boxed("b", [x, 0.0, 0.0], [x + 1.0, 3.0, 1.0]);
    let scene = Scene::new((0..5).map(|k| at(f64::from(k) * 2.0)).collect()).unwrap();
    let scene = scene.with_see_through(vec![1]).unwrap().with_mirrors(vec![2]).unwrap().with_doors(vec![3]).unwrap();
    let scene = scene.with_moving(vec![MovingObject { object: 4, within: None }]).unwrap();
    let FloorCut { plan, .. } = floor_cut(&scene, Axis::Y, 1.0).unwrap();
    let of = |k: i32| {
        plan.lines()
            .iter()
            .enumerate()
            .filter(move |(_, l)| l.a.x.max(l.b.x) <= f64::from(2 * k + 1) && l.a.x >= f64::from(2 * k))
    };
    assert_eq!([0, 1, 2, 3, 4].map(|k| of(k).count()), [4, 4, 4, 0, 0]);
    assert!(of(0).chain(of(2)).all(|(_, line)| line.opaque) && of(1).all(|(_, line)| !line.opaque));
    let mirrors: Vec<usize> = plan.mirrors().iter().map(|id| id.0 as usize).collect();
    assert_eq!(mirrors, of(2).map(|(k, _)| k).collect::<Vec<_>>());
}

/// Whether the segment crosses something, by the signs of two determinants on each side; `None` where one is too small to be sure.
fn all_same(signs: &[f64], scale: f64) -> Option<bool> {
    let sure = |x: &f64| x.abs() > 1e-7 * scale;
    if signs.iter().any(|x| signs.iter().any(|y| sure(x) && sure(y) && x * y < 0.0)) {
        return Some(false);
    }
    signs.iter().all(sure).then_some(true)
}

fn both(a: Option<bool>, b: Option<bool>) -> Option<bool> {
    match (a, b) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    }
}

/// Whether any blocks; a sure one decides.
fn any(all: impl Iterator<Item = Option<bool>>) -> Option<bool> {
    let mut found = Some(false);
    for one in all {
        match one {
            Some(true) => return Some(true),
            None => found = None,
            Some(false) => {}
        }
    }
    found
}

fn determinant(o: Point3, a: Point3, b: Point3, c: Point3) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| [p[0] - o[0], p[1] - o[1], p[2] - o[2]]);
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// Whether a segment meets a triangle.
fn meets([p, q]: [Point3; 2], [a, b, c]: [Point3; 3], scale: f64) -> Option<bool> {
    let through = [determinant(p, q, a, b), determinant(p, q, b, c), determinant(p, q, c, a)];
    let sides = [determinant(p, a, b, c), -determinant(q, a, b, c)];
    both(all_same(&through, scale * scale * scale), all_same(&sides, scale * scale * scale))
}

/// Whether two segments of a plane cross.
fn crosses([p, q]: [Point2; 2], line: &PlanLine, scale: f64) -> Option<bool> {
    let turn = |a: Point2, b: Point2, c: Point2| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    let (ends, sides) =
        ([turn(p, q, line.a), -turn(p, q, line.b)], [turn(line.a, line.b, p), -turn(line.a, line.b, q)]);
    both(all_same(&ends, scale * scale), all_same(&sides, scale * scale))
}

/// Shoots level segments at a height of a scene with y up; how many are blocked and free in both, and how many differ.
fn compare(scene: &Scene, plan: &Plan, height: f64, n: usize, seed: u64) -> [usize; 3] {
    let mut random = SplitMix::new(seed);
    let bounds = scene.bounds();
    let mut number = |k: usize| {
        let share = random.next() as f64 / u64::MAX as f64;
        bounds.min[k] + share * (bounds.max[k] - bounds.min[k])
    };
    // Of those triangles that reach the height, all but a few are far from any segment.
    let near = |t: &[Point3; 3]| t.iter().any(|p| p[1] <= height) && t.iter().any(|p| p[1] >= height);
    let triangles: Vec<[Point3; 3]> = scene.occluding_triangles().filter(near).collect();
    let scale = (0..3).map(|k| bounds.max[k] - bounds.min[k]).fold(0.0, f64::max).min(40.0);
    let mut counts = [0; 3];
    for k in 0..n {
        let p = [number(0), number(2)];
        // Most of them short, so that some are free.
        let reach = if k % 4 == 0 { 1.0 } else { 0.04 };
        let q = [p[0] + reach * (number(0) - p[0]), p[1] + reach * (number(2) - p[1])];
        let ends = [[p[0], height, p[1]], [q[0], height, q[1]]];
        let by_rays = any(triangles.iter().map(|&t| meets(ends, t, scale * reach.max(0.1))));
        let flat = [Point2::new(p[0], -p[1]), Point2::new(q[0], -q[1])];
        let by_plan =
            any(plan.lines().iter().filter(|l| l.opaque).map(|line| crosses(flat, line, scale * reach.max(0.1))));
        match (by_rays, by_plan) {
            (Some(true), Some(true)) => counts[0] += 1,
            (Some(false), Some(false)) => counts[1] += 1,
            (Some(_), Some(_)) => counts[2] += 1,
            _ => {}
        }
    }
    counts
}

fn generated() -> Vec<(Scene, Vec<f64>)> {
    let tower = |seed| {
        tower(TowerOptions { seed, floors: 2, rooms_x: 3, rooms_y: 2, furniture: 1, ..TowerOptions::default() })
            .unwrap()
    };
    vec![
        (tower(1), vec![0.37, 1.234, 2.9, 4.61]),
        (tower(2), vec![1.1, 3.333]),
        (city(CityOptions { blocks_x: 4, blocks_z: 4, ..CityOptions::default() }).unwrap(), vec![0.5, 3.1, 11.7]),
    ]
}

#[test]
fn level_rays_in_generated_buildings_are_blocked_as_in_their_plans() {
    let mut total = [0; 3];
    for (scene, heights) in generated() {
        for height in heights {
            let cut = floor_cut(&scene, Axis::Y, height).unwrap();
            assert_eq!(cut.n_flat, 0);
            let found = compare(&scene, &cut.plan, height, 300, 5);
            assert_eq!(found[2], 0, "{height}: {found:?}");
            total = [0, 1, 2].map(|k| total[k] + found[k]);
            // Impostors: the plan seen from below, a plan of half the lines.
            let turned = cut.plan.lines().iter().map(|l| (Point2::new(l.a.x, -l.a.y), Point2::new(l.b.x, -l.b.y)));
            let half = cut.plan.lines().iter().step_by(2).map(|l| (l.a, l.b));
            for impostor in [Plan::from_walls(turned).unwrap(), Plan::from_walls(half).unwrap()] {
                assert!(compare(&scene, &impostor, height, 300, 5)[2] > 0, "{height}");
            }
        }
    }
    assert!(total[0] > 500 && total[1] > 500, "{total:?}");
}

/// The same in real buildings, some of which have slanted walls, so that points are rounded.
#[test]
fn level_rays_in_real_buildings_are_blocked_as_in_their_plans() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED: SIGHTLINES_DATA is not set, so real data is not tested");
        return;
    };
    let mut n_scenes = 0;
    for name in ["duplex", "office_a", "whale_large", "sponza"] {
        let path = std::path::Path::new(&data).join("scenes").join(name).join(format!("{name}.glb"));
        let drawn = SceneReadOptions { backs: BackFaces::Drawn, ..SceneReadOptions::default() };
        let file = read_scene_with(&path, &drawn).unwrap();
        let fronts = read_scene_with(&path, &SceneReadOptions::default()).unwrap().scene;
        let bounds = file.scene.bounds();
        let mut total = [0; 3];
        for share in [0.21, 0.437, 0.68] {
            let height = bounds.min[1] + share * (bounds.max[1] - bounds.min[1]);
            let cut = floor_cut(&file.scene, file.info.up, height).unwrap();
            assert_eq!(floor_cut(&fronts, file.info.up, height).unwrap().plan, cut.plan, "walls of one side are walls");
            let found = compare(&file.scene, &cut.plan, height, 150, 9);
            assert_eq!(found[2], 0, "{name} at {height}: {found:?}");
            total = [0, 1, 2].map(|k| total[k] + found[k]);
            eprintln!(
                "{name} at {height}: {} triangles, {} lines, {} joined",
                cut.n_cut,
                cut.plan.lines().len(),
                cut.n_joined
            );
        }
        eprintln!("{name}: {total:?}");
        assert!(total[0] > 20 && total[1] > 20, "{name}: {total:?}");
        n_scenes += 1;
    }
    assert_eq!(n_scenes, 4);
}

use super::*;
use crate::measure::{MeasureOptions, measure};
use crate::measure_aimed;
use crate::{Simplified, estimate};
use crate::{bound, geometric};
use proptest::prelude::*;
use sightlines_cells::SceneObject;
use sightlines_geometry::{Point3, Random};
use sightlines_multifocal::mesh::{SheetMethod, Sheets};
use sightlines_multifocal::{FromRegion, Volume};
use sightlines_scenes::{
    CityOptions, SurfaceOptions, TowerOptions, city, city_crossings, surfaces, tower, tower_rooms,
};
use sightlines_visible_surface::{Camera, FaceMask, NOTHING, RayCaster, RenderInput, VisibleSurface};
use std::sync::Arc;

fn volume(min: Point3, max: Point3) -> Volume {
    Volume::new(Aabb { min, max }).unwrap()
}

fn views(min: Point3, max: Point3) -> Views {
    Views::new([volume(min, max)]).unwrap()
}

/// Runs with sheets as the method.
fn with_sheets<T>(scene: &Scene, run: impl FnOnce(&HiddenBy<'_>) -> T) -> T {
    let triangles: Vec<[Point3; 3]> = scene.objects().iter().flat_map(|o| o.corners()).collect();
    let sheets = Arc::new(Sheets::new(&triangles));
    let make = move || Box::new(SheetMethod::shared(Arc::clone(&sheets))) as Box<dyn FromRegion + Send>;
    run(&HiddenBy { method: Some(&make), table: None })
}

fn simplified(scene: &Scene, views: &Views, options: &SimplifyOptions) -> Simplified {
    with_sheets(scene, |by| simplify(scene, views, by, options)).unwrap()
}

/// A small tower and the boxes of some rooms in it.
fn small_tower() -> (Scene, Vec<Aabb<3>>) {
    let options = TowerOptions { floors: 2, rooms_x: 2, rooms_y: 2, furniture: 1, ..TowerOptions::default() };
    let rooms = tower_rooms(options).unwrap().into_iter().map(|r| r.bounds).collect();
    (tower(options).unwrap(), rooms)
}

/// A surface of n by n squares, bent by a random height at each corner, at a distance along z.
fn terrain(n: u32, z: f64, bend: f64, seed: u64) -> SceneObject {
    let mut random = Random::new(seed);
    let at = |x: u32, y: u32| y * (n + 1) + x;
    let vertices = (0..(n + 1) * (n + 1))
        .map(|i| [f64::from(i % (n + 1)), f64::from(i / (n + 1)), z + bend * random.unit()])
        .collect();
    let squares = (0..n).flat_map(|y| (0..n).map(move |x| (x, y)));
    let triangles = squares
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    SceneObject { name: format!("terrain {seed}"), vertices, triangles }
}

/// The faces visible from an eye, in pictures of the whole sphere.
fn panorama(faces: &Faces, caster: &RayCaster, eye: Point3, n: u32) -> Vec<u32> {
    let mut all = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let unit = |k: usize, s: f64| std::array::from_fn(|i| if i == k { s } else { 0.0 });
            let [i, j] = [(axis + 1) % 3, (axis + 2) % 3];
            let step = 2.0 / f64::from(n);
            let mut corner: Point3 = unit(axis, sign);
            (corner[i], corner[j]) = (-1.0, -1.0);
            let camera = Camera::new(eye, corner, unit(i, step), unit(j, step), [n, n]).unwrap();
            let chosen = FaceMask::all(faces);
            all.extend_from_slice(caster.picture(&RenderInput { faces, camera: &camera, mask: &chosen }).0.faces());
        }
    }
    all
}

/// How many pixels of panoramas from random eyes show another face.
fn changed_pixels(scene: &Scene, left: &Simplified, views: &Views, n_eyes: usize, n: u32) -> (usize, usize) {
    let before = Faces::of_scene(scene).unwrap();
    let after = Faces::of_scene(&left.scene(scene).unwrap()).unwrap();
    let mut origin = Vec::new();
    let mut first = 0;
    for (object, of) in scene.objects().iter().zip(&left.origin) {
        origin.extend(of.iter().map(|o| o.map(|k| first + k)));
        first += object.triangles.len() as u32;
    }
    let casters = [&before, &after].map(RayCaster::build);
    let places = crate::estimate::EyeSampler::new(views);
    let mut random = Random::new(77);
    let (mut changed, mut all) = (0, 0);
    for _ in 0..n_eyes {
        let eye = places.any(&mut random);
        let [a, b] = [panorama(&before, &casters[0], eye, n), panorama(&after, &casters[1], eye, n)];
        all += a.len();
        let face = |b: u32| if b == NOTHING { Some(NOTHING) } else { origin[b as usize] };
        changed += a.iter().zip(&b).filter(|(a, b)| Some(**a) != face(**b)).count();
    }
    (changed, all)
}

#[test]
fn no_budget_changes_no_pixel() {
    let (scene, rooms) = small_tower();
    let streets = CityOptions { blocks_x: 2, blocks_z: 2, ..CityOptions::default() };
    let crossing = city_crossings(streets).unwrap()[0];
    let cases = [
        ("tower", scene.clone(), rooms[0]),
        ("upper floor", scene, *rooms.last().unwrap()),
        ("city", city(streets).unwrap(), crossing),
    ];
    for (name, scene, b) in cases {
        let views = views(b.min, b.max);
        let left = simplified(&scene, &views, &SimplifyOptions::default());
        let (changed, all) = changed_pixels(&scene, &left, &views, 40, 12);
        assert_eq!((changed, left.bound), (0, 0.0), "{name}: of {all}");
        // And much is removed.
        let Counts { before, hidden, left: n, .. } = left.counts;
        assert!(n + hidden == before && hidden * 2 > before, "{name}: {:?}", left.counts);
        assert!(left.is_part_of_the_original());
        // An impostor: one visible face less.
        let mut wrong = left.clone();
        let estimate = HitEstimate::new(&Faces::of_scene(&scene).unwrap(), &views, 4096);
        let mut face = 0;
        let seen = |object: usize, k: u32| {
            let first: usize = scene.objects()[..object].iter().map(|o| o.triangles.len()).sum();
            estimate.hits(first as u32 + k) > 20
        };
        'search: for object in 0..wrong.origin.len() {
            for k in 0..wrong.origin[object].len() {
                if wrong.origin[object][k].is_some_and(|of| seen(object, of)) {
                    wrong.origin[object].remove(k);
                    wrong.triangles[object].remove(k);
                    face += 1;
                    break 'search;
                }
            }
        }
        assert_eq!(face, 1);
        assert!(changed_pixels(&scene, &wrong, &views, 40, 12).0 > 0, "{name}");
    }
}

/// The same of a real scene, from a view cell in its courtyard.
#[test]
fn no_budget_changes_no_pixel_of_a_real_scene() {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA").map(std::path::PathBuf::from) else {
        eprintln!("SKIPPED: SIGHTLINES_DATA is not set, so real data is not tested");
        return;
    };
    let folder = data.join("scenes/sponza");
    let scene = sightlines_formats::scene::read_scene(folder.join("sponza.glb")).unwrap().scene;
    let cells = sightlines_formats::view_cells::read_view_cells(folder.join("cells_walk.json")).unwrap().cells;
    let b = cells[cells.len() / 2].bounds;
    let views = views(b.min, b.max);
    let left = simplified(&scene, &views, &SimplifyOptions::default());
    let (changed, all) = changed_pixels(&scene, &left, &views, 24, 12);
    assert_eq!((changed, left.bound), (0, 0.0), "of {all}");
    assert!(all == 24 * 6 * 144 && left.counts.hidden * 10 > left.counts.before, "{:?}", left.counts);
}

/// Whether a measured share can be at most `bound`: of all rays, and of the worst eye's, except by chance.
fn check(measured: &crate::Measured, bound: f64, n_rays: u64, n_eyes: usize) -> Result<(), TestCaseError> {
    let low =
        |share: f64, n: u64, wrong: f64| estimate::interval((share * n as f64).round() as u64, n, 1.0 - wrong).ends[0];
    prop_assert!(low(measured.changed, measured.n_rays, 1e-9) <= bound, "{:?} {}", measured, bound);
    prop_assert!(low(measured.worst, n_rays, 1e-9 / n_eyes as f64) <= bound, "{:?} {}", measured, bound);
    Ok(())
}

proptest! {
    /// Random triangles, views among them, any budget.
    #[test]
    fn the_promise_is_kept(
        seed: u64,
        at in prop::array::uniform3(-3.0..3.0f64),
        size in prop::array::uniform3(prop_oneof![Just(0.0), 0.0..2.0f64]),
        budget in prop_oneof![1e-3..0.3f64, Just(0.0), Just(1.0)],
        collapse in prop_oneof![Just(0.0), Just(0.5), Just(1.0)],
        family in 0..3,
    ) {
        let scene = match family {
            0 => surfaces::soup(SurfaceOptions { seed, triangles: 100, ..SurfaceOptions::default() }).unwrap(),
            1 => Scene::new(vec![terrain(5, 12.0, 1.0, seed), terrain(4, 9.0, 0.2, seed ^ 1)]).unwrap(),
            _ => city(CityOptions { seed, blocks_x: 1, blocks_z: 1, detail: 1 }).unwrap(),
        };
        let max = [0, 1, 2].map(|k| at[k] + size[k]);
        let views = views(at, max);
        let flat = seed.is_multiple_of(2);
        let options = SimplifyOptions { budget, collapse, flat, n_parts: 3, n_rays: 1000, ..SimplifyOptions::default() };
        let left = simplified(&scene, &views, &options);
        prop_assert!(left.bound <= budget);
        let options = MeasureOptions { n_eyes: 8, n_rays: 500, seed, threads: 1 };
        let measured = measure(&scene, &left, &views, &options).unwrap();
        check(&measured, left.bound, 500, 8)?;
        if left.bound == 0.0 {
            prop_assert_eq!(measured.changed, 0.0);
        }
        let c = left.counts;
        prop_assert_eq!(c.before + c.new, c.without_area + c.hidden + c.deleted + c.collapsed + c.merged_away + c.left);
    }
}

/// Aimed rays find the same shares as rays in all directions.
#[test]
fn aimed_rays_agree_with_others() {
    let streets = CityOptions { blocks_x: 2, blocks_z: 2, ..CityOptions::default() };
    let scene = city(streets).unwrap();
    let b = city_crossings(streets).unwrap()[0];
    let views = views(b.min, b.max);
    for (budget, collapse) in [(0.0, 0.0), (0.02, 0.0), (0.02, 1.0)] {
        let options = SimplifyOptions { budget, collapse, ..SimplifyOptions::default() };
        let left = simplified(&scene, &views, &options);
        let options = MeasureOptions { n_eyes: 6, n_rays: 20_000, ..MeasureOptions::default() };
        let all = measure(&scene, &left, &views, &options).unwrap();
        let aimed = measure_aimed(&scene, &left, &views, &options).unwrap();
        // By chance, 120,000 rays are off by the root of the share over that; aimed ones by much less.
        let chance = 5.0 * (all.changed / 120_000.0).sqrt() + 1e-6;
        assert!((all.changed - aimed.changed).abs() <= chance, "{all:?} {aimed:?}");
        assert!(aimed.worst <= left.bound + 4.0 * aimed.worst_error, "{aimed:?} {}", left.bound);
        assert!(aimed.worst_error <= aimed.worst / 20.0, "{aimed:?}");
        assert_eq!(aimed.worst > 0.0, budget > 0.0);
    }
    // And a budget that is exceeded tenfold is detected.
    let tenfold = simplified(&scene, &views, &SimplifyOptions::default().with_budget(1e-3));
    let options = MeasureOptions { n_eyes: 6, n_rays: 2000, ..MeasureOptions::default() };
    let aimed = measure_aimed(&scene, &tenfold, &views, &options).unwrap();
    assert!(aimed.worst - 4.0 * aimed.worst_error > 1e-4, "{aimed:?}");
}

/// The bound is not far from tight: where the budget permits a share, some of it is used.
#[test]
fn budgets_are_used() {
    let streets = CityOptions { blocks_x: 3, blocks_z: 3, ..CityOptions::default() };
    let scene = city(streets).unwrap();
    let b = city_crossings(streets).unwrap()[0];
    let views = views(b.min, b.max);
    let left = |budget: f64, collapse: f64| {
        simplified(&scene, &views, &SimplifyOptions { budget, collapse, ..SimplifyOptions::default() })
    };
    let all = [0.0, 1e-3, 1e-2, 0.1].map(|budget| left(budget, 0.0));
    let sizes = all.each_ref().map(|left| left.counts.left);
    assert!(sizes.windows(2).all(|w| w[1] < w[0]), "{sizes:?}");
    let [.., tenth] = all;
    let options = MeasureOptions { n_eyes: 20, n_rays: 2000, ..MeasureOptions::default() };
    let measured = measure(&scene, &tenth, &views, &options).unwrap();
    // Bounds are sums over faces that partly hide each other.
    assert!(tenth.bound > 0.09 && measured.changed > 0.02 && measured.worst <= 0.1, "{} {measured:?}", tenth.bound);
    let tenth = left(0.1, 1.0);
    assert!(tenth.counts.new > 0 && tenth.counts.collapsed > tenth.counts.new, "{:?}", tenth.counts);
}

/// Simplification that breaks its guarantee is detected by the same measurement.
#[test]
fn a_broken_promise_is_measured() {
    let scene = Scene::new(vec![terrain(16, 9.0, 1.0, 3)]).unwrap();
    let views = views([4.0, 4.0, 0.0], [8.0, 8.0, 2.0]);
    let options = MeasureOptions { n_eyes: 20, n_rays: 2000, ..MeasureOptions::default() };
    let is_refused = |left: &Simplified, bound: f64| {
        check(&measure(&scene, left, &views, &options).unwrap(), bound, 2000, 20).is_err()
    };
    let good = simplified(&scene, &views, &SimplifyOptions::default().with_budget(0.05));
    assert!(!is_refused(&good, good.bound));
    // Made for another place; by shape alone; for a budget ten times as large.
    let elsewhere = self::views([4.0, 4.0, 200.0], [8.0, 8.0, 220.0]);
    let other = simplified(&scene, &elsewhere, &SimplifyOptions::default().with_budget(0.05));
    let shape = geometric(&scene, good.counts.left).unwrap();
    let tenfold =
        simplified(&scene, &views, &SimplifyOptions { collapse: 0.0, ..SimplifyOptions::default() }.with_budget(0.5));
    for (name, wrong) in [("elsewhere", other), ("shape", shape), ("tenfold", tenfold)] {
        assert!(is_refused(&wrong, good.bound), "{name}");
    }
}

/// At equal counts, the visible change is less than with the ordinary metric.
#[test]
fn the_geometric_metric_changes_more() {
    let far = |seed| {
        let mut far = terrain(24, 9.0, 1.0, seed);
        // Most of it is far away.
        far.vertices.iter_mut().for_each(|v| *v = [v[0] * v[0], v[1] * v[1], v[2]]);
        far
    };
    let scene = Scene::new(vec![far(1)]).unwrap();
    let views = views([0.0, 0.0, 0.0], [2.0, 2.0, 2.0]);
    let ours = simplified(&scene, &views, &SimplifyOptions::default().with_budget(0.01));
    let theirs = geometric(&scene, ours.counts.left).unwrap();
    assert!(ours.counts.left < ours.counts.before * 3 / 4, "{:?}", ours.counts);
    assert!(theirs.counts.left <= ours.counts.left);
    let measured = [&ours, &theirs].map(|s| measure(&scene, s, &views, &MeasureOptions::default()).unwrap());
    assert!(measured[0].changed * 5.0 < measured[1].changed, "{measured:?}");
    assert!(measured[0].moved < measured[1].moved, "{measured:?}");
}

/// Merged faces cover what was covered, and nothing else.
#[test]
fn merging_changes_no_surface() {
    let streets = CityOptions { blocks_x: 2, blocks_z: 2, ..CityOptions::default() };
    let scene = city(streets).unwrap();
    let b = city_crossings(streets).unwrap()[0];
    let views = views(b.min, b.max);
    let options = SimplifyOptions { flat: true, ..SimplifyOptions::default() };
    let left = simplified(&scene, &views, &options);
    let Counts { hidden, merged_away, left: n, before, .. } = left.counts;
    assert!(n * 2 < before - hidden && merged_away > 0 && left.is_part_of_the_original(), "{:?}", left.counts);
    // From anywhere, the result looks like the result without merging.
    let plain = simplified(&scene, &views, &SimplifyOptions::default());
    let plain = plain.scene(&scene).unwrap();
    let all = simplified(
        &plain,
        &self::views(scene.bounds().min, scene.bounds().max),
        &SimplifyOptions { n_parts: 1, ..options },
    );
    let anywhere = self::views(scene.bounds().min, scene.bounds().max.map(|x| x + 50.0));
    let measure_options = MeasureOptions { n_eyes: 50, n_rays: 2000, ..MeasureOptions::default() };
    let measured = measure(&plain, &all, &anywhere, &measure_options).unwrap();
    assert_eq!((measured.changed, measured.other_object), (0.0, 0.0), "{:?}", all.counts);
    // If bent ever so slightly, nothing is merged.
    let mut random = Random::new(8);
    let mut bent = terrain(6, 3.0, 0.0, 1);
    bent.vertices.iter_mut().for_each(|v| {
        if random.unit() < 0.5 {
            v[2] = v[2].next_up();
        }
    });
    let bent = Scene::new(vec![bent]).unwrap();
    let mut mesh = Mesh::new(&bent);
    crate::mesh::merge(&mut mesh);
    assert!(mesh.n_left() > 50, "{}", mesh.n_left());
    let mut mesh = Mesh::new(&Scene::new(vec![terrain(6, 3.0, 0.0, 1)]).unwrap());
    crate::mesh::merge(&mut mesh);
    assert_eq!(mesh.n_left(), 2);
}

#[test]
fn collapsing_keeps_what_belongs_to_vertices() {
    // Two sheets of one object that share places but not vertices, as at a seam of texture coordinates; and another
    // object next to them.
    let mut seam = terrain(8, 30.0, 0.1, 4);
    let n = seam.vertices.len() as u32;
    seam.vertices.extend(seam.vertices.clone());
    for (k, t) in seam.triangles.iter_mut().enumerate() {
        if (k / 2) % 8 >= 4 {
            *t = t.map(|v| v + n);
        }
    }
    let mut beside = terrain(8, 30.0, 0.1, 4);
    beside.vertices.iter_mut().for_each(|v| v[0] += 8.0);
    for y in 0..9 {
        beside.vertices[y * 9] = seam.vertices[y * 9 + 8];
    }
    let scene = Scene::new(vec![seam, beside]).unwrap();
    let views = views([8.0, 4.0, 0.0], [9.0, 5.0, 1.0]);
    let options = SimplifyOptions { collapse: 1.0, shift: 0.1, ..SimplifyOptions::default().with_budget(0.05) };
    let left = simplified(&scene, &views, &options);
    assert!(left.counts.new > 10 && left.deviation > 0.0, "{:?}", left.counts);
    // One side of the seam has its vertices, the other side the copies; both still meet all along it.
    let seam_of = |t: &[u32; 3]| t.iter().filter(|&&v| v >= n).count();
    assert!(left.triangles[0].iter().all(|t| [0, 3].contains(&seam_of(t))));
    let on_seam = |copies: bool| {
        let mut ys: Vec<u32> = left.triangles[0]
            .iter()
            .flatten()
            .filter(|&&v| (v >= n) == copies && v % n % 9 == 4)
            .map(|v| v % n / 9)
            .collect();
        ys.sort_unstable();
        ys.dedup();
        ys
    };
    assert_eq!(on_seam(false), on_seam(true));
    // No cracks: every edge of the mesh that is not on its outer border is shared.
    let after = left.scene(&scene).unwrap();
    let mesh = Mesh::new(&after);
    for place in 0..mesh.n_places() as u32 {
        for (other, faces) in mesh.around(place) {
            let [p, q] = [place, other].map(|p| mesh.place(p));
            let along = |k: usize, x: f64| p[k] == x && q[k] == x;
            let outer = along(0, 0.0) || along(0, 16.0) || along(1, 0.0) || along(1, 8.0);
            assert_eq!(faces, if outer { 1 } else { 2 }, "{p:?} {q:?}");
        }
    }
}

/// The distance of a point from a triangle: the least of those to its inside, sides and corners.
fn to_triangle(p: Point3, &[a, b, c]: &[Point3; 3]) -> f64 {
    let sub = |p: Point3, q: Point3| [0, 1, 2].map(|k| p[k] - q[k]);
    let dot = |p: Point3, q: Point3| (0..3).map(|k| p[k] * q[k]).sum::<f64>();
    let (u, v, w) = (sub(b, a), sub(c, a), sub(p, a));
    let [uu, uv, vv, wu, wv] = [dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)];
    let whole = uu * vv - uv * uv;
    let (s, t) = ((vv * wu - uv * wv) / whole, (uu * wv - uv * wu) / whole);
    let at = |s: f64, t: f64| {
        let d = [0, 1, 2].map(|k| w[k] - s * u[k] - t * v[k]);
        dot(d, d).sqrt()
    };
    if s >= 0.0 && t >= 0.0 && s + t <= 1.0 {
        return at(s, t);
    }
    let side = |from: Point3, to: Point3| {
        let (way, off) = (sub(to, from), sub(p, from));
        let t = (dot(off, way) / dot(way, way)).clamp(0.0, 1.0);
        let d = [0, 1, 2].map(|k| off[k] - t * way[k]);
        dot(d, d).sqrt()
    };
    side(a, b).min(side(b, c)).min(side(c, a))
}

/// The largest distance of points of one surface from another, by sampling.
fn far_from(from: &Scene, to: &Scene, random: &mut Random) -> f64 {
    let triangles = |s: &Scene| s.objects().iter().flat_map(|o| o.corners()).collect::<Vec<_>>();
    let to = triangles(to);
    let nearest = |p: Point3| to.iter().map(|t| to_triangle(p, t)).fold(f64::INFINITY, f64::min);
    let mut sample = |[a, b, c]: [Point3; 3]| {
        let (s, t) = (random.unit(), random.unit());
        let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
        nearest([0, 1, 2].map(|k| a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k])))
    };
    triangles(from).into_iter().map(&mut sample).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn surfaces_are_no_farther_apart_than_said(seed: u64, bend in 0.0..2.0f64, target in 4usize..60) {
        // Corners are moved within the plane, too.
        let mut bent = terrain(6, 0.0, bend, seed);
        let mut random = Random::new(seed ^ 5);
        bent.vertices.iter_mut().for_each(|v| *v = [v[0] + 0.7 * random.unit(), v[1] + 0.7 * random.unit(), v[2]]);
        let scene = Scene::new(vec![bent]).unwrap();
        let left = geometric(&scene, target).unwrap();
        let after = left.scene(&scene).unwrap();
        let apart = far_from(&scene, &after, &mut random).max(far_from(&after, &scene, &mut random));
        prop_assert!(apart <= left.deviation + 1e-12, "{} {}", apart, left.deviation);
    }
}

proptest! {
    /// Few triangles on few places: strips, single ones, ones that face different ways, and ones that intersect.
    #[test]
    fn small_meshes_are_no_farther_apart_than_said(
        places in prop::collection::vec(prop::array::uniform3(0i32..8), 4..9),
        triangles in prop::collection::vec(prop::array::uniform3(0u32..8), 1..9),
        objects in 1usize..3,
        seed: u64,
    ) {
        let vertices: Vec<Point3> = places.iter().map(|p| p.map(f64::from)).collect();
        let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(|i| i % vertices.len() as u32)).collect();
        let object = |of: &[[u32; 3]]| SceneObject { name: "x".into(), vertices: vertices.clone(), triangles: of.to_vec() };
        let scene = Scene::new(triangles.chunks(triangles.len().div_ceil(objects)).map(object).collect()).unwrap();
        let left = geometric(&scene, 1).unwrap();
        let after = left.scene(&scene).unwrap();
        let with_area: Vec<SceneObject> = scene.objects().iter().map(|o| {
            let faces = Faces::new(o.corners().collect()).unwrap();
            let triangles = faces.ids().filter(|&f| faces.has_area(f)).map(|f| o.triangles[f as usize]).collect();
            SceneObject { triangles, ..o.clone() }
        }).collect();
        let before = Scene::new(with_area).unwrap();
        prop_assume!(before.n_triangles() > 0);
        prop_assert!(after.n_triangles() > 0);
        let mut random = Random::new(seed);
        // The rounding of the measurement itself: on this grid it divides products of four differences, below (8 √3)^4
        // < 2^16, by a squared area of at least 1, and each product is off by no more than 16 units in the last place.
        let rounding = f64::exp2(16.0) * 16.0 * f64::EPSILON;
        for _ in 0..4 {
            let apart = far_from(&before, &after, &mut random).max(far_from(&after, &before, &mut random));
            prop_assert!(apart <= left.deviation + rounding, "{} {}", apart, left.deviation);
        }
    }
}

/// Cases in which single steps do not simply add up.
#[test]
fn ears_and_lone_triangles_count() {
    let object = |vertices: &[Point3], triangles: &[[u32; 3]]| SceneObject {
        name: "x".into(),
        vertices: vertices.to_vec(),
        triangles: triangles.to_vec(),
    };
    let strip = object(
        &[
            [0.171875, 0.203125, 0.3125],
            [0.625, 0.59375, 0.875],
            [1.234375, 0.15625, 0.375],
            [1.53125, 0.515625, 0.25],
            [2.015625, 0.09375, 0.75],
        ],
        &[[0, 2, 1], [1, 2, 3], [2, 4, 3]],
    );
    let mixed = object(
        &[[6., 5., 1.], [4., 1., 1.], [7., 6., 2.], [8., 6., 0.], [8., 2., 0.], [6., 1., 2.]],
        &[[5, 0, 4], [3, 4, 0], [3, 4, 5]],
    );
    for scene in [strip, mixed] {
        let scene = Scene::new(vec![scene]).unwrap();
        let left = geometric(&scene, 1).unwrap();
        let after = left.scene(&scene).unwrap();
        let mut random = Random::new(1);
        let apart = (0..500).map(|_| far_from(&scene, &after, &mut random)).fold(0.0, f64::max);
        assert!(apart <= left.deviation, "{apart} {}", left.deviation);
    }
    // An isolated triangle does not collapse to nothing.
    let lone = [
        object(&[[0.; 3], [1., 0., 0.], [0., 1., 0.]], &[[0, 1, 2]]),
        object(&[[1e3, 0., 0.], [1.1e3, 0., 0.], [1e3, 100., 0.]], &[[0, 1, 2]]),
    ];
    assert_eq!(geometric(&Scene::new(lone.to_vec()).unwrap(), 1).unwrap().counts.left, 2);
}

#[test]
fn flat_surfaces_do_not_move() {
    let scene = Scene::new(vec![terrain(8, 3.0, 0.0, 1)]).unwrap();
    let left = geometric(&scene, 2).unwrap();
    assert!(left.counts.left == 2 && left.deviation < 1e-10, "{left:?}");
    // A bent surface does collapse: the bound is not far above the sampled distance.
    let scene = Scene::new(vec![terrain(8, 3.0, 1.0, 1)]).unwrap();
    let left = geometric(&scene, 100).unwrap();
    let apart = far_from(&left.scene(&scene).unwrap(), &scene, &mut Random::new(1));
    assert!(apart > 0.05 && left.deviation < 20.0 * apart, "{apart} {}", left.deviation);
}

/// Corners, edges and faces of the views, where no random eye ever is.
#[test]
fn eyes_on_the_border_see_no_change() {
    let streets = CityOptions { blocks_x: 2, blocks_z: 2, ..CityOptions::default() };
    let scene = city(streets).unwrap();
    let b = city_crossings(streets).unwrap()[0];
    let left = simplified(&scene, &views(b.min, b.max), &SimplifyOptions::default());
    for place in 0..27 {
        let part = [place % 3, place / 3 % 3, place / 9].map(|third| f64::from(third) / 2.0);
        let eye = [0, 1, 2].map(|k| b.min[k] + part[k] * (b.max[k] - b.min[k]));
        assert_eq!(changed_pixels(&scene, &left, &views(eye, eye), 1, 12).0, 0, "{eye:?}");
    }
}

#[test]
fn sums_never_exceed_the_budget_by_refunds() {
    let mut account = crate::select::Account::new(1);
    let (a, b) = (0.009_947_183_943_243_58, 1e-19);
    assert!(account.spend(1.0, |_| a));
    account.refund(|_| b);
    assert_eq!(account.most(), a);
    // The smallest triangle at the largest distance that coordinates permit still takes up something.
    let [e, d] = [-140, -192].map(|k| 2f64.powi(k));
    let far = Aabb { min: [2f64.powi(200), e, e + d], max: [2f64.powi(200), e, e + d] };
    assert!(bound::share(&[[e, e, e], [e + d, e, e], [e, e + d, e]], &far, 4) > 0.0);
}

#[test]
fn mirrors_are_refused_unless_they_are_ignored() {
    let scene = Scene::new(vec![terrain(2, 3.0, 1.0, 1)]).unwrap().with_mirrors(vec![0]).unwrap();
    let views = views([0.0; 3], [1.0; 3]);
    let options = SimplifyOptions::default();
    let error = simplify(&scene, &views, &HiddenBy::default(), &options).unwrap_err();
    assert_eq!(error, SimplifyError::Mirrors { n: 1 });
    let options = SimplifyOptions { ignore_mirrors: true, ..options };
    assert!(simplify(&scene, &views, &HiddenBy::default(), &options).is_ok());
}

#[test]
fn strange_scenes_have_answers() {
    let object =
        |vertices: Vec<Point3>, triangles: Vec<[u32; 3]>| SceneObject { name: "x".into(), vertices, triangles };
    let fan = (0..6).map(|k| [0, 1, 2 + k]).collect::<Vec<_>>();
    let fan = object((0..8u32).map(|k| [f64::from(k), f64::from(k * k), f64::from(k * k * k)]).collect(), fan);
    let flat = object(vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2], [0, 0, 1], [2, 2, 2]]);
    let twice = object(vec![[0., 0., 5.], [1., 0., 5.], [0., 1., 5.]], vec![[0, 1, 2], [0, 1, 2], [2, 1, 0]]);
    let huge = object(vec![[1e55, 0., 0.], [0., 1e55, 0.], [0., 0., 1e55]], vec![[0, 1, 2]]);
    let none = object(vec![], vec![]);
    let tiny = object(vec![[1e-40, 0., 0.], [0., 1e-40, 0.], [0., 0., 1e-40]], vec![[0, 1, 2]]);
    let far = object(vec![[1e9, 0., 0.], [1e9, 1., 0.], [1e9, 0., 1.]], vec![[0, 1, 2]]);
    let scene = Scene::new(vec![fan, flat, twice, huge, none, tiny, far, terrain(4, 3.0, 1.0, 1)]).unwrap();
    for (min, max) in
        [([0.0; 3], [0.0; 3]), ([-1.0; 3], [1.0; 3]), ([0., 0., 5.], [1., 1., 5.]), ([-1e50; 3], [1e50; 3])]
    {
        for budget in [0.0, 0.01, 1.0] {
            for collapse in [0.0, 1.0] {
                let views = views(min, max);
                let options = SimplifyOptions { budget, collapse, n_rays: 1000, ..SimplifyOptions::default() };
                let left = simplified(&scene, &views, &options);
                assert!(left.bound <= budget && left.counts.without_area == 3);
                let measured =
                    measure(&scene, &left, &views, &MeasureOptions { n_eyes: 10, n_rays: 100, ..Default::default() });
                assert!(measured.unwrap().changed <= budget, "{budget} {collapse}");
                drop(geometric(&scene, 3).unwrap());
            }
        }
    }
    // What touches the eyes is kept.
    let left = simplified(&scene, &views([0., 0., 5.], [1., 1., 5.]), &SimplifyOptions::default().with_budget(0.49));
    assert_eq!(left.origin[2], [Some(0), Some(1), Some(2)]);
    let empty = Scene::new(vec![]).unwrap();
    assert_eq!(simplified(&empty, &views([0.0; 3], [1.0; 3]), &SimplifyOptions::default()).counts.left, 0);
}

#[test]
fn inside_of_an_object_little_more_than_its_inside_is_left() {
    let (scene, rooms) = small_tower();
    // Within the closed slab of the roof, in which nothing is.
    let roof = scene.objects().last().unwrap().bounds();
    let b = rooms[0];
    let middle = [(b.min[0] + b.max[0]) / 2.0, (roof.min[1] + roof.max[1]) / 2.0, (b.min[2] + b.max[2]) / 2.0];
    let inside = views(middle.map(|x| x - 0.05), middle.map(|x| x + 0.05));
    let left = simplified(&scene, &inside, &SimplifyOptions::default());
    let n = scene.objects().len();
    assert!(!left.triangles[n - 1].is_empty() && left.counts.left * 8 < left.counts.before, "{:?}", left.counts);
    assert_eq!(changed_pixels(&scene, &left, &inside, 20, 12).0, 0);
}

#[test]
fn threads_change_nothing() {
    let (scene, rooms) = small_tower();
    let views = views(rooms[1].min, rooms[1].max);
    let run = |threads| {
        simplified(
            &scene,
            &views,
            &SimplifyOptions { threads, n_rays: 10_000, ..SimplifyOptions::default().with_budget(0.01) },
        )
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn options_out_of_range_are_refused() {
    let scene = Scene::new(vec![terrain(1, 1.0, 0.0, 1)]).unwrap();
    let views = views([0.0; 3], [1.0; 3]);
    let default = SimplifyOptions::default();
    let cases = [
        (default.with_budget(-0.1), OptionsError::Budget(-0.1)),
        (default.with_budget(1.5), OptionsError::Budget(1.5)),
        (SimplifyOptions { collapse: 2.0, ..default }, OptionsError::Collapse(2.0)),
        (SimplifyOptions { n_parts: 0, ..default }, OptionsError::Parts(0)),
        (SimplifyOptions { depth: 9, ..default }, OptionsError::Depth(9)),
    ];
    for (options, error) in cases {
        let found = simplify(&scene, &views, &HiddenBy::default(), &options).unwrap_err();
        assert_eq!(found, SimplifyError::Options(error));
    }
    assert!(simplify(&scene, &views, &HiddenBy::default(), &default.with_budget(f64::NAN)).is_err());
}

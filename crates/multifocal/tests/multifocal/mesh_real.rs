//! Patches and sheets of real scenes: what they gain, in figures on standard error.

use sightlines_cells::Scene;
use sightlines_formats::scene::{BackFaces, SceneReadOptions, read_scene_with};
use sightlines_geometry::{Aabb, BoxTree, Point3, orient3d};
use sightlines_multifocal::Occluder;
use sightlines_multifocal::mesh::{PatchOptions, Sheets, patches};
use sightlines_testkit::Random;
use sightlines_testkit::RayScene;
use std::time::Instant;

/// The scenes of these names; prints that the test is skipped if there is no data.
fn scenes(names: &[&str], test: &str) -> Vec<(String, Scene)> {
    let Some(data) = std::env::var_os("SIGHTLINES_DATA") else {
        eprintln!("SKIPPED {test}: SIGHTLINES_DATA is not set");
        return Vec::new();
    };
    let folder = std::path::Path::new(&data).join("scenes");
    let read = |name: &&str| {
        let file = read_scene_with(
            folder.join(name).join(format!("{name}.glb")),
            &SceneReadOptions::with_backs(BackFaces::Drawn),
        )
        .unwrap_or_else(|e| panic!("{e}"));
        ((*name).to_owned(), file.scene)
    };
    names.iter().map(read).collect()
}

fn triangles(scene: &Scene) -> Vec<[Point3; 3]> {
    scene.objects().iter().flat_map(|o| o.corners()).collect()
}

fn area(outline: &[Point3]) -> f64 {
    vector_area(outline).iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn vector_area(outline: &[Point3]) -> Point3 {
    let mut sum = [0.0; 3];
    for i in 1..outline.len() - 1 {
        let [u, v] = [i, i + 1].map(|i| [0, 1, 2].map(|k| outline[i][k] - outline[0][k]));
        for (k, s) in sum.iter_mut().enumerate() {
            *s += u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
        }
    }
    sum.map(|x| x / 2.0)
}

/// At random points of the surface: the mean area of the triangle there, and of the largest patch that is there.
fn mean_areas(all: &[[Point3; 3]], found: &[Occluder]) -> [f64; 2] {
    let mut sums = vec![0.0];
    all.iter().for_each(|t| sums.push(sums[sums.len() - 1] + area(t)));
    let boxes: Vec<Aabb<3>> = found.iter().map(|o| *o.bounds()).collect();
    let tree = BoxTree::build(&boxes, 4);
    let (mut random, mut means) = (Random::new(3, 0), [0.0; 2]);
    for _ in 0..N_POINTS {
        let at = random.unit() * sums[all.len()];
        let [a, b, c] = all[sums.partition_point(|&s| s <= at) - 1];
        let p: Point3 = std::array::from_fn(|k| 0.4 * a[k] + 0.35 * b[k] + 0.25 * c[k]);
        let mut largest = 0.0f64;
        let near = |b: &Aabb<3>| (0..3).all(|k| b.min[k] <= p[k] + 1e-6 && p[k] <= b.max[k] + 1e-6);
        tree.visit(near, |i| {
            let o = &found[i as usize];
            if near(&boxes[i as usize]) && surrounds(o, p) {
                largest = largest.max(area(o.outline()));
            }
        });
        for (mean, area) in means.iter_mut().zip([area(&[a, b, c]), largest]) {
            *mean += area / f64::from(N_POINTS);
        }
    }
    means
}

const N_POINTS: u32 = 4000;

/// Whether the line through `p` along the normal passes all edges on one side, and `p` is on the patch, or nearly so.
fn surrounds(o: &Occluder, p: Point3) -> bool {
    let outline = o.outline();
    let normal = vector_area(outline);
    let end: Point3 = std::array::from_fn(|k| p[k] + normal[k]);
    let n = outline.len();
    let side = |i: usize| orient3d(outline[i], outline[(i + 1) % n], p, end) > 0.0;
    let flat = |f: &[Point3; 3]| orient3d(f[0], f[1], f[2], p).abs() <= 1e-5 * area(f);
    (0..n).all(|i| side(i) == side(0)) && o.facets().iter().any(flat)
}

#[test]
fn patches_are_larger_than_triangles() {
    for (name, scene) in
        scenes(&["sponza", "pandora", "delft", "office_a", "castle"], "patches_are_larger_than_triangles")
    {
        let all = triangles(&scene);
        let start = Instant::now();
        let found = patches(&all, &PatchOptions::default());
        let seconds = start.elapsed().as_secs_f64();
        let mut before: Vec<f64> = all.iter().map(|t| area(t)).collect();
        before.sort_unstable_by(|a, b| b.total_cmp(a));
        let after: Vec<f64> = found.iter().map(|o| area(o.outline())).collect();
        let [mean_before, mean_after] = mean_areas(&all, &found);
        let share = |a: &[f64], n: usize| a[..n.min(a.len())].iter().sum::<f64>() / before.iter().sum::<f64>();
        let n_flat = found.iter().filter(|o| o.facets().len() == 1).count();
        let n_alone = found.iter().filter(|o| o.outline().len() == 3).count();
        let corners = found.iter().map(|o| o.outline().len()).sum::<usize>() as f64 / found.len() as f64;
        eprintln!(
            "{name}: {} triangles -> {} patches ({n_flat} flat, {n_alone} triangles, {corners:.1} corners) in {seconds:.2} s; mean area at a point {mean_before:.2} -> {mean_after:.2} ({:.2}x); \
             first 100: {:.1} % -> {:.1} %; first 1000: {:.1} % -> {:.1} %",
            all.len(),
            found.len(),
            mean_after / mean_before,
            100.0 * share(&before, 100),
            100.0 * share(&after, 100),
            100.0 * share(&before, 1000),
            100.0 * share(&after, 1000),
        );
        assert!(after.is_sorted_by(|a, b| a * (1.0 + 1e-9) >= *b));
        assert!(mean_after > 1.5 * mean_before, "{name}");
        check_witness(&found);
    }
}

/// Asserts that there is something of each kind.
fn check_witness(found: &[Occluder]) {
    assert!(found.iter().any(|o| o.outline().len() > 3));
}

/// Boxes of eyes in a scene.
const N_VOLUMES: usize = 40;

#[test]
fn sheets_hide_much_of_real_scenes() {
    for (name, scene) in scenes(&["sponza", "pandora", "delft", "office_a"], "sheets_hide_much_of_real_scenes") {
        let all = triangles(&scene);
        let start = Instant::now();
        let sheets = Sheets::new(&all);
        let built = start.elapsed().as_secs_f64();
        let (b, mut random) = (scene.bounds(), Random::new(1, 0));
        let size = |k: usize| b.max[k] - b.min[k];
        let mut volume = || {
            let min: Point3 = std::array::from_fn(|k| b.min[k] + random.unit() * size(k) * 0.95);
            Aabb { min, max: std::array::from_fn(|k| min[k] + 0.03 * size(k)) }
        };
        let volumes: Vec<Aabb<3>> = (0..N_VOLUMES).map(|_| volume()).collect();
        let targets: Vec<Aabb<3>> = scene.objects().iter().map(|o| o.bounds()).collect();
        let mut hidden = Vec::new();
        for limit in [512, 4096] {
            let mut tester = sheets.tester();
            let start = Instant::now();
            let pairs = volumes.iter().flat_map(|v| targets.iter().map(move |e| (v, e)));
            let answers: Vec<bool> = pairs.map(|(v, e)| tester.hides(v, e, limit)).collect();
            let seconds = start.elapsed().as_secs_f64();
            hidden = answers;
            eprintln!(
                "{name}: built in {built:.2} s; limit {limit}: {} of {} pairs hidden, {:.1} us each",
                hidden.iter().filter(|h| **h).count(),
                hidden.len(),
                1e6 * seconds / hidden.len() as f64
            );
        }
        // Rays from random points of volumes, regardless of their target.
        let rays = RayScene::new(&scene);
        let pairs = volumes.iter().flat_map(|v| targets.iter().map(move |e| (v, e)));
        let mut n_hidden = 0;
        for (i, ((v, e), _)) in (0u64..).zip(pairs.zip(&hidden).filter(|p| *p.1 && !p.0.1.is_empty())) {
            n_hidden += 1;
            let mut random = Random::new(2, i);
            for _ in 0..8 {
                let (p, q) = (random.point(v), random.point(e));
                let hit = rays.first_hit(p, std::array::from_fn(|k| q[k] - p[k]));
                assert!(hit.is_some_and(|h| h.t < 1.0), "{name}: {v:?} sees {e:?} along {p:?} to {q:?}");
            }
        }
        assert!(n_hidden > 500, "{name}: {n_hidden}");
    }
}

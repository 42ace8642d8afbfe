//! Skies, ground planes and backdrops: found where they are, and the table of the rest as without them.

use crate::places::{block, scene};
use proptest::prelude::*;
use sightlines_bake::eye_level::EyeLevelOptions;
use sightlines_bake::methods::OcclusionMethod;
use sightlines_bake::{BakeRequest, Baked, CellsFrom, PlaceOptions, Runtime, SceneMethod, bake, surroundings};
use sightlines_cells::{MovingObject, Scene, SceneObject};
use sightlines_geometry::{Aabb, Point3, Random};
use sightlines_packed::{PackOptions, SizeClass, pack};
use sightlines_pvs::{Axis, ObjectId, Table};
use sightlines_testkit::siblings;
use sightlines_verify::{Truth, VerifyOptions, verify};

fn boxed(min: Point3, max: Point3) -> SceneObject {
    block(&Aabb { min, max }, false)
}

/// Houses on a floor, whose box is 16 by 6 by 16 from the origin on.
fn village(random: &mut Random) -> Vec<SceneObject> {
    let mut objects = vec![boxed([0.0, 0.0, 0.0], [16.0, 1.0, 16.0]), boxed([0.0, 1.0, 0.0], [2.0, 6.0, 2.0])];
    objects.extend((0..1 + random.below(4)).map(|_| {
        let [x, z] = [(); 2].map(|()| random.below(13) as f64);
        block(&Aabb { min: [x, 1.0, z], max: [x + 2.0, 4.0, z + 3.0] }, false)
    }));
    objects
}

/// A box seen from inside.
fn sky(min: Point3, max: Point3) -> SceneObject {
    let mut sky = boxed(min, max);
    sky.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    sky
}

/// Half of a ball of a radius around the middle of the village, in rings; its rim is as high as `rim`.
fn dome(radius: f64, rim: f64) -> SceneObject {
    // Points of a circle with rational coordinates.
    let circle = [[1.0, 0.0], [0.8, 0.6], [0.0, 1.0], [-0.8, 0.6], [-1.0, 0.0], [-0.8, -0.6], [0.0, -1.0], [0.8, -0.6]];
    let rings = [[1.0, 0.0], [0.8, 0.6], [0.28, 0.96]];
    let ring = |[r, y]: [f64; 2]| circle.map(|[x, z]| [8.0 + radius * r * x, rim + radius * y, 8.0 + radius * r * z]);
    let mut vertices: Vec<Point3> = rings.into_iter().flat_map(ring).collect();
    vertices.push([8.0, rim + radius, 8.0]);
    let mut triangles = Vec::new();
    for i in 0..8u32 {
        let j = (i + 1) % 8;
        triangles.extend(
            [0, 8].iter().flat_map(|low| [[low + i, low + j, low + 8 + j], [low + i, low + 8 + j, low + 8 + i]]),
        );
        triangles.push([16 + i, 16 + j, 24]);
    }
    SceneObject { name: String::new(), vertices, triangles }
}

fn ground(size: f64, at: f64) -> SceneObject {
    let [low, high] = [8.0 - size / 2.0, 8.0 + size / 2.0];
    let vertices = vec![[low, at, low], [high, at, low], [high, at, high], [low, at, high]];
    SceneObject { name: String::new(), vertices, triangles: vec![[0, 2, 1], [0, 3, 2]] }
}

fn backdrop(size: f64, away: f64) -> SceneObject {
    let vertices = vec![[8.0 - size, -5.0, away], [8.0 + size, -5.0, away], [8.0, 40.0, away]];
    SceneObject { name: String::new(), vertices, triangles: vec![[0, 1, 2]] }
}

/// What is around a village, as an object each.
fn around(kind: usize, far: f64) -> Vec<SceneObject> {
    let s = |x: f64| 8.0 + x * far;
    match kind {
        0 => vec![sky([s(-40.0), -8.0 * far, s(-40.0)], [s(40.0), s(40.0), s(40.0)])],
        1 => vec![dome(40.0 * far, 0.0)],
        2 => vec![ground(260.0 * far, 0.0)],
        3 => vec![backdrop(40.0 * far, s(60.0)), backdrop(40.0 * far, s(-60.0))],
        _ => vec![ground(260.0 * far, -0.25), sky([s(-400.0); 3], [s(400.0); 3]), backdrop(40.0 * far, s(60.0))],
    }
}

/// The village with what is around it put in among its objects, and the places of these.
fn with_around(rest: &[SceneObject], around: Vec<SceneObject>, random: &mut Random) -> (Scene, Vec<u32>) {
    let mut objects: Vec<(SceneObject, bool)> = rest.iter().map(|o| (o.clone(), false)).collect();
    for o in around {
        objects.insert(random.below(objects.len() + 1), (o, true));
    }
    let found = (0u32..).zip(&objects).filter(|(_, (_, is_around))| *is_around).map(|(k, _)| k).collect();
    (scene(objects.into_iter().map(|(o, _)| o).collect()), found)
}

/// A thousand villages: what is around them is found, and nothing without it. The impostors are as large and stand too near, or are
/// not much larger.
#[test]
fn what_is_around_is_found_and_nothing_else() {
    let (mut n, mut n_impostors) = (0, 0);
    for seed in siblings() {
        let mut random = Random::new(seed);
        let rest = village(&mut random);
        assert_eq!(surroundings(&scene(rest.clone())), [0u32; 0], "{seed}");
        let far = 1.0 + 30.0 * random.unit();
        let (with, places) = with_around(&rest, around(random.below(5), far), &mut random);
        assert_eq!(surroundings(&with), places, "{seed}");
        n += places.len();
        let impostors = [
            // A hall that the village stands in: its floor is that of the village.
            sky([8.0 - 40.0 * far, 0.0, 8.0 - 40.0 * far], [8.0 + 40.0 * far; 3]),
            // A hull that is hardly larger.
            sky([-6.0; 3], [22.0; 3]),
            // A floor, a roof through the middle, and a wall through the village.
            ground(200.0, 0.0),
            ground(260.0 * far, 3.0),
            backdrop(40.0 * far, 8.0),
        ];
        for impostor in impostors {
            let (with, _) = with_around(&rest, vec![impostor], &mut random);
            assert_eq!(surroundings(&with), [0u32; 0], "{seed}");
            n_impostors += 1;
        }
    }
    let n_villages = siblings().len();
    eprintln!("{n_villages} villages, {n} things around them, {n_impostors} impostors");
    assert!(n >= n_villages && n_impostors == 5 * n_villages, "{n} {n_impostors}");
}

#[test]
fn what_moves_or_leaves_nothing_is_no_surrounding() {
    let rest = village(&mut Random::new(3));
    let (with, places) = with_around(&rest, around(0, 1.0), &mut Random::new(5));
    assert_eq!(surroundings(&with), places);
    let moves = MovingObject { object: places[0], within: Some(with.extent(places[0])) };
    assert_eq!(surroundings(&with.clone().with_moving(vec![moves]).expect("an object")), [0u32; 0]);
    assert_eq!(surroundings(&with.with_mirrors(places).expect("an object")), [0u32; 0]);
    let alone = vec![rest[1].clone(), around(0, 1.0).remove(0)];
    assert_eq!(surroundings(&scene(alone)), [0u32; 0], "one thing in a room");
    assert_eq!(surroundings(&Scene::default()), [0u32; 0]);
}

/// How the tables differ: what is of the rest, and cells that do not see what is around.
fn faults(with: &Table, without: &Table, places: &[u32]) -> usize {
    if with.cells() != without.cells() || with.parts().rows != without.parts().rows || with.kind() != without.kind() {
        return usize::MAX;
    }
    let rest: Vec<u32> = (0..with.objects().len() as u32).filter(|o| !places.contains(o)).collect();
    let of = |cell| {
        let seen = with.visible_objects(cell);
        let of_rest = (0u32..).zip(&rest).filter(|(_, o)| seen.contains(&ObjectId(**o))).map(|(k, _)| ObjectId(k));
        usize::from(of_rest.collect::<Vec<_>>() != without.visible_objects(cell))
            + places.iter().filter(|o| !seen.contains(&ObjectId(**o))).count()
    };
    (0..with.n_cells() as u32).map(|cell| of(sightlines_pvs::CellId(cell))).sum()
}

fn requests() -> [BakeRequest; 3] {
    let few = CellsFrom::Places(PlaceOptions { n_cells: Some(6), cell_size: None });
    [
        BakeRequest::default(),
        BakeRequest { cells: Some(few.clone()), ..BakeRequest::default() },
        BakeRequest {
            cells: Some(few),
            method: Some(SceneMethod::FromRegion(OcclusionMethod::LineSpace)),
            ..BakeRequest::default()
        },
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases.div_ceil(16), ..ProptestConfig::default() })]
    /// The table of the rest is as without what is around it, which every cell sees. The impostor is the table for viewers who may be
    /// everywhere, in which what is around takes part.
    #[test]
    fn the_rest_is_as_without(seed in any::<u64>()) {
        let mut random = Random::new(seed);
        let rest = village(&mut random);
        let (with, places) = with_around(&rest, around(random.below(5), 1.5), &mut random);
        let without = scene(rest);
        for request in requests() {
            let [Baked { table, .. }, alone] = [&with, &without].map(|scene| bake(scene, &request).expect("a table"));
            prop_assert_eq!(faults(&table, &alone.table, &places), 0, "the_rest_is_as_without: {}", seed);
            prop_assert_eq!(table.digest(), Some(with.digest()));
            let names = table.info_value("surroundings").map(|names| names.lines().count().max(1));
            prop_assert!(names.is_some() && alone.table.info_value("surroundings").is_none());
            // An eye outside is in no cell: it may see everything.
            prop_assert!(table.place_at([8.0, 3.0, 30.0]).is_outside());
            let holds = |k: usize| {
                let (b, record) = (with.extent(places[k]), &table.objects()[places[k] as usize]);
                let cells = table.cells().iter().map(|cell| (cell.min, cell.max)).chain([(b.min, b.max)]);
                cells.into_iter().all(|(min, max)| (0..3).all(|k| record.min[k] <= min[k] && max[k] <= record.max[k]))
            };
            prop_assert!((0..places.len()).all(holds));
            let lists = (0..table.n_cells() as u32).map(|cell| table.objects_of(sightlines_pvs::CellId(cell)));
            prop_assert!(lists.into_iter().all(|list| list.is_sorted() && list.contains(&ObjectId(places[0]))));
            let everywhere = BakeRequest { view_region: Some(with.bounds()), ..request };
            prop_assert_ne!(faults(&bake(&with, &everywhere).expect("a table").table, &alone.table, &places), 0);
        }
    }
}

/// Hills of eight triangles over the same 16 by 16 as a village, with a long house across them, and small things on both sides of it.
fn terrain(random: &mut Random) -> Vec<SceneObject> {
    let vertices: Vec<Point3> =
        (0..9).map(|k| [f64::from(k % 3) * 8.0, random.unit(), f64::from(k / 3) * 8.0]).collect();
    let quads = [0, 1, 3, 4].map(|k| [[k, k + 4, k + 1], [k, k + 3, k + 4]]);
    let hills = SceneObject { name: String::new(), vertices, triangles: quads.concat() };
    let thick = 0.5 + random.unit();
    let mut objects = vec![hills, boxed([8.0 - thick, 0.0, 0.0], [8.0 + thick, 5.0 + random.unit(), 16.0])];
    for low in [0.0, 10.0] {
        let [x, y, z] = [low + 5.0 * random.unit(), 0.5 * random.unit(), 15.0 * random.unit()];
        objects.push(boxed([x, y, z], [x + 0.75, 1.0 + random.unit(), z + 0.75]));
    }
    objects
}

/// A thousand terrains with and without what is around them: the same cells, which list the same of the rest. The twin is that something is hidden; the
/// impostor is the table for viewers who may be everywhere.
#[test]
fn terrains_have_the_tables_that_they_have_without_a_sky() {
    let [mut n, mut n_hide, mut n_tried, mut n_wrong] = [0; 4];
    let mut of_kind = [0; 5];
    for seed in siblings() {
        let mut random = Random::new(seed);
        let rest = terrain(&mut random);
        let kind = random.below(5);
        let far = 1.0 + 10.0 * random.unit();
        let (with, places) = with_around(&rest, around(kind, far), &mut random);
        let without = scene(rest);
        let few = || CellsFrom::Places(PlaceOptions { n_cells: Some(3), cell_size: None });
        let eyes =
            EyeLevelOptions { cell_size: Some(8.0), eye_height: None, up: Some(Axis::Y), units_per_metre: Some(1.0) };
        let cells = Some(if random.below(2) == 0 { few() } else { CellsFrom::EyeLevel(eyes) });
        let request = BakeRequest { cells, ..BakeRequest::default() };
        let table = |scene: &Scene, request: &BakeRequest| {
            Runtime { threads: 1, ..Runtime::default() }.bake(scene, request).expect("a table").table
        };
        let alone = table(&without, &request);
        assert_eq!(faults(&table(&with, &request), &alone, &places), 0, "{seed}");
        let all = 0..alone.n_cells() as u32;
        let seen: usize = all.map(|cell| alone.visible_objects(sightlines_pvs::CellId(cell)).len()).sum();
        n_hide += usize::from(seen < alone.n_cells() * alone.objects().len());
        if n % 16 == 0 {
            let everywhere =
                BakeRequest { cells: Some(few()), view_region: Some(with.bounds()), ..BakeRequest::default() };
            n_tried += 1;
            n_wrong += usize::from(faults(&table(&with, &everywhere), &alone, &places) > 0);
        }
        of_kind[kind] += 1;
        n += 1;
    }
    eprintln!(
        "{n} terrains, {of_kind:?} of each kind, {n_hide} hide something; the impostor differs in {n_wrong} of {n_tried}"
    );
    assert!(
        n == siblings().len() && 8 * n_hide > n && n_wrong == n_tried && n_tried > 0,
        "{n_hide} {n_wrong} {n_tried}"
    );
    assert!(of_kind.iter().all(|k| 10 * k > n), "{of_kind:?}");
}

/// Row by row the same bytes as packed from memory.
#[test]
fn rows_have_what_is_around_too() {
    let mut random = Random::new(11);
    let rest = village(&mut random);
    let (with, places) = with_around(&rest, around(4, 1.0), &mut random);
    let [_, _, request] = requests();
    let runtime = Runtime { threads: 1, ..Runtime::default() };
    let prepared = request.prepare(&with, &runtime).expect("good options");
    assert_eq!(prepared.decisions().surroundings, places);
    let table = prepared.run(&runtime).expect("a table").table;
    // The impostor: a table of the rest that leaves out what is around.
    let options = VerifyOptions { rays: 500, pairs: 50, tries: 8, seed: 7, threads: 1, ..VerifyOptions::default() };
    let found = |table: &Table| verify(table, &Truth::Scene(&with), &options).expect("verified").by_kind;
    let mut parts = table.parts().clone();
    parts.cell_objects[0].retain(|object| object.0 != places[0]);
    let faults = [found(&table), found(&Table::new(parts).expect("a table"))];
    assert!(faults[0].is_empty() && !faults[1].is_empty(), "{faults:?}");
    let (rows, report, _) = prepared.run_packed(Vec::new(), &runtime).expect("a packed table");
    let options = PackOptions { class: Some(SizeClass::Large), ..PackOptions::default() };
    assert_eq!(rows, pack(&table, &options).expect("packed"));
    let n_seen = (0..table.n_cells() as u32).map(|c| table.visible_objects(sightlines_pvs::CellId(c)).len() as u64);
    assert_eq!(report.n_objects_seen, n_seen.sum::<u64>());
    // Where viewers are said to be, and for proofs, nothing is looked for.
    let said = [
        BakeRequest { view_region: Some(with.bounds()), ..BakeRequest::default() },
        BakeRequest { for_proofs: true, ..BakeRequest::default() },
    ];
    for request in said {
        assert!(request.prepare(&with, &runtime).expect("good options").decisions().surroundings.is_empty());
    }
}

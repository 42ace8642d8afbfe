//! What is see-through is seen and hides nothing, what moves is seen wherever it may be: in tables of all methods, against
//! tables of scenes without it, and against rays.

use proptest::prelude::*;
use sightlines::bake::methods::{BufferOptions, OcclusionMethod, OcclusionMethodFactory};
use sightlines::bake::{CellsFrom, RegionBakeOptions, SceneBakeOptions, bake_regions, bake_scene};
use sightlines::cells::{CellId, MovingObject, Point3, Scene, SceneObject};
use sightlines::geometry::{Aabb, Random};
use sightlines::kdtree::SceneOptions;
use sightlines::multifocal::Split;
use sightlines::pvs::{ObjectId, Table};
use sightlines::verify::{Truth, VerifyOptions, check_walls_in_space, verify};

/// A closed box of twelve triangles, its fronts outwards.
fn block(name: &str, min: Point3, max: Point3) -> SceneObject {
    let corner = |i: usize| -> Point3 { std::array::from_fn(|k| if i >> k & 1 == 0 { min[k] } else { max[k] }) };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    SceneObject { name: name.to_owned(), vertices: (0..8).map(corner).collect(), triangles }
}

/// A hall of 12 by 4 by 3, seen from inside, with a thing at either end.
fn hall() -> Vec<SceneObject> {
    let mut shell = block("shell", [0.0; 3], [12.0, 4.0, 3.0]);
    shell.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    vec![shell, block("west", [1.0; 3], [2.0, 2.0, 2.0]), block("east", [10.0, 1.0, 1.0], [11.0, 2.0, 2.0])]
}

/// The hall, divided by a wall, which is object 3, and with it a pane of slanted glass, which is object 4.
fn divided() -> Scene {
    let mut objects = hall();
    objects.push(block("wall", [6.0, 0.0, 0.0], [6.5, 4.0, 3.0]));
    let pane: Vec<Point3> = vec![[4.0, 0.0, 0.0], [5.0, 4.0, 0.0], [5.0, 4.0, 3.0], [4.0, 0.0, 3.0]];
    objects.push(SceneObject { name: "pane".to_owned(), vertices: pane, triangles: vec![[0, 1, 2], [0, 2, 3]] });
    Scene::new(objects).unwrap()
}

fn cut() -> SceneOptions {
    SceneOptions { detail_below: Some(0.0), keep_solid: true, ..SceneOptions::default() }
}

fn by_sightlines(scene: &Scene) -> Table {
    bake_scene(scene, &SceneBakeOptions { cut: cut(), threads: 2, ..SceneBakeOptions::default() }).unwrap().table
}

fn by_method(scene: &Scene, method: OcclusionMethod, cells: &CellsFrom, sightlines: bool) -> Table {
    // Small buffers and few rays are enough for few things.
    let buffers = BufferOptions { planes: 2, texels: 64, ..BufferOptions::default() };
    let factory = OcclusionMethodFactory::new(method, scene, &buffers).unwrap();
    let make = || factory.instance();
    let options = RegionBakeOptions {
        cells,
        method: Some(&make),
        sightlines,
        split: Split { n_rays: 1024, ..Split::default() },
        cut: cut(),
        portals: Default::default(),
        threads: 2,
        ..RegionBakeOptions::new(cells)
    };
    bake_regions(scene, &options).unwrap().table
}

/// Tables of a scene by every method, on both kinds of cells.
fn tables(scene: &Scene) -> Vec<(String, Table)> {
    let mut all = vec![("sightlines".to_owned(), by_sightlines(scene))];
    for method in OcclusionMethod::ALL {
        for (name, cells) in [("kd", CellsFrom::KdTree), ("grid", CellsFrom::Grid([6, 2, 1]))] {
            for sightlines in [false, true] {
                let name = format!("{method} {name} {sightlines}");
                all.push((name, by_method(scene, method, &cells, sightlines)));
            }
        }
    }
    all
}

/// The cells that contain a point.
fn cells_at(table: &Table, p: Point3) -> Vec<CellId> {
    let contains = |c: &CellId| Aabb { min: table.cells()[c.idx()].min, max: table.cells()[c.idx()].max }.contains(p);
    (0u32..).map(CellId).take(table.n_cells()).filter(contains).collect()
}

/// Whether a point's cells see an object.
fn sees(table: &Table, from: Point3, object: u32) -> bool {
    cells_at(table, from).into_iter().any(|cell| table.visible_objects(cell).contains(&ObjectId(object)))
}

fn n_violations(table: &Table, scene: &Scene) -> usize {
    let options = VerifyOptions { rays: 4000, pairs: 400, tries: 64, seed: 7, threads: 2, ..VerifyOptions::default() };
    verify(table, &Truth::Scene(scene), &options).unwrap().by_kind.values().sum()
}

const WEST: Point3 = [0.5, 0.5, 0.5];

#[test]
fn glass_hides_nothing_and_is_seen() {
    let opaque = divided();
    let glass = opaque.clone().with_see_through(vec![3, 4]).unwrap();
    let (mut n_hidden, mut n_caught) = (0, 0);
    for ((name, of_walls), (_, of_glass)) in tables(&opaque).into_iter().zip(tables(&glass)) {
        // The same wall hides if it is opaque: what is checked below is no accident.
        n_hidden += u32::from(!sees(&of_walls, WEST, 2));
        for object in 0..5 {
            assert!(sees(&of_glass, WEST, object), "{name}: {object}");
        }
        assert_eq!(n_violations(&of_glass, &glass), 0, "{name}");
        assert_eq!(n_violations(&of_walls, &opaque), 0, "{name}");
        // Glass taken for a wall is caught by rays.
        n_caught += u32::from(n_violations(&of_walls, &glass) > 0);
    }
    assert!(n_hidden >= 7 && n_caught >= n_hidden, "{n_hidden} {n_caught}");
    // Where borders of cells are walls, what covers them has to hide.
    let table = by_sightlines(&opaque);
    assert_eq!(check_walls_in_space(&table, &opaque).n_bare, 0);
    assert!(check_walls_in_space(&table, &glass).n_bare > 0);
}

#[test]
fn what_moves_is_seen_wherever_it_may_be() {
    let opaque = divided();
    let moving = |within| opaque.clone().with_moving(vec![MovingObject { object: 2, within }]).unwrap();
    let stays = moving(Some(Aabb { min: [9.0, 1.0, 1.0], max: [11.0, 3.0, 2.0] }));
    let crosses = moving(Some(Aabb { min: [3.0, 1.0, 1.0], max: [11.0, 2.0, 2.0] }));
    let anywhere = moving(None);
    let mut n_hidden = 0;
    for (((name, stays_table), (_, crosses_table)), (_, anywhere_table)) in
        tables(&stays).into_iter().zip(tables(&crosses)).zip(tables(&anywhere))
    {
        n_hidden += u32::from(!sees(&stays_table, WEST, 2));
        assert!(sees(&crosses_table, WEST, 2), "{name}");
        for cell in (0u32..).map(CellId).take(anywhere_table.n_cells()) {
            assert!(anywhere_table.visible_objects(cell).contains(&ObjectId(2)), "{name} {cell}");
        }
        for (table, scene) in [(&stays_table, &stays), (&crosses_table, &crosses), (&anywhere_table, &anywhere)] {
            assert_eq!(n_violations(table, scene), 0, "{name}");
        }
    }
    assert!(n_hidden >= 7, "{n_hidden}");
}

/// Rays go where things may be: a table that does not show one from where it passes is caught, though it is out of sight at
/// rest, or has no triangles there.
#[test]
fn movers_are_aimed_at_wherever_they_may_be() {
    let opaque = divided();
    let within = Some(Aabb { min: [3.0, 1.0, 1.0], max: [11.0, 2.0, 2.0] });
    let at_rest = opaque.clone().with_moving(vec![MovingObject { object: 2, within }]).unwrap();
    let mut objects = opaque.objects().to_vec();
    objects[2].triangles.clear();
    let bare = Scene::new(objects).unwrap().with_moving(vec![MovingObject { object: 2, within }]).unwrap();
    let anywhere = opaque.with_moving(vec![MovingObject { object: 2, within: None }]).unwrap();
    for scene in [at_rest, bare, anywhere] {
        let table = by_method(&scene, OcclusionMethod::ALL[0], &CellsFrom::Grid([6, 2, 1]), true);
        assert_eq!(n_violations(&table, &scene), 0);
        let mut parts = table.parts().clone();
        for cell in cells_at(&table, WEST) {
            assert!(!parts.cell_objects[cell.idx()].contains(&ObjectId(2)) || scene.moving()[0].within.is_none());
            parts.cell_objects[cell.idx()].retain(|&object| object != ObjectId(2));
            parts.objects_seen.as_mut().unwrap().set(cell.idx(), 2, false);
        }
        let impostor = Table::new(parts).unwrap();
        assert!(!sees(&impostor, WEST, 2));
        let options =
            VerifyOptions { rays: 4000, pairs: 400, tries: 64, seed: 7, threads: 2, ..VerifyOptions::default() };
        let found = verify(&impostor, &Truth::Scene(&scene), &options).unwrap();
        assert!(
            found.by_kind.keys().any(|kind| kind.contains("hidden") || kind.contains("object")),
            "{:?}",
            found.by_kind
        );
    }
}

/// Blocks and panes on a small grid in the hall, some of which are see-through.
fn cluttered(random: &mut Random) -> (Scene, Vec<u32>) {
    let mut objects = hall();
    let mut glass = Vec::new();
    for k in 0..6 {
        let min: Point3 = [random.below(12) as f64, random.below(4) as f64, random.below(3) as f64];
        let mut size: Point3 =
            [(1 + random.below(3)) as f64, (1 + random.below(4)) as f64, (1 + random.below(3)) as f64];
        // Many are panes, some across all of the hall.
        let flat = random.below(3);
        let mut min = min;
        if random.below(2) == 0 {
            size[0] = 0.0;
            if flat == 0 {
                (min, size) = ([min[0], 0.0, 0.0], [0.0, 4.0, 3.0]);
            }
        }
        let max = std::array::from_fn(|axis| (min[axis] + size[axis]).min([12.0, 4.0, 3.0][axis]));
        if random.below(2) == 0 {
            glass.push(objects.len() as u32);
        }
        objects.push(block(&format!("block {k}"), min, max));
    }
    (Scene::new(objects).unwrap(), glass)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases.div_ceil(8), ..ProptestConfig::default() })]

    /// A see-through thing changes nothing but that it is seen itself: cells, what they see, and which of the other objects
    /// they see are those of the scene without it.
    #[test]
    fn see_through_things_change_nothing(seed in any::<u64>()) {
        let (scene, glass) = cluttered(&mut Random::new(seed));
        let without = scene.clone().with_see_through(glass.clone()).unwrap().opaque_part().into_owned();
        let seen = scene.with_see_through(glass.clone()).unwrap();
        let (with, without) = (by_sightlines(&seen), by_sightlines(&without));
        prop_assert_eq!(with.cells(), without.cells());
        prop_assert_eq!(with.portals(), without.portals());
        for cell in (0u32..).map(CellId).take(with.n_cells()) {
            let rows = [&with, &without].map(|table| table.visible(cell).collect::<Vec<_>>());
            prop_assert_eq!(&rows[0], &rows[1]);
            let others = [&with, &without].map(|table| {
                let objects = table.visible_objects(cell).into_iter();
                objects.filter(|object| !glass.contains(&object.0)).collect::<Vec<_>>()
            });
            prop_assert_eq!(&others[0], &others[1]);
        }
        prop_assert_eq!(n_violations(&with, &seen), 0);
    }

    /// Whatever finds the hidden, rays through what is see-through find nothing that it hides wrongly.
    #[test]
    fn no_method_hides_behind_glass(seed in any::<u64>()) {
        let (scene, glass) = cluttered(&mut Random::new(seed));
        let scene = scene.with_see_through(glass).unwrap();
        let method = OcclusionMethod::ALL[seed as usize % OcclusionMethod::ALL.len()];
        let table = by_method(&scene, method, &CellsFrom::Grid([4, 2, 1]), seed % 2 == 0);
        prop_assert_eq!(n_violations(&table, &scene), 0);
    }
}

#[test]
fn single_sided_things_are_seen_from_the_front_only() {
    // A sign in the middle of the hall that looks to the east.
    let sign = |turned: bool| {
        let at: Vec<Point3> = vec![[5.0, 1.0, 1.0], [5.0, 3.0, 1.0], [5.0, 3.0, 2.0], [5.0, 1.0, 2.0]];
        let triangles = if turned { vec![[0, 2, 1], [0, 3, 2]] } else { vec![[0, 1, 2], [0, 2, 3]] };
        let mut objects = hall();
        objects.push(SceneObject { name: "sign".to_owned(), vertices: at, triangles });
        Scene::new(objects).unwrap()
    };
    let (both, single) = (sign(false), sign(false).with_single_sided(vec![3]).unwrap());
    let turned = sign(true).with_single_sided(vec![3]).unwrap();
    const EAST: Point3 = [11.5, 3.5, 2.5];
    let (mut n_hidden, mut n_caught) = (0, 0);
    for ((name, of_single), (_, of_both)) in tables(&single).into_iter().zip(tables(&both)) {
        assert!(sees(&of_single, EAST, 3) && sees(&of_both, EAST, 3) && sees(&of_both, WEST, 3), "{name}");
        // It hides from both sides all the same, and nothing but itself is seen less.
        for object in 0..3 {
            assert_eq!(sees(&of_single, WEST, object), sees(&of_both, WEST, object), "{name}: {object}");
        }
        let is_hidden = !sees(&of_single, WEST, 3);
        n_hidden += u32::from(is_hidden);
        assert_eq!(n_violations(&of_single, &single), 0, "{name}");
        assert_eq!(n_violations(&of_both, &both), 0, "{name}");
        // Whoever takes the back for the front, or believes that nobody sees the back of what has two sides, is caught.
        n_caught +=
            u32::from(is_hidden && n_violations(&of_single, &turned) > 0 && n_violations(&of_single, &both) > 0);
    }
    assert!(n_hidden >= 7 && n_caught == n_hidden, "{n_hidden} {n_caught}");
}

/// A wall with one side hides from its front, by every method, and nothing from behind: against rays that know of them, too.
#[test]
fn walls_with_one_side_hide_from_their_front() {
    let mut objects = hall();
    // Its front is towards the west.
    let wall: Vec<Point3> = vec![[6.0, 0.0, 0.0], [6.0, 0.0, 3.0], [6.0, 4.0, 3.0], [6.0, 4.0, 0.0]];
    objects.push(SceneObject { name: "wall".to_owned(), vertices: wall, triangles: vec![[0, 1, 2], [0, 2, 3]] });
    let both_sides = Scene::new(objects).unwrap();
    let seen = both_sides.clone().with_see_through(vec![3]).unwrap();
    let front = seen.clone().with_front_occluders(vec![3]).unwrap();
    let east = [11.5, 0.5, 0.5];
    let (mut n_hidden, mut n_caught) = (0, 0);
    for ((name, of_both), (_, of_front)) in tables(&both_sides).into_iter().zip(tables(&front)) {
        assert!(sees(&of_front, east, 1), "{name}: what is seen past the back is hidden");
        assert_eq!(n_violations(&of_front, &front), 0, "{name}");
        n_hidden += u32::from(!sees(&of_front, WEST, 2));
        // The impostors: a wall that hides from both sides, and one that the checker does not know of.
        n_caught += u32::from(n_violations(&of_both, &front) > 0);
        if !sees(&of_front, WEST, 2) {
            assert!(n_violations(&of_front, &seen) > 0, "{name}");
        }
    }
    assert!(n_hidden == 13 && n_caught == 13, "{n_hidden} {n_caught}");
    assert_ne!(front.digest(), seen.digest());
    assert_ne!(front.digest(), both_sides.digest());
}

//! Scenes made by hand: doors, windows, furniture, thick and hollow walls, houses.

use crate::meshes::{aabb, cuboid, object, quad, scene};
use sightlines_cells::{MovingObject, Point3, Scene, SceneObject};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{KdError, SceneOptions, SceneSubdivision, default_detail_below, subdivide_scene};
use sightlines_pvs::CellId;

fn cut(objects: Vec<SceneObject>, options: &SceneOptions) -> SceneSubdivision {
    let out = subdivide_scene(&scene(objects), options).expect("the scene is good");
    out.graph.assert_well_formed();
    out
}

fn everything() -> SceneOptions {
    SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() }
}

/// The walls of a room, seen from inside.
fn hull(min: Point3, max: Point3) -> SceneObject {
    object("hull", &cuboid(&aabb(min, max), true))
}

fn solid(name: &str, min: Point3, max: Point3) -> SceneObject {
    object(name, &cuboid(&aabb(min, max), false))
}

/// A wall on x = 4 with a doorway from y = 1 to y = 2 up to z = 2, as one polygon cut into ears with
/// slanted edges.
fn wall_with_door() -> SceneObject {
    let p = |y: f64, z: f64| [4.0, y, z];
    let outline = [p(0., 0.), p(1., 0.), p(1., 2.), p(2., 2.), p(2., 0.), p(4., 0.), p(4., 3.), p(0., 3.)];
    let ears = [[0, 1, 2], [0, 2, 7], [2, 3, 7], [3, 6, 7], [3, 5, 6], [3, 4, 5]];
    object("wall", &ears.map(|t| t.map(|i: usize| outline[i])))
}

#[test]
fn two_rooms_with_a_door() {
    let out = cut(vec![hull([0.; 3], [9., 4., 3.]), wall_with_door()], &everything());
    assert_eq!((out.graph.n_cells(), out.summary.n_faces), (2, 9));
    let [portal] = out.graph.portals() else { panic!("one door, {:?}", out.graph.portals()) };
    assert_eq!((portal.cells, portal.sides), ([CellId(0), CellId(1)], [1, 0]));
    assert_eq!(portal.shape.extent, aabb([4., 1., 0.], [4., 2., 2.]));
    assert_eq!(out.locate([1., 1., 1.]), Some(CellId(0)));
    assert_eq!(out.locate([4., 1.5, 1.]), Some(CellId(1)));
    assert_eq!(out.locate([-1., 1.5, 1.]), None);
}

/// A wall on x = 4 of a room 4 wide and 3 high with two windows.
fn wall_with_windows() -> SceneObject {
    let part = |y0, z0, y1, z1| quad(0, [4., y0, z0], [4., y1, z1], true);
    let below_and_above = [part(0., 0., 4., 1.), part(0., 2., 4., 3.)];
    let between = [part(0., 1., 0.5, 2.), part(1.5, 1., 2.5, 2.), part(3.5, 1., 4., 2.)];
    object("wall", &below_and_above.into_iter().chain(between).flatten().collect::<Vec<_>>())
}

#[test]
fn each_window_is_a_portal() {
    let out = cut(vec![hull([0.; 3], [9., 4., 3.]), wall_with_windows()], &everything());
    let windows = [0.5, 2.5].map(|y| aabb([4., y, 1.], [4., y + 1., 2.]));
    let extents: Vec<Aabb<3>> = out.graph.portals().iter().map(|p| p.shape.extent).collect();
    assert_eq!(extents, windows);
    assert!(out.graph.portals().iter().all(|p| p.cells == [CellId(0), CellId(1)]));
}

/// A chair of four boxes.
fn chair(x: f64, y: f64) -> SceneObject {
    let boxes = [
        aabb([x, y, 0.4], [x + 0.5, y + 0.5, 0.45]),
        aabb([x, y, 0.45], [x + 0.05, y + 0.5, 0.9]),
        aabb([x, y, 0.], [x + 0.05, y + 0.05, 0.4]),
        aabb([x + 0.4, y + 0.4, 0.], [x + 0.45, y + 0.45, 0.4]),
    ];
    object("chair", &boxes.iter().flat_map(|b| cuboid(b, false)).collect::<Vec<_>>())
}

#[test]
fn furniture_is_detail() {
    let objects = || vec![hull([0.; 3], [40., 30., 3.]), chair(6., 1.), wall_with_door(), chair(20., 20.)];
    let scene_ = scene(objects());
    assert_eq!(default_detail_below(&scene_), 1.5);
    let out = cut(objects(), &SceneOptions::default());
    let bare = cut(objects().into_iter().filter(|o| o.name != "chair").collect(), &SceneOptions::default());
    assert_eq!(out.detail, [false, true, false, true]);
    assert_eq!((out.summary.n_detail_objects, &out.graph), (2, &bare.graph));
    let all = cut(objects(), &everything());
    assert!(all.graph.n_cells() > out.graph.n_cells() + 10 && all.summary.n_solid > 0);
    // The same chairs in one mesh with the hull: small closed pieces are detail too.
    let mut mesh: Vec<[Point3; 3]> = objects()[0].corners().collect();
    mesh.extend(chair(6., 1.).corners());
    let one = cut(vec![object("all", &mesh), objects().remove(2)], &SceneOptions::default());
    assert_eq!((one.summary.detail_below, &one.graph), (1.5, &bare.graph));
    // And as sheets without a closed border: small regions are.
    mesh.truncate(12);
    mesh.extend(quad(2, [20., 20., 1.], [21., 21., 1.], true));
    let one = cut(vec![object("all", &mesh), objects().remove(2)], &SceneOptions::default());
    assert_eq!((one.summary.n_small_regions, &one.graph), (1, &bare.graph));
}

#[test]
fn a_turned_building_beside_another_does_not_count_for_what_is_detail() {
    let alone = || vec![hull([0.; 3], [40., 30., 3.]), chair(6., 1.), wall_with_door()];
    // Twice as large, by 3 and 4 of 5, and with a floor of its own.
    let turned = |[x, y, z]: Point3| [100. + 2. * (0.6 * x - 0.8 * y), 100. + 2. * (0.8 * x + 0.6 * y), z];
    let floor = quad(2, [0., 0., 0.], [40., 30., 0.], true);
    let beside = |o: SceneObject| object("beside", &o.corners().map(|t| t.map(turned)).collect::<Vec<_>>());
    let both: Vec<SceneObject> =
        alone().into_iter().chain(alone().into_iter().chain([object("floor", &floor)]).map(beside)).collect();
    assert_eq!(default_detail_below(&scene(alone())), 1.5);
    assert_eq!(default_detail_below(&scene(both.clone())), 1.5);
    // What stands alone counts, although it is turned.
    assert!(default_detail_below(&scene(both[3..].to_vec())) > 1.5);
}

#[test]
fn detail_leaves_most_of_the_surface() {
    // A large campus of small houses: a twentieth of its extent is more than a house.
    let house = |i: u32| {
        solid("house", [f64::from(i % 40) * 25., f64::from(i / 40) * 25., 0.], {
            [f64::from(i % 40) * 25. + 10., f64::from(i / 40) * 25. + 8., 5.]
        })
    };
    let houses: Vec<SceneObject> = (0..1600).map(house).collect();
    let campus = scene(houses.clone());
    assert_eq!(default_detail_below(&campus), 10.0, "no house is below its own size");
    assert_eq!(default_detail_below(&Scene::default()), 0.0);
    let hulls: f64 = default_detail_below(&scene(vec![hull([0.; 3], [20., 40., 60.])]));
    assert_eq!(hulls, 2.0);
}

/// Two rooms with a thick wall between them, in which there is a doorway or none.
fn thick_wall(door: bool) -> Vec<SceneObject> {
    let mut out = vec![hull([0.; 3], [9., 4., 3.])];
    out.push(solid("wall", [4., 2., 0.], [4.5, 4., 3.]));
    out.push(solid("wall", [4., 0., 0.], [4.5, if door { 1. } else { 2. }, 3.]));
    if door {
        out.push(solid("lintel", [4., 1., 2.], [4.5, 2., 3.]));
    }
    out
}

#[test]
fn the_inside_of_a_thick_wall_is_left_out() {
    let out = cut(thick_wall(true), &everything());
    assert_eq!((out.summary.n_solid, out.graph.n_cells(), out.graph.portals().len()), (3, 3, 2));
    assert_eq!(out.locate([4.25, 3., 1.]), None);
    assert_eq!(out.locate([4.25, 1.5, 2.5]), None, "the lintel");
    assert!(out.locate([4.25, 1.5, 1.]).is_some(), "the doorway");
    // On the border of the wall one is in the room.
    for x in [4.0, 4.5] {
        let at = out.locate([x, 3., 1.]).expect("a room");
        assert_eq!(out.locate_all([x, 3., 1.]), [at]);
    }
    let kept = cut(thick_wall(true), &SceneOptions { keep_solid: true, ..everything() });
    assert_eq!((kept.summary.n_solid, kept.graph.n_cells(), kept.graph.portals().len()), (0, 6, 2));
}

#[test]
fn a_closed_room_stays() {
    // No door, and the room on the right is a room all the same: it shows fronts.
    let out = cut(thick_wall(false), &everything());
    assert_eq!((out.summary.n_solid, out.graph.n_cells(), out.graph.portals().len()), (2, 2, 0));
    // A room between solid walls, each seen from outside of itself only.
    let walls = [
        solid("west", [0., 0., 0.], [1., 6., 3.]),
        solid("east", [5., 0., 0.], [6., 6., 3.]),
        solid("south", [1., 0., 0.], [5., 1., 3.]),
        solid("north", [1., 5., 0.], [5., 6., 3.]),
        solid("floor", [0., 0., -1.], [6., 6., 0.]),
        solid("ceiling", [0., 0., 3.], [6., 6., 4.]),
    ];
    let out = cut(walls.to_vec(), &everything());
    assert_eq!(out.graph.n_cells(), 1);
    assert_eq!(out.graph.cell(CellId(0)).bounds, aabb([1., 1., 0.], [5., 5., 3.]));
}

/// Two rooms whose walls are sheets, with a gap between the rooms; `inwards` turns the fronts of the two
/// sheets to the gap.
fn sheet_walls(inwards: bool) -> Vec<SceneObject> {
    let sheet = |x: f64, up: bool| object("sheet", &quad(0, [x, 0., 0.], [x, 4., 3.], up));
    vec![hull([0.; 3], [4., 4., 3.]), sheet(4.5, true), hull([4.5, 0., 0.], [9., 4., 3.]), sheet(4., inwards)]
}

#[test]
fn the_gap_between_sheets_is_hollow_if_it_shows_backs_only() {
    // Each room is closed by its own hull; the gap is closed on its sides by nothing.
    let out = cut(sheet_walls(false), &everything());
    assert_eq!((out.summary.n_hollow, out.graph.n_cells()), (0, 3));
    // With a closed edge all around, it is.
    let with_edge = |inwards| {
        let mut objects = sheet_walls(inwards);
        let edge: Vec<[Point3; 3]> = cuboid(&aabb([4., 0., 0.], [4.5, 4., 3.]), false);
        objects.push(object("edge", &edge[4..]));
        objects
    };
    let out = cut(with_edge(false), &everything());
    assert_eq!((out.summary.n_hollow, out.summary.n_solid, out.graph.n_cells()), (1, 0, 2));
    assert_eq!(cut(with_edge(true), &everything()).summary.n_hollow, 0, "a front is a room");
    // Something in the gap, and it may be somewhere to be.
    let mut inhabited = with_edge(false);
    inhabited.push(object("cat", &[[[4.1, 1., 1.], [4.2, 1., 1.5], [4.3, 2., 1.]]]));
    let out = cut(inhabited, &SceneOptions { detail_below: Some(1.2), ..SceneOptions::default() });
    assert_eq!((out.summary.n_hollow, out.summary.n_detail_objects, out.graph.n_cells()), (0, 1, 3));
    // Something that is elsewhere at rest, and may come into the gap, or not.
    let visited = |within| {
        let mut objects = with_edge(false);
        let cat = objects.len() as u32;
        objects.push(object("cat", &[[[1., 1., 1.], [1.2, 1., 1.5], [1.3, 2., 1.]]]));
        let scene = Scene::new(objects).unwrap().with_moving(vec![MovingObject { object: cat, within }]).unwrap();
        subdivide_scene(&scene, &everything()).unwrap().summary.n_hollow
    };
    let up_to = |x: f64| Some(aabb([1.; 3], [x, 2., 2.]));
    assert_eq!([visited(up_to(3.)), visited(up_to(4.2)), visited(None)], [1, 0, 0]);
}

#[test]
fn a_house_is_no_wall() {
    // A house as one closed box seen from outside, with a solid partition and a garden around.
    let house = || vec![solid("house", [0.; 3], [8., 6., 3.]), solid("partition", [3., 0., 0.], [3.5, 6., 3.])];
    let garden = SceneOptions { view_region: Some(aabb([-5.; 3], [13., 11., 8.])), ..everything() };
    let out = cut(house(), &garden);
    assert_eq!(out.summary.n_solid, 1, "the partition");
    assert!(out.locate([1., 1., 1.]).is_some() && out.locate([5., 1., 1.]).is_some());
    assert_eq!(out.locate([3.2, 1., 1.]), None);
    // Without anything in it, it is a block.
    let out = cut(house().into_iter().take(1).collect(), &garden);
    assert_eq!((out.summary.n_solid, out.locate([1., 1., 1.])), (1, None));
    // If that is all there is, it stays.
    let out = cut(house().into_iter().take(1).collect(), &everything());
    assert_eq!((out.summary.n_solid, out.graph.n_cells()), (0, 1));
    // With a room hollowed out by the same object, the rest is wall.
    let mut shell = cuboid(&aabb([0.; 3], [8., 6., 3.]), false);
    shell.extend(cuboid(&aabb([1.; 3], [7., 5., 2.]), true));
    let out = cut(vec![object("house", &shell)], &garden);
    assert!(out.locate([2., 2., 1.5]).is_some());
    assert_eq!(out.locate([0.5, 2., 1.5]), None);
}

#[test]
fn a_block_that_divides_nothing_takes_no_room_with_it() {
    // With the threshold at 1 the block stays inside of the room's cell, around the cell's middle.
    let pane = object("pane", &quad(0, [6., 0., 0.], [6., 6., 6.], true));
    let objects = vec![hull([0.; 3], [9., 6., 6.]), pane, solid("block", [2.; 3], [4.; 3])];
    let out = cut(objects, &SceneOptions { tau: 1.0, ..everything() });
    assert_eq!((out.graph.n_cells(), out.summary.n_unfollowed), (2, 6));
    assert_eq!(out.locate([3.; 3]), Some(CellId(0)));
}

#[test]
fn rooms_without_a_way_are_out_of_a_given_region() {
    let region = Some(aabb([0.; 3], [1., 4., 3.]));
    let options = SceneOptions { view_region: region, ..everything() };
    let out = cut(thick_wall(false), &options);
    assert_eq!((out.summary.n_unreachable, out.summary.n_solid, out.graph.n_cells()), (1, 2, 1));
    let out = cut(thick_wall(true), &options);
    assert_eq!((out.summary.n_unreachable, out.graph.n_cells()), (0, 3));
}

#[test]
fn the_view_region_is_part_of_what_is_cut() {
    let garden = aabb([-5., -5., 0.], [20., 5., 2.]);
    let out = cut(thick_wall(true), &SceneOptions { view_region: Some(garden), ..everything() });
    assert_eq!(out.tree.bounds(), aabb([-5., -5., 0.], [20., 5., 3.]));
    assert!(out.locate([-4., -4., 2.5]).is_some());
}

#[test]
fn bad_input_is_named() {
    let message = |objects: Vec<SceneObject>, options: &SceneOptions| {
        subdivide_scene(&scene(objects), options).unwrap_err().to_string()
    };
    let room = || vec![hull([0.; 3], [4., 4., 3.])];
    assert_eq!(message(vec![], &everything()), "the scene is empty");
    let sheet = object("sheet", &quad(2, [0., 0., 1.], [4., 4., 1.], true));
    assert_eq!(message(vec![sheet], &everything()), "the scene has no extent along axis 2");
    let with = |region| SceneOptions { view_region: Some(region), ..everything() };
    let inverted = with(aabb([1.; 3], [0.; 3]));
    assert_eq!(message(room(), &inverted), "the view region has a lower corner above its upper one");
    let infinite = with(aabb([0.; 3], [f64::INFINITY; 3]));
    assert_eq!(message(room(), &infinite), "bounds: coordinate inf is not a finite number");
    for size in [f64::NAN, -1.0] {
        let text = format!("size of detail {size} is not a number from 0 on");
        assert_eq!(message(room(), &SceneOptions { detail_below: Some(size), ..everything() }), text);
    }
    let limited = SceneOptions { max_cells: 1, ..everything() };
    assert_eq!(subdivide_scene(&scene(thick_wall(true)), &limited), Err(KdError::TooManyCells { limit: 1 }));
}

//! Doors: along which planes cells are divided for them, and which portals they close.

use crate::meshes::{aabb, cuboid, object};
use proptest::prelude::*;
use sightlines_cells::{AxialDoor, Point3, Scene, SceneObject};
use sightlines_kdtree::{SceneOptions, SceneSubdivision, ShutDoor, shut_doors, subdivide_scene};

const DOOR: u32 = 4;

fn solid(name: &str, min: Point3, max: Point3) -> SceneObject {
    object(name, &cuboid(&aabb(min, max), false))
}

/// Two rooms with a wall between x = 4 and 5, an opening in it from y = 1 to 2 up to z = 2, and a door.
fn rooms(door: SceneObject) -> Scene {
    let hull = object("hull", &cuboid(&aabb([0.0; 3], [9.0, 4.0, 3.0]), true));
    let walls = [
        solid("left", [4.0, 0.0, 0.0], [5.0, 1.0, 3.0]),
        solid("right", [4.0, 2.0, 0.0], [5.0, 4.0, 3.0]),
        solid("lintel", [4.0, 1.0, 2.0], [5.0, 2.0, 3.0]),
    ];
    let objects = [hull].into_iter().chain(walls).chain([door]).collect();
    let scene = Scene::new(objects).and_then(|scene| scene.with_see_through(vec![DOOR]));
    scene.and_then(|scene| scene.with_doors(vec![DOOR])).expect("a good scene")
}

fn cut(scene: &Scene) -> SceneSubdivision {
    let out = subdivide_scene(scene, &SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() });
    let out = out.expect("room for cells");
    out.graph.assert_well_formed();
    out
}

/// Another method: whether each of a lattice of points of a portal, a quarter off all coordinates of the scene, is in a triangle of
/// the door that lies in the plane of the portal.
fn is_shut(portal: &AxialDoor, door: &SceneObject) -> bool {
    let axis = usize::from(portal.axis);
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (min, max) = (portal.extent.min, portal.extent.max);
    let points = |k: usize| {
        let n = ((max[k] - min[k]) / 0.5) as u32;
        (0..n).map(move |i| min[k] + 0.25 + 0.5 * f64::from(i))
    };
    let covers = |t: [Point3; 3], p: [f64; 2]| {
        let side = |a: Point3, b: Point3| (b[u] - a[u]) * (p[1] - a[v]) - (b[v] - a[v]) * (p[0] - a[u]);
        let sides = [side(t[0], t[1]), side(t[1], t[2]), side(t[2], t[0])];
        t.iter().all(|corner| corner[axis] == min[axis])
            && (sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0))
    };
    points(u).all(|a| points(v).all(|b| door.corners().any(|t| covers(t, [a, b]))))
}

/// Whether the rooms are joined by portals that the door leaves open.
fn are_joined(out: &SceneSubdivision, door: Option<&ShutDoor>) -> bool {
    let [from, to] = [[1.0, 1.0, 1.0], [8.0, 1.0, 1.0]].map(|p| out.locate(p).expect("a room"));
    let (mut reached, mut stack) = (vec![false; out.graph.n_cells()], vec![from]);
    while let Some(cell) = stack.pop() {
        if !std::mem::replace(&mut reached[cell.idx()], true) {
            let open = out.graph.portals().iter().filter(|p| door.is_none_or(|door| !door.closes(&p.shape)));
            stack.extend(open.filter(|p| p.cells.contains(&cell)).flat_map(|p| p.cells));
        }
    }
    reached[to.idx()]
}

proptest! {
    /// Invariant: a door closes a portal in its plane if and only if its triangles are at all points of it, and none elsewhere; the
    /// cells stay joined with the door open. A door that fills the opening parts the rooms.
    #[test]
    fn doors_close_what_their_triangles_cover(
        low in [0u32..6, 0u32..5, 0u32..3],
        size in [1u32..4, 1u32..6, 1u32..6],
    ) {
        let min = [3.0 + 0.5 * f64::from(low[0]), 0.5 * f64::from(low[1]), 0.5 * f64::from(low[2])];
        let max: Point3 = std::array::from_fn(|k| (min[k] + 0.5 * f64::from(size[k])).min([9.0, 4.0, 3.0][k]));
        let scene = rooms(solid("door", min, max));
        let out = cut(&scene);
        let all = shut_doors(&scene);
        let [door] = &all[..] else { panic!("{all:?}") };
        let (axis, at) = (door.faces[0].axis, door.faces[0].at);
        for portal in out.graph.portals() {
            let is_in_plane = usize::from(portal.shape.axis) == axis && portal.shape.extent.min[axis] == at;
            let truth = is_in_plane && is_shut(&portal.shape, &scene.objects()[DOOR as usize]);
            prop_assert_eq!(door.closes(&portal.shape), truth, "{:?} of {:?}", portal, door);
        }
        prop_assert!(are_joined(&out, None));
        let fills = min[1] <= 1.0 && max[1] >= 2.0 && min[2] <= 0.0 && max[2] >= 2.0;
        if fills && axis == 0 && (4.0..=5.0).contains(&at) {
            prop_assert!(!are_joined(&out, Some(door)), "{door:?}");
        } else if at > 4.0 && at < 5.0 && axis == 0 {
            prop_assert!(are_joined(&out, Some(door)), "{door:?}");
        }
    }
}

#[test]
fn a_leaf_divides_its_opening_once() {
    let without = cut(&rooms(solid("door", [7.0, 1.0, 0.0], [7.5, 1.5, 1.0])));
    let scene = rooms(solid("door", [4.25, 1.0, 0.0], [4.5, 2.0, 2.0]));
    let out = cut(&scene);
    assert_eq!(out.graph.n_cells(), without.graph.n_cells() + 1);
    let doors = shut_doors(&scene);
    let closed: Vec<_> = out.graph.portals().iter().filter(|p| doors[0].closes(&p.shape)).collect();
    let [portal] = &closed[..] else { panic!("{closed:?}") };
    assert_eq!((portal.shape.extent.min, portal.shape.extent.max), ([4.25, 1.0, 0.0], [4.25, 2.0, 2.0]));
    // With two wings, and in a frame of its own, it fills the opening together.
    let wing = |y: f64| cuboid(&aabb([4.25, y, 0.0], [4.5, y + 0.5, 2.0]), false);
    let scene = rooms(object("wings", &[wing(1.0), wing(1.5)].concat()));
    assert!(!are_joined(&cut(&scene), shut_doors(&scene).first()));
    // The impostors: one wing alone, a leaf that ends a hair below the lintel, and one that is slanted.
    let slanted = |p: Point3| [p[0] + 0.125 * p[1], p[1], p[2]];
    let leaf = cuboid(&aabb([4.0, 1.0, 0.0], [4.25, 2.0, 2.0]), false);
    for door in [
        object("wing", &wing(1.0)),
        solid("low", [4.25, 1.0, 0.0], [4.5, 2.0, 2.0f64.next_down()]),
        object("slanted", &leaf.iter().map(|t| t.map(slanted)).collect::<Vec<_>>()),
    ] {
        let scene = rooms(door);
        assert!(are_joined(&cut(&scene), shut_doors(&scene).first()));
    }
    // What is no door divides nothing.
    let scene = rooms(solid("door", [4.25, 1.0, 0.0], [4.5, 2.0, 2.0])).with_doors(Vec::new()).unwrap();
    assert!(shut_doors(&scene).is_empty());
    assert_eq!(cut(&scene).graph.n_cells(), without.graph.n_cells());
}

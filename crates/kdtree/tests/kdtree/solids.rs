//! Random scenes of boxes: what is left out is matter, and what stays hangs together as before.

use crate::common::{centres, components, step};
use crate::meshes::{aabb, cube, cuboid, object, rectangle, scene, triangulated};
use proptest::prelude::*;
use sightlines_cells::{CellId, SceneObject};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneOptions, SceneSubdivision, scene_faces, subdivide_scene};

const SIDE: i32 = 4;

fn boxes_as_objects(boxes: &[Aabb<3>]) -> Vec<SceneObject> {
    boxes.iter().map(|b| object("box", &cuboid(b, false))).collect()
}

fn cut(objects: Vec<SceneObject>, keep_solid: bool) -> SceneSubdivision {
    cut_at(0.0, objects, keep_solid)
}

/// Cut with a margin of one all around, so that there is an outside.
fn cut_at(tau: f64, objects: Vec<SceneObject>, keep_solid: bool) -> SceneSubdivision {
    let n = f64::from(SIDE) + 1.0;
    let view_region = Some(aabb([-1.0; 3], [n; 3]));
    let options = SceneOptions { view_region, detail_below: Some(0.0), tau, keep_solid, ..SceneOptions::default() };
    let out = subdivide_scene(&scene(objects), &options).expect("the scene is good");
    out.graph.assert_well_formed();
    out
}

/// Middles of the unit cubes, the margin included.
fn cubes() -> Vec<[f64; 3]> {
    centres::<3>(SIDE as u32 + 2).into_iter().map(|c| c.map(|x| x - 1.0)).collect()
}

/// Left out is only what is inside of a box, and all that is inside of a box with no other box in it.
fn check_left_out(boxes: &[Aabb<3>], left_out: impl Fn([f64; 3]) -> bool) -> Result<(), String> {
    let inside = |a: &Aabb<3>, b: &Aabb<3>| a != b && b.contains(a.min) && b.contains(a.max);
    let is_wall = |b: &&Aabb<3>| !boxes.iter().any(|a| inside(a, b));
    for centre in cubes() {
        let around = || boxes.iter().filter(|b| b.contains(centre));
        if left_out(centre) && around().next().is_none() {
            return Err(format!("{centre:?} is left out, but in no box"));
        }
        if !left_out(centre) && around().any(|b| is_wall(&b)) {
            return Err(format!("{centre:?} is in a box, and not left out"));
        }
    }
    Ok(())
}

/// Flood filling the unit grid and walking through portals reach the same places.
fn check_connectivity(
    out: &SceneSubdivision,
    blocked: impl Fn(usize, [f64; 3]) -> bool,
    portals: impl Iterator<Item = [CellId; 2]>,
) -> Result<(), String> {
    let cubes = cubes();
    let index = |p: [f64; 3]| cubes.iter().position(|&c| c == p);
    let mut links = Vec::new();
    for (i, &centre) in cubes.iter().enumerate() {
        for axis in 0..3 {
            let (next, between) = step(centre, axis);
            links.extend(index(next).filter(|_| !blocked(axis, between)).map(|j| (i, j)));
        }
    }
    let flood = components(cubes.len(), links.into_iter());
    let walk = components(out.graph.n_cells(), portals.map(|[a, b]| (a.idx(), b.idx())));
    let found: Vec<Option<usize>> = cubes.iter().map(|&c| out.locate(c).map(|id| walk[id.idx()])).collect();
    for (i, j) in (0..cubes.len()).flat_map(|i| (0..i).map(move |j| (i, j))) {
        let (same, joined) = (flood[i] == flood[j], found[i] == found[j]);
        // Two that are left out may be in different walls, but never one in and one out of the same.
        if same != joined && (same || found[i].is_some()) {
            return Err(format!("flood fill and portals disagree whether {:?} leads to {:?}", cubes[i], cubes[j]));
        }
    }
    Ok(())
}

fn on_border(b: &Aabb<3>, axis: usize, p: [f64; 3]) -> bool {
    b.contains(p) && (p[axis] == b.min[axis] || p[axis] == b.max[axis])
}

fn portals(out: &SceneSubdivision) -> impl Iterator<Item = [CellId; 2]> + '_ {
    out.graph.portals().iter().map(|p| p.cells)
}

proptest! {
    /// Invariant: the insides of boxes are left out; the rest stays and is connected as flood fill finds.
    #[test]
    fn left_out_is_matter(boxes in prop::collection::vec(cube(SIDE), 1..6)) {
        let out = cut(boxes_as_objects(&boxes), false);
        check_left_out(&boxes, |p| out.locate(p).is_none()).map_err(TestCaseError::fail)?;
        let blocked = |axis: usize, p| boxes.iter().any(|b| on_border(b, axis, p));
        check_connectivity(&out, blocked, portals(&out)).map_err(TestCaseError::fail)?;
    }

    /// Invariant: at any threshold, what is left out is inside of boxes.
    #[test]
    fn left_out_is_matter_at_any_threshold(boxes in prop::collection::vec(cube(SIDE), 1..6), tau in 1u8..=4) {
        let out = cut_at(f64::from(tau) / 4.0, boxes_as_objects(&boxes), false);
        for p in cubes().into_iter().filter(|p| out.locate(*p).is_none()) {
            prop_assert!(boxes.iter().any(|b| b.contains(p)), "{p:?} is left out, but in no box");
        }
    }

    /// Invariant: leaving out changes no portal of what stays.
    #[test]
    fn what_stays_is_unchanged(boxes in prop::collection::vec(cube(SIDE), 1..5)) {
        let (out, whole) = (cut(boxes_as_objects(&boxes), false), cut(boxes_as_objects(&boxes), true));
        prop_assert_eq!(&out.tree, &whole.tree);
        let stays = |c: CellId| out.cell_of(c);
        let kept: Vec<_> = whole.graph.portals().iter().filter(|p| p.cells.iter().any(|&c| stays(c).is_some())).collect();
        prop_assert_eq!(kept.len(), out.graph.portals().len());
        for (p, q) in kept.iter().zip(out.graph.portals()) {
            prop_assert_eq!((p.cells.map(stays), p.shape), (q.cells.map(Some), q.shape));
        }
    }

    /// Invariant: with sheets of any kind, portals still lead exactly where flood fill gets; a threshold
    /// for small sheets only opens ways.
    #[test]
    fn sheets_hang_together(sheets in prop::collection::vec((rectangle(SIDE), any::<u64>()), 1..8)) {
        let triangles: Vec<_> = sheets.iter().flat_map(|((axis, min, max), seed)| triangulated(*axis, *min, *max, *seed)).collect();
        let out = cut(vec![object("sheets", &triangles)], true);
        let blocked = |axis: usize, p| sheets.iter().any(|((a, min, max), _)| *a == axis && aabb(*min, *max).contains(p));
        check_connectivity(&out, blocked, portals(&out)).map_err(TestCaseError::fail)?;
    }

    /// Invariant: a scene far from the origin is cut as one near it, if moving it loses no bits.
    #[test]
    fn far_from_the_origin_is_as_near(boxes in prop::collection::vec(cube(SIDE), 1..5), default in any::<bool>()) {
        let far = [1e7, -1e7, 33_554_432.0];
        let moved = |b: &Aabb<3>| {
            let shift = |p: [f64; 3]| std::array::from_fn(|k| p[k] / 4.0 + far[k]);
            Aabb { min: shift(b.min), max: shift(b.max) }
        };
        let near = |b: &Aabb<3>| Aabb { min: b.min.map(|x| x / 4.0), max: b.max.map(|x| x / 4.0) };
        let options = SceneOptions { detail_below: if default { None } else { Some(0.0) }, ..SceneOptions::default() };
        let cut = |boxes: Vec<Aabb<3>>| subdivide_scene(&scene(boxes_as_objects(&boxes)), &options).unwrap();
        let (here, there) = (cut(boxes.iter().map(near).collect()), cut(boxes.iter().map(moved).collect()));
        prop_assert_eq!(&here.summary, &there.summary);
        let back = |b: &Aabb<3>| {
            let shift = |p: [f64; 3]| std::array::from_fn(|k| p[k] - far[k]);
            Aabb { min: shift(b.min), max: shift(b.max) }
        };
        let there_boxes: Vec<_> = there.graph.cells().iter().map(|c| back(&c.bounds)).collect();
        prop_assert!(here.graph.cells().iter().map(|c| c.bounds).eq(there_boxes));
        let doors = |s: &SceneSubdivision| s.graph.portals().iter().map(|p| (p.cells, p.sides)).collect::<Vec<_>>();
        prop_assert_eq!(doors(&here), doors(&there));
    }

    /// Invariant: a larger size of detail leaves no new faces.
    #[test]
    fn detail_only_takes_away(boxes in prop::collection::vec(cube(SIDE), 1..6), size in 0u8..5) {
        let scene = scene(boxes_as_objects(&boxes));
        let faces = |size: u8| {
            let detail_below = Some(f64::from(size));
            scene_faces(&scene, &SceneOptions { detail_below, ..SceneOptions::default() }).faces
        };
        let all = faces(0);
        for f in faces(size) {
            let middle = std::array::from_fn(|k| f.min[k].midpoint(f.max[k]));
            let covers = |g: &sightlines_kdtree::AxialFace<3>| g.axis == f.axis && aabb(g.min, g.max).contains(middle);
            prop_assert!(all.iter().any(covers), "{f:?} is new");
        }
    }
}

#[test]
fn impostors_are_found_out() {
    let block = aabb([1.0; 3], [3.0; 3]);
    assert!(check_left_out(&[block], |p| block.contains(p)).is_ok());
    assert!(check_left_out(&[block], |_| false).is_err(), "one that leaves out nothing");
    assert!(check_left_out(&[block], |p| p[0] < 3.0 && p[0] > 1.0).is_err(), "one that leaves out too much");
    let out = cut(boxes_as_objects(&[block]), false);
    let blocked = |axis: usize, p: [f64; 3]| on_border(&block, axis, p);
    assert!(check_connectivity(&out, blocked, portals(&out)).is_ok());
    assert!(check_connectivity(&out, blocked, portals(&out).skip(1).take(1)).is_err(), "portals are missing");
    assert!(check_connectivity(&out, |_, _| false, portals(&out)).is_err(), "a block that lets through");
}

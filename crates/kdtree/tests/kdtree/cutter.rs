//! Scenes that are cut one after the other against scenes that are cut alone: all of the result is the same.

use proptest::prelude::*;
use sightlines_cells::{Scene, SceneObject};
use sightlines_geometry::Aabb;
use sightlines_kdtree::{SceneCutter, SceneOptions, SceneSubdivision, subdivide_scene};
use std::cell::Cell;

/// A box; open ones lack a side, and those turned inside out show their backs.
fn block([a, b]: [[u8; 3]; 2], kind: u8) -> SceneObject {
    let [a, b] = [a, b].map(|p| p.map(f64::from));
    let (min, max) = ([0, 1, 2].map(|k| a[k].min(b[k])), [0, 1, 2].map(|k| a[k].max(b[k]) + 1.0));
    let bounds: Aabb<3> = Aabb { min, max };
    let corner = |i: u32| [0, 1, 2].map(|k| if i >> k & 1 == 1 { bounds.max[k] } else { bounds.min[k] });
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let n_sides = if kind == 1 { 5 } else { 6 };
    let mut triangles: Vec<[u32; 3]> =
        sides[..n_sides].iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    if kind == 2 {
        triangles.iter_mut().for_each(|t| t.swap(0, 1));
    }
    if kind == 3 {
        // A slanted one.
        triangles.push([0, 1, 7]);
    }
    SceneObject { name: String::new(), vertices: (0..8).map(corner).collect(), triangles }
}

fn object() -> impl Strategy<Value = SceneObject> {
    (prop::array::uniform2(prop::array::uniform3(0..7u8)), 0..4u8).prop_map(|(ends, kind)| block(ends, kind))
}

#[derive(Debug, Clone)]
enum Edit {
    Remove(usize),
    Add(usize, SceneObject),
    Move(usize, usize, i8),
    Turn(usize),
    Detail(u8),
}

fn edit() -> impl Strategy<Value = Edit> {
    let index = any::<usize>;
    prop_oneof![
        index().prop_map(Edit::Remove),
        (index(), object()).prop_map(|(at, object)| Edit::Add(at, object)),
        (index(), 0..3usize, -1..2i8).prop_map(|(object, axis, by)| Edit::Move(object, axis, by)),
        index().prop_map(Edit::Turn),
        (0..4u8).prop_map(Edit::Detail),
    ]
}

fn apply(objects: &mut Vec<SceneObject>, options: &mut SceneOptions, edit: &Edit) {
    let n = objects.len();
    match edit {
        Edit::Remove(i) if n > 1 => drop(objects.remove(i % n)),
        Edit::Remove(_) => {}
        Edit::Add(i, object) => objects.insert(i % (n + 1), object.clone()),
        Edit::Move(i, axis, by) => objects[i % n].vertices.iter_mut().for_each(|p| p[*axis] += f64::from(*by)),
        Edit::Turn(by) => objects.rotate_left(by % n),
        Edit::Detail(size) => options.detail_below = Some(f64::from(*size)).filter(|size| *size < 3.0),
    }
}

/// Invariant: whatever was cut before, a scene is cut as if it were the first. The impostor, which keeps the result of
/// the previous scene, is detected.
#[test]
fn what_is_kept_changes_nothing() {
    let (n_cut, n_changed) = (Cell::new(0u32), Cell::new(0u32));
    let strategy = (prop::collection::vec(object(), 1..9), prop::collection::vec(edit(), 1..6));
    proptest!(|((objects, edits) in strategy)| {
        let (mut objects, mut options) = (objects, SceneOptions::default());
        let mut cutter = SceneCutter::default();
        let mut last: Option<SceneSubdivision> = None;
        for step in 0..=edits.len() {
            if step > 0 {
                apply(&mut objects, &mut options, &edits[step - 1]);
            }
            let scene = Scene::new(objects.clone()).expect("boxes make a scene");
            let (kept, alone) = (cutter.cut(&scene, &options), subdivide_scene(&scene, &options));
            prop_assert!(kept == alone, "step {}: {:?} and {:?}", step, kept.map(|c| c.summary), alone.map(|c| c.summary));
            let cut = alone.expect("boxes have room around them");
            n_cut.set(n_cut.get() + 1);
            n_changed.set(n_changed.get() + u32::from(last.as_ref().is_some_and(|last| *last != cut)));
            last = Some(cut);
        }
    });
    assert!(4 * n_changed.get() > n_cut.get(), "of {} cuts {} differ from the last", n_cut.get(), n_changed.get());
}

//! Eyes that walk: rooms behind closed doors are hidden, those behind open ones are not; against a flood of the cells of a lattice.

use crate::sides::block;
use proptest::prelude::*;
use sightlines_cells::{MovingObject, Scene, SceneObject};
use sightlines_geometry::{Aabb, Point3};
use sightlines_multifocal::Volume;
use sightlines_strip::{Eyes, Fate, HiddenReason, LineEffort, StripOptions, Stripped, strip};
use sightlines_testkit::fronts::{Mixed, lattice};
use std::collections::BTreeSet;

fn at(point: Point3) -> Volume {
    Volume::new(Aabb { min: point, max: point }).expect("a point")
}

fn walk(scene: &Scene, from: &[Point3], options: &StripOptions) -> Stripped {
    let eyes = Eyes::joined_to(from.iter().map(|p| at(*p))).expect("a point");
    strip(scene, &eyes, options, None).expect("no mirrors")
}

/// Two rooms of boards that touch each other, with a door between; a bed in the first, a chest in the second, a tree outside.
///
/// * `door`: how far it is open
/// * `turn`: so much each point moves along the second axis for a unit of the first
fn flat(door: f64, turn: f64) -> Scene {
    let boards = [
        ("Floor", [0.0, 0.0, 0.0], [13.0, 7.0, 1.0]),
        ("Ceiling", [0.0, 0.0, 5.0], [13.0, 7.0, 6.0]),
        ("West", [0.0, 0.0, 1.0], [1.0, 7.0, 5.0]),
        ("East", [12.0, 0.0, 1.0], [13.0, 7.0, 5.0]),
        ("South", [1.0, 0.0, 1.0], [12.0, 1.0, 5.0]),
        ("North", [1.0, 6.0, 1.0], [12.0, 7.0, 5.0]),
        ("Wall", [6.0, 1.0, 1.0], [7.0, 4.0, 5.0]),
        ("Lintel", [6.0, 4.0, 4.0], [7.0, 6.0, 5.0]),
        ("Door", [6.0, 4.0 + door, 1.0], [7.0, 6.0, 4.0]),
        ("Bed", [2.0, 2.0, 1.0], [4.0, 3.0, 2.0]),
        ("Chest", [9.0, 2.0, 1.0], [11.0, 3.0, 2.0]),
        ("Tree", [20.0, 2.0, 1.0], [21.0, 3.0, 9.0]),
    ];
    let turned = |mut of: SceneObject| {
        of.vertices.iter_mut().for_each(|p| p[1] += turn * p[0]);
        of
    };
    Scene::new(boards.into_iter().map(|(name, min, max)| turned(block(name, min, max))).collect()).expect("a scene")
}

fn hidden(scene: &Scene, from: &[Point3], gap: f64) -> Vec<String> {
    let found = walk(scene, from, &StripOptions { gap, ..StripOptions::default() });
    let is_hidden = |(_, of): &(&SceneObject, &sightlines_strip::ObjectFate)| of.fate.is_hidden();
    scene.objects().iter().zip(&found.objects).filter(is_hidden).map(|(of, _)| of.name.clone()).collect()
}

const IN_FIRST: Point3 = [3.0, 5.0, 3.0];
const IN_SECOND: Point3 = [10.0, 5.0, 3.0];

#[test]
fn a_room_behind_a_closed_door_is_hidden_and_one_behind_an_open_door_is_not() {
    let behind = |names: &[&str]| names.iter().map(ToString::to_string).collect::<Vec<_>>();
    let closed = flat(0.0, 0.0);
    assert_eq!(hidden(&closed, &[IN_FIRST], 0.0), behind(&["East", "Chest", "Tree"]));
    assert_eq!(hidden(&closed, &[IN_SECOND], 0.0), behind(&["West", "Bed", "Tree"]));
    assert_eq!(hidden(&closed, &[IN_FIRST, IN_SECOND], 0.0), behind(&["Tree"]));
    assert_eq!(hidden(&closed, &[[-5.0, 0.0, 0.0]], 0.0), behind(&["Wall", "Lintel", "Door", "Bed", "Chest"]));
    // Open by however little: a crack is a way.
    for door in [1.0, 0.125, 1e-9] {
        assert_eq!(hidden(&flat(door, 0.0), &[IN_FIRST], 0.0), behind(&["Tree"]), "{door}");
    }
    let found = walk(&flat(1.0, 0.0), &[IN_FIRST], &StripOptions::default());
    assert!(matches!(found.objects[10].fate, Fate::Seen(_)), "{:?}", found.objects[10].fate);
    // A door of glass, or one that moves, bars no way.
    assert_eq!(
        hidden(&closed.clone().with_see_through(vec![8]).expect("the door"), &[IN_FIRST], 0.0),
        behind(&["Tree"])
    );
    let moving = vec![MovingObject { object: 8, within: Some(Aabb { min: [6.0, 4.0, 1.0], max: [7.0, 8.0, 4.0] }) }];
    assert_eq!(hidden(&closed.with_moving(moving).expect("the door"), &[IN_FIRST], 0.0), behind(&["Tree"]));
}

/// Two walls back to back that hide from their fronts bar no way, though nothing passes them that is drawn from its front only.
#[test]
fn walls_that_hide_from_their_fronts_bar_no_way() {
    let closed = flat(0.0, 0.0);
    let sheet = |x: f64, is_up: bool| {
        let corners = [[x, 1.0, 1.0], [x, 6.0, 1.0], [x, 6.0, 5.0], [x, 1.0, 5.0]];
        let triangles = if is_up { vec![[0, 1, 2], [0, 2, 3]] } else { vec![[2, 1, 0], [3, 2, 0]] };
        SceneObject { name: "Sheet".to_owned(), vertices: corners.to_vec(), triangles }
    };
    let with = |sheets: Vec<SceneObject>| {
        let others = closed.objects().iter().filter(|of| !["Wall", "Lintel", "Door"].contains(&of.name.as_str()));
        Scene::new(others.cloned().chain(sheets).collect()).expect("a scene")
    };
    let pair = with(vec![sheet(6.5, true), sheet(6.5, false)]);
    let fronts = pair.clone().with_front_occluders(vec![9, 10]).expect("the sheets");
    assert_eq!(hidden(&fronts, &[IN_FIRST], 0.0), ["Tree"]);
    // The twin: the same sheets hide from both sides.
    assert_eq!(hidden(&pair, &[IN_FIRST], 0.0), ["East", "Chest", "Tree"]);
}

/// From outside, nothing is seen to which no way leads from there.
#[test]
fn boards_that_touch_enclose_from_outside() {
    for (door, n) in [(0.0, 5), (1.0, 5)] {
        let scene = flat(door, 0.0);
        let found = strip(&scene, &Eyes::outside(), &StripOptions::default(), None).expect("no mirrors");
        let n_enclosed = found.objects.iter().filter(|of| of.fate == Fate::Hidden(HiddenReason::Enclosed)).count();
        assert_eq!(n_enclosed, n, "{door}");
    }
    // The twin: a wall that is too short by however little.
    let mut objects = flat(1.0, 0.0).objects().to_vec();
    objects[3].vertices.iter_mut().for_each(|p| p[1] = p[1].min(6.999_999_9));
    objects[5].vertices.iter_mut().for_each(|p| p[0] = p[0].min(11.999_999_9));
    let scene = Scene::new(objects).expect("a scene");
    let found = strip(&scene, &Eyes::outside(), &StripOptions::default(), None).expect("no mirrors");
    assert!(found.objects.iter().all(|of| of.fate != Fate::Hidden(HiddenReason::Enclosed)));
}

/// Where no wall stands along an axis, boards bar the way within a gap, and not without one.
#[test]
fn turned_rooms_are_closed_within_the_gap() {
    let from = [3.0, 5.9, 3.0];
    assert_eq!(hidden(&flat(0.0, 0.3), &[from], 0.0), [""; 0]);
    let names = hidden(&flat(0.0, 0.3), &[from], 0.25);
    assert!(
        names.contains(&"Chest".into()) && names.contains(&"Tree".into()) && !names.contains(&"Bed".into()),
        "{names:?}"
    );
    let open = hidden(&flat(1.0, 0.3), &[from], 0.25);
    assert!(!open.contains(&"Chest".into()) && open.contains(&"Tree".into()), "{open:?}");
    // A door that is open by less than the gap may count as closed; by more, it does not.
    assert!(!hidden(&flat(0.3, 0.3), &[from], 0.25).contains(&"Chest".into()));
    assert!(hidden(&flat(0.01, 0.3), &[from], 0.25).contains(&"Chest".into()));
}

/// A lattice of three cells along each axis with a block in each, and which blocks no way joins to the cell of the eye.
struct Cells {
    scene: Scene,
    /// The lower corners of the squares that bar ways, and their axes.
    walls: BTreeSet<([i32; 3], usize)>,
}

const N_CELLS: i32 = 27;

fn cell(k: i32) -> [i32; 3] {
    [k / 9, k / 3 % 3, k % 3]
}

impl Cells {
    fn new(of: &Mixed) -> Self {
        let blocks = (0..N_CELLS).map(|k| {
            let low = cell(k).map(f64::from);
            block("", low.map(|x| x + 0.4), low.map(|x| x + 0.6))
        });
        let sheet =
            |t: &[Point3; 3]| SceneObject { name: String::new(), vertices: t.to_vec(), triangles: vec![[0, 1, 2]] };
        let sheets = of.both_sides.iter().chain(&of.fronts).map(sheet);
        let scene = Scene::new(blocks.chain(sheets).collect()).expect("a scene");
        let first = N_CELLS as u32 + of.both_sides.len() as u32;
        let fronts = (first..first + of.fronts.len() as u32).collect();
        let wall = |t: &[Point3; 3]| {
            let b = Aabb::around(*t);
            let axis = (0..3).find(|&k| b.min[k] == b.max[k]).expect("a square across an axis");
            (b.min.map(|x| x as i32), axis)
        };
        let walls = of.both_sides.iter().map(wall).collect();
        Self { scene: scene.with_front_occluders(fronts).expect("sheets"), walls }
    }

    /// The cells that ways join to one; those beyond the border are outside.
    fn joined_to(&self, start: [i32; 3]) -> BTreeSet<[i32; 3]> {
        let mut found = BTreeSet::new();
        let mut pending = vec![start];
        while let Some(cell) = pending.pop() {
            if !cell.iter().all(|x| (-1..4).contains(x)) || !found.insert(cell) {
                continue;
            }
            for axis in 0..3 {
                let (mut after, mut before) = (cell, cell);
                (after[axis], before[axis]) = (cell[axis] + 1, cell[axis] - 1);
                pending.extend((!self.walls.contains(&(after, axis))).then_some(after));
                pending.extend((!self.walls.contains(&(cell, axis))).then_some(before));
            }
        }
        found
    }

    /// The blocks that are said to be hidden from eyes that walk from a cell, and those that truly are.
    fn judge(&self, start: [i32; 3], truth: &Self) -> [Vec<i32>; 2] {
        let found = walk(&self.scene, &[start.map(|x| f64::from(x) + 0.2)], &quick());
        let joined = truth.joined_to(start);
        for (k, of) in (0..N_CELLS).zip(&found.objects) {
            // What is seen is where a way leads to.
            assert!(!matches!(of.fate, Fate::Seen(_)) || joined.contains(&cell(k)), "{k}");
        }
        let said = (0..N_CELLS).zip(&found.objects).filter(|(_, of)| of.fate.is_hidden()).map(|(k, _)| k);
        let hidden = (0..N_CELLS).filter(|k| !joined.contains(&cell(*k)));
        [said.collect(), hidden.collect()]
    }
}

fn start() -> impl Strategy<Value = [i32; 3]> {
    [-1i32..3, 0i32..3, 0i32..3]
}

/// Neither line space nor many rays.
fn quick() -> StripOptions {
    let effort = LineEffort { sides: 0, ..LineEffort::default() };
    StripOptions { effort, first_rays: 8, more_rays: 0, threads: 1, ..StripOptions::default() }
}

/// Lattices with more walls: what three have.
fn lattices() -> impl Strategy<Value = Mixed> {
    (lattice(), lattice(), lattice(), 0u8..3).prop_map(|(mut one, two, three, n)| {
        for more in [two, three].into_iter().take(n.into()) {
            one.both_sides.extend(more.both_sides);
        }
        one
    })
}

proptest! {
    /// Invariant: of what stands along axes exactly that is hidden to which no way leads.
    #[test]
    fn what_no_way_leads_to_is_hidden_and_nothing_else(of in lattices(), start in start()) {
        let cells = Cells::new(&of);
        let [said, hidden] = cells.judge(start, &cells);
        prop_assert_eq!(said, hidden);
    }
}

/// The property saw both; and a lattice that lacks a wall is not the same.
#[test]
fn impostor_a_wall_too_many_is_noticed() {
    let (mut n_hidden, mut n_noticed) = (0, 0);
    for of in sightlines_testkit::draw(&lattices(), 80) {
        let whole = Cells::new(&of);
        n_hidden += whole.judge([1; 3], &whole)[1].len();
        let mut lacking = Cells::new(&of);
        let beside = [([1, 1, 1], 0), ([1, 1, 1], 1), ([1, 1, 1], 2)];
        beside.iter().for_each(|wall| _ = lacking.walls.remove(wall));
        let joined = lacking.joined_to([1; 3]);
        let said = walk(&whole.scene, &[[1.2; 3]], &quick());
        let is_wrong = (0..N_CELLS).zip(&said.objects).any(|(k, of)| of.fate.is_hidden() && joined.contains(&cell(k)));
        n_noticed += usize::from(is_wrong);
    }
    assert!(n_hidden > 50 && n_noticed > 3, "{n_hidden} hidden, {n_noticed} noticed");
}

/// What is seen is seen from where free segments lead to, and reasons are exact.
#[test]
fn reasons_of_what_walkers_do_not_see_are_exact() {
    let found = walk(&flat(0.0, 0.0), &[IN_FIRST], &StripOptions::default());
    assert_eq!(found.objects[10].fate, Fate::Hidden(HiddenReason::Enclosed));
    let Fate::Seen([eye, _]) = found.objects[9].fate else { panic!("{:?}", found.objects[9].fate) };
    assert!((1.0..=6.0).contains(&eye[0]) && (1.0..=6.0).contains(&eye[1]), "{eye:?}");
}

//! Walls that hide from one side, against what the same walls hide from both sides, and from none.

use crate::boxes::{SIDE, cut, faces, objects};
use proptest::prelude::*;
use sightlines_cells::{Axial, CellGraph, CellId, Portal};
use sightlines_geometry::{Aabb, AxialDoor, OneWayRectangle};
use sightlines_kdtree::AxialFace;
use sightlines_pvs::BitMatrix;
use sightlines_stabtree::{AxialVisibility, PairMask, SearchOptions, axial_visibility, box_visibility};
use sightlines_testkit::draw;

/// A graph, the same with portals where it has walls that hide from one side, and those walls. All of their fronts face larger x.
struct Case {
    solid: Vec<Aabb<3>>,
    walls: CellGraph<Axial>,
    open: CellGraph<Axial>,
    fronts: Vec<OneWayRectangle>,
}

/// The unit squares of the grid that an x-plane has within two boxes that touch there.
fn squares(a: &Aabb<3>, b: &Aabb<3>) -> Vec<Aabb<3>> {
    let mut found = Vec::new();
    for (y, z) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |z| (f64::from(y), f64::from(z)))) {
        let square = Aabb { min: [a.max[0], y, z], max: [a.max[0], y + 1.0, z + 1.0] };
        let holds = |cell: &Aabb<3>| (1..3).all(|k| cell.min[k] <= square.min[k] && square.max[k] <= cell.max[k]);
        if a.max[0] == b.min[0] && holds(a) && holds(b) {
            found.push(square);
        }
    }
    found
}

fn covers(face: &Aabb<3>, square: &Aabb<3>) -> bool {
    (0..3).all(|k| face.min[k] <= square.min[k] && square.max[k] <= face.max[k])
}

impl Case {
    /// Of the faces across x, every other one hides from its front only.
    fn new(faces: &[AxialFace<3>], out: &[bool]) -> Self {
        let (walls, solid) = cut(faces, out);
        let bounds = |face: &AxialFace<3>| Aabb { min: face.min, max: face.max };
        let across: Vec<Aabb<3>> = faces.iter().filter(|face| face.axis == 0).map(bounds).collect();
        let (front, both): (Vec<_>, Vec<_>) = across.iter().enumerate().partition(|(i, _)| i % 2 == 0);
        let mut portals = walls.portals().to_vec();
        let cells = walls.cells();
        for (a, b) in (0..cells.len()).flat_map(|a| (0..cells.len()).map(move |b| (a, b))) {
            for square in squares(&cells[a].bounds, &cells[b].bounds) {
                let is_open = walls.portals().iter().any(|p| covers(&p.shape.extent, &square));
                if !is_open && !both.iter().any(|(_, face)| covers(face, &square)) {
                    let shape = AxialDoor { extent: square, axis: 0, forward: true };
                    portals.push(Portal { cells: [a, b].map(|cell| CellId(cell as u32)), sides: [1, 0], shape });
                }
            }
        }
        let open = CellGraph::new(cells.to_vec(), portals);
        let fronts = front.iter().map(|(_, bounds)| OneWayRectangle { bounds: **bounds, front_up: true }).collect();
        Self { solid, walls, open, fronts }
    }
}

fn seen(
    graph: &CellGraph<Axial>,
    case: &Case,
    fronts: &[OneWayRectangle],
    objects: &[Aabb<3>],
    threads: usize,
) -> AxialVisibility {
    let options = SearchOptions { threads, ..SearchOptions::default() };
    axial_visibility(graph, &case.solid, fronts, objects, &options).expect("nobody cancels")
}

/// Lines towards larger x pass all of these walls as if they were not there, and lines towards smaller x none of them. So cells see each other
/// as without them, as one of two directions is free; and what lies wholly on one side of a cell is seen as without them, or as if they hid from
/// both sides. The same for given boxes. The impostor: fronts that face the other way.
#[test]
fn walls_hide_from_their_fronts_only() {
    let out = || prop::collection::vec(prop::bool::weighted(0.2), 1..9);
    let (mut n_ahead, mut n_behind, mut n_between, mut n_impostors) = (0u64, 0u64, 0u64, 0);
    for (faces, out, objects) in draw(&(faces(24), out(), objects()), 2500) {
        let case = Case::new(&faces, &out);
        let cells = case.open.cells();
        if cells.is_empty() {
            continue;
        }
        let [none, all] = [&case.open, &case.walls].map(|graph| seen(graph, &case, &[], &objects, 1));
        let ours = seen(&case.open, &case, &case.fronts, &objects, 1);
        let again = seen(&case.open, &case, &case.fronts, &objects, 2);
        assert_eq!((&ours.cells, &ours.objects), (&again.cells, &again.objects), "threads change nothing");
        let boxes: Vec<Aabb<3>> = cells.iter().map(|cell| cell.bounds).collect();
        let mut asked =
            PairMask { boxes: BitMatrix::identity(boxes.len()), objects: BitMatrix::new(boxes.len(), objects.len()) };
        let pairs = |n: usize| (0..boxes.len()).flat_map(move |a| (0..n).map(move |b| (a, b)));
        pairs(boxes.len()).for_each(|(a, b)| asked.boxes.set(a, b, true));
        pairs(objects.len()).for_each(|(a, b)| asked.objects.set(a, b, true));
        let options = SearchOptions { threads: 1, ..SearchOptions::default() };
        let given = |graph: &CellGraph<Axial>, fronts: &[OneWayRectangle]| {
            box_visibility(graph, &case.solid, fronts, &boxes, &objects, &asked, &options).expect("nobody cancels")
        };
        let [given, given_none, given_all] = [(&case.open, &case.fronts[..]), (&case.open, &[]), (&case.walls, &[])]
            .map(|(graph, fronts)| given(graph, fronts));
        for (a, b) in pairs(boxes.len()) {
            let [low, high] = if boxes[a].max[0] <= boxes[b].min[0] { [a, b] } else { [b, a] };
            if boxes[low].max[0] <= boxes[high].min[0] {
                assert_eq!(ours.cells.get(a, b), none.cells.get(a, b), "{a} {b}: {faces:?}");
                n_between += u64::from(none.cells.get(a, b) != all.cells.get(a, b));
            }
            assert!(all.cells.get(a, b) <= ours.cells.get(a, b) && ours.cells.get(a, b) <= none.cells.get(a, b));
        }
        let turned: Vec<OneWayRectangle> =
            case.fronts.iter().map(|f| OneWayRectangle { front_up: false, ..*f }).collect();
        let impostor = seen(&case.open, &case, &turned, &objects, 1);
        for (a, o) in pairs(objects.len()).filter(|(_, o)| !objects[*o].is_empty()) {
            let [is_seen, at_most, at_least] = [&ours, &none, &all].map(|seen| seen.objects.get(a, o));
            assert!(at_least <= is_seen && is_seen <= at_most, "{a} {o}: {faces:?}");
            // A flat object that touches a wall may be on either side of it.
            if objects[o].min[0] > boxes[a].max[0] {
                assert_eq!(is_seen, at_most, "cell {a}, object {o} ahead: {faces:?}");
                n_ahead += u64::from(at_most != at_least);
                n_impostors += u64::from(impostor.objects.get(a, o) != at_most);
            } else if objects[o].max[0] < boxes[a].min[0] {
                assert_eq!(is_seen, at_least, "cell {a}, object {o} behind: {faces:?}");
                n_behind += u64::from(at_most != at_least);
            }
            let is_given = given.objects.get(a, o);
            if objects[o].min[0] > boxes[a].max[0] {
                assert_eq!(is_given, given_none.objects.get(a, o), "given box {a}, object {o} ahead: {faces:?}");
            } else if objects[o].max[0] < boxes[a].min[0] {
                assert_eq!(is_given, given_all.objects.get(a, o), "given box {a}, object {o} behind: {faces:?}");
            }
        }
        for (a, b) in pairs(boxes.len()) {
            if boxes[a].max[0] < boxes[b].min[0] || boxes[b].max[0] < boxes[a].min[0] {
                assert_eq!(given.boxes.get(a, b), given_none.boxes.get(a, b), "given {a} {b}: {faces:?}");
            }
        }
    }
    eprintln!("{n_ahead} ahead, {n_behind} behind, {n_between} of cells, {n_impostors} caught");
    assert!(
        n_ahead > 20 && n_behind > 20 && n_between > 20 && n_impostors > 10,
        "{n_ahead} {n_behind} {n_between} {n_impostors}"
    );
}

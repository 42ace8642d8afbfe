//! Rooms with boxes in them, on a small grid: what is seen is known exactly.

use crate::eye_to_cell::ask::{Answer, Asker, missed, missed_within_bounds, not_nested};
use crate::eye_to_cell::picture::{Picture, box_around, minus};
use crate::eye_to_cell::plans::{reachable, some_doors};
use sightlines::bake::{SceneBakeOptions, StabOptions, bake_scene, from_table, with_stab_trees};
use sightlines::cells::{Scene, SceneObject};
use sightlines::eye_to_cell::{Doors, View};
use sightlines::geometry::{Aabb, Point3};
use sightlines::kdtree::SceneOptions;
use sightlines::pvs::Table;
use sightlines_testkit::Random;
use sightlines_testkit::{directions_among_boxes, first_box, range_in_box};

/// Side of the room.
pub(crate) const SIDE: usize = 8;

fn cuboid(name: String, b: &Aabb<3>, room: bool) -> SceneObject {
    let corner = |i: usize| [0, 1, 2].map(|k| if i >> k & 1 == 1 { b.max[k] } else { b.min[k] });
    // Each side as it is seen from outside.
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let mut triangles: Vec<[u32; 3]> = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    if room {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    SceneObject { name, vertices: (0..8).map(corner).collect(), triangles }
}

/// A room and what stands in it; object 0 is the room, the others are the boxes.
pub(crate) struct Room {
    pub(crate) solids: Vec<Aabb<3>>,
    pub(crate) table: Table,
}

impl Room {
    /// Walls with gaps, mostly.
    pub(crate) fn random(seed: u64, n_boxes: usize) -> Self {
        let mut random = Random::new(seed, 1);
        let solid = |_| {
            let thin = random.below(3);
            let size = [0, 1, 2].map(|k| if k == thin { 1 } else { 2 + random.below(SIDE - 2) });
            let min = size.map(|size| random.below(SIDE - size + 1));
            Aabb { min: min.map(|x| x as f64), max: [0, 1, 2].map(|k| (min[k] + size[k]) as f64) }
        };
        Self::of((0..n_boxes).map(solid).collect())
    }

    fn of(solids: Vec<Aabb<3>>) -> Self {
        let room = Aabb { min: [0.0; 3], max: [SIDE as f64; 3] };
        let mut objects = vec![cuboid("room".to_owned(), &room, true)];
        objects.extend(solids.iter().enumerate().map(|(k, b)| cuboid(format!("box {k}"), b, false)));
        let scene = Scene::new(objects).expect("boxes");
        let cut = SceneOptions { detail_below: Some(0.0), ..SceneOptions::default() };
        let options = SceneBakeOptions { cut, threads: 1, ..SceneBakeOptions::default() };
        Self { solids, table: bake_scene(&scene, &options).expect("a room").table }
    }

    /// The same room with stab trees of at most so many nodes.
    pub(crate) fn with_trees(&self, max_nodes: Option<usize>) -> Table {
        let options = StabOptions { max_nodes, threads: 1, ..StabOptions::default() };
        with_stab_trees(
            self.table.clone(),
            &from_table::graph(&self.table).expect("the table stores its graph"),
            &options,
        )
        .expect("the table has its geometry")
        .table
    }

    pub(crate) fn cells(&self) -> Vec<Aabb<3>> {
        self.table.cells().iter().map(|c| Aabb { min: c.min, max: c.max }).collect()
    }

    /// Whether a place is in the room and in no box.
    pub(crate) fn is_open(&self, p: Point3) -> bool {
        let inside = |b: &Aabb<3>| (0..3).all(|k| b.min[k] <= p[k] && p[k] <= b.max[k]);
        p.iter().all(|x| (0.0..=SIDE as f64).contains(x)) && !self.solids.iter().any(inside)
    }
}

/// A place in the open: anywhere, where its coordinates have nothing to do with the grid; or with one, two or three
/// of them on the grid, on the borders of cells.
pub(crate) fn place(room: &Room, n_on_grid: usize, random: &mut Random) -> Option<Point3> {
    let first = random.below(3);
    (0..50).find_map(|_| {
        let mut p = [0.0; 3].map(|_: f64| SIDE as f64 * random.unit());
        (0..n_on_grid).for_each(|k| p[(first + k) % 3] = p[(first + k) % 3].round());
        room.is_open(p).then_some(p)
    })
}

/// What a room shows in all directions, and in some pictures. Doors are boxes that are flat and hide what is behind.
fn shown(room: &Room, doors: &[Aabb<3>], eye: Point3, pictures: &[Picture]) -> Vec<Answer> {
    let cells = room.cells();
    let hindrances = [room.solids.clone(), doors.to_vec()].concat();
    let mut shown = vec![Answer::default(); pictures.len() + 1];
    for d in directions_among_boxes(&[hindrances.clone(), cells.clone()].concat(), eye) {
        let hit = first_box(&hindrances, eye, d);
        let end = hit.map_or(f64::INFINITY, |hit| hit.t);
        let passed = |b: &Aabb<3>| range_in_box(b, eye, d).is_some_and(|[from, to]| from.max(0.0) < to.min(end));
        // Boxes that touch are met at the same distance.
        let solid = hit.filter(|hit| {
            let others = hindrances.iter().enumerate().filter(|(k, _)| *k != hit.solid);
            let others: Vec<Aabb<3>> = others.map(|(_, b)| *b).collect();
            first_box(&others, eye, d).is_none_or(|other| other.t > hit.t * (1.0 + 1e-9))
        });
        let object = solid.filter(|hit| hit.solid < room.solids.len()).map(|hit| hit.solid as u32 + 1);
        let object = if hit.is_none() { Some(0) } else { object };
        let passed: Vec<u32> = (0..).zip(&cells).filter(|(_, b)| passed(b)).map(|(id, _)| id).collect();
        let wanted = |k: usize| k == 0 || pictures[k - 1].contains(d);
        for answer in (0..shown.len()).filter(|&k| wanted(k)) {
            shown[answer].cells.extend(&passed);
            shown[answer].objects.extend(object);
        }
    }
    shown
}

#[derive(Debug, Default)]
struct Counts {
    n_frames: usize,
    n_seen: usize,
    n_exact: usize,
    /// Cells that the exact method shows all round and no ray passes, from eyes on the grid.
    n_surplus: usize,
    n_cells: [usize; 5],
    n_objects: [usize; 5],
}

/// Looks from one place into all directions and into a few pictures.
fn check(room: &Room, n_on_grid: usize, seed: u64, counts: &mut Counts) -> Result<(), String> {
    let mut random = Random::new(seed, 2);
    let Some(eye) = place(room, n_on_grid, &mut random) else { return Ok(()) };
    let (doors, closed) = some_doors(&room.table, &mut random);
    let portals = room.table.portals();
    let closed: Vec<Aabb<3>> = closed.iter().map(|&p| box_around(&portals[p as usize].points)).collect();
    let pictures: Vec<Picture> = (0..4)
        .map(|k| {
            let towards = match k {
                0 => random.direction(),
                _ => minus(portals[random.below(portals.len())].points[random.below(4)], eye),
            };
            let towards = if towards == [0.0; 3] { [1.0, 0.0, 0.0] } else { towards };
            Picture::random(eye, towards, &mut random)
        })
        .collect();
    let shown = shown(room, &closed, eye, &pictures);
    let roots = room.table.in_dimension().unwrap().at(eye).cells().to_vec();
    let walked = reachable(&room.table, &roots, &doors);
    let all_round = View::all_round(eye).expect("a finite eye");
    let views: Vec<&View> = std::iter::once(&all_round).chain(pictures.iter().map(|p| &p.view)).collect();
    let trees = [room.with_trees(None), room.with_trees(Some(8))];
    for table in trees.iter().chain([&room.table]) {
        let mut asker = Asker::new(table);
        for (k, (&view, seen)) in views.iter().zip(&shown).enumerate() {
            let answers = asker.all(&roots, view, &doors);
            let trees = table.stab().map(|t| t.n_nodes());
            let what = || format!("eye {eye:?}, closed {closed:?}, view {k} {view:?}, trees {trees:?}");
            if let Some(wrong) = not_nested(&answers)
                .or_else(|| missed(&answers, seen))
                .or_else(|| missed_within_bounds(&asker.bounded, seen))
            {
                return Err(format!("{wrong}: {}", what()));
            }
            if let Some(cell) = answers[2].cells.difference(&walked).next() {
                return Err(format!("cell {cell} is behind closed portals: {}", what()));
            }
            if k == 0 {
                let surplus: Vec<&u32> = answers[4].cells.difference(&seen.cells).collect();
                if n_on_grid == 0 && !surplus.is_empty() {
                    return Err(format!("exact shows {surplus:?}, which no ray passes: {}", what()));
                }
                counts.n_surplus += surplus.len();
                counts.n_exact += answers[4].cells.len();
            }
            counts.n_frames += 1;
            counts.n_seen += seen.cells.len() + seen.objects.len();
            for (method, answer) in answers.iter().enumerate() {
                counts.n_cells[method] += answer.cells.len();
                counts.n_objects[method] += answer.objects.len();
            }
        }
    }
    Ok(())
}

/// Invariant: among boxes, with any portals closed, the answers are nested and miss nothing that a ray meets; the
/// exact one has all round exactly the cells that rays pass, but for grazing ones, which eyes on the grid have.
#[test]
fn rooms_with_boxes_are_seen_as_they_are() {
    let mut counts = Counts::default();
    for seed in 0..8 {
        let room = Room::random(seed, 2 + seed as usize % 4);
        for n_on_grid in [0, 0, 1, 2, 3] {
            let seed = 100 * seed + counts.n_frames as u64;
            check(&room, n_on_grid, seed, &mut counts).unwrap_or_else(|wrong| panic!("{wrong}\n{:?}", room.solids));
        }
    }
    eprintln!("{counts:?}");
    assert!(counts.n_frames > 500 && counts.n_seen > 3_000, "{counts:?}");
    assert!(counts.n_cells.is_sorted_by(|a, b| a > b) && counts.n_objects.is_sorted_by(|a, b| a >= b), "{counts:?}");
    assert!(counts.n_surplus * 10 < counts.n_exact, "{counts:?}");
}

/// The impostors: a cell less, an object less, a cell too many are noticed.
#[test]
fn wrong_answers_about_a_room_are_noticed() {
    let room = Room::random(3, 4);
    let eye = place(&room, 0, &mut Random::new(3, 3)).expect("there is room");
    let shown = &shown(&room, &[], eye, &[])[0];
    let view = View::all_round(eye).expect("a finite eye");
    let answers =
        Asker::new(&room.table).all(room.table.in_dimension().unwrap().at(eye).cells(), &view, &Doors::all_open());
    assert_eq!((missed(&answers, shown), &answers[4].cells), (None, &shown.cells));
    for cell in &shown.cells {
        let mut less = answers.clone();
        less[4].cells.remove(cell);
        assert!(missed(&less, shown).is_some());
    }
    let mut less = answers.clone();
    assert!(less[4].objects.pop_first().is_some() && missed(&less, shown).is_some());
    assert!(answers[1].cells.len() > shown.cells.len(), "a method that shows too much is not taken for the exact one");
}

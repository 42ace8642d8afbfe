//! A viewer answers as the methods do, cell by cell.

use crate::walk::hall_of_mirrors;
use sightlines_bake::{BakeRequest, PlanBakeOptions, bake, bake_plan};
use sightlines_eye_to_cell::{
    Doors, Method, MirrorImage, Scratch, StepBudget, TableCells, View, VisibleSet, VisibleSubgraph, follow_reflections,
};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, DoorId, ObjectId, PortalId, Table};
use sightlines_scenes::{OfficeOptions, TowerOptions, office, tower};
use sightlines_walkthrough::Viewer;
use std::sync::Arc;

/// What an eye sees: cells, objects, the method that answered, and what is seen in mirrors.
type Seen = (Vec<CellId>, Vec<ObjectId>, Option<Method>, Vec<MirrorImage>);

/// A look, as one asks for it.
struct Ask {
    view: View,
    method: Method,
    budget: StepBudget,
    doors: Doors,
}

/// The oracle: the answer for an eye in these cells, with everything made anew.
fn by_cell(cells: &TableCells<Arc<Table>>, at: &[CellId], ask: &Ask) -> Seen {
    let counts @ [n_cells, n_objects] = [cells.table().n_cells(), cells.table().objects().len()];
    if at.is_empty() {
        let all = |n: usize| 0..n as u32;
        return (all(n_cells).map(CellId).collect(), all(n_objects).map(ObjectId).collect(), None, vec![]);
    }
    let prepared = |cell: CellId| VisibleSubgraph::prepare(cells, cell).expect("a table in memory");
    let (mut scratch, mut seen) = (Scratch::new(), VisibleSet::new());
    scratch.allow(ask.budget);
    seen.clear(n_cells, n_objects);
    let look = |&cell: &CellId| ask.method.look(&prepared(cell), &ask.view, &ask.doors, &mut scratch, &mut seen);
    let by = at.iter().map(look).min();
    seen.sort();
    scratch.allow(ask.budget);
    let there = |cell| Some(prepared(cell));
    let images = follow_reflections(ask.method, &seen, 2, &ask.doors, &mut scratch, counts, there);
    (seen.cells().to_vec(), seen.objects().to_vec(), by, images)
}

/// The same of a viewer that has looked before.
fn by_viewer(viewer: &mut Viewer, ask: &Ask) -> Seen {
    viewer.set_method(ask.method);
    viewer.set_budget(ask.budget);
    viewer.doors_mut().clone_from(&ask.doors);
    let look = viewer.look(&ask.view);
    let (by, at) = (look.method, look.at.to_vec());
    assert_eq!((look.is_outside(), by.is_none()), (at.is_empty(), at.is_empty()));
    let images = viewer.follow_reflections(2).to_vec();
    assert_eq!(viewer.images(), images);
    let portals = viewer.portals();
    let joins = |p: &PortalId| viewer.table().portals()[p.idx()].cells.iter().all(|&cell| viewer.seen().has_cell(cell));
    match at.is_empty() {
        true => assert_eq!(portals.len(), viewer.table().portals().len()),
        false => assert!(portals.iter().all(|p| ask.doors.is_open(*p) && joins(p))),
    }
    (viewer.seen().cells().to_vec(), viewer.seen().objects().to_vec(), by, images)
}

fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mixed = (*state ^ (*state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb)
}

/// The `k`th look into a table: every eighth on a portal, every eighth outside of everything.
fn ask(table: &Table, k: usize, state: &mut u64) -> Ask {
    let mut share = || (random(state) >> 11) as f64 / (1u64 << 53) as f64;
    let bounds = Aabb::around(table.cells().iter().flat_map(|cell| [cell.min, cell.max]));
    let eye = match k % 8 {
        0 => table.portals()[(share() * table.portals().len() as f64) as usize].points[0],
        1 => bounds.max.map(|x| x + 0.5),
        _ => std::array::from_fn(|i| bounds.min[i] + share() * (bounds.max[i] - bounds.min[i])),
    };
    let dir: [f64; 3] = std::array::from_fn(|_| share() - 0.5);
    let view = match (k % 7, table.dimension()) {
        (0, _) => View::all_round(eye),
        (_, 2) => View::planar([eye[0], eye[1]], [dir[0], dir[1]], 1.2),
        _ => View::perspective_vertical(eye, dir, [0.0, 1.0, 0.0], 1.2, 1.5),
    };
    let mut doors = Doors::all_open();
    for _ in 0..k % 3 * table.portals().len() / 8 {
        doors.close(PortalId((share() * table.portals().len() as f64) as u32));
    }
    let budget = [StepBudget::steps(0), StepBudget::steps(40), StepBudget::FRAME, StepBudget::UNLIMITED][k / 5 % 4];
    Ask { view: view.unwrap(), method: Method::ALL[4 - k % 5], budget, doors }
}

fn tables() -> [Arc<Table>; 3] {
    let plan = office(OfficeOptions { rooms_x: 4, rooms_y: 2, furniture: true, ..OfficeOptions::default() }).unwrap();
    let scene = TowerOptions { floors: 1, rooms_x: 2, rooms_y: 1, furniture: 2, ..TowerOptions::default() };
    let plan = bake_plan(&plan, &PlanBakeOptions::default()).unwrap().table;
    let scene = bake(&tower(scene).unwrap(), &BakeRequest::default()).unwrap().table;
    [Arc::new(plan), Arc::new(scene), hall_of_mirrors()]
}

#[test]
fn viewers_answer_as_the_methods_do() {
    let (mut state, [mut n_outside, mut n_borders, mut n_coarser, mut n_images]) = (1, [0; 4]);
    // Impostors: only one of the cells of a border is asked; doors are not heeded; outside nothing is seen.
    let [mut one_cell, mut no_doors, mut nothing] = [0; 3];
    for table in tables() {
        let cells = Arc::new(TableCells::new(Arc::clone(&table)));
        let mut viewer = Viewer::of(Arc::clone(&cells));
        for k in 0..320 {
            viewer.set_memory([64 << 20, 1][k / 50 % 2]);
            let ask = ask(&table, k, &mut state);
            let at = table.place_at(ask.view.eye()).cells().to_vec();
            let expected = by_cell(&cells, &at, &ask);
            assert_eq!(by_viewer(&mut viewer, &ask), expected, "look {k}, in {at:?}");
            n_outside += usize::from(at.is_empty());
            n_borders += usize::from(at.len() > 1);
            n_coarser += usize::from(expected.2.is_some_and(|by| by < ask.method));
            n_images += expected.3.len();
            one_cell += usize::from(by_cell(&cells, &at[..at.len().min(1)], &ask) != expected);
            nothing += usize::from(at.is_empty() && !expected.0.is_empty());
            no_doors += usize::from(by_cell(&cells, &at, &Ask { doors: Doors::all_open(), ..ask }) != expected);
        }
    }
    let n = [n_outside, n_borders, n_coarser, n_images, one_cell, no_doors, nothing];
    assert!(n.iter().all(|&n| n >= 20), "{n:?}");
}

#[test]
fn viewers_see_nothing_before_they_look() {
    let [plan, ..] = tables();
    let mut viewer = Viewer::new(plan);
    assert!(viewer.follow_reflections(3).is_empty() && viewer.portals().is_empty() && viewer.seen().cells().is_empty());
    assert_eq!(viewer.kept(), (0, 0));
    assert!(!viewer.close_door(DoorId(0)) && *viewer.doors() == Doors::all_open(), "the plan has no doors with names");
}

#[cfg(feature = "packed")]
mod packed {
    use super::*;
    use sightlines_packed::{ByteSource, PackOptions, Packed, pack};
    use sightlines_walkthrough::PackedCells;
    use std::io;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// A file that can be read until its medium is gone.
    struct Medium(Vec<u8>, Arc<AtomicBool>);

    impl ByteSource for Medium {
        fn len(&self) -> io::Result<u64> {
            ByteSource::len(&self.0)
        }

        fn read_at(&self, offset: u64, buf: &mut [u8]) -> io::Result<()> {
            match self.1.load(Ordering::Relaxed) {
                true => Err(io::ErrorKind::NotFound.into()),
                false => self.0.read_at(offset, buf),
            }
        }
    }

    #[test]
    fn what_cannot_be_read_counts_as_seen() {
        let [table, ..] = tables();
        let (gone, mut state) = (Arc::new(AtomicBool::new(false)), 1);
        let medium = Medium(pack(&table, &PackOptions::default()).unwrap(), Arc::clone(&gone));
        let mut viewer = Viewer::of(PackedCells::new(Packed::open(medium, 0).unwrap()));
        let mut plain = Viewer::new(Arc::clone(&table));
        let mut n = [0; 2];
        for k in (0..100).filter(|k| k % 8 != 1) {
            let view = ask(&table, k, &mut state).view;
            gone.store(k % 2 == 0, Ordering::Relaxed);
            viewer.set_memory(0);
            match viewer.try_look(&view) {
                Ok(look) => {
                    let (same, n_seen) = (plain.look(&view), look.seen.cells().len());
                    assert_eq!((look.seen.cells(), look.method), (same.seen.cells(), same.method));
                    n[0] += usize::from(n_seen < table.n_cells());
                }
                Err(_) => {
                    assert_eq!(viewer.seen().cells().len(), table.n_cells());
                    assert_eq!(viewer.seen().objects().len(), table.objects().len());
                    n[1] += 1;
                }
            }
        }
        assert!(n.iter().all(|&n| n > 20), "{n:?}");
    }
}

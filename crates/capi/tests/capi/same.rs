//! What C gets is what Rust answers.

use crate::common::{Handle, Random, cell_ids, list, object_ids, plans, text, towers};
use sightlines_bake::{BakeRequest, PlanBakeOptions, bake, bake_plan};
use sightlines_capi::*;
use sightlines_eye_to_cell::{
    Doors, Method, Scratch, TableCells, View, VisibleSet, VisibleSubgraph, follow_reflections,
};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, DoorRecord, ObjectId, Place, PlaceBuffer, PortalId, Table, TriangleRange};
use sightlines_relevance::{Body, Player, PlayerRole, ReachOptions, Reaches, Relevance, RelevanceOptions};
use std::collections::BTreeSet;
use std::ffi::CString;
use std::ops::Range;
use std::ptr;
use std::sync::Arc;

/// Compares everything that the border tells of cells, objects and portals; the number of answers that were compared and of those that
/// differ.
pub(crate) fn compare_content(table: &Table, c: &Handle) -> [usize; 2] {
    let (mut n, mut n_wrong) = (0, 0);
    let mut same = |is_same: bool| {
        n += 1;
        n_wrong += usize::from(!is_same);
    };
    let c = c.0;
    // SAFETY: the handle lives; results go to places and buffers of the stated sizes.
    unsafe {
        let mut info = std::mem::zeroed::<SlTableInfo>();
        info.struct_size = size_of::<SlTableInfo>();
        assert_eq!(sl_table_get_info(c, &mut info), SL_OK);
        same(info.cell_count as usize == table.n_cells() && info.dimension == u32::from(table.dimension()));
        same(
            info.object_count as usize == table.objects().len() && info.portal_count as usize == table.portals().len(),
        );
        same(info.door_count as usize == table.doors().len());
        same(
            table.digest().is_none_or(|d| d.hiding.to_le_bytes() == info.digest_hiding)
                && info.has_digest == u32::from(table.digest().is_some()),
        );
        same(info.has_frame == u32::from(table.frame().is_some()));
        same(table.frame().is_none_or(|f| f.axes().as_flattened() == info.frame_axes && f.gap() == info.frame_gap));
        for (id, record) in (0u32..).zip(table.cells()) {
            let cell = CellId(id);
            let mut out = std::mem::zeroed::<SlCell>();
            assert_eq!(sl_table_cell(c, id, &mut out), SL_OK);
            same(
                (out.bounds.min, out.bounds.max, out.group)
                    == (record.min, record.max, record.group.unwrap_or(SL_NONE)),
            );
            same(list(|to, size, n| sl_table_cell_corners(c, id, to, size, n)) == record.polygon.as_flattened());
            same(
                text(|to, size, n| sl_table_cell_name(c, id, to.cast(), size, n))
                    == table.cell_name(cell).unwrap_or(""),
            );
            same(list(|to, size, n| sl_table_visible_cells(c, id, to, size, n)) == cell_ids(table.visible(cell)));
            same(
                list(|to, size, n| sl_table_objects_in_cell(c, id, to, size, n))
                    == object_ids(table.objects_of(cell).iter().copied()),
            );
            let objects = object_ids(table.visible_objects(cell));
            same(list(|to, size, n| sl_table_visible_objects(c, id, to, size, n)) == objects);
            same(list(|to, size, n| sl_table_visible_ranges(c, id, to, size, n)) == ranges(table.visible_ranges(cell)));
            let bits = list(|to, size, n| sl_table_visible_object_bits(c, id, to, size, n));
            let is_set = |o: &u32| bits[*o as usize / 64] >> (o % 64) & 1 == 1;
            same((0..info.object_count).filter(is_set).collect::<Vec<_>>() == objects);
            let (mut words, mut n_words) = (ptr::null(), 0);
            assert_eq!(sl_table_row(c, id, &mut words, &mut n_words), SL_OK);
            same(std::slice::from_raw_parts(words, n_words) == table.row(cell));
            for other in 0..info.cell_count {
                let mut sees = 7;
                assert_eq!(sl_table_sees(c, id, other, &mut sees), SL_OK);
                same(sees == u32::from(table.sees(cell, CellId(other))));
            }
        }
        for (id, record) in (0u32..).zip(table.objects()) {
            let mut out = std::mem::zeroed::<SlObject>();
            assert_eq!(sl_table_object(c, id, &mut out), SL_OK);
            same(
                (out.bounds.min, out.bounds.max) == (record.min, record.max)
                    && out.polygon_count == table.polygons_of(ObjectId(id)),
            );
            let name = text(|to, size, n| sl_table_object_name(c, id, to.cast(), size, n));
            same(name == record.name);
            let mut first = SL_NONE;
            let name = CString::new(name).expect("names here have no zeros");
            assert_eq!(sl_table_find_object(c, name.as_ptr(), &mut first), SL_OK);
            same(table.objects()[first as usize].name == record.name && first <= id);
            let mut source = std::mem::zeroed::<SlSource>();
            assert_eq!(sl_table_object_source(c, id, &mut source), SL_OK);
            let found = table.source_of(ObjectId(id)).map_or((SL_NONE, SL_NONE), |s| (s.node, s.primitive));
            same((source.node, source.primitive) == found);
        }
        for (id, record) in (0u32..).zip(table.portals()) {
            let mut out = std::mem::zeroed::<SlPortal>();
            assert_eq!(sl_table_portal(c, id, &mut out), SL_OK);
            same(out.cells == record.cells.map(|cell| cell.0) && out.corner_count as usize == record.points.len());
            same(list(|to, size, n| sl_table_portal_corners(c, id, to, size, n)) == record.points.as_flattened());
        }
        for (id, record) in (0u32..).zip(table.doors()) {
            let mut out = std::mem::zeroed::<SlDoor>();
            assert_eq!(sl_table_door(c, id, &mut out), SL_OK);
            same(out.object == record.object.map_or(SL_NONE, |object| object.0));
            let portals = list(|to, size, n| sl_table_door_portals(c, id, to, size, n));
            same(portals == record.portals.iter().map(|p| p.0).collect::<Vec<_>>());
            same(text(|to, size, n| sl_table_door_name(c, id, to.cast(), size, n)) == record.name);
            let name = CString::new(record.name.as_str()).expect("names here have no zeros");
            let named = list(|to, size, n| sl_table_find_doors(c, name.as_ptr(), to, size, n));
            same(named == table.door(&record.name).map(|door| door.0).collect::<Vec<_>>() && named.contains(&id));
        }
    }
    [n, n_wrong]
}

fn ranges(of: Vec<TriangleRange>) -> Vec<SlRange> {
    let range = |(object, range): TriangleRange| match range {
        Some(Range { start, end }) => SlRange { object: object.0, start, end },
        None => SlRange { object: object.0, start: 0, end: SL_NONE },
    };
    of.into_iter().map(range).collect()
}

/// Compares answers for random points and boxes in and around a table.
fn compare_points(table: &Table, c: &Handle, random: &mut Random, n_points: usize) -> [usize; 2] {
    let (mut n_inside, mut n_wrong) = (0, 0);
    let bounds = bounds_of(table);
    for _ in 0..n_points {
        let p: [f64; 3] = std::array::from_fn(|k| random.between(bounds.0[k] - 0.5, bounds.1[k] + 0.5));
        let q = p.map(|x| x + random.share());
        let (all_cells, all_objects) = (0..table.n_cells() as u32, 0..table.objects().len() as u32);
        let whole = |object: u32| (ObjectId(object), None);
        let found = table.place_at(p).inside().map(|here| here.visible_ranges());
        let found = ranges(found.unwrap_or_else(|| all_objects.clone().map(whole).collect()));
        let (at, cells, objects, outside) = match table.place_at(p) {
            Place::Outside => (vec![], all_cells.collect(), all_objects.collect(), 1),
            Place::Inside(here) => {
                let at = cell_ids(here.cells().iter().copied());
                (at, cell_ids(here.visible_cells()), object_ids(here.visible_objects()), 0)
            }
        };
        let mut touching = Vec::new();
        let flat = |x: [f64; 3]| if table.dimension() == 2 { [x[0], x[1], 0.0] } else { x };
        table.for_each_touching(flat(p), flat(q), &mut Vec::new(), |cell| {
            touching.push(cell.0);
            true
        });
        touching.sort_unstable();
        touching.dedup();
        let within = table.portals_within(p, q).into_iter().map(|portal| portal.0).collect::<Vec<_>>();
        n_inside += usize::from(outside == 0);
        let (mut is_outside, bounds) = (7, SlBox { min: p, max: q });
        let c = c.0;
        // SAFETY: the handle lives; results go to places and buffers of the stated sizes.
        let is_same = unsafe {
            list(|to, size, n| sl_table_cells_at(c, p.as_ptr(), to, size, n)) == at
                && list(|to, size, n| sl_table_visible_cells_at(c, p.as_ptr(), to, size, n, ptr::null_mut())) == cells
                && list(|to, size, n| sl_table_visible_objects_at(c, p.as_ptr(), to, size, n, ptr::null_mut()))
                    == objects
                && list(|to, size, n| sl_table_visible_ranges_at(c, p.as_ptr(), to, size, n, ptr::null_mut())) == found
                && list(|to, size, n| sl_table_cells_touching(c, &bounds, to, size, n)) == touching
                && list(|to, size, n| sl_table_portals_within(c, &bounds, to, size, n)) == within
                && sl_table_cells_at(c, p.as_ptr(), ptr::null_mut(), 0, &mut 0) == SL_OK
                && sl_table_visible_cells_at(c, p.as_ptr(), ptr::null_mut(), 0, &mut 0, &mut is_outside) == SL_OK
                && is_outside == outside
        };
        n_wrong += usize::from(!is_same);
    }
    [n_inside, n_wrong]
}

/// The box around all cells, in the axes of the scene.
fn bounds_of(table: &Table) -> ([f64; 3], [f64; 3]) {
    let boxes = table.cells().iter().map(|cell| (cell.min, cell.max));
    let union = |a: ([f64; 3], [f64; 3]), b: ([f64; 3], [f64; 3])| {
        (std::array::from_fn(|k| a.0[k].min(b.0[k])), std::array::from_fn(|k| a.1[k].max(b.1[k])))
    };
    let (min, max) = boxes.reduce(union).expect("a table has cells");
    table.frame().map_or((min, max), |frame| frame.around_in_scene(min, max))
}

fn nothing_seen(kind: u32, eye: [f64; 3], direction: [f64; 3]) -> SlView {
    SlView { kind, eye, direction, up: [0.1, 1.0, 0.2], field_of_view: 1.1, aspect: 1.5, matrix: [0.0; 16] }
}

/// Compares looks by every method, with and without closed portals; the number of looks from inside, and of those that differ.
fn compare_looks(table: &Table, c: &Handle, random: &mut Random, n_looks: usize) -> [usize; 2] {
    let cells = TableCells::new(Arc::new(table.clone()));
    let bounds = bounds_of(table);
    let (mut n_inside, mut n_wrong) = (0, 0);
    let (mut n_listed, mut n_joining) = (0, 0);
    let with_portals: BTreeSet<CellId> = table.portals().iter().flat_map(|portal| portal.cells).collect();
    let has_apart_cells = with_portals.len() < table.n_cells();
    let mut viewer = ptr::null_mut();
    // SAFETY: the handle lives.
    assert_eq!(unsafe { sl_viewer_new(c.0, &mut viewer) }, SL_OK);
    let (mut scratch, mut seen, mut buffer) = (Scratch::new(), VisibleSet::new(), PlaceBuffer::new());
    for look in 0..n_looks {
        let eye: [f64; 3] = std::array::from_fn(|k| random.between(bounds.0[k], bounds.1[k]));
        let direction = [random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        let planar = table.dimension() == 2;
        let (view, given) = if look % 5 == 4 {
            let eye = if planar { [eye[0], eye[1], 0.0] } else { eye };
            (View::all_round(eye), nothing_seen(SL_VIEW_ALL_ROUND, eye, direction))
        } else if planar {
            let flat = |p: [f64; 3]| [p[0], p[1]];
            (View::planar(flat(eye), flat(direction), 1.1), nothing_seen(SL_VIEW_PLANAR, eye, direction))
        } else {
            let given = nothing_seen(SL_VIEW_PERSPECTIVE, eye, direction);
            (View::perspective_vertical(eye, direction, given.up, 1.1, 1.5), given)
        };
        let view = view.expect("a view");
        let method = Method::ALL[look % 5];
        let mut doors = Doors::all_open();
        // SAFETY: the viewer lives; results go to places and buffers of the stated sizes.
        unsafe {
            assert_eq!(sl_viewer_open_all(viewer), SL_OK);
            for _ in 0..if table.portals().is_empty() { 0 } else { look % 3 } {
                let portal = (random.next() % table.portals().len() as u64) as u32;
                doors.close(PortalId(portal));
                assert_eq!(sl_viewer_close_portal(viewer, portal), SL_OK);
            }
            assert_eq!(sl_viewer_set_method(viewer, (look % 5) as u32, SL_STEPS_UNLIMITED), SL_OK);
            let mut answer = std::mem::zeroed::<SlAnswer>();
            assert_eq!(sl_viewer_look(viewer, &given, &mut answer), SL_OK);
            seen.clear(table.n_cells(), table.objects().len());
            let mut answered = None;
            if let Place::Inside(here) = table.cells_at(eye, &mut buffer) {
                for &cell in here {
                    let Ok(subgraph) = VisibleSubgraph::prepare(&cells, cell);
                    let by = method.look(&subgraph, &view, &doors, &mut scratch, &mut seen);
                    answered = Some(answered.map_or(by, |before: Method| before.min(by)));
                }
            }
            seen.sort();
            let outside = answered.is_none();
            n_inside += usize::from(!outside);
            let number = answered.map_or(SL_NONE, |by| Method::ALL.iter().position(|m| *m == by).expect("one") as u32);
            let found = list(|to, size, n| sl_viewer_cells(viewer, to, size, n));
            let objects = list(|to, size, n| sl_viewer_objects(viewer, to, size, n));
            let is_same = if outside {
                found.len() == table.n_cells() && objects.len() == table.objects().len()
            } else {
                found == cell_ids(seen.cells().iter().copied()) && objects == object_ids(seen.objects().iter().copied())
            };
            let portals = list(|to, size, n| sl_viewer_portals(viewer, to, size, n));
            let joins = |&p: &u32| table.portals()[p as usize].cells.iter().all(|cell| found.contains(&cell.0));
            let are_open = portals.iter().all(|&p| outside || doors.is_open(PortalId(p)) && joins(&p));
            let at = table.place_at(eye);
            let reached = reached_through(table, at.cells(), &portals);
            // What the exact method finds is on a line through open portals in view, and each of them is listed.
            let follows =
                method < Method::Exact || has_apart_cells || outside || found.iter().all(|c| reached.contains(c));
            n_listed += portals.len();
            n_joining += (0..table.portals().len() as u32).filter(|p| outside || joins(p)).count();
            let closed = list(|to, size, n| sl_viewer_closed_portals(viewer, to, size, n));
            let is_known = closed == doors.closed().map(|p| p.0).collect::<Vec<_>>();
            let images_differ = !outside && images_differ(viewer, method, &seen, &doors, &cells);
            let same_answer = answer.method == number && answer.is_outside == u32::from(outside);
            n_wrong += usize::from(!(is_same && are_open && follows && is_known && same_answer) || images_differ);
        }
    }
    // SAFETY: it is owned.
    unsafe { sl_viewer_free(viewer) };
    assert!(n_listed < n_joining || n_joining < 40, "portals out of view are not listed: {n_listed} of {n_joining}");
    [n_inside, n_wrong]
}

/// The cells that are reached from some by way of these portals.
fn reached_through(table: &Table, from: &[CellId], portals: &[u32]) -> BTreeSet<u32> {
    let mut reached: BTreeSet<u32> = from.iter().map(|cell| cell.0).collect();
    loop {
        let before = reached.len();
        for record in portals.iter().map(|&p| &table.portals()[p as usize]) {
            let [a, b] = record.cells.map(|cell| cell.0);
            if reached.contains(&a) || reached.contains(&b) {
                reached.extend([a, b]);
            }
        }
        if reached.len() == before {
            return reached;
        }
    }
}

/// Whether what is seen in mirrors differs.
///
/// # Safety
/// The viewer lives.
unsafe fn images_differ(
    viewer: *mut SlViewer,
    method: Method,
    seen: &VisibleSet,
    doors: &Doors,
    cells: &TableCells<Arc<Table>>,
) -> bool {
    let table = cells.table();
    let sizes = [table.n_cells(), table.objects().len()];
    let subgraph = |cell| VisibleSubgraph::prepare(cells, cell).ok();
    let images = follow_reflections(method, seen, 2, doors, &mut Scratch::new(), sizes, subgraph);
    let mut n = 0;
    // SAFETY: the viewer lives; results go to places and buffers of the stated sizes.
    unsafe {
        assert_eq!(sl_viewer_follow_mirrors(viewer, 2, &mut n), SL_OK);
        let differs = |(id, image): (u32, &sightlines_eye_to_cell::MirrorImage)| {
            let mut out = std::mem::zeroed::<SlImage>();
            assert_eq!(sl_viewer_image(viewer, id, &mut out), SL_OK);
            let mirrors: Vec<u32> = image.mirrors.iter().map(|mirror| mirror.0).collect();
            out.is_complete != u32::from(image.complete)
                || list(|to, size, n| sl_viewer_image_mirrors(viewer, id, to, size, n)) != mirrors
                || list(|to, size, n| sl_viewer_image_cells(viewer, id, to, size, n)) != cell_ids(image.cells.clone())
                || list(|to, size, n| sl_viewer_image_objects(viewer, id, to, size, n))
                    != object_ids(image.objects.clone())
        };
        n as usize != images.len() || (0u32..).zip(&images).any(differs)
    }
}

/// Tables of plans, scenes and files of all versions.
fn tables() -> Vec<Table> {
    let plans = plans().into_iter().map(|plan| bake_plan(&plan, &PlanBakeOptions::default()).expect("a plan").table);
    let scenes = towers().into_iter().map(|scene| bake(&scene, &BakeRequest::default()).expect("a scene").table);
    let golden = concat!(env!("CARGO_MANIFEST_DIR"), "/../pvs/tests/golden");
    let mut files: Vec<_> =
        std::fs::read_dir(golden).expect("old files").map(|entry| entry.expect("an entry").path()).collect();
    files.sort();
    let old = files.iter().filter(|path| path.extension().is_some_and(|e| e == "pvs")).map(|path| {
        let bytes = std::fs::read(path).expect("a file");
        Table::from_bytes(&bytes).expect("a table")
    });
    let tables: Vec<Table> = plans.chain(scenes).chain(old).collect();
    assert!(tables.len() >= 10, "{}", tables.len());
    tables
}

#[test]
fn tables_answer_as_in_rust() {
    let mut random = Random(1);
    let [mut n, mut n_inside, mut n_looks] = [0; 3];
    for table in tables() {
        let c = Handle::of(&table.to_bytes());
        let [content, wrong] = compare_content(&table, &c);
        assert_eq!(wrong, 0, "{} cells", table.n_cells());
        n += content;
        if table.has_places() && table.n_cells() > 0 {
            let [inside, wrong] = compare_points(&table, &c, &mut random, 300);
            assert_eq!(wrong, 0);
            n_inside += inside;
            let [inside, wrong] = compare_looks(&table, &c, &mut random, 60);
            assert_eq!(wrong, 0);
            n_looks += inside;
        }
    }
    assert!(n > 10_000 && n_inside > 1000 && n_looks > 200, "{n} answers, {n_inside} points, {n_looks} looks");
}

/// A table that hides one pair more is told from the one that does not.
#[test]
fn impostor_a_table_with_a_pair_removed_differs() {
    let mut n = 0;
    for table in tables().into_iter().filter(|table| table.mean_visible_share() > 0.0) {
        let pair = (0..table.n_cells()).find_map(|a| {
            let other = table.visible(CellId(a as u32)).find(|b| b.idx() != a)?;
            Some((a, other.idx()))
        });
        let Some((a, b)) = pair else { continue };
        let mut parts = table.clone().into_parts();
        parts.rows.set(a, b, false);
        parts.rows.set(b, a, false);
        parts.stab = None;
        let Ok(less) = Table::new(parts) else { continue };
        assert!(compare_content(&table, &Handle::of(&less.to_bytes()))[1] >= 6);
        n += 1;
    }
    assert!(n >= 5, "{n}");
}

/// By a matrix in either layout one sees what one sees in Rust; the wrong layout is refused.
#[test]
fn matrices_are_those_of_rust() {
    let table = bake(&towers()[1], &BakeRequest::default()).expect("a scene").table;
    let (cells, c) = (TableCells::new(Arc::new(table.clone())), Handle::of(&table.to_bytes()));
    let (mut random, bounds) = (Random(5), bounds_of(&table));
    let (mut viewer, mut n, mut n_objects) = (ptr::null_mut(), 0, BTreeSet::new());
    // SAFETY: the handle lives.
    assert_eq!(unsafe { sl_viewer_new(c.0, &mut viewer) }, SL_OK);
    // SAFETY: the viewer lives.
    assert_eq!(unsafe { sl_viewer_set_method(viewer, SL_METHOD_EXACT, SL_STEPS_UNLIMITED) }, SL_OK);
    for _ in 0..60 {
        let eye: [f64; 3] = std::array::from_fn(|k| random.between(bounds.0[k], bounds.1[k]));
        let Place::Inside(here) = table.place_at(eye) else { continue };
        // A camera turned about y, with a lens of reversed infinite depth, as rows.
        let (sin, cos) = random.between(0.0, std::f64::consts::TAU).sin_cos();
        let (right, ahead, f) = ([cos, 0.0, -sin], [sin, 0.0, cos], 1.3);
        let along = |v: [f64; 3], scale: f64| {
            let at: f64 = (0..3).map(|k| v[k] * eye[k]).sum();
            [v[0] * scale, v[1] * scale, v[2] * scale, -at * scale]
        };
        let rows = [along(right, f / 1.5), along([0.0, 1.0, 0.0], f), [0.0, 0.0, 0.0, 0.1], along(ahead, 1.0)];
        let columns: [[f64; 4]; 4] = std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
        let view = View::from_view_projection(eye, columns).expect("a perspective");
        let mut seen = VisibleSet::new();
        seen.clear(table.n_cells(), table.objects().len());
        for &cell in here.cells() {
            let Ok(subgraph) = VisibleSubgraph::prepare(&cells, cell);
            Method::Exact.look(&subgraph, &view, &Doors::all_open(), &mut Scratch::new(), &mut seen);
        }
        seen.sort();
        let expected = object_ids(seen.objects().iter().copied());
        let flat = |m: [[f64; 4]; 4]| std::array::from_fn(|i| m[i / 4][i % 4]);
        let given = |kind, matrix| SlView { matrix, ..nothing_seen(kind, eye, [0.0; 3]) };
        for view in [given(SL_VIEW_MATRIX, flat(columns)), given(SL_VIEW_MATRIX_TRANSPOSED, flat(rows))] {
            // SAFETY: the viewer lives.
            assert_eq!(unsafe { sl_viewer_look(viewer, &view, ptr::null_mut()) }, SL_OK);
            // SAFETY: the viewer lives; results go to buffers of the stated sizes.
            assert_eq!(list(|to, size, n| unsafe { sl_viewer_objects(viewer, to, size, n) }), expected);
        }
        let wrong = given(SL_VIEW_MATRIX, flat(rows));
        // SAFETY: the viewer lives.
        assert_eq!(unsafe { sl_viewer_look(viewer, &wrong, ptr::null_mut()) }, SL_ERROR_VIEW);
        n_objects.insert(expected.len());
        n += 1;
    }
    // SAFETY: it is owned.
    unsafe { sl_viewer_free(viewer) };
    assert!(n > 20 && n_objects.len() > 5, "{n} views, {n_objects:?}");
}

/// A portal that two doors close is closed until both stand open, and until it is opened itself if it was closed alone.
#[test]
fn doors_that_share_a_portal_are_shut_each_on_its_own() {
    let table = bake(&towers()[0], &BakeRequest::default()).expect("a scene").table;
    let door = |name: &str, portals: &[u32]| DoorRecord {
        name: name.to_owned(),
        object: None,
        portals: portals.iter().map(|&portal| PortalId(portal)).collect(),
    };
    let table = table.with_doors(vec![door("a", &[0, 1]), door("b", &[1, 2])]).expect("doors");
    let handle = Handle::of(&table.to_bytes());
    let mut viewer = ptr::null_mut();
    // SAFETY: handles live until they are freed; all pointers are to live memory.
    unsafe {
        assert_eq!(sl_viewer_new(handle.0, &mut viewer), SL_OK);
        let closed = || list(|to, size, n| sl_viewer_closed_portals(viewer, to, size, n));
        let check = |status: SlStatus, expected: &[u32]| assert_eq!((status, &*closed()), (SL_OK, expected));
        check(sl_viewer_close_door(viewer, 0), &[0, 1]);
        check(sl_viewer_close_door(viewer, 1), &[0, 1, 2]);
        check(sl_viewer_open_door(viewer, 0), &[1, 2]);
        check(sl_viewer_close_portal(viewer, 2), &[1, 2]);
        check(sl_viewer_open_door(viewer, 1), &[2]);
        check(sl_viewer_open_portal(viewer, 2), &[]);
        sl_viewer_free(viewer);
    }
}

/// Bodies that walk at random, told by Rust and by the border; the number of answers that were compared and of those that differ.
fn compare_ticks(table: &Table, c: &Handle, random: &mut Random) -> [usize; 2] {
    let (mut n, mut n_wrong) = (0, 0);
    let bounds = bounds_of(table);
    let options = RelevanceOptions { looks: 3, ..RelevanceOptions::of(table) };
    let mut own = Relevance::new(
        table.clone(),
        Reaches::of(table, &ReachOptions::default()).expect("a table with places"),
        options,
    );
    let mut there = ptr::null_mut();
    // SAFETY: handles live; results go to places and buffers of the stated sizes.
    unsafe {
        let mut given = std::mem::zeroed::<SlRelevanceOptions>();
        given.struct_size = size_of::<SlRelevanceOptions>();
        assert_eq!(sl_relevance_default_options(c.0, &mut given), SL_OK);
        given.looks = 3;
        assert_eq!(sl_relevance_new(c.0, ptr::null(), &given, &mut there), SL_OK);
        let mut places: Vec<[f64; 3]> =
            (0..7).map(|_| std::array::from_fn(|k| random.between(bounds.0[k], bounds.1[k]))).collect();
        for tick in 0..40 {
            places.iter_mut().flatten().for_each(|x| *x += random.between(-0.3, 0.3));
            let of = |(i, p): (usize, &[f64; 3])| SlPlayer {
                eyes: SlBox { min: *p, max: *p },
                seen: SlBox { min: p.map(|x| x - 0.2), max: p.map(|x| x + 0.2) },
                reach: 0.1 * i as f64,
                arm: if i == 3 { 0.5 } else { 0.0 },
                sees_always: if i == 4 { 2 } else { 0 },
                team: u32::from(i == 5),
                flags: if i == 6 { SL_PLAYER_IS_SEEN } else { SL_PLAYER_VIEWS | SL_PLAYER_IS_SEEN },
            };
            let players: Vec<SlPlayer> = places.iter().enumerate().map(of).collect();
            let plain = |p: &SlPlayer| Player {
                body: Body {
                    eyes: Aabb { min: p.eyes.min, max: p.eyes.max },
                    seen: Aabb { min: p.seen.min, max: p.seen.max },
                    reach: p.reach,
                    arm: p.arm,
                },
                role: PlayerRole {
                    team: p.team as u8,
                    sees_always: p.sees_always,
                    views: p.flags & SL_PLAYER_VIEWS != 0,
                    is_seen: p.flags & SL_PLAYER_IS_SEEN != 0,
                },
            };
            let own_players: Vec<Player> = players.iter().map(plain).collect();
            let (now, mut changes) = (0.1 * f64::from(tick), std::mem::zeroed::<SlChanges>());
            assert_eq!(sl_relevance_update(there, now, players.as_ptr(), players.len(), &mut changes), SL_OK);
            let said = own.update(now, &own_players).clone();
            let mut same = |is_same: bool| {
                n += 1;
                n_wrong += usize::from(!is_same);
            };
            same(
                (changes.gained_count, changes.lost_count) == (said.gained.len(), said.lost.len())
                    && (changes.look_count, changes.coarse_count, changes.outside_count)
                        == (said.n_looks, said.n_coarse, said.n_outside),
            );
            same(list(|to, size, n| sl_relevance_gained(there, to, size, n)) == said.gained.as_flattened());
            same(list(|to, size, n| sl_relevance_lost(there, to, size, n)) == said.lost.as_flattened());
            for to in 0..7 {
                let shown = list(|at, size, n| sl_relevance_shown_to(there, to, at, size, n));
                same(shown == own.shown_to(to).collect::<Vec<_>>());
                let (of, mut is_shown) = (random.next() as u32 % 7, 7);
                assert_eq!(sl_relevance_is_shown(there, to, of, &mut is_shown), SL_OK);
                same(is_shown == u32::from(shown.contains(&of)));
                let (a, b, speeds) = (to as usize, of as usize, [random.share(), random.share()]);
                let (mut may, mut seconds) = (7, -1.0);
                assert_eq!(sl_relevance_may_see_within(there, &players[a], &players[b], &mut may), SL_OK);
                same(may == u32::from(own.may_see_within(&own_players[a].body, &own_players[b].body)));
                let (p, q) = (&players[a], &players[b]);
                assert_eq!(sl_relevance_time_to_sight(there, p, q, speeds.as_ptr(), &mut seconds), SL_OK);
                same(seconds == own.time_to_sight(&own_players[a].body, &own_players[b].body, speeds));
            }
        }
        sl_relevance_free(there);
    }
    [n, n_wrong]
}

/// What a server asks is what Rust answers; and a table of another scene is noticed.
#[test]
fn ticks_of_servers_are_the_same() {
    let mut random = Random(5);
    let mut tables: Vec<Table> =
        plans().iter().map(|plan| bake_plan(plan, &PlanBakeOptions::default()).expect("a table").table).collect();
    tables.extend(towers().iter().map(|scene| bake(scene, &BakeRequest::default()).expect("a table").table));
    for (i, table) in tables.iter().enumerate() {
        let c = Handle::of(&table.to_bytes());
        let [n, n_wrong] = compare_ticks(table, &c, &mut random);
        assert!(n > 1000 && n_wrong == 0, "{n_wrong} of {n} differ");
        let other = Handle::of(&tables[(i + 1) % tables.len()].to_bytes());
        let [n, n_wrong] = compare_ticks(table, &other, &mut random);
        assert!(n_wrong > 20, "{n_wrong} of {n}: another table goes unnoticed");
    }
}

#[test]
fn reaches_come_from_files() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = bake_plan(&plans()[0], &PlanBakeOptions::default()).expect("a table").table;
    let c = Handle::of(&table.to_bytes());
    let reaches = Reaches::of(&table, &ReachOptions::default()).expect("a table with places").to_bytes();
    let mut made = ptr::null_mut();
    let mut new = |name: &str, bytes: Option<&[u8]>| {
        let path = folder.path().join(name);
        if let Some(bytes) = bytes {
            std::fs::write(&path, bytes).expect("a file is written");
        }
        let path = CString::new(path.to_str().expect("UTF-8")).expect("no zeros");
        // SAFETY: the handle lives, a text and a place of this function; what is made is freed.
        unsafe {
            let status = sl_relevance_new(c.0, path.as_ptr(), ptr::null(), &mut made);
            assert_eq!(status == SL_OK, !made.is_null());
            sl_relevance_free(made);
            status
        }
    };
    assert_eq!(new("a.rel", Some(&reaches)), SL_OK);
    assert_eq!(new("none.rel", None), SL_ERROR_FILE);
    assert_eq!(new("short.rel", Some(&reaches[..reaches.len() - 1])), SL_ERROR_FORMAT);
}

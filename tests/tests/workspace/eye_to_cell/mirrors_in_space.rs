//! Mirrors on boxes and on the walls of a room, against a ray that is reflected.

use crate::eye_to_cell::ask::{Asker, Shown, missed_in_mirrors, word_of};
use crate::eye_to_cell::boxes::{Room, SIDE, place};
use crate::eye_to_cell::picture::{Picture, along, box_around, minus};
use crate::eye_to_cell::plans::some_doors;
use sightlines::eye_to_cell::{Doors, Method, View};
use sightlines::geometry::{Aabb, Point3};
use sightlines::pvs::{CellId, MirrorId, MirrorRecord, Table};
use sightlines_testkit::Random;
use sightlines_testkit::{directions_among_boxes, first_box, range_in_box};

/// A rectangle that reflects what comes towards it along its axis.
struct Mirror {
    face: u32,
    rectangle: Aabb<3>,
    axis: usize,
    /// Whether rays that grow along the axis meet it.
    upwards: bool,
}

/// The corners counter-clockwise as seen by who looks along the axis.
fn corners(b: &Aabb<3>, axis: usize, upwards: bool) -> Vec<Point3> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let corner = |high_u: bool, high_v: bool| {
        let mut p = b.min;
        p[u] = if high_u { b.max[u] } else { b.min[u] };
        p[v] = if high_v { b.max[v] } else { b.min[v] };
        p
    };
    let mut points = vec![corner(false, false), corner(false, true), corner(true, true), corner(true, false)];
    if !upwards {
        points.reverse();
    }
    points
}

/// Puts `n` mirrors on sides of cells that are wholly covered by a side of a box or of the room.
fn with_mirrors(room: &Room, table: &Table, n: usize, random: &mut Random) -> (Table, Vec<Mirror>) {
    let mut sides = Vec::new();
    for (cell, b) in (0..).zip(room.cells()) {
        for (axis, upwards) in (0..6).map(|k| (k / 2, k % 2 == 1)) {
            let at = if upwards { b.max[axis] } else { b.min[axis] };
            let mut side = b;
            (side.min[axis], side.max[axis]) = (at, at);
            let covers = |solid: &Aabb<3>| {
                let front = if upwards { solid.min[axis] } else { solid.max[axis] };
                let within = |k: usize| k == axis || (solid.min[k] <= side.min[k] && side.max[k] <= solid.max[k]);
                front == at && (0..3).all(within)
            };
            if at == if upwards { SIDE as f64 } else { 0.0 } || room.solids.iter().any(covers) {
                sides.push((cell, side, axis, upwards));
            }
        }
    }
    let (mut mirrors, mut records) = (Vec::new(), Vec::new());
    for face in 0..n as u32 {
        let (cell, rectangle, axis, upwards) = sides.swap_remove(random.below(sides.len()));
        records.push(MirrorRecord {
            cell: CellId(cell),
            mirror: MirrorId(face),
            points: corners(&rectangle, axis, upwards),
        });
        mirrors.push(Mirror { face, rectangle, axis, upwards });
    }
    let mut parts = table.clone().into_parts();
    parts.mirrors = records;
    (Table::new(parts).expect("mirrors on sides of cells"), mirrors)
}

/// Follows a ray through three mirrors at most, and adds the cells that it passes behind each row of mirrors.
fn trace(hindrances: &[Aabb<3>], cells: &[Aabb<3>], mirrors: &[Mirror], eye: Point3, d: Point3, reached: &mut Shown) {
    let (mut at, mut d) = (eye, d);
    let mut word = Vec::new();
    let room = Aabb { min: [0.0; 3], max: [SIDE as f64; 3] };
    loop {
        let out = range_in_box(&room, at, d).map_or(0.0, |range| range[1]);
        let end = first_box(hindrances, at, d).map_or(out, |hit| hit.t.min(out));
        let passed = |b: &Aabb<3>| range_in_box(b, at, d).is_some_and(|[from, to]| from.max(0.0) + 1e-9 < to.min(end));
        let passed = (0..).zip(cells).filter(|(_, b)| passed(b)).map(|(id, _)| id);
        reached.entry(word.clone()).or_default().extend(passed);
        let q = along(at, d, end);
        let meets = |m: &&Mirror| {
            let k = m.axis;
            let inside = |j: usize| m.rectangle.min[j] <= q[j] && q[j] <= m.rectangle.max[j];
            d[k] != 0.0
                && (d[k] > 0.0) == m.upwards
                && (q[k] - m.rectangle.min[k]).abs() < 1e-9
                && (0..3).all(|j| j == k || inside(j))
        };
        // An eye in a mirror is on neither side of it.
        let Some(mirror) = mirrors.iter().find(meets).filter(|_| end > 1e-9 && word.len() < 3) else { return };
        word.push(mirror.face);
        at = q;
        at[mirror.axis] = mirror.rectangle.min[mirror.axis];
        d[mirror.axis] = -d[mirror.axis];
    }
}

/// Where a mirror has the image of a box.
fn image(mirror: &Mirror, b: Aabb<3>) -> Aabb<3> {
    let (k, at) = (mirror.axis, mirror.rectangle.min[mirror.axis]);
    let mut image = b;
    (image.min[k], image.max[k]) = (2.0 * at - b.max[k], 2.0 * at - b.min[k]);
    image
}

/// Directions from the eye that tell all that is seen by way of some mirrors: as one looks from behind the last
/// one, with what is before it as the mirrors show it.
fn directions(hindrances: &[Aabb<3>], cells: &[Aabb<3>], mirrors: &[Mirror], eye: Point3, word: &[u32]) -> Vec<Point3> {
    let word: Vec<&Mirror> = word.iter().filter_map(|face| mirrors.iter().find(|m| m.face == *face)).collect();
    let Some(last) = word.last() else { return Vec::new() };
    let mut edges = cells.to_vec();
    let mut leg: Vec<Aabb<3>> = hindrances.iter().copied().chain(mirrors.iter().map(|m| m.rectangle)).collect();
    edges.extend(&leg);
    let mut behind = Aabb { min: eye, max: eye };
    word.iter().for_each(|mirror| behind = image(mirror, behind));
    for mirror in word.iter().rev() {
        leg.iter_mut().for_each(|b| *b = image(mirror, *b));
        edges.extend(&leg);
    }
    let towards = directions_among_boxes(&edges, behind.min).into_iter();
    let framed = towards.filter(|d| range_in_box(&last.rectangle, behind.min, *d).is_some_and(|[from, _]| from > 0.0));
    framed
        .map(|mut d| {
            word.iter().for_each(|mirror| d[mirror.axis] = -d[mirror.axis]);
            d
        })
        .collect()
}

#[derive(Debug, Default)]
struct Counts {
    n_frames: usize,
    n_reached: [usize; 3],
    n_cells: [usize; 5],
    /// Of the exact one all round: cells in mirrors, and those of them that random rays reach.
    n_exact: usize,
    n_confirmed: usize,
    /// The same from places off the grid, of one mirror or two, and rays in all directions that matter.
    n_known: usize,
    /// Cells that the exact one shows more: a ray through the corner of a mirror may touch a cell with the same corner.
    n_touched: usize,
    n_incomplete: usize,
}

fn check(room: &Room, seed: u64, counts: &mut Counts) {
    let mut random = Random::new(seed, 9);
    let trees = [None, Some(room.with_trees(None)), Some(room.with_trees(Some(8)))];
    for table in trees.iter().map(|table| table.as_ref().unwrap_or(&room.table)) {
        let (table, mirrors) = with_mirrors(room, table, 6, &mut random);
        let mut asker = Asker::new(&table);
        for n_on_grid in [0, 0, 1, 2] {
            let Some(eye) = place(room, n_on_grid, &mut random) else { continue };
            let (doors, closed) = match random.below(3) {
                0 => some_doors(&table, &mut random),
                _ => (Doors::all_open(), Vec::new()),
            };
            let mut hindrances = room.solids.clone();
            hindrances.extend(closed.iter().map(|&p| box_around(&table.portals()[p as usize].points)));
            let cells = room.cells();
            let aim = |random: &mut Random| {
                let mirror = &mirrors[random.below(mirrors.len())];
                minus(random.point(&mirror.rectangle), eye)
            };
            let picture = Picture::random(eye, aim(&mut random), &mut random);
            let all_round = View::all_round(eye).expect("a finite eye");
            for (view, whole) in [(&all_round, true), (&picture.view, false)] {
                let mut reached = Shown::new();
                for ray in 0..3_000 {
                    let aimed = if ray % 2 == 0 { aim(&mut random) } else { random.direction() };
                    let d = if whole || picture.contains(aimed) { aimed } else { picture.direction(&mut random) };
                    // Rays along a plane of the grid show what no open set of lines does.
                    if d.iter().all(|x| *x != 0.0) {
                        trace(&hindrances, &cells, &mirrors, eye, d, &mut reached);
                    }
                }
                for (k, method) in Method::ALL.into_iter().enumerate() {
                    let images = asker.images(table.in_dimension().unwrap().at(eye).cells(), view, &doors, method);
                    let what =
                        || format!("{method}, eye {eye:?}, view {view:?}, {:?}, {:?}", room.solids, table.mirrors());
                    assert_eq!(missed_in_mirrors(&images, &reached), None, "{}", what());
                    counts.n_cells[k] += images.iter().map(|image| image.cells.len()).sum::<usize>();
                    counts.n_incomplete += images.iter().filter(|image| !image.complete).count();
                    if whole && method == Method::Exact {
                        for image in &images {
                            let by_rays = reached.get(&word_of(image));
                            let confirmed = |cell: &&CellId| by_rays.is_some_and(|cells| cells.contains(&cell.0));
                            counts.n_exact += image.cells.len();
                            counts.n_confirmed += image.cells.iter().filter(confirmed).count();
                            if n_on_grid == 0 && image.mirrors.len() < 3 && table.stab().is_none() {
                                let mut known = Shown::new();
                                for d in directions(&hindrances, &cells, &mirrors, eye, &word_of(image)) {
                                    trace(&hindrances, &cells, &mirrors, eye, d, &mut known);
                                }
                                let known: Vec<CellId> =
                                    known.remove(&word_of(image)).into_iter().flatten().map(CellId).collect();
                                let surplus = image.cells.iter().filter(|cell| !known.contains(cell)).count();
                                assert_eq!(image.cells.len() - surplus, known.len(), "{:?}: {}", image.mirrors, what());
                                counts.n_known += known.len();
                                counts.n_touched += surplus;
                            }
                        }
                    }
                }
                for (word, cells) in reached.iter().filter(|(word, _)| !word.is_empty()) {
                    counts.n_reached[word.len() - 1] += cells.len();
                }
                counts.n_frames += 1;
            }
        }
    }
}

/// Invariant: what a ray reaches that mirrors reflect up to three times, following the reflections of any method
/// shows, in the same mirrors; what the exact one shows random rays reach mostly, and rays in all directions that
/// matter wholly.
#[test]
fn mirrors_in_rooms_show_what_rays_reach() {
    let mut counts = Counts::default();
    for seed in 0..6 {
        check(&Room::random(seed, 2 + seed as usize % 3), seed, &mut counts);
    }
    eprintln!("{counts:?}");
    assert!(counts.n_frames > 100 && counts.n_reached.iter().all(|n| *n > 100), "{counts:?}");
    assert!(counts.n_cells.is_sorted_by(|a, b| a >= b) && counts.n_cells[4] < counts.n_cells[0], "{counts:?}");
    assert!(counts.n_confirmed * 10 >= counts.n_exact * 7 && counts.n_known > 100, "{counts:?}");
    assert!(counts.n_touched * 100 < counts.n_known, "{counts:?}");
}

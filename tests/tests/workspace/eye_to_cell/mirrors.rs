//! Mirrors in plans, against a ray that is reflected.

use crate::eye_to_cell::ask::{Asker, Shown, missed_in_mirrors, word_of};
use crate::eye_to_cell::plan_families::{N_PLACES, eye, families, gaze, tables};
use crate::eye_to_cell::plans::some_doors;
use sightlines::cells::Plan;
use sightlines::eye_to_cell::{Doors, Method, View};
use sightlines::geometry::{Point2, orient2d};
use sightlines::pvs::{CellId, MirrorId, MirrorRecord, Table};
use sightlines_testkit::Random;
use std::collections::BTreeSet;
use std::f64::consts::TAU;

/// Rays stay this far from ends of walls and mirrors, in scene units; plans have features of an eighth at least.
const CLEAR: f64 = 1e-7;

/// A piece of a mirror: seen from the left of the way from the first end to the second.
#[derive(Debug, Clone, Copy)]
struct Mirror {
    face: u32,
    ends: [Point2; 2],
}

impl Mirror {
    /// A vector as the mirror shows it.
    fn turned(&self, v: Point2) -> Point2 {
        let along = self.ends[1] - self.ends[0];
        2.0 * v.dot(along) / along.dot(along) * along - v
    }

    /// A point as the mirror shows it.
    fn image(&self, p: Point2) -> Point2 {
        self.ends[0] + self.turned(p - self.ends[0])
    }
}

/// Walls, mirrors and cells.
struct Hall {
    table: Table,
    walls: Vec<[Point2; 2]>,
    mirrors: Vec<Mirror>,
    cells: Vec<Vec<Point2>>,
}

impl Hall {
    /// Puts `n` mirrors on sides of cells that lie on walls, whole sides or their middle halves.
    fn new(plan: &Plan, table: &Table, n: usize, random: &mut Random) -> Option<Self> {
        let cells: Vec<Vec<Point2>> =
            table.cells().iter().map(|c| c.polygon.iter().map(|&[x, y]| Point2::new(x, y)).collect()).collect();
        let walls: Vec<[Point2; 2]> = plan.lines().iter().filter(|l| l.opaque).map(|l| [l.a, l.b]).collect();
        let on = |p: Point2, [a, b]: [Point2; 2]| {
            orient2d(a, b, p) == 0.0 && p.cmpge(a.min(b)).all() && p.cmple(a.max(b)).all()
        };
        let mut sides: Vec<(u32, [Point2; 2])> = Vec::new();
        for (id, corners) in (0..).zip(&cells) {
            let around = (0..corners.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()]]);
            let walled = |side: &[Point2; 2]| walls.iter().any(|&wall| side.iter().all(|&p| on(p, wall)));
            sides.extend(around.filter(walled).map(|side| (id, side)));
        }
        if sides.is_empty() {
            return None;
        }
        let (mut mirrors, mut records) = (Vec::new(), Vec::new());
        for face in 0..n as u32 {
            let (cell, [a, b]) = sides[random.below(sides.len())];
            let by = if random.below(2) == 0 { 0.25 } else { 0.0 };
            let ends = [a + by * (b - a), b - by * (b - a)];
            // Mirrors on each other would both be right.
            let overlaps = |m: &Mirror| ends.iter().any(|&p| on(p, m.ends)) || m.ends.iter().any(|&p| on(p, ends));
            if mirrors.iter().any(overlaps) {
                continue;
            }
            mirrors.push(Mirror { face, ends });
            // The cell is on the left of the side, so who looks out of it has its end at the left hand.
            let points = [ends[1], ends[0]].map(|p| [p.x, p.y, 0.0]).to_vec();
            records.push(MirrorRecord { cell: CellId(cell), mirror: MirrorId(face), points });
        }
        let mut parts = table.clone().into_parts();
        parts.mirrors = records;
        Some(Self { table: Table::new(parts).expect("mirrors on walls"), walls, mirrors, cells })
    }

    /// Follows a ray through three mirrors at most, and adds the cells that it passes behind each row of mirrors. Stops
    /// where it comes near the end of something.
    fn trace(&self, closed: &[[Point2; 2]], eye: Point2, direction: Point2, reached: &mut Shown) {
        let (mut at, mut d) = (eye, direction.normalize());
        let mut word = Vec::new();
        loop {
            let cross = |a: Point2, b: Point2| a.perp_dot(b);
            let hinders = self.walls.iter().chain(closed);
            let hit = |&[a, b]: &[Point2; 2]| {
                let (u, v) = (b - a, a - at);
                let (t, s) = (cross(v, u) / cross(d, u), cross(v, d) / cross(d, u));
                ((0.0..=1.0).contains(&s) && t > CLEAR).then_some(t)
            };
            let end = hinders.clone().filter_map(hit).fold(f64::INFINITY, f64::min);
            let grazed = |p: &Point2| {
                let t = (*p - at).dot(d);
                t > -CLEAR && t < end + CLEAR && (*p - at).perp_dot(d).abs() < CLEAR && (*p - at).length() > CLEAR
            };
            let ends = self.mirrors.iter().flat_map(|m| &m.ends);
            if hinders.flatten().chain(ends).any(grazed) {
                return;
            }
            let passed = (0..).zip(&self.cells).filter(|(_, cell)| passes(cell, at, d, end)).map(|(id, _)| id);
            reached.entry(word.clone()).or_default().extend(passed);
            if !end.is_finite() || word.len() == 3 {
                return;
            }
            let q = at + end * d;
            let met = self.mirrors.iter().find(|m| {
                let along = m.ends[1] - m.ends[0];
                let s = (q - m.ends[0]).dot(along) / along.dot(along);
                let beside = (q - m.ends[0]).perp_dot(along).abs() / along.length();
                (0.0..=1.0).contains(&s) && beside < 1e-9 && along.perp_dot(d) < 0.0
            });
            let Some(mirror) = met else { return };
            word.push(mirror.face);
            (at, d) = (q, mirror.turned(d));
        }
    }

    /// All cells that rays reach, by mirrors: one ray between each two neighbouring directions in which anything
    /// changes for one of some rows of mirrors.
    fn all_reached(&self, closed: &[[Point2; 2]], eye: Point2, words: &[&[u32]]) -> Shown {
        let points: Vec<Point2> =
            self.walls.iter().chain(closed).flatten().chain(self.cells.iter().flatten()).copied().collect();
        let frames: Vec<Point2> = self.mirrors.iter().flat_map(|m| m.ends).collect();
        let mut angles: Vec<f64> = Vec::new();
        for word in words.iter().copied().chain([&[][..]]) {
            for &p in points.iter().chain(&frames) {
                let mirror = |face: &u32| self.mirrors.iter().find(|m| m.face == *face);
                let image = word.iter().rev().filter_map(mirror).fold(p, |p, m| m.image(p));
                let d = image - eye;
                angles.extend((d.length() > CLEAR).then(|| d.y.atan2(d.x)));
            }
        }
        angles.sort_by(f64::total_cmp);
        let mut reached = Shown::new();
        for (k, &from) in angles.iter().enumerate() {
            let to = if k + 1 == angles.len() { angles[0] + TAU } else { angles[k + 1] };
            if to - from > 1e-9 {
                let (sin, cos) = (0.5 * (from + to)).sin_cos();
                self.trace(closed, eye, Point2::new(cos, sin), &mut reached);
            }
        }
        reached
    }
}

/// Whether a ray is inside a convex polygon for a stretch before `end`.
fn passes(polygon: &[Point2], at: Point2, d: Point2, end: f64) -> bool {
    let (mut from, mut to) = (0.0f64, end);
    for (k, &a) in polygon.iter().enumerate() {
        let side = polygon[(k + 1) % polygon.len()] - a;
        let (slope, start) = (side.perp_dot(d), side.perp_dot(at - a));
        if slope > 0.0 {
            from = from.max(-start / slope);
        } else if slope < 0.0 {
            to = to.min(-start / slope);
        } else if start < 0.0 {
            return false;
        }
    }
    from + CLEAR < to
}

#[derive(Debug, Default)]
struct Counts {
    n_frames: usize,
    /// Cells in mirrors that rays reach; of them by two and by three mirrors.
    n_reached: usize,
    n_again: usize,
    n_thrice: usize,
    /// Cells in mirrors that the methods show.
    n_cells: [usize; 5],
    /// Of the exact one, all round from places off the grid: those, and those of them that rays reach.
    n_exact: usize,
    n_confirmed: usize,
    n_incomplete: usize,
    /// Images of bounded answers; those that fell back, and those that did not though another of the answer did.
    n_bounded: usize,
    n_fell_back: usize,
    n_beside: usize,
}

fn check(name: &str, hall: &Hall, plan: &Plan, places: std::ops::Range<usize>, seed: u64, counts: &mut Counts) {
    let mut asker = Asker::new(&hall.table);
    for place in places {
        let mut random = Random::new(seed, place as u64);
        let Some(mut eye) = eye(plan, &hall.table, place, &mut random) else { continue };
        // A place that has nothing to do with the grid: there nothing is only grazed.
        let is_off_grid = place % N_PLACES == 0;
        if is_off_grid {
            eye += Point2::new(random.unit(), random.unit()) / 64.0;
        }
        let roots = hall.table.in_dimension().unwrap().at([eye.x, eye.y]).cells().to_vec();
        let (doors, closed) = match random.below(3) {
            0 => some_doors(&hall.table, &mut random),
            _ => (Doors::all_open(), Vec::new()),
        };
        let ends = |portal: &u32| [0, 1].map(|k| hall.table.portals()[*portal as usize].points[k]);
        let closed: Vec<[Point2; 2]> = closed.iter().map(|p| ends(p).map(|[x, y, _]| Point2::new(x, y))).collect();
        let all_round = View::all_round([eye.x, eye.y, 0.0]).expect("a finite eye");
        for (view, centre, fov) in [(all_round, 0.0, TAU), gaze(&hall.table, eye, &mut random)] {
            let mut reached = Shown::new();
            for _ in 0..300 {
                // Inside the view, more often near its middle.
                let angle = centre + (random.unit() - 0.5) * fov * [0.999, 0.01][usize::from(random.below(4) == 0)];
                hall.trace(&closed, eye, Point2::new(angle.cos(), angle.sin()), &mut reached);
            }
            let images = Method::ALL.map(|method| asker.images(&roots, &view, &doors, method));
            for (k, images) in images.iter().enumerate() {
                let what = || format!("{name}: {}, eye {eye:?}, view {view:?}, {:?}", Method::ALL[k], hall.mirrors);
                assert_eq!(missed_in_mirrors(images, &reached), None, "{}", what());
                counts.n_cells[k] += images.iter().map(|image| image.cells.len()).sum::<usize>();
                counts.n_incomplete += images.iter().filter(|image| !image.complete).count();
            }
            for bounded in asker.bounded_images(&roots, &view, &doors) {
                assert_eq!(
                    missed_in_mirrors(&bounded, &reached),
                    None,
                    "{name}: eye {eye:?}, {view:?}, {:?}",
                    hall.mirrors
                );
                let n_fell_back = bounded.iter().filter(|image| image.fell_back).count();
                counts.n_bounded += bounded.len();
                counts.n_fell_back += n_fell_back;
                counts.n_beside += if n_fell_back > 0 { bounded.len() - n_fell_back } else { 0 };
            }
            if fov == TAU && is_off_grid && images[4].iter().all(|image| image.complete) {
                let words: Vec<Vec<u32>> = images[4].iter().map(word_of).collect();
                let words: Vec<&[u32]> = words.iter().map(Vec::as_slice).collect();
                let reached = hall.all_reached(&closed, eye, &words);
                assert_eq!(missed_in_mirrors(&images[4], &reached), None, "{name}: eye {eye:?}, {:?}", hall.mirrors);
                for image in &images[4] {
                    let by_rays = reached.get(&word_of(image)).cloned().unwrap_or_default();
                    let shown: BTreeSet<u32> = image.cells.iter().map(|c| c.0).collect();
                    counts.n_exact += shown.len();
                    counts.n_confirmed += shown.intersection(&by_rays).count();
                }
            }
            let by_mirrors = |n: usize| reached.iter().filter(move |(word, _)| word.len() == n).map(|(_, c)| c.len());
            counts.n_reached += by_mirrors(1).sum::<usize>();
            counts.n_again += by_mirrors(2).sum::<usize>();
            counts.n_thrice += by_mirrors(3).sum::<usize>();
            counts.n_frames += 1;
        }
    }
}

/// Invariant: what a ray reaches that mirrors reflect up to three times, following the reflections of any method
/// shows, in the same mirrors; and from places off the grid, where nothing is only grazed, rays reach all that the
/// exact one shows.
#[test]
fn mirrors_in_plans_show_what_rays_reach() {
    let mut counts = Counts::default();
    for (seed, (name, plan)) in (0..).zip(families().into_iter().take(6)) {
        for (k, table) in (0..).zip(tables(&plan)) {
            let mut random = Random::new(seed, 77 + k);
            let Some(hall) = Hall::new(&plan, &table, 12, &mut random) else { continue };
            check(&name, &hall, &plan, 0..2 * N_PLACES, seed, &mut counts);
        }
    }
    eprintln!("{counts:?}");
    assert!(counts.n_frames > 100 && counts.n_reached > 1_000, "{counts:?}");
    assert!(counts.n_fell_back > 100 && counts.n_beside > 100 && counts.n_bounded > 1_000, "{counts:?}");
    assert!(counts.n_again > 100 && counts.n_thrice > 20, "{counts:?}");
    assert!(counts.n_cells.is_sorted_by(|a, b| a >= b) && counts.n_cells[4] * 2 < counts.n_cells[0], "{counts:?}");
    assert!(counts.n_exact > 200 && counts.n_confirmed == counts.n_exact, "{counts:?}");
}

/// The impostors: an image less, or a cell less in one, is noticed.
#[test]
fn wrong_images_are_noticed() {
    let plan = sightlines::scenes::maze(5, 4, 4).expect("a small maze");
    let table = tables(&plan).swap_remove(2);
    let (hall, eye) = (0..)
        .find_map(|seed| {
            let mut random = Random::new(seed, 1);
            let hall = Hall::new(&plan, &table, 12, &mut random)?;
            let eye = eye(&plan, &hall.table, 0, &mut random)?;
            let mut reached = Shown::new();
            (0..200).for_each(|k| hall.trace(&[], eye, Point2::from_angle(0.0314159 * f64::from(k)), &mut reached));
            (reached.len() > 2).then_some((hall, eye))
        })
        .expect("a place with mirrors");
    let roots = hall.table.in_dimension().unwrap().at([eye.x, eye.y]).cells().to_vec();
    let view = View::all_round([eye.x, eye.y, 0.0]).expect("a finite eye");
    let images = Asker::new(&hall.table).images(&roots, &view, &Doors::all_open(), Method::Exact);
    let words: Vec<Vec<u32>> = images.iter().map(word_of).collect();
    let words: Vec<&[u32]> = words.iter().map(Vec::as_slice).collect();
    let reached = hall.all_reached(&[], eye, &words);
    assert_eq!(missed_in_mirrors(&images, &reached), None);
    let mut n = 0;
    for (word, cells) in reached.iter().filter(|(word, cells)| !word.is_empty() && !cells.is_empty()) {
        let without: Vec<_> = images.iter().filter(|image| word_of(image) != *word).cloned().collect();
        assert!(missed_in_mirrors(&without, &reached).is_some());
        for &cell in cells {
            let mut less = images.clone();
            less.iter_mut().filter(|i| word_of(i) == *word).for_each(|i| i.cells.retain(|c| c.0 != cell));
            assert!(missed_in_mirrors(&less, &reached).is_some());
            n += 1;
        }
    }
    assert!(n > 3, "{n}");
}

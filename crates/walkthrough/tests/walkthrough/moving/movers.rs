//! Movers against the plain method: the box of each one against the visible cells, in each frame.

use crate::moving::grid::{Chance, Grid, IntBox, Kind, UNIT, any_grid, float, frame, grid, see};
use proptest::prelude::*;
use sightlines_eye_to_cell::{TableCells, VisibleSet};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Table};
use sightlines_walkthrough::{AnswerKind, CellBoxes, Motion, MoverId, MoverOptions, Movers};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A mover in the oracle's form: a box that moves by at most `speed` quarters along each axis in a quarter of a time
/// unit.
#[derive(Debug, Clone)]
struct Thing {
    at: IntBox,
    speed: Option<i64>,
    region: Option<IntBox>,
}

impl Thing {
    fn any(grid: &Grid, chance: &mut Chance) -> Self {
        let mut corner = |from: i64, size: i64| -> [i64; 3] {
            std::array::from_fn(|k| from + chance.below((grid.size[k] + size) as u64) as i64)
        };
        let (a, b) = (corner(-1, 2), corner(0, 1));
        let region =
            (std::array::from_fn(|k| a[k].min(b[k])), std::array::from_fn(|k| a[k].max(b[k]) + chance.below(2) as i64));
        let size: [i64; 3] = std::array::from_fn(|_| chance.below(3) as i64);
        let at: IntBox = (region.0, std::array::from_fn(|k| (region.0[k] + size[k]).min(region.1[k])));
        let speed = (!chance.one_in(4)).then(|| chance.below(3) as i64);
        Self { at, speed, region: chance.one_in(3).then_some(region) }
    }

    fn motion(&self) -> Motion {
        let mut motion = Motion::ANY;
        if let Some(speed) = self.speed {
            motion = motion.and_speed(speed as f64).unwrap();
        }
        if let Some(region) = &self.region {
            motion = motion.and_within(float(region)).unwrap();
        }
        motion
    }

    /// Moves for some quarters of a time unit.
    fn go(&mut self, quarters: i64, chance: &mut Chance) {
        let most = self.speed.unwrap_or(3) * quarters;
        for k in 0..3 {
            let step = chance.below(2 * most as u64 + 1) as i64 - most;
            let (low, high) = self.region.map_or((-99, 99), |r| (r.0[k] - self.at.0[k], r.1[k] - self.at.1[k]));
            let step = step.clamp(low, high);
            self.at.0[k] += step;
            self.at.1[k] += step;
        }
    }
}

type CellLocator = TableCells<Arc<Table>>;

/// A game with movers and its plain twin.
struct Game {
    grid: Grid,
    chance: Chance,
    movers: Movers<CellLocator>,
    things: BTreeMap<MoverId, Thing>,
    seen: VisibleSet,
    /// Quarters of a time unit.
    now: i64,
    n_reported: usize,
    n_hidden: usize,
}

impl Game {
    fn new(grid: Grid, seed: u64) -> Self {
        let mut chance = Chance(seed);
        let options = MoverOptions {
            least: [0.25, 1.0, 0.0, 1e-9][chance.below(4) as usize],
            most: [64.0, 1.0, f64::INFINITY][chance.below(3) as usize],
            cells: [64, 3, 0][chance.below(3) as usize],
            patience: chance.below(3) as u32,
            tries: [usize::MAX, 2, 0][chance.below(3) as usize],
            solid_within: None,
        };
        let movers = Movers::new(grid.cells(), options);
        let (things, seen) = (BTreeMap::new(), VisibleSet::new());
        Self { grid, chance, movers, things, seen, now: 0, n_reported: 0, n_hidden: 0 }
    }

    fn time(&self) -> f64 {
        self.now as f64 / UNIT as f64
    }

    fn add(&mut self) {
        let thing = Thing::any(&self.grid, &mut self.chance);
        let id = self.movers.add(float(&thing.at), thing.motion(), self.time()).unwrap();
        assert!(self.things.insert(id, thing).is_none(), "an id comes once");
    }

    fn any_id(&mut self) -> Option<MoverId> {
        let n = self.things.len() as u64;
        let k = if n == 0 { return None } else { self.chance.below(n) as usize };
        self.things.keys().nth(k).copied()
    }

    /// A random event.
    fn happen(&mut self) {
        let now = self.time();
        match self.chance.below(12) {
            0 => self.add(),
            1 => {
                if let Some(id) = self.any_id() {
                    self.things.remove(&id);
                    assert!(self.movers.remove(id) && !self.movers.remove(id));
                }
            }
            2 => {
                if let Some(id) = self.any_id() {
                    let other = Thing::any(&self.grid, &mut self.chance);
                    assert!(self.movers.moved(id, float(&other.at), now).unwrap());
                    assert!(self.movers.promise(id, other.motion()));
                    self.things.insert(id, other);
                }
            }
            3 => {
                let (kind, size) = (self.grid.kind, self.grid.size.map(|x| (x / UNIT) as usize));
                let seed = self.chance.below(1 << 30);
                let solid = |i: usize| i > 0 && Chance(seed ^ i as u64).one_in(4);
                self.grid = grid(kind, size, solid, |a, b| (a * b) % 3 == 0);
                self.movers.replace(self.grid.cells());
                self.look();
            }
            _ => {}
        }
    }

    /// Changes what the viewer sees.
    fn look(&mut self) {
        let n = self.grid.n_cells();
        let eye = CellId(self.chance.below(n as u64) as u32);
        let cells: Vec<u32> = self.grid.table.visible(eye).map(|cell| cell.0).collect();
        let chance = &mut self.chance;
        see(&mut self.seen, n, cells.into_iter().filter(|&cell| cell == eye.0 || !chance.one_in(3)));
    }

    /// One frame: the report, and what the plain method reports.
    fn frame(&mut self) -> (Vec<MoverId>, Vec<MoverId>) {
        let quarters = self.chance.below(4) as i64;
        self.now += quarters;
        for thing in self.things.values_mut() {
            thing.go(quarters, &mut self.chance);
        }
        let answer = if self.chance.one_in(20) { AnswerKind::Outside } else { AnswerKind::Full };
        if answer == AnswerKind::Outside {
            let n = self.grid.n_cells();
            see(&mut self.seen, n, 0..n as u32);
        } else if self.chance.one_in(3) {
            self.look();
        }
        let now = self.time();
        let (grid, things) = (&self.grid, &self.things);
        let reported = self.movers.frame(now, &frame(&self.seen, answer), &mut |id| float(&things[&id].at)).unwrap();
        let reported = reported.to_vec();
        let outside = answer == AnswerKind::Outside;
        let plain = things.iter().filter(|(_, thing)| outside || grid.sees(&self.seen, &thing.at));
        let plain: Vec<MoverId> = plain.map(|(&id, _)| id).collect();
        self.n_reported += reported.len();
        self.n_hidden += things.len() - plain.len();
        (reported, plain)
    }
}

proptest! {
    /// Invariant: as long as promises are kept, the reported movers are exactly those of the plain method, whatever
    /// comes and goes, and however the table changes.
    #[test]
    fn movers_are_those_of_the_plain_method(grid in any_grid(), seed in any::<u64>(), n in 1usize..12) {
        let mut game = Game::new(grid, seed);
        (0..n).for_each(|_| game.add());
        game.look();
        for k in 0..40 {
            let (reported, plain) = game.frame();
            prop_assert_eq!(&reported, &plain, "frame {}", k);
            prop_assert_eq!(game.movers.broken(), &[]);
            prop_assert_eq!(game.movers.len(), game.things.len());
            game.happen();
        }
    }

    /// Invariant: movers seen in mirrors are those of the plain method for the cells seen there, and no mover is
    /// queried twice.
    #[test]
    fn movers_in_mirrors_are_those_of_the_plain_method(grid in any_grid(), seed in any::<u64>()) {
        let mut game = Game::new(grid, seed);
        (0..6).for_each(|_| game.add());
        game.look();
        for _ in 0..20 {
            game.now += 1;
            game.things.values_mut().for_each(|thing| thing.go(1, &mut game.chance));
            let now = game.time();
            let mut asked = Vec::new();
            let things = &game.things;
            let mut place = |id: MoverId| { asked.push(id); float(&things[&id].at) };
            game.movers.frame(now, &frame(&game.seen, AnswerKind::Full), &mut place).unwrap();
            for turn in 0..3u32 {
                let n = game.grid.n_cells() as u32;
                let cells: Vec<CellId> = (0..n).filter(|cell| (cell + turn) % 3 == 0).map(CellId).collect();
                let reported = game.movers.also(&cells, &mut place).to_vec();
                let mut seen = VisibleSet::new();
                see(&mut seen, n as usize, cells.iter().map(|cell| cell.0));
                let plain = things.iter().filter(|(_, thing)| game.grid.sees(&seen, &thing.at)).map(|(&id, _)| id);
                prop_assert_eq!(reported, plain.collect::<Vec<_>>());
            }
            let n_asked = asked.len();
            asked.sort_unstable();
            asked.dedup();
            prop_assert_eq!(asked.len(), n_asked);
        }
    }

    /// Invariant: the cells of a table that a box touches are those of the oracle; by boxes of cells alone, at least
    /// these.
    #[test]
    fn touching_is_that_of_whole_numbers(grid in any_grid(), seed in any::<u64>()) {
        let mut chance = Chance(seed);
        let (cells, boxes) = (grid.cells(), CellBoxes::read(&grid.cells()).unwrap());
        let mut pending = Vec::new();
        for _ in 0..20 {
            let mut b = Thing::any(&grid, &mut chance).at;
            if grid.dimension() == 2 {
                (b.0[2], b.1[2]) = (0, 0);
            }
            let mut collect = |places: &dyn sightlines_walkthrough::CellLocator| {
                let mut found = Vec::new();
                places.touching(&float(&b), &mut pending, &mut |cell| { found.push(cell.0); true });
                found.sort_unstable();
                found.dedup();
                found
            };
            let touched = collect(&cells);
            let loose = collect(&boxes);
            let oracle: Vec<u32> =
                (0u32..).zip(&grid.shapes).filter(|(_, s)| s.touches(&b, grid.dimension())).map(|(i, _)| i).collect();
            prop_assert_eq!(&touched, &oracle);
            prop_assert!(oracle.iter().all(|cell| loose.binary_search(cell).is_ok()));
            // The first `false` ends the search.
            for places in [&cells as &dyn sightlines_walkthrough::CellLocator, &boxes] {
                let mut n = 0;
                places.touching(&float(&b), &mut pending, &mut |_| { n += 1; false });
                prop_assert!(n <= 1);
            }
        }
    }
}

/// `n` rooms in a row; each sees its neighbours.
pub(crate) fn row(n: usize) -> Grid {
    grid(Kind::Space, [n, 1, 1], |_| false, |a, b| a.abs_diff(b) <= 1)
}

fn in_room(i: usize) -> Aabb<3> {
    let x = i as f64;
    Aabb { min: [x + 0.25, 0.25, 0.25], max: [x + 0.75, 0.75, 0.75] }
}

/// Frames of a viewer that stays in the first room, with movers in far rooms: the number of queries in each.
fn asked_in_frames(n_movers: usize, n_frames: usize, motion: impl Fn(usize) -> Motion) -> Vec<u64> {
    let grid = row(64);
    let mut movers = Movers::new(grid.cells(), MoverOptions { tries: usize::MAX, ..MoverOptions::default() });
    for k in 0..n_movers {
        let motion = motion(8 + k % 56);
        let motion = if motion.region().is_some() { motion } else { motion.and_within(movers.bounds()).unwrap() };
        movers.add(in_room(8 + k % 56), motion, 0.0).unwrap();
    }
    let seen_by = movers.add(in_room(1), Motion::speed(0.125).unwrap(), 0.0).unwrap();
    let mut seen = VisibleSet::new();
    see(&mut seen, 64, [0, 1]);
    let mut asked = Vec::new();
    for k in 0..n_frames {
        let before = movers.counters();
        let place = &mut |id: MoverId| if id == seen_by { in_room(1) } else { in_room(8 + id.slot() % 56) };
        let reported = movers.frame(k as f64 / 60.0, &frame(&seen, AnswerKind::Full), place).unwrap();
        assert_eq!(reported, [seen_by]);
        let after = movers.counters();
        asked.push(after.asked - before.asked);
        assert!(after.cells - before.cells <= 2, "only cells in view are looked at");
    }
    asked
}

#[test]
fn hidden_movers_are_not_asked() {
    // Those that stay in their rooms: once, and never again, however many.
    for n in [10, 10_000] {
        let asked = asked_in_frames(n, 600, |room| {
            let x = room as f64;
            Motion::within(Aabb { min: [x, 0.0, 0.0], max: [x + 1.0, 1.0, 1.0] }).unwrap()
        });
        assert_eq!(asked[0], n as u64 + 1);
        assert!(asked[1..].iter().all(|&n| n == 1), "only the one that is seen");
    }
    // Those that may go anywhere slowly: ever more rarely, and spread over the frames.
    let n = 5_600;
    let asked = asked_in_frames(n, 3000, |_| Motion::speed(0.1).unwrap());
    let late: u64 = asked[1800..].iter().sum::<u64>() - 1200;
    assert!(late < n as u64, "{late} in 20 seconds");
    assert!(asked[1..].iter().max().unwrap() * 10 < n as u64, "{:?}", asked.iter().max());
}

#[test]
fn frames_without_movers_look_at_nothing() {
    let grid = row(64);
    let mut movers = Movers::new(grid.cells(), MoverOptions::default());
    let mut seen = VisibleSet::new();
    see(&mut seen, 64, 0..64);
    for k in 0..100 {
        assert!(
            movers.frame(f64::from(k), &frame(&seen, AnswerKind::Full), &mut |_| unreachable!()).unwrap().is_empty()
        );
    }
    assert_eq!((movers.counters().cells, movers.is_empty(), movers.n_entries()), (0, true, 0));
}

#[test]
fn volumes_shrink_when_they_come_into_view_for_nothing() {
    let grid = row(64);
    let mut movers = Movers::new(grid.cells(), MoverOptions { patience: 0, ..MoverOptions::default() });
    let motion = Motion::speed(1.0).unwrap().and_within(movers.bounds()).unwrap();
    let id = movers.add(in_room(20), motion, 0.0).unwrap();
    let mut seen = VisibleSet::new();
    let mut widths = Vec::new();
    let mut in_vain = Vec::new();
    // The viewer approaches every other second, and stops two rooms away.
    for k in 0..2400 {
        let at = (k / 120).min(17) as u32;
        see(&mut seen, 64, [at, at + 1]);
        let reported =
            movers.frame(f64::from(k) / 60.0, &frame(&seen, AnswerKind::Full), &mut |_| in_room(20)).unwrap();
        assert!(reported.is_empty());
        let volume = movers.sleeps_in(id);
        widths.push(volume.map_or(0.0, |v| v.max[0] - v.min[0]));
        assert!(volume.is_none_or(|v| v.min[0] > f64::from(at) + 2.0), "what is in view is not slept in");
        in_vain.push(movers.counters().in_vain);
    }
    let widest = widths.iter().copied().fold(0.0, f64::max);
    assert!(widest > 8.0, "{widest}");
    assert!(in_vain[2399] > 0 && in_vain[2399] < 40, "{}", in_vain[2399]);
    assert!(widths[2300..].iter().all(|&w| w < 4.0));
    assert!(movers.counters().asked < 600, "{:?}", movers.counters());
}

/// In a plane a region has no height, so in space it is discarded: a mover that rises within its promise is seen.
#[test]
fn regions_of_a_plane_say_nothing_in_space() {
    let [plane, space] = [Kind::Plane, Kind::Space].map(|kind| grid(kind, [4, 1, 3], |_| false, |_, _| true));
    let mut movers = Movers::new(plane.cells(), MoverOptions { patience: 0, ..MoverOptions::default() });
    let column = Aabb { min: [3.0, 0.0, 0.0], max: [4.0, 1.0, 3.0] };
    let at = |z: f64| Aabb { min: [3.25, 0.25, z], max: [3.5, 0.5, z + 0.25] };
    let id = movers.add(at(0.0), Motion::within(column).unwrap(), 0.0).unwrap();
    let mut seen = VisibleSet::new();
    let n = space.table.n_cells();
    see(&mut seen, plane.table.n_cells(), [0]);
    for k in 0..10 {
        assert!(movers.frame(f64::from(k), &frame(&seen, AnswerKind::Full), &mut |_| at(0.0)).unwrap().is_empty());
    }
    assert!(movers.sleeps_in(id).is_some());
    movers.replace(space.cells());
    see(&mut seen, n, [0]);
    for k in 10..20 {
        assert!(movers.frame(f64::from(k), &frame(&seen, AnswerKind::Full), &mut |_| at(0.0)).unwrap().is_empty());
    }
    // The topmost cell of its column comes into view, and the mover is there.
    see(&mut seen, n, [n as u32 - 1]);
    assert_eq!(movers.frame(20.0, &frame(&seen, AnswerKind::Full), &mut |_| at(2.5)).unwrap(), [id]);
    assert!(movers.broken().is_empty());
    // From outside everything is seen, including movers added after the frame.
    movers.frame(21.0, &frame(&seen, AnswerKind::Outside), &mut |_| at(2.5)).unwrap();
    let new = movers.add(at(0.0), Motion::ANY, 21.0).unwrap();
    assert_eq!(movers.also(&[], &mut |_| unreachable!()), [id, new]);
    movers.remove(id);
    assert_eq!(movers.also(&[], &mut |_| unreachable!()), [new]);
}

//! The cells from which one object is hidden.

use super::lines::{Sight, hit, is_free_back, sights};
use super::tiling::{Tiling, side};
use sightlines_geometry::{Aabb, Point3, Random, orient3d};
use sightlines_line_space::{FaceEffort, FaceExit, FaceSearch, FaceTarget, Surface};
use sightlines_multifocal::{RaySampler, Volume};
use sightlines_progress::{Cancelled, Observer};
use sightlines_pvs::runs::{read_runs, read_varint, runs_of, write_runs, write_varint};
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

/// Rays from a cell to where its neighbour sees an object.
const AIMED: usize = 4;

/// Rays from a cell to the box of an object before anything is asked about the cell.
const FIRST_RAYS: usize = 16;

/// How many triangles a chain has.
const LONGEST_CHAIN: usize = 300;

/// Cells of line space for the triangle at which the search from a neighbour failed.
const AGAIN: u32 = 20;

/// Up to this number of pairs of a box and an object, each question gets the full effort; beyond it the effort shrinks in proportion, down to
/// [`LEAST_SHARE`]. Measured on a castle with 20 million pairs: a quarter of the effort finds 98 % of what the full effort finds, in half the time.
const FULL_EFFORT_PAIRS: f64 = 5e6;
const LEAST_SHARE: f64 = 0.1;

/// Cells of line space for a question, apart from half a one for each triangle of the object. Ten times as many find hardly more.
const EFFORT: FaceEffort = FaceEffort { cells: 60, triangle_cells: 40, attempts: 4, enough: 0.5 };

/// The most of them.
const MOST_CELLS: u32 = 400;

/// What is known of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// A filler on which no cell leaned yet.
    Unasked,
    /// Hidden from, if it stays so.
    Hidden,
    /// May see the object.
    Visible,
}

/// A tiling of boxes in a scene, ready for one object after the other.
#[derive(Debug)]
pub(crate) struct Propagation<'a> {
    tiling: Tiling,
    rays: &'a RaySampler,
    surface: Arc<Surface>,
    sights: Vec<Vec<Sight>>,
    /// How many of the boxes are cells; the others only have to be known where cells lean on them.
    n_cells: usize,
    /// Which share of the full effort each question gets.
    share: f64,
}

/// What was found of one object.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Solved {
    /// The boxes from which it is hidden: of fillers only those on which cells lean.
    pub(crate) hidden: Vec<Range<u32>>,
    /// Boxes that rays found to see it.
    pub(crate) n_seen: u64,
    /// Questions, and those that found no proof.
    pub(crate) n_asked: u64,
    pub(crate) n_failed: u64,
    /// Cells of line space.
    pub(crate) n_cells: u64,
}

impl Solved {
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        write_runs(&self.hidden, &mut out);
        let Self { n_seen, n_asked, n_failed, n_cells, .. } = *self;
        [n_seen, n_asked, n_failed, n_cells].into_iter().for_each(|n| write_varint(n, &mut out));
        out
    }

    /// `None` if these are no bytes of what was found in so many boxes.
    pub(crate) fn from_bytes(mut bytes: &[u8], n_boxes: u32) -> Option<Self> {
        let hidden = read_runs(&mut bytes, n_boxes)?;
        let mut number = || read_varint(&mut bytes);
        let (n_seen, n_asked, n_failed, n_cells) = (number()?, number()?, number()?, number()?);
        bytes.is_empty().then_some(Self { hidden, n_seen, n_asked, n_failed, n_cells })
    }
}

/// Memory of a thread.
#[derive(Debug)]
pub(crate) struct Memory {
    search: FaceSearch,
    marks: Vec<Mark>,
    /// By pair of neighbours: whether the part of a side was found blocked.
    is_blocked: Vec<bool>,
    /// The same of open sides, a bit for each side of a box.
    are_blocked: Vec<u8>,
    waits: Vec<bool>,
}

impl<'a> Propagation<'a> {
    /// Shoots the rays of all cells. O(n log n) of triangles, and of boxes.
    ///
    /// * `boxes`: the cells, then the fillers
    /// * `rays`: of which each object is one
    ///
    /// # Errors
    /// [`Cancelled`] by the observer.
    pub(crate) fn new(
        (boxes, n_cells): (Vec<Aabb<3>>, usize),
        rays: &'a RaySampler,
        surface: Arc<Surface>,
        n_objects: usize,
        observer: Option<&dyn Observer>,
    ) -> Result<Self, Cancelled> {
        let tiling = Tiling::new(boxes);
        let sights = sights(&tiling, rays, n_objects, observer)?;
        let n_pairs = tiling.len() as f64 * n_objects as f64;
        Ok(Self {
            tiling,
            rays,
            surface,
            sights,
            n_cells,
            share: (FULL_EFFORT_PAIRS / n_pairs).clamp(LEAST_SHARE, 1.0),
        })
    }

    /// The impostor: lines leave through no side without a neighbour.
    #[cfg(test)]
    pub(super) fn close_open_sides(&mut self) {
        self.tiling.close();
    }

    pub(crate) fn memory(&self) -> Memory {
        let n = self.tiling.len();
        Memory {
            search: FaceSearch::new(self.surface.clone(), LONGEST_CHAIN),
            marks: vec![Mark::Hidden; n],
            is_blocked: vec![false; self.tiling.n_pairs()],
            are_blocked: vec![0; n],
            waits: vec![false; n],
        }
    }

    /// Finds from which boxes an object is hidden; the same whatever was asked before.
    ///
    /// * `object`: its index, if it is one of the objects that rays find
    /// * `fronts`: whether only the fronts of its triangles are seen
    pub(crate) fn solve(&self, memory: &mut Memory, object: Option<u32>, target: &FaceTarget, fronts: bool) -> Solved {
        memory.search.forget();
        let (cells, fillers) = memory.marks.split_at_mut(self.n_cells);
        cells.fill(Mark::Hidden);
        fillers.fill(Mark::Unasked);
        memory.is_blocked.fill(false);
        memory.are_blocked.fill(0);
        let n_cells = memory.search.n_cells();
        let mut one = One {
            of: self,
            memory,
            object,
            target,
            fronts,
            culprit: None,
            changed: Vec::new(),
            random: Random::new(u64::from(object.unwrap_or(0))),
            solved: Solved::default(),
        };
        one.see();
        one.ask_all();
        if !one.is_sound() {
            return Solved::default();
        }
        let hidden = runs_of((0..self.tiling.len() as u32).filter(|&k| one.is_hidden(k)));
        let mut solved = Solved { hidden, ..one.solved };
        solved.n_cells = memory.search.n_cells() - n_cells;
        solved
    }
}

/// One object.
struct One<'a> {
    of: &'a Propagation<'a>,
    memory: &'a mut Memory,
    object: Option<u32>,
    target: &'a FaceTarget,
    fronts: bool,
    /// The triangle at which the last search failed.
    culprit: Option<u32>,
    /// What was marked since this was emptied.
    changed: Vec<u32>,
    random: Random,
    solved: Solved,
}

fn exit(volume: &Aabb<3>, side: usize, part: Aabb<3>) -> FaceExit {
    FaceExit { volume: *volume, axis: side / 2, upward: side % 2 == 1, part }
}

fn meet(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

impl One<'_> {
    fn is_hidden(&self, cell: u32) -> bool {
        self.memory.marks[cell as usize] == Mark::Hidden
    }

    fn is_visible(&self, cell: u32) -> bool {
        self.memory.marks[cell as usize] == Mark::Visible
    }

    /// Marks what touches the object, what rays find to see it, and from there on neighbours from which it is seen as well.
    fn see(&mut self) {
        let around = self.target.bounds();
        for (mark, b) in self.memory.marks.iter_mut().zip(self.of.tiling.boxes()) {
            if meet(b, around) {
                *mark = Mark::Visible;
            }
        }
        let of = self.of;
        let Some(object) = self.object.filter(|&object| !of.sights[object as usize].is_empty()) else {
            return self.see_box();
        };
        let mut queue: VecDeque<Sight> = VecDeque::new();
        for &sight in &of.sights[object as usize] {
            self.note(sight, &mut queue);
        }
        self.follow(queue);
    }

    /// Marks boxes from which a point of the box around the object is seen: of what rays do not find, as it stops none.
    fn see_box(&mut self) {
        let (of, around) = (self.of, self.target.bounds());
        for (mark, b) in self.memory.marks.iter_mut().zip(of.tiling.boxes()) {
            let volume = Volume::new(*b).ok().filter(|_| *mark != Mark::Visible);
            if volume.is_some_and(|volume| of.rays.sees(&volume, around, AIMED as u32)) {
                *mark = Mark::Visible;
                self.solved.n_seen += 1;
            }
        }
    }

    fn note(&mut self, sight: Sight, queue: &mut VecDeque<Sight>) {
        let mark = &mut self.memory.marks[sight.cell as usize];
        if *mark != Mark::Visible {
            *mark = Mark::Visible;
            self.solved.n_seen += 1;
            self.changed.push(sight.cell);
            queue.push_back(sight);
        }
    }

    /// Aims from the neighbours of what sees the object at where it does.
    fn follow(&mut self, mut queue: VecDeque<Sight>) {
        let (of, Some(object)) = (self.of, self.object) else { return };
        while let Some(sight) = queue.pop_front() {
            for (_, near) in of.tiling.neighbours(sight.cell) {
                if self.is_visible(near.of) {
                    continue;
                }
                let b = &of.tiling.boxes()[near.of as usize];
                for _ in 0..AIMED {
                    let origin = self.random.point(b);
                    let way: Point3 = std::array::from_fn(|k| sight.at[k] - origin[k]);
                    let (found, at) = hit(of.rays, origin, way);
                    if found == Some(object) {
                        let mut passed = Vec::new();
                        of.tiling.walk(near.of, origin, at, |cell| passed.push(cell));
                        for cell in passed {
                            self.note(Sight { cell, at }, &mut queue);
                        }
                        break;
                    }
                }
            }
        }
    }

    /// Asks about faces until each is blocked, or has a box behind it from which the object is hidden, or its cell may see the object.
    fn ask_all(&mut self) {
        let tiling = &self.of.tiling;
        let mut queue: VecDeque<u32> = (0..tiling.len() as u32).filter(|&cell| self.is_hidden(cell)).collect();
        self.memory.waits.fill(false);
        queue.iter().for_each(|&cell| self.memory.waits[cell as usize] = true);
        while let Some(cell) = queue.pop_front() {
            self.memory.waits[cell as usize] = false;
            if !self.is_hidden(cell) {
                continue;
            }
            self.changed.clear();
            let Err(line) = self.ask(cell, &mut queue) else { continue };
            self.memory.marks[cell as usize] = Mark::Visible;
            self.changed.push(cell);
            if let Some(line) = line {
                self.confirm(cell, line);
            }
            // What leaned on them has to be looked at again.
            for k in 0..self.changed.len() {
                for (_, near) in tiling.neighbours(self.changed[k]) {
                    let waits = &mut self.memory.waits[near.of as usize];
                    if self.memory.marks[near.of as usize] == Mark::Hidden && !*waits {
                        *waits = true;
                        queue.push_back(near.of);
                    }
                }
            }
        }
    }

    /// Marks the cells on a free line of the search, if a ray says so too.
    fn confirm(&mut self, cell: u32, [from, to]: [Point3; 2]) {
        let way: Point3 = std::array::from_fn(|k| to[k] - from[k]);
        let (found, at) = hit(self.of.rays, from, way);
        if found.is_none() || found != self.object {
            return;
        }
        let (_, behind) = hit(self.of.rays, from, way.map(|x| -x));
        let mut passed = Vec::new();
        self.of.tiling.walk(cell, from, at, |cell| passed.push(cell));
        if !self.of.rays.is_one_way() || is_free_back(self.of.rays, from, behind) {
            self.of.tiling.walk(cell, from, behind, |cell| passed.push(cell));
        }
        let mut queue = VecDeque::from([Sight { cell, at }]);
        for cell in passed {
            self.note(Sight { cell, at }, &mut queue);
        }
        self.follow(queue);
    }

    /// A free line from a cell to the object, by rays to its box.
    fn aim(&mut self, cell: u32) -> Option<[Point3; 2]> {
        let (b, around) = (&self.of.tiling.boxes()[cell as usize], self.target.bounds());
        self.object?;
        (0..FIRST_RAYS).find_map(|_| {
            let (from, to) = (self.random.point(b), self.random.point(around));
            let way: Point3 = std::array::from_fn(|k| to[k] - from[k]);
            let (found, at) = hit(self.of.rays, from, way);
            (found == self.object).then_some([from, at])
        })
    }

    /// Whether all parts of the sides of a cell that face the object, and have no hidden box behind them, are blocked; or else a free line, if one
    /// was found.
    fn ask(&mut self, cell: u32, queue: &mut VecDeque<u32>) -> Result<(), Option<[Point3; 2]>> {
        let tiling = &self.of.tiling;
        let b = tiling.boxes()[cell as usize];
        let mut is_first = true;
        for s in 0..6 {
            if !self.faces(&b, s) {
                continue;
            }
            if tiling.is_open(cell, s) {
                if self.memory.are_blocked[cell as usize] >> s & 1 == 0 {
                    self.aim_first(cell, &mut is_first)?;
                    self.ask_part(&b, s, tiling.whole(cell, s))?;
                    self.memory.are_blocked[cell as usize] |= 1 << s;
                }
                continue;
            }
            for (pair, near) in tiling.neighbours(cell).filter(|(_, near)| usize::from(near.side) == s) {
                if self.memory.is_blocked[pair] {
                    continue;
                }
                match self.memory.marks[near.of as usize] {
                    Mark::Hidden => continue,
                    Mark::Unasked => {
                        self.memory.marks[near.of as usize] = Mark::Hidden;
                        self.memory.waits[near.of as usize] = true;
                        queue.push_back(near.of);
                        continue;
                    }
                    Mark::Visible => {}
                }
                self.aim_first(cell, &mut is_first)?;
                self.ask_part(&b, s, tiling.part(cell, near))?;
                self.memory.is_blocked[pair] = true;
            }
        }
        Ok(())
    }

    /// Before the first question about a cell: a free line that rays find.
    fn aim_first(&mut self, cell: u32, is_first: &mut bool) -> Result<(), Option<[Point3; 2]>> {
        let free = if std::mem::take(is_first) { self.aim(cell) } else { None };
        free.map_or(Ok(()), |line| Err(Some(line)))
    }

    /// Whether lines to the object may leave a box by a side.
    fn faces(&self, b: &Aabb<3>, side: usize) -> bool {
        exit(b, side, *b).faces(self.target.bounds())
    }

    fn ask_part(&mut self, volume: &Aabb<3>, side: usize, part: Aabb<3>) -> Result<(), Option<[Point3; 2]>> {
        let exit = exit(volume, side, part);
        let (target, fronts, corners) = (self.target, self.fronts, part.corners());
        // Where a line leaves the cell, it is on the same side of what it ends at as its eye.
        let leave_out = |t: u32| {
            let [a, b, c] = target.triangles()[t as usize];
            fronts && corners.iter().all(|&corner| orient3d(a, b, c, corner) <= 0.0)
        };
        let share_of = |n: u32| (f64::from(n) * self.of.share).ceil() as u32;
        let more = u32::try_from(target.triangles().len() / 2).unwrap_or(u32::MAX);
        let cells = share_of(EFFORT.cells.saturating_add(more).min(MOST_CELLS));
        let effort = FaceEffort { cells, triangle_cells: share_of(EFFORT.triangle_cells), ..EFFORT };
        self.solved.n_asked += 1;
        let search = &mut self.memory.search;
        let mut found = Ok(());
        if let Some(culprit) = self.culprit.filter(|&t| !leave_out(t)) {
            let effort = FaceEffort { cells: share_of(AGAIN), ..effort };
            found = search.is_blocked(&exit, target, Some(culprit), &leave_out, &effort);
        }
        match found {
            Ok(()) => {
                found = search.is_blocked(&exit, target, None, &leave_out, &effort);
                if let Err(failed) = &found {
                    self.culprit = failed.triangle.or(self.culprit);
                }
            }
            // What touches a triangle may still block all lines to the box around it.
            Err(failed) if failed.line.is_none() => {
                let effort = FaceEffort { cells: share_of(AGAIN), ..effort };
                found = search.is_blocked(&exit, target, None, &leave_out, &effort);
            }
            Err(_) => {}
        }
        self.solved.n_failed += u64::from(found.is_err());
        found.map_err(|failed| failed.line)
    }

    /// The fixed point, without the solver: see the page of the module.
    fn is_sound(&self) -> bool {
        let (tiling, memory) = (&self.of.tiling, &*self.memory);
        (0..tiling.len() as u32).filter(|&cell| self.is_hidden(cell)).all(|cell| {
            let b = &tiling.boxes()[cell as usize];
            let covered = |s: usize| {
                if tiling.is_open(cell, s) {
                    return memory.are_blocked[cell as usize] >> s & 1 == 1;
                }
                let mut behind = tiling.neighbours(cell).filter(|(_, near)| usize::from(near.side) == s);
                behind.all(|(pair, near)| self.is_hidden(near.of) || memory.is_blocked[pair])
            };
            let sides = (0..3).flat_map(|axis| [false, true].map(|upward| side(axis, upward)));
            !meet(b, self.target.bounds()) && sides.filter(|&s| self.faces(b, s)).all(covered)
        })
    }
}

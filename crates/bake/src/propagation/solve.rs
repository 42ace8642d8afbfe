//! The cells from which one object is hidden.

use super::lines::{Sight, hit, is_free_back, sights};
use super::tiling::{Part, Tiling};
use sightlines_geometry::{Aabb, Point3, Random, orient3d};
use sightlines_line_space::{FaceEffort, FaceExit, FaceSearch, FaceTarget, Surface};
use sightlines_multifocal::{RaySampler, Volume};
use sightlines_progress::{Cancelled, Observer};
use sightlines_pvs::runs::{read_runs, read_varint, runs_of, write_runs, write_varint};
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

/// Rays from a cell to where its neighbour sees an object.
const AIMED: usize = 4;

/// Rays from a cell to the box of an object before anything is asked about the cell.
const FIRST_RAYS: usize = 16;

/// How many triangles a chain has.
const LONGEST_CHAIN: usize = 300;

/// Cells of line space for the triangle at which the search from a neighbour failed.
const AGAIN: u32 = 20;

/// Up to this number of pairs of a cell and an object, each question gets the full effort; beyond it the effort shrinks in proportion, down to
/// [`LEAST_SHARE`]. Measured on a castle with 9.5 million pairs: a tenth of the effort lists 23.1 % of the objects where a quarter lists 21.5, in
/// three quarters of the time.
const FULL_EFFORT_PAIRS: f64 = 0.5e6;
const LEAST_SHARE: f64 = 0.1;

/// Cells of line space for a question, apart from half a one for each triangle of the object. Ten times as many find hardly more.
const EFFORT: FaceEffort = FaceEffort { cells: 60, triangle_cells: 40, attempts: 4, enough: 0.5 };

/// The most of them.
const MOST_CELLS: u32 = 400;

/// Cells in a scene, ready for one object after the other.
#[derive(Debug)]
pub(crate) struct Propagation<'a> {
    tiling: Tiling,
    rays: &'a RaySampler,
    surface: Arc<Surface>,
    sights: Vec<Vec<Sight>>,
    /// Which share of the full effort each question gets.
    share: f64,
    /// Memory that no thread uses now.
    free: Mutex<Vec<Memory>>,
}

/// What was found of one object.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Solved {
    /// The cells from which it is hidden.
    pub(crate) hidden: Vec<Range<u32>>,
    /// Cells that rays found to see it.
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
struct Memory {
    search: FaceSearch,
    /// By cell: whether it may see the object. All others are those from which it is hidden, if they stay so.
    is_visible: Vec<bool>,
    /// By part of a side: whether it was found blocked.
    is_blocked: Vec<bool>,
    waits: Vec<bool>,
    /// By cell: whether it was known before that the object is hidden from it.
    is_known: Vec<bool>,
}

impl<'a> Propagation<'a> {
    /// Shoots the rays of all cells. O(n log n) of triangles, and of cells.
    ///
    /// * `rays`: of which each object is one
    ///
    /// # Errors
    /// [`Cancelled`] by the observer.
    pub(crate) fn new(
        cells: Vec<Aabb<3>>,
        rays: &'a RaySampler,
        surface: Arc<Surface>,
        n_objects: usize,
        observer: Option<&dyn Observer>,
    ) -> Result<Self, Cancelled> {
        let tiling = Tiling::new(cells);
        let sights = sights(&tiling, rays, n_objects, observer)?;
        let n_pairs = tiling.len() as f64 * n_objects as f64;
        Ok(Self {
            tiling,
            rays,
            surface,
            sights,
            share: (FULL_EFFORT_PAIRS / n_pairs).clamp(LEAST_SHARE, 1.0),
            free: Mutex::default(),
        })
    }

    #[cfg(test)]
    pub(super) fn close(&mut self) {
        self.tiling.close();
    }

    fn memory(&self) -> Memory {
        let n = self.tiling.len();
        Memory {
            search: FaceSearch::new(self.surface.clone(), LONGEST_CHAIN),
            is_visible: vec![false; n],
            is_blocked: vec![false; self.tiling.n_parts()],
            waits: vec![false; n],
            is_known: vec![false; n],
        }
    }

    /// Finds from which cells an object is hidden; the same whatever was asked before.
    ///
    /// * `object`: its index, if it is one of the objects that rays find
    /// * `fronts`: whether only the fronts of its triangles are seen
    /// * `known`: cells from which it is hidden, which is not asked again
    pub(crate) fn solve(&self, object: Option<u32>, target: &FaceTarget, fronts: bool, known: &[Range<u32>]) -> Solved {
        let free = || self.free.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = free().pop();
        let mut memory = kept.unwrap_or_else(|| self.memory());
        let solved = self.solve_with(&mut memory, object, target, fronts, known);
        free().push(memory);
        solved
    }

    fn solve_with(
        &self,
        memory: &mut Memory,
        object: Option<u32>,
        target: &FaceTarget,
        fronts: bool,
        known: &[Range<u32>],
    ) -> Solved {
        memory.search.forget();
        [&mut memory.is_visible, &mut memory.is_blocked, &mut memory.is_known]
            .into_iter()
            .for_each(|of| of.fill(false));
        known.iter().for_each(|run| memory.is_known[run.start as usize..run.end as usize].fill(true));
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

fn exit(volume: &Aabb<3>, part: &Part) -> FaceExit {
    let side = usize::from(part.side);
    FaceExit { volume: *volume, axis: side / 2, upward: side % 2 == 1, part: part.bounds }
}

fn meet(a: &Aabb<3>, b: &Aabb<3>) -> bool {
    (0..3).all(|k| a.min[k] <= b.max[k] && b.min[k] <= a.max[k])
}

impl One<'_> {
    fn is_hidden(&self, cell: u32) -> bool {
        !self.memory.is_visible[cell as usize]
    }

    fn is_open(&self, cell: u32) -> bool {
        self.is_hidden(cell) && !self.memory.is_known[cell as usize]
    }

    /// Marks what touches the object, what rays find to see it, and from there on neighbours from which it is seen as well.
    fn see(&mut self) {
        let around = self.target.bounds();
        for (is_visible, b) in self.memory.is_visible.iter_mut().zip(self.of.tiling.boxes()) {
            *is_visible |= meet(b, around);
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

    /// Marks cells from which a point of the box around the object is seen: of what rays do not find, as it stops none.
    fn see_box(&mut self) {
        let (of, around) = (self.of, self.target.bounds());
        let marks = self.memory.is_visible.iter_mut().zip(&self.memory.is_known);
        for ((is_visible, is_known), b) in marks.zip(of.tiling.boxes()) {
            let volume = Volume::new(*b).ok().filter(|_| !*is_visible && !is_known);
            if volume.is_some_and(|volume| of.rays.sees(&volume, around, AIMED as u32)) {
                *is_visible = true;
                self.solved.n_seen += 1;
            }
        }
    }

    fn note(&mut self, sight: Sight, queue: &mut VecDeque<Sight>) {
        if self.is_open(sight.cell) {
            self.memory.is_visible[sight.cell as usize] = true;
            self.solved.n_seen += 1;
            self.changed.push(sight.cell);
            queue.push_back(sight);
        }
    }

    /// Aims from the neighbours of what sees the object at where it does.
    fn follow(&mut self, mut queue: VecDeque<Sight>) {
        let (of, Some(object)) = (self.of, self.object) else { return };
        while let Some(sight) = queue.pop_front() {
            for near in of.tiling.neighbours(sight.cell) {
                if !self.is_open(near) {
                    continue;
                }
                let b = &of.tiling.boxes()[near as usize];
                for _ in 0..AIMED {
                    let origin = self.random.point(b);
                    let way: Point3 = std::array::from_fn(|k| sight.at[k] - origin[k]);
                    let (found, at) = hit(of.rays, origin, way);
                    if found == Some(object) {
                        let mut passed = Vec::new();
                        of.tiling.passed(origin, at, |cell| passed.push(cell));
                        for cell in passed {
                            self.note(Sight { cell, at }, &mut queue);
                        }
                        break;
                    }
                }
            }
        }
    }

    /// Asks about parts of faces until each is blocked, or has a cell behind it from which the object is hidden, or its cell may see the object.
    fn ask_all(&mut self) {
        let tiling = &self.of.tiling;
        let mut queue: VecDeque<u32> = (0..tiling.len() as u32).filter(|&cell| self.is_open(cell)).collect();
        self.memory.waits.fill(false);
        queue.iter().for_each(|&cell| self.memory.waits[cell as usize] = true);
        while let Some(cell) = queue.pop_front() {
            self.memory.waits[cell as usize] = false;
            if !self.is_open(cell) {
                continue;
            }
            self.changed.clear();
            let Err(line) = self.ask(cell) else { continue };
            self.memory.is_visible[cell as usize] = true;
            self.changed.push(cell);
            if let Some(line) = line {
                self.confirm(cell, line);
            }
            // What leaned on them has to be looked at again.
            for k in 0..self.changed.len() {
                for near in tiling.neighbours(self.changed[k]) {
                    if self.is_open(near) && !std::mem::replace(&mut self.memory.waits[near as usize], true) {
                        queue.push_back(near);
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
        self.of.tiling.passed(from, at, |cell| passed.push(cell));
        if !self.of.rays.is_one_way() || is_free_back(self.of.rays, from, behind) {
            self.of.tiling.passed(from, behind, |cell| passed.push(cell));
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

    /// Whether all parts of the sides of a cell that face the object, and have no cell behind them from which it is hidden, are blocked; or else a free
    /// line, if one was found.
    fn ask(&mut self, cell: u32) -> Result<(), Option<[Point3; 2]>> {
        let tiling = &self.of.tiling;
        let b = tiling.boxes()[cell as usize];
        let mut is_first = true;
        for (k, part) in tiling.parts(cell) {
            if self.memory.is_blocked[k] || !self.faces(&b, part) || part.near.is_some_and(|near| self.is_hidden(near))
            {
                continue;
            }
            self.aim_first(cell, &mut is_first)?;
            self.ask_part(&b, part)?;
            self.memory.is_blocked[k] = true;
        }
        Ok(())
    }

    /// Before the first question about a cell: a free line that rays find.
    fn aim_first(&mut self, cell: u32, is_first: &mut bool) -> Result<(), Option<[Point3; 2]>> {
        let free = if std::mem::take(is_first) { self.aim(cell) } else { None };
        free.map_or(Ok(()), |line| Err(Some(line)))
    }

    /// Whether lines to the object may leave a box by a part of a side.
    fn faces(&self, b: &Aabb<3>, part: &Part) -> bool {
        exit(b, part).faces(self.target.bounds())
    }

    fn ask_part(&mut self, volume: &Aabb<3>, part: &Part) -> Result<(), Option<[Point3; 2]>> {
        let exit = exit(volume, part);
        let (target, fronts, corners) = (self.target, self.fronts, part.bounds.corners());
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
        (0..tiling.len() as u32).filter(|&cell| self.is_open(cell)).all(|cell| {
            let b = &tiling.boxes()[cell as usize];
            let mut facing = tiling.parts(cell).filter(|(_, part)| self.faces(b, part));
            let is_covered =
                |(k, part): (usize, &Part)| memory.is_blocked[k] || part.near.is_some_and(|near| self.is_hidden(near));
            !meet(b, self.target.bounds()) && facing.all(is_covered)
        })
    }
}

//! An answer that is updated when walls, doors or objects change, instead of computed anew.
//!
//! The lines that proved the answer are kept with it. When walls change:
//! * a visible pair stays visible unless its line meets a closed rectangle;
//! * a hidden pair stays hidden unless both see, or touch, one opened rectangle: every line that joins them now was
//!   blocked there;
//! * a new cell sees at most what the old cells that it overlaps saw, what opened rectangles reveal, and what lies with
//!   it where no cells were. Uncut lines through it prove part of what it sees.
//!
//! All other pairs are decided as usual, groups first; groups without such pairs are skipped. Lines that are cut are
//! followed once more on both sides of the cut, and lines that ended at a removed wall are followed further; lines that
//! proved what removed cells saw prove much of what the cells in their place see.
//!
//! The answer is that of [`axial_visibility`](super::axial_visibility): both are exact, but for pairs that are given up
//! ([`AxialVisibility::n_assumed`]). Such a pair is decided again with every update, but a pair that was proven to be
//! hidden stays hidden, though a new search, which meets other groups and rectangles, might give it up.

mod change;
mod doubt;
mod matching;

use super::atomic_bits::AtomicBitMatrix;
use super::opaque::Walls;
use super::witness_log::{FoundFor, Line, Proof, WitnessLog, Worker};
use super::{AxialSearch, AxialVisibility, PairsInDoubt, on_threads, slivers};
use crate::search::SearchOptions;
use change::Change;
use matching::{Matching, heirs, same_boxes};
use rayon::prelude::*;
use sightlines_cells::{Axial, CellGraph};
use sightlines_geometry::{Aabb, BoxTree};
use sightlines_progress::{Cancelled, Halt, Observer, Uncancelled};
use sightlines_sightline::{Blockers, ShaftCounters};
use std::cell::Cell;

/// Number of opened rectangles beyond which everything is computed anew: each means a query to all cells.
const MOST_OPENED: usize = 256;

/// The answer for a graph in space, with the data needed to update it.
///
/// Memory beside the answer: about 300 bytes for each line (there are fewer than visible pairs of cells, as a line
/// proves several), twelve bytes for each visible pair, and the walls, plane by plane.
#[derive(Debug, Clone)]
pub struct LiveAxial {
    graph: CellGraph<Axial>,
    objects: Vec<Aabb<3>>,
    seen: AxialVisibility,
    walls: Walls,
    log: WitnessLog,
}

/// The work of an update.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct AxialUpdate {
    /// Whether so much changed that everything was computed anew.
    pub rebuilt: bool,
    /// Cells whose bounds are those of an old cell.
    pub n_cells_kept: usize,
    /// All other cells.
    pub n_cells_new: usize,
    /// Objects whose box no object had before.
    pub n_objects_new: usize,
    /// Rectangles that have become walls.
    pub n_closed: usize,
    /// Rectangles that are no longer walls.
    pub n_opened: usize,
    /// Lines known before.
    pub n_lines: usize,
    /// Those of them that are now cut by a wall.
    pub n_lines_cut: usize,
    /// The work of the decisions. Varies with threads.
    pub counters: ShaftCounters,
}

impl LiveAxial {
    /// Finds which cells of a graph see each other and which objects they see, as [`axial_visibility`](super::axial_visibility)
    /// does, and keeps what an update needs. Arguments, exactness and cost as there, but for walls that hide from one side: here they hide nothing.
    ///
    /// # Errors
    /// [`Cancelled`] by the observer.
    pub fn new(
        graph: CellGraph<Axial>,
        solid: &[Aabb<3>],
        objects: Vec<Aabb<3>>,
        options: &SearchOptions<'_>,
    ) -> Result<Self, Cancelled> {
        let (seen, walls, log) = on_threads(options.threads, |threads| {
            let walls = Walls::of(&graph, solid, &Walls::default());
            let (seen, log) = anew(&graph, &walls, &objects, threads, options)?;
            Ok((seen, walls, log))
        })?;
        Ok(Self { graph, objects, seen, walls, log })
    }

    /// The graph of the answer.
    pub const fn graph(&self) -> &CellGraph<Axial> {
        &self.graph
    }

    /// The answer.
    pub const fn seen(&self) -> &AxialVisibility {
        &self.seen
    }

    /// Number of lines kept.
    pub const fn n_lines(&self) -> usize {
        self.log.lines.len()
    }

    /// Moves to another graph, other solid boxes and other objects; arguments as for [`Self::new`].
    ///
    /// The answer is correct for any arguments; it is found quickly if most cells and objects keep their bounds. Ids of
    /// cells and objects need not be the same.
    ///
    /// The observer receives reports, but cannot cancel an update.
    ///
    /// Cost: O(cells + portals + objects + visible pairs), with small constants, plus the decisions about pairs whose
    /// line is cut, pairs that see the same opened rectangle, and new cells and objects.
    pub fn update(
        &mut self,
        graph: CellGraph<Axial>,
        solid: &[Aabb<3>],
        objects: Vec<Aabb<3>>,
        options: &SearchOptions<'_>,
    ) -> AxialUpdate {
        let log = std::mem::take(&mut self.log);
        // Half an update is no valid state, and the last answer is already gone.
        let observer = options.progress.map(Uncancelled);
        let options =
            SearchOptions { progress: observer.as_ref().map(|observer| observer as &dyn Observer), ..*options };
        let run = |threads| self.updated(log, &graph, solid, &objects, threads, &options);
        let (seen, walls, log, update) = on_threads(options.threads, run).expect("the observer does not cancel");
        *self = Self { graph, objects, seen, walls, log };
        update
    }

    fn updated(
        &self,
        log: WitnessLog,
        graph: &CellGraph<Axial>,
        solid: &[Aabb<3>],
        boxes: &[Aabb<3>],
        threads: usize,
        options: &SearchOptions<'_>,
    ) -> Result<(AxialVisibility, Walls, WitnessLog, AxialUpdate), Cancelled> {
        let walls = Walls::of(graph, solid, &self.walls);
        let same_objects = same_boxes(&self.objects, boxes);
        let cells = self.same_cells(graph);
        let change = change::between(&self.graph, graph, &cells);
        let n_cells_kept = cells.old_of.iter().flatten().count();
        let mut update = AxialUpdate {
            n_cells_kept,
            n_cells_new: graph.n_cells() - n_cells_kept,
            n_objects_new: same_objects.iter().filter(|old| old.is_none()).count(),
            n_closed: change.closed.len(),
            n_opened: change.opened.len(),
            n_lines: log.lines.len(),
            ..AxialUpdate::default()
        };
        if n_cells_kept < graph.n_cells() / 2 || change.opened.len() > MOST_OPENED {
            let (seen, log) = anew(graph, &walls, boxes, threads, options)?;
            (update.rebuilt, update.n_lines_cut, update.counters) = (true, update.n_lines, seen.counters);
            return Ok((seen, walls, log, update));
        }
        let blockers = Blockers::new(walls.rectangles());
        let mut search = AxialSearch::new(graph, boxes, &blockers);
        search.logging = true;
        let step = Step { search: &search, old: self, cells: &cells, heirs: heirs(&same_objects, self.objects.len()) };
        let (doubt, mut kept, n_cut) = step.prepare(log, &change, &same_objects);
        update.n_lines_cut = n_cut;
        search.doubt = Some(doubt);
        let (counters, found) = search.answer(threads, options).map_err(Halt::without_store)?;
        kept.append(found);
        update.counters = counters;
        kept.compact();
        Ok((search.into_seen(counters), walls, kept, update))
    }

    /// The cells that keep their bounds and are not slivers.
    fn same_cells(&self, graph: &CellGraph<Axial>) -> Matching {
        let [old, new] = [&self.graph, graph].map(|g| g.cells().iter().map(|c| c.bounds).collect::<Vec<_>>());
        let [old_slivers, new_slivers] = [&old, &new].map(|extents| slivers::find(extents));
        Matching::of(&same_boxes(&old, &new), old.len())
            .only(|old, new| !old_slivers[old as usize] && !new_slivers[new as usize])
    }
}

fn anew(
    graph: &CellGraph<Axial>,
    walls: &Walls,
    objects: &[Aabb<3>],
    threads: usize,
    options: &SearchOptions<'_>,
) -> Result<(AxialVisibility, WitnessLog), Cancelled> {
    let blockers = Blockers::new(walls.rectangles());
    let mut search = AxialSearch::new(graph, objects, &blockers);
    search.logging = true;
    let (counters, log) = search.answer(threads, options).map_err(Halt::without_store)?;
    Ok((search.into_seen(counters), log))
}

/// Whether the free part of a line may meet any box of a tree: `false` is certain.
fn meets_any(line: &Line, tree: &BoxTree<3>) -> bool {
    let met = Cell::new(false);
    tree.visit(|b| !met.get() && line.span.may_meet(b), |_| met.set(true));
    met.get()
}

/// From one graph to the next.
struct Step<'a> {
    search: &'a AxialSearch<'a>,
    old: &'a LiveAxial,
    cells: &'a Matching,
    /// For each old object the new ones with the same box.
    heirs: Vec<Vec<u32>>,
}

impl Step<'_> {
    /// Marks what old lines still prove; returns the doubtful pairs, the log, and the number of lines cut.
    fn prepare(
        &self,
        mut log: WitnessLog,
        change: &Change,
        same_objects: &[Option<u32>],
    ) -> (PairsInDoubt, WitnessLog, usize) {
        let search = self.search;
        let mut doubt = PairsInDoubt::none(search.cell_at.len(), search.boxes.len());
        let [closed, opened] = [&change.closed, &change.opened].map(|walls| BoxTree::build(walls, 1));
        let new_objects: Vec<u32> =
            (0u32..).zip(same_objects).filter(|(_, old)| old.is_none()).map(|(object, _)| object).collect();
        let new_boxes: Vec<Aabb<3>> = new_objects.iter().map(|&object| search.boxes[object as usize]).collect();
        let new_boxes = BoxTree::build(&new_boxes, 1);
        let kind = |line: &Line| match () {
            () if meets_any(line, &closed) => Kind::Cut,
            () if meets_any(line, &opened) => Kind::Freed,
            () if meets_any(line, &new_boxes) => Kind::Near,
            () => Kind::Away,
        };
        let kinds: Vec<Kind> = log.lines.par_iter().map(kind).collect();
        let of_kind = |wanted: Kind| -> Vec<u32> {
            (0u32..).zip(&kinds).filter(|(_, kind)| **kind == wanted).map(|(line, _)| line).collect()
        };
        let freed: Vec<Line> = of_kind(Kind::Freed).iter().map(|&i| log.lines[i as usize].clone()).collect();
        let near = of_kind(Kind::Near);
        let (cut, number) = log.take_lines(&of_kind(Kind::Cut));
        let mut again = self.carry_over(&mut log, &number, &mut doubt);
        again.extend(near.iter().filter_map(|&line| number[line as usize]));
        again.sort_unstable();
        again.dedup();
        let is_new = self.is_new(&new_objects);
        let more = again.par_iter().map(|&line| search.mark_new(line, &log.lines[line as usize].span, &is_new));
        let more: Vec<[Vec<Proof>; 2]> = more.collect();
        for [cells, objects] in more {
            log.cells.extend(cells);
            log.objects.extend(objects);
        }
        let parts = cut.par_iter().chain(&freed).map_init(
            || search.worker(),
            |worker, line| {
                self.follow_parts(line, worker);
                worker.take_log()
            },
        );
        let found: Vec<WitnessLog> = parts.collect();
        found.into_iter().for_each(|found| log.append(found));
        let candidates = doubt::candidates(search, self.old, self.cells, &change.opened);
        let seers = change
            .opened
            .par_iter()
            .map_init(|| search.worker(), |worker, opened| search.seers(opened, &candidates, worker));
        let seers: Vec<Vec<usize>> = seers.collect();
        for (opened, seers) in change.opened.iter().zip(&seers) {
            doubt.through(opened, seers, search);
        }
        doubt.new_cells(search, self.old, self.cells, &self.heirs);
        new_objects.into_iter().for_each(|object| doubt.new_object(object, search));
        (doubt, log, cut.len())
    }

    /// Which places and objects are new.
    fn is_new(&self, new_objects: &[u32]) -> [Vec<bool>; 2] {
        let search = self.search;
        let cells = search.cell_at.iter().map(|&cell| self.cells.old_of[cell as usize].is_none()).collect();
        let mut objects = vec![false; search.boxes.len()];
        new_objects.iter().for_each(|&object| objects[object as usize] = true);
        [cells, objects]
    }

    /// The place of an old cell that still exists.
    fn place(&self, cell: u32) -> Option<usize> {
        self.search.place_of(self.cells.new_of[cell as usize]?)
    }

    /// Marks the pairs whose lines still exist, by their new numbers, and gives them the new ids; the other pairs are
    /// in doubt. Returns lines that proved pairs of removed cells: they may pass the cells in their place.
    fn carry_over(&self, log: &mut WitnessLog, number: &[Option<u32>], doubt: &mut PairsInDoubt) -> Vec<u32> {
        let PairsInDoubt { cells, objects, rows, .. } = doubt;
        let (of_cells, of_objects) = rayon::join(
            || self.carry_over_cells(&mut log.cells, number, cells),
            || self.carry_over_objects(&mut log.objects, number, objects, rows),
        );
        for pair in log.without_line.drain(..) {
            if let [Some(a), Some(b)] = pair.map(|cell| self.place(cell)) {
                doubt.pair(a, b);
            }
        }
        for [object, cell] in log.objects_without_line.drain(..).chain(log.inside.drain(..)) {
            if let Some(place) = self.place(cell) {
                self.heirs[object as usize].iter().for_each(|&same| doubt.object(same, place));
            }
        }
        [of_cells, of_objects].concat()
    }

    fn carry_over_cells(&self, proofs: &mut Vec<Proof>, number: &[Option<u32>], doubt: &AtomicBitMatrix) -> Vec<u32> {
        let (search, mut again) = (self.search, Vec::new());
        proofs.retain_mut(|proof| {
            let line = number[proof.line as usize];
            let [Some(a), Some(b)] = proof.pair.map(|cell| self.place(cell)) else {
                again.extend(line);
                return false;
            };
            let Some(line) = line else {
                doubt.set(a, b);
                doubt.set(b, a);
                return false;
            };
            search.join(a, b);
            *proof = Proof { pair: [a, b].map(|place| search.cell_at[place]), line };
            true
        });
        again
    }

    fn carry_over_objects(
        &self,
        proofs: &mut Vec<Proof>,
        number: &[Option<u32>],
        doubt: &AtomicBitMatrix,
        rows: &mut [bool],
    ) -> Vec<u32> {
        let (search, mut again, mut more) = (self.search, Vec::new(), Vec::new());
        proofs.retain_mut(|proof| {
            let [object, cell] = proof.pair;
            let line = number[proof.line as usize];
            let (Some(place), [first, others @ ..]) = (self.place(cell), &self.heirs[object as usize][..]) else {
                again.extend(line);
                return false;
            };
            let Some(line) = line else {
                for &same in &self.heirs[object as usize] {
                    doubt.set(same as usize, place);
                }
                rows[place] = true;
                return false;
            };
            let of = |object: u32| Proof { pair: [object, search.cell_at[place]], line };
            search.objects.set(*first as usize, place);
            *proof = of(*first);
            for &other in others {
                search.objects.set(other as usize, place);
                more.push(of(other));
            }
            true
        });
        proofs.append(&mut more);
        again
    }

    /// Follows a line in both directions from cells on it, as far as it is free.
    fn follow_parts(&self, line: &Line, worker: &mut Worker<'_>) {
        let search = self.search;
        let mut left = search.cells_on(&line.span);
        while let Some(&place) = left.first() {
            let bounds = &search.graph.cells()[search.cell_at[place] as usize].bounds;
            let span = line.line.span(bounds, bounds, search.blockers);
            let cells = search.cells_on(&span);
            left.retain(|other| *other != place && !cells.contains(other));
            search.mark(&line.line, span, &cells, FoundFor::Groups, worker);
        }
    }
}

/// What a change means for a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A wall may block it now.
    Cut,
    /// It may continue further now.
    Freed,
    /// It may pass a new object.
    Near,
    /// Nothing.
    Away,
}

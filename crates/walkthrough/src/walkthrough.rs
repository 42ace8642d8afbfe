//! What to draw, frame by frame.

use crate::coarse::CoarseVisibility;
use crate::predict::Path;
use crate::prefetch::{Prefetcher, Prepare};
use sightlines_eye_to_cell::{
    CellSource, Doors, Method, MirrorImage, Scratch, StepBudget, View, VisibleSet, VisibleSubgraph, follow_reflections,
};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, DoorId, DoorRecord, ObjectId, Place, PlaceBuffer, PortalId};
use std::fmt;

/// Parameters of a [`Walkthrough`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WalkOptions {
    /// Maximum size of the prepared subgraphs, in bytes. Those of the eye's cells, of cells with mirrors in view, and
    /// the last one made are kept regardless.
    pub budget: usize,
    /// Number of frames ahead to prepare for, if the eye keeps its current motion.
    pub frames_ahead: u32,
    /// Number of points on the predicted path that are located in each frame.
    pub places_per_frame: u32,
    /// Maximum number of reflections in a row; 0 for no mirrors.
    pub bounces: usize,
    /// Work that the queries of a frame may do together, those in mirrors included; beyond it the exact method's answer is
    /// exact only near the eye, and that of the incident portals farther away, which is never less ([`DrawList::method`]).
    pub steps: StepBudget,
    /// Whether subgraphs are prepared on another thread. Otherwise each frame prepares those that it requests before it
    /// returns: such a frame waits. For measurements that have to be repeatable, and for targets without threads.
    pub has_thread: bool,
}

impl Default for WalkOptions {
    fn default() -> Self {
        Self {
            budget: 64 << 20,
            frames_ahead: 60,
            places_per_frame: 4,
            bounces: 0,
            steps: StepBudget::FRAME,
            has_thread: true,
        }
    }
}

/// How a frame's answer relates to the method's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnswerKind {
    /// It is the answer of [`DrawList::method`], or, where the work of the frame was spent, between that and the answer of the method
    /// that was asked for.
    Full,
    /// Something was not prepared yet: the cells and objects are a superset of the method's, cut by the view where the boxes of cells and
    /// objects are in memory, and as if all doors were open. What is seen in mirrors is incomplete.
    Late,
    /// The eye is outside every cell: draw everything.
    Outside,
}

/// What to draw in a frame.
#[derive(Debug)]
pub struct DrawList<'a> {
    /// The cells and objects.
    pub seen: &'a VisibleSet,
    /// The cells that contain the eye, ascending: several on a border, none outside.
    pub at: &'a [CellId],
    /// How that relates to the method's answer.
    pub answer: AnswerKind,
    /// The method that answered: the one that was asked for, or the coarsest that a query of the frame fell back to, in mirrors
    /// too, as [`WalkOptions::steps`] were spent. The answer is no more than its, and may be less.
    pub method: Method,
    /// What is seen in mirrors, if [`WalkOptions::bounces`] is above 0. Complete only with [`AnswerKind::Full`]; otherwise
    /// anything may be seen in any mirror, listed or not.
    pub images: &'a [MirrorImage],
    /// The cells of the eye, those with mirrors in view, and those on the predicted path: the most urgent first, each
    /// once. For any other data that is prepared for the viewers of a cell.
    pub ahead: &'a [CellId],
}

/// Counters of the work done so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WalkCounters {
    /// Frames.
    pub frames: u64,
    /// Frames without a change since the one before, which reused its answer.
    pub repeated: u64,
    /// Frames with [`AnswerKind::Late`].
    pub late: u64,
    /// Frames with [`AnswerKind::Outside`].
    pub outside: u64,
    /// Frames with a coarser [`DrawList::method`] than was asked for; repeated ones count again.
    pub fell_back: u64,
}

/// Prepares subgraphs from a source.
struct VisibleSubgraphs<S>(S);

impl<S: CellSource<Error: Send + 'static> + Send + 'static> Prepare for VisibleSubgraphs<S> {
    type Prepared = VisibleSubgraph;
    type Error = S::Error;

    fn prepare(&mut self, cell: CellId) -> Result<VisibleSubgraph, S::Error> {
        VisibleSubgraph::prepare(&self.0, cell)
    }

    fn n_bytes(prepared: &VisibleSubgraph) -> usize {
        prepared.n_bytes()
    }
}

/// Follows an eye over frames.
///
/// `R` answers at once (point location, and a superset of what a cell sees). `S` is a source that may be slow; only
/// another thread reads it. Both may be the same table.
///
/// A frame never waits, except without a thread ([`WalkOptions::has_thread`]), and for a block of a large packed table in
/// which the eye is located. If the subgraph of the eye's cell has not arrived yet, the frame gets a superset. Subgraphs of
/// the cells ahead are prepared in advance.
pub struct Walkthrough<R: CoarseVisibility, S: CellSource<Error: Send + 'static> + Send + 'static> {
    resident: R,
    options: WalkOptions,
    subgraphs: Prefetcher<VisibleSubgraphs<S>>,
    path: Path,
    doors: Doors,
    scratch: Scratch,
    seen: VisibleSet,
    images: Vec<MirrorImage>,
    at: Vec<CellId>,
    /// Cells with mirrors in view.
    mirrored: Vec<CellId>,
    /// Cells to come, the most urgent first.
    wishes: Vec<CellId>,
    buffer: PlaceBuffer,
    last: Option<Last>,
    counters: WalkCounters,
    place_error: Option<R::PlaceError>,
}

/// The query of the last answer.
struct Last {
    view: View,
    method: Method,
    answer: AnswerKind,
    /// Who answered.
    by: Method,
    doors_changed: bool,
}

impl<R: CoarseVisibility, S: CellSource<Error: Send + 'static> + Send + 'static> Walkthrough<R, S> {
    /// Starts with nothing prepared.
    pub fn new(resident: R, source: S, options: WalkOptions) -> Self {
        Self {
            resident,
            options,
            subgraphs: prefetcher(source, &options),
            path: Path::default(),
            doors: Doors::all_open(),
            scratch: Scratch::new(),
            seen: VisibleSet::new(),
            images: Vec::new(),
            at: Vec::new(),
            mirrored: Vec::new(),
            wishes: Vec::new(),
            buffer: PlaceBuffer::new(),
            last: None,
            counters: WalkCounters::default(),
            place_error: None,
        }
    }

    /// What an eye sees now, by `method`. Requests the data that it will need next.
    ///
    /// Errs towards visible: see [`AnswerKind`]. Costs as much as the method; nothing, if nothing changed since the last
    /// frame.
    pub fn frame(&mut self, view: &View, method: Method) -> DrawList<'_> {
        self.counters.frames += 1;
        self.subgraphs.poll();
        self.path.follow(view.eye());
        let repeats = |last: &Last| {
            last.answer != AnswerKind::Late && !last.doors_changed && last.method == method && last.view == *view
        };
        let (answer, by) = match &self.last {
            Some(last) if repeats(last) => {
                self.counters.repeated += 1;
                (last.answer, last.by)
            }
            _ => self.look(view, method),
        };
        self.look_ahead();
        match answer {
            AnswerKind::Full => {}
            AnswerKind::Late => self.counters.late += 1,
            AnswerKind::Outside => self.counters.outside += 1,
        }
        self.counters.fell_back += u64::from(by < method);
        DrawList { seen: &self.seen, at: &self.at, answer, method: by, images: &self.images, ahead: &self.wishes }
    }

    fn look(&mut self, view: &View, method: Method) -> (AnswerKind, Method) {
        self.scratch.allow(self.options.steps);
        let mut by = method;
        let (n_cells, n_objects) = (self.resident.n_cells(), self.resident.n_objects());
        self.seen.clear(n_cells, n_objects);
        self.images.clear();
        self.mirrored.clear();
        self.at.clear();
        let mut answer = match self.resident.cells_at(view.eye(), &mut self.buffer) {
            Ok(Place::Inside(cells)) => {
                self.at.extend_from_slice(cells);
                AnswerKind::Full
            }
            Ok(Place::Outside) => AnswerKind::Outside,
            Err(error) => {
                self.place_error = Some(error);
                AnswerKind::Late
            }
        };
        // Where the eye is outside, or cannot be located, nothing is known.
        let is_lost = self.at.is_empty();
        for &cell in &self.at {
            match self.subgraphs.get(cell) {
                Some(subgraph) => {
                    by = by.min(method.look(&subgraph, view, &self.doors, &mut self.scratch, &mut self.seen));
                }
                None => {
                    answer = AnswerKind::Late;
                    let view = (method != Method::CellToCell).then_some(view);
                    coarse(&self.resident, cell, view, &mut self.seen);
                }
            }
        }
        if is_lost {
            self.seen.add_cells((0..n_cells as u32).map(CellId));
            self.seen.add_objects((0..n_objects as u32).map(ObjectId));
        } else if self.options.bounces > 0 {
            let (subgraphs, mirrored) = (&mut self.subgraphs, &mut self.mirrored);
            let subgraph = |cell| {
                if !mirrored.contains(&cell) {
                    mirrored.push(cell);
                }
                subgraphs.get(cell)
            };
            let sizes = [n_cells, n_objects];
            self.images = follow_reflections(
                method,
                &self.seen,
                self.options.bounces,
                &self.doors,
                &mut self.scratch,
                sizes,
                subgraph,
            );
            if self.images.iter().any(|image| image.fell_back) {
                by = by.min(Method::IncidentPortals);
            }
            if self.images.iter().any(|image| !image.complete) {
                answer = AnswerKind::Late;
            }
        }
        match &mut self.last {
            Some(last) => {
                last.view.clone_from(view);
                (last.method, last.answer, last.by, last.doors_changed) = (method, answer, by, false);
            }
            none => *none = Some(Last { view: view.clone(), method, answer, by, doors_changed: false }),
        }
        (answer, by)
    }

    /// Requests the subgraphs of the eye's cells, of cells with mirrors in view, and of the cells ahead.
    fn look_ahead(&mut self) {
        self.wishes.clear();
        self.wishes.extend_from_slice(&self.at);
        self.wishes.extend_from_slice(&self.mirrored);
        self.subgraphs.pin(&self.wishes);
        let n = self.options.places_per_frame;
        // Nearby points are looked up in each frame, those farther ahead in turn.
        let turn = (self.counters.frames % 8) as f64 / 8.0;
        for k in 0..n {
            let share = (f64::from(k) + turn) / f64::from(n);
            let Some(place) = self.path.ahead(share * f64::from(self.options.frames_ahead)) else { break };
            if !self.path.moves() {
                break;
            }
            // Outside there is nothing to prepare; a place that cannot be read will be told when the eye is there.
            if let Ok(Place::Inside(cells)) = self.resident.cells_at(place, &mut self.buffer) {
                self.wishes.extend_from_slice(cells);
            }
        }
        // Each once, at its first position. The list is short.
        let mut k = 0;
        while k < self.wishes.len() {
            if self.wishes[..k].contains(&self.wishes[k]) {
                self.wishes.remove(k);
            } else {
                k += 1;
            }
        }
        self.subgraphs.wish(&self.wishes);
    }

    /// Closes a portal. Returns whether it was open.
    pub fn close(&mut self, portal: PortalId) -> bool {
        let changed = self.doors.close(portal);
        self.note_doors(changed)
    }

    /// Opens a portal. Returns whether it was closed.
    pub fn open(&mut self, portal: PortalId) -> bool {
        let changed = self.doors.open(portal);
        self.note_doors(changed)
    }

    /// Shuts a door, given the doors of the table ([`sightlines_pvs::Table::doors`], or those of a packed table): closes its portals, as
    /// [`Doors::close_door`]. Returns whether it was open.
    pub fn close_door(&mut self, doors: &[DoorRecord], door: DoorId) -> bool {
        let changed = self.doors.close_door(doors, door);
        self.note_doors(changed)
    }

    /// Opens a door. Returns whether it was shut. A portal stays closed while another shut door closes it, or if it was closed by
    /// [`Walkthrough::close`].
    pub fn open_door(&mut self, door: DoorId) -> bool {
        let changed = self.doors.open_door(door);
        self.note_doors(changed)
    }

    fn note_doors(&mut self, changed: bool) -> bool {
        if let Some(last) = &mut self.last {
            last.doors_changed |= changed;
        }
        changed
    }

    /// Switches to another table, for example after a wall was added or removed. Subgraphs and mirrors of the old one
    /// are dropped, and pending results of its thread are ignored; the first frames are [`AnswerKind::Late`], as at the
    /// start. The path of the eye and the counters continue.
    ///
    /// `keep` maps a closed portal of the old table to the same portal of the new one, which stays closed. Portals
    /// mapped to `None` are forgotten, and whatever took their place is open, which errs towards visible. `Some` keeps
    /// the numbers; [`crate::same_portals`] compares corners. Doors that were shut by [`Walkthrough::close_door`] are open, as the new
    /// table may have others: shut them again. O(closed portals), and a new thread.
    ///
    /// Movers follow by [`crate::Movers::replace`], simplified levels by [`crate::LevelPrefetcher::forget`].
    pub fn replace(&mut self, resident: R, source: S, keep: impl Fn(PortalId) -> Option<PortalId>) {
        let mut doors = Doors::all_open();
        self.doors.closed_alone().filter_map(keep).for_each(|portal| {
            doors.close(portal);
        });
        self.doors = doors;
        self.resident = resident;
        self.subgraphs = prefetcher(source, &self.options);
        self.seen.clear(0, 0);
        self.images.clear();
        self.at.clear();
        self.mirrored.clear();
        self.wishes.clear();
        self.last = None;
    }

    /// The part that answers at once.
    pub fn resident(&self) -> &R {
        &self.resident
    }

    /// Which portals are closed.
    pub fn doors(&self) -> &Doors {
        &self.doors
    }

    /// Counters of the work done so far.
    pub fn counters(&self) -> WalkCounters {
        self.counters
    }

    /// Whether everything that the last frame requested is prepared, for callers that prefer to wait, for example
    /// before the first frame.
    pub fn is_idle(&mut self) -> bool {
        self.subgraphs.is_idle()
    }

    /// Takes the last error of preparing a subgraph, with its cell. Until preparing succeeds, frames there are
    /// [`AnswerKind::Late`].
    pub fn take_error(&mut self) -> Option<(CellId, S::Error)> {
        self.subgraphs.take_error()
    }

    /// Takes the last error of locating the eye. Until that succeeds, frames there are [`AnswerKind::Late`], and show everything.
    pub fn take_place_error(&mut self) -> Option<R::PlaceError> {
        self.place_error.take()
    }

    /// Bytes and number of the subgraphs in memory. [`Walkthrough::replace`] resets these, and those of the next method.
    pub fn kept(&self) -> (usize, usize) {
        (self.subgraphs.n_bytes(), self.subgraphs.n_kept())
    }

    /// Numbers of subgraphs prepared so far, and evicted to stay within the budget.
    pub fn prepared(&self) -> (u64, u64) {
        (self.subgraphs.n_made(), self.subgraphs.n_dropped())
    }
}

fn prefetcher<S>(source: S, options: &WalkOptions) -> Prefetcher<VisibleSubgraphs<S>>
where
    S: CellSource<Error: Send + 'static> + Send + 'static,
{
    let maker = VisibleSubgraphs(source);
    match options.has_thread {
        true => Prefetcher::new(maker, options.budget),
        false => Prefetcher::without_thread(maker, options.budget),
    }
}

/// Adds a superset of what a viewer in a cell may see, in a view if there is one: what is known to be out of it is left out.
fn coarse(resident: &impl CoarseVisibility, root: CellId, view: Option<&View>, seen: &mut VisibleSet) {
    let is_in_view = |bounds: Option<Aabb<3>>| match (view, bounds) {
        (Some(view), Some(bounds)) => bounds.is_empty() || view.may_meet(&bounds),
        _ => true,
    };
    resident.coarse(root, &mut |cell| {
        if cell == root || is_in_view(resident.cell_bounds(cell)) {
            seen.add_cell(cell);
        }
    });
    let mut show = |object| {
        if is_in_view(resident.object_bounds(object)) {
            seen.add_object(object);
        }
    };
    if !resident.coarse_objects(root, &mut show) {
        (0..resident.n_objects() as u32).map(ObjectId).for_each(show);
    }
}

impl<R: CoarseVisibility, S: CellSource<Error: Send + 'static> + Send + 'static> fmt::Debug for Walkthrough<R, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Walkthrough")
            .field("options", &self.options)
            .field("counters", &self.counters)
            .finish_non_exhaustive()
    }
}

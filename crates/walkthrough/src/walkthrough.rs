//! Frame by frame: what to draw.

use crate::predict::Path;
use crate::prefetch::{Prefetcher, Prepare};
use crate::resident::Resident;
use sightlines_eye_to_cell::{
    CellSource, Doors, EyeToCell, Image, Method, Outlook, Scratch, Seen, View, follow_reflections,
};
use sightlines_pvs::CellId;
use std::fmt;

/// How to follow a viewer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WalkOptions {
    /// Bytes of prepared outlooks to keep at most. Those of the cells that the eye is in, and of cells with mirrors that it looks
    /// into, are kept whatever they take, and the last one made.
    pub budget: usize,
    /// How many frames ahead to prepare for, if the viewer goes on as he does.
    pub frames_ahead: u32,
    /// Places on the way ahead that are looked up in each frame.
    pub places_per_frame: u32,
    /// Mirrors that a line may meet one after the other; 0 for no mirrors.
    pub bounces: usize,
}

impl Default for WalkOptions {
    fn default() -> Self {
        Self { budget: 64 << 20, frames_ahead: 60, places_per_frame: 4, bounces: 0 }
    }
}

/// Whether a frame's answer is the method's.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Answer {
    /// It is what the method says.
    Full,
    /// Something was not prepared yet: the cells and objects are more than the method says, and never less. What is
    /// seen in mirrors is not all told.
    Late,
    /// The eye is outside every cell: everything.
    Outside,
}

/// What to draw in a frame.
#[derive(Debug)]
pub struct Frame<'a> {
    /// The cells and objects.
    pub seen: &'a Seen,
    /// The cells that the eye is in, ascending: several on a border, none outside.
    pub at: &'a [CellId],
    /// Whether that is the method's answer.
    pub answer: Answer,
    /// What is seen in mirrors, if [`WalkOptions::bounces`] asks for it. All of it with [`Answer::Full`] only: otherwise anything
    /// may be seen in any mirror, listed or not.
    pub images: &'a [Image],
    /// The cells that the eye is in, those with mirrors that it looks into, and those that it will be in if it goes on like this: the
    /// most urgent first, each once. For whatever else is prepared for the viewers of a cell.
    pub ahead: &'a [CellId],
}

/// Counters of the work done so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct WalkCounters {
    /// Frames.
    pub frames: u64,
    /// Frames with nothing changed since the one before: the answer was at hand.
    pub repeated: u64,
    /// Frames with [`Answer::Late`].
    pub late: u64,
    /// Frames with [`Answer::Outside`].
    pub outside: u64,
}

/// Prepares outlooks from a source.
struct Outlooks<S>(S);

impl<S: CellSource<Error: Send + 'static> + Send + 'static> Prepare for Outlooks<S> {
    type Prepared = Outlook;
    type Error = S::Error;

    fn prepare(&mut self, cell: CellId) -> Result<Outlook, S::Error> {
        Outlook::prepare(&self.0, cell)
    }

    fn n_bytes(prepared: &Outlook) -> usize {
        prepared.n_bytes()
    }
}

/// Follows a viewer over frames.
///
/// `R` is what can be asked at once (where a point is, and a superset of what a cell sees); `S` is the source that may be slow,
/// and is read by another thread only. Both may be the same table.
///
/// A frame never waits. If the outlook of the viewer's cell has not come yet, the frame gets a superset; outlooks of
/// the cells ahead are prepared before he is there.
pub struct Walkthrough<R, S: CellSource<Error: Send + 'static> + Send + 'static> {
    resident: R,
    options: WalkOptions,
    outlooks: Prefetcher<Outlooks<S>>,
    path: Path,
    doors: Doors,
    scratch: Scratch,
    seen: Seen,
    images: Vec<Image>,
    at: Vec<CellId>,
    /// Cells with mirrors that are looked into.
    mirrored: Vec<CellId>,
    /// Cells to come, the most urgent first.
    wishes: Vec<CellId>,
    found: Vec<CellId>,
    pending: Vec<u32>,
    last: Option<Last>,
    counters: WalkCounters,
}

/// What the last answer was an answer to.
struct Last {
    view: View,
    method: Method,
    answer: Answer,
    doors_changed: bool,
}

impl<R: Resident, S: CellSource<Error: Send + 'static> + Send + 'static> Walkthrough<R, S> {
    /// Begins with nothing prepared.
    pub fn new(resident: R, source: S, options: WalkOptions) -> Self {
        Self {
            resident,
            options,
            outlooks: Prefetcher::new(Outlooks(source), options.budget),
            path: Path::default(),
            doors: Doors::all_open(),
            scratch: Scratch::new(),
            seen: Seen::new(),
            images: Vec::new(),
            at: Vec::new(),
            mirrored: Vec::new(),
            wishes: Vec::new(),
            found: Vec::new(),
            pending: Vec::new(),
            last: None,
            counters: WalkCounters::default(),
        }
    }

    /// What a viewer sees now, by `method`, and asks for what he will need next.
    ///
    /// Errs towards more: see [`Answer`]. Costs what the method costs; nothing, if nothing changed since the last frame.
    pub fn frame(&mut self, view: &View, method: Method) -> Frame<'_> {
        self.counters.frames += 1;
        self.outlooks.poll();
        self.path.follow(view.eye());
        let repeats = |last: &Last| {
            last.answer != Answer::Late && !last.doors_changed && last.method == method && last.view == *view
        };
        let answer = match &self.last {
            Some(last) if repeats(last) => {
                self.counters.repeated += 1;
                last.answer
            }
            _ => self.look(view, method),
        };
        self.look_ahead();
        match answer {
            Answer::Full => {}
            Answer::Late => self.counters.late += 1,
            Answer::Outside => self.counters.outside += 1,
        }
        Frame { seen: &self.seen, at: &self.at, answer, images: &self.images, ahead: &self.wishes }
    }

    fn look(&mut self, view: &View, method: Method) -> Answer {
        let (n_cells, n_objects) = (self.resident.n_cells(), self.resident.n_objects());
        self.seen.clear(n_cells, n_objects);
        self.images.clear();
        self.mirrored.clear();
        self.resident.locate(view.eye(), &mut self.pending, &mut self.at);
        let mut answer = Answer::Full;
        for &cell in &self.at {
            match self.outlooks.get(cell) {
                Some(outlook) => method.look(&outlook, view, &self.doors, &mut self.scratch, &mut self.seen),
                None => {
                    answer = Answer::Late;
                    coarse(&self.resident, cell, &mut self.seen);
                }
            }
        }
        if self.at.is_empty() {
            answer = Answer::Outside;
            self.seen.add_cells((0..n_cells as u32).map(CellId));
            self.seen.add_objects(0..n_objects as u32);
        } else if self.options.bounces > 0 {
            let (outlooks, mirrored) = (&mut self.outlooks, &mut self.mirrored);
            let outlook = |cell| {
                if !mirrored.contains(&cell) {
                    mirrored.push(cell);
                }
                outlooks.get(cell)
            };
            let sizes = [n_cells, n_objects];
            self.images = follow_reflections(
                &method,
                &self.seen,
                self.options.bounces,
                &self.doors,
                &mut self.scratch,
                sizes,
                outlook,
            );
            if self.images.iter().any(|image| !image.complete) {
                answer = Answer::Late;
            }
        }
        match &mut self.last {
            Some(last) => {
                last.view.clone_from(view);
                (last.method, last.answer, last.doors_changed) = (method, answer, false);
            }
            none => *none = Some(Last { view: view.clone(), method, answer, doors_changed: false }),
        }
        answer
    }

    /// Asks for the outlooks of the viewer's cells, of cells with mirrors that he looks into, and of the cells ahead.
    fn look_ahead(&mut self) {
        self.wishes.clear();
        self.wishes.extend_from_slice(&self.at);
        self.wishes.extend_from_slice(&self.mirrored);
        self.outlooks.pin(&self.wishes);
        let n = self.options.places_per_frame;
        // Places near by come in each frame, those farther ahead in turn.
        let turn = (self.counters.frames % 8) as f64 / 8.0;
        for k in 0..n {
            let share = (f64::from(k) + turn) / f64::from(n);
            let Some(place) = self.path.ahead(share * f64::from(self.options.frames_ahead)) else { break };
            if !self.path.moves() {
                break;
            }
            self.resident.locate(place, &mut self.pending, &mut self.found);
            self.wishes.extend_from_slice(&self.found);
        }
        // Each once, where it comes first. The list is short.
        let mut k = 0;
        while k < self.wishes.len() {
            if self.wishes[..k].contains(&self.wishes[k]) {
                self.wishes.remove(k);
            } else {
                k += 1;
            }
        }
        self.outlooks.wish(&self.wishes);
    }

    /// Closes a portal; whether it was open.
    pub fn close(&mut self, portal: u32) -> bool {
        let changed = self.doors.close(portal);
        self.note_doors(changed)
    }

    /// Opens a portal; whether it was closed.
    pub fn open(&mut self, portal: u32) -> bool {
        let changed = self.doors.open(portal);
        self.note_doors(changed)
    }

    fn note_doors(&mut self, changed: bool) -> bool {
        if let Some(last) = &mut self.last {
            last.doors_changed |= changed;
        }
        changed
    }

    /// Goes on in another table, such as one in which a wall was added or taken away. Outlooks and mirrors of the old one
    /// are dropped, and what its thread still makes is not looked at; the first frames are [`Answer::Late`] as at the beginning. The
    /// viewer's path and the counters go on.
    ///
    /// `keep` says which portal of the new table a closed portal of the old one is; it stays closed. Those that are none (`None`) are forgotten,
    /// and what took their place is open, which errs towards visible. `Some` keeps the numbers; [`crate::same_portals`]
    /// compares corners. O(closed portals), and a new thread.
    ///
    /// Movers follow by [`crate::Movers::replace`], simplified levels by [`crate::Levels::forget`].
    pub fn replace(&mut self, resident: R, source: S, keep: impl Fn(u32) -> Option<u32>) {
        let mut doors = Doors::all_open();
        self.doors.closed().filter_map(keep).for_each(|portal| {
            doors.close(portal);
        });
        self.doors = doors;
        self.resident = resident;
        self.outlooks = Prefetcher::new(Outlooks(source), self.options.budget);
        self.seen.clear(0, 0);
        self.images.clear();
        self.at.clear();
        self.mirrored.clear();
        self.wishes.clear();
        self.last = None;
    }

    /// What can be asked at once.
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

    /// Whether all that the last frame asked for is prepared: for who would rather wait, such as before the first frame.
    pub fn is_idle(&mut self) -> bool {
        self.outlooks.is_idle()
    }

    /// What went wrong last while an outlook was prepared, and of which cell; asking takes it away. Until it goes right,
    /// frames there are [`Answer::Late`].
    pub fn take_error(&mut self) -> Option<(CellId, S::Error)> {
        self.outlooks.take_error()
    }

    /// Bytes of the outlooks that are kept, and their number. Counts anew with [`Walkthrough::replace`], as the next one does.
    pub fn kept(&self) -> (usize, usize) {
        (self.outlooks.n_bytes(), self.outlooks.n_kept())
    }

    /// Outlooks prepared so far, and dropped again to keep to the budget.
    pub fn prepared(&self) -> (u64, u64) {
        (self.outlooks.n_made(), self.outlooks.n_dropped())
    }
}

/// Adds all that a cell may see, and more.
fn coarse(resident: &impl Resident, cell: CellId, seen: &mut Seen) {
    resident.coarse(cell, &mut |cell| {
        seen.add_cell(cell);
    });
    let told = resident.coarse_objects(cell, &mut |object| {
        seen.add_object(object);
    });
    if !told {
        seen.add_objects(0..resident.n_objects() as u32);
    }
}

impl<R, S: CellSource<Error: Send + 'static> + Send + 'static> fmt::Debug for Walkthrough<R, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Walkthrough")
            .field("options", &self.options)
            .field("counters", &self.counters)
            .finish_non_exhaustive()
    }
}

//! Moving objects in a table, by temporal bounding volumes.
//!
//! A mover is asked for its place only while it is seen, or near to what is seen. When it is out of sight, a box is made that it does
//! not leave for a while, and that touches no cell in view; the box is entered into the cells that it touches, and the mover sleeps: it
//! costs nothing until one of these cells comes into view, or its time runs out. The longer it is hidden, the longer the next box holds;
//! when a box came into view for nothing, the next one is smaller.
//!
//! What lies in no cell is solid, as far as a box reaches that is [`MoverOptions::solid_within`]; whatever reaches beyond it may be seen
//! from everywhere, and never sleeps. So a mover that stays in the scene should promise that too ([`Movers::bounds`]): else its volumes
//! grow only until they reach the scene's border, roof or ground.
//!
//! Source: Sudarsky and Gotsman, "Dynamic scene occlusion culling", IEEE TVCG 5(1), 1999: the volumes, and that their time adapts.
//! Ours: cells of a table in place of a tree over the scene; movers that are seen are in no cell at all; a volume is made as long as it
//! can be without touching what is in view; regions that are never left; promises that are checked.

mod expiry;
mod frame;
mod lists;
mod motion;
mod places;
mod report;

pub use motion::{Motion, MotionError};
pub use places::{CellBoxes, Places};
pub use report::{Broken, BrokenPromise, MoverCounters, MoverError, MoverId};

use expiry::Expiries;
use lists::Lists;
use motion::{flat, is_box, is_within};
use sightlines_geometry::Aabb;
use sightlines_pvs::CellId;
use std::fmt;

/// How to keep movers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MoverOptions {
    /// The shortest time for which a volume is made, in the units of [`Movers::frame`]; longer ones are twice, four times, … as long. To make
    /// a volume and enter it costs as much as asking a mover in some fifty frames, so shorter times than these do not pay. If it is not above 0 and
    /// finite, only movers sleep whose region is out of sight.
    pub least: f64,
    /// The longest time; regions that are out of sight hold forever.
    pub most: f64,
    /// The most cells that a volume is entered into; one that touches more is not made.
    pub cells: usize,
    /// Frames for which a mover is out of sight before a volume is made for it, and between tries, so that a view that turns back finds it
    /// awake.
    pub patience: u32,
    /// The most movers for which volumes are tried in a frame; the others stay awake until it is their turn.
    pub tries: usize,
    /// Within this box whatever lies in no cell is solid, so nothing there is seen; beyond it everything may be seen from everywhere.
    /// `None`: the box around all cells. That is right where the cells fill that box but for what is solid, or where walls are all around.
    /// It is not for cells whose border is open to places in no cell: such as the hull of a plan without walls around it.
    pub solid_within: Option<Aabb<3>>,
}

impl Default for MoverOptions {
    /// For times in seconds.
    fn default() -> Self {
        Self { least: 0.5, most: 120.0, cells: 64, patience: 8, tries: 2000, solid_within: None }
    }
}

/// A mover and what is known of it.
#[derive(Debug, Clone)]
struct Mover {
    motion: Motion,
    /// Its box at the time `known_at`.
    bounds: Aabb<3>,
    known_at: f64,
    /// The box was nonsense when it was asked for.
    is_lost: bool,
    /// For how long to make the next volume: `least` times a power of two; the last level is forever.
    level: u8,
    /// Frames since it was seen.
    hidden_for: u32,
    /// The frame in which it was asked last.
    asked_in: u64,
    /// The round in which it was found to be due last.
    due_in: u64,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    /// Asked in each frame; its place among those.
    Awake(u32),
    /// In the cells of its volume.
    Asleep(Aabb<3>),
}

/// A place for a mover.
#[derive(Debug, Clone, Default)]
struct Slot {
    generation: u32,
    mover: Option<Mover>,
}

/// The movers in a table.
///
/// Each frame reports those whose box touches a cell that is seen. As long as the movers keep what their [`Motion`] promises, that is what
/// asking each of them would report; a promise that is broken is noticed when the mover is asked again ([`Movers::broken`]).
///
/// A frame costs, for each mover that is awake, as much as asking for its cells; for each cell in view that has volumes, O(1) and
/// its volumes. Those that are hidden cost only when their time runs out, which is more seldom the longer they are hidden.
pub struct Movers<P> {
    places: P,
    options: MoverOptions,
    /// Number of levels that are not forever.
    n_levels: u8,
    solid_within: Aabb<3>,
    slots: Vec<Slot>,
    free: Vec<u32>,
    n_movers: usize,
    awake: Vec<u32>,
    lists: Lists,
    expiries: Expiries,
    now: f64,
    /// What the last frame reported, and its promises that were broken.
    seen: Vec<MoverId>,
    also: Vec<MoverId>,
    broken: Vec<Broken>,
    /// Movers for which volumes may still be tried in this frame.
    tries_left: usize,
    /// The last frame was outside every cell.
    is_outside: bool,
    due: Vec<(u32, frame::Why)>,
    round: u64,
    /// By cell: the round in which it was marked last.
    marks: Vec<u64>,
    found: Vec<CellId>,
    pending: Vec<u32>,
    counters: MoverCounters,
}

impl<P: Places> Movers<P> {
    /// No movers yet, in the cells of `places`.
    pub fn new(places: P, options: MoverOptions) -> Self {
        let n_cells = places.n_cells();
        let solid_within = options.solid_within.unwrap_or_else(|| places.bounds());
        let steps = std::iter::successors(Some(options.least), |time| Some(2.0 * time));
        let is_time = options.least > 0.0 && options.least.is_finite();
        // A double has some 2000 doublings; 64 are more than any frame rate and game need.
        let n_levels = if is_time { steps.take(64).take_while(|time| *time <= options.most).count() } else { 0 };
        Self {
            options,
            n_levels: n_levels as u8,
            solid_within: flat(solid_within, places.dimension()),
            slots: Vec::new(),
            free: Vec::new(),
            n_movers: 0,
            awake: Vec::new(),
            lists: Lists::new(n_cells),
            expiries: Expiries::default(),
            now: f64::NEG_INFINITY,
            seen: Vec::new(),
            also: Vec::new(),
            broken: Vec::new(),
            tries_left: 0,
            is_outside: false,
            due: Vec::new(),
            round: 0,
            marks: vec![0; n_cells],
            found: Vec::new(),
            pending: Vec::new(),
            counters: MoverCounters::default(),
            places,
        }
    }

    /// Adds a mover whose box is `bounds` (scene units; z is not looked at in a plane) at the time `now`. It is awake at first.
    ///
    /// # Errors
    /// [`MoverError::Box`], [`MoverError::Time`], [`MoverError::TooMany`].
    pub fn add(&mut self, bounds: Aabb<3>, motion: Motion, now: f64) -> Result<MoverId, MoverError> {
        self.check(&bounds, now)?;
        let dimension = self.places.dimension();
        let slot = match self.free.pop() {
            Some(slot) => slot,
            None => {
                let slot = u32::try_from(self.slots.len()).map_err(|_| MoverError::TooMany)?;
                self.slots.push(Slot::default());
                slot
            }
        };
        let place = &mut self.slots[slot as usize];
        let level = if motion.region().is_some() { self.n_levels } else { self.n_levels / 2 };
        place.mover = Some(Mover {
            motion: motion.flat(dimension),
            bounds: flat(bounds, dimension),
            known_at: now,
            is_lost: false,
            level,
            hidden_for: self.options.patience,
            asked_in: 0,
            due_in: 0,
            state: State::Awake(self.awake.len() as u32),
        });
        self.awake.push(slot);
        self.n_movers += 1;
        self.now = self.now.max(now);
        Ok(MoverId { slot, generation: place.generation })
    }

    /// Removes a mover; whether it was there.
    pub fn remove(&mut self, id: MoverId) -> bool {
        if self.get(id).is_none() {
            return false;
        }
        self.rise(id.slot);
        self.leave_awake(id.slot);
        self.n_movers -= 1;
        let place = &mut self.slots[id.slot as usize];
        place.mover = None;
        // A slot whose generations are used up is not used again.
        if let Some(next) = place.generation.checked_add(1) {
            place.generation = next;
            self.free.push(id.slot);
        }
        true
    }

    /// Says that a mover is somewhere else since `now`, whatever was promised: it was teleported, or made anew. It is asked in the next frame.
    /// Whether there is such a mover.
    ///
    /// # Errors
    /// [`MoverError::Box`], [`MoverError::Time`].
    pub fn moved(&mut self, id: MoverId, bounds: Aabb<3>, now: f64) -> Result<bool, MoverError> {
        self.check(&bounds, now)?;
        let bounds = flat(bounds, self.places.dimension());
        let Some(mover) = self.get_mut(id) else { return Ok(false) };
        (mover.bounds, mover.known_at, mover.is_lost) = (bounds, now, false);
        self.rise(id.slot);
        self.now = self.now.max(now);
        Ok(true)
    }

    /// Replaces what is promised about a mover, from the time on when its place was known last ([`Movers::last_known`]). It is asked in the next
    /// frame. Whether there is such a mover.
    pub fn promise(&mut self, id: MoverId, motion: Motion) -> bool {
        let motion = motion.flat(self.places.dimension());
        let Some(mover) = self.get_mut(id) else { return false };
        mover.motion = motion;
        self.rise(id.slot);
        true
    }

    /// Goes on in another table, such as one in which a wall was added or a door cut: all volumes are entered into its cells. Nobody is
    /// asked; who has no place there wakes. Ids stay. What the last frame reported is forgotten. In a table of another dimension nobody has a
    /// known place (it is anywhere) nor a region until he is asked and promises anew, as one of both had no height.
    ///
    /// O(cells + entries of the volumes).
    pub fn replace(&mut self, places: P) {
        let is_other_space = places.dimension() != self.places.dimension();
        self.solid_within = flat(self.options.solid_within.unwrap_or_else(|| places.bounds()), places.dimension());
        self.lists = Lists::new(places.n_cells());
        self.marks = vec![0; places.n_cells()];
        self.places = places;
        self.seen.clear();
        self.also.clear();
        self.broken.clear();
        self.is_outside = false;
        for slot in 0..self.slots.len() as u32 {
            if is_other_space && let Some(mover) = &mut self.slots[slot as usize].mover {
                let everywhere = Aabb { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
                (mover.motion, mover.is_lost, mover.bounds) = (mover.motion.anywhere(), true, everywhere);
            }
            let Some(Mover { state: State::Asleep(volume), .. }) = self.slots[slot as usize].mover else { continue };
            if !is_other_space && is_within(&volume, &self.solid_within) && self.find_cells(&volume, |_| false) {
                self.lists.enter(slot, &self.found);
            } else {
                self.rise(slot);
            }
        }
    }

    /// Where the movers are.
    pub fn places(&self) -> &P {
        &self.places
    }

    /// The box within which whatever lies in no cell is solid, in scene units: [`MoverOptions::solid_within`], or that around all cells. The
    /// region to promise ([`Motion::within`]) for movers that do not leave the scene.
    pub fn bounds(&self) -> Aabb<3> {
        self.solid_within
    }

    /// Number of movers.
    pub fn len(&self) -> usize {
        self.n_movers
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.n_movers == 0
    }

    /// Movers that are asked in the next frame, whatever it sees.
    pub fn n_awake(&self) -> usize {
        self.awake.len()
    }

    /// Pairs of a volume and a cell that it is entered into.
    pub fn n_entries(&self) -> usize {
        self.lists.n_entries()
    }

    /// The box of a mover when its place was known last, and when that was.
    pub fn last_known(&self, id: MoverId) -> Option<(Aabb<3>, f64)> {
        self.get(id).map(|mover| (mover.bounds, mover.known_at))
    }

    /// Whether a mover sleeps, and in which volume.
    pub fn sleeps_in(&self, id: MoverId) -> Option<Aabb<3>> {
        match self.get(id)?.state {
            State::Asleep(volume) => Some(volume),
            State::Awake(_) => None,
        }
    }

    /// Promises that were found broken in the last frame.
    pub fn broken(&self) -> &[Broken] {
        &self.broken
    }

    /// What was done so far.
    pub fn counters(&self) -> MoverCounters {
        self.counters
    }

    fn check(&self, bounds: &Aabb<3>, now: f64) -> Result<(), MoverError> {
        self.check_time(now)?;
        if is_box(&flat(*bounds, self.places.dimension())) { Ok(()) } else { Err(MoverError::Box) }
    }

    fn check_time(&self, now: f64) -> Result<(), MoverError> {
        match now.is_finite() && now >= self.now {
            true => Ok(()),
            false => Err(MoverError::Time { now, last: self.now }),
        }
    }

    fn get(&self, id: MoverId) -> Option<&Mover> {
        let slot = self.slots.get(id.slot as usize)?;
        slot.mover.as_ref().filter(|_| slot.generation == id.generation)
    }

    fn get_mut(&mut self, id: MoverId) -> Option<&mut Mover> {
        let slot = self.slots.get_mut(id.slot as usize)?;
        slot.mover.as_mut().filter(|_| slot.generation == id.generation)
    }

    fn id_of(&self, slot: u32) -> MoverId {
        MoverId { slot, generation: self.slots[slot as usize].generation }
    }

    /// The mover in a slot that is known to have one.
    fn at(&mut self, slot: u32) -> &mut Mover {
        self.slots[slot as usize].mover.as_mut().expect("lists hold only slots with a mover")
    }

    /// Wakes a mover: from now on it is asked in each frame.
    fn rise(&mut self, slot: u32) {
        let place = self.awake.len() as u32;
        let mover = self.at(slot);
        if let State::Asleep(_) = mover.state {
            mover.state = State::Awake(place);
            mover.hidden_for = 0;
            self.awake.push(slot);
            self.lists.leave(slot);
            self.expiries.unset(slot);
        }
    }

    /// Takes a mover that is awake out of the list of these.
    fn leave_awake(&mut self, slot: u32) {
        if let State::Awake(place) = self.at(slot).state {
            self.awake.swap_remove(place as usize);
            if let Some(&moved) = self.awake.get(place as usize) {
                self.at(moved).state = State::Awake(place);
            }
        }
    }

    /// Puts the cells that a box touches into `found`, each once; whether they are few enough, and none of them is refused.
    fn find_cells(&mut self, bounds: &Aabb<3>, refuse: impl Fn(CellId) -> bool) -> bool {
        self.round += 1;
        self.found.clear();
        let (round, marks, found, most) = (self.round, &mut self.marks, &mut self.found, self.options.cells);
        let mut fits = true;
        self.places.touching(bounds, &mut self.pending, &mut |cell| {
            let mark = &mut marks[cell.idx()];
            if *mark != round {
                *mark = round;
                found.push(cell);
                fits = found.len() <= most && !refuse(cell);
            }
            fits
        });
        fits
    }
}

impl<P> fmt::Debug for Movers<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Movers")
            .field("options", &self.options)
            .field("counters", &self.counters)
            .finish_non_exhaustive()
    }
}

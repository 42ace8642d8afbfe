//! Moving objects in a table, by temporal bounding volumes.
//!
//! The position of a mover is queried only while it is visible or nearly so. When it is out of sight, it gets a box
//! that it does not leave for a while and that touches no cell in view. The box is registered in the cells that it
//! touches, and the mover sleeps: it costs nothing until one of these cells comes into view, or the box expires. The
//! longer a mover stays hidden, the longer its next box lasts; if a box came into view but the mover was not visible,
//! the next one is smaller.
//!
//! Within the box [`MoverOptions::solid_within`], space outside every cell is solid; a mover that reaches beyond that
//! box may be visible from everywhere, and never sleeps. So a mover that stays in the scene should promise that
//! ([`Movers::bounds`]); otherwise its volumes grow only until they reach the scene's border, roof or ground.
//!
//! Source: Sudarsky and Gotsman, "Dynamic scene occlusion culling", IEEE TVCG 5(1), 1999: temporal bounding volumes and
//! their adaptive duration. Ours: cells of a table in place of a tree over the scene; visible movers are in no cell at
//! all; a volume lasts as long as possible without touching anything in view; regions that are never left; promises
//! that are checked.

mod expiry;
mod frame;
mod lists;
mod locator;
mod motion;
mod options;
mod report;
mod solid;

pub use locator::{CellBoxes, CellLocator};
pub use motion::{Motion, MotionError};
pub use options::MoverOptions;
pub use report::{Broken, BrokenPromise, MoverCounters, MoverError, MoverId};

use expiry::Expiries;
use lists::Lists;
use motion::{flat, is_box};
use sightlines_geometry::Aabb;
use sightlines_pvs::CellId;
use solid::Solid;
use std::fmt;

/// The state of a mover.
#[derive(Debug, Clone)]
struct Mover {
    motion: Motion,
    /// Its box at the time `known_at`.
    bounds: Aabb<3>,
    known_at: f64,
    /// The last queried box was invalid.
    is_lost: bool,
    /// Duration of the next volume: `least` times a power of two; the last level is forever.
    level: u8,
    /// Frames since it was seen.
    hidden_for: u32,
    /// The frame of its last query.
    asked_in: u64,
    /// The round in which it was last found due.
    due_in: u64,
    state: State,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    /// Queried in each frame; its index in the list of these.
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
/// Each frame reports the movers whose box touches a visible cell. As long as the movers keep the promises of their
/// [`Motion`], the report equals that of querying each of them; a broken promise is noticed at the next query
/// ([`Movers::broken`]).
///
/// A frame costs one search for cells for each awake mover, and O(1) plus its volumes for each cell in view that has
/// volumes. Hidden movers cost only when their volumes expire, which is rarer the longer they stay hidden.
pub struct Movers<P> {
    places: P,
    options: MoverOptions,
    /// Number of levels that are not forever.
    n_levels: u8,
    solid: Solid,
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

impl<P: CellLocator> Movers<P> {
    /// No movers yet, in the cells of `places`.
    pub fn new(places: P, options: MoverOptions) -> Self {
        let n_cells = places.n_cells();
        let steps = std::iter::successors(Some(options.least), |time| Some(2.0 * time));
        let is_time = options.least > 0.0 && options.least.is_finite();
        // A double has some 2000 doublings; 64 are more than any frame rate and game need.
        let n_levels = if is_time { steps.take(64).take_while(|time| *time <= options.most).count() } else { 0 };
        Self {
            options,
            n_levels: n_levels as u8,
            solid: Solid::new(&options, &places),
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

    /// Adds a mover whose box is `bounds` (scene units; z is ignored in the plane) at the time `now`. It starts awake.
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

    /// Removes a mover. Returns whether it existed.
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

    /// Moves a mover at the time `now`, regardless of its promise: it was teleported or respawned. It is queried in the
    /// next frame. Returns whether there is such a mover.
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

    /// Replaces the promise of a mover, starting at the time of its last known position ([`Movers::last_known`]). It is
    /// queried in the next frame. Returns whether there is such a mover.
    pub fn promise(&mut self, id: MoverId, motion: Motion) -> bool {
        let motion = motion.flat(self.places.dimension());
        let Some(mover) = self.get_mut(id) else { return false };
        mover.motion = motion;
        self.rise(id.slot);
        true
    }

    /// Switches to another table, for example after a wall was added or a door cut: all volumes are registered in its
    /// cells. No mover is queried; movers whose volume does not fit there wake. Ids stay valid. The report of the last
    /// frame is cleared. In a table of another dimension a mover has neither a known position (it may be anywhere) nor
    /// a region until it is queried and makes a new promise, because one of the two had no height.
    ///
    /// O(cells + entries of the volumes).
    pub fn replace(&mut self, places: P) {
        let is_other_space = places.dimension() != self.places.dimension();
        self.solid = Solid::new(&self.options, &places);
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
            if !is_other_space && self.solid.encloses(&volume) && self.find_cells(&volume, |_| false) {
                self.lists.enter(slot, &self.found);
            } else {
                self.rise(slot);
            }
        }
    }

    /// The cells in which the movers are registered.
    pub fn places(&self) -> &P {
        &self.places
    }

    /// The box within which space outside every cell is solid, in scene units: [`MoverOptions::solid_within`], or the
    /// box around all cells; empty if they may leave gaps. This is the region to promise ([`Motion::within`]) for movers that do not leave the scene.
    pub fn bounds(&self) -> Aabb<3> {
        self.solid.within()
    }

    /// Number of movers.
    pub fn len(&self) -> usize {
        self.n_movers
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.n_movers == 0
    }

    /// Number of movers that will be queried in the next frame regardless of the view.
    pub fn n_awake(&self) -> usize {
        self.awake.len()
    }

    /// Number of pairs of a volume and a cell in which it is registered.
    pub fn n_entries(&self) -> usize {
        self.lists.n_entries()
    }

    /// The last known box of a mover, and its time.
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

    /// Counters of the work done so far.
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

    /// Wakes a mover: from now on it is queried in each frame.
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

    /// Removes an awake mover from the list of awake ones.
    fn leave_awake(&mut self, slot: u32) {
        if let State::Awake(place) = self.at(slot).state {
            self.awake.swap_remove(place as usize);
            if let Some(&moved) = self.awake.get(place as usize) {
                self.at(moved).state = State::Awake(place);
            }
        }
    }

    /// Collects the cells that a box touches into `found`, each once. Returns whether they are few enough and none is
    /// refused.
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

//! One frame: which movers are queried, which are visible, which may sleep.

use super::motion::{is_box, is_within};
use super::{Broken, BrokenPromise, CellLocator, Mover, MoverError, MoverId, Movers, State, flat};
use crate::walkthrough::{AnswerKind, DrawList};
use sightlines_eye_to_cell::VisibleSet;
use sightlines_geometry::Aabb;
use sightlines_pvs::CellId;

/// Why a mover is queried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Why {
    /// It was awake.
    Awake,
    /// Its volume touches a visible cell.
    Touched,
    /// Its volume expired.
    Expired,
}

impl<P: CellLocator> Movers<P> {
    /// The movers visible at the time `now` (in the time unit of their speeds), by ascending slot: those whose box
    /// touches a visible cell, or reaches beyond [`super::MoverOptions::solid_within`]. `place` returns the current box
    /// of a mover; it is called at most once for each mover, and not for sleeping ones. Outside every cell all movers
    /// are visible, and none is queried.
    ///
    /// Errs towards visible. The frame must belong to the table that the movers are in. With [`AnswerKind::Late`] more
    /// movers are visible, as with everything else. Movers seen in mirrors are not included; see [`Movers::also`].
    ///
    /// Positions are compared with the promise without any slack except for our own rounding: a caller that accumulates
    /// steps should promise slightly more than their sum.
    ///
    /// # Errors
    /// [`MoverError::Time`]; then nothing changes.
    pub fn frame(
        &mut self,
        now: f64,
        frame: &DrawList<'_>,
        place: &mut dyn FnMut(MoverId) -> Aabb<3>,
    ) -> Result<&[MoverId], MoverError> {
        self.check_time(now)?;
        self.now = now;
        self.counters.frames += 1;
        self.broken.clear();
        self.seen.clear();
        self.is_outside = frame.answer == AnswerKind::Outside;
        if self.is_outside {
            let all = (0u32..).zip(&self.slots).filter(|(_, slot)| slot.mover.is_some());
            self.seen.extend(all.map(|(slot, s)| MoverId { slot, generation: s.generation }));
            self.counters.seen += self.seen.len() as u64;
            return Ok(&self.seen);
        }
        self.tries_left = self.options.tries;
        self.find_due(frame.seen);
        let mut due = std::mem::take(&mut self.due);
        for &(slot, why) in &due {
            self.meet(slot, why, frame.seen, place);
        }
        due.clear();
        self.due = due;
        self.seen.sort_unstable();
        self.counters.seen += self.seen.len() as u64;
        Ok(&self.seen)
    }

    /// Collects the movers to query: those whose volume expired or is in view, and those that are awake.
    fn find_due(&mut self, seen: &VisibleSet) {
        self.round += 1;
        let round = self.round;
        self.due.clear();
        self.due.extend(self.awake.iter().map(|&slot| (slot, Why::Awake)));
        while let Some(slot) = self.expiries.pop(self.now) {
            self.at(slot).due_in = round;
            self.due.push((slot, Why::Expired));
            self.counters.expired += 1;
        }
        let slots = &mut self.slots;
        let (lists, due, counters) = (&self.lists, &mut self.due, &mut self.counters);
        let mut look = |cell: u32| {
            counters.cells += 1;
            for slot in lists.of(cell) {
                if let Some(mover) = slots[slot as usize].mover.as_mut().filter(|mover| mover.due_in != round) {
                    mover.due_in = round;
                    counters.touched += 1;
                    due.push((slot, Why::Touched));
                }
            }
        };
        // The smaller set is enumerated.
        if lists.occupied().len() <= seen.cells().len() {
            lists.occupied().iter().filter(|&&cell| seen.has_cell(CellId(cell))).for_each(|&cell| look(cell));
        } else {
            seen.cells().iter().for_each(|&cell| look(cell.0));
        }
    }

    /// Queries a mover, reports it if it is visible, and lets it sleep otherwise.
    fn meet(&mut self, slot: u32, why: Why, seen: &VisibleSet, place: &mut dyn FnMut(MoverId) -> Aabb<3>) {
        let bounds = self.ask(slot, place);
        if bounds.is_none_or(|bounds| self.is_seen(&bounds, |cell| seen.has_cell(cell))) {
            self.rise(slot);
            self.at(slot).hidden_for = 0;
            self.seen.push(self.id_of(slot));
            return;
        }
        let (n_levels, patience) = (self.n_levels, self.options.patience);
        let mover = self.at(slot);
        match why {
            Why::Awake => {
                mover.hidden_for = mover.hidden_for.saturating_add(1);
                if mover.hidden_for <= patience {
                    return;
                }
            }
            Why::Touched => mover.level = mover.level.saturating_sub(1),
            Why::Expired => mover.level = (mover.level + 1).min(n_levels),
        }
        self.counters.in_vain += u64::from(why == Why::Touched);
        self.lay_down(slot, seen);
    }

    /// Lets a hidden mover sleep in the longest volume, from its level downwards, that touches no visible cell; wakes
    /// it if there is none, or if too many were attempted in this frame.
    fn lay_down(&mut self, slot: u32, seen: &VisibleSet) {
        self.rise(slot);
        let Some(tries_left) = self.tries_left.checked_sub(1) else { return };
        self.tries_left = tries_left;
        let &mut Mover { motion, bounds, level, .. } = self.at(slot);
        let dimension = self.places.dimension();
        // Spread over a quarter of the duration, so that movers that fall asleep together do not wake together.
        let share = 1.0 - 0.25 * f64::from(slot.reverse_bits()) / f64::from(u32::MAX);
        let has_times = motion.top_speed().is_some();
        for level in (0..=level).rev() {
            let until = match level == self.n_levels || !has_times {
                true => f64::INFINITY,
                false => self.now + share * self.options.least * 2.0f64.powi(i32::from(level)),
            };
            let Some(volume) = (match until == f64::INFINITY {
                true => motion.region().copied(),
                false => motion.volume(&bounds, self.now, until, dimension),
            }) else {
                continue;
            };
            self.counters.tried += 1;
            if self.solid.encloses(&volume) && self.find_cells(&volume, |cell| seen.has_cell(cell)) {
                self.leave_awake(slot);
                let mover = self.at(slot);
                (mover.state, mover.level) = (State::Asleep(volume), level);
                self.lists.enter(slot, &self.found);
                self.expiries.set(slot, if Some(&volume) == motion.region() { f64::INFINITY } else { until });
                self.counters.entered += 1;
                return;
            }
            if !has_times {
                break;
            }
        }
        let mover = self.at(slot);
        mover.hidden_for = 0;
        if has_times {
            mover.level = 0;
        }
    }

    /// Queries the box of a mover and checks its promise; `None` if it has no box.
    fn ask(&mut self, slot: u32, place: &mut dyn FnMut(MoverId) -> Aabb<3>) -> Option<Aabb<3>> {
        let (id, now, dimension) = (self.id_of(slot), self.now, self.places.dimension());
        let bounds = flat(place(id), dimension);
        let frame = self.counters.frames;
        let mover = self.at(slot);
        let known_at = mover.known_at;
        mover.asked_in = frame;
        mover.is_lost = !is_box(&bounds);
        let broken = if mover.is_lost {
            [Some(BrokenPromise::NoBox), None]
        } else {
            let way = mover.motion.anywhere().volume(&mover.bounds, known_at, now, dimension);
            let is_fast = way.is_some_and(|volume| !is_within(&bounds, &volume));
            let has_left = mover.motion.region().is_some_and(|region| !is_within(&bounds, region));
            (mover.bounds, mover.known_at) = (bounds, now);
            if has_left {
                mover.motion = mover.motion.anywhere();
            }
            [is_fast.then_some(BrokenPromise::Speed), has_left.then_some(BrokenPromise::Region)]
        };
        let is_lost = mover.is_lost;
        self.counters.asked += 1;
        for promise in broken.into_iter().flatten() {
            self.counters.broken += 1;
            self.broken.push(Broken { mover: id, at: now, known_at, promise });
        }
        (!is_lost).then_some(bounds)
    }

    /// Whether a box is visible if these cells are.
    fn is_seen(&mut self, bounds: &Aabb<3>, sees: impl Fn(CellId) -> bool) -> bool {
        let mut hit = !self.solid.encloses(bounds);
        if !hit {
            self.places.touching(bounds, &mut self.pending, &mut |cell| {
                hit = sees(cell);
                !hit
            });
        }
        hit
    }

    /// Whether a box (scene units) that is no mover is visible in a frame, by the same test as for movers.
    pub fn sees(&mut self, frame: &DrawList<'_>, bounds: &Aabb<3>) -> bool {
        let bounds = flat(*bounds, self.places.dimension());
        frame.answer == AnswerKind::Outside
            || !is_box(&bounds)
            || self.is_seen(&bounds, |cell| frame.seen.has_cell(cell))
    }

    /// The movers visible in these cells at the time of the last frame, by ascending slot; for what is seen in a mirror
    /// ([`sightlines_eye_to_cell::MirrorImage::cells`]). Movers queried in this frame are not queried again. None falls
    /// asleep.
    ///
    /// An image that is not complete may show any mover.
    pub fn also(&mut self, cells: &[CellId], place: &mut dyn FnMut(MoverId) -> Aabb<3>) -> &[MoverId] {
        self.also.clear();
        if self.is_outside {
            // Includes movers added since, without those removed.
            let there = (0..).zip(&self.slots).filter(|(_, slot)| slot.mover.is_some());
            self.also.extend(there.map(|(slot, place)| MoverId { slot, generation: place.generation }));
            return &self.also;
        }
        self.round += 1;
        let round = self.round;
        let mut due = std::mem::take(&mut self.due);
        due.extend(self.awake.iter().map(|&slot| (slot, Why::Awake)));
        for cell in cells {
            let Some(mark) = self.marks.get_mut(cell.idx()) else { continue };
            *mark = round;
            for slot in self.lists.of(cell.0) {
                if let Some(mover) = self.slots[slot as usize].mover.as_mut().filter(|mover| mover.due_in != round) {
                    mover.due_in = round;
                    due.push((slot, Why::Touched));
                }
            }
        }
        let marks = std::mem::take(&mut self.marks);
        for &(slot, _) in &due {
            let &mut Mover { asked_in, is_lost, bounds, .. } = self.at(slot);
            let bounds = match asked_in == self.counters.frames {
                true => (!is_lost).then_some(bounds),
                false => {
                    let n_broken = self.broken.len();
                    let bounds = self.ask(slot, place);
                    // The volume is no longer reliable.
                    if self.broken.len() > n_broken {
                        self.rise(slot);
                    }
                    bounds
                }
            };
            if bounds.is_none_or(|bounds| self.is_seen(&bounds, |cell| marks[cell.idx()] == round)) {
                self.also.push(self.id_of(slot));
            }
        }
        self.marks = marks;
        due.clear();
        self.due = due;
        self.also.sort_unstable();
        &self.also
    }
}

//! The incremental form: doors are pushed and undone, and each push counts the method that decided it.

use super::octant::{Decision, FINE, decide};
use super::rows::{
    Line, Octant, Octants, Row, both_directions, box_rows, common_direction, door_rows, octants_through, others,
    reaches,
};
use super::witness::AxialWitness;
use super::{AxialCertificate, AxialVerdict, decide_doors};
use crate::planar::{Funnel, FunnelUndo};
use crate::stabber::Stabber;
use sightlines_geometry::{Aabb, Adaptive, AxialDoor, Point2, Portal2};
use std::convert::Infallible;

/// How many pushes each method decided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct AxialCounters {
    /// Two planar funnels, as all doors faced one axis; or two doors were crossed in opposite directions.
    pub n_planar: u64,
    /// The line of the previous sequence passed the new door too.
    pub n_witness: u64,
    /// The linear program in doubles found a line or a proof, which exact arithmetic confirmed.
    pub n_float: u64,
    /// The linear program in numbers of two doubles, or in fractions.
    pub n_exact: u64,
}

/// The state of the sequence up to one door.
#[derive(Debug, Clone, Copy)]
struct Level {
    /// Octants that are not proven blocked.
    octants: Octants,
    /// Whether all doors so far face one axis, each beyond the one before.
    planar: bool,
    /// A line through all doors so far, if one was found in doubles.
    line: Option<Line>,
}

/// The lines that pass a sequence of axis-aligned doors. See the [module](super).
#[derive(Debug, Clone)]
pub struct AxialStabber {
    doors: Vec<AxialDoor>,
    levels: Vec<Level>,
    /// In the planes of the doors' axis and one other, while the level is planar.
    funnels: [Funnel<Adaptive>; 2],
    funnel_undos: Vec<[FunnelUndo; 2]>,
    counters: AxialCounters,
    rows: Vec<Row>,
    scratch: Vec<Row>,
}

impl Default for AxialStabber {
    fn default() -> Self {
        Self::new()
    }
}

/// How to undo one push: the number of doors before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxialUndo(u32);

/// A door in the plane of its axis, drawn to the right, and another axis.
fn projected(door: &AxialDoor, other: usize) -> Portal2 {
    let point = |x: f64| Point2::new(door.at(), x);
    let portal = Portal2 { left: point(door.extent.max[other]), right: point(door.extent.min[other]) };
    if door.forward { portal } else { portal.reversed() }
}

fn projected_box(bounds: &Aabb<3>, axis: usize, other: usize) -> Aabb<2> {
    Aabb { min: [bounds.min[axis], bounds.min[other]], max: [bounds.max[axis], bounds.max[other]] }
}

/// The octants of a set, the one in which the doors' middles move first.
fn likely_first(octants: Octants, first: &AxialDoor, last: &AxialDoor) -> impl Iterator<Item = Octant> {
    let middle = |door: &AxialDoor, i: usize| door.extent.min[i] + (door.extent.max[i] - door.extent.min[i]) / 2.0;
    let likely = (0..3).map(|i| u8::from(middle(last, i) >= middle(first, i)) << i).sum::<u8>();
    (0..8).map(move |turned| likely ^ turned).filter(move |o| octants >> o & 1 == 1)
}

impl AxialStabber {
    /// A stabber without doors; [`Stabber::start`] it.
    pub fn new() -> Self {
        let funnels = [(); 2].map(|()| Funnel::new(Adaptive));
        let (counters, rows, scratch) = (AxialCounters::default(), Vec::new(), Vec::new());
        Self { doors: Vec::new(), levels: Vec::new(), funnels, funnel_undos: Vec::new(), counters, rows, scratch }
    }

    /// What decided the pushes since this stabber was made.
    pub const fn counters(&self) -> AxialCounters {
        self.counters
    }

    /// The doors of the current sequence.
    pub fn doors(&self) -> &[AxialDoor] {
        &self.doors
    }

    /// A line that passes every door of the sequence. Exact; costs a linear program if none is at hand.
    ///
    /// # Panics
    /// If nothing was started.
    pub fn witness(&mut self) -> AxialWitness {
        let level = *self.levels.last().expect("a sequence was started");
        if let Some(line) = &level.line {
            return AxialWitness::through(line);
        }
        self.search(level.octants, |_| Some(Vec::new()))
            .0
            .map(|(decision, _)| match decision {
                Decision::Line(line) => AxialWitness::through(&line),
                Decision::Fractions(witness) => *witness,
                Decision::Blocked(_) => unreachable!("only open octants are returned"),
            })
            .expect("a line passes the doors that were pushed")
    }

    /// Looks for an octant in which a line passes all doors and obeys the rows of `more`, which is `None`
    /// where none can. Returns the first found, with the octants that are left, and whether fractions
    /// were needed.
    fn search(
        &mut self,
        octants: Octants,
        more: impl Fn(Octant) -> Option<Vec<Row>>,
    ) -> (Option<(Decision, Octants)>, bool) {
        let mut left = octants;
        let mut exact = false;
        let (Some(first), Some(last)) = (self.doors.first(), self.doors.last()) else { return (None, false) };
        for octant in likely_first(octants, first, last) {
            if left >> octant & 1 == 0 {
                continue;
            }
            let Some(extra) = more(octant) else {
                left &= !(1 << octant);
                continue;
            };
            self.rows.clear();
            self.rows.extend(self.doors.iter().flat_map(|door| door_rows(door, octant)));
            self.rows.extend(extra);
            let (decision, fractions) = decide(&self.rows, octant, FINE, &mut self.scratch);
            exact |= fractions;
            let Decision::Blocked(proof) = decision else { return (Some((decision, left)), exact) };
            // A proof without rows about an axis holds for both directions along it.
            left &= !(0..3).filter(|&axis| !proof.speaks_of(&self.rows, axis)).fold(1 << octant, both_directions);
        }
        (None, exact)
    }

    /// Adds a door to two funnels; `None` if it faces another axis or does not lie beyond the last.
    fn push_planar(&mut self, door: &AxialDoor) -> Option<bool> {
        let last = self.doors.last()?;
        let beyond = if door.forward { door.at() > last.at() } else { door.at() < last.at() };
        if door.axis != last.axis || door.forward != last.forward || !beyond {
            return None;
        }
        self.counters.n_planar += 1;
        let [b, c] = others(usize::from(door.axis));
        let Some(first) = self.funnels[0].push(projected(door, b)) else { return Some(false) };
        let Some(second) = self.funnels[1].push(projected(door, c)) else {
            self.funnels[0].undo(first);
            return Some(false);
        };
        self.funnel_undos.push([first, second]);
        Some(true)
    }

    /// Adds a door where funnels do not apply; true if a line passes.
    #[inline(never)]
    fn push_solved(&mut self, door: AxialDoor, octants: Octants) -> bool {
        self.doors.push(door);
        let (found, exact) = self.search(octants, |_| Some(Vec::new()));
        *(if exact { &mut self.counters.n_exact } else { &mut self.counters.n_float }) += 1;
        let Some((decision, octants)) = found else {
            self.doors.pop();
            return false;
        };
        let line = match decision {
            Decision::Line(line) => Some(line),
            Decision::Fractions(witness) => {
                let line = witness.line(&self.doors);
                line.filter(|line| self.doors.iter().all(|door| line.passes(door)))
            }
            Decision::Blocked(_) => None,
        };
        self.levels.push(Level { octants, planar: false, line });
        true
    }

    /// Whether an open set of lines passes the sequence and meets the box beyond its last door, at the
    /// door's plane or later. Exact; costs a linear program or two.
    ///
    /// Walls beyond the last door do not count, so give a box in the cell behind it. A box that is flat
    /// along one axis can be met by an open set of lines; one that is flat along two cannot.
    ///
    /// # Panics
    /// If nothing was started.
    pub fn meets_box(&mut self, bounds: &Aabb<3>) -> bool {
        if !self.may_meet(bounds) {
            return false;
        }
        let level = *self.levels.last().expect("a sequence was started");
        let door = *self.doors.last().expect("a sequence was started");
        if let Some(line) = level.line {
            let octant = (0..3).map(|i| u8::from(line.to[i] > line.from[i]) << i).sum();
            if box_rows(bounds, &door, octant).is_some_and(|rows| rows.iter().all(|row| line.obeys(row, octant))) {
                return true;
            }
        }
        self.search(level.octants, |octant| box_rows(bounds, &door, octant)).0.is_some()
    }
}

impl Stabber for AxialStabber {
    type Portal = AxialDoor;
    type Bounds = Aabb<3>;
    type Undo = AxialUndo;
    type Line = Box<AxialWitness>;
    type Proof = AxialCertificate;
    type Doubt = Infallible;

    fn start(&mut self, door: AxialDoor) {
        self.doors.clear();
        self.levels.clear();
        self.funnel_undos.clear();
        self.doors.push(door);
        self.levels.push(Level { octants: octants_through(&door), planar: true, line: None });
        for (funnel, other) in self.funnels.iter_mut().zip(others(usize::from(door.axis))) {
            funnel.start(projected(&door, other));
        }
    }

    #[inline]
    fn push(&mut self, door: AxialDoor) -> Option<AxialUndo> {
        let level = self.levels.last()?;
        let undo = AxialUndo(self.doors.len() as u32);
        let octants = level.octants & octants_through(&door);
        if let Some(line) = level.line.filter(|line| line.passes(&door)) {
            self.counters.n_witness += 1;
            self.doors.push(door);
            self.levels.push(Level { octants, planar: false, line: Some(line) });
            return Some(undo);
        }
        if octants == 0 {
            self.counters.n_planar += 1;
            return None;
        }
        let planar = if level.planar { self.push_planar(&door) } else { None };
        match planar {
            Some(true) => {
                self.doors.push(door);
                self.levels.push(Level { octants, planar: true, line: None });
                Some(undo)
            }
            Some(false) => None,
            None => self.push_solved(door, octants).then_some(undo),
        }
    }

    #[inline]
    fn undo(&mut self, undo: AxialUndo) {
        debug_assert_eq!(undo.0 as usize + 1, self.doors.len(), "pushes are taken back in stack order");
        self.doors.pop();
        if self.levels.pop().is_some_and(|level| level.planar)
            && let Some([first, second]) = self.funnel_undos.pop()
        {
            self.funnels[0].undo(first);
            self.funnels[1].undo(second);
        }
    }

    /// The box must have a part at the last door's plane or beyond, and along each axis on which all
    /// lines go one way, a part beyond where that door begins; while all doors face one axis, it must
    /// also meet what the funnels leave of two planes.
    #[inline]
    fn may_meet(&self, bounds: &Aabb<3>) -> bool {
        let (Some(door), Some(level)) = (self.doors.last(), self.levels.last()) else { return true };
        let axis = usize::from(door.axis);
        if !reaches(bounds, axis, door.forward, door.at()) {
            return false;
        }
        if level.planar {
            let meets =
                |(funnel, other): (&Funnel<Adaptive>, usize)| funnel.may_meet(&projected_box(bounds, axis, other));
            return self.funnels.iter().zip(others(axis)).all(meets);
        }
        others(axis).into_iter().all(|b| match common_direction(level.octants, b) {
            Some(true) => bounds.max[b] > door.extent.min[b],
            Some(false) => bounds.min[b] < door.extent.max[b],
            None => true,
        })
    }

    fn meets(&mut self, bounds: &Aabb<3>) -> bool {
        self.meets_box(bounds)
    }

    #[inline]
    fn in_front(&self, portal: &AxialDoor, bounds: &Aabb<3>) -> bool {
        let axis = usize::from(portal.axis);
        if portal.forward { bounds.max[axis] > portal.at() } else { bounds.min[axis] < portal.at() }
    }
    /// Costs a linear program if no line is at hand.
    fn line(&mut self) -> Option<Box<AxialWitness>> {
        Some(Box::new(self.witness()))
    }

    /// Exact. At most eight small linear programs.
    fn decide(&mut self, portals: &[AxialDoor]) -> AxialVerdict {
        decide_doors(portals)
    }
}

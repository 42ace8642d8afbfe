//! Lines from one box to another past opaque rectangles: whether there is one, and which.
//!
//! # Method
//! Lazy subtraction. In each octant of directions the lines between two boxes are those that obey a few
//! linear rows (see the [module above](super)). Some line in the middle of them is followed. If it meets
//! nothing, it is the answer. If it meets a rectangle, all lines through that rectangle are blocked, and
//! the others pass it beside one of its four edges, which is one more row each; or they cross its plane
//! before they leave the first box or after they enter the second, which is two. So the lines fall into
//! at most six smaller sets, each a linear program again, and most of them are empty. The effort depends on what stands
//! between the boxes, not on the number of cells that the space between them is cut into.
//!
//! Doubles choose the line and the rectangle. That a set is empty is proven by integer weights, as for
//! doors; that a line is free is checked exactly; so no answer depends on rounding. Where lines pass a slit of a few units
//! in the last place, or miss one by that, the program is solved again in numbers of two doubles.
//!
//! # Ties
//! Rectangles are closed and the boxes' insides are open: a line that only grazes does not count.
//!
//! # Source
//! Haumont, Makinen and Nirenstein, "A low dimensional framework for exact polygon-to-polygon occlusion
//! queries", EGSR 2005, and Mora and Aveneau, for the laziness, in Plücker space; that lines along the
//! axes' octants are linear is the observation of the module above.

mod blockers;
mod certificate;
mod cuts;
mod ray;
mod record;
#[cfg(test)]
mod tests;
mod trace;

pub use super::fine::FineLine;
pub use blockers::Blockers;
pub use certificate::{BlockedProof, Branch, BranchRow, Bypass, Contradiction, ProofSize};
pub use trace::{FreeLine, FreeSpan};

use super::fine::{self, Fine};
use super::octant::{Decision, FINE, SMALL_FIRST, decide_in_doubles, two_axes};
use super::proof::{self, Proof};
use super::rows::{Line, Octant, Row, misses, others, sign};
use super::simplex::{Frame, Tableau};
use super::witness::AxialWitness;
use crate::{LimitReached, Verdict};
use cuts::{BypassRows, Ends};
use ray::Ray;
use sightlines_geometry::{Aabb, AxialDoor};

/// What has to be reached.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BoxTarget {
    /// The inside of the box: a rectangle on its surface is in the way.
    Inside,
    /// The closed box: a rectangle on its surface is not in the way.
    Surface,
}

/// What is between two boxes. [`Verdict::Visible`]: the line, from its first point towards its second, leaves the
/// first box and enters the second without meeting a rectangle; so does an open set of lines. For a proof of
/// [`Verdict::Hidden`] see [`Shaft::certify`].
pub type ShaftVerdict = Verdict<ShaftLine, (), LimitReached>;

/// How queries were decided.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ShaftCounters {
    /// Pairs of boxes decided.
    pub n_asked: u64,
    /// Linear programs solved in doubles.
    pub n_programs: u64,
    /// Linear programs whose margin was within rounding, so that integers had to decide.
    pub n_exact: u64,
    /// Queries that were given up.
    pub n_undecided: u64,
}

impl std::ops::Add for ShaftCounters {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            n_asked: self.n_asked + other.n_asked,
            n_programs: self.n_programs + other.n_programs,
            n_exact: self.n_exact + other.n_exact,
            n_undecided: self.n_undecided + other.n_undecided,
        }
    }
}

impl std::ops::Sub for ShaftCounters {
    type Output = Self;

    /// The difference from `other`, an earlier count.
    fn sub(self, other: Self) -> Self {
        Self {
            n_asked: self.n_asked - other.n_asked,
            n_programs: self.n_programs - other.n_programs,
            n_exact: self.n_exact - other.n_exact,
            n_undecided: self.n_undecided - other.n_undecided,
        }
    }
}

/// Number of rectangles passed on one branch at which the branch is given up.
const DEEPEST: usize = 64;

/// Number of rectangles on a line that are compared, the largest ones.
const COMPARED: usize = 6;

/// A margin of at least this, in the unit box of a program, counts as more than rounding. Only the order of checks
/// depends on it.
const CLEAR_MARGIN: f64 = 1e-9;

/// Decides visibility between boxes among fixed rectangles. Holds scratch memory; use one for each thread.
#[derive(Debug, Clone)]
pub struct Shaft<'a> {
    blockers: &'a Blockers,
    rows: Vec<Row>,
    unit: Vec<Row>,
    hits: Vec<u32>,
    /// Rectangles that the current branch has gone past.
    passed: Vec<u32>,
    scratch: Vec<Row>,
    left: u32,
    counters: ShaftCounters,
}

/// An answer for one octant, or a part of it.
enum Part {
    Open(ShaftLine),
    Blocked,
    Undecided,
}

/// What comes of a ray.
enum Next {
    /// A rectangle is in its way, which the branch has not gone past.
    Past(u32),
    /// It is free.
    Open(ShaftLine),
    /// Rounding spoils that.
    Unknown,
}

/// What a closer look at the current rows found: a ray that rounding may have moved out of them, with the line that it stands
/// for if doubles cannot hold that; or that there are none.
enum Closer {
    Open(Ray, Option<FineLine>),
    Blocked(Proof),
}

/// A line that was checked exactly to lead from one box to another past all rectangles; so does an open set of lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ShaftLine {
    /// Through two points in doubles.
    Free(FreeLine),
    /// Through a slit of about a unit in the last place, which such a line may not pass.
    Fine(FineLine),
}

impl ShaftLine {
    /// The line through two points, if it is one.
    pub const fn free(&self) -> Option<&FreeLine> {
        match self {
            Self::Free(line) => Some(line),
            Self::Fine(_) => None,
        }
    }

    /// Whether it crosses the plane of a door in the door's direction and meets the closed rectangle. Exact.
    pub fn touches(&self, door: &AxialDoor) -> bool {
        match self {
            Self::Free(line) => line.touches(door),
            Self::Fine(line) => line.touches(door),
        }
    }

    /// The same line in fractions.
    pub fn witness(&self) -> AxialWitness {
        match self {
            Self::Free(line) => line.witness(),
            Self::Fine(line) => line.witness(),
        }
    }
}

impl<'a> Shaft<'a> {
    /// A solver among `blockers`.
    pub fn new(blockers: &'a Blockers) -> Self {
        Self {
            blockers,
            rows: Vec::new(),
            unit: Vec::new(),
            hits: Vec::new(),
            passed: Vec::new(),
            scratch: Vec::new(),
            left: 0,
            counters: ShaftCounters::default(),
        }
    }

    /// Counts since this was created.
    pub const fn counters(&self) -> ShaftCounters {
        self.counters
    }

    /// Whether an open set of lines leads from inside of `from` to `to` without meeting a rectangle in
    /// between.
    ///
    /// * `from`, `to`: boxes in scene units. Along some axis they must not overlap (touching is fine). `from` must have
    ///   an inside; `to` may be flat along one axis if the target is its surface.
    /// * `budget`: linear programs after which it gives up; the answer for a budget does not depend on
    ///   anything else.
    ///
    /// Rectangles that hide [from one side](sightlines_geometry::OneWayRectangle) stop only lines that come from their fronts, on the way from `from` to `to`.
    ///
    /// Exact, except for [`Verdict::Undecided`], which errs on neither side. Rectangles inside of the boxes
    /// count only for lines that have to pass them between leaving the first and entering the second.
    pub fn decide(&mut self, from: &Aabb<3>, to: &Aabb<3>, target: BoxTarget, budget: u32) -> ShaftVerdict {
        self.counters.n_asked += 1;
        self.left = budget;
        self.middle_blockers(from, to, target);
        let guesses = std::mem::take(&mut self.hits);
        let mut given_up = false;
        for octant in likely_first(from, to) {
            let ends = Ends { from, to, target, octant };
            if !ends.are_in_order() || guesses.iter().any(|&g| self.covers(&ends, g)) {
                continue;
            }
            self.rows.clear();
            self.rows.extend(ends.rows());
            let frame = Frame::around(&self.rows, octant);
            self.unit.clear();
            self.unit.extend(self.rows.iter().map(|row| frame.scaled(row)));
            self.passed.clear();
            match self.search(&ends, &frame, Tableau::bounded()) {
                Part::Open(line) => return Verdict::Visible(line),
                Part::Blocked => {}
                Part::Undecided => given_up = true,
            }
        }
        if given_up {
            self.counters.n_undecided += 1;
            return Verdict::Undecided(LimitReached);
        }
        Verdict::Hidden(())
    }

    /// Whether an open set of lines leads from the inside of one box to that of the other, in either direction: as [`Self::decide`], and where
    /// rectangles hide from one side and no line leads from `a` to `b`, from `b` to `a` as well.
    pub fn decide_either(&mut self, a: &Aabb<3>, b: &Aabb<3>, budget: u32) -> ShaftVerdict {
        let forth = self.decide(a, b, BoxTarget::Inside, budget);
        if forth.is_hidden() && self.blockers.has_one_way() {
            return self.decide(b, a, BoxTarget::Inside, budget);
        }
        forth
    }

    /// Whether no line between the boxes gets past a rectangle.
    fn covers(&self, ends: &Ends<'_>, rectangle: u32) -> bool {
        if !self.blockers.stops(rectangle, ends.octant) {
            return false;
        }
        let mut ways = 0;
        ends.ways_past(self.blockers.rectangle(rectangle), self.blockers.axis(rectangle), |_| ways += 1);
        ways == 0
    }

    /// What stands between the middles of two boxes.
    fn middle_blockers(&mut self, from: &Aabb<3>, to: &Aabb<3>, target: BoxTarget) -> Option<()> {
        self.hits.clear();
        let middle = |b: &Aabb<3>| [0, 1, 2].map(|k| b.min[k] + (b.max[k] - b.min[k]) / 2.0);
        let (a, mut b) = (middle(from), middle(to));
        for k in 0..3 {
            if a[k] == b[k] {
                // A ray needs a direction along every axis.
                b[k] += (from.max[k] - from.min[k]) / 64.0;
            }
        }
        let line = Line::new(a, b)?;
        let ray = Ray::through(&line)?;
        let times = [ray.span(from)[1], ray.span(to)[0]];
        self.look(&ray, line.octant(), times, target);
        self.hits.sort_by_cached_key(|&i| {
            std::cmp::Reverse((filled(self.blockers.rectangle(i), self.blockers.axis(i), from, to) * 1e6) as u32)
        });
        self.hits.truncate(COMPARED);
        Some(())
    }

    /// Collects the rectangles that stop lines of an octant, and that a ray meets between two times.
    fn look(&mut self, ray: &Ray, octant: Octant, times: [f64; 2], target: BoxTarget) {
        self.hits.clear();
        let hits = &mut self.hits;
        let blockers = self.blockers;
        blockers.met(ray, octant, times, |i| {
            let rectangle = blockers.rectangle(i);
            let axis = blockers.axis(i);
            let at = ray.time(axis, rectangle.min[axis]);
            if target == BoxTarget::Inside || at < times[1] {
                hits.push(i);
            }
        });
    }

    /// A rectangle in the way of a ray that the current branch has not gone past.
    fn ahead(&mut self, ends: &Ends<'_>, ray: &Ray) -> Option<u32> {
        self.look(ray, ends.octant, [ray.span(ends.from)[1], ray.span(ends.to)[0]], ends.target);
        let passed = &self.passed;
        self.hits.retain(|hit| !passed.contains(hit));
        self.best(ends, ray)
    }

    /// The rectangle met that leaves the fewest ways past it, or of those the one that the ray meets
    /// farthest from any of them.
    fn best(&self, ends: &Ends<'_>, ray: &Ray) -> Option<u32> {
        let blockers = self.blockers;
        // The largest come first, and few are looked at.
        let mut largest = [(0.0, u32::MAX); COMPARED];
        for &i in &self.hits {
            let mut new = (filled(blockers.rectangle(i), blockers.axis(i), ends.from, ends.to), i);
            for old in &mut largest {
                if new.0 > old.0 || (new.0 == old.0 && new.1 < old.1) {
                    std::mem::swap(old, &mut new);
                }
            }
        }
        let ways = |i: u32| {
            let (mut ways, mut depth) = (0u32, f64::INFINITY);
            ends.ways_past(blockers.rectangle(i), blockers.axis(i), |way| {
                ways += 1;
                depth = depth.min(lateness(&way, ray));
            });
            (ways, depth)
        };
        let met = largest.into_iter().map(|l| l.1).filter(|&i| i != u32::MAX).map(|i| (ways(i), i));
        met.min_by(|(a, _), (b, _)| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1))).map(|best| best.1)
    }

    /// Searches the lines that obey the current rows.
    fn search(&mut self, ends: &Ends<'_>, frame: &Frame, mut tableau: Tableau) -> Part {
        if self.left == 0 || self.passed.len() > DEEPEST {
            return Part::Undecided;
        }
        self.left -= 1;
        self.counters.n_programs += 1;
        let mut y = tableau.improve(&self.unit);
        if y[5] <= CLEAR_MARGIN {
            if self.is_proven_empty(ends.octant, tableau.support().collect()) {
                return Part::Blocked;
            }
            let mut full = Tableau::new([true; 3]);
            y = full.improve(&self.unit);
            if y[5] <= CLEAR_MARGIN && self.is_proven_empty(ends.octant, full.support().collect()) {
                return Part::Blocked;
            }
        }
        let Some(mut ray) = Ray::new(frame.starts_and_paces(&y)) else { return Part::Undecided };
        let mut fine = None;
        let mut blocker = self.ahead(ends, &ray);
        if blocker.is_none() && y[5] <= CLEAR_MARGIN {
            // No rectangle is left to pass, so it remains to decide whether there are lines at all.
            match self.look_closer(ends.octant, FINE) {
                Some(Closer::Blocked(_)) => return Part::Blocked,
                Some(Closer::Open(found, line)) => (ray, fine) = (found, line),
                None => return Part::Undecided,
            }
            blocker = self.ahead(ends, &ray);
        }
        let next = blocker.map_or_else(|| self.free_line(ends, &ray, fine), Next::Past);
        let blocker = match next {
            Next::Past(blocker) => blocker,
            Next::Open(line) => return Part::Open(line),
            Next::Unknown => return Part::Undecided,
        };
        self.passed.push(blocker);
        let part = self.past(ends, frame, tableau, blocker, &ray);
        self.passed.pop();
        part
    }

    /// Whether weights of rows lead to a proof that no line obeys all current rows.
    fn is_proven_empty(&mut self, octant: Octant, support: Vec<(usize, f64)>) -> bool {
        let proves = |support: &[(usize, f64)], scales: &[f64]| {
            scales.iter().any(|&scale| proof::is_proven_by_cycles(&self.rows, octant, support, scale))
        };
        if proves(&support, FINE) {
            return true;
        }
        // Where two axes are enough, another program finds weights with more slack.
        two_axes(&self.rows, octant, &support, &mut self.scratch).is_some_and(|s| proves(&s, FINE))
            || proves(&support, SMALL_FIRST)
    }

    /// Searches the lines that obey the current rows and go past a rectangle; those ways first that are
    /// nearest to a ray that does not.
    fn past(&mut self, ends: &Ends<'_>, frame: &Frame, tableau: Tableau, blocker: u32, ray: &Ray) -> Part {
        let mut ways: Vec<(f64, BypassRows)> = Vec::with_capacity(6);
        ends.ways_past(self.blockers.rectangle(blocker), self.blockers.axis(blocker), |way| {
            ways.push((lateness(&way, ray), way));
        });
        ways.sort_by(|a, b| a.0.total_cmp(&b.0));
        let n_rows = self.rows.len();
        let mut given_up = false;
        for (_, way) in ways {
            let own = self.rows.len();
            way.rows().iter().for_each(|row| self.push(frame, row));
            let part = if way.rows().iter().any(|row| self.contradicts(row, ends.octant)) {
                Part::Blocked
            } else {
                self.search(ends, frame, tableau)
            };
            self.truncate(own);
            match part {
                Part::Open(_) => {
                    self.truncate(n_rows);
                    return part;
                }
                Part::Blocked => {}
                Part::Undecided => given_up = true,
            }
            if self.left == 0 {
                given_up = true;
                break;
            }
            if let Some(row) = way.complement() {
                self.push(frame, &row);
                if self.contradicts(&row, ends.octant) {
                    break;
                }
            }
        }
        self.truncate(n_rows);
        if given_up { Part::Undecided } else { Part::Blocked }
    }

    /// Whether the rows alone lead from the late end of one of them back to its early end: each row states that one
    /// coordinate is reached before another, and on one axis coordinates are reached in their order. Exact: nothing is
    /// computed.
    fn contradicts(&self, row: &Row, octant: Octant) -> bool {
        // The first coordinate on each axis that is known to be reached after the row's late end.
        let mut after = [f64::INFINITY; 3];
        let along = |axis: usize, x: f64| sign(octant, axis) * x;
        after[row.late] = along(row.late, row.to);
        loop {
            let mut changed = false;
            for r in &self.rows {
                if after[r.early] <= along(r.early, r.from) && along(r.late, r.to) < after[r.late] {
                    after[r.late] = along(r.late, r.to);
                    changed = true;
                }
            }
            if after[row.early] <= along(row.early, row.from) {
                return true;
            }
            if !changed {
                return false;
            }
        }
    }

    fn push(&mut self, frame: &Frame, row: &Row) {
        self.rows.push(*row);
        self.unit.push(frame.scaled(row));
    }

    fn truncate(&mut self, n_rows: usize) {
        self.rows.truncate(n_rows);
        self.unit.truncate(n_rows);
    }

    /// Lines of the current rows where a margin is within rounding, or why there are none; `None` if that is not decided.
    fn look_closer(&mut self, octant: Octant, scales: &[f64]) -> Option<Closer> {
        self.counters.n_exact += 1;
        match decide_in_doubles(&self.rows, octant, scales, &mut self.scratch) {
            Ok(Decision::Blocked(proof)) => return Some(Closer::Blocked(proof)),
            Ok(Decision::Line(line)) => return Some(Closer::Open(Ray::through(&line)?, None)),
            Ok(Decision::Fractions(_)) | Err(_) => {}
        }
        match fine::decide(&self.rows, octant)? {
            Fine::Blocked(proof) => Some(Closer::Blocked(proof)),
            Fine::Open(line) => Some(Closer::Open(Ray::new(line.start_and_pace())?, Some(line))),
        }
    }

    /// What comes of a ray of the current rows on which no rectangle seems to be: a rectangle that it meets nevertheless, or
    /// the line, which was checked exactly to lead from box to box past all rectangles. `fine` is the line that the ray was
    /// rounded from, if it is known.
    fn free_line(&self, ends: &Ends<'_>, ray: &Ray, fine: Option<FineLine>) -> Next {
        let new = |blocker: u32| !self.passed.contains(&blocker);
        match self.rounded_line(ends, ray) {
            Ok(line) => return Next::Open(ShaftLine::Free(line)),
            Err(Some(blocker)) if new(blocker) => return Next::Past(blocker),
            Err(_) => {}
        }
        let fine = fine.or_else(|| match fine::decide(&self.rows, ends.octant)? {
            Fine::Open(line) => Some(line),
            Fine::Blocked(_) => None,
        });
        let Some(line) = fine else { return Next::Unknown };
        let Some(ray) = Ray::new(line.start_and_pace()) else { return Next::Unknown };
        let near = |each: &mut dyn FnMut(u32)| self.blockers.near_rounded(&ray, ends.octant, line.origin(), each);
        match self.first_met(ends, &|row| line.obeys(row), near) {
            None => Next::Open(ShaftLine::Fine(line)),
            Some(blocker) if new(blocker) => Next::Past(blocker),
            Some(_) => Next::Unknown,
        }
    }

    /// A ray as a line through two points that is checked exactly to lead from box to box past all rectangles; else the
    /// rectangle that it touches, if it is that.
    fn rounded_line(&self, ends: &Ends<'_>, ray: &Ray) -> Result<FreeLine, Option<u32>> {
        let ([enter, out], [into, leave]) = (ray.span(ends.from), ray.span(ends.to));
        let middle = |a: f64, b: f64| a + (b - a) / 2.0;
        let at = |t: f64| [0, 1, 2].map(|i| ray.place(i, t));
        let (start, stop) = (at(middle(enter, out)), at(middle(into, leave)));
        let line = Line::new(start, stop).ok_or(None)?;
        let octant = ends.octant;
        let obeys = |row: &Row| line.obeys(row, octant);
        if !line.is_in(octant) || !ends.rows().all(|row| obeys(&row)) {
            return Err(None);
        }
        let free = FreeLine::new(line, octant).ok_or(None)?;
        let times = [free.ray.span(ends.from)[1], free.ray.span(ends.to)[0]];
        match self.first_met(ends, &obeys, |each| self.blockers.near(&free.ray, octant, times, each)) {
            None => Ok(free),
            touched => Err(touched),
        }
    }

    /// The first of some rectangles that a line which passes two boxes meets between them. Exact.
    fn first_met(
        &self,
        ends: &Ends<'_>,
        obeys: &impl Fn(&Row) -> bool,
        candidates: impl FnOnce(&mut dyn FnMut(u32)),
    ) -> Option<u32> {
        let mut met = None;
        candidates(&mut |i| {
            let missed = || misses(self.blockers.rectangle(i), self.blockers.axis(i), ends.octant, obeys);
            if met.is_none() && !missed() && !is_outside(ends, self.blockers, i, obeys) {
                met = Some(i);
            }
        });
        met
    }
}

/// Whether a line that passes two boxes crosses the plane of a rectangle before it leaves the first, or
/// after it enters the second. Exact.
fn is_outside(ends: &Ends<'_>, blockers: &Blockers, index: u32, obeys: &impl Fn(&Row) -> bool) -> bool {
    let mut outside = false;
    ends.ways_past(blockers.rectangle(index), blockers.axis(index), |way| {
        outside |= way.complement().is_none() && way.rows().iter().all(obeys);
    });
    outside
}

/// By how much a ray fails to take a way, in time.
fn lateness(way: &BypassRows, ray: &Ray) -> f64 {
    let late = |row: &Row| ray.time(row.early, row.from) - ray.time(row.late, row.to);
    way.rows().iter().map(late).fold(f64::NEG_INFINITY, f64::max)
}

/// The octants, the one from middle to middle first.
fn likely_first(from: &Aabb<3>, to: &Aabb<3>) -> impl Iterator<Item = Octant> + use<> {
    let likely: u8 = (0..3).map(|i| u8::from(to.min[i] + to.max[i] >= from.min[i] + from.max[i]) << i).sum();
    (0..8).map(move |turned| likely ^ turned)
}

/// About what share of the way between two boxes a rectangle fills, where its plane cuts it.
fn filled(rectangle: &Aabb<3>, axis: usize, from: &Aabb<3>, to: &Aabb<3>) -> f64 {
    let at = rectangle.min[axis];
    let (near, far) = if from.max[axis] <= to.min[axis] {
        (from.max[axis], to.min[axis])
    } else if to.max[axis] <= from.min[axis] {
        (from.min[axis], to.max[axis])
    } else {
        // The plane is beside one of the boxes for many lines.
        let middle = |b: &Aabb<3>| b.min[axis] + (b.max[axis] - b.min[axis]) / 2.0;
        (middle(from), middle(to))
    };
    let along = if far == near { 0.5 } else { ((at - near) / (far - near)).clamp(0.0, 1.0) };
    let between = |a: f64, b: f64| a + (b - a) * along;
    let share = |k: usize| {
        let (low, high) = (between(from.min[k], to.min[k]), between(from.max[k], to.max[k]));
        ((rectangle.max[k].min(high) - rectangle.min[k].max(low)) / (high - low)).max(0.0)
    };
    let [b, c] = others(axis);
    share(b) * share(c)
}

//! The linear program as a stabber, and stabbers that stop when their time is over.

use sightlines::geometry::{Aabb, Adaptive, AxialDoor, Orient2d, Point2, Portal2};
use sightlines::sightline::{LimitReached, Stabber, Verdict};
use sightlines_benches::measure::{CpuClock, Work};
use sightlines_testkit::lp::{self, LpAnswer};
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

/// Each sequence is a linear program from scratch, as the literature puts it.
///
/// The solver works in doubles. What it calls unclear counts as blocked, so this one may err towards hidden, and charts
/// say how often it does.
#[derive(Debug, Clone)]
pub(crate) struct ByProgram<P>(Vec<P>);

impl<P> ByProgram<P> {
    pub(crate) const fn new() -> Self {
        Self(Vec::new())
    }
}

/// A portal that can be a constraint of a linear program.
pub(crate) trait Programmed: Copy + Send + Sync {
    type Bounds;
    fn solve(sequence: &[Self]) -> LpAnswer;
    /// Whether something of `bounds` may lie beyond.
    fn is_before(self, bounds: &Self::Bounds) -> bool;
}

impl Programmed for Portal2 {
    type Bounds = Aabb<2>;

    fn solve(sequence: &[Self]) -> LpAnswer {
        lp::stab(sequence)
    }

    fn is_before(self, b: &Aabb<2>) -> bool {
        let corners = [[b.min[0], b.min[1]], [b.max[0], b.min[1]], [b.max[0], b.max[1]], [b.min[0], b.max[1]]];
        corners.into_iter().any(|[x, y]| Adaptive.orient(self.left, self.right, Point2 { x, y }) > 0.0)
    }
}

impl Programmed for AxialDoor {
    type Bounds = Aabb<3>;

    fn solve(sequence: &[Self]) -> LpAnswer {
        lp::stab_axial(sequence)
    }

    fn is_before(self, b: &Aabb<3>) -> bool {
        let axis = usize::from(self.axis);
        if self.forward { b.max[axis] > self.at() } else { b.min[axis] < self.at() }
    }
}

impl<P: Programmed> Stabber for ByProgram<P> {
    type Portal = P;
    type Bounds = P::Bounds;
    type Undo = ();
    type Line = Infallible;
    type Proof = Infallible;
    type Doubt = LimitReached;

    fn start(&mut self, portal: P) {
        self.0.clear();
        self.0.push(portal);
    }

    fn push(&mut self, portal: P) -> Option<()> {
        self.0.push(portal);
        match P::solve(&self.0) {
            LpAnswer::Open { .. } => Some(()),
            _ => {
                self.0.pop();
                None
            }
        }
    }

    fn undo(&mut self, (): ()) {
        self.0.pop();
    }

    fn may_meet(&self, _: &P::Bounds) -> bool {
        true
    }

    fn in_front(&self, portal: &P, bounds: &P::Bounds) -> bool {
        portal.is_before(bounds)
    }

    /// The program's evidence is in doubles, which is none.
    fn line(&mut self) -> Option<Infallible> {
        None
    }

    fn decide(&mut self, _: &[P]) -> Verdict<Infallible, Infallible, LimitReached> {
        Verdict::Undecided(LimitReached)
    }
}

/// A stabber that lets nothing pass once the process has worked for some time. Then its answer means nothing, which
/// [`is_over`](Self::is_over) says.
#[derive(Debug, Clone)]
pub(crate) struct Limited<S> {
    stabber: S,
    start: CpuClock,
    limit: Duration,
    n_pushes: u64,
    is_over: Arc<AtomicBool>,
}

impl<S: Stabber> Limited<S> {
    pub(crate) fn new(stabber: S, limit: Duration) -> Self {
        Self { stabber, start: CpuClock::start(Work::Process), limit, n_pushes: 0, is_over: Arc::default() }
    }

    /// Of this and all copies.
    pub(crate) fn is_over(&self) -> bool {
        self.is_over.load(Relaxed)
    }
}

impl<S: Stabber> Stabber for Limited<S> {
    type Portal = S::Portal;
    type Bounds = S::Bounds;
    type Undo = S::Undo;
    type Line = S::Line;
    type Proof = S::Proof;
    type Doubt = S::Doubt;

    fn start(&mut self, portal: S::Portal) {
        self.stabber.start(portal);
    }

    fn push(&mut self, portal: S::Portal) -> Option<S::Undo> {
        // Asking for the time costs more than a push.
        if self.n_pushes.is_multiple_of(64) && self.start.is_over(self.limit) {
            self.is_over.store(true, Relaxed);
        }
        self.n_pushes += 1;
        if self.is_over() {
            return None;
        }
        self.stabber.push(portal)
    }

    fn undo(&mut self, undo: S::Undo) {
        self.stabber.undo(undo);
    }

    fn may_meet(&self, bounds: &S::Bounds) -> bool {
        self.stabber.may_meet(bounds)
    }

    fn meets(&mut self, bounds: &S::Bounds) -> bool {
        self.stabber.meets(bounds)
    }

    fn in_front(&self, portal: &S::Portal, bounds: &S::Bounds) -> bool {
        self.stabber.in_front(portal, bounds)
    }

    fn line(&mut self) -> Option<S::Line> {
        self.stabber.line()
    }

    fn decide(&mut self, portals: &[S::Portal]) -> Verdict<S::Line, S::Proof, S::Doubt> {
        self.stabber.decide(portals)
    }
}

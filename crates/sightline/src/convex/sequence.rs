//! The incremental form: convex portals are pushed and undone.

use super::{ConvexCertificate, ConvexStabber, ConvexStabberCounters, ConvexVerdict, Line3, StabLimits};
use crate::stabber::Stabber;
use crate::{LimitReached, Verdict};
use sightlines_geometry::{Aabb, Portal3, orient3d};
use std::borrow::Borrow;

/// The lines that pass a sequence of convex polygons in order. See the [module](super).
///
/// `P` is how portals are held: `&Portal3`, `Arc<Portal3>`, or anything else that is cheap to clone. What is not
/// decided within the limits counts as passable, so this errs towards visible.
#[derive(Debug, Clone)]
pub struct ConvexSequence<P> {
    stabber: ConvexStabber,
    portals: Vec<P>,
    /// For each portal a line through the sequence up to there, if one is known.
    lines: Vec<Option<Line3>>,
    n_undecided: u64,
}

/// How to undo one push: the number of portals before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConvexUndo(u32);

impl<P: Borrow<Portal3> + Clone> ConvexSequence<P> {
    /// A stabber without portals; [`Stabber::start`] it. `limits` are those of each push.
    pub fn new(limits: StabLimits) -> Self {
        Self { stabber: ConvexStabber::new(limits), portals: Vec::new(), lines: Vec::new(), n_undecided: 0 }
    }

    /// The portals of the current sequence.
    pub fn portals(&self) -> &[P] {
        &self.portals
    }

    /// How many pushes counted as passable because they were not decided within the limits.
    pub const fn n_undecided(&self) -> u64 {
        self.n_undecided
    }

    /// Work counts of the solver since this was created.
    pub const fn counters(&self) -> ConvexStabberCounters {
        self.stabber.counters()
    }

    /// Adds a portal for which an earlier push after the same sequence found this line, or none. Costs nothing.
    pub fn push_known(&mut self, portal: P, line: Option<Line3>) -> ConvexUndo {
        let undo = ConvexUndo(self.portals.len() as u32);
        self.portals.push(portal);
        self.lines.push(line);
        undo
    }

    /// Adds a portal, even the first; `None` and no change if no line passes.
    pub fn extend(&mut self, portal: P) -> Option<ConvexUndo> {
        let hint = self.lines.last().copied().flatten();
        let shapes: Vec<&Portal3> = self.portals.iter().chain([&portal]).map(Borrow::borrow).collect();
        let line = match self.stabber.stab(&shapes, hint.as_ref()) {
            Verdict::Visible(line) => Some(line),
            Verdict::Hidden(_) => return None,
            Verdict::Undecided(LimitReached) => {
                self.n_undecided += 1;
                None
            }
        };
        Some(self.push_known(portal, line))
    }

    /// Removes the last portal, even the first; `None` if there is none.
    pub fn pop(&mut self) -> Option<P> {
        self.lines.pop();
        self.portals.pop()
    }

    /// The line of the sequence, if one is known.
    pub fn known_line(&self) -> Option<Line3> {
        self.lines.last().copied().flatten()
    }
}

impl<P: Borrow<Portal3> + Clone + Send> Stabber for ConvexSequence<P> {
    type Portal = P;
    type Bounds = Aabb<3>;
    type Undo = ConvexUndo;
    type Line = Line3;
    type Proof = ConvexCertificate;
    type Doubt = LimitReached;

    fn start(&mut self, portal: P) {
        self.portals.clear();
        self.lines.clear();
        if self.extend(portal.clone()).is_none() {
            // No line passes the portal by itself; then none passes it with others either.
            self.push_known(portal, None);
        }
    }

    /// Costs a few linear programs, unless the line of the previous sequence passes the portal too.
    fn push(&mut self, portal: P) -> Option<ConvexUndo> {
        self.extend(portal)
    }

    fn undo(&mut self, undo: ConvexUndo) {
        debug_assert_eq!(undo.0 as usize + 1, self.portals.len(), "pushes are taken back in stack order");
        self.pop();
    }

    /// The box must have a part in front of the last portal.
    fn may_meet(&self, bounds: &Aabb<3>) -> bool {
        self.portals.last().is_none_or(|portal| reaches_front(portal.borrow(), bounds))
    }

    fn in_front(&self, portal: &P, bounds: &Aabb<3>) -> bool {
        reaches_front(portal.borrow(), bounds)
    }

    fn line(&mut self) -> Option<Line3> {
        self.known_line()
    }

    /// Within the limits of a push; without a hint, so that the answer depends on the portals alone.
    fn decide(&mut self, portals: &[P]) -> ConvexVerdict {
        let shapes: Vec<&Portal3> = portals.iter().map(Borrow::borrow).collect();
        self.stabber.stab(&shapes, None)
    }
}

/// Whether a closed box may have a point in front of a portal. Exact for portals in one plane; of others nothing is
/// left out, as lines that pass them are not bound to one side of any plane.
fn reaches_front(portal: &Portal3, bounds: &Aabb<3>) -> bool {
    let [a, b, c, ref others @ ..] = *portal.corners() else { return true };
    if others.iter().any(|&d| orient3d(a, b, c, d) != 0.0) {
        return true;
    }
    let sides = (0..8).map(|i| {
        let corner = [0, 1, 2].map(|k| if i >> k & 1 == 1 { bounds.max[k] } else { bounds.min[k] });
        orient3d(a, b, c, corner)
    });
    // If the three corners are on one straight line, all sides are 0, which decides nothing.
    let (mut above, mut below) = (false, false);
    sides.for_each(|side| (above, below) = (above || side > 0.0, below || side < 0.0));
    above || !below
}

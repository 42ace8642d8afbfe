//! Stabbers with one fault each. The suite refuses every one of them, or it proves nothing.

use super::Clause;
use crate::{Stabber, Verdict};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

/// What an [`Impostor`] does wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Blocks everything after the third portal.
    GivesUp,
    /// Blocks nothing.
    NeverBlocks,
    /// Does not undo pushes.
    ForgetsUndo,
    /// Restarts with a portal that it blocks.
    LosesItself,
    /// Blocks one push of seven, whichever it is.
    Random,
    /// No box may be met.
    MeetsNothing,
    /// No box is met; some may be.
    ReachesNothing,
    /// No box is in front of a portal.
    NothingInFront,
    /// Gives the line of the first portal.
    OldLine,
    /// Gives no lines.
    NoLine,
    /// Decides without the last portal.
    DecidesTooEarly,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 11] = [
        Self::GivesUp,
        Self::NeverBlocks,
        Self::ForgetsUndo,
        Self::LosesItself,
        Self::Random,
        Self::MeetsNothing,
        Self::ReachesNothing,
        Self::NothingInFront,
        Self::OldLine,
        Self::NoLine,
        Self::DecidesTooEarly,
    ];

    /// The clause that it breaks, of an exact stabber.
    pub const fn clause(self) -> Clause {
        match self {
            Self::GivesUp => Clause::Conservative,
            Self::NeverBlocks => Clause::Tight,
            Self::ForgetsUndo | Self::LosesItself => Clause::Undone,
            Self::Random => Clause::Repeatable,
            Self::MeetsNothing | Self::ReachesNothing | Self::NothingInFront => Clause::Reaching,
            Self::OldLine | Self::NoLine => Clause::Lines,
            Self::DecidesTooEarly => Clause::Evidence,
        }
    }
}

/// A stabber with a fault.
#[derive(Debug, Clone)]
pub struct Impostor<S: Stabber> {
    stabber: S,
    fault: Fault,
    first: Option<S::Portal>,
    n_portals: usize,
    /// Shared by clones, so that they do not answer alike.
    n_pushes: Arc<AtomicU32>,
}

/// How to take back a push that may have had no effect.
#[derive(Debug, Clone, Copy)]
pub struct ImpostorUndo<U>(Option<U>);

impl<S: Stabber> Impostor<S> {
    /// A faultless stabber except for this fault.
    pub fn new(stabber: S, fault: Fault) -> Self {
        Self { stabber, fault, first: None, n_portals: 0, n_pushes: Arc::default() }
    }
}

impl<S: Stabber> Stabber for Impostor<S>
where
    S::Portal: Send,
{
    type Portal = S::Portal;
    type Bounds = S::Bounds;
    type Undo = ImpostorUndo<S::Undo>;
    type Line = S::Line;
    type Proof = S::Proof;
    type Doubt = S::Doubt;

    fn start(&mut self, portal: S::Portal) {
        (self.first, self.n_portals) = (Some(portal.clone()), 1);
        self.stabber.start(portal);
    }

    fn push(&mut self, portal: S::Portal) -> Option<Self::Undo> {
        if self.fault == Fault::GivesUp && self.n_portals >= 3 {
            return None;
        }
        let n_pushes = self.n_pushes.fetch_add(1, Relaxed);
        if self.fault == Fault::Random && n_pushes % 7 == 6 {
            return None;
        }
        let undo = self.stabber.push(portal.clone());
        match self.fault {
            Fault::NeverBlocks => {}
            Fault::LosesItself if undo.is_none() => {
                self.stabber.start(portal);
                return None;
            }
            _ if undo.is_none() => return None,
            _ => {}
        }
        self.n_portals += 1;
        Some(ImpostorUndo(undo))
    }

    fn undo(&mut self, ImpostorUndo(undo): Self::Undo) {
        if self.fault == Fault::ForgetsUndo {
            return;
        }
        self.n_portals -= 1;
        undo.into_iter().for_each(|undo| self.stabber.undo(undo));
    }

    fn may_meet(&self, bounds: &S::Bounds) -> bool {
        self.fault != Fault::MeetsNothing && self.stabber.may_meet(bounds)
    }

    fn meets(&mut self, bounds: &S::Bounds) -> bool {
        self.fault != Fault::ReachesNothing && self.stabber.meets(bounds)
    }

    fn in_front(&self, portal: &S::Portal, bounds: &S::Bounds) -> bool {
        self.fault != Fault::NothingInFront && self.stabber.in_front(portal, bounds)
    }

    fn line(&mut self) -> Option<S::Line> {
        match (self.fault, &self.first) {
            (Fault::NoLine, _) => None,
            (Fault::OldLine, Some(first)) => {
                let mut early = self.stabber.clone();
                early.start(first.clone());
                early.line()
            }
            _ => self.stabber.line(),
        }
    }

    fn decide(&mut self, portals: &[S::Portal]) -> Verdict<S::Line, S::Proof, S::Doubt> {
        match (self.fault, portals) {
            (Fault::DecidesTooEarly, [before @ .., _]) if !before.is_empty() => self.stabber.decide(before),
            _ => self.stabber.decide(portals),
        }
    }
}

//! Stabbers with one fault each.

use crate::conformance::Impostor;
use sightlines_sightline::{Stabber, Verdict};

faults! {
    /// What a wrong stabber does.
    StabberFault {
        /// Blocks everything after the third portal.
        GivesUp breaks Conservative,
        /// Blocks nothing.
        NeverBlocks breaks Tight,
        /// Does not undo pushes.
        ForgetsUndo breaks Undone,
        /// Restarts with a portal that it blocks.
        LosesItself breaks Undone,
        /// Blocks one push of seven, whichever it is.
        Random breaks Repeatable,
        /// No box may be met.
        MeetsNothing breaks Reaching,
        /// No box is met; some may be.
        ReachesNothing breaks Reaching,
        /// No box is in front of a portal.
        NothingInFront breaks Reaching,
        /// Gives the line of the first portal.
        OldLine breaks Lines,
        /// Gives no lines.
        NoLine breaks Lines,
        /// Decides without the last portal.
        DecidesTooEarly breaks Evidence,
    }
}

/// Notes the portals of its sequence.
impl<S: Stabber> Stabber for Impostor<S, StabberFault, Vec<S::Portal>>
where
    S::Portal: Send,
{
    type Portal = S::Portal;
    type Bounds = S::Bounds;
    /// A push may have had no effect.
    type Undo = Option<S::Undo>;
    type Line = S::Line;
    type Proof = S::Proof;
    type Doubt = S::Doubt;

    fn start(&mut self, portal: S::Portal) {
        self.memory = vec![portal.clone()];
        self.inner.start(portal);
    }

    fn push(&mut self, portal: S::Portal) -> Option<Self::Undo> {
        if self.fault == StabberFault::GivesUp && self.memory.len() >= 3 {
            return None;
        }
        let n_pushes = self.call();
        if self.fault == StabberFault::Random && n_pushes % 7 == 6 {
            return None;
        }
        let undo = self.inner.push(portal.clone());
        if undo.is_none() && self.fault != StabberFault::NeverBlocks {
            if self.fault == StabberFault::LosesItself {
                self.inner.start(portal);
            }
            return None;
        }
        self.memory.push(portal);
        Some(undo)
    }

    fn undo(&mut self, undo: Self::Undo) {
        if self.fault != StabberFault::ForgetsUndo {
            self.memory.pop();
            undo.into_iter().for_each(|undo| self.inner.undo(undo));
        }
    }

    fn may_meet(&self, bounds: &S::Bounds) -> bool {
        self.fault != StabberFault::MeetsNothing && self.inner.may_meet(bounds)
    }

    fn meets(&mut self, bounds: &S::Bounds) -> bool {
        self.fault != StabberFault::ReachesNothing && self.inner.meets(bounds)
    }

    fn in_front(&self, portal: &S::Portal, bounds: &S::Bounds) -> bool {
        self.fault != StabberFault::NothingInFront && self.inner.in_front(portal, bounds)
    }

    fn line(&mut self) -> Option<S::Line> {
        match (self.fault, self.memory.first()) {
            (StabberFault::NoLine, _) => None,
            (StabberFault::OldLine, Some(first)) => {
                let mut early = self.inner.clone();
                early.start(first.clone());
                early.line()
            }
            _ => self.inner.line(),
        }
    }

    fn decide(&mut self, portals: &[S::Portal]) -> Verdict<S::Line, S::Proof, S::Doubt> {
        match (self.fault, portals) {
            (StabberFault::DecidesTooEarly, [before @ .., _]) if !before.is_empty() => self.inner.decide(before),
            _ => self.inner.decide(portals),
        }
    }
}

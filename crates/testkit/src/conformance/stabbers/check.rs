//! The walk through a sequence, and what is compared on the way.

use super::{Case, Cases, Clause, Report, Stabbers, Violation};
use sightlines_sightline::{Proof, Stabber, Verdict, Witness};
use std::fmt::Display;
use std::slice::from_ref;

pub(super) struct Walk<'a, S: Stabber, R, C> {
    stabber: &'a S,
    suite: &'a Stabbers<R, C>,
    reference: R,
    report: &'a mut Report,
    round: u32,
    /// The latest proof of the stabber.
    proof: Option<S::Proof>,
}

fn passes<P>(line: &impl Witness<P>, portals: &[P]) -> bool {
    portals.iter().all(|portal| line.passes(portal))
}

impl<'a, S, R, C> Walk<'a, S, R, C>
where
    C: Cases<Portal = S::Portal, Bounds = S::Bounds>,
    S: Stabber,
    R: Stabber<Portal = S::Portal, Bounds = S::Bounds>,
{
    pub(super) fn new(stabber: &'a S, suite: &'a Stabbers<R, C>, report: &'a mut Report) -> Self {
        Self { stabber, suite, reference: suite.reference.clone(), report, round: 0, proof: None }
    }

    fn broken(&self, clause: Clause, n_portals: usize, expected: impl Display, found: &str) -> Violation {
        let case = format!("sequence {} of seed {}, {n_portals} portals", self.round, self.suite.seed);
        self.report.broken(clause, case, expected, found)
    }

    fn not_undone(&self, n_portals: usize) -> Violation {
        self.broken(Clause::Undone, n_portals, "the answer of a new stabber", "another one after undoing")
    }

    /// Whether lines pass, from evidence that was evaluated; `None` without evidence.
    fn truth(&mut self, portals: &[S::Portal]) -> Option<bool> {
        match self.reference.decide(portals) {
            Verdict::Visible(line) if passes(&line, portals) => Some(true),
            Verdict::Hidden(proof) if proof.holds(portals) => Some(false),
            _ => None,
        }
    }

    /// Walks one sequence.
    pub(super) fn sequence(&mut self, round: u32, case: &Case<S::Portal, S::Bounds>) -> Result<(), Violation> {
        self.round = round;
        self.report.count("sequences", 1);
        let Some((first, rest)) = case.portals.split_first() else { return Ok(()) };
        let mut walked = self.stabber.clone();
        walked.start(first.clone());
        let mut passed = vec![first.clone()];
        self.line(&mut walked, &passed)?;
        for (k, portal) in rest.iter().enumerate() {
            let tried = [&passed[..], from_ref(portal)].concat();
            let truth = self.truth(&tried);
            let is_open = self.push(&mut walked, &passed, portal)?;
            self.compare(&tried, truth, is_open)?;
            self.decision(&tried, truth)?;
            if is_open {
                passed = tried;
                if truth == Some(true) {
                    self.line(&mut walked, &passed)?;
                }
                // As long as the spine passes, it meets what lies on it.
                if case.has_spine && passed.len() == k + 2 {
                    self.boxes(&mut walked, &passed, &case.beyond[k + 1])?;
                }
            }
        }
        Ok(())
    }

    /// Whether the portal can be pushed. Something else is pushed first and undone; then the portal twice, with an undo
    /// between if it is open; and once by another stabber that was given only the sequence.
    fn push(&mut self, walked: &mut S, passed: &[S::Portal], portal: &S::Portal) -> Result<bool, Violation> {
        let half = walked.push(self.suite.cases.half(portal));
        half.into_iter().for_each(|undo| walked.undo(undo));
        let once = walked.push(portal.clone());
        let is_open = once.is_some();
        once.into_iter().for_each(|undo| walked.undo(undo));
        let again = walked.push(portal.clone());
        self.report.count("answers after undoing", 2);
        if again.is_some() != is_open || self.pushed(passed, portal) != Some(is_open) {
            return Err(self.why_other(passed, portal));
        }
        Ok(is_open)
    }

    /// Compares with the truth.
    fn compare(&mut self, tried: &[S::Portal], truth: Option<bool>, is_open: bool) -> Result<(), Violation> {
        match truth {
            Some(true) if !is_open => {
                return Err(self.broken(Clause::Conservative, tried.len(), "a line passes", "the last is blocked"));
            }
            Some(true) => self.report.count("open sequences", 1),
            Some(false) => {
                self.report.count("blocked sequences", 1);
                self.report.count("blocked sequences found", usize::from(!is_open));
            }
            None => self.report.count("sequences without evidence", 1),
        }
        Ok(())
    }

    /// Whether a new stabber passes a portal after some others; `None` if one of the others blocks.
    fn pushed(&self, before: &[S::Portal], portal: &S::Portal) -> Option<bool> {
        Some(self.walked(before)?.push(portal.clone()).is_some())
    }

    /// A new stabber that was given only these portals.
    fn walked(&self, portals: &[S::Portal]) -> Option<S> {
        let mut stabber = self.stabber.clone();
        let (first, rest) = portals.split_first()?;
        stabber.start(first.clone());
        rest.iter().try_for_each(|portal| stabber.push(portal.clone()).map(drop))?;
        Some(stabber)
    }

    /// Answers differ: because of an undo, or even without one.
    fn why_other(&self, before: &[S::Portal], portal: &S::Portal) -> Violation {
        let n_portals = before.len() + 1;
        let answers: Vec<Option<bool>> = (0..8).map(|_| self.pushed(before, portal)).collect();
        if answers.iter().any(|answer| *answer != answers[0]) || answers[0].is_none() {
            self.broken(Clause::Repeatable, n_portals, "one answer for the last", "two")
        } else {
            self.not_undone(n_portals)
        }
    }

    /// Evaluates the line of a sequence that is open in truth.
    fn line(&mut self, stabber: &mut S, portals: &[S::Portal]) -> Result<(), Violation> {
        let line = stabber.line();
        let is_good = line.map(|line| passes(&line, portals));
        if is_good == Some(true) {
            self.report.count("lines", 1);
        } else if is_good == Some(false) || self.suite.tight >= 1.0 {
            let fresh = self.walked(portals).and_then(|mut fresh| fresh.line());
            if fresh.is_some_and(|line| passes(&line, portals)) {
                return Err(self.not_undone(portals.len()));
            }
            let found = if is_good.is_some() { "one that does not" } else { "none" };
            return Err(self.broken(Clause::Lines, portals.len(), "a line that passes", found));
        }
        if self.proof.as_ref().is_some_and(|proof| proof.holds(portals)) {
            let found = "one of another sequence holds";
            return Err(self.broken(Clause::Evidence, portals.len(), "no proof about an open one", found));
        }
        Ok(())
    }

    fn decision(&mut self, portals: &[S::Portal], truth: Option<bool>) -> Result<(), Violation> {
        let (expected, found) = match self.stabber.clone().decide(portals) {
            Verdict::Visible(_) if truth == Some(false) => ("'hidden'", "'visible'"),
            Verdict::Hidden(_) if truth == Some(true) => ("'visible'", "'hidden'"),
            Verdict::Visible(line) if !passes(&line, portals) => ("a line that passes", "one that does not"),
            Verdict::Hidden(proof) if !proof.holds(portals) => ("a proof that holds", "one that does not"),
            Verdict::Visible(_) => {
                self.report.count("lines", 1);
                return Ok(());
            }
            Verdict::Hidden(proof) => {
                self.report.count("proofs", 1);
                self.proof = Some(proof);
                return Ok(());
            }
            Verdict::Undecided(_) => return Ok(()),
        };
        Err(self.broken(Clause::Evidence, portals.len(), expected, found))
    }

    /// Asks about boxes that a line meets.
    fn boxes(&mut self, stabber: &mut S, portals: &[S::Portal], boxes: &[S::Bounds]) -> Result<(), Violation> {
        let Some(last) = portals.last() else { return Ok(()) };
        let mut fresh = self.walked(portals);
        for bounds in boxes {
            self.report.count("boxes that a line meets", 1);
            let ask = |stabber: &mut S| {
                let answers = [
                    ("may_meet", stabber.may_meet(bounds)),
                    ("meets", stabber.meets(bounds)),
                    ("in_front", stabber.in_front(last, bounds)),
                ];
                answers.into_iter().find(|(_, reaches)| !reaches).map(|(method, _)| method)
            };
            if let Some(method) = ask(stabber) {
                if fresh.as_mut().and_then(ask).is_none() {
                    return Err(self.not_undone(portals.len()));
                }
                let expected = format!("{method} of a box that a line meets");
                return Err(self.broken(Clause::Reaching, portals.len(), expected, "'false'"));
            }
        }
        Ok(())
    }
}

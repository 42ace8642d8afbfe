//! The walk through a sequence, and what is compared on the way.

use super::{Case, Clause, Report, Stabbers, Violation};
use sightlines_sightline::{Proof, Stabber, Verdict, Witness};
use std::fmt::Display;
use std::slice::from_ref;

pub(super) struct Walk<'a, S: Stabber, R: Stabber> {
    stabber: &'a S,
    suite: &'a Stabbers<R>,
    reference: R,
    report: &'a mut Report,
    round: u32,
    /// The latest proof of the stabber.
    proof: Option<S::Proof>,
}

fn passes<P>(line: &impl Witness<P>, portals: &[P]) -> bool {
    portals.iter().all(|portal| line.passes(portal))
}

impl<'a, S: Stabber, R: Stabber<Portal = S::Portal, Bounds = S::Bounds>> Walk<'a, S, R> {
    pub(super) fn new(stabber: &'a S, suite: &'a Stabbers<R>, report: &'a mut Report) -> Self {
        Self { stabber, suite, reference: suite.reference.clone(), report, round: 0, proof: None }
    }

    fn broken(&self, clause: Clause, portals: &[S::Portal], expected: impl Display, found: &str) -> Violation {
        let case = format!("sequence {} of seed {}, portals: {}", self.round, self.suite.seed, portals.len());
        self.report.broken(clause, case, expected, found)
    }

    fn not_undone(&self, portals: &[S::Portal]) -> Violation {
        self.broken(Clause::Undone, portals, "the answer of a new stabber", "another after undoing")
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
            let is_open = self.push(&mut walked, &tried)?;
            self.compare(&tried, truth, is_open)?;
            self.decision(&tried, truth)?;
            if is_open {
                passed = tried;
                if truth == Some(true) {
                    self.line(&mut walked, &passed)?;
                }
                // As long as the spine passes, it meets what lies on it.
                if case.has_spine && passed.len() == k + 2 {
                    self.reach(&mut walked, &passed, &case.beyond[k + 1])?;
                }
            }
        }
        Ok(())
    }

    /// Whether the last portal can be pushed. Something else is pushed first and undone; then the portal twice, with an
    /// undo between if it is open; and once by another stabber that was given only the sequence.
    fn push(&mut self, walked: &mut S, tried: &[S::Portal]) -> Result<bool, Violation> {
        let portal = &tried[tried.len() - 1];
        let mut try_push = |portal: S::Portal| walked.push(portal).map(|undo| walked.undo(undo)).is_some();
        try_push((self.suite.cases.half)(portal));
        let is_open = try_push(portal.clone());
        let again = walked.push(portal.clone()).is_some();
        self.report.count("answers after undoing", 2);
        if again == is_open && self.pushed(tried) == Some(is_open) {
            return Ok(is_open);
        }
        // Answers differ: because of an undo, or even without one.
        let answers: Vec<Option<bool>> = (0..8).map(|_| self.pushed(tried)).collect();
        let is_one = answers[0].is_some() && answers.iter().all(|answer| *answer == answers[0]);
        let not_repeatable = self.broken(Clause::Repeatable, tried, "one answer for the last", "two");
        Err(if is_one { self.not_undone(tried) } else { not_repeatable })
    }

    /// Compares with the truth.
    fn compare(&mut self, tried: &[S::Portal], truth: Option<bool>, is_open: bool) -> Result<(), Violation> {
        if truth == Some(true) && !is_open {
            return Err(self.broken(Clause::Conservative, tried, "an open one", "that the last is blocked"));
        }
        let (open, blocked) = (truth == Some(true), truth == Some(false));
        self.report.count("open sequences", usize::from(open));
        self.report.count("blocked sequences", usize::from(blocked));
        self.report.count("blocked sequences found", usize::from(blocked && !is_open));
        self.report.count("sequences without evidence", usize::from(truth.is_none()));
        Ok(())
    }

    /// Whether a new stabber passes the last portal after the others; `None` if one of the others blocks.
    fn pushed(&self, portals: &[S::Portal]) -> Option<bool> {
        let (last, before) = portals.split_last()?;
        Some(self.walked(before)?.push(last.clone()).is_some())
    }

    /// A new stabber that was given only these portals.
    fn walked(&self, portals: &[S::Portal]) -> Option<S> {
        let mut stabber = self.stabber.clone();
        let (first, rest) = portals.split_first()?;
        stabber.start(first.clone());
        rest.iter().try_for_each(|portal| stabber.push(portal.clone()).map(drop))?;
        Some(stabber)
    }

    /// Evaluates the line of a sequence that is open in truth.
    fn line(&mut self, stabber: &mut S, portals: &[S::Portal]) -> Result<(), Violation> {
        let is_good = stabber.line().map(|line| passes(&line, portals));
        if is_good == Some(true) {
            self.report.count("lines", 1);
        } else if is_good == Some(false) || self.suite.tight >= 1.0 {
            let fresh = self.walked(portals).and_then(|mut fresh| fresh.line());
            if fresh.is_some_and(|line| passes(&line, portals)) {
                return Err(self.not_undone(portals));
            }
            let found = if is_good.is_some() { "one that does not" } else { "none" };
            return Err(self.broken(Clause::Lines, portals, "a line that passes", found));
        }
        if self.proof.as_ref().is_some_and(|proof| proof.holds(portals)) {
            let found = "that the one of another sequence holds";
            return Err(self.broken(Clause::Evidence, portals, "no proof, for a line passes", found));
        }
        Ok(())
    }

    fn decision(&mut self, portals: &[S::Portal], truth: Option<bool>) -> Result<(), Violation> {
        let wrong = |expected: &str, found| Err(self.broken(Clause::Evidence, portals, expected, found));
        let what = match self.stabber.clone().decide(portals) {
            Verdict::Visible(_) if truth == Some(false) => return wrong("'hidden'", "'visible'"),
            Verdict::Hidden(_) if truth == Some(true) => return wrong("'visible'", "'hidden'"),
            Verdict::Visible(line) if !passes(&line, portals) => return wrong("a line that passes", "another"),
            Verdict::Hidden(proof) if !proof.holds(portals) => return wrong("a proof that holds", "another"),
            Verdict::Visible(_) => "lines",
            Verdict::Hidden(proof) => {
                self.proof = Some(proof);
                "proofs"
            }
            Verdict::Undecided(_) => return Ok(()),
        };
        self.report.count(what, 1);
        Ok(())
    }

    /// Asks about a box that a line meets.
    fn reach(&mut self, stabber: &mut S, portals: &[S::Portal], bounds: &S::Bounds) -> Result<(), Violation> {
        self.report.count("boxes that a line meets", 1);
        let ask = |stabber: &mut S| {
            let is_in_front = stabber.in_front(&portals[portals.len() - 1], bounds);
            let answers =
                [("may_meet", stabber.may_meet(bounds)), ("meets", stabber.meets(bounds)), ("in_front", is_in_front)];
            answers.into_iter().find(|(_, reaches)| !reaches).map(|(method, _)| method)
        };
        let Some(method) = ask(stabber) else { return Ok(()) };
        Err(match self.walked(portals).as_mut().and_then(ask) {
            Some(_) => self.broken(Clause::Reaching, portals, format_args!("'true' of {method}"), "a box left out"),
            None => self.not_undone(portals),
        })
    }
}

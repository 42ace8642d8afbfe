//! The walk through a sequence, and what is compared on the way.

use super::{Case, Cases, Effort, Report, Violation};
use crate::{Proof, Stabber, Verdict, Witness};

/// The truth about a sequence, from evidence that was evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Truth {
    Open,
    Blocked,
    Unknown,
}

pub(super) struct Check<'a, S: Stabber, R, C> {
    stabber: &'a S,
    reference: R,
    cases: &'a C,
    effort: &'a Effort,
    report: Report,
    /// The latest proof of the stabber.
    proof: Option<S::Proof>,
}

impl<'a, S, R, C> Check<'a, S, R, C>
where
    C: Cases<Portal = S::Portal, Bounds = S::Bounds>,
    S: Stabber,
    R: Stabber<Portal = S::Portal, Bounds = S::Bounds>,
{
    pub(super) fn new(stabber: &'a S, reference: R, cases: &'a C, effort: &'a Effort) -> Self {
        Self { stabber, reference, cases, effort, report: Report::default(), proof: None }
    }

    fn truth(&mut self, portals: &[S::Portal]) -> Truth {
        match self.reference.decide(portals) {
            Verdict::Visible(line) if portals.iter().all(|portal| line.passes(portal)) => Truth::Open,
            Verdict::Hidden(proof) if proof.holds(portals) => Truth::Blocked,
            _ => Truth::Unknown,
        }
    }

    /// Walks one sequence.
    pub(super) fn sequence(&mut self, round: u32, case: &Case<S::Portal, S::Bounds>) -> Result<(), Violation> {
        self.report.sequences += 1;
        let Some((first, rest)) = case.portals.split_first() else { return Ok(()) };
        let mut walked = self.stabber.clone();
        walked.start(first.clone());
        self.open_sequence(round, &mut walked, &case.portals[..1])?;
        let mut passed = vec![first.clone()];
        for (k, portal) in rest.iter().enumerate() {
            let tried: Vec<S::Portal> = passed.iter().chain([portal]).cloned().collect();
            let n = tried.len();
            let truth = self.truth(&tried);
            // Something else is pushed first and undone; then the portal twice, with an undo between if it is open; and
            // once by another stabber that was given only the sequence.
            let half = walked.push(self.cases.half(portal));
            half.into_iter().for_each(|undo| walked.undo(undo));
            let once = walked.push(portal.clone());
            let is_open = once.is_some();
            once.into_iter().for_each(|undo| walked.undo(undo));
            let again = walked.push(portal.clone());
            let fresh = self.pushed(&passed, portal);
            self.report.undone += 2;
            if again.is_some() != is_open || fresh != Some(is_open) {
                return Err(self.why_other(round, &passed, portal));
            }
            match truth {
                Truth::Open if !is_open => return Err(Violation::Hides { round, portals: n }),
                Truth::Open => self.report.open += 1,
                Truth::Blocked => {
                    self.report.blocked += 1;
                    self.report.found += u64::from(!is_open);
                }
                Truth::Unknown => self.report.unknown += 1,
            }
            self.decision(round, &tried, truth)?;
            if is_open {
                passed = tried;
                if truth == Truth::Open {
                    self.open_sequence(round, &mut walked, &passed)?;
                }
                // As long as the spine passes, it meets what lies on it.
                if case.has_spine && passed.len() == k + 2 {
                    self.boxes(round, &mut walked, &passed, &case.beyond[k + 1])?;
                }
            }
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
        for portal in rest {
            stabber.push(portal.clone())?;
        }
        Some(stabber)
    }

    /// Answers differ: because of an undo, or even without one.
    fn why_other(&self, round: u32, before: &[S::Portal], portal: &S::Portal) -> Violation {
        let portals = before.len() + 1;
        let answers: Vec<Option<bool>> = (0..8).map(|_| self.pushed(before, portal)).collect();
        if answers.iter().any(|answer| *answer != answers[0]) || answers[0].is_none() {
            Violation::NotRepeatable { round, portals }
        } else {
            Violation::NotUndone { round, portals }
        }
    }

    /// Evaluates the line of a sequence that is open in truth.
    fn open_sequence(&mut self, round: u32, stabber: &mut S, portals: &[S::Portal]) -> Result<(), Violation> {
        let wrong = |what| Err(Violation::Line { round, portals: portals.len(), what });
        let passes = |line: &S::Line| portals.iter().all(|portal| line.passes(portal));
        let line = stabber.line();
        let is_good = line.as_ref().map(passes);
        if is_good == Some(true) {
            self.report.lines += 1;
        } else if is_good == Some(false) || self.effort.tight >= 1.0 {
            if self.walked(portals).and_then(|mut fresh| fresh.line()).is_some_and(|line| passes(&line)) {
                return Err(Violation::NotUndone { round, portals: portals.len() });
            }
            return wrong(if line.is_some() { "the line does not pass" } else { "there is no line" });
        }
        // A proof of another sequence must not hold for an open one.
        match &self.proof {
            Some(proof) if proof.holds(portals) => Err(Violation::Evidence {
                round,
                portals: portals.len(),
                what: "a proof of another sequence holds for an open one",
            }),
            _ => Ok(()),
        }
    }

    fn decision(&mut self, round: u32, portals: &[S::Portal], truth: Truth) -> Result<(), Violation> {
        let wrong = |what| Err(Violation::Evidence { round, portals: portals.len(), what });
        match self.stabber.clone().decide(portals) {
            Verdict::Visible(_) if truth == Truth::Blocked => wrong("'visible' is wrong"),
            Verdict::Hidden(_) if truth == Truth::Open => wrong("'hidden' is wrong"),
            Verdict::Visible(line) if !portals.iter().all(|portal| line.passes(portal)) => {
                wrong("the line does not pass")
            }
            Verdict::Hidden(proof) if !proof.holds(portals) => wrong("the proof does not hold"),
            Verdict::Visible(_) => {
                self.report.lines += 1;
                Ok(())
            }
            Verdict::Hidden(proof) => {
                self.report.proofs += 1;
                self.proof = Some(proof);
                Ok(())
            }
            Verdict::Undecided(_) => Ok(()),
        }
    }

    fn boxes(
        &mut self,
        round: u32,
        stabber: &mut S,
        portals: &[S::Portal],
        boxes: &[S::Bounds],
    ) -> Result<(), Violation> {
        let Some(last) = portals.last() else { return Ok(()) };
        let mut fresh = self.walked(portals);
        for bounds in boxes {
            self.report.boxes += 1;
            let ask = |stabber: &mut S| {
                let answers = [
                    ("may_meet", stabber.may_meet(bounds)),
                    ("meets", stabber.meets(bounds)),
                    ("in_front", stabber.in_front(last, bounds)),
                ];
                answers.into_iter().find(|(_, reaches)| !reaches).map(|(method, _)| method)
            };
            if let Some(method) = ask(stabber) {
                let portals = portals.len();
                return Err(match fresh.as_mut().and_then(ask) {
                    Some(_) => Violation::Misses { round, portals, method },
                    None => Violation::NotUndone { round, portals },
                });
            }
        }
        Ok(())
    }

    /// The counts of comparisons, if they suffice.
    pub(super) fn finish(self) -> Result<Report, Violation> {
        let report = self.report;
        let counts = [
            ("sequences", report.sequences),
            ("open sequences", report.open),
            ("blocked sequences", report.blocked),
            ("boxes that a line meets", report.boxes),
        ];
        if let Some((what, _)) = counts.into_iter().find(|&(_, n)| n == 0) {
            return Err(Violation::NothingRan { what });
        }
        if (report.found as f64) < self.effort.tight * report.blocked as f64 {
            return Err(Violation::Loose { found: report.found, blocked: report.blocked });
        }
        Ok(report)
    }
}

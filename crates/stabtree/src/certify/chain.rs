//! Lines and walks in units of work that build on each other: a line is taken for pairs that have none yet, and a walk rests on the pairs
//! that those before it have proven. So the units are a chain: a run that goes on takes again what the units before have found, each line
//! and each walk checked again, and then searches on.

use sightlines_progress::{Counter, Halt, Kept, Phase, Units};
use std::ops::Range;

/// A search for lines and walks, in steps: lines that are shot, searches for lines, walks. What a step finds depends on the steps before it
/// through the maker and [`Steps::spent`] alone.
pub(crate) trait Steps {
    /// Lines are shot in rounds: at first only those are taken that prove at least this many new pairs.
    const ROUNDS: [usize; 3];
    /// What a line that is shot, a search for lines, and a walk cost, about.
    const COSTS: [f64; 3];
    /// A line.
    type Line;

    /// The forms of a line that is shot, the one to try first first.
    fn shot(&self, shot: usize) -> [Self::Line; 2];

    /// Takes a line if the maker does.
    fn take_line(&mut self, line: Self::Line, at_least: usize) -> bool;

    /// Takes a step of the search for lines.
    fn seek(&mut self, step: usize);

    /// All lines are found.
    fn begin_walks(&mut self);

    /// Makes a walk, or several.
    fn walk(&mut self, step: usize);

    /// What was spent so far.
    fn spent(&self) -> u64;

    /// Spends as much as some steps have spent; `false` if they cannot have spent that much.
    fn spend(&mut self, spent: u64, n_steps: usize) -> bool;

    /// How many lines and walks the maker has.
    fn n_taken(&self) -> [usize; 2];

    /// Those that were taken since, as bytes.
    fn taken_since(&self, n_taken: [usize; 2]) -> Vec<u8>;

    /// Takes such bytes, if the maker takes all of them.
    fn take_again(&mut self, bytes: &[u8]) -> bool;
}

/// The steps of a unit.
#[derive(Debug, Clone, PartialEq)]
enum Unit {
    /// Lines that are shot, in a round.
    Shots(usize, Range<usize>),
    Seeks(Range<usize>),
    Walks(Range<usize>),
}

/// Parts of equal length, at most `most` long, and of about `n_parts` if they may be shorter.
fn divided(n: usize, n_parts: usize, most: usize) -> impl Iterator<Item = Range<usize>> {
    let size = n.div_ceil(n_parts).clamp(1, most);
    (0..n).step_by(size).map(move |start| start..n.min(start + size))
}

/// Divides steps into units, and predicts their costs. Does not depend on who does them.
fn units_of<S: Steps>([n_shots, n_seeks, n_walks]: [usize; 3]) -> (Vec<Unit>, Vec<f64>) {
    let shots = (0..S::ROUNDS.len()).flat_map(|round| divided(n_shots, 64, 1024).map(move |part| (round, part)));
    let mut units: Vec<Unit> = shots.map(|(round, part)| Unit::Shots(round, part)).collect();
    units.extend(divided(n_seeks, 256, 16).map(Unit::Seeks));
    units.extend(divided(n_walks, 256, 16).map(Unit::Walks));
    let cost = |unit: &Unit| match unit {
        Unit::Shots(_, part) => S::COSTS[0] * part.len() as f64,
        Unit::Seeks(part) => S::COSTS[1] * part.len() as f64,
        Unit::Walks(part) => S::COSTS[2] * part.len() as f64,
    };
    let costs = units.iter().map(cost).collect();
    (units, costs)
}

/// A search under way.
struct Chain<S> {
    steps: S,
    /// Which of the lines that are shot were taken.
    is_taken: Vec<bool>,
    is_walking: bool,
}

/// Goes through all steps, in units that are kept.
///
/// * `n_steps`: lines that are shot, searches for lines, and walks
/// * `counter`: counts searches and walks
/// * `share`: of each of them in what it counts
/// * `start`: a search that has found nothing; it may begin anew
///
/// # Errors
/// [`Halt`] by the observer or the store.
pub(crate) fn through<S: Steps>(
    phase: &'static str,
    n_steps: [usize; 3],
    (counter, share): (&Counter<'_>, f64),
    units: Units<'_>,
    start: impl Fn() -> S,
) -> Result<S, Halt> {
    let (all, costs) = units_of::<S>(n_steps);
    let mut done = None;
    units.through(&Phase::chain(phase, &costs), || {
        // With all results there is nothing that another pass could find.
        if done.is_some() {
            return Ok(());
        }
        let is_taken = vec![false; n_steps[0]];
        let mut chain = Chain { steps: start(), is_taken, is_walking: false };
        let count = |is_kept: bool| match units.are_kept() {
            true => counter.step_by(share, is_kept),
            false => counter.step(),
        };
        for (place, unit) in all.iter().enumerate() {
            counter.check()?;
            if matches!(unit, Unit::Walks(_)) && !std::mem::replace(&mut chain.is_walking, true) {
                chain.steps.begin_walks();
            }
            let mut is_computed = false;
            let result = units.get(phase, place, || {
                is_computed = true;
                chain.compute(unit, units.are_kept(), &|| count(false).map_err(Halt::from))
            })?;
            // All that comes later builds on this unit, which is for another process.
            let Some(result) = result else { return Ok(()) };
            if !is_computed {
                chain.repeat(unit, &result).ok_or_else(|| Halt::unfit(phase, place, super::OF))?;
                let n = if let Unit::Seeks(part) | Unit::Walks(part) = unit { part.len() } else { 0 };
                (0..n).try_for_each(|_| count(true))?;
            }
        }
        done = Some(chain.steps);
        Ok::<_, Halt>(())
    })?;
    // A phase that ends has all its results.
    done.ok_or(Halt::Shared)
}

impl<S: Steps> Chain<S> {
    /// Does a unit, and returns its result; nothing if that is not kept.
    fn compute(&mut self, unit: &Unit, is_kept: bool, count: &dyn Fn() -> Result<(), Halt>) -> Result<Vec<u8>, Halt> {
        let (n_taken, spent) = (self.steps.n_taken(), self.steps.spent());
        match unit {
            Unit::Shots(round, part) => {
                let taken: Vec<[usize; 2]> = part.clone().filter_map(|shot| self.shoot(shot, *round)).collect();
                return Ok(if is_kept { shots_to_bytes(&taken) } else { Vec::new() });
            }
            Unit::Seeks(part) => {
                for step in part.clone() {
                    self.steps.seek(step);
                    count()?;
                }
            }
            Unit::Walks(part) => {
                for step in part.clone() {
                    self.steps.walk(step);
                    count()?;
                }
            }
        }
        let mut out = Vec::new();
        if is_kept {
            (self.steps.spent() - spent).write(&mut out);
            out.append(&mut self.steps.taken_since(n_taken));
        }
        Ok(out)
    }

    /// Shoots a line that was not taken in an earlier round; returns it with its form if it is taken.
    fn shoot(&mut self, shot: usize, round: usize) -> Option<[usize; 2]> {
        if self.is_taken[shot] {
            return None;
        }
        let at_least = S::ROUNDS[round];
        let form = self.steps.shot(shot).into_iter().position(|line| self.steps.take_line(line, at_least))?;
        self.is_taken[shot] = true;
        Some([shot, form])
    }

    /// Takes what a unit has found; `None` if it cannot have found that. Then the search is of no more use.
    fn repeat(&mut self, unit: &Unit, mut bytes: &[u8]) -> Option<()> {
        let (Unit::Seeks(part) | Unit::Walks(part)) = unit else { return self.shoot_again(unit, bytes) };
        let (spent, [n_lines, n_walks]) = (u64::read(&mut bytes)?, self.steps.n_taken());
        if !self.steps.spend(spent, part.len()) || !self.steps.take_again(bytes) {
            return None;
        }
        // A search finds lines, and a walk rests on all of them.
        let now = self.steps.n_taken();
        let is_of_kind = if matches!(unit, Unit::Seeks(_)) { now[1] == n_walks } else { now[0] == n_lines };
        is_of_kind.then_some(())
    }

    fn shoot_again(&mut self, unit: &Unit, bytes: &[u8]) -> Option<()> {
        let Unit::Shots(round, part) = unit else { return None };
        for [shot, form] in shots_from_bytes(bytes)? {
            if !part.contains(&shot) || self.is_taken[shot] {
                return None;
            }
            let line = self.steps.shot(shot).into_iter().nth(form)?;
            if !self.steps.take_line(line, S::ROUNDS[*round]) {
                return None;
            }
            self.is_taken[shot] = true;
        }
        Some(())
    }
}

/// How many were taken; for each the difference to the one before, twice, plus the form.
fn shots_to_bytes(taken: &[[usize; 2]]) -> Vec<u8> {
    let mut before = 0;
    let code = |&[shot, form]: &[usize; 2]| 2 * (shot - std::mem::replace(&mut before, shot)) + form;
    taken.iter().map(code).collect::<Vec<usize>>().to_bytes()
}

fn shots_from_bytes(bytes: &[u8]) -> Option<Vec<[usize; 2]>> {
    let mut before = 0_usize;
    let taken = |code: usize| {
        before = before.checked_add(code / 2)?;
        Some([before, code % 2])
    };
    Vec::from_bytes(bytes)?.into_iter().map(taken).collect()
}

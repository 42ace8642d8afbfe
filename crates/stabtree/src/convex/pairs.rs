//! Cells that beams leave in doubt, decided exactly: sequence by sequence.
//!
//! From a gate of one cell, all sequences of gates are followed that could lead to a cell in doubt, and as far as
//! an open set of lines passes them, which [`ConvexStabber`] decides exactly. A sequence is left as soon as
//! planes show that no line passes it, or that nothing in doubt lies in its beam, or when it is known that from
//! one of its gates the first or the last cell cannot be seen.

use super::ConvexCounters;
use super::beams::drop_hidden;
use super::cut::{Cutter, Part, Plane, middle};
use super::gates::Gates;
use super::vector::{scale, sub, unit};
use sightlines_cells::Portal3;
use sightlines_pvs::BitMatrix;
use sightlines_pvs::bits::ones;
use sightlines_sightline::{ConvexStabber, Line3, StabLimits, Stabbing3};
use std::collections::HashMap;

/// How many questions about sequences may be asked for one cell, for each cell that is in doubt about it.
const MOST_QUESTIONS: u64 = 20_000;

/// How many planes of earlier gates cut a gate: the last ones cut most, the others hardly any more.
const PLANES: usize = 24;

/// Of how many gates, without the last, it is remembered that no line passes them all.
const MOST_LEARNT: usize = 5;

/// One gate of the sequence that is followed.
#[derive(Debug, Default)]
struct Level {
    gate: u32,
    /// The part of the first gate that lines of the sequence may pass.
    source: Part,
    /// The same of this gate.
    part: Part,
    wanted: Vec<u64>,
}

/// Follows sequences; one for each thread.
#[derive(Debug)]
pub(super) struct SequenceTracer {
    cutter: Cutter,
    stabber: ConvexStabber,
    programs_before: u64,
    n_lines: u64,
    n_sequences: u64,
    levels: Vec<Level>,
    planes: Vec<Plane>,
    turned: [Part; 2],
    back: Vec<Plane>,
    chain: Vec<u32>,
    in_doubt: Vec<u64>,
    open: Vec<u64>,
    /// Gates that no line passes all of, by the last of them, for the cell that is decided.
    learnt: HashMap<u32, Vec<Vec<u32>>>,
    /// The level up to which no line passes the sequence, and behind which there is nothing to follow.
    blocked: usize,
    asked: u64,
    most_asked: u64,
}

/// What was found out about one cell.
#[derive(Debug, Default)]
pub(super) struct Decided {
    /// Cells that it does not see.
    pub(super) hidden: Vec<u64>,
    /// Cells of which it could not be decided whether it sees them.
    pub(super) undecided: Vec<u64>,
    /// Lines that show that cells see each other: the gates that each passes.
    pub(super) chains: Vec<Vec<u32>>,
}

impl SequenceTracer {
    pub(super) fn new(gates: &Gates) -> Self {
        Self {
            cutter: Cutter::new(gates.largest),
            stabber: ConvexStabber::new(StabLimits::default()),
            programs_before: 0,
            n_lines: 0,
            n_sequences: 0,
            levels: Vec::new(),
            planes: Vec::new(),
            turned: Default::default(),
            back: Vec::new(),
            chain: Vec::new(),
            in_doubt: Vec::new(),
            open: Vec::new(),
            learnt: HashMap::new(),
            blocked: usize::MAX,
            asked: 0,
            most_asked: 0,
        }
    }

    /// What was done since this was last asked.
    pub(super) fn take_counters(&mut self) -> ConvexCounters {
        let programs = self.stabber.counters().n_programs;
        let counters = ConvexCounters {
            clips: std::mem::take(&mut self.cutter.clips),
            lines: std::mem::take(&mut self.n_lines),
            programs: programs - self.programs_before,
            beams: 0,
            sequences: std::mem::take(&mut self.n_sequences),
        };
        self.programs_before = programs;
        counters
    }

    /// Decides which of the cells `in_doubt` the cell sees. Row `g` of `through` has the cells that may be seen
    /// through gate `g`.
    pub(super) fn decide(&mut self, gates: &Gates, cell: u32, in_doubt: Vec<u64>, through: &BitMatrix) -> Decided {
        let mut decided = Decided::default();
        self.asked = 0;
        self.learnt.clear();
        self.most_asked = MOST_QUESTIONS * in_doubt.iter().map(|w| u64::from(w.count_ones())).sum::<u64>();
        self.open = vec![0; in_doubt.len()];
        self.in_doubt = in_doubt;
        for &gate in gates.exits(cell) {
            self.planes.clear();
            let level = self.level(0);
            level.gate = gate;
            level.source.clear();
            level.source.extend_from_slice(gates.corners(gate));
            level.part.clone_from(&level.source);
            let mut wanted = std::mem::take(&mut level.wanted);
            wanted.clear();
            wanted.extend(self.in_doubt.iter().zip(through.row(gate as usize)).map(|(a, b)| a & b));
            self.levels[0].wanted = wanted;
            let behind = gates.get(gate).to as usize;
            if self.levels[0].wanted[behind / 64] >> (behind % 64) & 1 == 1 {
                let answer = self.stabber.stab(&[gates.shape(gate)], None);
                self.reached(gates, 0, answer, &mut decided);
            }
            self.follow(gates, 0, through, &mut decided);
            self.blocked = usize::MAX;
        }
        if self.asked >= self.most_asked {
            // What was not looked at may be anything.
            self.open.iter_mut().zip(&self.in_doubt).for_each(|(open, doubt)| *open |= doubt);
        }
        decided.undecided = self.open.iter().zip(&self.in_doubt).map(|(open, doubt)| open & doubt).collect();
        decided.hidden = self.open.iter().zip(&self.in_doubt).map(|(open, doubt)| !open & doubt).collect();
        decided
    }

    fn level(&mut self, depth: usize) -> &mut Level {
        if depth == self.levels.len() {
            self.levels.push(Level::default());
        }
        &mut self.levels[depth]
    }

    /// Goes on behind the gate of a level.
    fn follow(&mut self, gates: &Gates, depth: usize, through: &BitMatrix, decided: &mut Decided) {
        let n_planes = self.planes.len();
        let level = &self.levels[depth];
        let gate = gates.get(level.gate);
        if depth > 0 {
            self.cutter.separators(&level.source, &level.part, &mut self.planes);
        }
        self.planes.push(Plane { normal: gate.normal, origin: gate.center, offset: gates.flat });
        let mut wanted = std::mem::take(&mut self.levels[depth].wanted);
        drop_hidden(&self.planes[n_planes..], gates, self.cutter.eps, &mut wanted);
        self.levels[depth].wanted = wanted;
        for &exit in gates.exits(gate.to) {
            if self.asked < self.most_asked && self.enter(gates, depth, exit, through, decided) {
                self.follow(gates, depth + 1, through, decided);
            }
            if self.blocked <= depth {
                break;
            }
            self.blocked = usize::MAX;
        }
        self.planes.truncate(n_planes);
    }

    /// Lengthens the sequence by a gate; whether it is worth following.
    fn enter(&mut self, gates: &Gates, depth: usize, exit: u32, through: &BitMatrix, decided: &mut Decided) -> bool {
        let home = gates.get(self.levels[0].gate).from;
        let gate = gates.get(exit);
        // A line meets each cell once, and sees the first cell from wherever it is.
        let sees_home = gate.from == home || through.get((exit ^ 1) as usize, home as usize);
        let is_on_way = gate.to == home || self.levels[..=depth].iter().any(|l| gates.get(l.gate).to == gate.to);
        if !sees_home || is_on_way {
            return false;
        }
        self.level(depth + 1);
        let [.., before, level] = &mut self.levels[..=depth + 1] else { unreachable!("two levels at least") };
        level.wanted.clear();
        let behind = before.wanted.iter().zip(&self.in_doubt).zip(through.row(exit as usize));
        level.wanted.extend(behind.map(|((w, doubt), through)| w & doubt & through));
        if level.wanted.iter().all(|&w| w == 0) {
            return false;
        }
        level.gate = exit;
        level.part.clear();
        level.part.extend_from_slice(gates.corners(exit));
        for plane in self.planes.iter().rev().take(PLANES) {
            if plane.at(gate.center) < 1.02 * gate.radius && !self.cutter.cut(&mut level.part, plane) {
                return false;
            }
        }
        level.source.clone_from(&before.source);
        let behind = Plane { normal: scale(gate.normal, -1.0), origin: gate.center, offset: gates.flat };
        if !self.cutter.cut(&mut level.source, &behind) {
            return false;
        }
        if depth > 0 {
            // Looking back from the new part through the one before, the source is cut too.
            let [a, b] = &mut self.turned;
            a.clear();
            a.extend(level.part.iter().rev());
            b.clear();
            b.extend(before.part.iter().rev());
            self.back.clear();
            self.cutter.separators(a, b, &mut self.back);
            if !self.cutter.cut_all(&mut level.source, &self.back) {
                return false;
            }
        }
        if !self.levels[..=depth].iter().all(|l| gates.may_follow(l.gate, exit)) {
            return false;
        }
        self.n_sequences += 1;
        if self.is_learnt(depth + 1) {
            return false;
        }
        let cell = gate.to as usize;
        self.levels[depth + 1].wanted[cell / 64] >> (cell % 64) & 1 == 0 || self.ask(gates, depth + 1, decided)
    }

    /// Asks whether a line passes the sequence up to a level, whose gate leads into a cell in doubt. `false` if
    /// none does; then `self.blocked` is the first level up to which none does.
    fn ask(&mut self, gates: &Gates, depth: usize, decided: &mut Decided) -> bool {
        self.asked += 1;
        let level = &self.levels[depth];
        let hint = Line3::through(middle(&level.source), middle(&level.part));
        let shapes: Vec<&Portal3> = self.levels[..=depth].iter().map(|l| gates.shape(l.gate)).collect();
        let answer = self.stabber.stab(&shapes, hint.as_ref());
        if let Stabbing3::Hidden(proof) = &answer {
            self.learn(&proof.named());
            return false;
        }
        self.reached(gates, depth, answer, decided);
        true
    }

    /// Remembers that no line passes some gates of the sequence, given by their places in it, ascending.
    fn learn(&mut self, named: &[usize]) {
        let Some((&last, others)) = named.split_last() else { return };
        self.blocked = last;
        if others.len() <= MOST_LEARNT {
            let gate = |place: usize| self.levels[place].gate;
            let others = others.iter().map(|&place| gate(place)).collect();
            self.learnt.entry(gate(last)).or_default().push(others);
        }
    }

    /// Whether it was learnt that no line passes the sequence up to a level.
    fn is_learnt(&self, depth: usize) -> bool {
        let on_way = |gate: &u32| self.levels[..depth].iter().any(|level| level.gate == *gate);
        let learnt = self.learnt.get(&self.levels[depth].gate);
        learnt.is_some_and(|sets| sets.iter().any(|set| set.iter().all(on_way)))
    }

    /// The sequence has reached a cell in doubt.
    fn reached(&mut self, gates: &Gates, depth: usize, answer: Stabbing3, decided: &mut Decided) {
        let cell = gates.get(self.levels[depth].gate).to as usize;
        match answer {
            Stabbing3::Hidden(_) => {}
            Stabbing3::Undecided => self.open[cell / 64] |= 1 << (cell % 64),
            Stabbing3::Visible(line) => {
                self.n_lines += 1;
                let first = self.levels[0].gate;
                gates.chain(first, line.a, unit(sub(line.b, line.a)), &mut self.chain);
                if !self.chain.iter().any(|&g| gates.get(g).to as usize == cell) {
                    self.chain.clear();
                    self.chain.extend(self.levels[..=depth].iter().map(|l| l.gate));
                }
                for &g in &self.chain {
                    for cell in [gates.get(g).from as usize, gates.get(g).to as usize] {
                        self.in_doubt[cell / 64] &= !(1 << (cell % 64));
                    }
                }
                decided.chains.push(self.chain.clone());
            }
        }
    }
}

/// The cells of a row, as ids.
pub(super) fn cells_of(row: &[u64]) -> impl Iterator<Item = u32> + '_ {
    ones(row).map(|cell| cell as u32)
}

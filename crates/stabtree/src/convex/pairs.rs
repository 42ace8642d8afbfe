//! Pairs of cells that beams leave in doubt, decided exactly: sequence by sequence.
//!
//! From each gate of one cell, sequences of gates are followed towards each gate into the other, as long as planes (see
//! [`cut`](super::cut)) leave something of the first gate, the last, the goal gate, and the space between first and
//! goal. Where a sequence arrives, [`ConvexStabber`] decides exactly whether an open set of lines passes it.
//!
//! If none does, its proof names the gates responsible: the search backtracks to before the last of them, and skips
//! other sequences with the same gates at once.

use super::ConvexSearchCounters;
use super::cut::{Cutter, Part, Plane, enclosing, middle};
use super::gates::{Gates, Memory};
use super::vector::{sub, unit};
use sightlines_cells::Portal3;
use sightlines_pvs::BitMatrix;
use sightlines_pvs::bits::ones;
use sightlines_sightline::{ConvexCertificate, ConvexStabber, KnownPortal, LimitReached, Line3, StabLimits, Verdict};

/// Maximum number of queries about sequences for a pair; a pair that takes more counts as visible.
const MOST_QUESTIONS: u64 = 20_000;

/// How many planes of earlier gates cut a gate: the latest ones cut most, older ones hardly at all.
const PLANES: usize = 20;

/// Largest number of gates, without the last, that is stored as a blocked set.
const MOST_LEARNT: usize = 5;

/// Number of sequences examined behind one before testing whether it can lead to the goal.
const WORTH_ASKING: u64 = 32;

/// One gate of the sequence that is followed.
#[derive(Debug, Default)]
struct Level {
    gate: u32,
    /// The cell behind it.
    to: u32,
    /// The part of the first gate that lines of the sequence may pass.
    source: Part,
    /// The same for this gate.
    part: Part,
    /// The same for the goal gate.
    goal: Part,
    /// A line through the sequence up to here, then through the goal gate, if one was found.
    line: Option<Line3>,
}

/// The answer for a pair. Visible: the gates that a line passes, which may be more than those between the cells.
pub(super) type PairVerdict = Verdict<Vec<u32>, (), LimitReached>;

/// Follows sequences; one for each thread.
#[derive(Debug)]
pub(super) struct SequenceTracer {
    cutter: Cutter,
    stabber: ConvexStabber,
    programs_before: u64,
    counted: ConvexSearchCounters,
    levels: Vec<Level>,
    planes: Vec<Plane>,
    chain: Vec<u32>,
    /// Sets of gates that no line passes, by their last gate, for the current pair; and the gates that have some.
    learnt: Vec<Vec<Vec<u32>>>,
    learnt_of: Vec<u32>,
    /// Which gates may lead to the goal.
    leads: Memory,
    /// Which gates may follow the first one.
    follows: Memory,
    asked: u64,
    undecided: bool,
    /// The level at which the sequence is blocked; nothing is to be followed behind it.
    blocked: usize,
    turned: [Part; 2],
    back: Vec<Plane>,
}

impl SequenceTracer {
    pub(super) fn new(gates: &Gates) -> Self {
        Self {
            cutter: Cutter::new(gates.largest),
            stabber: ConvexStabber::new(StabLimits::default()),
            programs_before: 0,
            counted: ConvexSearchCounters::default(),
            levels: Vec::new(),
            planes: Vec::new(),
            chain: Vec::new(),
            learnt: vec![Vec::new(); gates.len()],
            learnt_of: Vec::new(),
            leads: Memory::new(gates.len()),
            follows: Memory::new(gates.len()),
            asked: 0,
            undecided: false,
            blocked: usize::MAX,
            turned: Default::default(),
            back: Vec::new(),
        }
    }

    /// The work done since the last call.
    pub(super) fn take_counters(&mut self) -> ConvexSearchCounters {
        let programs = self.stabber.counters().n_programs;
        self.counted.programs = programs - std::mem::replace(&mut self.programs_before, programs);
        self.counted.clips = std::mem::take(&mut self.cutter.clips);
        std::mem::take(&mut self.counted)
    }

    /// Decides whether cell `a` sees another cell `b`. Row `g` of `through` has the cells that may be seen through gate
    /// `g`.
    pub(super) fn decide(&mut self, gates: &Gates, [a, b]: [u32; 2], through: &BitMatrix) -> PairVerdict {
        (self.asked, self.undecided) = (0, false);
        self.learnt_of.drain(..).for_each(|gate| self.learnt[gate as usize].clear());
        for goal in gates.exits(b).iter().map(|&exit| exit ^ 1) {
            if !through.get((goal ^ 1) as usize, a as usize) {
                continue;
            }
            self.leads.forget();
            for &first in gates.exits(a).iter().filter(|&&first| through.get(first as usize, b as usize)) {
                if first != goal && !gates.may_follow(first, goal) {
                    continue;
                }
                self.planes.clear();
                self.blocked = usize::MAX;
                self.follows.forget();
                let level = self.level(0);
                (level.gate, level.to, level.line) = (first, gates.get(first).to, None);
                for (part, gate) in [(&mut level.source, first), (&mut level.part, first), (&mut level.goal, goal)] {
                    part.clear();
                    part.extend_from_slice(gates.corners(gate));
                }
                if first == goal && self.ask(gates, 0, None)
                    || first != goal && self.follow(gates, 0, &Pair { a, b, goal, through })
                {
                    return Verdict::Visible(self.chain.clone());
                }
            }
        }
        if self.undecided || self.asked >= MOST_QUESTIONS {
            Verdict::Undecided(LimitReached)
        } else {
            Verdict::Hidden(())
        }
    }

    fn level(&mut self, depth: usize) -> &mut Level {
        if depth == self.levels.len() {
            self.levels.push(Level::default());
        }
        &mut self.levels[depth]
    }

    /// Continues behind the gate of a level; returns whether a line was found, with the gates that it passes in the
    /// chain.
    fn follow(&mut self, gates: &Gates, depth: usize, pair: &Pair<'_>) -> bool {
        let n_planes = self.planes.len();
        let mut found = false;
        if !self.is_learnt(depth + 1, pair.goal) && self.narrow(gates, depth, pair.goal) {
            let (first, mut has_asked) = (self.counted.sequences, false);
            for &exit in gates.next(self.levels[depth].gate) {
                // Where much lies behind a sequence, test whether its lines lead to the goal at all.
                if !has_asked && self.counted.sequences > first + WORTH_ASKING {
                    has_asked = true;
                    found = self.ask(gates, depth, Some(pair.goal));
                }
                // Nothing is followed behind a blocked level.
                if found || self.blocked <= depth || self.asked >= MOST_QUESTIONS {
                    break;
                }
                self.blocked = usize::MAX;
                found = self.enter(gates, depth, exit, pair)
                    && if exit == pair.goal {
                        self.ask(gates, depth + 1, None)
                    } else {
                        self.follow(gates, depth + 1, pair)
                    };
                if found {
                    break;
                }
            }
        }
        self.planes.truncate(n_planes);
        found
    }

    /// Finds the planes of a level and cuts the goal with them; returns whether something is left of it.
    fn narrow(&mut self, gates: &Gates, depth: usize, goal: u32) -> bool {
        let n_planes = self.planes.len();
        let level = &mut self.levels[depth];
        if depth > 0 {
            self.cutter.separators(&level.source, &level.part, &mut self.planes);
        }
        self.planes.push(gates.in_front(level.gate));
        let left = self.cutter.cut_all(&mut level.goal, &gates.get(goal).ball(), self.planes[n_planes..].iter());
        if left {
            enclosing(&level.source, &level.goal, &mut self.planes);
        }
        left
    }

    /// Extends the sequence by a gate; returns whether it is worth following.
    fn enter(&mut self, gates: &Gates, depth: usize, exit: u32, pair: &Pair<'_>) -> bool {
        // A line meets each cell once, and every point on it sees the first cell and the last.
        let gate = gates.get(exit);
        let leads = || {
            gate.to != pair.a
                && gate.to != pair.b
                && pair.through.get(exit as usize, pair.b as usize)
                && pair.through.get((exit ^ 1) as usize, pair.a as usize)
                && gates.may_follow(exit, pair.goal)
        };
        if exit != pair.goal && !self.leads.ask(exit, leads) {
            return false;
        }
        let [first, others @ ..] = &self.levels[..=depth] else { unreachable!("one level at least") };
        // What may follow the last one is all that is tried.
        let between = &others[..others.len().saturating_sub(1)];
        if others.iter().any(|level| level.to == gate.to)
            || first.to == gate.to
            || !self.follows.ask(exit, || gates.may_follow(first.gate, exit))
            || self.is_learnt(depth + 1, exit)
            || !between.iter().all(|level| gates.may_follow(level.gate, exit))
        {
            return false;
        }
        self.level(depth + 1);
        let first = self.levels[0].gate;
        let [.., before, level] = &mut self.levels[..=depth + 1] else { unreachable!("two levels at least") };
        (level.gate, level.to, level.line) = (exit, gate.to, None);
        level.part.clear();
        level.part.extend_from_slice(if exit == pair.goal { &before.goal } else { gates.corners(exit) });
        if !self.cutter.cut_all(&mut level.part, &gate.ball(), self.planes.iter().rev().take(PLANES)) {
            return false;
        }
        level.goal.clone_from(&before.goal);
        level.source.clone_from(&before.source);
        if !self.cutter.cut(&mut level.source, &gates.behind(exit)) {
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
            let first = gates.get(first);
            self.cutter.separators(a, b, &mut self.back);
            if !self.cutter.cut_all(&mut level.source, &first.ball(), self.back.iter()) {
                return false;
            }
        }
        self.counted.sequences += 1;
        true
    }

    /// Queries the stabber for a line through the sequence up to a level, then the goal, if that is not the last gate.
    ///
    /// `true` if a line was found that reaches the goal's cell; the gates that it passes are then in the chain. If no
    /// line passes, `self.blocked` is the level up to which none does.
    fn ask(&mut self, gates: &Gates, depth: usize, goal: Option<u32>) -> bool {
        // A line that was found for the first levels may pass the others too, but leads nowhere else.
        let above = self.levels[..=depth].iter().rposition(|level| level.line.is_some());
        let line = above.and_then(|above| {
            let passes = |line: &Line3| self.levels[above + 1..=depth].iter().all(|l| line.passes(gates.shape(l.gate)));
            self.levels[above].line.filter(passes)
        });
        if line.is_some() && goal.is_some() {
            self.levels[depth].line = line;
            return false;
        }
        self.asked += 1;
        let level = &self.levels[depth];
        let end = if goal.is_some() { &level.goal } else { &level.part };
        let hint = line.or_else(|| Line3::through(middle(&level.source), middle(end)));
        let sequence: Vec<u32> = self.levels[..=depth].iter().map(|l| l.gate).chain(goal).collect();
        let shapes: Vec<&KnownPortal> = sequence.iter().map(|&gate| gates.known(gate)).collect();
        match self.stabber.stab_known(&shapes, hint.as_ref()) {
            Verdict::Visible(line) => {
                // Followed further, the line may pass more gates; where rounding could matter, the exact decision
                // stands.
                self.counted.lines += 1;
                gates.chain(sequence[0], line.a, unit(sub(line.b, line.a)), &mut self.chain);
                if self.chain.contains(&sequence[sequence.len() - 1]) {
                    return true;
                }
                self.levels[depth].line = Some(line);
                let arrives = goal.is_none() && gates.are_in_order(&sequence, [line.a, line.b]);
                // Nothing is known of lines that meet the gates in order.
                self.undecided |= goal.is_none() && !arrives;
                self.chain = sequence;
                arrives
            }
            Verdict::Hidden(proof) => {
                self.learn(&proof, &sequence, depth, goal);
                false
            }
            Verdict::Undecided(_) if goal.is_some() => false,
            Verdict::Undecided(_) => {
                let shapes: Vec<&Portal3> = shapes.iter().map(|known| known.shape()).collect();
                match self.stabber.stab_finely(&shapes) {
                    Verdict::Visible(line) if gates.are_in_order(&sequence, line.points().map(|p| p.map(|x| x[0]))) => {
                        self.chain = sequence;
                        return true;
                    }
                    Verdict::Visible(_) => self.undecided = true,
                    Verdict::Hidden(proof) => self.learn(&proof, &sequence, depth, goal),
                    Verdict::Undecided(_) => self.undecided = true,
                }
                false
            }
        }
    }

    /// Learns which gates of a sequence no line passes, and up to which level none does.
    fn learn(&mut self, proof: &ConvexCertificate, sequence: &[u32], depth: usize, goal: Option<u32>) {
        let mut named = proof.named();
        if let Some(mut last) = named.pop() {
            if named.len() <= MOST_LEARNT {
                let others = named.iter().map(|&place| sequence[place]).collect();
                let gate = sequence[last];
                self.learnt[gate as usize].push(others);
                self.learnt_of.push(gate);
            }
            // The goal comes last, whatever lies between.
            if goal.is_some() && last > depth {
                last = named.pop().unwrap_or(0);
            }
            self.blocked = last;
        }
    }

    /// Whether the first levels and a gate are known to be blocked. Gates are stored in order, and a proof may depend
    /// on it.
    fn is_learnt(&self, n_levels: usize, gate: u32) -> bool {
        self.learnt[gate as usize].iter().any(|set| {
            let mut on_way = self.levels[..n_levels].iter().map(|level| level.gate);
            set.iter().all(|other| on_way.any(|gate| gate == *other))
        })
    }
}

/// A pair of cells and the gate in question.
struct Pair<'a> {
    a: u32,
    b: u32,
    /// The gate into `b` by which it is to be reached.
    goal: u32,
    through: &'a BitMatrix,
}

/// The cells of a row, as ids.
pub(super) fn cells_of(row: &[u64]) -> impl Iterator<Item = u32> + '_ {
    ones(row).map(|cell| cell as u32)
}

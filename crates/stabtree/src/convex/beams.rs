//! What may be seen through one gate: beams of lines, followed from portal to portal.
//!
//! A beam is all lines through the source gate and a part of a later gate. In the cell behind that gate it meets
//! further gates; planes between the source and the part (see [`cut`](super::cut)) cut off what the beam cannot
//! reach, and what is left of a gate makes the next beam. Cells that no beam reaches are hidden.
//!
//! Three things keep the number of beams small:
//!
//! * Only cells that are in doubt are searched for, and a beam carries them along: cells on the wrong side of its new
//!   planes, or known not to be visible through the gate, are dropped, and a beam without any ends. So does one at a
//!   gate through which, looking back, the first cell is known not to be visible.
//! * What lies beyond a part of a gate depends on the source and the part, not on the route to it. So a beam ends if
//!   its part lies within the part of an earlier beam whose targets include its own. (The earlier one may still be
//!   waiting; all beams are followed in the end.)
//! * After [`MOST_PARTS`] parts of one gate, the next one is the whole gate: from then on every beam through it ends at
//!   once. This bounds the work for a source by the number of gates, at the price of looser answers where a thousand
//!   routes lead through open space; later stages decide those exactly.
//!
//! When a beam reaches a cell in doubt, an exact search looks for a line through its sequence of gates. If there is
//! none, the cell is left to a later stage, which follows sequences of gates one by one.

use super::ConvexSearchCounters;
use super::cell_set::CellSet;
use super::cut::{Cutter, Part, Plane, Vertex, is_within, middle};
use super::gates::{Gate, Gates, Memory};
use super::vector::{add, sub, unit};
use sightlines_pvs::BitMatrix;
use sightlines_sightline::{ConvexStabber, KnownPortal, Line3, StabLimits, Verdict};

/// How many different parts of one gate are followed before the whole gate is.
const MOST_PARTS: usize = 8;

/// Beams only need a line; proofs are left to a later stage.
const ONLY_LINES: StabLimits = StabLimits { boxes: 1, turns: 8 };

/// A part of a gate, and the cells that are searched for behind it.
#[derive(Debug)]
struct Beam {
    gate: u32,
    /// The beam that it continues; the first one is its own parent.
    parent: u32,
    part: Part,
    wanted: CellSet,
}

/// Scratch space for beams; one for each thread.
#[derive(Debug)]
pub(super) struct BeamTracer {
    cutter: Cutter,
    stabber: ConvexStabber,
    programs_before: u64,
    counted: ConvexSearchCounters,
    beams: Vec<Beam>,
    n_beams_used: usize,
    waiting: Vec<u32>,
    /// The beams of each gate.
    by_gate: Vec<Vec<u32>>,
    planes: Vec<Plane>,
    chain: Vec<u32>,
    source: Part,
    part: Part,
    wanted: CellSet,
    followed: CellSet,
    sequence: Vec<u32>,
    /// Which gates may follow the source.
    follows: Memory,
}

/// The results for one gate.
#[derive(Debug, Default)]
pub(super) struct Traced {
    /// The cells that were in doubt and are not visible through the gate.
    pub(super) hidden: Vec<u64>,
    /// Lines that prove cells visible: the gates that each passes.
    pub(super) chains: Vec<Vec<u32>>,
}

impl BeamTracer {
    pub(super) fn new(gates: &Gates) -> Self {
        Self {
            cutter: Cutter::new(gates.largest),
            stabber: ConvexStabber::new(ONLY_LINES),
            programs_before: 0,
            counted: ConvexSearchCounters::default(),
            beams: Vec::new(),
            n_beams_used: 0,
            waiting: Vec::new(),
            by_gate: vec![Vec::new(); gates.len()],
            planes: Vec::new(),
            chain: Vec::new(),
            source: Vec::new(),
            part: Vec::new(),
            wanted: CellSet::default(),
            followed: CellSet::default(),
            sequence: Vec::new(),
            follows: Memory::new(gates.len()),
        }
    }

    /// The work done since the last call.
    pub(super) fn take_counters(&mut self) -> ConvexSearchCounters {
        let programs = self.stabber.counters().n_programs;
        self.counted.programs = programs - std::mem::replace(&mut self.programs_before, programs);
        self.counted.clips = std::mem::take(&mut self.cutter.clips);
        std::mem::take(&mut self.counted)
    }

    /// Searches through the gate `source` for the cells in `in_doubt`. Row `g` of `through` has the cells that may be
    /// seen through gate `g`.
    pub(super) fn trace(&mut self, gates: &Gates, source: u32, mut in_doubt: Vec<u64>, through: &BitMatrix) -> Traced {
        let mut traced = Traced::default();
        if in_doubt.iter().all(|&w| w == 0) {
            traced.hidden = in_doubt;
            return traced;
        }
        let Gate { from: home, to: next, .. } = *gates.get(source);
        self.follows.forget();
        if in_doubt[next as usize / 64] >> (next % 64) & 1 == 1 {
            self.seek(gates, source, None, source, &[], &mut in_doubt, &mut traced);
        }
        self.part.clear();
        self.part.extend_from_slice(gates.corners(source));
        self.wanted.set(&in_doubt);
        self.wanted.retain(|cell| {
            gates.exits(cell as u32).iter().any(|&exit| {
                through.get(exit as usize, home as usize)
                    && (exit ^ 1 == source || self.follows.ask(exit ^ 1, || gates.may_follow(source, exit ^ 1)))
            })
        });
        self.push(source, 0);
        while let Some(beam) = self.waiting.pop() {
            self.follow(gates, source, home, beam, &mut in_doubt, through, &mut traced);
        }
        for beam in &self.beams[..self.n_beams_used] {
            self.by_gate[beam.gate as usize].clear();
        }
        self.n_beams_used = 0;
        // What is still in doubt was not reached.
        traced.hidden = in_doubt;
        traced
    }

    /// Adds the beam of `self.part` and `self.wanted`.
    fn push(&mut self, gate: u32, parent: u32) {
        if self.n_beams_used == self.beams.len() {
            self.beams.push(Beam { gate: 0, parent: 0, part: Vec::new(), wanted: CellSet::default() });
        }
        let beam = &mut self.beams[self.n_beams_used];
        (beam.gate, beam.parent) = (gate, parent);
        std::mem::swap(&mut beam.part, &mut self.part);
        std::mem::swap(&mut beam.wanted, &mut self.wanted);
        self.by_gate[gate as usize].push(self.n_beams_used as u32);
        self.waiting.push(self.n_beams_used as u32);
        self.n_beams_used += 1;
    }

    #[expect(clippy::too_many_arguments, reason = "the state of one trace, borrowed in pieces")]
    fn follow(
        &mut self,
        gates: &Gates,
        source: u32,
        home: u32,
        beam: u32,
        in_doubt: &mut [u64],
        through: &BitMatrix,
        traced: &mut Traced,
    ) {
        let Beam { gate: at, wanted: ref looked_for, .. } = self.beams[beam as usize];
        let mut wanted = std::mem::take(&mut self.followed);
        wanted.set_common(looked_for, in_doubt, in_doubt);
        if !wanted.is_empty() {
            self.counted.beams += 1;
            let meets = self.find_planes(gates, source, beam);
            drop_hidden(&self.planes, gates, self.cutter.eps, &mut wanted);
            if meets && !wanted.is_empty() {
                for &exit in gates.next(at) {
                    // Looking back through the exit, a line sees the cell that it comes from.
                    if gates.get(exit).to != home && through.get((exit ^ 1) as usize, home as usize) {
                        self.pass(gates, source, beam, exit, &wanted, in_doubt, through, traced);
                    }
                }
            }
        }
        self.followed = wanted;
    }

    /// The planes that bound a beam: those between the source and the part, and the source's own.
    ///
    /// `false` if the source lies wholly in front of the part, so that no line passes both.
    fn find_planes(&mut self, gates: &Gates, source: u32, beam: u32) -> bool {
        self.planes.clear();
        let Beam { gate: at, ref part, .. } = self.beams[beam as usize];
        if at == source {
            return true;
        }
        self.source.clear();
        self.source.extend_from_slice(gates.corners(source));
        // Lines through the gate come from behind its plane.
        if !self.cutter.cut(&mut self.source, &gates.behind(at)) {
            return false;
        }
        self.cutter.separators(&self.source, part, &mut self.planes);
        self.planes.push(gates.in_front(source));
        true
    }

    /// Continues through a gate, if something is left of it and of the cells wanted behind it.
    #[expect(clippy::too_many_arguments, reason = "the state of one trace, borrowed in pieces")]
    fn pass(
        &mut self,
        gates: &Gates,
        source: u32,
        beam: u32,
        exit: u32,
        wanted: &CellSet,
        in_doubt: &mut [u64],
        through: &BitMatrix,
        traced: &mut Traced,
    ) {
        self.wanted.set_common(wanted, in_doubt, through.row(exit as usize));
        if self.wanted.is_empty() {
            return;
        }
        if !self.follows.ask(exit, || gates.may_follow(source, exit)) {
            return;
        }
        let gate = gates.get(exit);
        self.part.clear();
        self.part.extend_from_slice(gates.corners(exit));
        if !self.cutter.cut_all(&mut self.part, &gate.ball(), self.planes.iter()) {
            return;
        }
        if self.wanted.has(gate.to) {
            // The search for a line uses the gates themselves; the part is only a hint.
            let part = std::mem::take(&mut self.part);
            self.seek(gates, source, Some(beam), exit, &part, in_doubt, traced);
            self.part = part;
        }
        self.wanted.keep(in_doubt);
        if self.wanted.is_empty() {
            return;
        }
        for &earlier in &self.by_gate[exit as usize] {
            let earlier = &self.beams[earlier as usize];
            if self.wanted.meets(&earlier.wanted) && is_within(&self.part, &earlier.part, gate.normal) {
                self.wanted.remove(&earlier.wanted);
                if self.wanted.is_empty() {
                    return;
                }
            }
        }
        if self.by_gate[exit as usize].len() >= MOST_PARTS {
            self.part.clear();
            self.part.extend_from_slice(gates.corners(exit));
        }
        self.push(exit, beam);
    }

    /// Searches for a line through the gates that lead to `exit`, whose cell is in doubt. In either case the cell is no
    /// longer in doubt here: without a line it is left to a later stage.
    #[expect(clippy::too_many_arguments, reason = "the state of one trace, borrowed in pieces")]
    fn seek(
        &mut self,
        gates: &Gates,
        source: u32,
        beam: Option<u32>,
        exit: u32,
        part: &[Vertex],
        in_doubt: &mut [u64],
        traced: &mut Traced,
    ) {
        let (cell, first) = (gates.get(exit).to as usize, gates.get(source));
        let (start, end) = match beam {
            None => (first.center, add(first.center, first.normal)),
            Some(beam) if self.beams[beam as usize].gate == source => (first.center, middle(part)),
            Some(_) => (middle(&self.source), middle(part)),
        };
        self.counted.lines += 1;
        gates.chain(source, start, unit(sub(end, start)), &mut self.chain);
        if !self.chain.iter().any(|&g| gates.get(g).to as usize == cell) {
            self.chain.clear();
            self.sequence_to(beam, exit);
            let shapes: Vec<&KnownPortal> = self.sequence.iter().map(|&g| gates.known(g)).collect();
            let hint = Line3::through(start, end);
            if let Verdict::Visible(line) = self.stabber.stab_known(&shapes, hint.as_ref()) {
                // Followed further, the line may pass more gates; where rounding could matter, the exact decision
                // stands.
                self.counted.lines += 1;
                gates.chain(source, line.a, unit(sub(line.b, line.a)), &mut self.chain);
                if !self.chain.iter().any(|&g| gates.get(g).to as usize == cell) {
                    self.chain.clear();
                    if gates.are_in_order(&self.sequence, [line.a, line.b]) {
                        self.chain.clone_from(&self.sequence);
                    }
                }
            }
        }
        in_doubt[cell / 64] &= !(1 << (cell % 64));
        for &g in &self.chain {
            for cell in [gates.get(g).from as usize, gates.get(g).to as usize] {
                in_doubt[cell / 64] &= !(1 << (cell % 64));
            }
        }
        if !self.chain.is_empty() {
            traced.chains.push(self.chain.clone());
        }
    }

    /// The gates from the source to `exit` along the beam's route; without a beam, `exit` is the source.
    fn sequence_to(&mut self, beam: Option<u32>, exit: u32) {
        self.sequence.clear();
        self.sequence.push(exit);
        let mut last = beam;
        while let Some(beam) = last {
            let Beam { gate, parent, .. } = self.beams[beam as usize];
            self.sequence.push(gate);
            last = (parent != beam).then_some(parent);
        }
        self.sequence.reverse();
    }
}

/// Drops the cells whose portals all lie below one of the planes.
fn drop_hidden(planes: &[Plane], gates: &Gates, eps: f64, wanted: &mut CellSet) {
    if !planes.is_empty() {
        wanted.retain(|cell| {
            let [min, max] = &gates.boxes[cell];
            planes.iter().all(|plane| plane.highest(min, max) >= -2.0 * eps)
        });
    }
}

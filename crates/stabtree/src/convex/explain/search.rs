//! The search for a line between two cells, or for what blocks all chains of gates.

use super::super::gates::Gates;
use super::super::vector::{dot, sub, unit};
use super::{BlockedConvex, Blocking, ConvexDoubt, ConvexExplanation, ConvexGate, ConvexPath, ConvexProof};
use crate::explanation::{Barrier, SearchLimit, Sight};
use sightlines_cells::{CellId, Portal3, PortalId};
use sightlines_sightline::{
    BoxProof, ConvexCertificate, ConvexNode, ConvexStabber, ConvexTerm, ConvexVerdict, HullProof, Line3, PlaneProof,
    StabLimits, Verdict,
};

/// A gate into the goal that lines may reach through the chain, and one that does.
#[derive(Debug, Clone, Copy)]
struct Aim {
    gate: u32,
    /// `None` if no line is known, nor that there is none.
    line: Option<Line3>,
}

/// A cell on the way.
#[derive(Debug)]
struct Level {
    cell: u32,
    /// Exits still to try, the best last.
    exits: Vec<u32>,
    aims: Vec<Aim>,
}

/// One search, from one cell to another.
#[derive(Debug)]
pub(super) struct Search<'g> {
    gates: &'g Gates,
    start: u32,
    goal: u32,
    stabber: ConvexStabber,
    asked: u64,
    limit: u64,
    chain: Vec<u32>,
    /// The position of each gate in the chain, from 1; 0 for gates that are not in it.
    place: Vec<u32>,
    is_met: Vec<bool>,
    blocked: Vec<BlockedConvex>,
    /// For each gate, lists of gates after which no line passes it.
    learnt: Vec<Vec<Vec<u32>>>,
    visible: Option<(Vec<u32>, Line3)>,
    undecided: Option<Vec<u32>>,
    /// The last walk that reached each cell.
    seen: Vec<u32>,
    n_walks: u32,
}

impl<'g> Search<'g> {
    pub(super) fn new(gates: &'g Gates, start: u32, goal: u32, limit: u64) -> Self {
        Self {
            gates,
            start,
            goal,
            stabber: ConvexStabber::new(StabLimits::default()),
            asked: 0,
            limit,
            chain: Vec::new(),
            place: vec![0; gates.len()],
            is_met: vec![false; gates.n_cells()],
            blocked: Vec::new(),
            learnt: vec![Vec::new(); gates.len()],
            visible: None,
            undecided: None,
            seen: vec![0; gates.n_cells()],
            n_walks: 0,
        }
    }

    pub(super) fn run(mut self) -> ConvexExplanation {
        self.is_met[self.start as usize] = true;
        let entries = self.gates.exits(self.goal).iter().map(|gate| gate ^ 1);
        let aims: Vec<Aim> = entries.map(|gate| Aim { gate, line: None }).collect();
        if !self.reaches(self.start) {
            return Verdict::Hidden(Barrier::NotConnected);
        }
        let mut levels = vec![Level { cell: self.start, exits: self.gates.exits(self.start).to_vec(), aims }];
        while let Some(level) = levels.last_mut() {
            let Some(exit) = level.exits.pop() else {
                self.is_met[level.cell as usize] = false;
                levels.pop();
                if let Some(gate) = self.chain.pop() {
                    self.place[gate as usize] = 0;
                }
                continue;
            };
            if self.asked >= self.limit {
                return Verdict::Undecided(ConvexDoubt::Limit(SearchLimit(self.limit)));
            }
            let to = self.gates.get(exit).to;
            if self.is_met[to as usize] || self.is_learnt(exit) {
                continue;
            }
            if to == self.goal {
                let aim = level.aims.iter().find(|aim| aim.gate == exit).copied();
                self.arrive(exit, aim);
            } else {
                let aims = std::mem::take(&mut level.aims);
                let next = self.enter(exit, &aims);
                level.aims = aims;
                levels.extend(next);
            }
            if let Some((chain, line)) = self.visible.take() {
                return Verdict::Visible(Sight::Along(ConvexPath { gates: named(&chain), line }));
            }
        }
        match self.undecided {
            Some(chain) => Verdict::Undecided(ConvexDoubt::Chain(named(&chain))),
            None => {
                let proof = ConvexProof { start: CellId(self.start), blocked: self.blocked };
                Verdict::Hidden(Barrier::Blocked(proof))
            }
        }
    }

    /// The chain leads through `gate` into the goal.
    fn arrive(&mut self, gate: u32, aim: Option<Aim>) {
        let sequence = [&self.chain[..], &[gate]].concat();
        let line = match aim.and_then(|aim| aim.line) {
            Some(line) => Verdict::Visible(line),
            None => self.ask(&sequence, None),
        };
        match line {
            Verdict::Visible(line) if self.gates.are_in_order(&sequence, [line.a, line.b]) => {
                self.visible = Some((sequence, line));
            }
            Verdict::Hidden(_) => {}
            Verdict::Visible(_) | Verdict::Undecided(_) => self.undecided = self.undecided.take().or(Some(sequence)),
        }
    }

    /// Extends the chain by `exit`, if lines may continue from there to the goal.
    fn enter(&mut self, exit: u32, aims: &[Aim]) -> Option<Level> {
        // Steps count too, so that the time is bounded even without queries.
        self.asked += 1;
        if let Some(&behind) = self.chain.iter().find(|&&gate| !self.gates.may_follow(gate, exit)) {
            self.block_pair(behind, exit);
            return None;
        }
        let sequence = [&self.chain[..], &[exit]].concat();
        let passes = |line: &Line3| line.passes(self.gates.shape(exit));
        let near = aims.iter().find_map(|aim| aim.line);
        if !aims.iter().any(|aim| aim.line.as_ref().is_some_and(passes))
            && matches!(self.ask(&sequence, near.as_ref()), Verdict::Hidden(_))
        {
            return None;
        }
        self.chain.push(exit);
        self.place[exit as usize] = self.chain.len() as u32;
        let to = self.gates.get(exit).to;
        self.is_met[to as usize] = true;
        let aims = self.aim(exit, aims);
        if !aims.is_empty() && self.reaches(to) {
            let lines: Vec<_> = aims.iter().filter_map(|aim| aim.line).collect();
            let mut exits = self.gates.exits(to).to_vec();
            let is_met = |line: &Line3, gate: u32| line.passes(self.gates.shape(gate));
            exits.sort_by_cached_key(|&gate| lines.iter().filter(|line| is_met(line, gate)).count());
            return Some(Level { cell: to, exits, aims });
        }
        self.is_met[to as usize] = false;
        self.chain.pop();
        self.place[exit as usize] = 0;
        None
    }

    /// The gates into the goal that lines through the chain may reach, among those of the chain without its last gate.
    fn aim(&mut self, last: u32, aims: &[Aim]) -> Vec<Aim> {
        let mut left = Vec::new();
        for aim in aims {
            if self.is_learnt(aim.gate) {
                continue;
            }
            if !self.gates.may_follow(last, aim.gate) {
                self.block_pair(last, aim.gate);
                continue;
            }
            let sequence = [&self.chain[..], &[aim.gate]].concat();
            let known =
                aim.line.filter(|line| line.passes(self.gates.shape(last)) && self.is_in_order(line, &sequence));
            let line = match known {
                Some(line) => Some(line),
                None => match self.ask(&sequence, aim.line.as_ref()) {
                    Verdict::Visible(line) => {
                        self.follow(last, line);
                        Some(line).filter(|line| self.is_in_order(line, &sequence))
                    }
                    Verdict::Hidden(_) => continue,
                    Verdict::Undecided(_) => None,
                },
            };
            left.push(Aim { gate: aim.gate, line });
        }
        left
    }

    /// Whether a line crosses gates one after the other, up to rounding.
    fn is_in_order(&self, line: &Line3, sequence: &[u32]) -> bool {
        let direction = unit(sub(line.b, line.a));
        let at = |&gate: &u32| {
            let g = self.gates.get(gate);
            dot(g.normal, sub(g.center, line.a)) / dot(g.normal, direction)
        };
        sequence.windows(2).all(|pair| at(&pair[0]) <= at(&pair[1]))
    }

    /// Follows a line through the chain behind its last gate; it may lead to the goal.
    fn follow(&mut self, last: u32, line: Line3) {
        let mut passed = Vec::new();
        self.gates.follow(last, line.a, unit(sub(line.b, line.a)), &mut passed);
        let Some(end) = passed.iter().position(|&gate| self.gates.get(gate).to == self.goal) else { return };
        let chain = [&self.chain[..], &passed[..=end]].concat();
        let mut is_met = self.is_met.clone();
        let once = passed[..=end].iter().all(|&g| !std::mem::replace(&mut is_met[self.gates.get(g).to as usize], true));
        let passes = |&gate: &u32| line.passes(self.gates.shape(gate));
        if once && chain.iter().all(passes) && self.gates.are_in_order(&chain, [line.a, line.b]) {
            self.visible = Some((chain, line));
        }
    }

    /// Queries whether a line passes gates in order, and learns the reason if not.
    fn ask(&mut self, sequence: &[u32], hint: Option<&Line3>) -> ConvexVerdict {
        self.asked += 1;
        let shapes: Vec<&Portal3> = sequence.iter().map(|&gate| self.gates.shape(gate)).collect();
        let mut answer = self.stabber.stab(&shapes, hint);
        if matches!(answer, Verdict::Undecided(_))
            && let Verdict::Hidden(proof) = self.stabber.stab_finely(&shapes)
        {
            answer = Verdict::Hidden(proof);
        }
        if let Verdict::Hidden(proof) = &answer {
            let (places, certificate) = narrowed(proof);
            let gates: Vec<u32> = places.into_iter().map(|place| sequence[place]).collect();
            if let Some((&last, before)) = gates.split_last() {
                self.learnt[last as usize].push(before.to_vec());
                self.blocked
                    .push(BlockedConvex { gates: named(&gates), reason: Blocking::Certificate(Box::new(certificate)) });
            }
        }
        answer
    }

    /// Learns that no line passes two gates one after the other, because of their planes.
    fn block_pair(&mut self, first: u32, second: u32) {
        if !matches!(self.ask(&[first, second], None), Verdict::Hidden(_)) {
            self.learnt[second as usize].push(vec![first]);
            self.blocked.push(BlockedConvex { gates: named(&[first, second]), reason: Blocking::Behind });
        }
    }

    /// Whether a learnt list shows that no line passes the chain and then this gate.
    fn is_learnt(&self, gate: u32) -> bool {
        let is_on_way = |list: &[u32]| {
            let mut last = 0;
            list.iter().all(|&g| {
                let place = self.place[g as usize];
                place > std::mem::replace(&mut last, place)
            })
        };
        self.learnt[gate as usize].iter().any(|list| is_on_way(list))
    }

    /// Whether the graph leads from a cell to the goal, avoiding the cells of the chain and learnt lists.
    fn reaches(&mut self, from: u32) -> bool {
        self.n_walks += 1;
        let mut waiting = vec![from];
        while let Some(cell) = waiting.pop() {
            for &exit in self.gates.exits(cell) {
                let to = self.gates.get(exit).to;
                let seen = self.seen[to as usize] == self.n_walks;
                if seen || self.is_met[to as usize] || self.is_learnt(exit) {
                    continue;
                }
                if to == self.goal {
                    return true;
                }
                self.seen[to as usize] = self.n_walks;
                waiting.push(to);
            }
        }
        false
    }
}

/// Gates in their public form.
fn named(gates: &[u32]) -> Vec<ConvexGate> {
    gates.iter().map(|&gate| ConvexGate { portal: PortalId(gate / 2), forward: gate % 2 == 0 }).collect()
}

/// The positions in a sequence that a certificate needs, and the certificate for these alone.
fn narrowed(proof: &ConvexCertificate) -> (Vec<usize>, ConvexCertificate) {
    let places = proof.named();
    let rank = |place: usize| places.partition_point(|&p| p < place);
    let narrow = match proof {
        ConvexCertificate::Boxes(BoxProof { portals, blocks, nodes }) => {
            let term = |t: &ConvexTerm| ConvexTerm { portal: rank(t.portal), ..*t };
            let node = |node: &ConvexNode| match node {
                ConvexNode::Leaf(terms) => ConvexNode::Leaf(terms.iter().map(term).collect()),
                split @ ConvexNode::Split { .. } => split.clone(),
            };
            let nodes = nodes.iter().map(node).collect();
            ConvexCertificate::Boxes(BoxProof { portals: portals.map(rank), blocks: *blocks, nodes })
        }
        ConvexCertificate::Plane(PlaneProof { edge, corner, stops }) => {
            let at = |(portal, k): (usize, usize)| (rank(portal), k);
            ConvexCertificate::Plane(PlaneProof { edge: at(*edge), corner: at(*corner), stops: stops.map(rank) })
        }
        ConvexCertificate::Hulls(HullProof { portals, terms }) => {
            let terms = terms.iter().map(|t| ConvexTerm { portal: rank(t.portal), ..*t }).collect();
            ConvexCertificate::Hulls(HullProof { portals: portals.map(rank), terms })
        }
        // A certificate of another kind is for the sequence up to its last position.
        other => return ((0..=places.last().copied().unwrap_or(0)).collect(), other.clone()),
    };
    (places, narrow)
}

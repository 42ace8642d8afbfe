//! Aims at sequences of portals that stab trees do not have.

use super::ways::{Ways, inside};
use crate::exact::snapped;
use crate::findings::Violation;
use crate::oracle::{RayOracle, climb, sub};
use crate::sight::{SightSegment, Target};
use sightlines_geometry::Random;
use sightlines_pvs::{CellId, PortalId, StabTrees};
use std::collections::{HashMap, HashSet, VecDeque};

/// A sequence of portals out of a cell that a stab tree has, and a portal that does not follow it there.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Absent {
    from: CellId,
    /// May be empty: then the portal is none of the tree's roots.
    passed: Vec<PortalId>,
    next: PortalId,
}

/// Portals that are looked at behind nodes; with more, only behind some of these.
const MOST_NEXT: usize = 1 << 26;

/// Sequences that are aimed at for each hidden pair that is. Most of them no line passes, which is known after some signs: all 163,845 of a furnished
/// floor with 25,462 nodes took some two seconds.
pub(super) const FOR_EACH_PAIR: u64 = 16;

/// How far segments reach beyond the first and the last portal, as shares of the way between the two: into thin cells, and beyond what doubles
/// round.
const BEYOND: [f64; 2] = [1.0 / 256.0, 1.0 / (1u64 << 20) as f64];

impl Ways<'_> {
    /// Up to `most` sequences that stab trees do not have and that are one portal longer than one that they have, the most suspicious first: those
    /// that most of the nodes with the same gate have. Of each node the shortest sequence counts. Cells that are hidden altogether are aimed at
    /// elsewhere. Of very large trees only some nodes are looked at, spread over all.
    pub(super) fn absent(&self, stab: &StabTrees, most: u64) -> Vec<Absent> {
        let most = usize::try_from(most).unwrap_or(usize::MAX);
        let (shortest, followers) = (Shortest::of(stab), Followers::of(stab));
        let mut best: Vec<(f64, Option<u32>, CellId, PortalId)> = Vec::new();
        // What comes first stays first among equals.
        let cut = |best: &mut Vec<(f64, Option<u32>, CellId, PortalId)>| {
            best.sort_by(|a, b| b.0.total_cmp(&a.0));
            best.truncate(most);
        };
        for cell in (0..stab.n_cells() as u32).map(CellId).filter(|&cell| !stab.is_root_open(cell)) {
            // Through a portal alone there is always a line.
            let missing = self.not_among(stab, cell, stab.roots(cell));
            best.extend(missing.into_iter().map(|next| (2.0, None, cell, next)));
        }
        let into = |node: u32| {
            let (entry, forward) = stab.gate(node);
            self.portal(entry).cells[usize::from(forward)]
        };
        let n_next: usize = (0..stab.n_nodes() as u32).map(|node| self.portals_of(into(node)).len()).sum();
        let step = n_next.div_ceil(MOST_NEXT).max(1);
        for node in (0..stab.n_nodes() as u32).step_by(step).filter(|&node| !stab.is_open(node)) {
            let (entry, from) = (stab.gate(node).0, shortest.root(node));
            for next in self.not_among(stab, into(node), stab.children(node)) {
                if next != entry && self.portal(next).cells.iter().all(|&cell| self.table().sees(from, cell)) {
                    best.push((followers.share(stab.gate(node), next), Some(node), from, next));
                }
            }
            if best.len() / 4 > most {
                cut(&mut best);
            }
        }
        cut(&mut best);
        let absent = |(_, node, from, next)| Absent { from, passed: shortest.passed(stab, node), next };
        best.into_iter().map(absent).collect()
    }

    /// The portals of a cell that no node of a list crosses, in their order.
    fn not_among(&self, stab: &StabTrees, cell: CellId, nodes: &[u32]) -> Vec<PortalId> {
        let crossed: HashSet<PortalId> = nodes.iter().map(|&node| stab.gate(node).0).collect();
        self.portals_of(cell).iter().copied().filter(|portal| !crossed.contains(portal)).collect()
    }

    /// Looks for a free segment along a sequence, with about so many rays.
    pub(super) fn aim<R: RayOracle>(
        &self,
        world: &R,
        Absent { from, passed, next }: &Absent,
        tries: u32,
        random: &mut Random,
    ) -> Option<Violation> {
        let mut cell = *from;
        for &portal in passed.iter().chain([next]) {
            let [a, b] = self.portal(portal).cells;
            cell = if a == cell { b } else { a };
        }
        let beyond = |[a, b]: [[f64; 3]; 2], share: f64| {
            let d = sub(b, a);
            [-share, 1.0 + share].map(|s| snapped([0, 1, 2].map(|k| a[k] + d[k] * s)))
        };
        let Some((&first, between)) = passed.split_first() else {
            return self.through_one(world, *from, *next, random);
        };
        let openness = |ends| {
            let segment = beyond(ends, BEYOND[0]);
            let n = between.iter().filter(|&&portal| world.crosses(self.portal(portal), segment)).count();
            if n == between.len() { 1.0 } else { n as f64 / between.len() as f64 }
        };
        let mut found = None;
        let mut is_good = |ends| {
            found = BEYOND.iter().find_map(|&share| {
                let sight = SightSegment { from: *from, target: Target::Cell(cell), segment: beyond(ends, share) };
                self.follow(world, &sight).1
            });
            found.is_some()
        };
        let ends = [first, *next];
        let boxes = ends.map(|portal| self.around(portal));
        (0..(tries / 16).max(1)).find(|_| {
            let start = ends.map(|portal| inside(&self.portal(portal).points, random));
            climb(start, boxes, 16, random, openness, &mut is_good).is_some()
        })?;
        found
    }
}

/// How often which portals follow a gate.
#[derive(Debug)]
struct Followers {
    nodes: HashMap<(PortalId, bool), u32>,
    children: HashMap<(PortalId, bool, PortalId), u32>,
}

impl Followers {
    fn of(stab: &StabTrees) -> Self {
        let (mut nodes, mut children) = (HashMap::new(), HashMap::new());
        for node in 0..stab.n_nodes() as u32 {
            let (portal, forward) = stab.gate(node);
            *nodes.entry((portal, forward)).or_default() += 1;
            for &child in stab.children(node) {
                *children.entry((portal, forward, stab.gate(child).0)).or_default() += 1;
            }
        }
        Self { nodes, children }
    }

    /// The share of the nodes with a gate that have a portal among their children.
    fn share(&self, gate: (PortalId, bool), next: PortalId) -> f64 {
        let n = self.children.get(&(gate.0, gate.1, next)).copied().unwrap_or(0);
        f64::from(n) / f64::from(self.nodes[&gate])
    }
}

/// The shortest way to each node.
#[derive(Debug)]
struct Shortest {
    /// For each node the one before it, or none for a root, and the cell that its tree is of.
    before: Vec<(Option<u32>, CellId)>,
}

impl Shortest {
    fn of(stab: &StabTrees) -> Self {
        let mut before: Vec<Option<(Option<u32>, CellId)>> = vec![None; stab.n_nodes()];
        let mut queue = VecDeque::new();
        for cell in (0..stab.n_cells() as u32).map(CellId) {
            for &root in stab.roots(cell) {
                if before[root as usize].is_none() {
                    before[root as usize] = Some((None, cell));
                    queue.push_back(root);
                }
            }
        }
        while let Some(node) = queue.pop_front() {
            let cell = before[node as usize].expect("queued nodes are reached").1;
            for &child in stab.children(node) {
                if before[child as usize].is_none() {
                    before[child as usize] = Some((Some(node), cell));
                    queue.push_back(child);
                }
            }
        }
        // Each node is reached from some root.
        Self { before: before.into_iter().map(|b| b.unwrap_or((None, CellId(0)))).collect() }
    }

    /// The cell that the way to a node begins in.
    fn root(&self, node: u32) -> CellId {
        self.before[node as usize].1
    }

    /// The portals that lead to a node, its own the last.
    fn passed(&self, stab: &StabTrees, node: Option<u32>) -> Vec<PortalId> {
        let mut nodes: Vec<u32> = std::iter::successors(node, |&n| self.before[n as usize].0).collect();
        nodes.reverse();
        nodes.into_iter().map(|n| stab.gate(n).0).collect()
    }
}

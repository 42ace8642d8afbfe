//! Why one cell in space sees another, or why it does not.

use super::opaque::opaque_rectangles;
use crate::explanation::{Barrier, Explanation, SearchLimit, Sight};
use sightlines_cells::{Axial, CellGraph, CellId, Exit, PortalId};
use sightlines_geometry::{Aabb, AxialDoor};
use sightlines_sightline::{
    AxialStabber, AxialWitness, BlockedProof, Blockers, BoxTarget, Branch, Shaft, ShaftLine, Stabber, Verdict,
};

/// The explanation for two cells in space.
pub type AxialExplanation = Explanation<AxialPath, AxialProof>;

/// How one cell in space sees another.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialPath {
    /// The portals between them, in order.
    pub portals: Vec<PortalId>,
    /// The cells entered, one for each portal; the last is the target.
    pub cells: Vec<CellId>,
    /// The same portals, oriented for crossing them in this order.
    pub doors: Vec<AxialDoor>,
    /// A line through all of them, which is checked exactly.
    pub witness: Box<AxialWitness>,
    /// Two points of that line, one inside each of the two cells; `None` if the line was found by way of the portals
    /// and may have no such points in doubles.
    pub ends: Option<[[f64; 3]; 2]>,
}

/// Why one cell in space does not see another: walls block all lines.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialProof {
    /// The proof, in terms of the indices of `walls`.
    pub proof: Box<BlockedProof>,
    /// The rectangles of walls in the way.
    pub walls: Vec<Aabb<3>>,
    /// Number of rectangles that all walls were merged into.
    pub n_blockers: usize,
}

impl AxialProof {
    /// How often the proof goes past each wall.
    pub fn n_steps(&self) -> Vec<usize> {
        fn count(branch: &Branch, n: &mut [usize]) {
            if let Branch::Past { rectangle, ways, .. } = branch {
                n[*rectangle as usize] += 1;
                ways.iter().for_each(|(_, branch)| count(branch, n));
            }
        }
        let mut n = vec![0; self.walls.len()];
        self.proof.octants.iter().for_each(|(_, branch)| count(branch, &mut n));
        n
    }

    /// The walls and how often the proof goes past each, the most often first.
    pub fn most_important(&self) -> Vec<(Aabb<3>, usize)> {
        let mut walls: Vec<_> = self.walls.iter().copied().zip(self.n_steps()).collect();
        walls.sort_by_key(|&(_, n)| std::cmp::Reverse(n));
        walls
    }
}

/// Most sequences of portals that are tried for a line that touches their edges.
const MAX_TRIES: u32 = 10_000;

/// Searches for a line from inside of `from` to inside of `to`, or for a proof that no open set of lines
/// leads there; one pair of [`AxialExplainer`], which is for many.
///
/// # Panics
/// If there are no such cells.
pub fn explain_axial(
    graph: &CellGraph<Axial>,
    solid: &[Aabb<3>],
    from: CellId,
    to: CellId,
    budget: u32,
) -> AxialExplanation {
    AxialExplainer::new(graph, solid).explain(from, to, budget)
}

/// Explains pairs of cells in space. Its walls are merged once, O(portals log portals).
#[derive(Debug)]
pub struct AxialExplainer<'a> {
    graph: &'a CellGraph<Axial>,
    blockers: Blockers,
}

impl<'a> AxialExplainer<'a> {
    /// For the cells of a graph.
    ///
    /// `solid`: boxes beside the cells that no line from a cell enters, as for
    /// [`axial_visibility`](super::axial_visibility); may be empty.
    pub fn new(graph: &'a CellGraph<Axial>, solid: &[Aabb<3>]) -> Self {
        Self { graph, blockers: Blockers::new(opaque_rectangles(graph, solid)) }
    }

    /// Searches for a line from inside of `from` to inside of `to`, or for a proof that no open set of lines
    /// leads there. `budget`: linear programs after which it gives up.
    ///
    /// Exact. Both a line and a proof were checked by code that shares nothing with the code that found them. Undecided
    /// means that the budget, or the digits of two doubles, were not enough. The answer does not depend on pairs that were
    /// asked before.
    ///
    /// # Panics
    /// If there are no such cells.
    pub fn explain(&self, from: CellId, to: CellId, budget: u32) -> AxialExplanation {
        let Self { graph, blockers } = self;
        if from == to {
            return Verdict::Visible(Sight::SameCell);
        }
        let useful = crate::explain::reaching(graph, to);
        if !useful[from.idx()] {
            return Verdict::Hidden(Barrier::NotConnected);
        }
        let [a, b] = [from, to].map(|cell| &graph.cell(cell).bounds);
        let mut shaft = Shaft::new(blockers);
        let explanation = match shaft.decide(a, b, BoxTarget::Inside, budget) {
            Verdict::Visible(line) => Walk::new(graph, &useful, &line, to).explain(from),
            // Cases that are left open may still be decided by the fractions of a proof.
            Verdict::Hidden(()) | Verdict::Undecided(_) => shaft
                .certify(a, b, BoxTarget::Inside, budget)
                .and_then(|proof| proof.narrowed(blockers.rectangles()))
                .filter(|(proof, walls)| proof.holds(a, b, BoxTarget::Inside, walls))
                .map(|(proof, walls)| {
                    let proof = AxialProof { proof: Box::new(proof), walls, n_blockers: blockers.len() };
                    Verdict::Hidden(Barrier::Blocked(proof))
                }),
        };
        explanation.unwrap_or(Verdict::Undecided(SearchLimit(budget.into())))
    }
}

/// Follows a free line through portals. Where it passes the common edge of portals, nearby lines pass one or the other,
/// so all that it touches are tried.
struct Walk<'a> {
    graph: &'a CellGraph<Axial>,
    useful: &'a [bool],
    line: &'a ShaftLine,
    to: CellId,
    path: Vec<Exit>,
    stabber: AxialStabber,
    tries: u32,
}

impl<'a> Walk<'a> {
    fn new(graph: &'a CellGraph<Axial>, useful: &'a [bool], line: &'a ShaftLine, to: CellId) -> Self {
        Self { graph, useful, line, to, path: Vec::new(), stabber: AxialStabber::new(), tries: 0 }
    }

    fn explain(mut self, from: CellId) -> Option<AxialExplanation> {
        if !self.reaches(from) {
            return None;
        }
        let doors: Vec<AxialDoor> = self.path.iter().map(|exit| self.graph.door(exit)).collect();
        let passes = |witness: &AxialWitness| doors.iter().all(|door| witness.passes(door));
        let free = Some(self.line.witness()).filter(passes);
        let ends = free.as_ref().and_then(|_| Some(self.line.free()?.points()));
        let witness = free.or_else(|| Some(self.stabber.witness()).filter(passes))?;
        Some(Verdict::Visible(Sight::Along(AxialPath {
            portals: self.path.iter().map(|exit| exit.portal).collect(),
            cells: self.path.iter().map(|exit| exit.to).collect(),
            doors,
            witness: Box::new(witness),
            ends,
        })))
    }

    /// Continues from a cell; afterwards `path` leads to the target. A line with a direction along every axis enters no
    /// cell twice, so this ends.
    fn reaches(&mut self, here: CellId) -> bool {
        if here == self.to {
            return true;
        }
        let graph = self.graph;
        for exit in graph.exits(here) {
            let door = graph.door(exit);
            if !self.useful[exit.to.idx()] || !self.line.touches(&door) || self.tries == MAX_TRIES {
                continue;
            }
            self.tries += 1;
            let undo = if self.path.is_empty() {
                self.stabber.start(door);
                None
            } else {
                let Some(undo) = self.stabber.push(door) else { continue };
                Some(undo)
            };
            self.path.push(*exit);
            if self.reaches(exit.to) {
                return true;
            }
            self.path.pop();
            undo.into_iter().for_each(|undo| self.stabber.undo(undo));
        }
        false
    }
}

//! Why one cell in space sees another, or why it does not.

use super::opaque::opaque_rectangles;
use sightlines_cells::{Axial, CellGraph, CellId, Exit, PortalId};
use sightlines_geometry::{Aabb, AxialDoor};
use sightlines_sightline::{
    AxialStabber, AxialWitness, BlockedProof, Blockers, FreeLine, Shaft, Stabber, Target, Verdict,
};

/// The answer for two cells in space.
#[derive(Debug, Clone, PartialEq)]
pub enum SpaceExplanation {
    /// They are one cell.
    Same,
    /// They see each other.
    Visible {
        /// The portals between them, in order.
        portals: Vec<PortalId>,
        /// The cells entered, one for each portal; the last is the target.
        cells: Vec<CellId>,
        /// The same portals as who walks through them sees them.
        doors: Vec<AxialDoor>,
        /// A line through all of them, which is checked exactly.
        witness: Box<AxialWitness>,
        /// Two points of that line, one inside each of the two cells; `None` if the line was found by way
        /// of the portals and may have no such points in doubles.
        ends: Option<[[f64; 3]; 2]>,
    },
    /// They do not, though portals lead from one to the other.
    Hidden {
        /// Why, by the indices of `walls`.
        proof: Box<BlockedProof>,
        /// The rectangles of walls in the way.
        walls: Vec<Aabb<3>>,
        /// Number of rectangles that all walls were put together to.
        n_blockers: usize,
    },
    /// No chain of portals leads from one to the other.
    NotConnected,
    /// Neither a line nor a proof was found: the budget was not enough, or the digits of doubles were not. A
    /// table counts such cells as visible.
    Undecided {
        /// Linear programs that were allowed.
        budget: u32,
    },
}

/// Sequences of portals that a line touches in their edges which are tried before it is given up.
const MAX_TRIES: u32 = 10_000;

/// Searches for a line from inside of `from` to inside of `to`, or for a proof that no open set of lines
/// leads there.
///
/// * `solid`: boxes beside the cells, that no line from a cell gets into, as for
///   [`space_visibility`](super::space_visibility); none will do.
/// * `budget`: linear programs after which it gives up.
///
/// Exact. Both a line and a proof were checked by code that shares nothing with what found them.
///
/// # Panics
/// If there are no such cells.
pub fn explain_space(
    graph: &CellGraph<Axial>,
    solid: &[Aabb<3>],
    from: CellId,
    to: CellId,
    budget: u32,
) -> SpaceExplanation {
    if from == to {
        return SpaceExplanation::Same;
    }
    let useful = crate::explain::reaching(graph, to);
    if !useful[from.idx()] {
        return SpaceExplanation::NotConnected;
    }
    let blockers = Blockers::new(opaque_rectangles(graph, solid));
    let [a, b] = [from, to].map(|cell| &graph.cell(cell).bounds);
    let mut shaft = Shaft::new(&blockers);
    let explanation = match shaft.decide(a, b, Target::Inside, budget) {
        Verdict::Visible(line) => Walk::new(graph, &useful, &line, to).explain(from),
        // What doubles leave open is often decided by the fractions of a proof.
        Verdict::Hidden(()) | Verdict::Undecided(_) => shaft
            .certify(a, b, Target::Inside, budget)
            .and_then(|proof| proof.narrowed(blockers.rectangles()))
            .filter(|(proof, walls)| proof.holds(a, b, Target::Inside, walls))
            .map(|(proof, walls)| SpaceExplanation::Hidden {
                proof: Box::new(proof),
                walls,
                n_blockers: blockers.len(),
            }),
    };
    explanation.unwrap_or(SpaceExplanation::Undecided { budget })
}

/// Follows a free line through portals. Where it passes the common edge of portals, lines next to it go
/// through one or the other, so all that it touches are tried.
struct Walk<'a> {
    graph: &'a CellGraph<Axial>,
    useful: &'a [bool],
    line: &'a FreeLine,
    to: CellId,
    path: Vec<Exit>,
    stabber: AxialStabber,
    tries: u32,
}

impl<'a> Walk<'a> {
    fn new(graph: &'a CellGraph<Axial>, useful: &'a [bool], line: &'a FreeLine, to: CellId) -> Self {
        Self { graph, useful, line, to, path: Vec::new(), stabber: AxialStabber::new(), tries: 0 }
    }

    fn explain(mut self, from: CellId) -> Option<SpaceExplanation> {
        if !self.reaches(from) {
            return None;
        }
        let doors: Vec<AxialDoor> = self.path.iter().map(|exit| self.graph.door(exit)).collect();
        let passes = |witness: &AxialWitness| doors.iter().all(|door| witness.passes(door));
        let free = Some(self.line.witness()).filter(passes);
        let ends = free.is_some().then(|| self.line.points());
        let witness = free.or_else(|| Some(self.stabber.witness()).filter(passes))?;
        Some(SpaceExplanation::Visible {
            portals: self.path.iter().map(|exit| exit.portal).collect(),
            cells: self.path.iter().map(|exit| exit.to).collect(),
            doors,
            witness: Box::new(witness),
            ends,
        })
    }

    /// Goes on from a cell; the path that leads to the target is left behind. A line with a direction along
    /// every axis comes into no cell twice, so this ends.
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

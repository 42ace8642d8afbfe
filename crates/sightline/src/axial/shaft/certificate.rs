//! Proof that no line leads from one box to another past opaque rectangles.
//!
//! For each vector of signs of a direction, lines that pass both boxes obey six rows for each box: an
//! extent along one axis is entered before the extent along another is left. A line that is not blocked
//! by a rectangle goes past it in one of six ways: it crosses the plane before it enters or after it
//! leaves the rectangle's extent along one of two axes, or before it leaves the first box, or after it
//! enters the second. So a tree proves that all are blocked: its nodes are rectangles, with a branch for
//! each way past them; on its leaves, positive multiples of rows that hold on that branch add up to
//! something that is negative for no line (see [`AxialCertificate`](crate::AxialCertificate)).
//!
//! Ways are handled one after another, and a later branch may assume that an earlier way is not taken: an open set of
//! lines has an open subset that strictly takes it, which the earlier branch covers, or one that strictly does not.
//! Grazing lines alone are no open set.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use sightlines_geometry::Aabb;

use super::BoxTarget;

/// A way past a rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bypass {
    /// Beside one of its edges.
    Beside {
        /// The axis, not the rectangle's own, along which it is missed.
        axis: u8,
        /// Whether its plane is crossed before its extent along that axis is entered; else after that is
        /// left.
        entering: bool,
    },
    /// Its plane is crossed before the first box is left.
    Before,
    /// Its plane is crossed after the second box is entered.
    After,
}

/// A comparison of two times that holds on a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum BranchRow {
    /// The extent of a box along `early` is entered before that along `late` is left.
    End {
        /// Whether it is the second box.
        second: bool,
        /// The axis of the earlier time.
        early: u8,
        /// The axis of the later time.
        late: u8,
    },
    /// A condition of the way that the branch takes past a rectangle.
    Taken {
        /// Number of rectangles on the path before that one.
        depth: usize,
        /// Which of the way's conditions; [`Bypass::Beside`] has one, the others have two, for the two
        /// axes that follow the rectangle's own in cyclic order.
        row: u8,
    },
    /// A way beside an edge of a rectangle was handled by an earlier branch and is not taken.
    NotTaken {
        /// Number of rectangles on the path before that one.
        depth: usize,
        /// The way.
        way: Bypass,
    },
}

/// Rows with positive multipliers that contradict each other.
pub type Contradiction = Vec<(BranchRow, BigInt)>;

/// Why no open set of lines is left on a branch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Branch {
    /// Its rows contradict each other.
    Empty(Contradiction),
    /// A rectangle is in the way, and no way leads past it.
    Past {
        /// The rectangle, by index.
        rectangle: u32,
        /// Ways past it in the order in which they are handled, each with the proof that no line takes it.
        ways: Vec<(Bypass, Branch)>,
        /// Why no line is left after those ways; `None` if there are no others.
        rest: Option<Contradiction>,
    },
}

/// Why nothing leads from one box to another, for all signs of a direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BlockedProof {
    /// Signs of a direction (whether it goes towards larger coordinates on each axis), and why lines in it
    /// are blocked. Signs that are missing lead away from the second box.
    pub octants: Vec<([bool; 3], Branch)>,
}

/// The size of a proof.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ProofSize {
    /// Rectangles passed, counted once for each node of the tree.
    pub n_nodes: usize,
    /// Contradictions.
    pub n_leaves: usize,
    /// Largest number of rectangles passed on one path.
    pub depth: usize,
    /// Largest number of rows in a contradiction.
    pub most_rows: usize,
}

impl BlockedProof {
    /// Whether it proves that no open set of lines leads from inside of `from` to `to` without meeting one of
    /// `rectangles` in between. Exact; shares no code with the solver.
    ///
    /// * `rectangles`: those that the proof names by index; boxes that are flat along one axis.
    pub fn holds(&self, from: &Aabb<3>, to: &Aabb<3>, target: BoxTarget, rectangles: &[Aabb<3>]) -> bool {
        (0..8u8).all(|bits| {
            let forward = [0, 1, 2].map(|axis| bits >> axis & 1 == 1);
            let mut lines = Lines { from, to, target, rectangles, forward, path: Vec::new() };
            let mut branches = self.octants.iter().filter(|(signs, _)| *signs == forward).map(|(_, branch)| branch);
            lines.lead_away() || branches.any(|branch| lines.none_is_left(branch))
        })
    }

    /// The rectangles it names, ascending. No others are needed.
    pub fn rectangles(&self) -> Vec<u32> {
        let mut found = Vec::new();
        self.visit(&mut |branch, _| {
            if let Branch::Past { rectangle, .. } = branch {
                found.push(*rectangle);
            }
        });
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The size of the proof.
    pub fn size(&self) -> ProofSize {
        let mut size = ProofSize::default();
        self.visit(&mut |branch, depth| {
            size.depth = size.depth.max(depth);
            let leaf = match branch {
                Branch::Empty(terms) => Some(terms),
                Branch::Past { rest, .. } => {
                    size.n_nodes += 1;
                    rest.as_ref()
                }
            };
            if let Some(terms) = leaf {
                size.n_leaves += 1;
                size.most_rows = size.most_rows.max(terms.len());
            }
        });
        size
    }

    /// The same proof with only those of `rectangles` that it names, and these; `None` if one is missing.
    pub fn narrowed(mut self, rectangles: &[Aabb<3>]) -> Option<(Self, Vec<Aabb<3>>)> {
        let named = self.rectangles();
        let kept: Option<Vec<Aabb<3>>> = named.iter().map(|&i| rectangles.get(i as usize).copied()).collect();
        self.octants.iter_mut().for_each(|(_, branch)| branch.renumber(&named));
        Some((self, kept?))
    }

    /// Visits all branches, each with the number of rectangles gone past on the way to it.
    fn visit(&self, each: &mut impl FnMut(&Branch, usize)) {
        self.octants.iter().for_each(|(_, branch)| branch.visit(0, each));
    }
}

impl Branch {
    fn visit(&self, depth: usize, each: &mut impl FnMut(&Self, usize)) {
        each(self, depth);
        if let Self::Past { ways, .. } = self {
            ways.iter().for_each(|(_, branch)| branch.visit(depth + 1, each));
        }
    }

    /// Names rectangles by their places in a sorted list that has them all.
    fn renumber(&mut self, named: &[u32]) {
        if let Self::Past { rectangle, ways, .. } = self {
            *rectangle = named.partition_point(|i| i < rectangle) as u32;
            ways.iter_mut().for_each(|(_, branch)| branch.renumber(named));
        }
    }
}

/// A coordinate on an axis, which stands for the time at which it is reached.
type Place = (usize, f64);

/// Two places, of which the first is reached before the second.
type Claim = [Place; 2];

/// A rectangle gone past.
struct Passage<'a> {
    rectangle: &'a Aabb<3>,
    axis: usize,
    taken: Option<Bypass>,
    dealt_with: Vec<Bypass>,
}

/// The lines of one vector of signs that are left on a branch.
struct Lines<'a> {
    from: &'a Aabb<3>,
    to: &'a Aabb<3>,
    target: BoxTarget,
    rectangles: &'a [Aabb<3>],
    forward: [bool; 3],
    path: Vec<Passage<'a>>,
}

/// The axis that a rectangle is perpendicular to.
fn flat_axis(rectangle: &Aabb<3>) -> Option<usize> {
    let extended = |k: usize| rectangle.min[k] < rectangle.max[k];
    (0..3).find(|&k| rectangle.min[k] == rectangle.max[k] && (0..3).all(|other| other == k || extended(other)))
}

impl<'a> Lines<'a> {
    fn enters(&self, bounds: &Aabb<3>, axis: usize) -> Place {
        (axis, if self.forward[axis] { bounds.min[axis] } else { bounds.max[axis] })
    }

    fn leaves(&self, bounds: &Aabb<3>, axis: usize) -> Place {
        (axis, if self.forward[axis] { bounds.max[axis] } else { bounds.min[axis] })
    }

    /// Whether one place of an axis is reached before another.
    fn is_before(&self, (axis, x): Place, (other, y): Place) -> bool {
        axis == other && if self.forward[axis] { x < y } else { x > y }
    }

    /// Whether no line passes the inside of the first box and later that of the second.
    fn lead_away(&self) -> bool {
        (0..3).any(|axis| !self.is_before(self.enters(self.from, axis), self.leaves(self.to, axis)))
    }

    /// The conditions of a way; `None` if no line goes that way.
    fn conditions(&self, rectangle: &Aabb<3>, own: usize, way: Bypass) -> Option<Vec<Claim>> {
        let plane = (own, rectangle.min[own]);
        let others = [(own + 1) % 3, (own + 2) % 3];
        match way {
            Bypass::Beside { axis, entering } => {
                let axis = usize::from(axis);
                let claim = if entering {
                    [plane, self.enters(rectangle, axis)]
                } else {
                    [self.leaves(rectangle, axis), plane]
                };
                others.contains(&axis).then(|| vec![claim])
            }
            Bypass::Before => {
                let may = self.is_before(plane, self.leaves(self.from, own));
                may.then(|| others.map(|k| [plane, self.leaves(self.from, k)]).to_vec())
            }
            Bypass::After => {
                let enters = self.enters(self.to, own);
                let on_surface = self.target == BoxTarget::Surface && plane.1 == enters.1;
                let may = on_surface || self.is_before(enters, plane);
                may.then(|| others.map(|k| [self.enters(self.to, k), plane]).to_vec())
            }
        }
    }

    /// The comparison that a row stands for, if it holds on this branch.
    fn claim(&self, row: BranchRow) -> Option<Claim> {
        match row {
            BranchRow::End { second, early, late } => {
                let (bounds, early, late) =
                    (if second { self.to } else { self.from }, usize::from(early), usize::from(late));
                (early < 3 && late < 3 && early != late)
                    .then(|| [self.enters(bounds, early), self.leaves(bounds, late)])
            }
            BranchRow::Taken { depth, row } => {
                let passage = self.path.get(depth)?;
                let conditions = self.conditions(passage.rectangle, passage.axis, passage.taken?)?;
                conditions.get(usize::from(row)).copied()
            }
            BranchRow::NotTaken { depth, way } => {
                let passage = self.path.get(depth)?;
                if !passage.dealt_with.contains(&way) {
                    return None;
                }
                // The negation of several conditions is a disjunction, which is no row.
                match self.conditions(passage.rectangle, passage.axis, way)?[..] {
                    [[early, late]] => Some([late, early]),
                    _ => None,
                }
            }
        }
    }

    /// Adds rows up.
    fn exclude_each_other(&self, terms: &Contradiction) -> bool {
        let mut slownesses: [BigRational; 3] = Default::default();
        let mut offsets: [BigInt; 3] = Default::default();
        for (row, multiplier) in terms {
            let Some([early, late]) = self.claim(*row).filter(|_| multiplier.is_positive()) else { return false };
            for ((axis, x), multiple) in [(early, multiplier.clone()), (late, -multiplier)] {
                let Some(x) = BigRational::from_float(if self.forward[axis] { x } else { -x }) else { return false };
                slownesses[axis] += x * &multiple;
                offsets[axis] += multiple;
            }
        }
        !terms.is_empty() && offsets.iter().all(Zero::is_zero) && slownesses.iter().all(|s| !s.is_negative())
    }

    fn none_is_left(&mut self, branch: &Branch) -> bool {
        match branch {
            Branch::Empty(terms) => self.exclude_each_other(terms),
            Branch::Past { rectangle, ways, rest } => {
                let Some(rectangle) = self.rectangles.get(*rectangle as usize) else { return false };
                let Some(axis) = flat_axis(rectangle) else { return false };
                self.path.push(Passage { rectangle, axis, taken: None, dealt_with: Vec::new() });
                let none = self.no_way_leads_on(ways, rest.as_ref());
                self.path.pop();
                none
            }
        }
    }

    /// Goes past the last rectangle of the path.
    fn no_way_leads_on(&mut self, ways: &[(Bypass, Branch)], rest: Option<&Contradiction>) -> bool {
        let last = self.path.len() - 1;
        for (way, branch) in ways {
            self.path[last].taken = Some(*way);
            if !self.none_is_left(branch) {
                return false;
            }
            self.path[last].dealt_with.push(*way);
        }
        self.path[last].taken = None;
        if let Some(terms) = rest {
            return self.exclude_each_other(terms);
        }
        let Passage { rectangle, axis, dealt_with, .. } = &self.path[last];
        let beside = (0..3u8).flat_map(|k| [true, false].map(|entering| Bypass::Beside { axis: k, entering }));
        beside
            .chain([Bypass::Before, Bypass::After])
            .all(|way| dealt_with.contains(&way) || self.conditions(rectangle, *axis, way).is_none())
    }
}

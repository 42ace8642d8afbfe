//! Why no line leads from one box to another past rectangles: proofs about pairs of boxes, and their checker.
//!
//! An object is hidden from a box by the same reasons, with the object's box as the second one: lines end where they meet it, so a
//! rectangle on its surface blocks none.
//!
//! # What is shown
//! A line with a direction along every axis reaches each coordinate on an axis at some time, and times are linear in
//! the coordinate: on axis `k` it reaches `x` at `s_k |x| + q_k`, with a positive slowness `s_k`, where `|x|` is `x`,
//! or `-x` if the line goes towards smaller coordinates. A line that passes the inside of a box enters its extent along
//! each axis before it leaves that along any other. A line that crosses the plane of a rectangle and does not meet it
//! goes *past* it in one of six ways: beside one of its four edges, before it leaves the first box, or after it enters
//! the second.
//!
//! For each octant of directions a tree shows that no way is left: a node names a rectangle and has a branch for each way past
//! it that lines can take; on its leaves, positive multiples of comparisons of times that hold there add up to one that is
//! false for all slownesses. If a way is a single comparison, lines that are left after it obey the reverse, except for
//! those with equal times, which form no open set.
//!
//! Source: that lines of one octant are linear in slownesses and offsets is the project's own.

use super::network::{Box3, flat_axis};
use crate::exact::Dyadic;
use num_bigint::BigInt;
use std::cmp::Ordering;

/// A way past a rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bypass {
    /// Beside an edge: the plane is crossed before the extent along an axis is entered, or after it is left.
    Beside {
        /// The axis; not the rectangle's own.
        axis: u8,
        /// Before; else after.
        before: bool,
    },
    /// The plane is crossed before the first box is left.
    InFirst,
    /// The plane is crossed after the second box is entered.
    InSecond,
}

/// A comparison of two times, by the reason why it holds on a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Claim {
    /// A box is entered along one axis before it is left along another.
    Box {
        /// Which of the two boxes.
        second: bool,
        /// The axis that is entered.
        enter: u8,
        /// The axis that is left.
        leave: u8,
    },
    /// A comparison of the way past a rectangle that the branch takes.
    Taken {
        /// Number of rectangles on the path before it.
        depth: u32,
        /// Which comparison: [`Bypass::Beside`] has one, the others have two, for the two axes after the rectangle's own.
        part: u8,
    },
    /// The reverse of a way beside a rectangle that an earlier branch takes.
    Reversed {
        /// Number of rectangles on the path before it.
        depth: u32,
        /// The way.
        way: Bypass,
    },
}

/// Claims with positive multipliers, which add up to a contradiction.
pub type Sum = Vec<(Claim, BigInt)>;

/// Why no line is left on a branch.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Branch {
    /// Its claims contradict each other.
    Empty(Sum),
    /// A rectangle blocks lines, except for those that go past it.
    Past {
        /// The index of the rectangle among the blockers.
        blocker: u32,
        /// Ways past it, each with its branch, in the order in which they are handled.
        ways: Vec<(Bypass, Branch)>,
        /// Why no line is left after those ways; `None` if they are all that lines can take.
        rest: Option<Sum>,
    },
}

/// An axis and a coordinate on it that a line reaches.
type Event = (usize, f64);

/// A rectangle on the path from the root.
struct Passage<'a> {
    rectangle: &'a Box3,
    axis: usize,
    taken: Option<Bypass>,
    done: Vec<Bypass>,
}

/// The lines of one octant of directions from one box to another.
pub(super) struct Lines<'a> {
    boxes: [&'a Box3; 2],
    blockers: &'a [Box3],
    /// Whether lines go towards larger coordinates.
    forward: [bool; 3],
    /// Whether lines may end on the surface of the second box, so that a rectangle there is not in their way.
    ends_on_surface: bool,
    path: Vec<Passage<'a>>,
}

impl<'a> Lines<'a> {
    pub(super) fn new(boxes: [&'a Box3; 2], blockers: &'a [Box3], forward: [bool; 3]) -> Self {
        Self { boxes, blockers, forward, ends_on_surface: false, path: Vec::new() }
    }

    /// The same for lines that end where they meet the second box, which may be flat.
    pub(super) fn ending_on_surface(self) -> Self {
        Self { ends_on_surface: true, ..self }
    }

    fn enter(&self, b: &Box3, axis: usize) -> Event {
        (axis, b[usize::from(!self.forward[axis])][axis])
    }

    fn leave(&self, b: &Box3, axis: usize) -> Event {
        (axis, b[usize::from(self.forward[axis])][axis])
    }

    /// Whether a coordinate is reached before another on the same axis.
    fn earlier(&self, axis: usize, x: f64, y: f64) -> bool {
        if self.forward[axis] { x < y } else { x > y }
    }

    /// Whether along some axis the second box is left before the first is entered: then no line leads from one to the other.
    pub(super) fn lead_away(&self) -> bool {
        (0..3).any(|k| !self.earlier(k, self.enter(self.boxes[0], k).1, self.leave(self.boxes[1], k).1))
    }

    /// The comparisons of a way, each with the earlier event first; `None` for a way that no line takes.
    fn comparisons(&self, rectangle: &Box3, own: usize, way: Bypass) -> Option<Vec<[Event; 2]>> {
        let at = rectangle[0][own];
        let plane = (own, at);
        let others = [(own + 1) % 3, (own + 2) % 3];
        let [first, second] = self.boxes;
        match way {
            Bypass::Beside { axis, before } => {
                let axis = usize::from(axis);
                others.contains(&axis).then(|| {
                    vec![if before {
                        [plane, self.enter(rectangle, axis)]
                    } else {
                        [self.leave(rectangle, axis), plane]
                    }]
                })
            }
            Bypass::InFirst => self
                .earlier(own, at, self.leave(first, own).1)
                .then(|| others.map(|k| [plane, self.leave(first, k)]).to_vec()),
            Bypass::InSecond => {
                let entered = self.enter(second, own).1;
                (self.earlier(own, entered, at) || (self.ends_on_surface && entered == at))
                    .then(|| others.map(|k| [self.enter(second, k), plane]).to_vec())
            }
        }
    }

    /// The comparison that a claim stands for; `None` if it does not hold on this branch.
    fn comparison(&self, claim: Claim) -> Option<[Event; 2]> {
        match claim {
            Claim::Box { second, enter, leave } => {
                let (b, enter, leave) = (self.boxes[usize::from(second)], usize::from(enter), usize::from(leave));
                (enter < 3 && leave < 3 && enter != leave).then(|| [self.enter(b, enter), self.leave(b, leave)])
            }
            Claim::Taken { depth, part } => {
                let passage = self.path.get(depth as usize)?;
                let comparisons = self.comparisons(passage.rectangle, passage.axis, passage.taken?)?;
                comparisons.get(usize::from(part)).copied()
            }
            Claim::Reversed { depth, way } => {
                let passage = self.path.get(depth as usize).filter(|passage| passage.done.contains(&way))?;
                match self.comparisons(passage.rectangle, passage.axis, way)?[..] {
                    [[early, late]] => Some([late, early]),
                    _ => None,
                }
            }
        }
    }

    /// Whether claims contradict each other: a claim that holds is a negative difference of times, but their sum is negative
    /// for no line.
    fn contradict(&self, sum: &Sum) -> bool {
        let mut slownesses = [(); 3].map(|()| Dyadic::whole(BigInt::from(0)));
        let mut offsets = [(); 3].map(|()| BigInt::from(0));
        for (claim, multiplier) in sum {
            let Some([early, late]) = self.comparison(*claim) else { return false };
            if multiplier.sign() != num_bigint::Sign::Plus {
                return false;
            }
            for ((axis, x), multiplier) in [(early, multiplier.clone()), (late, -multiplier)] {
                let x = Dyadic::new(if self.forward[axis] { x } else { -x });
                slownesses[axis] = &slownesses[axis] + &(&x * &Dyadic::whole(multiplier.clone()));
                offsets[axis] += multiplier;
            }
        }
        let zero = BigInt::from(0);
        !sum.is_empty()
            && offsets.iter().all(|offset| *offset == zero)
            && slownesses.iter().all(|slowness| slowness.sign() != Ordering::Less)
    }

    /// Whether a branch shows that no line is left on it.
    pub(super) fn none_left(&mut self, branch: &Branch) -> bool {
        let (blocker, ways, rest) = match branch {
            Branch::Empty(sum) => return self.contradict(sum),
            Branch::Past { blocker, ways, rest } => (*blocker, ways, rest),
        };
        let Some(rectangle) = self.blockers.get(blocker as usize) else { return false };
        let Some(axis) = flat_axis(rectangle) else { return false };
        self.path.push(Passage { rectangle, axis, taken: None, done: Vec::new() });
        let depth = self.path.len() - 1;
        let mut is_shown = true;
        for (way, branch) in ways {
            self.path[depth].taken = Some(*way);
            is_shown = self.none_left(branch);
            if !is_shown {
                break;
            }
            self.path[depth].done.push(*way);
        }
        self.path[depth].taken = None;
        is_shown = is_shown
            && match rest {
                Some(sum) => self.contradict(sum),
                None => self.all_are_done(depth),
            };
        self.path.pop();
        is_shown
    }

    /// Whether every way past a rectangle that lines can take has its branch.
    fn all_are_done(&self, depth: usize) -> bool {
        let Passage { rectangle, axis, done, .. } = &self.path[depth];
        let beside = (0..3u8).flat_map(|axis| [true, false].map(|before| Bypass::Beside { axis, before }));
        let mut ways = beside.chain([Bypass::InFirst, Bypass::InSecond]);
        ways.all(|way| done.contains(&way) || self.comparisons(rectangle, *axis, way).is_none())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// All claims that may hold on a branch, and some that do not.
    fn claims(n_passed: u32) -> Vec<Claim> {
        let mut all = Vec::new();
        for (enter, leave) in (0..3).flat_map(|enter| (0..3).map(move |leave| (enter, leave))) {
            all.extend([false, true].map(|second| Claim::Box { second, enter, leave }));
        }
        for depth in 0..n_passed {
            all.extend([0, 1, 2].map(|part| Claim::Taken { depth, part }));
            all.extend(ways().into_iter().map(|way| Claim::Reversed { depth, way }));
        }
        all
    }

    fn ways() -> Vec<Bypass> {
        let beside = (0..3u8).flat_map(|axis| [true, false].map(|before| Bypass::Beside { axis, before }));
        beside.chain([Bypass::InFirst, Bypass::InSecond]).collect()
    }

    /// Two or three claims that the checker accepts as a contradiction.
    fn contradiction(lines: &Lines<'_>, n_passed: u32) -> Option<Sum> {
        let all = claims(n_passed);
        let sum = |some: &[Claim]| -> Sum { some.iter().map(|claim| (*claim, BigInt::from(1))).collect() };
        for (i, &a) in all.iter().enumerate() {
            for (j, &b) in all[..=i].iter().enumerate() {
                let thirds = all[..=j].iter().map(|&c| sum(&[a, b, c]));
                let found = std::iter::once(sum(&[a, b])).chain(thirds).find(|sum| lines.contradict(sum));
                if found.is_some() {
                    return found;
                }
            }
        }
        None
    }

    /// A proof that the checker accepts, if there is one in which each blocker occurs once on a path.
    fn any_proof(lines: &mut Lines<'_>, next: u32) -> Option<Branch> {
        if let Some(sum) = contradiction(lines, next) {
            return Some(Branch::Empty(sum));
        }
        let blockers = lines.blockers;
        let rectangle = blockers.get(next as usize)?;
        let axis = flat_axis(rectangle)?;
        lines.path.push(Passage { rectangle, axis, taken: None, done: Vec::new() });
        let mut found = Some(Vec::new());
        for way in ways() {
            lines.path[next as usize].taken = Some(way);
            let branch = match lines.comparisons(rectangle, axis, way) {
                Some(_) => any_proof(lines, next + 1),
                None => continue,
            };
            found = found.zip(branch).map(|(mut found, branch)| {
                found.push((way, branch));
                found
            });
            if found.is_none() {
                break;
            }
            lines.path[next as usize].done.push(way);
        }
        lines.path.pop();
        Some(Branch::Past { blocker: next, ways: found?, rest: None })
    }

    /// A small box or, if `flat`, a rectangle that is often larger, on a grid of a few units.
    fn extent(flat: bool) -> impl Strategy<Value = Box3> {
        let sizes = if flat { 2i32..8 } else { 1i32..3 };
        let side =
            (if flat { -2i32..4 } else { 0i32..5 }, sizes).prop_map(|(x, size)| [f64::from(x), f64::from(x + size)]);
        (prop::array::uniform3(side), 0usize..3).prop_map(move |(mut sides, axis)| {
            if flat {
                sides[axis][1] = sides[axis][0];
            }
            [0, 1].map(|end| sides.map(|side| side[end]))
        })
    }

    /// Whether the segment between two points meets no rectangle.
    fn is_free(p: [f64; 3], q: [f64; 3], blockers: &[Box3]) -> bool {
        blockers.iter().all(|b| {
            let axis = flat_axis(b).expect("a rectangle");
            let t = (b[0][axis] - p[axis]) / (q[axis] - p[axis]);
            let x = [0, 1, 2].map(|k| p[k] + t * (q[k] - p[k]));
            let is_met = (0..3).all(|k| k == axis || (b[0][k] <= x[k] && x[k] <= b[1][k]));
            !((0.0..=1.0).contains(&t) && is_met)
        })
    }

    /// The share of the segment from `p` to `q` after which the box is entered.
    fn entered(p: [f64; 3], q: [f64; 3], b: &Box3) -> f64 {
        let at = |k: usize| (if p[k] < q[k] { b[0][k] } else { b[1][k] } - p[k]) / (q[k] - p[k]);
        (0..3).map(at).fold(0.0, f64::max)
    }

    proptest! {
        /// The same for lines that end on the surface of the second box, which may be flat: only what is in front of it blocks.
        #[test]
        fn no_line_to_a_surface_refutes_what_is_accepted(
            from in extent(false),
            to in prop_oneof![extent(false), extent(true)],
            blockers in prop::collection::vec(extent(true), 0..3),
            on_surface in any::<bool>(),
            shares in prop::collection::vec(prop::array::uniform6(0.01f64..0.99), 200),
        ) {
            let at = |b: &Box3, s: &[f64]| [0, 1, 2].map(|k| b[0][k] + (b[1][k] - b[0][k]) * s[k]);
            let mut blockers = blockers;
            // Often one lies on a face of the box.
            if let Some(first) = blockers.first_mut().filter(|_| on_surface) {
                let axis = flat_axis(first).expect("a rectangle");
                (first[0][axis], first[1][axis]) = (to[0][axis], to[0][axis]);
            }
            for octant in 0..8 {
                let forward = [0, 1, 2].map(|k| octant >> k & 1 == 1);
                let mut lines = Lines::new([&from, &to], &blockers, forward).ending_on_surface();
                let leads_away = lines.lead_away();
                let proof = if leads_away { None } else { any_proof(&mut lines, 0) };
                if leads_away || proof.is_some() {
                    for s in &shares {
                        let (p, q) = (at(&from, &s[..3]), at(&to, &s[3..]));
                        let is_ours = (0..3).all(|k| (p[k] < q[k]) == forward[k]);
                        let end = entered(p, q, &to);
                        let stop = [0, 1, 2].map(|k| p[k] + (q[k] - p[k]) * end * (1.0 - 1e-9));
                        // An eye in the box sees it.
                        let is_seen = is_ours && (end <= 0.0 || is_free(p, stop, &blockers));
                        prop_assert!(!is_seen, "{p:?} {q:?} {proof:?}");
                    }
                }
            }
        }

        /// No line of the octant refutes what the checker accepts. Boxes may overlap, and rectangles lie anywhere.
        #[test]
        fn no_line_refutes_what_is_accepted(
            boxes in [extent(false), extent(false)],
            blockers in prop::collection::vec(extent(true), 0..3),
            shares in prop::collection::vec(prop::array::uniform6(0.01f64..0.99), 200),
        ) {
            let at = |b: &Box3, s: &[f64]| [0, 1, 2].map(|k| b[0][k] + (b[1][k] - b[0][k]) * s[k]);
            for octant in 0..8 {
                let forward = [0, 1, 2].map(|k| octant >> k & 1 == 1);
                let mut lines = Lines::new([&boxes[0], &boxes[1]], &blockers, forward);
                let leads_away = lines.lead_away();
                let proof = if leads_away { None } else { any_proof(&mut lines, 0) };
                if let Some(proof) = &proof {
                    prop_assert!(lines.none_left(proof));
                }
                if leads_away || proof.is_some() {
                    for s in &shares {
                        let (p, q) = (at(&boxes[0], &s[..3]), at(&boxes[1], &s[3..]));
                        let is_ours = (0..3).all(|k| (p[k] < q[k]) == forward[k]);
                        prop_assert!(!(is_ours && is_free(p, q, &blockers)), "{p:?} {q:?} {proof:?}");
                    }
                }
            }
        }
    }
}

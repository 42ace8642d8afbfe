//! Why no line passes some gates one after the other: a plane, or sums of sides of edges.

use super::network::ConvexNetwork;
use super::vector::{Exact, Point, cross, dot, exact, minus, plus, rough, times, turn};
use crate::exact::{Dyadic, is_coordinate};
use crate::walk::gate_back;
use std::cmp::Ordering;

/// Most cuts on a path of a tree.
pub(super) const MOST_DEPTH: u32 = 24;
/// Corners that a part of a gate's hull may have.
const MOST_CORNERS: usize = 96;
/// Bits that a coordinate of such a corner may have. A cut through corners that are made by cuts nearly doubles them, so this
/// bounds the time that a proof takes for its size.
const MOST_BITS: u64 = 1 << 14;

/// Why no line passes gates of a chain.
///
/// Gates are counted from the end of the chain: 0 is the gate that the chain comes to, which must be among them.
#[derive(Debug, Clone, PartialEq)]
pub enum ConvexBlock {
    /// A plane.
    Plane(ConvexPlane),
    /// Sums.
    Sums(ConvexSums),
}

/// A plane with a gate on one side, a later gate on the other, and the last gate on the first side again. Corners may lie on the
/// plane.
///
/// A line that passes in order meets the hulls of the three gates one after the other. The plane's linear form is affine along
/// the line, so it is zero on all of it: the line lies on the plane. Seen along the line, the line is a point, and the plane a
/// line through it with all corners of a gate on one side; the edges of that gate cannot turn around the point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ConvexPlane {
    /// The first two of the three gates, the earlier one first; the third is the last gate.
    pub stops: [u32; 2],
    /// Gate and number of an edge that lies on the plane; the gate may be any of the chain.
    pub edge: [u32; 2],
    /// Gate and number of a corner that lies on the plane and, with the edge, determines it.
    pub corner: [u32; 2],
}

/// Lines from the hull of a gate to the hull of a later one, divided into parts. In each part some sides of edges, times
/// positive numbers, have no positive sum. For a line that passes, every side is positive.
///
/// The sum is linear in the point of the first hull and in that of the second, so it is largest at some pair of their corners.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexSums {
    /// The two gates, the earlier one first.
    pub ends: [u32; 2],
    /// The parts.
    pub tree: ConvexTree,
}

/// Why no line of a part passes.
#[derive(Debug, Clone, PartialEq)]
pub enum ConvexTree {
    /// This sum is not positive for any of them.
    Sum(Vec<ConvexTerm>),
    /// The part is cut in two.
    Cut(Box<ConvexCut>),
}

/// A part cut in two by a plane, by where its lines meet a gate's hull.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexCut {
    /// Whether the plane cuts the hull of the later gate; else it cuts that of the earlier one.
    pub later: bool,
    /// `a x + b y + c z + d = 0`.
    pub plane: [f64; 4],
    /// The lines where the plane's form is negative or zero, and those where it is positive or zero.
    pub parts: [ConvexTree; 2],
}

/// An edge of a gate, and a multiplier of its side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConvexTerm {
    /// The gate.
    pub gate: u32,
    /// The number of the edge.
    pub edge: u32,
    /// The multiplier, positive.
    pub times: f64,
}

/// A corner of a part in homogeneous coordinates, exact: the last coordinate is positive.
type Corner = (Exact, Dyadic);

impl ConvexBlock {
    /// Whether it shows that no line passes a chain of gates and then `gate`. Exact.
    ///
    /// # Panics
    /// If the network has no such gates.
    pub fn holds(&self, network: &ConvexNetwork, chain: &[u32], gate: u32) -> bool {
        self.gates(network, chain, gate).is_some()
    }

    /// The gates of the chain that it names, in the order of the chain, without the new one; `None` if it proves nothing.
    /// Exact.
    pub(super) fn gates(&self, network: &ConvexNetwork, chain: &[u32], gate: u32) -> Option<Vec<u32>> {
        let of = |back: u32| gate_back(chain, gate, back);
        let mut named = match self {
            Self::Plane(plane) => {
                plane.holds(network, of)?;
                vec![plane.stops[0], plane.stops[1], 0]
            }
            Self::Sums(sums) => {
                let [s, t] = sums.ends;
                let (first, last) = (of(s).filter(|_| s > t)?, of(t)?);
                let part = |gate: u32| Part::of(network.corners(gate));
                let mut named = vec![s, t];
                refutes(network, &of, &sums.tree, [&part(first), &part(last)], MOST_DEPTH, &mut named)?;
                named
            }
        };
        // Earlier gates have larger numbers.
        named.sort_unstable_by(|a, b| b.cmp(a));
        named.dedup();
        (named.pop() == Some(0)).then_some(())?;
        named.into_iter().map(of).collect()
    }
}

impl ConvexPlane {
    fn holds(&self, network: &ConvexNetwork, of: impl Fn(u32) -> Option<u32>) -> Option<()> {
        let [i, j] = self.stops;
        let [e, f] = network.edge(of(self.edge[0])?, self.edge[1])?;
        let [c, _] = network.edge(of(self.corner[0])?, self.corner[1])?;
        let from = exact(e);
        let normal = cross(&minus(&exact(f), &from), &minus(&exact(c), &from));
        let is_plane = normal.iter().any(|x| x.sign() != Ordering::Equal);
        let beside = |gate: u32, out: Ordering| network.corners(gate).iter().all(|&p| turn(e, f, c, p) != out);
        let gates = [of(i)?, of(j)?, of(0)?];
        let stops = |[x, y]: [Ordering; 2]| beside(gates[0], x) && beside(gates[1], y) && beside(gates[2], x);
        let (above, below) = (Ordering::Greater, Ordering::Less);
        (i > j && j > 0 && is_plane && (stops([above, below]) || stops([below, above]))).then_some(())
    }
}

/// The hull of a gate's corners, or a part of it.
enum Part {
    Whole(Vec<Point>),
    Cut(Vec<Corner>),
}

impl Part {
    fn of(corners: &[Point]) -> Self {
        Self::Whole(corners.to_vec())
    }

    fn corners(&self) -> Vec<Corner> {
        match self {
            Self::Whole(points) => points.iter().map(|&p| (exact(p), Dyadic::new(1.0))).collect(),
            Self::Cut(corners) => corners.clone(),
        }
    }

    /// The hulls on both sides of a plane.
    fn cut(&self, plane: [f64; 4]) -> Option<[Self; 2]> {
        if !plane.iter().all(|x| is_coordinate(*x)) {
            return None;
        }
        let (normal, offset) = (exact([plane[0], plane[1], plane[2]]), Dyadic::new(plane[3]));
        let corners = self.corners();
        let height = |(p, w): &Corner| &dot(&normal, p) + &(&offset * w);
        let heights: Vec<Dyadic> = corners.iter().map(height).collect();
        let mut parts = [Vec::new(), Vec::new()];
        for (corner, height) in corners.iter().zip(&heights) {
            if height.sign() != Ordering::Greater {
                parts[0].push(corner.clone());
            }
            if height.sign() != Ordering::Less {
                parts[1].push(corner.clone());
            }
        }
        // The section is the hull of the points where the plane meets segments between corners.
        for ((p, v), low) in corners.iter().zip(&heights).filter(|(_, h)| h.sign() == Ordering::Less) {
            for ((q, w), high) in corners.iter().zip(&heights).filter(|(_, h)| h.sign() == Ordering::Greater) {
                let low = &-low;
                let corner = (plus(&times(p, high), &times(q, low)), &(v * high) + &(w * low));
                if !corner.0.iter().chain([&corner.1]).all(|x| x.has_bits(MOST_BITS)) {
                    return None;
                }
                parts.iter_mut().for_each(|part| part.push(corner.clone()));
                if parts.iter().any(|part| part.len() > MOST_CORNERS) {
                    return None;
                }
            }
        }
        Some(parts.map(Self::Cut))
    }
}

/// Whether a tree of sums shows that no line from the first part to the second passes; collects the gates that it names.
fn refutes(
    network: &ConvexNetwork,
    of: &impl Fn(u32) -> Option<u32>,
    tree: &ConvexTree,
    [first, last]: [&Part; 2],
    depth: u32,
    named: &mut Vec<u32>,
) -> Option<()> {
    match tree {
        ConvexTree::Sum(terms) => {
            let mut edges = Vec::with_capacity(terms.len());
            for term in terms {
                let is_positive = term.times > 0.0 && is_coordinate(term.times);
                edges.push((network.edge(of(term.gate)?, term.edge)?, is_positive.then_some(term.times)?));
                named.push(term.gate);
            }
            (!edges.is_empty() && is_never_positive(&edges, first, last)).then_some(())
        }
        ConvexTree::Cut(cut) => {
            let depth = depth.checked_sub(1)?;
            let parts = if cut.later { last } else { first }.cut(cut.plane)?;
            for (part, tree) in parts.iter().zip(&cut.parts) {
                let ends = if cut.later { [first, part] } else { [part, last] };
                refutes(network, of, tree, ends, depth, named)?;
            }
            Some(())
        }
    }
}

/// Whether a sum of sides is positive for no line from the first part to the second.
fn is_never_positive(edges: &[([Point; 2], f64)], first: &Part, last: &Part) -> bool {
    // The side of the edge from e to f is (f - e) · ((q - e) × (r - e)), which is (f - e) · (q × r) + (e × f) · (r - q).
    let mut sums = None;
    let mut exactly = |q: &Corner, r: &Corner| {
        let (along, moment) = sums.get_or_insert_with(|| {
            let zero = || exact([0.0; 3]);
            edges.iter().fold((zero(), zero()), |(along, moment), &([e, f], times_)| {
                let (e, f, x) = (exact(e), exact(f), Dyadic::new(times_));
                (plus(&along, &times(&minus(&f, &e), &x)), plus(&moment, &times(&cross(&e, &f), &x)))
            })
        });
        let step = minus(&times(&r.0, &q.1), &times(&q.0, &r.1));
        (&dot(along, &cross(&q.0, &r.0)) + &dot(moment, &step)).sign() != Ordering::Greater
    };
    if let (Part::Whole(qs), Part::Whole(rs)) = (first, last) {
        return qs.iter().all(|&q| {
            rs.iter().all(|&r| {
                let (value, wrong) = roughly(edges, q, r);
                value + wrong <= 0.0
                    || (value <= wrong && exactly(&(exact(q), Dyadic::new(1.0)), &(exact(r), Dyadic::new(1.0))))
            })
        });
    }
    let (qs, rs) = (first.corners(), last.corners());
    qs.iter().all(|q| rs.iter().all(|r| exactly(q, r)))
}

/// A sum in doubles, and a bound on its error: the errors of the sides and of adding them up.
fn roughly(edges: &[([Point; 2], f64)], q: Point, r: Point) -> (f64, f64) {
    let (mut value, mut wrong, mut size) = (0.0, 0.0, 0.0);
    for &([e, f], times) in edges {
        let (side, off) = rough(e, f, q, r);
        value += times * side;
        wrong += times * off;
        size += (times * side).abs();
    }
    // Each addition and product rounds by 2^-53 of no more than the sum of magnitudes. The factor of two covers the rounding of the
    // bound itself.
    (value, 2.0 * (wrong + size * (edges.len() as f64 + 2.0) * f64::EPSILON))
}

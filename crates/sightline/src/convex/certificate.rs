//! Proof that no line passes a sequence of convex polygons, and its checker.
//!
//! The checker computes in integers only and shares no code with the solver. Every double is an integer times a power
//! of two, so after two scalings, one for places and one for coordinates of boxes, there is nothing left to round. The
//! [module above](super) explains why the proof is valid.

use crate::stabber::Proof;
use num_bigint::BigInt;
use num_traits::{Signed, Zero};
use sightlines_geometry::{Point3, Portal3};
use std::borrow::Borrow;

/// A box in space, not parallel to the axes: its points are `corner + x edges[0] + y edges[1] + z edges[2]`
/// with coordinates from 0 to 1. These numbers are exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Block {
    /// A corner, scene units.
    pub corner: Point3,
    /// Three edges out of it, right-handed.
    pub edges: [[f64; 3]; 3],
}

/// A row of a sum: how a line passes one edge, times a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConvexTerm {
    /// Index of the portal in the sequence.
    pub portal: usize,
    /// Index of the edge among the portal's.
    pub edge: usize,
    /// Positive.
    pub multiplier: f64,
}

/// A box of lines: refuted, or cut in two.
#[derive(Debug, Clone, PartialEq)]
pub enum ConvexNode {
    /// Lines with coordinate `axis` below and above `at`, which lies inside of the box.
    Split {
        /// 0 and 1 for the first two coordinates in the first block, 2 and 3 for those in the second.
        axis: u8,
        /// Where.
        at: f64,
        /// Indices of the nodes of both parts, lower part first.
        parts: [usize; 2],
    },
    /// The sum of these rows is negative for every line of the box.
    Leaf(Vec<ConvexTerm>),
}

/// Why no line passes a sequence in order.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ConvexCertificate {
    /// All lines are in boxes that are refuted.
    Boxes(BoxProof),
    /// A plane stops them.
    Plane(PlaneProof),
    /// A sum of sides is positive for none of them.
    Hulls(HullProof),
}

/// A plane that has a portal on one side, a later one on the other, and a still later one on the first
/// side. Corners may lie on the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlaneProof {
    /// Portal and index of an edge that lies on the plane.
    pub edge: (usize, usize),
    /// Portal and index of a corner that lies on the plane and, with the edge, determines it.
    pub corner: (usize, usize),
    /// The three portals, ascending.
    pub stops: [usize; 3],
}

/// Lines from a block around one portal to a block around a later one, in boxes each of which is refuted.
#[derive(Debug, Clone, PartialEq)]
pub struct BoxProof {
    /// The portals around which the blocks are.
    pub portals: [usize; 2],
    /// The blocks.
    pub blocks: [Block; 2],
    /// Boxes of lines; the first contains all.
    pub nodes: Vec<ConvexNode>,
}

/// Lines from the hull of one portal's corners to that of a later one: the sum of these rows is not positive for any of
/// them, although for a line that passes each row is.
///
/// The sum is affine in both points, so it is largest at a pair of corners.
#[derive(Debug, Clone, PartialEq)]
pub struct HullProof {
    /// The portals from and to which lines lead, the earlier one first.
    pub portals: [usize; 2],
    /// The rows, at least one. A row may occur more than once: its multipliers then add up to a number that no double is.
    pub terms: Vec<ConvexTerm>,
}

/// A point or a vector times a power of two.
type Whole = [BigInt; 3];

impl ConvexCertificate {
    /// Portals that the proof names, ascending: no sequence that contains them in this order is passable.
    pub fn named(&self) -> Vec<usize> {
        let mut named: Vec<usize> = match self {
            Self::Boxes(proof) => proof.portals.into_iter().chain(proof.terms().map(|t| t.portal)).collect(),
            Self::Plane(proof) => proof.stops.into_iter().chain([proof.edge.0, proof.corner.0]).collect(),
            Self::Hulls(proof) => proof.portals.into_iter().chain(proof.terms.iter().map(|t| t.portal)).collect(),
        };
        named.sort_unstable();
        named.dedup();
        named
    }

    /// Number of boxes that are refuted; 0 where there are none.
    pub fn n_leaves(&self) -> usize {
        let Self::Boxes(proof) = self else { return 0 };
        proof.nodes.iter().filter(|node| matches!(node, ConvexNode::Leaf(_))).count()
    }

    /// Whether it proves that no line passes `portals` in order. Exact; `false` for damaged proofs.
    /// Cost: 64 sums for each leaf, in integers of some hundred bits.
    pub fn holds(&self, portals: &[&Portal3]) -> bool {
        match self {
            Self::Boxes(proof) => proof.check(portals),
            Self::Plane(proof) => proof.check(portals),
            Self::Hulls(proof) => proof.check(portals),
        }
    }
}

impl PlaneProof {
    fn check(&self, portals: &[&Portal3]) -> bool {
        let corner = |(portal, k): (usize, usize)| portals.get(portal)?.corners().get(k).copied();
        let after = |(portal, k): (usize, usize)| Some((portal, (k + 1) % portals.get(portal)?.corners().len()));
        let plane = || Some([corner(self.edge)?, corner(after(self.edge)?)?, corner(self.corner)?]);
        let Some(points) = plane() else { return false };
        let [i, j, k] = self.stops;
        if !(i < j && j < k && k < portals.len()) {
            return false;
        }
        let used = self.stops.iter().flat_map(|&s| portals[s].corners()).chain(&points);
        let Some(place) = least(used.flatten().copied()) else { return false };
        let [e, f, c] = points.map(|p| p.map(|x| whole(x, place)));
        let normal = product(&minus(&f, &e), &minus(&c, &e));
        let side = |s: usize, sign: i32| {
            portals[s].corners().iter().all(|p| {
                let height = scalar(&normal, &minus(&p.map(|x| whole(x, place)), &e));
                if sign < 0 { !height.is_positive() } else { !height.is_negative() }
            })
        };
        !normal.iter().all(Zero::is_zero)
            && ((side(i, -1) && side(j, 1) && side(k, -1)) || (side(i, 1) && side(j, -1) && side(k, 1)))
    }
}

impl HullProof {
    pub(super) fn check(&self, portals: &[&Portal3]) -> bool {
        let [first, last] = self.portals;
        if self.terms.is_empty() || first >= last || last >= portals.len() {
            return false;
        }
        let scales = || {
            let corners = portals.iter().flat_map(|p| p.corners()).flatten().copied();
            Some((least(corners)?, least(self.terms.iter().map(|t| t.multiplier))?))
        };
        let Some((place, multiplier)) = scales() else { return false };
        let Some(sum) = Sum::of(&self.terms, portals, place, multiplier) else { return false };
        let corners = |i: usize| portals[i].corners().iter().map(|p| p.map(|x| whole(x, place))).collect::<Vec<_>>();
        let later = corners(last);
        corners(first).iter().all(|q| later.iter().all(|r| !sum.at(q, r, &BigInt::from(1)).is_positive()))
    }
}

impl BoxProof {
    fn terms(&self) -> impl Iterator<Item = &ConvexTerm> + '_ {
        self.nodes.iter().flat_map(|node| match node {
            ConvexNode::Leaf(terms) => terms.as_slice(),
            ConvexNode::Split { .. } => &[],
        })
    }

    fn check(&self, portals: &[&Portal3]) -> bool {
        let [first, last] = self.portals;
        if first >= last || last >= portals.len() {
            return false;
        }
        let Some(scales) = Scales::of(self, portals) else { return false };
        let blocks = [0, 1].map(|i| scales.block(&self.blocks[i]));
        if !blocks.iter().zip(self.portals).all(|(block, p)| contains_corners(block, portals[p], &scales)) {
            return false;
        }
        let mut seen = vec![false; self.nodes.len()];
        let mut boxes = vec![(0usize, [0.0f64; 4], [1.0f64; 4])];
        while let Some((node, low, high)) = boxes.pop() {
            if node >= seen.len() || std::mem::replace(&mut seen[node], true) {
                return false;
            }
            match &self.nodes[node] {
                ConvexNode::Leaf(terms) => {
                    if !scales.refutes(terms, &blocks, [low, high], portals) {
                        return false;
                    }
                }
                &ConvexNode::Split { axis, at, parts } => {
                    let axis = usize::from(axis);
                    if axis > 3 || !(low[axis] < at && at < high[axis]) {
                        return false;
                    }
                    let (mut middle_low, mut middle_high) = (low, high);
                    (middle_low[axis], middle_high[axis]) = (at, at);
                    boxes.push((parts[0], low, middle_high));
                    boxes.push((parts[1], middle_low, high));
                }
            }
        }
        true
    }
}

/// A double as an odd integer times a power of two.
fn decoded(x: f64) -> Option<(i64, i32)> {
    if !x.is_finite() {
        return None;
    }
    let bits = x.to_bits();
    let biased = (bits >> 52 & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    let magnitude = if biased == 0 { fraction } else { fraction | 1 << 52 };
    if magnitude == 0 {
        return Some((0, 0));
    }
    let zeros = magnitude.trailing_zeros();
    let odd = magnitude >> zeros;
    Some((if x < 0.0 { -odd } else { odd }, biased.max(1) - 1075 + zeros as i32))
}

/// The power of two that makes all numbers integers.
fn least(mut numbers: impl Iterator<Item = f64>) -> Option<i32> {
    numbers.try_fold(0i32, |least, x| Some(least.min(decoded(x)?.1))).map(|least| -least)
}

/// The powers of two that make places, coordinates of boxes and multipliers integers.
struct Scales {
    place: i32,
    coordinate: i32,
    multiplier: i32,
}

impl Scales {
    fn of(proof: &BoxProof, portals: &[&Portal3]) -> Option<Self> {
        let corners = portals.iter().flat_map(|p| p.corners()).flatten().copied();
        let blocks = proof.blocks.iter().flat_map(|b| b.corner.into_iter().chain(b.edges.into_iter().flatten()));
        let splits = proof.nodes.iter().filter_map(|node| match node {
            ConvexNode::Split { at, .. } => Some(*at),
            ConvexNode::Leaf(_) => None,
        });
        Some(Self {
            place: least(corners.chain(blocks))?,
            coordinate: least(splits)?,
            multiplier: least(proof.terms().map(|t| t.multiplier))?,
        })
    }

    fn place(&self, p: Point3) -> Whole {
        p.map(|x| whole(x, self.place))
    }

    fn block(&self, block: &Block) -> [Whole; 4] {
        [block.corner, block.edges[0], block.edges[1], block.edges[2]].map(|p| self.place(p))
    }

    /// Whether the sum of `terms` is negative for all lines with coordinates in a box.
    fn refutes(
        &self,
        terms: &[ConvexTerm],
        blocks: &[[Whole; 4]; 2],
        [low, high]: [[f64; 4]; 2],
        portals: &[&Portal3],
    ) -> bool {
        let Some(sum) = Sum::of(terms, portals, self.place, self.multiplier) else { return false };
        // Points are scaled once more than directions, by the scale of coordinates.
        let ends = |i: usize, k: usize| [low[2 * i + k], high[2 * i + k]].map(|x| whole(x, self.coordinate));
        let one = BigInt::from(1) << self.coordinate;
        let corners = |i: usize| {
            let [corner, x, y, z] = &blocks[i];
            let (us, vs) = (ends(i, 0), ends(i, 1));
            let mut points: Vec<Whole> = Vec::with_capacity(8);
            for u in &us {
                for v in &vs {
                    for w in [&BigInt::zero(), &one] {
                        points.push([0, 1, 2].map(|k| &corner[k] * &one + &x[k] * u + &y[k] * v + &z[k] * w));
                    }
                }
            }
            points
        };
        let later = corners(1);
        corners(0).iter().all(|q| later.iter().all(|r| sum.at(q, r, &one).is_negative()))
    }
}

/// A weighted sum of sides, as a function of a line.
///
/// The line from q to r has the edge from e to f inside if (f - e) · (q × r) + (e × f) · (r - q) is positive. The factors of
/// the line are added up.
struct Sum {
    along: Whole,
    moment: Whole,
}

impl Sum {
    /// `None` if a term names no edge, or its multiplier is not positive. `place` and `multiplier` are the powers of two that
    /// make corners and multipliers integers.
    fn of(terms: &[ConvexTerm], portals: &[&Portal3], place: i32, multiplier: i32) -> Option<Self> {
        let (mut along, mut moment) = (Whole::default(), Whole::default());
        for term in terms {
            let corners = portals.get(term.portal)?.corners();
            if term.edge >= corners.len() || term.multiplier.is_nan() || term.multiplier <= 0.0 {
                return None;
            }
            let times = whole(term.multiplier, multiplier);
            let [e, f] = [term.edge, (term.edge + 1) % corners.len()].map(|k| corners[k].map(|x| whole(x, place)));
            let (d, m) = (minus(&f, &e), product(&e, &f));
            for i in 0..3 {
                along[i] += &times * &d[i];
                moment[i] += &times * &m[i];
            }
        }
        Some(Self { along, moment })
    }

    /// For the line from `q` to `r`, points that are multiplied by `one` more than the corners are.
    fn at(&self, q: &Whole, r: &Whole, one: &BigInt) -> BigInt {
        scalar(&self.along, &product(q, r)) + scalar(&self.moment, &minus(r, q)) * one
    }
}

/// `x` times two to the power of `exponent`, which makes it an integer.
fn whole(x: f64, exponent: i32) -> BigInt {
    let (odd, power) = decoded(x).unwrap_or_default();
    BigInt::from(odd) << (power + exponent).max(0)
}

fn minus(a: &Whole, b: &Whole) -> Whole {
    [0, 1, 2].map(|i| &a[i] - &b[i])
}

fn product(a: &Whole, b: &Whole) -> Whole {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i])
}

fn scalar(a: &Whole, b: &Whole) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// Whether every corner of a portal has coordinates from 0 to 1 in a block, by Cramer's rule.
fn contains_corners([corner, x, y, z]: &[Whole; 4], portal: &Portal3, scales: &Scales) -> bool {
    let normals = [product(y, z), product(z, x), product(x, y)];
    let volume = scalar(x, &normals[0]);
    volume.is_positive()
        && portal.corners().iter().all(|&p| {
            let from = minus(&scales.place(p), corner);
            normals.iter().map(|n| scalar(&from, n)).all(|v| !v.is_negative() && v <= volume)
        })
}

impl<P: Borrow<Portal3>> Proof<P> for ConvexCertificate {
    fn holds(&self, portals: &[P]) -> bool {
        self.holds(&portals.iter().map(Borrow::borrow).collect::<Vec<_>>())
    }
}

//! Sequences that doubles leave open: lines through slits of some units in the last place, and grazing lines.
//!
//! Corners of maps lie on a grid, but for the rounding of the program that cut the portals. So many sequences have no line but
//! grazing ones, or, by that rounding, lines through slits some `1e-13` units wide. The numbers here have two doubles, and what
//! they propose is decided exactly: the thresholds below choose what is proposed, so none of them can make an answer wrong.
//!
//! Lines lead from the hull of one portal's corners to that of a later one ([the module above](super) says why). The sides of
//! edges are affine in both points, so a relaxed line is a mixture of pairs of corners, and its edges and corners play a
//! [game](super::game). If the value is not positive, the weights of edges prove that no line passes ([`HullProof`]): as
//! they are, or as the fractions with small denominators near which they are, since on a grid the value is 0 and they have to be
//! exact. If it is positive, the points of the hulls are improved, alternately at the two ends by a game each, until a line passes exactly.

use super::certificate::{ConvexTerm, HullProof};
use super::game;
use super::rows::Edge;
use crate::stabber::Witness;
use crate::wide::Wide;
use sightlines_exact::Dyadic;
use sightlines_exact::vector as exact;
use sightlines_geometry::{Point3, Portal3};
use std::borrow::Borrow;

/// Most pairs of corners in a game.
const MOST_PAIRS: usize = 64;
/// Most turns.
const TURNS: usize = 8;
/// Weights below this are rounding.
const WEIGHT: f64 = 1e-20;
/// Values above this are no matter of rounding: doubles have settled them, if that can be done without cutting.
const CLEARLY_OPEN: f64 = 1e-7;
/// Values above this are not proven to be at most 0.
const CLEARLY_POSITIVE: f64 = 1e-24;
/// How near a fraction has to be to a weight.
const NEAR: f64 = 1e-22;
/// Largest denominator of such a fraction, and largest common one.
const MOST_DENOMINATOR: i128 = 1 << 34;
const MOST_COMMON: i128 = 1 << 52;
/// Error of a side in numbers of two doubles, relative to the product of the vectors' sizes: the differences, products and
/// sums of a determinant err by less than 2^-98 of it.
const ROUNDING: f64 = 1.0 / (1u128 << 98) as f64;

/// What weights are multiplied by, so that the lower of two doubles is far above the least of coordinates.
const LIFT: f64 = (1u128 << 64) as f64;

/// A point in numbers of two doubles.
type Wide3 = [Wide; 3];

/// What was found; both are exact.
#[derive(Debug)]
pub(super) enum Fine {
    /// A line passes every portal.
    Open(FineLine3),
    /// None does.
    Blocked(HullProof),
}

/// A directed line through two points in numbers of two doubles. It can pass where no line through two points in doubles does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FineLine3 {
    a: Wide3,
    b: Wide3,
}

impl FineLine3 {
    /// Whether it has every edge of the polygon strictly on its inner side, that is, passes it in its direction. Exact;
    /// O(corners).
    pub fn passes(&self, portal: &Portal3) -> bool {
        portal.edges().all(|[from, to]| self.is_inside(from, to))
    }

    /// Two points on it, in the order in which it meets them; each coordinate is the sum of two doubles.
    pub fn points(&self) -> [[[f64; 2]; 3]; 2] {
        [self.a, self.b].map(|p| p.map(|x| [x.high, x.low]))
    }

    fn is_inside(&self, from: Point3, to: Point3) -> bool {
        let edge: Wide3 = std::array::from_fn(|i| Wide::difference(to[i], from[i]));
        let (q, r) = (towards(&self.a, from), towards(&self.b, from));
        let size = |v: &Wide3| v.iter().map(|x| x.high.abs()).sum::<f64>();
        let side = determinant(&edge, &q, &r);
        let bound = size(&edge) * size(&q) * size(&r) * ROUNDING;
        if side.high.abs() > bound && bound > f64::MIN_POSITIVE {
            return side.high > 0.0;
        }
        let whole = |p: &Wide3| p.map(|x| &Dyadic::new(x.high) + &Dyadic::new(x.low));
        let (e, f) = (Dyadic::vector(from), Dyadic::vector(to));
        let minus = exact::sub::<Dyadic>;
        exact::determinant::<Dyadic>(&minus(&f, &e), &minus(&whole(&self.a), &e), &minus(&whole(&self.b), &e)).sign()
            > 0
    }
}

impl<P: Borrow<Portal3>> Witness<P> for FineLine3 {
    fn passes(&self, portal: &P) -> bool {
        self.passes(portal.borrow())
    }
}

/// Looks at lines from the hull of one portal to that of a later one. `edges`: those that some of these lines may have on the outer
/// side.
pub(super) fn decide(portals: &[&Portal3], ends: [usize; 2], edges: &[Edge]) -> Option<Fine> {
    let hulls = ends.map(|i| portals[i].corners());
    if hulls[0].len() * hulls[1].len() > MOST_PAIRS {
        return None;
    }
    let sides = Sides::of(edges);
    let [first, last] = hulls.map(|hull| hull.iter().map(|p| p.map(Wide::of)).collect::<Vec<_>>());
    let pairs: Vec<[&Wide3; 2]> = first.iter().flat_map(|q| last.iter().map(move |r| [q, r])).collect();
    let columns = sides.columns(&pairs);
    let relaxed = game::solve(&columns)?;
    if relaxed.value.high > CLEARLY_OPEN {
        return None;
    }
    if relaxed.value.high <= CLEARLY_POSITIVE {
        return sides.proof(ends, &relaxed.columns, portals).map(Fine::Blocked);
    }
    let mut q = [Wide::ZERO; 3];
    for (&[corner, _], &weight) in pairs.iter().zip(&relaxed.rows) {
        q = add(&q, corner, weight);
    }
    let mut value = Wide::of(f64::NEG_INFINITY);
    for turn in 0..TURNS {
        let second = turn % 2 == 0;
        let moved = if second { &last } else { &first };
        let fixed = q;
        let pairs: Vec<[&Wide3; 2]> = moved.iter().map(|p| if second { [&fixed, p] } else { [p, &fixed] }).collect();
        let found = game::solve(&sides.columns(&pairs))?;
        q = [Wide::ZERO; 3];
        for (p, &weight) in moved.iter().zip(&found.rows) {
            q = add(&q, p, weight);
        }
        if found.value.high > 0.0 {
            let line = if second { FineLine3 { a: fixed, b: q } } else { FineLine3 { a: q, b: fixed } };
            if line.a != line.b && portals.iter().all(|portal| line.passes(portal)) {
                return Some(Fine::Open(line));
            }
        }
        if turn > 1 && found.value <= value {
            return None;
        }
        value = found.value;
    }
    None
}

/// The edges of a game.
struct Sides<'a> {
    edges: &'a [Edge],
    /// Powers of two that make sides at most of the order of 1.
    scales: Vec<f64>,
}

impl<'a> Sides<'a> {
    fn of(edges: &'a [Edge]) -> Self {
        // The power of two below a positive number.
        let power = |x: f64| f64::from_bits(x.to_bits() & 0x7ff0_0000_0000_0000);
        let scales = edges.iter().map(|edge| power(edge.scale)).collect();
        Self { edges, scales }
    }

    /// The sides of lines through pairs of points, edge by edge.
    fn columns(&self, pairs: &[[&Wide3; 2]]) -> Vec<Vec<Wide>> {
        let column = |(edge, &scale): (&Edge, &f64)| {
            let along: Wide3 = std::array::from_fn(|i| Wide::difference(edge.to[i], edge.from[i]).scaled(scale));
            let side = |&[q, r]: &[&Wide3; 2]| determinant(&along, &towards(q, edge.from), &towards(r, edge.from));
            pairs.iter().map(side).collect()
        };
        self.edges.iter().zip(&self.scales).map(column).collect()
    }

    /// The weights of edges as a proof, if they are one.
    fn proof(&self, portals: [usize; 2], weights: &[Wide], shapes: &[&Portal3]) -> Option<HullProof> {
        let holds = |multipliers: &[Vec<f64>]| {
            let term = |(edge, times): (&Edge, &Vec<f64>)| {
                let of = |&multiplier: &f64| ConvexTerm { portal: edge.portal, edge: edge.edge, multiplier };
                times.iter().filter(|x| **x > 0.0).map(of).collect::<Vec<_>>()
            };
            let terms = self.edges.iter().zip(multipliers).flat_map(term).collect();
            Some(HullProof { portals, terms }).filter(|proof| proof.check(shapes))
        };
        let scales: Vec<f64> = self.scales.iter().map(|scale| scale * LIFT).collect();
        let most = weights.iter().copied().reduce(|a, b| if b > a { b } else { a }).filter(|w| w.high > 0.0)?;
        let shares: Vec<Wide> = weights.iter().map(|&w| if w.high > WEIGHT { w / most } else { Wide::ZERO }).collect();
        if let Some(whole) = common(&shares) {
            let scaled: Vec<Vec<f64>> = whole.iter().zip(&scales).map(|(x, scale)| vec![x * scale]).collect();
            if let Some(proof) = holds(&scaled) {
                return Some(proof);
            }
        }
        // Both parts have to be positive.
        let parts = |(share, scale): (&Wide, &f64)| {
            let (high, low) = if share.low < 0.0 {
                let under = share.high * (1.0 - f64::EPSILON);
                (under, (Wide::difference(share.high, under) + Wide::of(share.low)).high)
            } else {
                (share.high, share.low)
            };
            vec![high * scale, low * scale]
        };
        holds(&shares.iter().zip(&scales).map(parts).collect::<Vec<_>>())
    }
}

/// Whole numbers in the ratios of `shares`, which are from 0 to 1, if these are near fractions with small denominators.
fn common(shares: &[Wide]) -> Option<Vec<f64>> {
    let fractions: Vec<(i128, i128)> = shares.iter().map(|&share| fraction(share)).collect::<Option<_>>()?;
    let mut least = 1i128;
    for &(_, denominator) in &fractions {
        least = least / gcd(least, denominator) * denominator;
        if least > MOST_COMMON {
            return None;
        }
    }
    Some(fractions.iter().map(|&(numerator, denominator)| (numerator * (least / denominator)) as f64).collect())
}

/// The first fraction of the continued fraction of a number from 0 to 1 that is near it.
fn fraction(x: Wide) -> Option<(i128, i128)> {
    let (mut before, mut last) = ((1i128, 0i128), (0i128, 1i128));
    let mut rest = x;
    loop {
        let off = x * Wide::of(last.1 as f64) - Wide::of(last.0 as f64);
        if off.high.abs() <= NEAR * last.1 as f64 {
            return Some(last);
        }
        if rest.high <= 0.0 {
            return None;
        }
        let inverse = Wide::ONE / rest;
        let mut whole = inverse.high.floor();
        if whole == inverse.high && inverse.low < 0.0 {
            whole -= 1.0;
        }
        if whole > MOST_DENOMINATOR as f64 {
            return None;
        }
        let k = whole as i128;
        (before, last) = (last, (before.0 + k * last.0, before.1 + k * last.1));
        if last.1 > MOST_DENOMINATOR {
            return None;
        }
        rest = inverse - Wide::of(whole);
    }
}

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn towards(p: &Wide3, from: Point3) -> Wide3 {
    std::array::from_fn(|i| p[i] - Wide::of(from[i]))
}

fn add(a: &Wide3, b: &Wide3, by: Wide) -> Wide3 {
    std::array::from_fn(|i| a[i] + b[i] * by)
}

fn determinant(a: &Wide3, b: &Wide3, c: &Wide3) -> Wide {
    let minor = |i: usize, j: usize| b[i] * c[j] - b[j] * c[i];
    a[0] * minor(1, 2) + a[1] * minor(2, 0) + a[2] * minor(0, 1)
}

//! A line that passes a sequence of doors, with exact coefficients.

use crate::stabber::Witness;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use sightlines_exact::rational;
use sightlines_geometry::{Point2, Portal2, check_coordinate, orient2d};
use std::cmp::Ordering;

/// A directed line `a x + b y + c = 0` with rational coefficients; points on its left have a positive
/// value.
///
/// It is checked by evaluating it ([`PlanarWitness::passes`]), which shares no code with the solver.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlanarWitness {
    a: BigRational,
    b: BigRational,
    c: BigRational,
}

impl PlanarWitness {
    /// The directed line from `p` to `q`, which differ.
    pub fn through(p: Point2, q: Point2) -> Self {
        let [px, py, qx, qy] = [p.x, p.y, q.x, q.y].map(rational);
        let a = &py - &qy;
        let b = &qx - &px;
        let c = -(&a * &px) - &b * &py;
        Self { a, b, c }
    }

    /// The sum of lines, which is strictly inside the polygon that they are the vertices of.
    pub(crate) fn inside(lines: impl Iterator<Item = (Point2, Point2)>) -> Self {
        let zero = || Self { a: BigRational::zero(), b: BigRational::zero(), c: BigRational::zero() };
        lines.map(|(p, q)| Self::through(p, q)).fold(zero(), |s, l| Self { a: s.a + l.a, b: s.b + l.b, c: s.c + l.c })
    }

    /// The perpendicular bisector of a door, crossing it forwards.
    pub(crate) fn across(door: Portal2) -> Self {
        let [lx, ly, rx, ry] = [door.left.x, door.left.y, door.right.x, door.right.y].map(rational);
        let a = &lx - &rx;
        let b = &ly - &ry;
        let c = -(&a * (lx + rx) + &b * (ly + ry)) / BigRational::from_integer(2.into());
        Self { a, b, c }
    }

    /// On which side of the line `p` lies: `Greater` is left. Exact.
    pub fn side(&self, p: Point2) -> Ordering {
        let value = &self.a * rational(p.x) + &self.b * rational(p.y) + &self.c;
        if value.is_positive() {
            Ordering::Greater
        } else if value.is_zero() {
            Ordering::Equal
        } else {
            Ordering::Less
        }
    }

    /// Whether the line passes `portal` strictly, in the right direction. Exact.
    pub fn passes(&self, portal: Portal2) -> bool {
        self.side(portal.left) == Ordering::Greater && self.side(portal.right) == Ordering::Less
    }

    /// The coefficients `[a, b, c]`.
    pub fn coefficients(&self) -> [&BigRational; 3] {
        [&self.a, &self.b, &self.c]
    }

    /// Where the line crosses the carrier of a portal that it passes, rounded.
    pub fn crossing(&self, portal: Portal2) -> Point2 {
        let at = |p: Point2| &self.a * rational(p.x) + &self.b * rational(p.y) + &self.c;
        let (l, r) = (at(portal.left), at(portal.right));
        let span = &l - &r;
        let t = if span.is_zero() { BigRational::zero() } else { l / span };
        let mix = |p: f64, q: f64| rational(p) + &t * (rational(q) - rational(p));
        let round = |x: BigRational| check_coordinate(x.to_f64().unwrap_or(0.0)).unwrap_or(0.0);
        Point2::new(round(mix(portal.left.x, portal.right.x)), round(mix(portal.left.y, portal.right.y)))
    }

    /// Two points in doubles whose line passes all of `portals` too (checked exactly): where this line
    /// crosses the first and the last of them. `None` if rounding spoils that, or for a single portal.
    pub fn rounded(&self, portals: &[Portal2]) -> Option<[Point2; 2]> {
        let (first, last) = (portals.first()?, portals.last()?);
        let [p, q] = [self.crossing(*first), self.crossing(*last)];
        let passes = |d: &Portal2| orient2d(p, q, d.left) > 0.0 && orient2d(p, q, d.right) < 0.0;
        (p != q && portals.iter().all(passes)).then_some([p, q])
    }

    /// A line strictly between all left and all right ends, found by trying every pair; `None` if there is none. For
    /// sequences that come from no chain of cells, where the order of portals is meaningless. O(n³).
    pub(crate) fn separating(portals: &[Portal2]) -> Option<Self> {
        let allowed = |p: Point2, q: Point2| {
            portals.iter().all(|d| orient2d(p, q, d.left) >= 0.0 && orient2d(p, q, d.right) <= 0.0)
        };
        let ends: Vec<Point2> = portals.iter().flat_map(|d| [d.left, d.right]).collect();
        let pairs = ends.iter().flat_map(|&p| ends.iter().map(move |&q| (p, q)));
        let sum = Self::inside(pairs.filter(|&(p, q)| p != q && allowed(p, q)));
        // Where all ends are on one line, no pair spans a line between them; a bisector does.
        let bisectors = portals.iter().flat_map(|l| portals.iter().map(|r| Portal2 { left: l.left, right: r.right }));
        let bisectors = bisectors.filter(|d| d.left != d.right).map(Self::across);
        let strict = |w: &Self| portals.iter().all(|&d| w.passes(d));
        std::iter::once(sum).chain(bisectors).find(strict)
    }
}

impl Witness<Portal2> for PlanarWitness {
    fn passes(&self, portal: &Portal2) -> bool {
        self.passes(*portal)
    }
}

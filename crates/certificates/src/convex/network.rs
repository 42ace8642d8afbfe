//! The geometry that proofs of a map speak of: cells joined by polygons in space.

use super::line::{ConvexLine, LinePoints};
use super::vector::{Exact, Point, cross, dot, exact, minus, plus, times, turn};
use crate::exact::{Dyadic, is_coordinate};
use crate::graph::Gates;
use std::cmp::Ordering;

/// An opening between two cells.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexPortal {
    /// The two cells.
    pub cells: [u32; 2],
    /// Corners, three at least, counter-clockwise about the direction from the first cell into the second (right-hand rule).
    pub corners: Vec<Point>,
}

/// Why cells and portals are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ConvexNetworkError {
    /// More than 2^30 cells or portals.
    #[error("there are too many cells or portals")]
    TooMany,
    /// A portal to a cell that does not exist, or from a cell to itself.
    #[error("portal {0} does not join two cells")]
    Cells(u32),
    /// A coordinate that is not finite, or of a magnitude that is neither 0 nor from 2^-140 to 2^200.
    #[error("portal {0} has a coordinate out of range")]
    Coordinate(u32),
    /// A portal with fewer than three corners, with an edge without length, or without area.
    #[error("portal {0} is no polygon")]
    NoPolygon(u32),
    /// A flatness outside the range from 0 to 2^-20.
    #[error("portals cannot be that far off their planes")]
    Flatness,
}

/// Cells, given by number only, and the polygons between them.
///
/// # What passing means
/// A directed line passes a gate if it has each edge of the polygon, from corner to corner, strictly on its inner side. It then
/// meets the hull of the corners. The sides of the edges add up to the product of its direction and the *normal* of the polygon
/// (the sum of the cross products of successive corners), so it goes along this normal, not against it. It passes a chain if it
/// passes each gate and meets their hulls one after the other, each gate once.
///
/// # What is assumed
/// Corners in files are rounded, but portals are meant to lie on the planes by which the map was cut, and a line crosses a plane
/// once. So a corner counts as on a portal's plane if rounding could have moved it off the plane that far: if each coordinate
/// is rounded by the *flatness* times the largest coordinate of the two portals on its axis. With a flatness of 0 nothing is
/// assumed.
#[derive(Debug, Clone)]
pub struct ConvexNetwork {
    pub(super) gates: Gates,
    /// The corners of each gate, counter-clockwise about the direction of crossing.
    corners: Vec<Vec<Point>>,
    planes: Vec<Plane>,
    flatness: f64,
    checksum: u32,
}

/// Where a gate lies.
#[derive(Debug, Clone)]
struct Plane {
    normal: Exact,
    /// The normal in doubles, each component within 2^-51 of its magnitude.
    rounded: Point,
    /// The largest magnitude of a coordinate of a corner, on each axis.
    largest: Point,
    /// The smallest and the largest product of the rounded normal with a corner, in doubles.
    range: [f64; 2],
}

impl ConvexNetwork {
    /// The flatness for tables of maps: corners within 2^-44 of the largest coordinate count as on the plane of a portal.
    pub const OF_FILES: f64 = f64::EPSILON * 256.0;

    /// Checks cells and portals. O(size).
    ///
    /// # Errors
    /// The first [`ConvexNetworkError`].
    pub fn new(n_cells: usize, portals: &[ConvexPortal], flatness: f64) -> Result<Self, ConvexNetworkError> {
        if n_cells.max(portals.len()) > 1 << 30 {
            return Err(ConvexNetworkError::TooMany);
        }
        if !(0.0..=2f64.powi(-20)).contains(&flatness) || !is_coordinate(flatness) {
            return Err(ConvexNetworkError::Flatness);
        }
        let (mut corners, mut planes) = (Vec::new(), Vec::new());
        for (id, portal) in (0u32..).zip(portals) {
            let [a, b] = portal.cells;
            if a == b || a.max(b) as usize >= n_cells {
                return Err(ConvexNetworkError::Cells(id));
            }
            if !portal.corners.as_flattened().iter().all(|x| is_coordinate(*x)) {
                return Err(ConvexNetworkError::Coordinate(id));
            }
            for shape in [portal.corners.clone(), portal.corners.iter().rev().copied().collect()] {
                planes.push(Plane::of(&shape).ok_or(ConvexNetworkError::NoPolygon(id))?);
                corners.push(shape);
            }
        }
        // Each portal is a side by itself.
        let gates = Gates::new(n_cells, (0u32..).zip(portals).map(|(id, p)| (p.cells, [id, id])));
        let checksum = checksum(n_cells, portals, flatness);
        Ok(Self { gates, corners, planes, flatness, checksum })
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.gates.n_cells()
    }

    /// Number of portals.
    pub fn n_portals(&self) -> usize {
        self.gates.len() / 2
    }

    /// A checksum of cells and portals. Proofs carry it, so those of another network are refused.
    pub fn checksum(&self) -> u32 {
        self.checksum
    }

    /// The corners of a gate, counter-clockwise about the direction in which it is crossed. Gate `2p` is portal `p` crossed from its
    /// first cell into its second, gate `2p + 1` the other way.
    ///
    /// # Panics
    /// If there is no such gate.
    pub fn corners(&self, gate: u32) -> &[Point] {
        &self.corners[gate as usize]
    }

    /// The cells before and behind a gate.
    ///
    /// # Panics
    /// If there is no such gate.
    pub fn cells(&self, gate: u32) -> [u32; 2] {
        self.gates.gate(gate).cells
    }

    pub(super) fn edge(&self, gate: u32, edge: u32) -> Option<[Point; 2]> {
        let (corners, k) = (self.corners.get(gate as usize)?, edge as usize);
        Some([*corners.get(k)?, corners[(k + 1) % corners.len()]])
    }

    /// Whether a line may pass gate `s` and then gate `t`, by their planes.
    ///
    /// A line that does goes along the normals of both where it meets their hulls. So some corner of `t` lies farther along the
    /// normal of `s` than some corner of `s`, and some corner of `s` less far along the normal of `t` than some corner of `t`, by
    /// more than the flatness allows. Exact; `false` for a gate and itself.
    pub fn may_follow(&self, s: u32, t: u32) -> bool {
        s != t && self.rises(s, [s, t]) && self.rises(t, [s, t])
    }

    /// Whether a corner of `to` is farther along the normal of a gate, one of the two, than one of `from`, by more than the flatness.
    fn rises(&self, gate: u32, [from, to]: [u32; 2]) -> bool {
        let [plane, other] = [gate, from ^ to ^ gate].map(|g| &self.planes[g as usize]);
        let along = |p: &Point| plane.rounded[0] * p[0] + plane.rounded[1] * p[1] + plane.rounded[2] * p[2];
        let corners = self.corners(from ^ to ^ gate).iter().map(along);
        let rise = if gate == from {
            corners.fold(f64::NEG_INFINITY, f64::max) - plane.range[0]
        } else {
            plane.range[1] - corners.fold(f64::INFINITY, f64::min)
        };
        let largest = [0, 1, 2].map(|k| plane.largest[k].max(other.largest[k]));
        // No product of the normal with a corner is larger.
        let reach: f64 = (0..3).map(|k| plane.rounded[k].abs() * largest[k]).sum();
        let allowed = self.flatness * reach;
        // Components of normals are within 2^-51 of their magnitudes, and so are products with them; the sums of both products round
        // by less than 2^-51 of the reach each. 2^-47 covers all that and the rounding of the bound.
        let wrong = reach * 2f64.powi(-47);
        if (rise - allowed).abs() > wrong {
            return rise > allowed;
        }
        let products = plane.normal.iter().zip(largest).map(|(x, largest)| &x.magnitude() * &Dyadic::new(largest));
        let reach = products.fold(Dyadic::new(0.0), |sum, x| &sum + &x);
        let allowed = &Dyadic::new(self.flatness) * &reach;
        let [low, high] = [from, to].map(|g| self.corners(g).iter().map(|&p| dot(&plane.normal, &exact(p))));
        let high: Vec<Dyadic> = high.collect();
        low.into_iter().any(|low| high.iter().any(|high| (&(high - &low) - &allowed).sign() == Ordering::Greater))
    }

    /// The cells that a line passes, in order, followed from its gate both ways through gates that it passes one after the other. An
    /// open set of lines joins any two of them. Empty if the line does not pass its gate, or if there is no such gate. Exact.
    pub fn follow(&self, line: &ConvexLine) -> Vec<u32> {
        let gate = line.gate;
        let Some(points) = line.points().filter(|_| (gate as usize) < self.gates.len()) else { return Vec::new() };
        if !self.passes(gate, &points) {
            return Vec::new();
        }
        let mut cells = Vec::new();
        let back = points.reversed();
        self.go(gate ^ 1, &back, &mut cells);
        cells.reverse();
        self.go(gate, &back.reversed(), &mut cells);
        cells
    }

    /// Adds the cell behind a gate, and the cells that follow it along a line.
    fn go(&self, first: u32, line: &LinePoints, cells: &mut Vec<u32>) {
        let [p, q] = &line.exact;
        let way = minus(q, p);
        let (mut last, mut at) = (first, None);
        for _ in 0..self.n_cells() {
            let cell = self.cells(last)[1];
            cells.push(cell);
            let from = at.get_or_insert_with(|| self.place(last, p, &way)).clone();
            let next = self.gates.exits(cell).iter().find_map(|&gate| {
                let place = (gate != last ^ 1 && self.passes(gate, line)).then(|| self.place(gate, p, &way))?;
                let is_later = (&(&from[0] * &place[1]) - &(&place[0] * &from[1])).sign() == Ordering::Less;
                is_later.then_some((gate, place))
            });
            let Some((gate, place)) = next else { return };
            (last, at) = (gate, Some(place));
        }
    }

    /// Where a line that passes a gate crosses the plane through the gate's first corner, perpendicular to its normal: a share of
    /// the way between two points of the line, as numerator and positive denominator.
    fn place(&self, gate: u32, p: &Exact, way: &Exact) -> [Dyadic; 2] {
        let normal = &self.planes[gate as usize].normal;
        let from = minus(&exact(self.corners(gate)[0]), p);
        [dot(normal, &from), dot(normal, way)]
    }

    fn passes(&self, gate: u32, line: &LinePoints) -> bool {
        let corners = self.corners(gate);
        let mut edges = (0..corners.len()).map(|k| [corners[k], corners[(k + 1) % corners.len()]]);
        match line.rounded {
            Some([p, q]) => edges.all(|[e, f]| turn(e, f, p, q) == Ordering::Greater),
            None => edges.all(|[e, f]| {
                let from = exact(e);
                let [f, p, q] = [&exact(f), &line.exact[0], &line.exact[1]].map(|p| minus(p, &from));
                dot(&f, &cross(&p, &q)).sign() == Ordering::Greater
            }),
        }
    }
}

impl Plane {
    /// `None` for a polygon without area, and for one with an edge without length, which is on neither side of any line.
    fn of(corners: &[Point]) -> Option<Self> {
        let first = exact(*corners.first()?);
        if (0..corners.len()).any(|k| corners[k] == corners[(k + 1) % corners.len()]) {
            return None;
        }
        let from: Vec<Exact> = corners.iter().map(|&p| minus(&exact(p), &first)).collect();
        let zero = times(&first, &Dyadic::new(0.0));
        let normal = from.windows(2).fold(zero, |sum, pair| plus(&sum, &cross(&pair[0], &pair[1])));
        if normal.iter().all(|x| x.sign() == Ordering::Equal) {
            return None;
        }
        let rounded = [0, 1, 2].map(|k| normal[k].rounded());
        let along = |p: &Point| rounded[0] * p[0] + rounded[1] * p[1] + rounded[2] * p[2];
        let low = corners.iter().map(along).fold(f64::INFINITY, f64::min);
        let high = corners.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
        let largest = [0, 1, 2].map(|k| corners.iter().fold(0.0, |m: f64, p| m.max(p[k].abs())));
        Some(Self { normal, rounded, largest, range: [low, high] })
    }
}

fn checksum(n_cells: usize, portals: &[ConvexPortal], flatness: f64) -> u32 {
    let mut hash = crc32fast::Hasher::new();
    // Negative zero is zero.
    let mut number = |x: f64| hash.update(&(x + 0.0).to_le_bytes());
    number(n_cells as f64);
    number(flatness);
    for p in portals {
        p.cells.iter().for_each(|&cell| number(f64::from(cell)));
        number(p.corners.len() as f64);
        p.corners.as_flattened().iter().for_each(|&x| number(x));
    }
    hash.finalize()
}

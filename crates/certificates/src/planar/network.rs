//! The geometry that proofs of a plan are about: convex polygons joined by segments, checked exactly.

use super::line::{Line, PlanLine, Point};
use crate::exact::{is_coordinate, turn};
use crate::graph::Gates;
use std::cmp::Ordering;

/// An opening between two cells.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanarPortal {
    /// The two cells.
    pub cells: [u32; 2],
    /// The side of each cell that it lies on. Portals on one side of a cell lie on one line.
    pub sides: [u32; 2],
    /// The left end, as seen from the first cell.
    pub left: Point,
    /// The right end, as seen from the first cell.
    pub right: Point,
}

/// Why cells and portals are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkError {
    /// More than 2^30 cells or portals.
    #[error("there are too many cells or portals")]
    TooMany,
    /// A coordinate that is not finite, or of a magnitude that is neither 0 nor from 2^-140 to 2^200.
    #[error("cell {0} has a coordinate out of range")]
    Coordinate(u32),
    /// Not a convex polygon with counter-clockwise corners.
    #[error("cell {0} is not convex")]
    NotConvex(u32),
    /// A portal to a cell that does not exist, or from a cell to itself.
    #[error("portal {0} does not join two cells")]
    Cells(u32),
    /// A portal that does not lie on the border of one of its cells, directed out of the first and into the second.
    #[error("portal {portal} is not on the border of cell {cell}")]
    OffBorder {
        /// The portal.
        portal: u32,
        /// The cell.
        cell: u32,
    },
    /// Portals on one side of a cell that are not on one line.
    #[error("portals {} and {} are listed on one side of cell {cell}, and are not", portals[0], portals[1])]
    Sides {
        /// The cell.
        cell: u32,
        /// The portals.
        portals: [u32; 2],
    },
}

/// Convex polygons and the portals between them, for which it was checked that
///
/// * cells are convex and counter-clockwise;
/// * each portal lies on the border of both its cells, and is crossed outwards;
/// * portals with one side number of a cell lie on one line.
///
/// So a line that goes from cell to cell through portals meets each cell once, and leaves none by the side through which it
/// entered.
#[derive(Debug, Clone)]
pub struct PlanarNetwork {
    pub(super) gates: Gates,
    /// The left and the right end of each gate, in the direction of crossing.
    pub(super) ends: Vec<[Point; 2]>,
    /// Lower and upper corners of boxes around cells.
    pub(super) boxes: Vec<[Point; 2]>,
    checksum: u32,
}

impl PlanarNetwork {
    /// Checks cells, given by their corners, and portals. Exact; O(size).
    ///
    /// # Errors
    /// The first [`NetworkError`].
    pub fn new(cells: &[Vec<Point>], portals: &[PlanarPortal]) -> Result<Self, NetworkError> {
        if cells.len().max(portals.len()) > 1 << 30 {
            return Err(NetworkError::TooMany);
        }
        for (id, corners) in (0u32..).zip(cells) {
            if !corners.as_flattened().iter().all(|x| is_coordinate(*x)) {
                return Err(NetworkError::Coordinate(id));
            }
            if !is_convex(corners) {
                return Err(NetworkError::NotConvex(id));
            }
        }
        for (id, portal) in (0u32..).zip(portals) {
            let [a, b] = portal.cells;
            if a == b || a.max(b) as usize >= cells.len() {
                return Err(NetworkError::Cells(id));
            }
            let ends = [portal.left, portal.right];
            if !ends.as_flattened().iter().all(|x| is_coordinate(*x)) {
                return Err(NetworkError::OffBorder { portal: id, cell: a });
            }
            // Counter-clockwise, the border of the cell that is left runs from the right end to the left.
            for (cell, [from, to]) in [(a, [portal.right, portal.left]), (b, [portal.left, portal.right])] {
                if !is_on_border(&cells[cell as usize], from, to) {
                    return Err(NetworkError::OffBorder { portal: id, cell });
                }
            }
        }
        let gates = Gates::new(cells.len(), portals.iter().map(|p| (p.cells, p.sides)));
        let ends: Vec<[Point; 2]> = portals.iter().flat_map(|p| [[p.left, p.right], [p.right, p.left]]).collect();
        for cell in 0..cells.len() as u32 {
            for pair in gates.exits(cell).windows(2) {
                let [g, h] = [pair[0], pair[1]];
                let [left, right] = ends[g as usize];
                let straight = ends[h as usize].iter().all(|&p| turn(left, right, p) == Ordering::Equal);
                if gates.gate(g).sides[0] == gates.gate(h).sides[0] && !straight {
                    return Err(NetworkError::Sides { cell, portals: [g / 2, h / 2] });
                }
            }
        }
        let boxes = cells.iter().map(|corners| around(corners)).collect();
        Ok(Self { gates, ends, boxes, checksum: checksum(cells, portals) })
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

    /// The left and the right end of a gate, in the direction of crossing. Gate `2p` is portal `p` crossed from its first
    /// cell into its second, gate `2p + 1` the other way.
    ///
    /// # Panics
    /// If there is no such gate.
    pub fn gate_ends(&self, gate: u32) -> [Point; 2] {
        self.ends[gate as usize]
    }

    /// The cells that a line passes, in order, followed from its cell both ways through portals that it crosses
    /// strictly. An open set of lines joins any two of them. Empty if the line crosses no portal of its cell, or if there
    /// is no such cell. Exact.
    pub fn follow(&self, line: &PlanLine) -> Vec<u32> {
        let Some(forward) = Line::of(line).filter(|_| (line.cell as usize) < self.n_cells()) else { return Vec::new() };
        let backward = forward.reversed();
        self.gates.follow(line.cell, |gate, is_backward| {
            let line = if is_backward { &backward } else { &forward };
            let [left, right] = self.ends[gate as usize];
            line.side(left) == Ordering::Greater && line.side(right) == Ordering::Less
        })
    }
}

/// Whether a polygon is convex and counter-clockwise; straight angles are allowed.
fn is_convex(corners: &[Point]) -> bool {
    let n = corners.len();
    // Every corner lies to the left of every edge or on its line, and they are not all on one line.
    let edges = || (0..n).map(|i| [corners[i], corners[(i + 1) % n]]);
    let inside = edges().all(|[a, b]| a != b && corners.iter().all(|&c| turn(a, b, c) != Ordering::Less));
    n >= 3 && inside && edges().any(|[a, b]| corners.iter().any(|&c| turn(a, b, c) == Ordering::Greater))
}

/// Whether `from` to `to` runs along the border of a convex counter-clockwise polygon.
fn is_on_border(corners: &[Point], from: Point, to: Point) -> bool {
    let n = corners.len();
    let inside = corners.iter().all(|&c| turn(from, to, c) != Ordering::Less);
    let on_line: Vec<Point> = corners.iter().copied().filter(|&c| turn(from, to, c) == Ordering::Equal).collect();
    let [low, high] = around(&on_line);
    let within = |p: Point| (0..2).all(|k| low[k] <= p[k] && p[k] <= high[k]);
    n >= 3 && from != to && inside && on_line.len() >= 2 && within(from) && within(to)
}

fn around(points: &[Point]) -> [Point; 2] {
    points.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], p| {
        [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
    })
}

fn checksum(cells: &[Vec<Point>], portals: &[PlanarPortal]) -> u32 {
    let mut hash = crc32fast::Hasher::new();
    // Negative zero is zero.
    let mut point = |p: Point| p.iter().for_each(|x| hash.update(&(x + 0.0).to_le_bytes()));
    cells.iter().for_each(|cell| {
        point([cell.len() as f64, 0.0]);
        cell.iter().for_each(|&p| point(p));
    });
    for p in portals {
        point(p.left);
        point(p.right);
        point(p.cells.map(f64::from));
        point(p.sides.map(f64::from));
    }
    hash.finalize()
}

//! The geometry that proofs of scenes in space are about: boxes joined by rectangles, checked exactly.

use crate::exact::{is_coordinate, turn};
use crate::graph::Gates;
use std::cmp::Ordering;

/// A point of space, in scene units.
pub type Point3 = [f64; 3];

/// A closed box, by its lower and its upper corner. A rectangle is a box that is flat along one axis.
pub type Box3 = [Point3; 2];

/// An opening between two boxes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxialPortal {
    /// The two cells.
    pub cells: [u32; 2],
    /// The rectangle.
    pub extent: Box3,
    /// The axis that it is perpendicular to.
    pub axis: u8,
    /// Whether the way from the first cell to the second leads towards larger coordinates.
    pub forward: bool,
}

/// Why boxes and portals are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AxialNetworkError {
    /// More than 2^30 cells or portals.
    #[error("there are too many cells or portals")]
    TooMany,
    /// A box without an inside, or with a coordinate out of range.
    #[error("cell {0} is no box with an inside")]
    Cell(u32),
    /// A portal to a cell that does not exist, or from a cell to itself.
    #[error("portal {0} does not join two cells")]
    Cells(u32),
    /// A portal that is not on the walls of both its cells.
    #[error("portal {portal} is not on the wall of cell {cell}")]
    OffWall {
        /// The portal.
        portal: u32,
        /// The cell.
        cell: u32,
    },
}

/// A directed line that crosses portals of a cell, and so joins the cells that it passes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AxialLine {
    /// A cell that the line passes.
    pub cell: u32,
    /// A point and another farther along the line, by the bits of their coordinates.
    pub points: [[u64; 3]; 2],
}

impl AxialLine {
    /// The line from one point towards another, which passes a cell.
    pub fn through(cell: u32, from: Point3, to: Point3) -> Self {
        Self { cell, points: [from, to].map(|p| p.map(f64::to_bits)) }
    }
}

/// Boxes and the rectangles that join them. It is checked that boxes have an inside, and that each portal lies in the walls
/// of its two cells and leads out of the first into the second.
#[derive(Debug, Clone)]
pub struct AxialNetwork {
    pub(super) gates: Gates,
    pub(super) cells: Vec<Box3>,
    pub(super) portals: Vec<AxialPortal>,
    /// The coordinates of cells and portals along each axis, ascending, each once. Proofs name coordinates by their indices.
    pub(super) places: [Vec<f64>; 3],
    checksum: u32,
    pub(super) objects: Vec<Box3>,
    objects_checksum: u32,
}

impl AxialNetwork {
    /// Checks cells and portals. Exact; O(size log size).
    ///
    /// # Errors
    /// The first [`AxialNetworkError`].
    pub fn new(cells: &[Box3], portals: &[AxialPortal]) -> Result<Self, AxialNetworkError> {
        if cells.len().max(portals.len()) > 1 << 30 {
            return Err(AxialNetworkError::TooMany);
        }
        let fits = |b: &Box3| b.as_flattened().iter().all(|x| is_coordinate(*x));
        for (id, b) in (0u32..).zip(cells) {
            if !fits(b) || (0..3).any(|k| b[0][k] >= b[1][k]) {
                return Err(AxialNetworkError::Cell(id));
            }
        }
        for (id, portal) in (0u32..).zip(portals) {
            let [a, b] = portal.cells;
            if a == b || a.max(b) as usize >= cells.len() {
                return Err(AxialNetworkError::Cells(id));
            }
            for (first, cell) in [(true, a), (false, b)] {
                let off = Err(AxialNetworkError::OffWall { portal: id, cell });
                let axis = usize::from(portal.axis);
                if !fits(&portal.extent) || flat_axis(&portal.extent) != Some(axis) {
                    return off;
                }
                let own = &cells[cell as usize];
                // The portal leads out of the first cell: through its upper wall if it leads forward.
                let wall = if portal.forward == first { own[1][axis] } else { own[0][axis] };
                if wall != portal.extent[0][axis] || !is_within(&portal.extent, own) {
                    return off;
                }
            }
        }
        let sides = |p: &AxialPortal| {
            let (low, high) = (2 * u32::from(p.axis), 2 * u32::from(p.axis) + 1);
            if p.forward { [high, low] } else { [low, high] }
        };
        let gates = Gates::new(cells.len(), portals.iter().map(|p| (p.cells, sides(p))));
        let mut hash = crc32fast::Hasher::new();
        let mut places: [Vec<f64>; 3] = Default::default();
        for b in cells.iter().chain(portals.iter().map(|p| &p.extent)) {
            for corner in b {
                for (k, x) in corner.iter().enumerate() {
                    // Negative zero is zero.
                    hash.update(&(x + 0.0).to_le_bytes());
                    places[k].push(x + 0.0);
                }
            }
        }
        for p in portals {
            p.cells.iter().for_each(|cell| hash.update(&cell.to_le_bytes()));
            hash.update(&[p.axis, u8::from(p.forward)]);
        }
        for axis in &mut places {
            axis.sort_by(f64::total_cmp);
            axis.dedup();
        }
        let (cells, portals, checksum) = (cells.to_vec(), portals.to_vec(), hash.finalize());
        Ok(Self { gates, cells, portals, places, checksum, objects: Vec::new(), objects_checksum: 0 })
    }

    /// The same with boxes around objects, which proofs name by their indices. Any boxes will do; about those without a surface or
    /// with a coordinate out of range there are no proofs of their own.
    #[must_use]
    pub fn with_objects(self, objects: &[Box3]) -> Self {
        let mut hash = crc32fast::Hasher::new();
        objects.iter().for_each(|b| b.as_flattened().iter().for_each(|x| hash.update(&(x + 0.0).to_le_bytes())));
        Self { objects: objects.to_vec(), objects_checksum: hash.finalize(), ..self }
    }

    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.cells.len()
    }

    /// Number of objects.
    pub fn n_objects(&self) -> usize {
        self.objects.len()
    }

    /// A checksum of the boxes of objects. Proofs about objects carry it.
    pub fn objects_checksum(&self) -> u32 {
        self.objects_checksum
    }

    /// The box of an object; `None` if there is none, or if it is flat along more than one axis: no open set of lines leads to that.
    pub(super) fn object(&self, index: u32) -> Option<&Box3> {
        let b = self.objects.get(index as usize)?;
        let fits = b.as_flattened().iter().all(|x| is_coordinate(*x));
        let extents = (0..3).filter(|&k| b[0][k] < b[1][k]).count();
        (fits && (0..3).all(|k| b[0][k] <= b[1][k]) && extents >= 2).then_some(b)
    }

    /// A checksum of cells and portals. Proofs carry it, so those of another network are refused.
    pub fn checksum(&self) -> u32 {
        self.checksum
    }

    /// The name of a box; `None` unless all its coordinates are coordinates of cells or portals.
    pub fn name(&self, b: &Box3) -> Option<AxialName> {
        let place = |k: usize, x: f64| self.places[k].binary_search_by(|y| y.total_cmp(&(x + 0.0))).ok();
        let mut name = AxialName::default();
        for (side, corner) in b.iter().enumerate() {
            for (k, &x) in corner.iter().enumerate() {
                name.0[side][k] = u32::try_from(place(k, x)?).ok()?;
            }
        }
        Some(name)
    }

    /// The box of a name; `None` if there is none, or if its lower corner is not below its upper one.
    pub(super) fn named(&self, name: &AxialName) -> Option<Box3> {
        let mut b = [[0.0; 3]; 2];
        for (corner, places) in b.iter_mut().zip(&name.0) {
            for (k, x) in corner.iter_mut().enumerate() {
                *x = *self.places[k].get(places[k] as usize)?;
            }
        }
        (0..3).all(|k| b[0][k] <= b[1][k]).then_some(b)
    }

    /// The cells that a line passes, in order, followed from its cell both ways through portals that it crosses
    /// strictly. An open set of lines joins any two of them. Empty if the line crosses no portal of its cell, or if there is
    /// no such cell. Exact.
    pub fn follow(&self, line: &AxialLine) -> Vec<u32> {
        let points = line.points.map(|p| p.map(f64::from_bits));
        let fits = points.as_flattened().iter().all(|x| is_coordinate(*x));
        if !fits || line.cell as usize >= self.cells.len() {
            return Vec::new();
        }
        let [p, q] = points;
        self.gates.follow(line.cell, |gate, is_backward| {
            let line = if is_backward { [q, p] } else { [p, q] };
            passes(line, &self.portals[gate as usize / 2].extent, self.gates.gate(gate).sides[0])
        })
    }
}

/// A box, by the indices of its coordinates among those of a network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
pub struct AxialName(pub(super) [[u32; 3]; 2]);

/// The axis that a rectangle is perpendicular to.
pub(super) fn flat_axis(b: &Box3) -> Option<usize> {
    let is_flat = |k: usize| b[0][k] == b[1][k];
    let has_extent = |k: usize| b[0][k] < b[1][k];
    (0..3).find(|&k| is_flat(k) && (0..3).all(|other| other == k || has_extent(other)))
}

/// Whether a closed box lies in another.
pub(super) fn is_within(inner: &Box3, outer: &Box3) -> bool {
    (0..3).all(|k| outer[0][k] <= inner[0][k] && inner[1][k] <= outer[1][k])
}

/// Whether a directed line leaves a box strictly through the inside of a rectangle on the side `2 axis` (towards smaller
/// coordinates) or `2 axis + 1`.
///
/// Seen in the plane of the axis and another one, the line passes between two points if they are on its two sides.
fn passes([p, q]: [Point3; 2], extent: &Box3, side: u32) -> bool {
    let (axis, forward) = (side as usize / 2, side % 2 == 1);
    let right_way = if forward { p[axis] < q[axis] } else { p[axis] > q[axis] };
    right_way
        && (0..3).filter(|&b| b != axis).all(|b| {
            let flat = |r: Point3| [r[axis], r[b]];
            let sides = extent.map(|corner| turn(flat(p), flat(q), flat(corner)));
            // Going forward, larger coordinates are on the left.
            let [low, high] = if forward { sides } else { [sides[1], sides[0]] };
            low == Ordering::Less && high == Ordering::Greater
        })
}

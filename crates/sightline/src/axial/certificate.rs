//! Proof that no open set of lines passes a sequence of axis-aligned doors.
//!
//! A line reaches coordinate `c` of axis `i` at time `(c - p_i) / d_i`. With the signs of its direction
//! given, this is `± s_i c - q_i` for a positive slowness `s_i = 1 / |d_i|`. A door is passed if and
//! only if its plane is reached after the extents along the other two axes are entered and before they
//! are left: four rows, each "an earlier time minus a later time", all of which are negative for a line
//! that passes. If positive multiples of some rows add up to `(c_x, c_y, c_z, 0, 0, 0)` in
//! `(s, q)` with no `c` negative, they add up to something that is not negative for any line, so none
//! passes. Two doors that are crossed in opposite directions of one axis exclude each other outright.
//!
//! Source: the rows are those of Megiddo, US patent 5,481,658 (expired); that such multiples exist
//! whenever no line passes is Gordan's alternative, and six suffice by Carathéodory's theorem.

use crate::stabber::Proof;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use sightlines_geometry::AxialDoor;

/// One of the four conditions that a door imposes on a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct AxialRow {
    /// Index of the door in the sequence.
    pub door: usize,
    /// The axis, not the door's own, whose extent is entered or left.
    pub axis: u8,
    /// Whether the condition is that this extent is entered before the door's plane is reached; otherwise, that it is
    /// left after.
    pub entering: bool,
}

/// Rows that contradict each other for some signs of the direction.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OctantProof {
    /// For each axis, whether lines go towards larger coordinates on it; `None` if the proof does not
    /// depend on that.
    pub signs: [Option<bool>; 3],
    /// One to six rows with positive multipliers.
    pub terms: Vec<(AxialRow, BigInt)>,
}

/// Why a sequence is blocked.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum AxialCertificate {
    /// Two doors of one axis, by index, that are crossed in opposite directions.
    Opposed([usize; 2]),
    /// A proof for all signs of a direction.
    Rows {
        /// For each axis, a door, by index, that determines the sign of the direction along it; `None` if both signs
        /// are considered.
        guards: [Option<usize>; 3],
        /// For each vector of signs that the guards leave, at least one proof.
        proofs: Vec<OctantProof>,
    },
}

impl AxialCertificate {
    /// The doors that the proof names, ascending. No sequence that contains them is passable.
    pub fn doors(&self) -> Vec<usize> {
        let mut doors: Vec<usize> = match self {
            Self::Opposed(pair) => pair.to_vec(),
            Self::Rows { guards, proofs } => {
                let named = proofs.iter().flat_map(|p| p.terms.iter().map(|(row, _)| row.door));
                guards.iter().flatten().copied().chain(named).collect()
            }
        };
        doors.sort_unstable();
        doors.dedup();
        doors
    }

    /// Whether it proves that no open set of lines passes `doors`. Exact; shares no code with the solver.
    pub fn holds(&self, doors: &[AxialDoor]) -> bool {
        match self {
            Self::Opposed(pair) => match pair.map(|i| doors.get(i)) {
                [Some(d), Some(e)] => d.axis == e.axis && d.forward != e.forward,
                _ => false,
            },
            Self::Rows { guards, proofs } => (0..8u8).all(|bits| {
                let signs = [0, 1, 2].map(|axis| bits >> axis & 1 == 1);
                excluded(guards, doors, signs)
                    || proofs.iter().any(|p| p.speaks_of(signs) && p.terms_exclude(doors, signs))
            }),
        }
    }
}

/// Whether a guard is crossed in the other direction.
fn excluded(guards: &[Option<usize>; 3], doors: &[AxialDoor], signs: [bool; 3]) -> bool {
    let crossed = |axis: usize, guard: &Option<usize>| {
        let door = guard.and_then(|i| doors.get(i)).filter(|d| usize::from(d.axis) == axis);
        door.is_some_and(|d| d.forward != signs[axis])
    };
    guards.iter().enumerate().any(|(axis, guard)| crossed(axis, guard))
}

impl OctantProof {
    fn speaks_of(&self, signs: [bool; 3]) -> bool {
        self.signs.iter().zip(signs).all(|(mine, sign)| mine.is_none_or(|m| m == sign))
    }

    /// Adds up the rows for a direction with these signs.
    fn terms_exclude(&self, doors: &[AxialDoor], signs: [bool; 3]) -> bool {
        let mut slownesses: [BigRational; 3] = Default::default();
        let mut offsets: [BigInt; 3] = Default::default();
        for (row, multiplier) in &self.terms {
            let Some([earlier, later]) = times(row, doors, signs) else { return false };
            if !multiplier.is_positive() {
                return false;
            }
            for ((axis, x), earlier) in [(earlier, true), (later, false)] {
                let multiple = if earlier { multiplier.clone() } else { -multiplier };
                let Some(x) = BigRational::from_float(if signs[axis] { x } else { -x }) else { return false };
                slownesses[axis] += x * &multiple;
                offsets[axis] += multiple;
            }
        }
        !self.terms.is_empty() && offsets.iter().all(Zero::is_zero) && slownesses.iter().all(|s| !s.is_negative())
    }
}

/// The two times that a row compares, earlier first, as coordinates on axes.
fn times(row: &AxialRow, doors: &[AxialDoor], signs: [bool; 3]) -> Option<[(usize, f64); 2]> {
    let door = doors.get(row.door)?;
    let (own, axis) = (usize::from(door.axis), usize::from(row.axis));
    if own == axis || own > 2 || axis > 2 {
        return None;
    }
    let plane = (own, door.extent.min[own]);
    // Going towards larger coordinates, an extent is entered by its lower side.
    let side = if row.entering == signs[axis] { door.extent.min[axis] } else { door.extent.max[axis] };
    Some(if row.entering { [(axis, side), plane] } else { [plane, (axis, side)] })
}

impl Proof<AxialDoor> for AxialCertificate {
    fn holds(&self, portals: &[AxialDoor]) -> bool {
        self.holds(portals)
    }
}

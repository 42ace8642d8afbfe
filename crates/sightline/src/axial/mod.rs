//! Lines through axis-aligned rectangles in space: exact, incremental, proven.
//!
//! # Method
//! Give the direction `d` of a line its signs. Then the time at which the line reaches coordinate `c` of
//! axis `i`, `(c - p_i) / d_i`, is linear in the slownesses `1 / |d_i|`, which are positive, and in three
//! offsets. A door is passed if and only if its plane is reached after the door's extents along the
//! other axes are entered and before they are left: four linear rows. So, though lines in space are not
//! a linear space, each of at most eight octants of directions is a linear program with three slownesses
//! and three offsets, determined up to a common factor and the origin of time.
//!
//! * A push first tests the line of the previous sequence, exactly: a row about two axes is an orientation in their
//!   plane.
//! * If that line does not pass, a small linear program in doubles, on the sequence moved and scaled to the unit box,
//!   finds a line, which is checked exactly, or weights, which are turned into integers with which the rows add up to a
//!   contradiction.
//! * If rounding spoiled both, the same program in numbers of two doubles finds them, checked likewise; where that does
//!   not settle it either, the program in fractions decides.
//! * As long as all doors face one axis, the directions along the two others do not depend on each
//!   other, and two planar [funnels](crate::planar::funnel) decide.
//!
//! An octant without lines is skipped from then on; the other octants are examined only when needed.
//!
//! # Ties
//! Doors are open. Rows are strict, so a sequence that only grazing lines pass is blocked.
//!
//! # Source
//! Megiddo, US patent 5,481,658 (1996, expired), for the change of variables; Teller and Séquin,
//! SIGGRAPH 1991, for the question.

mod certificate;
mod exact;
mod fine;
mod octant;
mod proof;
mod rows;
pub mod shaft;
mod simplex;
mod stabber;
mod witness;

pub use certificate::{AxialCertificate, AxialRow, OctantProof};
pub use stabber::{AxialCounters, AxialStabber, AxialUndo};
pub use witness::AxialWitness;

use crate::{SightlineError, Verdict};
use octant::{Decision, SMALL_FIRST, decide};
use rows::{Octant, ROWS_PER_DOOR, Row, door_rows, is_forward, octants_through, others};
use sightlines_geometry::{AxialDoor, check_coordinate};

/// The answer for one sequence of axis-aligned doors. It is exact.
pub type AxialVerdict = Verdict<Box<AxialWitness>, AxialCertificate>;

/// Finds a directed line that passes through every one of `doors`, each strictly inside and in its
/// direction.
///
/// * `doors`: rectangles in one common frame, scene units, in any order.
/// * Returns a witness line, or a certificate that no such line exists; `None` for no doors at all,
///   which every line passes.
///
/// Exact. Cost: at most eight small linear programs of `4 n` rows.
///
/// # Errors
/// [`SightlineError`] with the door's index.
///
/// # Source
/// See the [module](self).
pub fn stabbing_line_axial(doors: &[AxialDoor]) -> Result<Option<AxialVerdict>, SightlineError> {
    doors.iter().enumerate().try_for_each(|(i, door)| check(i, door))?;
    Ok((!doors.is_empty()).then(|| decide_doors(doors)))
}

/// The verdict about doors with usable coordinates, at least one.
fn decide_doors(doors: &[AxialDoor]) -> AxialVerdict {
    let crossed =
        |axis: usize, forward: bool| doors.iter().position(|d| usize::from(d.axis) == axis && d.forward == forward);
    let opposed = (0..3).find_map(|axis| Some([crossed(axis, true)?, crossed(axis, false)?]));
    if let Some(pair) = opposed {
        return Verdict::Hidden(AxialCertificate::Opposed(pair));
    }
    let octants = doors.iter().fold(u8::MAX, |o, door| o & octants_through(door));
    let (mut proofs, mut scratch): (Vec<OctantProof>, Vec<Row>) = (Vec::new(), Vec::new());
    for octant in (0..8).filter(|o| octants >> o & 1 == 1) {
        let known = |p: &OctantProof| (0..3).all(|i| p.signs[i].is_none_or(|s| s == is_forward(octant, i)));
        if proofs.iter().any(known) {
            continue;
        }
        let rows: Vec<Row> = doors.iter().flat_map(|door| door_rows(door, octant)).collect();
        match decide(&rows, octant, SMALL_FIRST, &mut scratch).0 {
            Decision::Line(line) => return Verdict::Visible(Box::new(AxialWitness::through(&line))),
            Decision::Fractions(witness) => return Verdict::Visible(witness),
            Decision::Blocked(proof) => proofs.push(octant_proof(doors, octant, &rows, &proof)),
        }
    }
    let certificate = certificate(doors, proofs);
    debug_assert!(certificate.holds(doors), "{certificate:?} of {doors:?}");
    Verdict::Hidden(certificate)
}

fn check(i: usize, door: &AxialDoor) -> Result<(), SightlineError> {
    let [min, max] = [door.extent.min, door.extent.max];
    if min.into_iter().chain(max).any(|x| check_coordinate(x).is_err()) {
        return Err(SightlineError::NotFinite(i));
    }
    let axis = usize::from(door.axis);
    if axis > 2 || min[axis] != max[axis] {
        return Err(SightlineError::NotFlat(i));
    }
    if others(axis).into_iter().any(|b| min[b] >= max[b]) {
        return Err(SightlineError::ZeroLength(i));
    }
    Ok(())
}

/// Names the rows of a proof. It holds for both directions along an axis that no row involves.
fn octant_proof(doors: &[AxialDoor], octant: Octant, rows: &[Row], proof: &proof::Proof) -> OctantProof {
    let terms = proof.terms();
    let used = |axis: usize| terms.iter().any(|&(k, _)| rows[k].early == axis || rows[k].late == axis);
    let signs = [0, 1, 2].map(|axis| used(axis).then(|| is_forward(octant, axis)));
    let name = |k: usize| {
        let (door, kind) = (k / ROWS_PER_DOOR, k % ROWS_PER_DOOR);
        let axis = others(usize::from(doors[door].axis))[kind / 2];
        AxialRow { door, axis: axis as u8, entering: kind % 2 == 0 }
    };
    OctantProof { signs, terms: terms.into_iter().map(|(k, multiplier)| (name(k), multiplier)).collect() }
}

/// Puts proofs together with the doors that exclude all other directions; doors that are named anyway
/// are preferred.
fn certificate(doors: &[AxialDoor], proofs: Vec<OctantProof>) -> AxialCertificate {
    let named = |i: usize| proofs.iter().any(|p| p.terms.iter().any(|(row, _)| row.door == i));
    let guard = |axis: usize| {
        let mut crossing = (0..doors.len()).filter(|&i| usize::from(doors[i].axis) == axis);
        let needed = proofs.iter().any(|p| p.signs[axis].is_some());
        needed.then(|| crossing.clone().find(|&i| named(i)).or_else(|| crossing.next())).flatten()
    };
    AxialCertificate::Rows { guards: [0, 1, 2].map(guard), proofs }
}

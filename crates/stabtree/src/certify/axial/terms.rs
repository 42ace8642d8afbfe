//! Proofs of the search in the terms of the proof format.

use sightlines_certificates::axial::{Branch as Proof, Bypass as ProvenBypass, Claim, Sum};
use sightlines_sightline::{BlockedProof, Branch, BranchRow, Bypass, Contradiction};

/// A proof in the terms of the proof format.
pub(super) fn translated(proof: &BlockedProof) -> Vec<(u8, Proof)> {
    let octant = |signs: &[bool; 3]| (0..3).fold(0u8, |bits, k| bits | u8::from(signs[k]) << k);
    proof.octants.iter().map(|(signs, branch)| (octant(signs), branch_of(branch))).collect()
}

fn branch_of(branch: &Branch) -> Proof {
    match branch {
        Branch::Empty(terms) => Proof::Empty(sum_of(terms)),
        Branch::Past { rectangle, ways, rest } => Proof::Past {
            blocker: *rectangle,
            ways: ways.iter().map(|(way, branch)| (way_of(*way), branch_of(branch))).collect(),
            rest: rest.as_ref().map(sum_of),
        },
    }
}

fn way_of(way: Bypass) -> ProvenBypass {
    match way {
        Bypass::Beside { axis, entering } => ProvenBypass::Beside { axis, before: entering },
        Bypass::Before => ProvenBypass::InFirst,
        Bypass::After => ProvenBypass::InSecond,
    }
}

fn sum_of(terms: &Contradiction) -> Sum {
    let claim = |row: &BranchRow| match *row {
        BranchRow::End { second, early, late } => Claim::Box { second, enter: early, leave: late },
        BranchRow::Taken { depth, row } => Claim::Taken { depth: depth as u32, part: row },
        BranchRow::NotTaken { depth, way } => Claim::Reversed { depth: depth as u32, way: way_of(way) },
    };
    terms.iter().map(|(row, multiplier)| (claim(row), multiplier.clone())).collect()
}

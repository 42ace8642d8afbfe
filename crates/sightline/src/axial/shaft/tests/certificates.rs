//! Proofs that boxes are hidden from each other: they hold, and changed ones do not.

use super::super::{BlockedProof, Blockers, BoxTarget, Branch, Shaft, ShaftVerdict, Verdict};
use super::BUDGET;
use super::oracle::{Case, any_case, any_place, more, nudged};
use proptest::prelude::*;
use sightlines_geometry::Aabb;
use sightlines_testkit::draw;

impl Case {
    fn certified(&self) -> Option<BlockedProof> {
        let blockers = Blockers::new(self.rectangles.iter().copied());
        Shaft::new(&blockers).certify(&self.from, &self.to, self.target, BUDGET)
    }

    fn decided(&self) -> ShaftVerdict {
        let blockers = Blockers::new(self.rectangles.iter().copied());
        Shaft::new(&blockers).decide(&self.from, &self.to, self.target, BUDGET)
    }

    fn obeys(&self, proof: &BlockedProof) -> bool {
        proof.holds(&self.from, &self.to, self.target, &self.rectangles)
    }
}

/// What is blocked is proven, and nothing else is.
fn check(case: &Case) -> Result<(), String> {
    match (case.decided(), case.certified()) {
        (Verdict::Hidden(()), None) => Err("blocked without a proof".to_owned()),
        (Verdict::Visible(_), Some(proof)) => Err(format!("{proof:?} of what is open")),
        (_, Some(proof)) if !case.obeys(&proof) => Err(format!("{proof:?} does not hold")),
        (_, Some(proof)) => {
            let (narrow, kept) =
                proof.clone().narrowed(&case.rectangles).ok_or("names rectangles that are not there")?;
            let holds = narrow.holds(&case.from, &case.to, case.target, &kept);
            if holds && narrow.size() == proof.size() { Ok(()) } else { Err(format!("{narrow:?} does not hold")) }
        }
        (_, None) => Ok(()),
    }
}

/// Changes the nth node or leaf; returns whether there is one.
fn change_nth(proof: &mut BlockedProof, mut n: usize, change: &mut impl FnMut(&mut Branch)) -> bool {
    fn go(branch: &mut Branch, n: &mut usize, change: &mut impl FnMut(&mut Branch)) -> bool {
        if *n == 0 {
            change(branch);
            return true;
        }
        *n -= 1;
        match branch {
            Branch::Empty(_) => false,
            Branch::Past { ways, .. } => ways.iter_mut().any(|(_, branch)| go(branch, n, change)),
        }
    }
    proof.octants.iter_mut().any(|(_, branch)| go(branch, &mut n, change))
}

proptest! {
    /// Invariant: what is blocked is proven, also where rounding has moved what was in line.
    #[test]
    fn what_is_blocked_is_proven((case, (factor, by)) in (any_case(), any_place()), nudges in any::<[i8; 4]>()) {
        for case in [case.clone(), case.placed(factor, by), nudged(case.placed(factor, by), &nudges)] {
            if let Err(error) = check(&case) {
                prop_assert!(false, "{}: {:?}", error, case);
            }
        }
    }

    /// Invariant: a proof that holds is true, wherever it comes from: one that was made for another case holds only if
    /// this case is blocked too.
    #[test]
    fn proofs_of_other_cases_prove_nothing_wrong(
        case in any_case(),
        (moved, axis, by) in (any::<prop::sample::Index>(), 0..3usize, -2..=2i32),
        surface in any::<bool>(),
    ) {
        let Some(proof) = case.certified() else { return Ok(()) };
        let mut other = case;
        if !other.rectangles.is_empty() {
            let n = moved.index(other.rectangles.len());
            let rectangle = &mut other.rectangles[n];
            rectangle.min[axis] += f64::from(by);
            rectangle.max[axis] += f64::from(by);
        }
        if surface {
            other.target = BoxTarget::Surface;
        }
        prop_assert!(!other.obeys(&proof) || !other.is_open(), "{:?} of {:?}", proof, other);
    }
}

/// Proofs that have to fail: a weight changed, a branch left out, signs left out, a rectangle moved away.
#[test]
fn changed_proofs_do_not_hold() {
    let (mut weights, mut branches, mut signs, mut gone) = (0, 0, 0, 0);
    for case in draw(&any_case(), 400) {
        let Some(proof) = case.certified() else { continue };
        let size = proof.size();
        for n in 0..size.n_nodes + size.n_leaves {
            let (mut heavier, mut fewer) = (proof.clone(), proof.clone());
            let mut changed = false;
            change_nth(&mut heavier, n, &mut |branch| {
                let terms = match branch {
                    Branch::Empty(terms) => Some(terms),
                    Branch::Past { rest, .. } => rest.as_mut(),
                };
                if let Some((_, weight)) = terms.and_then(|terms| terms.first_mut()) {
                    *weight = more(weight);
                    changed = true;
                }
            });
            if changed {
                weights += 1;
                assert!(!case.obeys(&heavier), "{heavier:?} of {case:?}");
            }
            let mut changed = false;
            change_nth(&mut fewer, n, &mut |branch| {
                if let Branch::Past { ways, rest: None, .. } = branch {
                    changed = ways.pop().is_some();
                }
            });
            if changed {
                branches += 1;
                assert!(!case.obeys(&fewer), "{fewer:?} of {case:?}");
            }
        }
        for n in 0..proof.octants.len() {
            let mut partial = proof.clone();
            partial.octants.remove(n);
            signs += 1;
            assert!(!case.obeys(&partial), "{partial:?} of {case:?}");
        }
        for rectangle in proof.rectangles() {
            let mut without = case.clone();
            without.rectangles[rectangle as usize] = Aabb { min: [90.0, 90.0, 90.0], max: [90.0, 91.0, 91.0] };
            assert!(!without.obeys(&proof) || !without.is_open(), "{proof:?} of {without:?}");
            gone += usize::from(!without.obeys(&proof));
        }
    }
    assert!(weights > 500 && branches > 100 && signs > 100 && gone > 100, "{weights} {branches} {signs} {gone}");
}

/// Proofs are small: one to six rows on each leaf, by Carathéodory's theorem.
#[test]
fn proofs_are_small() {
    let (mut n_proofs, mut n_nodes, mut n_leaves, mut largest, mut most_rows) = (0, 0, 0, 0, 0);
    for case in draw(&any_case(), 1000) {
        let Some(proof) = case.certified() else { continue };
        let size = proof.size();
        assert!(size.depth <= case.rectangles.len() && proof.rectangles().len() <= size.n_nodes, "{size:?} {case:?}");
        n_proofs += 1;
        n_nodes += size.n_nodes;
        n_leaves += size.n_leaves;
        largest = largest.max(size.n_nodes);
        most_rows = most_rows.max(size.most_rows);
    }
    eprintln!("{n_proofs} proofs, {n_nodes} nodes, {n_leaves} leaves, at most {largest} nodes, {most_rows} rows");
    assert!(n_proofs > 200 && n_nodes > n_proofs && n_leaves > n_nodes, "{n_proofs} {n_nodes} {n_leaves}");
    assert!((3..=6).contains(&most_rows) && largest < 200, "{most_rows} {largest}");
}

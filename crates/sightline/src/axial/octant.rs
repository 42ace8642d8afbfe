//! The decision of one octant: doubles propose, then numbers of two doubles, and exact arithmetic decides.

use super::exact::{self, Exact};
use super::fine::{self, Fine};
use super::proof::{self, Proof};
use super::rows::{Line, Octant, Row};
use super::simplex;
use super::witness::AxialWitness;

/// Whether a line with given signs of its direction obeys all rows strictly.
#[derive(Debug)]
pub(super) enum Decision {
    /// This line does.
    Line(Line),
    /// This one does; no line in doubles was found.
    Fractions(Box<AxialWitness>),
    /// None does.
    Blocked(Proof),
}

/// Largest weight of a cycle of a proof, where only the answer matters.
pub(super) const FINE: &[f64] = &[(1u64 << 40) as f64];
/// The same, where small integers are preferred.
pub(super) const SMALL_FIRST: &[f64] =
    &[1.0, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 32.0, 64.0, 256.0, 65536.0, (1u64 << 40) as f64];

/// Decides; also returns whether doubles were not enough. `scales` are tried in turn for the weights of a proof.
pub(super) fn decide(rows: &[Row], octant: Octant, scales: &[f64], scratch: &mut Vec<Row>) -> (Decision, bool) {
    match decide_in_doubles(rows, octant, scales, scratch) {
        Ok(decision) => (decision, false),
        Err(support) => match fine::decide(rows, octant) {
            Some(Fine::Open(line)) => (Decision::Fractions(Box::new(line.witness())), true),
            Some(Fine::Blocked(proof)) => (Decision::Blocked(proof), true),
            None => match exact::decide(rows, octant, &support) {
                Exact::Open(witness) => (Decision::Fractions(witness), true),
                Exact::Blocked(proof) => (Decision::Blocked(proof), true),
            },
        },
    }
}

/// Decides if the program in doubles leads to a line or a proof that hold exactly; else returns the rows
/// that it found heavy.
pub(super) fn decide_in_doubles(
    rows: &[Row],
    octant: Octant,
    scales: &[f64],
    scratch: &mut Vec<Row>,
) -> Result<Decision, Vec<(usize, f64)>> {
    let solution = simplex::solve(rows, octant, [true; 3], scratch);
    let obeys = |line: &Line| line.is_in(octant) && rows.iter().all(|row| line.obeys(row, octant));
    if let Some(line) = solution.line.filter(obeys) {
        return Ok(Decision::Line(line));
    }
    let support = &solution.support[..];
    let by_cycles =
        |support: &[(usize, f64)]| scales.iter().find_map(|&scale| proof::by_cycles(rows, octant, support, scale));
    let proof = by_cycles(support)
        .or_else(|| by_cycles(&two_axes(rows, octant, support, scratch)?))
        .or_else(|| proof::by_elimination(rows, octant, support, solution.signs));
    proof.map(Decision::Blocked).ok_or(solution.support)
}

/// Solves the program again without the slowness of one axis, if the weights do not need it.
///
/// In that case lines are blocked by rows about two axes and at most one coordinate of the third, such as a floor. The
/// program with all slownesses then has an optimum of exactly zero, where the slownesses of the two axes vanish and the
/// weights have no slack; this program has slack.
pub(super) fn two_axes(
    rows: &[Row],
    octant: Octant,
    support: &[(usize, f64)],
    scratch: &mut Vec<Row>,
) -> Option<Vec<(usize, f64)>> {
    let places = |axis: usize| support.iter().filter_map(move |&(k, _)| rows[k].term(axis)).map(|(_, x)| x);
    let idle = (0..3).find(|&axis| places(axis).all(|x| Some(x) == places(axis).next()))?;
    let place = places(idle).next();
    let stays = |row: &Row| row.term(idle).is_none_or(|(_, x)| Some(x) == place);
    let kept: Vec<usize> = (0..rows.len()).filter(|&k| stays(&rows[k])).collect();
    let rows: Vec<Row> = kept.iter().map(|&k| rows[k]).collect();
    let total = [0, 1, 2].map(|axis| axis != idle);
    let solution = simplex::solve(&rows, octant, total, scratch);
    Some(solution.support.into_iter().map(|(k, weight)| (kept[k], weight)).collect())
}

#[cfg(test)]
mod tests {
    use super::super::certificate::AxialCertificate;
    use super::super::rows::{door_rows, is_forward};
    use super::super::{certificate, octant_proof};
    use super::*;
    use proptest::prelude::*;
    use sightlines_geometry::AxialDoor;
    use sightlines_testkit::{any_axial_doors, axial_corridor, axial_stabbable_brute_force};

    /// Doors that fix all signs, their octant, their rows.
    fn one_octant(doors: &[AxialDoor]) -> Option<(Octant, Vec<Row>)> {
        let mut fits = (0..8).filter(|&o| doors.iter().all(|d| is_forward(o, usize::from(d.axis)) == d.forward));
        let octant = fits.next().filter(|_| fits.next().is_none())?;
        Some((octant, doors.iter().flat_map(|door| door_rows(door, octant)).collect()))
    }

    fn certified(doors: &[AxialDoor], octant: Octant, rows: &[Row], proof: &Proof) -> bool {
        let certificate: AxialCertificate = certificate(doors, vec![octant_proof(doors, octant, rows, proof)]);
        certificate.holds(doors)
    }

    proptest! {
        /// Invariant: each way of deciding is correct on its own, whichever of them would have come first.
        #[test]
        fn each_stage_is_right(doors in prop_oneof![axial_corridor(), any_axial_doors()]) {
            let Some((octant, rows)) = one_octant(&doors) else { return Ok(()) };
            let open = axial_stabbable_brute_force(&doors);
            match exact::decide(&rows, octant, &[]) {
                Exact::Open(witness) => {
                    prop_assert!(open, "{:?}", doors);
                    prop_assert!(doors.iter().all(|d| witness.passes(d)), "{:?}", doors);
                }
                Exact::Blocked(proof) => {
                    prop_assert!(!open, "{:?}", doors);
                    prop_assert!(certified(&doors, octant, &rows, &proof), "{:?} {:?}", proof, doors);
                }
            }
            let solution = simplex::solve(&rows, octant, [true; 3], &mut Vec::new());
            let obeys = |line: &Line| line.is_in(octant) && rows.iter().all(|row| line.obeys(row, octant));
            if solution.line.is_some_and(|line| obeys(&line)) {
                prop_assert!(open, "{:?}", doors);
            }
            let by_cycles = SMALL_FIRST.iter().filter_map(|&s| proof::by_cycles(&rows, octant, &solution.support, s));
            let by_elimination = proof::by_elimination(&rows, octant, &solution.support, solution.signs);
            for proof in by_cycles.chain(by_elimination) {
                prop_assert!(!open, "{:?} {:?}", proof, doors);
                prop_assert!(certified(&doors, octant, &rows, &proof), "{:?} {:?}", proof, doors);
            }
        }
    }

    /// Every stage except fractions occurs on small grids: lines, cycles, recomputed weights.
    #[test]
    fn each_stage_is_needed() {
        let (mut lines, mut cycles, mut eliminations) = (0, 0, 0);
        for doors in sightlines_testkit::draw(&axial_corridor(), 6_000) {
            let Some((octant, rows)) = one_octant(&doors) else { continue };
            match decide(&rows, octant, FINE, &mut Vec::new()).0 {
                Decision::Line(_) => lines += 1,
                Decision::Blocked(Proof::Small(_)) => cycles += 1,
                Decision::Blocked(Proof::Big(_)) => eliminations += 1,
                Decision::Fractions(_) => {}
            }
        }
        assert!(lines > 10 && cycles > 100 && eliminations > 0, "{lines} {cycles} {eliminations}");
    }
}

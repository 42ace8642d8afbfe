//! Sequences that doubles leave open: on grids, where lines graze, and with corners moved by units in the last place, where
//! lines pass through slits as wide as that.

use crate::convex::{polygon, refs, whole};
use num_bigint::BigInt;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use sightlines_geometry::{AxialDoor, Portal3, Random};
use sightlines_sightline::{ConvexCertificate, ConvexStabber, ConvexTerm, FineLine3, HullProof, StabLimits, Verdict};
use sightlines_testkit::{axial_corridor, axial_stabbable_brute_force, straight_axial_corridor};

/// Doors with their edges moved by some units in the last place; `None` if one is left without an area.
fn moved(doors: &[AxialDoor], random: &mut Random, most: i64) -> Option<Vec<AxialDoor>> {
    let mut next = |x: f64| {
        let by = (random.bits() % (2 * most as u64 + 1)) as i64 - most;
        // From 1 on, so that a unit is much the same for all.
        let x = x + 64.0;
        f64::from_bits((x.to_bits() as i64 + by) as u64)
    };
    let door = |door: &AxialDoor| {
        let mut door = *door;
        for axis in 0..3 {
            let is_flat = axis == usize::from(door.axis);
            door.extent.min[axis] = next(door.extent.min[axis]);
            door.extent.max[axis] = if is_flat { door.extent.min[axis] } else { next(door.extent.max[axis]) };
        }
        let has_area = (0..3).all(|k| k == usize::from(door.axis) || door.extent.min[k] < door.extent.max[k]);
        has_area.then_some(door)
    };
    doors.iter().map(door).collect()
}

/// A door that is wider and higher by some units in the last place on each side.
fn widened(door: &AxialDoor, by: i64) -> AxialDoor {
    let step = |x: f64, by: i64| f64::from_bits((x.to_bits() as i64 + by) as u64);
    let mut door = *door;
    for axis in (0..3).filter(|&axis| axis != usize::from(door.axis)) {
        door.extent.min[axis] = step(door.extent.min[axis], -by);
        door.extent.max[axis] = step(door.extent.max[axis], by);
    }
    door
}

/// Whether a line passes, by integers: Plücker's product of sums of two doubles.
fn passes_exactly(line: &FineLine3, portal: &Portal3) -> bool {
    let cross = |a: &[BigInt; 3], b: &[BigInt; 3]| [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i]);
    let minus = |a: &[BigInt; 3], b: &[BigInt; 3]| [0, 1, 2].map(|i| &a[i] - &b[i]);
    let point = |p: [[f64; 2]; 3]| {
        let [high, low] = [0, 1].map(|k| whole(p.map(|x| x[k])));
        [0, 1, 2].map(|i| &high[i] + &low[i])
    };
    let [a, b] = line.points().map(point);
    let (d, m) = (minus(&b, &a), cross(&a, &b));
    portal.edges().all(|[e, f]| {
        let (e, f) = (whole(e), whole(f));
        let (ed, em) = (minus(&f, &e), cross(&e, &f));
        (0..3).fold(BigInt::zero(), |sum, i| sum + &d[i] * &em[i] + &m[i] * &ed[i]).is_positive()
    })
}

#[derive(Debug, Default, Clone, Copy)]
struct Found {
    /// Left open by doubles: visible, hidden.
    open: [usize; 2],
    /// Of these, still open.
    left: [usize; 2],
    /// Decided by doubles.
    others: usize,
}

/// Decides a sequence by both, and compares with brute force.
/// Returns the proof of a hidden one that doubles leave open.
fn compare(doors: &[AxialDoor], found: &mut Found) -> Result<Option<HullProof>, TestCaseError> {
    let portals: Vec<Portal3> = doors.iter().map(polygon).collect();
    let truth = axial_stabbable_brute_force(doors);
    let mut stabber = ConvexStabber::new(StabLimits::default());
    let is_open = matches!(stabber.stab(&refs(&portals), None), Verdict::Undecided(_));
    let place = usize::from(!truth);
    if is_open {
        found.open[place] += 1;
    } else {
        found.others += 1;
    }
    // Whatever doubles decide, this must not contradict.
    match stabber.stab_finely(&refs(&portals)) {
        Verdict::Visible(line) => {
            prop_assert!(truth, "{:?}", doors);
            prop_assert!(portals.iter().all(|p| passes_exactly(&line, p)), "{:?} {:?}", line, doors);
            prop_assert!(portals.iter().all(|p| line.passes(p)));
        }
        Verdict::Hidden(proof) => {
            prop_assert!(!truth, "{:?}", doors);
            prop_assert!(proof.holds(&refs(&portals)));
            let ConvexCertificate::Hulls(proof) = proof else { panic!("another kind of proof") };
            return Ok(Some(proof).filter(|_| is_open));
        }
        Verdict::Undecided(_) => found.left[place] += usize::from(is_open),
    }
    Ok(None)
}

proptest! {
    /// Invariant: nothing contradicts brute force, on the grid and beside it.
    #[test]
    fn fine_answers_agree_with_brute_force(
        doors in prop_oneof![3 => axial_corridor(), 1 => straight_axial_corridor()],
        seed: u64,
        units in 0i64..4,
    ) {
        let Some(doors) = moved(&doors, &mut Random::new(seed), units) else { return Ok(()) };
        compare(&doors, &mut Found::default())?;
    }
}

/// Tightness: of what doubles leave open, little stays so. Impostors: proofs with a row left out or changed.
#[test]
fn most_of_what_doubles_leave_open_is_decided() {
    let (mut found, mut n_damaged, mut n_refused, mut n_wide) = (Found::default(), 0, 0, 0);
    let mut random = Random::new(11);
    for doors in sightlines_testkit::draw(&axial_corridor(), 3000) {
        for units in [0, 1, 3] {
            let Some(doors) = moved(&doors, &mut random, units) else { continue };
            let Some(proof) = compare(&doors, &mut found).expect("it agrees") else { continue };
            let portals: Vec<Portal3> = doors.iter().map(polygon).collect();
            let holds = |proof: HullProof| ConvexCertificate::Hulls(proof).holds(&refs(&portals));
            let with = |terms: Vec<ConvexTerm>| HullProof { terms, ..proof.clone() };
            let [first, last] = proof.portals;
            assert!(!holds(HullProof { portals: [last, first], ..proof.clone() }));
            assert!(!holds(HullProof { portals: [first, portals.len()], ..proof.clone() }));
            assert!(!holds(with(Vec::new())));
            // Where the doors are wider by some units, and lines pass, it proves nothing.
            for by in 1..8 {
                let wide: Vec<AxialDoor> = doors.iter().map(|door| widened(door, by)).collect();
                let polygons: Vec<Portal3> = wide.iter().map(polygon).collect();
                if axial_stabbable_brute_force(&wide) {
                    assert!(!ConvexCertificate::Hulls(proof.clone()).holds(&refs(&polygons)), "{wide:?}");
                    n_wide += 1;
                }
            }
            for k in 0..proof.terms.len() {
                let change = |change: &dyn Fn(&mut ConvexTerm)| {
                    let mut terms = proof.terms.clone();
                    change(&mut terms[k]);
                    holds(with(terms))
                };
                assert!(!change(&|term| term.multiplier = 0.0));
                assert!(!change(&|term| term.multiplier = f64::NAN));
                assert!(!change(&|term| term.multiplier = f64::INFINITY));
                assert!(!change(&|term| term.edge = 99));
                assert!(!change(&|term| term.portal = 99));
                // Without a row, or with that of another edge, less than two of three proofs hold.
                let mut rest = proof.terms.clone();
                let taken = rest.remove(k);
                rest.retain(|term| (term.portal, term.edge) != (taken.portal, taken.edge));
                n_damaged += 2;
                n_refused += usize::from(!holds(with(rest)));
                n_refused += usize::from(!change(&|term| term.edge = (term.edge + 2) % 4));
            }
        }
    }
    println!("{found:?}; damaged {n_damaged}, refused {n_refused}");
    assert!(found.open.iter().all(|&n| n > 10), "{found:?}");
    let [open, left] = [found.open, found.left].map(|[visible, hidden]| visible + hidden);
    assert!(left * 10 <= open, "{found:?}");
    assert!(n_damaged > 50 && n_refused * 3 > n_damaged, "{n_damaged} {n_refused}");
    assert!(n_wide > 20, "{n_wide}");
}

/// A slit of one unit in the last place between two doors with a third behind: a line passes it, and none does where the slit is
/// closed by as much.
#[test]
fn a_slit_of_a_unit_in_the_last_place_is_open() {
    let square = |z: f64, x: [f64; 2]| {
        Portal3::around(&[[x[0], 0.0, z], [x[1], 0.0, z], [x[1], 1.0, z], [x[0], 1.0, z]]).expect("an area")
    };
    let unit = f64::EPSILON * 64.0;
    let mut stabber = ConvexStabber::new(StabLimits::default());
    // Lines lean by less than 1 from the first door to the third, and by 1 from the first to the second where it is closed.
    let slit = |by: f64| [square(0.0, [64.0, 65.0]), square(1.0, [66.0 - by, 67.0]), square(2.0, [60.0, 67.0])];
    assert!(matches!(stabber.stab_finely(&refs(&slit(unit))), Verdict::Visible(_)), "open by a unit");
    assert!(matches!(stabber.stab_finely(&refs(&slit(0.0))), Verdict::Hidden(_)), "grazed");
    assert!(matches!(stabber.stab_finely(&refs(&slit(-unit))), Verdict::Hidden(_)), "closed by a unit");
    // The impostor: the line of the open slit does not pass the closed ones.
    let Verdict::Visible(line) = stabber.stab_finely(&refs(&slit(unit))) else { unreachable!() };
    for closed in [slit(0.0), slit(-unit)] {
        assert!(!closed.iter().all(|p| line.passes(p)));
    }
}

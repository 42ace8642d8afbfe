//! The axial stabber, its proofs and the linear program against brute force.

use num_bigint::BigInt;
use proptest::prelude::*;
use sightlines_geometry::{Aabb, Adaptive, AxialDoor, Point2, Portal2};
use sightlines_sightline::{
    AxialCertificate, AxialStabber, Funnel, OctantProof, SightlineError, Stabber, Verdict, stabbing_line_axial,
};
use sightlines_testkit::lp::{LpAnswer, stab_axial};
use sightlines_testkit::{
    AXIS_ORDERS, any_axial_doors, axial_corridor, axial_meets_brute_force, axial_moved, axial_stabbable_brute_force,
    straight_axial_corridor,
};

fn any_corridor() -> impl Strategy<Value = Vec<AxialDoor>> {
    prop_oneof![4 => axial_corridor(), 1 => straight_axial_corridor()]
}

fn is_open(doors: &[AxialDoor]) -> bool {
    let mut stabber = AxialStabber::new();
    stabber.start(doors[0]);
    doors[1..].iter().all(|&door| stabber.push(door).is_some())
}

/// Moves doors by a vector and scales them by a factor.
fn affine(doors: &[AxialDoor], factor: f64, by: [f64; 3]) -> Vec<AxialDoor> {
    let point = |p: [f64; 3]| [0, 1, 2].map(|i| p[i] * factor + by[i]);
    let extent = |b: &Aabb<3>| Aabb { min: point(b.min), max: point(b.max) };
    doors.iter().map(|d| AxialDoor { extent: extent(&d.extent), ..*d }).collect()
}

/// The state that distinguishes two stabbers, besides counters.
fn state(stabber: &mut AxialStabber) -> String {
    let witness = stabber.witness();
    format!("{:?} {witness:?}", stabber.doors())
}

fn door(axis: u8, min: [f64; 3], max: [f64; 3]) -> AxialDoor {
    AxialDoor { extent: Aabb { min, max }, axis, forward: true }
}

/// A door across a corridor along x.
fn across(x: f64, y: [f64; 2], z: [f64; 2]) -> AxialDoor {
    door(0, [x, y[0], z[0]], [x, y[1], z[1]])
}

proptest! {
    /// Invariant: push by push, the stabber passes as long as brute force does; its lines pass.
    #[test]
    fn stabber_agrees_with_brute_force(doors in any_corridor()) {
        let mut stabber = AxialStabber::new();
        stabber.start(doors[0]);
        for n in 1..=doors.len() {
            let open = axial_stabbable_brute_force(&doors[..n]);
            prop_assert_eq!(n == 1 || stabber.push(doors[n - 1]).is_some(), open, "{} doors of {:?}", n, doors);
            if !open {
                break;
            }
            let witness = stabber.witness();
            prop_assert!(doors[..n].iter().all(|d| witness.passes(d)), "{:?} {:?}", witness, doors);
        }
    }

    /// Invariant: for doors in any order and of any kind, the answer is brute force's, and proven.
    #[test]
    fn stabbing_lines_are_proven(doors in prop_oneof![any_corridor(), any_axial_doors()]) {
        let open = axial_stabbable_brute_force(&doors);
        match stabbing_line_axial(&doors) {
            Ok(Some(Verdict::Visible(witness))) => {
                prop_assert!(open, "{:?}", doors);
                prop_assert!(doors.iter().all(|d| witness.passes(d)), "{:?} {:?}", witness, doors);
                prop_assert!(witness.direction().iter().all(|d| *d != Default::default()));
                let rounded = witness.rounded(&doors);
                prop_assert!(rounded.is_some(), "{:?} {:?}", witness, doors);
            }
            Ok(Some(Verdict::Hidden(certificate))) => {
                prop_assert!(!open, "{:?}", doors);
                prop_assert!(certificate.holds(&doors), "{:?} {:?}", certificate, doors);
                let named: Vec<AxialDoor> = certificate.doors().into_iter().map(|i| doors[i]).collect();
                prop_assert!(!axial_stabbable_brute_force(&named), "the doors named are passable without the others");
                if let AxialCertificate::Rows { proofs, .. } = &certificate {
                    prop_assert!(proofs.iter().all(|p| (1..=6).contains(&p.terms.len())), "{:?}", certificate);
                }
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }

    /// Invariant: coordinates that rounding moved off a grid, so that edges line up almost, are decided as
    /// they are, with lines and proofs.
    #[test]
    fn almost_aligned_doors_are_decided_exactly(doors in axial_corridor(), nudges in any::<[i8; 8]>()) {
        let mut doors = affine(&doors[..doors.len().min(5)], 0.1, [0.0, 100.0, 0.7]);
        for (door, nudge) in doors.iter_mut().zip(nudges) {
            let side = usize::from(door.axis + 1) % 3;
            let x = &mut door.extent.max[side];
            *x = if nudge % 3 == 0 || *x == 0.0 { *x } else if nudge > 0 { x.next_up() } else { x.next_down() };
        }
        let open = axial_stabbable_brute_force(&doors);
        prop_assert_eq!(is_open(&doors), open, "{:?}", doors);
        match stabbing_line_axial(&doors) {
            Ok(Some(Verdict::Visible(witness))) => prop_assert!(open && doors.iter().all(|d| witness.passes(d))),
            Ok(Some(Verdict::Hidden(certificate))) => prop_assert!(!open && certificate.holds(&doors)),
            other => prop_assert!(false, "{:?}", other),
        }
    }

    /// Invariant: undo restores what push changed, also after blocked pushes and blocked queries.
    #[test]
    fn undo_restores(doors in any_corridor(), others in any_axial_doors()) {
        let mut stabber = AxialStabber::new();
        stabber.start(doors[0]);
        let mut done = Vec::new();
        for &door in doors[1..].iter().chain(&others) {
            let before = state(&mut stabber);
            match stabber.push(door) {
                Some(undo) => done.push((before, undo)),
                None => prop_assert_eq!(before, state(&mut stabber)),
            }
        }
        while let Some((before, undo)) = done.pop() {
            stabber.undo(undo);
            prop_assert_eq!(before, state(&mut stabber));
        }
        // What is left works as if nothing had been pushed.
        let mut fresh = AxialStabber::new();
        fresh.start(doors[0]);
        for &door in &doors[1..] {
            prop_assert_eq!(fresh.push(door).is_some(), stabber.push(door).is_some());
        }
    }

    /// Invariant: doors that all face one axis are passable exactly if two funnels are.
    #[test]
    fn straight_corridors_are_two_funnels(doors in straight_axial_corridor()) {
        let axis = usize::from(doors[0].axis);
        let planar = |other: usize| {
            let portal = |d: &AxialDoor| {
                let [low, high] = [d.extent.min[other], d.extent.max[other]].map(|y| Point2::new(d.at(), y));
                if d.forward { Portal2 { left: high, right: low } } else { Portal2 { left: low, right: high } }
            };
            let mut funnel = Funnel::new(Adaptive);
            funnel.start(portal(&doors[0]));
            doors[1..].iter().all(|d| funnel.push(portal(d)).is_some())
        };
        let open = planar((axis + 1) % 3) && planar((axis + 2) % 3);
        prop_assert_eq!(is_open(&doors), open);
        let program = matches!(stabbing_line_axial(&doors), Ok(Some(Verdict::Visible(_))));
        prop_assert_eq!(program, open, "{:?}", doors);
    }

    /// Invariant: what good_lp opens is open; what it leaves unclear is blocked or tight.
    #[test]
    fn linear_program_agrees_where_it_is_clear(doors in any_corridor()) {
        let open = axial_stabbable_brute_force(&doors);
        match stab_axial(&doors) {
            LpAnswer::Open { margin } => prop_assert!(open, "margin {} of {:?}", margin, doors),
            // On the grids of these corridors an open sequence has a margin far above the threshold.
            LpAnswer::Unclear => prop_assert!(!open, "{:?}", doors),
            other => prop_assert!(false, "{:?} of {:?}", other, doors),
        }
    }

    /// Invariant: moving, scaling by powers of two, permuting axes, mirroring and reversal change nothing.
    #[test]
    fn answers_have_symmetries(
        doors in any_corridor(),
        order in prop::sample::select(AXIS_ORDERS.to_vec()),
        mirror in any::<[bool; 3]>(),
        power in -30i32..30,
    ) {
        let open = is_open(&doors);
        prop_assert_eq!(is_open(&affine(&doors, 1.0, [1e7, -1e7, 3e7])), open, "moved");
        prop_assert_eq!(is_open(&affine(&doors, 2f64.powi(power), [0.0; 3])), open, "scaled");
        prop_assert_eq!(is_open(&axial_moved(&doors, order, mirror)), open, "permuted");
        let back: Vec<AxialDoor> = doors.iter().rev().map(|d| d.reversed()).collect();
        prop_assert_eq!(is_open(&back), open, "reversed");
    }

    /// Invariant: a box is met exactly if brute force meets it, and the cheap tests never lose one.
    #[test]
    fn boxes_are_met_exactly(
        doors in any_corridor(),
        ahead in prop::collection::vec(([-6i32..=9, -6..=9, -6..=9], [0i32..=4, 0..=4, 0..=4]), 12),
    ) {
        let mut stabber = AxialStabber::new();
        stabber.start(doors[0]);
        let n = 1 + doors[1..].iter().take_while(|&&d| stabber.push(d).is_some()).count();
        let last = doors[n - 1];
        for (corner, size) in ahead {
            let near = [0, 1, 2].map(|i| last.extent.min[i].round() + f64::from(corner[i]));
            let far = [0, 1, 2].map(|i| near[i] + f64::from(size[i]));
            let bounds = Aabb { min: near, max: far };
            let met = axial_meets_brute_force(&doors[..n], &bounds);
            prop_assert_eq!(stabber.meets_box(&bounds), met, "{:?} beyond {:?}", bounds, &doors[..n]);
            prop_assert!(!met || stabber.may_meet(&bounds), "{:?} beyond {:?}", bounds, &doors[..n]);
        }
    }

    /// Invariant: a changed certificate is refused, whatever was changed.
    #[test]
    fn tampered_certificates_are_refused(doors in axial_corridor()) {
        let Ok(Some(Verdict::Hidden(certificate))) = stabbing_line_axial(&doors) else { return Ok(()) };
        let AxialCertificate::Rows { guards, proofs } = certificate else { return Ok(()) };
        let changes: [fn(&mut OctantProof); 7] = [
            // A row less, a multiplier one more, none at all or turned round, another side, another door.
            |p| p.terms.truncate(p.terms.len() - 1),
            |p| p.terms[0].1 += 1,
            |p| p.terms[0].1 = BigInt::from(0),
            |p| p.terms[0].1 = -p.terms[0].1.clone(),
            |p| p.terms[0].0.entering ^= true,
            |p| p.terms[0].0.door = 99,
            |p| p.terms.clear(),
        ];
        for (i, change) in changes.iter().enumerate() {
            let mut proofs = proofs.clone();
            proofs.iter_mut().for_each(change);
            let holds = AxialCertificate::Rows { guards, proofs }.holds(&doors);
            prop_assert!(!holds, "change {}", i);
        }
        let none = AxialCertificate::Rows { guards, proofs: Vec::new() };
        prop_assert!(!none.holds(&doors));
        let unguarded = AxialCertificate::Rows { guards, proofs };
        prop_assert!(!unguarded.holds(&doors[..1]), "one door is not blocked");
    }
}

/// The impostor of the comparison with brute force: a stabber that drops the rows about one axis.
#[test]
fn a_forgetful_stabber_is_noticed() {
    let tall = |doors: &[AxialDoor]| -> Vec<AxialDoor> {
        let stretched = |mut d: AxialDoor| {
            if d.axis != 2 {
                (d.extent.min[2], d.extent.max[2]) = (-1e3, 1e3);
            }
            d
        };
        doors.iter().map(|&d| stretched(d)).collect()
    };
    let drawn = sightlines_testkit::draw(&axial_corridor(), 300);
    let wrong = drawn.iter().filter(|doors| is_open(&tall(doors)) != axial_stabbable_brute_force(doors)).count();
    assert!(wrong > 0);
}

/// The impostors of the certificates: guards that guard nothing, and doors that are not opposed.
#[test]
fn guards_are_checked() {
    let blocked = [across(0., [0., 1.], [0., 1.]), across(1., [5., 6.], [0., 1.]), across(2., [0., 1.], [0., 1.])];
    let Ok(Some(Verdict::Hidden(certificate))) = stabbing_line_axial(&blocked) else { panic!("blocked") };
    assert!(certificate.holds(&blocked));
    let AxialCertificate::Rows { guards, proofs } = certificate else { panic!("not opposed") };
    assert!(matches!(guards, [Some(_), None, None]), "{guards:?}");
    for guards in [[None; 3], [Some(7), None, None], [None, Some(0), None]] {
        assert!(!AxialCertificate::Rows { guards, proofs: proofs.clone() }.holds(&blocked));
    }
    assert!(!AxialCertificate::Opposed([0, 1]).holds(&blocked));
    assert!(!AxialCertificate::Opposed([0, 7]).holds(&blocked));
    let opposed = [blocked[0], blocked[1].reversed()];
    let Ok(Some(Verdict::Hidden(certificate))) = stabbing_line_axial(&opposed) else { panic!("blocked") };
    assert_eq!(certificate, AxialCertificate::Opposed([0, 1]));
    assert!(certificate.holds(&opposed) && !certificate.holds(&blocked));
    assert_eq!(certificate.doors(), [0, 1]);
}

/// Edges that line up exactly leave only grazing lines; one unit in the last place more opens them.
#[test]
fn slits_of_one_ulp_are_open_and_aligned_edges_are_not() {
    let high = [0.0, 1.0];
    // Straight: the middle door begins where the others end.
    let straight = |low: f64| [across(0., [0., 0.7], high), across(1e3, [low, 1.], high), across(2e3, [0., 0.7], high)];
    // Round a corner: in along x, through a hatch in y, on along x, below the diagonal y = x.
    let bent =
        |low: f64| [across(0., [0., 1.], high), door(1, [1., 1., 0.], [2., 1., 1.]), across(3., [low, 4.], high)];
    // The same, with the second slit along z.
    let twice = |low: f64, floor: f64| {
        let [first, hatch, last] = bent(low);
        [across(-3., [-4., 1.], [0., 0.5]), first, hatch, across(3., [low, 4.], [floor, 1.]), last]
    };
    let mut n_exact = 0;
    for (doors, open) in [
        (straight(0.7).to_vec(), false),
        (straight(0.7f64.next_down()).to_vec(), true),
        (bent(3.).to_vec(), false),
        (bent(3f64.next_down()).to_vec(), true),
        (twice(3f64.next_down(), 0.5).to_vec(), true),
        (twice(3., 0.5).to_vec(), false),
    ] {
        assert_eq!(axial_stabbable_brute_force(&doors), open, "{doors:?}");
        let mut stabber = AxialStabber::new();
        stabber.start(doors[0]);
        assert_eq!(doors[1..].iter().all(|&door| stabber.push(door).is_some()), open, "{doors:?}");
        n_exact += stabber.counters().n_exact;
        let visible = matches!(stabbing_line_axial(&doors), Ok(Some(Verdict::Visible(_))));
        assert_eq!(visible, open, "{doors:?}");
    }
    assert!(n_exact > 0, "slits as narrow as these are for fractions");
}

#[test]
fn bad_sequences_are_errors() {
    let good = across(0., [0., 1.], [0., 1.]);
    assert_eq!(stabbing_line_axial(&[]), Ok(None));
    let cases = [
        (across(1., [0., f64::NAN], [0., 1.]), SightlineError::NotFinite(1)),
        (across(1e300, [0., 1.], [0., 1.]), SightlineError::NotFinite(1)),
        (across(1., [1., 1.], [0., 1.]), SightlineError::ZeroLength(1)),
        (across(1., [2., 1.], [0., 1.]), SightlineError::ZeroLength(1)),
        (AxialDoor { axis: 1, ..good }, SightlineError::NotFlat(1)),
        (AxialDoor { axis: 3, ..good }, SightlineError::NotFlat(1)),
    ];
    for (bad, error) in cases {
        assert_eq!(stabbing_line_axial(&[good, bad]), Err(error));
    }
    assert_eq!(SightlineError::NotFlat(1).to_string(), "portal 1 is not perpendicular to its axis");
}

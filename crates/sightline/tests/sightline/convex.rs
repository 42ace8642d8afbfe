//! Lines through convex polygons: both answers against exact integers, sampled lines and axial doors.

use num_bigint::BigInt;
use num_traits::{Float, Signed, Zero};
use proptest::prelude::*;
use sightlines_geometry::{AxialDoor, Point3, Portal3, Random};
use sightlines_sightline::{
    BoxProof, ConvexCertificate, ConvexNode, ConvexStabber, ConvexVerdict, KnownPortal, LimitReached, Line3,
    PlaneProof, StabLimits, Verdict,
};
use sightlines_testkit::{axial_corridor, axial_stabbable_brute_force, straight_axial_corridor};

/// A number between two others.
fn within(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * random.unit()
}

/// Tilted polygons of 3 to 6 corners along a bent corridor; `noise` is added to each coordinate, and
/// `grid` is what coordinates are rounded to before (0 for not at all).
fn corridor(random: &mut Random, n: usize, size: f64, grid: f64, noise: f64) -> Vec<Portal3> {
    let mut portals = Vec::new();
    let (mut at, mut k) = ([0.0f64; 3], 0);
    while portals.len() < n {
        k += 1;
        assert!(k < 100 * n + 100, "polygons without area");
        let centre = [at[0] + within(random, -40.0, 40.0), at[1] + within(random, -40.0, 40.0), at[2]];
        let tilt = [within(random, -0.6, 0.6), within(random, -0.6, 0.6)];
        let corners = 3 + (random.bits() % 4) as usize;
        let turn = random.unit();
        let points: Vec<Point3> = (0..corners)
            .map(|i| {
                let angle = (i as f64 + turn + within(random, -0.3, 0.3)) / corners as f64 * std::f64::consts::TAU;
                let (x, y) = (angle.cos() * size, angle.sin() * size);
                let p = [centre[0] + x, centre[1] + y, centre[2] + tilt[0] * x + tilt[1] * y];
                let p = p.map(|x| if grid > 0.0 { (x / grid).round() * grid } else { x });
                p.map(|x| x + within(random, -noise, noise))
            })
            .collect();
        // Rounded to a grid they are as flat as they are.
        if let Some(portal) = Portal3::around(&points)
            && portal.normal()[2] > 0.0
        {
            portals.push(portal);
            at[2] += size * 2.0 + within(random, 10.0, 150.0);
        }
    }
    portals
}

/// A coordinate times 2^200, which is an integer for all that occur here.
pub(crate) fn whole(p: Point3) -> [BigInt; 3] {
    p.map(|x| {
        let (mantissa, exponent, sign) = Float::integer_decode(x);
        assert!(mantissa == 0 || exponent >= -200, "{x:e}");
        (BigInt::from(mantissa) * sign) << (exponent + 200).max(0)
    })
}

/// Whether a line passes, by Plücker's product in integers.
fn passes_exactly(line: &Line3, portal: &Portal3) -> bool {
    let cross = |a: &[BigInt; 3], b: &[BigInt; 3]| [(1, 2), (2, 0), (0, 1)].map(|(i, j)| &a[i] * &b[j] - &a[j] * &b[i]);
    let minus = |a: &[BigInt; 3], b: &[BigInt; 3]| [0, 1, 2].map(|i| &a[i] - &b[i]);
    let (a, b) = (whole(line.a), whole(line.b));
    let (d, m) = (minus(&b, &a), cross(&a, &b));
    portal.edges().all(|[e, f]| {
        let (e, f) = (whole(e), whole(f));
        let (ed, em) = (minus(&f, &e), cross(&e, &f));
        let sum = (0..3).fold(BigInt::zero(), |sum, i| sum + &d[i] * &em[i] + &m[i] * &ed[i]);
        sum.is_positive()
    })
}

pub(crate) fn refs(portals: &[Portal3]) -> Vec<&Portal3> {
    portals.iter().collect()
}

/// A random point of a polygon.
fn inside(random: &mut Random, portal: &Portal3) -> Point3 {
    let weights: Vec<f64> = portal.corners().iter().map(|_| -random.unit().max(1e-9).ln()).collect();
    let total: f64 = weights.iter().sum();
    [0, 1, 2].map(|i| portal.corners().iter().zip(&weights).map(|(p, w)| p[i] * w).sum::<f64>() / total)
}

/// Whether one of `tries` lines through random points of two random portals passes all.
fn sampled(random: &mut Random, portals: &[Portal3], tries: usize) -> Option<Line3> {
    (0..tries).find_map(|_| {
        let j = 1 + (random.bits() as usize) % (portals.len() - 1);
        let i = (random.bits() as usize) % j;
        let line = Line3::through(inside(random, &portals[i]), inside(random, &portals[j]))?;
        portals.iter().all(|p| passes_exactly(&line, p)).then_some(line)
    })
}

/// What a sequence was found to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Found {
    Visible,
    Hidden,
    Undecided,
}

/// Decides, and proves the answer by other means than the solver's.
fn decide(stabber: &mut ConvexStabber, portals: &[Portal3]) -> Found {
    let sequence = refs(portals);
    match stabber.stab(&sequence, None) {
        Verdict::Visible(line) => {
            assert!(portals.iter().all(|p| passes_exactly(&line, p)), "{line:?} does not pass {portals:?}");
            Found::Visible
        }
        Verdict::Hidden(proof) => {
            assert!(proof.holds(&sequence), "{proof:?} does not hold for {portals:?}");
            Found::Hidden
        }
        Verdict::Undecided(_) => Found::Undecided,
    }
}

/// The corners of a portal, scaled about its first corner's neighbourhood: their mean.
fn scaled(portal: &Portal3, by: f64) -> Option<Portal3> {
    let n = portal.corners().len() as f64;
    let mean = [0, 1, 2].map(|i| portal.corners().iter().map(|p| p[i]).sum::<f64>() / n);
    let points: Vec<Point3> =
        portal.corners().iter().map(|p| [0, 1, 2].map(|i| mean[i] + by * (p[i] - mean[i]))).collect();
    Portal3::around(&points).filter(|p| p.normal()[2] > 0.0)
}

fn moved(portals: &[Portal3], by: Point3) -> Vec<Portal3> {
    let point = |p: &Point3| [p[0] + by[0], p[1] + by[1], p[2] + by[2]];
    portals.iter().filter_map(|p| Portal3::around(&p.corners().iter().map(point).collect::<Vec<_>>())).collect()
}

proptest! {
    /// Invariants: each answer is proven; what a sampled line passes is never hidden.
    #[test]
    fn answers_are_proven_and_no_sampled_line_is_lost(
        seed: u64,
        n in 2usize..12,
        size in 15.0f64..90.0,
        grid in prop_oneof![Just(0.0), Just(1.0), Just(8.0), Just(32.0)],
        noise in prop_oneof![Just(0.0), Just(1e-13)],
        far in prop_oneof![Just([0.0; 3]), Just([1e5, -9e4, 7e4])],
    ) {
        let mut random = Random::new(seed);
        let portals = moved(&corridor(&mut random, n, size.max(2.0 * grid), grid, noise), far);
        prop_assume!(portals.len() >= 2);
        let found = decide(&mut ConvexStabber::new(StabLimits::default()), &portals);
        if let Some(line) = sampled(&mut random, &portals, 100) {
            prop_assert_ne!(found, Found::Hidden, "{:?} passes {:?}", line, portals);
        }
    }

    /// Invariant: on chains of axial doors, on a small grid where grazing is common, no answer differs from
    /// brute force.
    #[test]
    fn axial_chains_agree_with_brute_force(doors in prop_oneof![3 => axial_corridor(), 1 => straight_axial_corridor()]) {
        let portals: Vec<Portal3> = doors.iter().map(polygon).collect();
        let open = axial_stabbable_brute_force(&doors);
        let found = decide(&mut ConvexStabber::new(StabLimits::default()), &portals);
        prop_assert_ne!(found, if open { Found::Hidden } else { Found::Visible }, "{:?}", doors);
    }

    /// Nor what is kept of the portal, or of the sequences before: the same answers with the same proofs.
    #[test]
    fn known_portals_change_no_answer(seed: u64, n in 1usize..9, size in 20.0f64..60.0) {
        let mut random = Random::new(seed);
        let mut stabber = ConvexStabber::new(StabLimits::default());
        for grid in [0.0, 4.0, 16.0] {
            let portals = corridor(&mut random, n, size, grid, 0.0);
            let known: Vec<KnownPortal> = portals.iter().cloned().map(KnownPortal::new).collect();
            let found = stabber.stab_known(&known.iter().collect::<Vec<_>>(), None);
            prop_assert_eq!(format!("{found:?}"), format!("{:?}", stab(&portals)));
        }
    }

    /// Invariant: hints do not change what is so.
    #[test]
    fn hints_change_no_answer(seed: u64, n in 3usize..9, size in 20.0f64..60.0) {
        let mut random = Random::new(seed);
        let portals = corridor(&mut random, n, size, 0.0, 0.0);
        let hint = Line3::through(inside(&mut random, &portals[0]), inside(&mut random, &portals[n - 1])).unwrap();
        let mut stabber = ConvexStabber::new(StabLimits::default());
        let plain = decide(&mut stabber, &portals);
        let hinted = match stabber.stab(&refs(&portals), Some(&hint)) {
            Verdict::Visible(line) => {
                prop_assert!(portals.iter().all(|p| passes_exactly(&line, p)));
                Found::Visible
            }
            Verdict::Hidden(_) => Found::Hidden,
            Verdict::Undecided(_) => Found::Undecided,
        };
        prop_assert_eq!(plain, hinted);
    }
}

/// A door as a polygon that is crossed the same way.
pub(crate) fn polygon(door: &AxialDoor) -> Portal3 {
    let axis = usize::from(door.axis);
    let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
    let corner = |low_b: bool, low_c: bool| {
        let mut p = door.extent.min;
        p[b] = if low_b { door.extent.min[b] } else { door.extent.max[b] };
        p[c] = if low_c { door.extent.min[c] } else { door.extent.max[c] };
        p
    };
    let points = [corner(true, true), corner(false, true), corner(false, false), corner(true, false)];
    let portal = Portal3::around(&points).expect("a door has an area");
    if door.forward { portal } else { portal.reversed() }
}

/// Tightness: nothing that is not grazing stays undecided, of random sequences of all lengths.
#[test]
fn random_sequences_are_all_decided() {
    let mut found = [0; 2];
    for n in [2usize, 3, 5, 10, 20, 50] {
        let mut stabber = ConvexStabber::new(StabLimits::default());
        let mut random = Random::new(n as u64);
        for _ in 0..100 {
            let size = within(&mut random, 20.0, 80.0) * (1.0 + n as f64 / 20.0);
            match decide(&mut stabber, &corridor(&mut random, n, size, 0.0, 0.0)) {
                Found::Visible => found[0] += 1,
                Found::Hidden => found[1] += 1,
                Found::Undecided => panic!("a sequence of {n} portals is undecided"),
            }
        }
        let c = stabber.counters();
        assert_eq!(c.n_asked, 100);
        println!("{n} portals: {c:?}");
    }
    assert!(found.iter().all(|n| *n > 50), "{found:?}");
}

/// Tightness near the critical size, at which visibility flips: still decided at a relative distance of 1e-6, and
/// the two answers are on the two sides.
#[test]
fn sequences_near_the_critical_size_are_decided() {
    let mut cases = 0;
    for n in [3usize, 5, 10, 20] {
        let mut random = Random::new(100 + n as u64);
        let mut most = [0; 3];
        for _ in 0..25 {
            let portals = corridor(&mut random, n, 40.0, 0.0, 0.0);
            let with = |by: f64| portals.iter().map(|p| scaled(p, by)).collect::<Option<Vec<_>>>();
            let mut stabber = ConvexStabber::new(StabLimits::default());
            let [mut low, mut high] = [1e-3f64, 16.0];
            let (Some(small), Some(large)) = (with(low), with(high)) else { continue };
            if decide(&mut stabber, &small) != Found::Hidden || decide(&mut stabber, &large) != Found::Visible {
                continue;
            }
            while high / low > 1.0 + 1e-7 {
                let by = (low * high).sqrt();
                let before = stabber.counters();
                let found = stabber.stab(&refs(&with(by).unwrap()), None);
                let boxes = (stabber.counters() - before).n_boxes;
                match found {
                    Verdict::Visible(_) => high = by,
                    Verdict::Hidden(_) => low = by,
                    Verdict::Undecided(_) => panic!("undecided between {low} and {high}: {portals:?}"),
                }
                let band = if high / low > 1.01 {
                    0
                } else if high / low > 1.0001 {
                    1
                } else {
                    2
                };
                most[band] = most[band].max(boxes);
                cases += 1;
            }
            assert_eq!(decide(&mut stabber, &with(low).unwrap()), Found::Hidden);
            assert_eq!(decide(&mut stabber, &with(high).unwrap()), Found::Visible);
        }
        println!("{n} portals, most boxes at 1e-2, 1e-4, 1e-7 from critical: {most:?}");
    }
    assert!(cases > 1000, "{cases}");
}

/// Tightness on the grid, where most of what is hidden is grazed.
#[test]
fn few_axial_chains_stay_undecided() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut stabber = ConvexStabber::new(StabLimits::default());
    let mut found = [0; 3];
    for _ in 0..1000 {
        let doors = proptest::strategy::ValueTree::current(&axial_corridor().new_tree(&mut runner).unwrap());
        let portals: Vec<Portal3> = doors.iter().map(polygon).collect();
        found[decide(&mut stabber, &portals) as usize] += 1;
    }
    println!("visible, hidden, undecided: {found:?}; {:?}", stabber.counters());
    assert!(found[0] > 100 && found[1] > 100, "{found:?}");
    assert!(found[2] * 20 <= found[1], "{found:?}");
}

/// Hidden sequences and their proofs.
fn proofs(count: usize) -> Vec<(Vec<Portal3>, ConvexCertificate)> {
    let mut random = Random::new(77);
    let mut stabber = ConvexStabber::new(StabLimits::default());
    let mut proofs = Vec::new();
    while proofs.len() < count {
        let n = 3 + (random.bits() % 6) as usize;
        let portals = corridor(&mut random, n, 24.0, 0.0, 0.0);
        if let Verdict::Hidden(proof) = stabber.stab(&refs(&portals), None) {
            proofs.push((portals, proof));
        }
    }
    proofs
}

#[test]
fn damaged_box_proofs_are_refused() {
    let (mut terms, mut blocks, mut refused) = (0, 0, 0);
    for (portals, proof) in proofs(60) {
        let sequence = refs(&portals);
        assert!(proof.holds(&sequence));
        let ConvexCertificate::Boxes(proof) = proof else { continue };
        let holds = |proof: BoxProof| ConvexCertificate::Boxes(proof).holds(&sequence);
        let change = |change: &dyn Fn(&mut BoxProof)| {
            let mut proof = proof.clone();
            change(&mut proof);
            holds(proof)
        };
        assert!(!change(&|p| p.portals.reverse()));
        assert!(!change(&|p| p.portals[1] = 99));
        assert!(!change(&|p| p.nodes.clear()));
        for block in 0..2 {
            assert!(!change(&|p| p.blocks[block].edges[0] = p.blocks[block].edges[0].map(|x| 0.5 * x)));
            assert!(!change(&|p| p.blocks[block].corner[2] += 1e-3));
            assert!(!change(&|p| p.blocks[block].edges.swap(0, 1)));
            assert!(!change(&|p| p.blocks[block].edges[1][0] = f64::NAN));
            blocks += 1;
        }
        for (k, node) in proof.nodes.iter().enumerate() {
            match node {
                ConvexNode::Leaf(rows) => {
                    assert!(!change(&|p| p.nodes[k] = ConvexNode::Leaf(Vec::new())));
                    for i in 0..rows.len() {
                        let edit = |edit: &dyn Fn(&mut Vec<sightlines_sightline::ConvexTerm>)| {
                            change(&|p| {
                                let ConvexNode::Leaf(rows) = &mut p.nodes[k] else { unreachable!() };
                                edit(rows);
                            })
                        };
                        assert!(!edit(&|rows| rows[i].multiplier *= -1.0));
                        assert!(!edit(&|rows| rows[i].multiplier = f64::INFINITY));
                        assert!(!edit(&|rows| rows[i].edge = 99));
                        // These may leave a proof, since what was found is not the shortest; mostly not.
                        refused += usize::from(!edit(&|rows| rows[i].multiplier *= 1e6));
                        refused += usize::from(!edit(&|rows| {
                            rows.remove(i);
                        }));
                        terms += 1;
                    }
                }
                &ConvexNode::Split { axis, parts, .. } => {
                    assert!(!change(&|p| p.nodes[k] = ConvexNode::Split { axis, at: 1.0, parts }));
                    assert!(!change(&|p| p.nodes[k] = ConvexNode::Split { axis, at: 0.5, parts: [parts[0]; 2] }));
                    assert!(!change(&|p| p.nodes[k] = ConvexNode::Split { axis, at: 0.5, parts: [0, parts[1]] }));
                    assert!(!change(&|p| p.nodes[k] = ConvexNode::Split { axis: 4, at: 0.5, parts }));
                }
            }
        }
    }
    assert!(terms > 60 && blocks > 60 && refused > terms, "{terms} {blocks} {refused}");
}

/// Impostors: a proof for one sequence proves nothing for a wider one, nor a line for a narrower one, nor a solver that
/// forgets a row or a sign for the sequence that it was given.
#[test]
fn impostors_are_found_out() {
    let mut random = Random::new(5);
    let mut stabber = ConvexStabber::new(StabLimits::default());
    let (mut wider, mut forgotten) = (0, 0);
    for _ in 0..200 {
        let portals = corridor(&mut random, 4, 30.0, 0.0, 0.0);
        let wide: Vec<Portal3> = portals.iter().map(|p| scaled(p, 16.0).unwrap()).collect();
        if let (Verdict::Hidden(proof), Verdict::Visible(line)) =
            (stabber.stab(&refs(&portals), None), stabber.stab(&refs(&wide), None))
        {
            assert!(!proof.holds(&refs(&wide)));
            assert!(!portals.iter().all(|p| passes_exactly(&line, p)));
            assert!(!wide.iter().any(|p| passes_exactly(&line.reversed(), p)));
            // Without the portals that the proof names, lines may pass; those do not pass all.
            let named = proof.named();
            let rest: Vec<&Portal3> = (0..4).filter(|i| *i != named[named.len() / 2]).map(|i| &portals[i]).collect();
            if let Verdict::Visible(line) = stabber.stab(&rest, None) {
                assert!(!portals.iter().all(|p| line.passes(p)));
                forgotten += 1;
            }
            wider += 1;
        }
    }
    assert!(wider > 20 && forgotten > 5, "{wider} {forgotten}");
}

/// A square across z, crossed upwards.
fn square(z: f64, x: [f64; 2], y: [f64; 2]) -> Portal3 {
    Portal3::around(&[[x[0], y[0], z], [x[1], y[0], z], [x[1], y[1], z], [x[0], y[1], z]]).unwrap()
}

#[test]
fn a_plane_stops_what_a_line_grazes() {
    // The third square begins where lines through the second square's edge end.
    let portals =
        [square(0.0, [0.0, 1.0], [0.0, 5.0]), square(1.0, [1.0, 2.0], [1.0, 3.0]), square(2.0, [0.0, 1.0], [0.0, 5.0])];
    let sequence = refs(&portals);
    let Verdict::Hidden(proof) = stab(&portals) else { panic!("only lines on x = 1 are left") };
    assert!(proof.holds(&sequence));
    let plane = PlaneProof { edge: (1, 3), corner: (0, 1), stops: [0, 1, 2] };
    assert!(ConvexCertificate::Plane(plane).holds(&sequence), "{portals:?}");
    for damaged in [
        PlaneProof { stops: [0, 2, 1], ..plane },
        PlaneProof { stops: [0, 1, 3], ..plane },
        PlaneProof { stops: [0, 1, 1], ..plane },
        PlaneProof { edge: (1, 0), ..plane },
        PlaneProof { edge: (1, 9), ..plane },
        PlaneProof { corner: (0, 0), ..plane },
        // An edge's own end fixes no plane.
        PlaneProof { corner: (1, 3), ..plane },
    ] {
        assert!(!ConvexCertificate::Plane(damaged).holds(&sequence), "{damaged:?}");
    }
    // A hair wider, and there is a line.
    let next = 1.0 + 1e-9;
    let open = [portals[0].clone(), portals[1].clone(), square(2.0, [0.0, next], [0.0, 5.0])];
    assert!(matches!(stab(&open), Verdict::Visible(_)));
    assert!(!proof.holds(&refs(&open)));
}

fn stab(portals: &[Portal3]) -> ConvexVerdict {
    ConvexStabber::new(StabLimits::default()).stab(&refs(portals), None)
}

#[test]
fn short_and_strange_sequences() {
    assert_eq!(stab(&[]), Verdict::Undecided(LimitReached));
    let one = square(0.0, [0.0, 1.0], [0.0, 1.0]);
    assert!(matches!(stab(std::slice::from_ref(&one)), Verdict::Visible(_)));
    // The same opening twice is not hidden, and neither are two that overlap in one plane.
    for other in [one.clone(), square(0.0, [0.5, 2.0], [0.5, 2.0])] {
        assert!(!matches!(stab(&[one.clone(), other]), Verdict::Hidden(_)));
    }
    // There and back again.
    let back = square(1.0, [0.0, 1.0], [0.0, 1.0]).reversed();
    assert!(!matches!(stab(&[one, back]), Verdict::Visible(_)));
}

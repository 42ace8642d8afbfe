//! The methods for axis-aligned doors.

use super::naive::passes;
use crate::stability::method::{Answer, Decide, Kind, method};
use crate::stability::plane::said;
use crate::stability::solvers::{Program, Solver};
use sightlines::geometry::{Aabb, AxialDoor};
use sightlines::sightline::{AxialStabber, Stabber, Verdict, stabbing_line_axial};
use sightlines_testkit::lp::{LpAnswer, stab_axial};

/// A sequence of doors.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialDoors(pub Vec<AxialDoor>);

/// All methods with what they answer.
pub fn methods() -> Vec<Decide<AxialDoors>> {
    vec![
        method("axial", Kind::Shipped, |d: &AxialDoors| axial(&d.0)),
        method("axial proven", Kind::Shipped, |d| proven(&d.0)),
        method("axial lp checked", Kind::Reference, |d| match stab_axial(&d.0) {
            LpAnswer::Failed => Answer::Failed,
            // Unclear hides nothing.
            _ => Answer::Seen,
        }),
        method("axial lp good_lp", Kind::Solver, |d| programs(&d.0, false, Solver::GoodLp)),
        method("axial lp good_lp unit", Kind::Solver, |d| programs(&d.0, true, Solver::GoodLp)),
        method("axial lp minilp", Kind::Solver, |d| programs(&d.0, false, Solver::Minilp)),
        method("axial lp minilp unit", Kind::Solver, |d| programs(&d.0, true, Solver::Minilp)),
        method("axial lp microlp", Kind::Solver, |d| programs(&d.0, false, Solver::Microlp)),
        method("axial lp microlp unit", Kind::Solver, |d| programs(&d.0, true, Solver::Microlp)),
        method("axial clipping f64", Kind::Naive, |d| said(passes::<f64>(&d.0))),
        method("axial clipping f32", Kind::Naive, |d| said(passes::<f32>(&d.0))),
        method("axial of stored f32", Kind::Naive, |d| axial(&in_singles(&d.0))),
    ]
}

/// The shipped stabber, as a search drives it.
fn axial(doors: &[AxialDoor]) -> Answer {
    let Some((&first, rest)) = doors.split_first() else { return Answer::Seen };
    let mut stabber = AxialStabber::new();
    stabber.start(first);
    said(rest.iter().all(|&door| stabber.push(door).is_some()))
}

/// The shipped question about one sequence, which comes with a witness or a certificate; one that does not hold is no
/// answer.
fn proven(doors: &[AxialDoor]) -> Answer {
    match stabbing_line_axial(doors) {
        Ok(Some(Verdict::Visible(witness))) if doors.iter().all(|door| witness.passes(door)) => Answer::Seen,
        Ok(Some(Verdict::Hidden(certificate))) if certificate.holds(doors) => Answer::Hidden,
        _ => Answer::Failed,
    }
}

/// The programs of all octants of directions, one after the other.
fn programs(doors: &[AxialDoor], unit: bool, solver: Solver) -> Answer {
    let bounds = Aabb::around(doors.iter().flat_map(|d| [d.extent.min, d.extent.max]));
    let octants = (0..8u8).map(|bits| [0, 1, 2].map(|axis| bits >> axis & 1 == 1));
    let possible = octants.filter(|signs| doors.iter().all(|d| signs[usize::from(d.axis)] == d.forward));
    let mut answer = Answer::Hidden;
    for signs in possible {
        match program(doors, unit.then_some(&bounds), signs).has_margin(solver) {
            Answer::Seen => return Answer::Seen,
            Answer::Failed => answer = Answer::Failed,
            Answer::Hidden => {}
        }
    }
    answer
}

/// Three slownesses, three offsets and a margin; coordinates as they are, or moved and scaled into `unit` along each
/// axis.
fn program(doors: &[AxialDoor], unit: Option<&Aabb<3>>, signs: [bool; 3]) -> Program {
    let place = |axis: usize, x: f64| {
        let x = unit.map_or(x, |b| (x - b.min[axis]) / (b.max[axis] - b.min[axis]).max(f64::MIN_POSITIVE));
        if signs[axis] { x } else { -x }
    };
    // The time at `x` of axis `i` less the time at `y` of axis `j`, less the margin.
    let later = |(i, x): (usize, f64), (j, y): (usize, f64)| {
        let mut row = vec![0.0; 7];
        (row[i], row[3 + i], row[j], row[3 + j], row[6]) = (place(i, x), -1.0, -place(j, y), 1.0, -1.0);
        row
    };
    let positive = (0..3).map(|k| {
        (0..7)
            .map(|c| {
                if c == k {
                    1.0
                } else if c == 6 {
                    -1.0
                } else {
                    0.0
                }
            })
            .collect()
    });
    let mut rows: Vec<Vec<f64>> = positive.collect();
    for door in doors {
        let axis = usize::from(door.axis);
        for other in (0..3).filter(|&other| other != axis) {
            let [low, high] = [door.extent.min[other], door.extent.max[other]];
            let [first, last] = if signs[other] { [low, high] } else { [high, low] };
            rows.push(later((axis, door.at()), (other, first)));
            rows.push(later((other, last), (axis, door.at())));
        }
    }
    let free = [f64::NEG_INFINITY, f64::INFINITY];
    let one = [0.0, 1.0];
    Program { bounds: vec![one, one, one, free, free, free, one], rows }
}

/// The doors as single precision stores them.
fn in_singles(doors: &[AxialDoor]) -> Vec<AxialDoor> {
    let single = |p: [f64; 3]| p.map(|x| f64::from(x as f32));
    let extent = |b: &Aabb<3>| Aabb { min: single(b.min), max: single(b.max) };
    doors.iter().map(|d| AxialDoor { extent: extent(&d.extent), ..*d }).collect()
}

//! The methods for doors in the plane.

use super::naive::{Coefficients, Doubles, Epsilon, Singles, passes};
use crate::stability::method::{Answer, Decide, Kind, method};
use crate::stability::solvers::{Program, Solver};
use sightlines::geometry::{Aabb, Adaptive, Point2, Portal2};
use sightlines::sightline::{Funnel, Verdict, stabbing_line};
use sightlines_testkit::lp::{LpAnswer, stab};

/// A sequence of doors.
#[derive(Debug, Clone, PartialEq)]
pub struct Doors(pub Vec<Portal2>);

/// All methods with what they answer.
pub fn methods() -> Vec<Decide<Doors>> {
    vec![
        method("funnel", Kind::Shipped, |d: &Doors| funnel(&d.0)),
        method("funnel proven", Kind::Shipped, |d| proven(&d.0)),
        method("lp checked", Kind::Reference, |d| match stab(&d.0) {
            LpAnswer::Failed => Answer::Failed,
            // Unclear hides nothing.
            _ => Answer::Seen,
        }),
        method("lp good_lp", Kind::Solver, |d| program(&d.0).has_margin(Solver::GoodLp)),
        method("lp good_lp unit", Kind::Solver, |d| program(&in_unit_box(&d.0)).has_margin(Solver::GoodLp)),
        method("lp minilp", Kind::Solver, |d| program(&d.0).has_margin(Solver::Minilp)),
        method("lp minilp unit", Kind::Solver, |d| program(&in_unit_box(&d.0)).has_margin(Solver::Minilp)),
        method("lp microlp", Kind::Solver, |d| program(&d.0).has_margin(Solver::Microlp)),
        method("lp microlp unit", Kind::Solver, |d| program(&in_unit_box(&d.0)).has_margin(Solver::Microlp)),
        method("funnel f64", Kind::Naive, |d| said(passes(&Doubles, &d.0))),
        method("funnel f64 coefficients", Kind::Naive, |d| said(passes(&Coefficients, &d.0))),
        method("funnel f32", Kind::Naive, |d| said(passes(&Singles, &d.0))),
        method("funnel f64 strict 1e-9", Kind::Naive, |d| said(passes(&Epsilon { lenient: false }, &d.0))),
        method("funnel f64 lenient 1e-9", Kind::Naive, |d| said(passes(&Epsilon { lenient: true }, &d.0))),
        method("funnel of stored f32", Kind::Naive, |d| funnel(&in_singles(&d.0))),
    ]
}

/// Seen if a line passes.
pub const fn said(passes: bool) -> Answer {
    if passes { Answer::Seen } else { Answer::Hidden }
}

/// The shipped funnel, as a search drives it.
pub(super) fn funnel(doors: &[Portal2]) -> Answer {
    let mut funnel = Funnel::new(Adaptive);
    let Some((first, rest)) = doors.split_first() else { return Answer::Seen };
    funnel.start(*first);
    said(rest.iter().all(|door| funnel.push(*door).is_some()))
}

/// The shipped question about one sequence, which comes with a witness or a certificate; one that does not hold is no
/// answer.
fn proven(doors: &[Portal2]) -> Answer {
    match stabbing_line(doors) {
        Ok(Some(Verdict::Visible(witness))) if doors.iter().all(|&door| witness.passes(door)) => Answer::Seen,
        Ok(Some(Verdict::Hidden(certificate))) if certificate.holds(doors) => Answer::Hidden,
        _ => Answer::Failed,
    }
}

/// The program of the literature: a line `a x + b y + c` with every left end on its left and every right end on its
/// right by a margin.
fn program(doors: &[Portal2]) -> Program {
    let free = [f64::NEG_INFINITY, f64::INFINITY];
    let row = |p: Point2, sign: f64| vec![sign * p.x, sign * p.y, sign, -1.0];
    Program {
        bounds: vec![[-1.0, 1.0], [-1.0, 1.0], free, [0.0, 1.0]],
        rows: doors.iter().flat_map(|d| [row(d.left, 1.0), row(d.right, -1.0)]).collect(),
    }
}

/// The doors moved and scaled into the unit box, rounded.
fn in_unit_box(doors: &[Portal2]) -> Vec<Portal2> {
    let bounds = Aabb::around(doors.iter().flat_map(|d| [[d.left.x, d.left.y], [d.right.x, d.right.y]]));
    let size = (bounds.max[0] - bounds.min[0]).max(bounds.max[1] - bounds.min[1]);
    let unit = |p: Point2| Point2::new((p.x - bounds.min[0]) / size, (p.y - bounds.min[1]) / size);
    doors.iter().map(|d| Portal2 { left: unit(d.left), right: unit(d.right) }).collect()
}

/// The doors as single precision stores them.
fn in_singles(doors: &[Portal2]) -> Vec<Portal2> {
    let single = |p: Point2| Point2::new(f64::from(p.x as f32), f64::from(p.y as f32));
    doors.iter().map(|d| Portal2 { left: single(d.left), right: single(d.right) }).collect()
}

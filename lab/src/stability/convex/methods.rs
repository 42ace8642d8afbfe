//! The methods for convex portals.

use super::{edges, separators};
use crate::stability::method::{Answer, Decide, Kind, method};
use crate::stability::plane::said;
use sightlines::geometry::Portal3;
use sightlines::sightline::{ConvexStabber, StabLimits, Verdict};

/// A sequence of portals.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvexPortals(pub Vec<Portal3>);

/// What methods of all sequences answer; `short` adds those whose cost grows with the fifth power of the edges.
pub fn methods(short: bool) -> Vec<Decide<ConvexPortals>> {
    let mut methods: Vec<Decide<ConvexPortals>> = vec![
        method("convex", Kind::Shipped, |p| convex(&p.0)),
        method("separators 0.1", Kind::Naive, |p| said(separators::passes::<f64>(&p.0, 0.1))),
        method("separators 0.001", Kind::Naive, |p| said(separators::passes::<f64>(&p.0, 0.001))),
        method("separators f64", Kind::Naive, |p| said(separators::passes::<f64>(&p.0, 0.0))),
        method("separators f32", Kind::Naive, |p| said(separators::passes::<f32>(&p.0, 0.0))),
        method("convex of stored f32", Kind::Naive, |p| convex(&in_singles(&p.0))),
    ];
    if short {
        methods.push(method("edges f64", Kind::Naive, |p| said(edges::passes::<f64>(&p.0))));
        methods.push(method("edges f32", Kind::Naive, |p| said(edges::passes::<f32>(&p.0))));
    }
    methods
}

/// The shipped stabber with its default limits. What it leaves undecided is seen; a line or a proof that does not hold
/// is no answer.
fn convex(portals: &[Portal3]) -> Answer {
    let portals: Vec<&Portal3> = portals.iter().collect();
    match ConvexStabber::new(StabLimits::default()).stab(&portals, None) {
        Verdict::Visible(line) if portals.iter().all(|portal| line.passes(portal)) => Answer::Seen,
        Verdict::Hidden(proof) if proof.holds(&portals) => Answer::Hidden,
        Verdict::Undecided(_) => Answer::Seen,
        _ => Answer::Failed,
    }
}

/// The portals as single precision stores them; one that has no area then stays as it was.
fn in_singles(portals: &[Portal3]) -> Vec<Portal3> {
    let single = |portal: &Portal3| {
        let corners = portal.corners().iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
        Portal3::of_corners(corners).unwrap_or_else(|| portal.clone())
    };
    portals.iter().map(single).collect()
}

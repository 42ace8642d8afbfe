//! Lines through doors in the plane: exact, incremental, proven.

mod certificate;
pub mod funnel;
mod witness;

pub use certificate::{End, PlanarCertificate};
pub use funnel::{Funnel, FunnelUndo};
pub use witness::PlanarWitness;

use crate::{SightlineError, Verdict};
use sightlines_geometry::{Adaptive, Portal2, check_coordinate};

/// The answer for one sequence of doors in the plane. It is exact.
pub type PlanarVerdict = Verdict<PlanarWitness, PlanarCertificate>;

/// Finds a directed line that passes through every portal of `portals`, in order.
///
/// The line keeps each portal's left end strictly on its left and its right end strictly on its right.
///
/// * `portals`: doors in one common frame, scene units, in the order in which a line meets them when
///   it goes through a chain of convex cells.
/// * Returns a witness line, or a certificate that no such line exists; `None` for no portals at all,
///   which every line passes.
///
/// Exact; O(n) for the decision, O(n²) for a certificate.
///
/// # Errors
/// [`SightlineError`] with the portal's index.
///
/// # Source
/// Teller and Séquin, SIGGRAPH 1991, for the question; for the method see [`funnel`].
pub fn stabbing_line(portals: &[Portal2]) -> Result<Option<PlanarVerdict>, SightlineError> {
    for (i, p) in portals.iter().enumerate() {
        if [p.left.x, p.left.y, p.right.x, p.right.y].into_iter().any(|x| check_coordinate(x).is_err()) {
            return Err(SightlineError::NotFinite(i));
        }
        if p.left == p.right {
            return Err(SightlineError::ZeroLength(i));
        }
    }
    Ok(decide(portals))
}

/// The verdict about portals with usable coordinates; `None` if there are none.
fn decide(portals: &[Portal2]) -> Option<PlanarVerdict> {
    let (first, rest) = portals.split_first()?;
    let mut funnel = Funnel::new(Adaptive);
    funnel.start(*first);
    if rest.iter().all(|p| funnel.push(*p).is_some()) {
        let witness = funnel.witness();
        if portals.iter().all(|&p| witness.passes(p)) {
            return Some(Verdict::Visible(witness));
        }
    }
    // The funnel relies on the order of portals. A sequence that comes from no chain of cells may violate it, so
    // "blocked" is returned only with a certificate.
    let separating = || PlanarWitness::separating(portals).expect("hulls that do not meet are separated by a line");
    Some(PlanarCertificate::find(portals).map_or_else(|| Verdict::Visible(separating()), Verdict::Hidden))
}

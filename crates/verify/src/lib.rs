#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: the checks of a table ([`verify`]) against the real geometry ([`Truth`]), and their results
//!   ([`Findings`]) as [`Violation`]s with the segment that shows them; the comparison of a table with its proofs
//!   ([`check_proofs`]), and of its walls with the scene ([`check_walls_of_plan`], [`check_walls_in_space`]); the visibility that a
//!   map has of its own, as a table to check ([`OwnVisibility`]); with the feature `serde`, all of it as a report for people and programs (`report`).
//! - **Out of scope**: how tables are made (no code is shared with cutting, searching or baking), pictures.
//! - **Invariants**: a violation that names a segment is proven, by exact signs or by margins that are wider than
//!   the uncertainty of the scene; so a correct table has none. The same table, scene and options give the same findings, with any
//!   number of threads. Rays that find nothing prove nothing.
//!
//! It has its own exact arithmetic on purpose and does not use `sightlines-exact`: what checks results must not share
//! the errors of what makes them.

#[cfg(feature = "serde")]
mod as_json;
mod borders;
mod counts;
pub mod exact;
mod findings;
mod framed;
mod map;
mod options;
mod oracle;
mod own;
mod parts;
mod proofs;
mod rays;
#[cfg(feature = "serde")]
pub mod report;
mod shapes;
mod sight;
mod structure;
mod truth;
mod walls;
mod witness;

pub use counts::{Confirmed, Remarks, Sampled};
pub use findings::{Findings, Geometry, Violation};
pub use framed::along_frame;
pub use options::VerifyOptions;
pub use own::{LumpKind, OwnError, OwnSummary, OwnViolation, OwnVisibility};
pub use proofs::{
    ProofError, ProofFindings, ProofViolation, boxes_of, can_be_proven, check_proofs, convex_of, plan_of,
};
pub use sight::{SightSegment, Target};
pub use truth::{MapChild, MapFace, MapNode, MapTree, Truth, VerifyError};
pub use walls::{WallFindings, check_walls_in_space, check_walls_of_plan};
pub use witness::sight_between;

use parts::InParts;
use sightlines_pvs::Table;

/// Checks a table against what is really there.
///
/// A table with [parts of objects](sightlines_pvs::ObjectParts) is checked by its parts: each is looked at as if it were an object.
///
/// First whether the scene is still what the table was made of, by the table's [digest](sightlines_pvs::GeometryDigest) if it has one; then its structure, then random rays, then rays aimed at what the table hides, most suspicious first. Lists the
/// first [`VerifyOptions::MOST_VIOLATIONS`] violations of each kind, and stops shooting rays once there are that many.
///
/// A table with a frame is checked along its axes, against the scene as [`along_frame`] moves it: that every corner is within the gap that the
/// table states is checked exactly, and the rays are shot in the moved scene. As many are shot in the scene as the file has it: what these alone
/// reach is counted apart, as [`Remarks::cracks`]. Places in the findings are along the axes of the table.
///
/// # Errors
/// [`VerifyError`] for a table that cannot be of such a scene, because it is of another dimension or another kind; or if the observer
/// cancels.
///
/// Cost: O(size of table and scene * log) for the structure; each ray visits what is near it.
pub fn verify(table: &Table, truth: &Truth<'_>, options: &VerifyOptions<'_>) -> Result<Findings, VerifyError> {
    truth.check_kind(table)?;
    let mut findings = check(table, truth, options)?;
    structure::door_boxes(table, truth, &mut findings);
    findings.add_first(structure::changes(table, truth));
    Ok(findings)
}

/// Checks all but the digests.
fn check(table: &Table, truth: &Truth<'_>, options: &VerifyOptions<'_>) -> Result<Findings, VerifyError> {
    if let Truth::Scene(scene) = truth
        && let Some(&frame) = table.frame()
        && let Some((table, along)) = along_frame(table, scene)?
    {
        let mut findings = check(&table, &Truth::Scene(&along), options)?;
        framed::add_remarks(&table, [scene, &along], &frame, options, &mut findings)?;
        return Ok(findings);
    }
    let mut findings = structure::check(table, truth);
    let in_parts = match truth {
        Truth::Scene(scene) => InParts::of(table, scene, options.left_out, &mut findings),
        _ => None,
    };
    let n = findings.violations.len();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(options.threads).build().expect("threads can be started");
    let shoot = |table: &Table, truth: &Truth<'_>, findings: &mut Findings| {
        pool.install(|| rays::check(table, truth, true, options, findings))
    };
    match in_parts {
        Some(all) => {
            shoot(&all.table, &Truth::Scene(&all.scene), &mut findings)?;
            all.rename(&mut findings, n);
        }
        None => shoot(table, truth, &mut findings)?,
    }
    Ok(findings)
}

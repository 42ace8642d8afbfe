#![doc = include_str!("../README.md")]
//!
//! # Scope
//!
//! - **Owns**: brute-force answers in exact integer arithmetic ([`stabbable_brute_force`],
//!   [`axial_stabbable_brute_force`], [`sees_brute_force`], [`sector_visibility_brute_force`], [`eye_fan`]), what a
//!   point among boxes sees ([`directions_among_boxes`]), sampled lower bounds (from a volume: [`sampled_view`]), what is known of worlds of convex
//!   cells ([`convex`]), stabbing lines as linear programs ([`lp`]), pages in a browser ([`browser`]), contracts as code ([`conformance`]), work by units with kept results ([`units`]), and strategies that draw from small grids.
//! - **Out of scope**: the code under test; an oracle that shares a method with it proves nothing. Of the stabber that a suite
//!   compares with, only evidence counts, which is evaluated.
//! - **Invariants**: slow on purpose; every answer in the plane is exact for every finite coordinate; rays in
//!   space are traced in doubles, and what is sampled with them stands clear of rounding.
//!
//! It has its own exact arithmetic on purpose and does not use `sightlines-exact`: what checks results must not share
//! the errors of what makes them.

pub mod axial;
pub mod browser;
mod bvh;
mod candidates;
pub mod conformance;
pub mod convex;
pub mod corridor;
mod exact;
pub mod eye;
pub mod eye_boxes;
pub mod from_region;
pub mod fronts;
pub mod lp;
pub mod meshes;
pub mod mutate;
pub mod plans;
mod ray_witness;
pub mod rays;
pub mod sampled;
pub mod sector_plans;
pub mod sectors;
pub mod sees;
mod siblings;
pub mod stab;
pub mod units;

pub use axial::{
    AXIS_ORDERS, any_axial_doors, axial_corridor, axial_meets_brute_force, axial_moved, axial_stabbable_brute_force,
    straight_axial_corridor,
};
pub use corridor::{PortalPair, any_portals, as_portals, corridor, kd_corridor, strip_corridor};
pub use eye::{EyeFan, EyeSector, EyeTouch, eye_fan};
pub use eye_boxes::{BoxHit, directions_among_boxes, first_box, range_in_box};
pub use from_region::{ClearSegment, SampledView, sampled_view};
pub use plans::{axial_plan, convex_polygon, small_grid_plan};
pub use ray_witness::{CellIndex, ClearLine, Random};
pub use rays::{Hit, RayScene};
pub use sampled::{Chord, chord_is_clear, clear_chords, sampled_sector_visibility};
pub use sector_plans::{Sectors, small_sector_plan, small_sectors};
pub use sectors::sector_visibility_brute_force;
pub use sees::sees_brute_force;
pub use siblings::siblings;
pub use stab::{Stab, stabbable_brute_force};

use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::TestRunner;

/// `n` values of a strategy, always the same ones: for impostor tests, which count failures.
///
/// # Panics
/// If the strategy rejects too much.
pub fn draw<S: Strategy>(strategy: &S, n: usize) -> Vec<S::Value> {
    let mut runner = TestRunner::deterministic();
    let mut one = || strategy.new_tree(&mut runner).expect("the strategy rejects little").current();
    (0..n).map(|_| one()).collect()
}

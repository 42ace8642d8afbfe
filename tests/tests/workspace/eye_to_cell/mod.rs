//! What a viewer sees, by five methods, against rays that know no cells' answers: nothing that a ray meets is missing,
//! each method is within the one before, and the exact one shows little or nothing else.

mod ask;
mod boxes;
mod convex;
mod doors;
mod impostors;
mod mirrors;
mod mirrors_in_space;
mod nonsense;
mod picture;
mod plan_families;
mod plans;
mod regions;
mod scenes;

//! What of a table no proof speaks of.

use crate::{ProofFindings, can_be_proven};
#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use sightlines_progress::words::count;
use sightlines_pvs::Table;
use std::fmt;

/// Pairs without a proof. Nothing is known to be wrong with them. What from-region methods hide has a proof only if walls between cells hide it as
/// well.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct Unproven {
    /// Unordered pairs of different cells that the table hides.
    n_hidden: u64,
    /// Of the hidden pairs of cells, those that a line through portals joins: only a from-region method hides them.
    n_hidden_past_portals: u64,
    /// Unordered pairs of different cells that the table shows.
    n_visible: u64,
    /// Pairs of a cell and an object that the table hides.
    n_hidden_objects: u64,
    /// Whether there can be proofs at all.
    #[serde(skip)]
    has_proofs: bool,
}

impl Unproven {
    /// Counts, after the proofs were checked.
    pub fn new(table: &Table, found: &ProofFindings) -> Self {
        Self {
            n_hidden: found.n_unproven_hidden,
            n_hidden_past_portals: found.n_hidden_past_portals,
            n_visible: found.n_unproven_visible,
            n_hidden_objects: found.n_unproven_hidden_objects,
            has_proofs: can_be_proven(table),
        }
    }

    /// Of a table that can have no proofs.
    pub fn without_proofs(table: &Table) -> Option<Self> {
        (!can_be_proven(table)).then(|| Self::new(table, &ProofFindings::without_proofs(table)))
    }

    /// Whether all that is hidden, cells and objects, is proven to be.
    pub fn hides_none(&self) -> bool {
        self.n_hidden + self.n_hidden_objects == 0
    }
}

impl fmt::Display for Unproven {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { n_hidden, n_hidden_past_portals, n_visible, n_hidden_objects, has_proofs } = *self;
        let all = if has_proofs { "" } else { "all " };
        let [hidden, visible] =
            [(n_hidden, "hidden pair"), (n_visible, "visible pair")].map(|(n, what)| count(n, what));
        writeln!(f, "unproven       {all}{hidden} and {visible} of cells")?;
        if n_hidden_past_portals > 0 {
            writeln!(
                f,
                "               {n_hidden_past_portals} of the hidden ones are joined through portals: a from-region method hides them"
            )?;
        }
        if n_hidden_objects > 0 {
            writeln!(f, "               {} of a cell and an object", count(n_hidden_objects, "hidden pair"))?;
        }
        Ok(())
    }
}

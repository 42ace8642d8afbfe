//! An explanation of a pair of cells: the pair, what the table lists, and the answer. [`text`](super::text) writes it for people.

use crate::command::{Done, JsonArg};
use crate::output::{JsonSchema, Serialize};
use crate::place::Place;
use sightlines::bake::explain::Explanation;
use sightlines::bake::explain::json::Explained;
use sightlines::bake::stated_methods;
use sightlines::pvs::{CellId, Table, TableKind};
use std::fmt;

/// An explanation of a pair of cells.
#[derive(Debug)]
pub(super) struct Report<'a> {
    pub(super) pair: [CellId; 2],
    /// What the table lists for the pair; null without a table.
    pub(super) listed: Option<bool>,
    /// What may hide pairs of the table that portals let through, if anything.
    pub(super) past_portals: Option<&'static str>,
    pub(super) explanation: &'a Explanation,
    /// How many proofs are shown to people.
    pub(super) n_shown: usize,
}

impl<'a> Report<'a> {
    pub(super) fn new(table: Option<&Table>, pair: [CellId; 2], explanation: &'a Explanation, n_shown: usize) -> Self {
        let listed = table.map(|table| table.sees(pair[0], pair[1]));
        let past_portals = table.and_then(past_portals);
        Self { pair, listed, past_portals, explanation, n_shown }
    }

    /// The end of the command with this report. The answer is that of the engine, else that of the table, and yes without one.
    pub(super) fn done(&self, json: JsonArg) -> Done {
        let verdict = self.explanation.answer.verdict();
        let is_hidden_past = self.past_portals.is_some() && verdict == Some(true) && self.listed == Some(false);
        let is_visible = verdict.filter(|_| !is_hidden_past).or(self.listed).unwrap_or(true);
        Done::in_two_forms(json, || Explained::new(self.explanation, self.pair, self.listed), || self.to_string())
            .answering_whether(is_visible)
    }
}

/// What may hide pairs of a table that portals let through.
fn past_portals(table: &Table) -> Option<&'static str> {
    let stated = stated_methods(table).filter(|_| matches!(table.kind(), TableKind::SceneKdTree { .. }))?;
    match (stated.from_region.is_some(), stated.has_one_sided_walls) {
        (true, false) => Some("a from-region method found walls that are no borders of cells in the way"),
        (false, true) => Some("only walls that hide from one side can be in the way, which portals do not tell of"),
        (true, true) => Some(
            "only walls that are no borders of cells, which a from-region method found, or walls that hide from one side can be in the way",
        ),
        (false, false) => None,
    }
}

/// Exit code 1.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct Outside {
    /// `outside`.
    answer: &'static str,
    /// The place, in words.
    place: String,
}

impl Outside {
    pub(super) fn new(place: &Place) -> Self {
        Self { answer: "outside", place: place.to_string() }
    }
}

impl fmt::Display for Outside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "the {} is outside every cell", self.place)
    }
}

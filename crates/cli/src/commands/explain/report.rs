//! An explanation of a pair of cells: the pair, what the table lists, and the answer. [`text`](super::text) writes it for people.

use crate::command::{Done, JsonArg};
use crate::output::{JsonSchema, Serialize};
use crate::place::Place;
use sightlines::bake::explain::Explanation;
use sightlines::bake::explain::json::Explained;
use sightlines::pvs::{CellId, Table, TableKind};
use std::fmt;

/// An explanation of a pair of cells.
#[derive(Debug)]
pub(super) struct Report<'a> {
    pub(super) pair: [CellId; 2],
    /// What the table lists for the pair; null without a table.
    pub(super) listed: Option<bool>,
    /// Whether a from-region method took part: it may hide what portals let through.
    pub(super) has_regions: bool,
    pub(super) explanation: &'a Explanation,
    /// How many proofs are shown to people.
    pub(super) n_shown: usize,
}

impl<'a> Report<'a> {
    pub(super) fn new(table: Option<&Table>, pair: [CellId; 2], explanation: &'a Explanation, n_shown: usize) -> Self {
        let listed = table.map(|table| table.sees(pair[0], pair[1]));
        let kind = table.map(Table::kind);
        let has_regions = matches!(kind, Some(TableKind::SceneKdTree { hidden_by }) if hidden_by.from_region);
        Self { pair, listed, has_regions, explanation, n_shown }
    }

    /// The end of the command with this report. The answer is that of the engine, else that of the table, and yes without one.
    pub(super) fn done(&self, json: JsonArg) -> Done {
        let verdict = self.explanation.answer.verdict();
        // A table may hide what portals let through, past walls that are no borders of cells.
        let is_hidden_by_region = self.has_regions && verdict == Some(true) && self.listed == Some(false);
        let is_visible = verdict.filter(|_| !is_hidden_by_region).or(self.listed).unwrap_or(true);
        Done::in_two_forms(json, || Explained::new(self.explanation, self.pair, self.listed), || self.to_string())
            .answering_whether(is_visible)
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

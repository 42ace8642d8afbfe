//! The shape of every explanation, for people and for programs: the pair, what the table lists, and the reason.

use crate::Answer;
use crate::error::OutputError;
use crate::output;
use crate::place::Place;
use serde::Serialize;
use std::fmt;

/// What an engine found about a pair of cells.
pub(super) trait Reason: Serialize {
    /// The verdict of the table on a pair that it lists as visible though the engine did not decide it.
    const UNDECIDED_BUT_LISTED: &'static str = "the table says that they see each other";

    /// Whether they see each other; `None` if that was not decided.
    fn verdict(&self) -> Option<bool>;

    /// Writes the reason in words. `n_shown` of the proofs are listed, the rest are counted.
    fn write(&self, f: &mut fmt::Formatter<'_>, pair: [u32; 2], n_shown: usize) -> fmt::Result;
}

/// An explanation of a pair of cells, by whichever engine.
#[derive(Debug, Serialize)]
pub(super) struct ExplanationReport<R> {
    pub(super) from: u32,
    pub(super) to: u32,
    /// What the table lists for the pair; null without a table.
    pub(super) listed: Option<bool>,
    /// Whether a from-region method took part: it may hide what portals let through.
    #[serde(skip)]
    pub(super) has_regions: bool,
    /// Whether an independent checker accepts the reason; left out where there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) checked: Option<bool>,
    #[serde(flatten)]
    pub(super) reason: R,
    /// How many proofs are shown to people; programs get them all.
    #[serde(skip)]
    pub(super) n_shown: usize,
}

impl<R: Reason> ExplanationReport<R> {
    /// Prints the report. The answer is that of the engine, else that of the table, and yes without one.
    pub(super) fn print(&self, json: bool) -> Result<Answer, OutputError> {
        output::print(json, self)?;
        let verdict = self.reason.verdict().filter(|_| !self.is_hidden_by_region());
        let is_visible = verdict.or(self.listed).unwrap_or(true);
        Ok(if is_visible { Answer::Yes } else { Answer::No })
    }

    /// Whether the table hides what portals let through, past walls that are no borders of cells.
    fn is_hidden_by_region(&self) -> bool {
        self.has_regions && self.reason.verdict() == Some(true) && self.listed == Some(false)
    }
}

impl<R: Reason> fmt::Display for ExplanationReport<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.reason.write(f, [self.from, self.to], self.n_shown)?;
        let verdict = self.reason.verdict();
        match (verdict, self.listed) {
            (None, Some(true)) => writeln!(f, "{}", R::UNDECIDED_BUT_LISTED)?,
            (None, Some(false)) => writeln!(f, "the table says that they do not see each other")?,
            (Some(false), Some(true)) => writeln!(f, "the table lists them as visible all the same")?,
            (Some(true), Some(false)) if self.has_regions => {
                writeln!(
                    f,
                    "the table hides them: a from-region method found walls that are no borders of cells in the way"
                )?;
            }
            (Some(true), Some(false)) => writeln!(f, "the table says that they do not: it is wrong")?,
            _ => {}
        }
        match self.checked.filter(|_| verdict.is_some()) {
            None => Ok(()),
            Some(true) => writeln!(f, "the independent checker accepts this"),
            Some(false) => writeln!(f, "the independent checker does not accept this"),
        }
    }
}

/// A place that is in no cell.
#[derive(Debug, Serialize)]
pub(super) struct Outside {
    answer: &'static str,
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

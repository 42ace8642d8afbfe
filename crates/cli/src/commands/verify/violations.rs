//! The violations that are reported.

use serde::Serialize;
use sightlines::verify::{Findings, VerifyOptions, Violation};
use std::collections::BTreeMap;

/// A violation.
#[derive(Debug, Clone, Serialize)]
pub(super) struct ReportedViolation {
    pub(super) kind: &'static str,
    cells: Vec<u32>,
    /// What the cells are in the map, of a map's own visibility.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    names: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    object: Option<u32>,
    /// From where to where the ray goes, in scene units.
    #[serde(skip_serializing_if = "Option::is_none")]
    segment: Option<[[f64; 3]; 2]>,
    pub(super) text: String,
}

impl ReportedViolation {
    /// A violation that needs no ray.
    pub(super) fn of_sides(kind: &'static str, names: Vec<String>, text: String) -> Self {
        Self { kind, cells: Vec::new(), names, object: None, segment: None, text }
    }

    /// The same in other words.
    pub(super) fn of(self, names: Vec<String>, text: String) -> Self {
        Self { names, text, ..self }
    }

    /// Whether a segment shows it.
    pub(super) fn has_ray(&self) -> bool {
        self.segment.is_some()
    }
}

/// All reported violations.
#[derive(Debug, Default)]
pub(super) struct Violations {
    pub(super) n: usize,
    /// Whether there may be more.
    pub(super) has_more: bool,
    pub(super) by_kind: BTreeMap<&'static str, usize>,
    pub(super) reported: Vec<ReportedViolation>,
}

impl Violations {
    /// What was found, in other words, and perhaps less often.
    pub(super) fn reported(found: &Findings, reported: Vec<ReportedViolation>) -> Self {
        let mut by_kind = BTreeMap::new();
        reported.iter().for_each(|v| *by_kind.entry(v.kind).or_default() += 1);
        Self { n: reported.len(), has_more: has_more(found), by_kind, reported }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.n == 0
    }
}

impl From<&Findings> for Violations {
    fn from(found: &Findings) -> Self {
        let reported = found.violations.iter().map(ReportedViolation::from).collect();
        Self { n: found.n_violations, has_more: has_more(found), by_kind: found.by_kind.clone(), reported }
    }
}

/// Whether rays found so much that no more were shot.
fn has_more(found: &Findings) -> bool {
    found.by_kind.values().any(|&n| n >= VerifyOptions::MOST_VIOLATIONS)
}

impl From<&Violation> for ReportedViolation {
    fn from(v: &Violation) -> Self {
        let cells = v.cells().into_iter().map(|cell| cell.0).collect();
        Self { kind: v.kind(), cells, names: Vec::new(), object: v.object(), segment: v.segment(), text: v.to_string() }
    }
}

//! The violations that are reported.

use crate::{Findings, OwnViolation, OwnVisibility, VerifyOptions, Violation};
#[cfg(feature = "schemars")]
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// A violation.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct ReportedViolation {
    /// The kind, such as `hidden-cell`.
    pub(super) kind: &'static str,
    /// The cells concerned.
    cells: Vec<u32>,
    /// What the cells are in the map, of a map's own visibility.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    names: Vec<String>,
    /// The object concerned.
    #[serde(skip_serializing_if = "Option::is_none")]
    object: Option<u32>,
    /// Start and end of the ray, three coordinates each.
    #[serde(skip_serializing_if = "Option::is_none")]
    segment: Option<[[f64; 3]; 2]>,
    /// The violation in a sentence.
    pub(super) text: String,
}

/// All reported violations.
#[derive(Debug, Serialize)]
#[cfg_attr(feature = "schemars", derive(JsonSchema))]
pub struct Violations {
    /// Violations found, including those that are not listed.
    pub(super) n_violations: usize,
    /// Whether there were so many that rays were stopped.
    pub(super) has_more_violations: bool,
    /// The same number for each kind.
    pub(super) n_violations_by_kind: BTreeMap<&'static str, usize>,
    /// Violations, a limited number of each kind.
    pub(super) violations: Vec<ReportedViolation>,
}

impl Violations {
    /// What was found of a map's own visibility, in terms of the map.
    pub fn of_own(found: &Findings, own: &OwnVisibility) -> Self {
        let violations: Vec<_> = own.violations(found).into_iter().map(ReportedViolation::from).collect();
        let mut by_kind = BTreeMap::new();
        violations.iter().for_each(|v| *by_kind.entry(v.kind).or_default() += 1);
        Self { n_violations: violations.len(), n_violations_by_kind: by_kind, violations, ..Self::from(found) }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.n_violations == 0
    }
}

impl From<&Findings> for Violations {
    fn from(found: &Findings) -> Self {
        let &Findings { n_violations, ref by_kind, ref violations, .. } = found;
        Self {
            n_violations,
            // Rays found so much that no more were shot.
            has_more_violations: by_kind.values().any(|&n| n >= VerifyOptions::MOST_VIOLATIONS),
            n_violations_by_kind: by_kind.clone(),
            violations: violations.iter().map(ReportedViolation::from).collect(),
        }
    }
}

impl From<&Violation> for ReportedViolation {
    fn from(v: &Violation) -> Self {
        let cells = v.cells().into_iter().map(|cell| cell.0).collect();
        Self { kind: v.kind(), cells, names: Vec::new(), object: v.object(), segment: v.segment(), text: v.to_string() }
    }
}

impl From<OwnViolation> for ReportedViolation {
    fn from(own: OwnViolation) -> Self {
        let OwnViolation { kind, sides: names, violation, text } = own;
        match violation {
            Some(v) => Self { names, text, ..Self::from(&v) },
            None => Self { kind, cells: Vec::new(), names, object: None, segment: None, text },
        }
    }
}

//! Which methods were chosen for an input, and why.

use serde::Serialize;
use sightlines::bake::auto::Choice;
use std::fmt;

/// What was chosen, and why.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Chosen {
    method: String,
    reasons: Vec<String>,
    /// The measured properties of a scene in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    facts: Option<Facts>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Facts {
    n_triangles: usize,
    n_objects: usize,
    axial_share: f64,
    /// Properties that do not matter are not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    loose_share: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    openness: Option<f64>,
    object_size: f64,
}

impl Chosen {
    pub(super) fn new(choice: Choice) -> Self {
        let facts = choice.facts.map(|f| Facts {
            n_triangles: f.n_triangles,
            n_objects: f.n_objects,
            axial_share: f.axial,
            loose_share: f.loose,
            openness: f.openness,
            object_size: f.object_size,
        });
        Self { method: choice.method, reasons: choice.reasons, facts }
    }

    /// The methods, in words.
    pub(super) fn method(&self) -> &str {
        &self.method
    }

    /// The same, and the first reason.
    pub(super) fn brief(&self) -> String {
        let reason = self.reasons.first().map_or(String::new(), |reason| format!(" ({reason})"));
        format!("{}{reason}", self.method)
    }
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "chosen         {}", self.method)?;
        self.reasons.iter().try_for_each(|reason| writeln!(f, "               {reason}"))
    }
}

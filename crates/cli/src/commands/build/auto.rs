//! Which methods were chosen for an input, and why.

use crate::output::{JsonSchema, Serialize};
use sightlines::bake::auto::Choice;
use std::fmt;

/// Choice of a method, and why.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub(super) struct Chosen {
    /// The method that was chosen.
    method: String,
    /// Why, in words.
    reasons: Vec<String>,
    /// The measured properties of a scene in space.
    #[serde(skip_serializing_if = "Option::is_none")]
    facts: Option<Facts>,
}

/// Facts of a scene, where the method was chosen for it.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct Facts {
    /// Triangles.
    n_triangles: usize,
    /// Objects.
    n_objects: usize,
    /// Share of the area that is perpendicular to an axis.
    axial_share: f64,
    /// Share of flat pieces that stand alone, such as screens and signs; measured only where it matters.
    #[serde(skip_serializing_if = "Option::is_none")]
    loose_share: Option<f64>,
    /// Share of rays that leave the scene without meeting anything: 0 for rooms, nearly 1 for a plain; measured only where it matters.
    #[serde(skip_serializing_if = "Option::is_none")]
    openness: Option<f64>,
    /// Size of a typical object as a share of the size of the scene.
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

//! `--method auto`: methods are chosen from properties of the input, and the reasons are printed.

use super::region::RegionArgs;
use crate::input::Input;
use serde::Serialize;
use sightlines::bake::auto::choose;
use std::fmt;

/// What was chosen, and why.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Chosen {
    method: String,
    reasons: Vec<String>,
    /// What a scene in space was measured to be like.
    #[serde(skip_serializing_if = "Option::is_none")]
    facts: Option<Facts>,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Facts {
    n_triangles: usize,
    n_objects: usize,
    axial_share: f64,
    /// What did not matter was not measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    loose_share: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    openness: Option<f64>,
    object_size: f64,
}

impl Chosen {
    /// Chooses for an input; the arguments that this stands for come with it.
    pub(super) fn of(input: &Input, given: &RegionArgs) -> (Self, RegionArgs) {
        let plain = |method: &str, reason: &str| {
            let (method, reasons) = (method.to_owned(), vec![reason.to_owned()]);
            (Self { method, reasons, facts: None }, given.clone())
        };
        match input {
            Input::Scene(file) => {
                let (f, choice) = choose(&file.scene, given.has_boxes());
                let facts = Facts {
                    n_triangles: f.n_triangles,
                    n_objects: f.n_objects,
                    axial_share: f.axial,
                    loose_share: f.loose,
                    openness: f.openness,
                    object_size: f.object_size,
                };
                let region = given.chosen(&choice);
                (Self { method: choice.to_string(), reasons: choice.reasons, facts: Some(facts) }, region)
            }
            Input::Plan(_) => plain(
                "sightlines",
                "a plan is solved in the plane, exactly; its walls' directions and groups say how it is cut",
            ),
            Input::Portals(_) | Input::Map(_) => {
                plain("sightlines", "cells and portals are given, convex and in any direction: beams, then sequences")
            }
        }
    }
}

impl fmt::Display for Chosen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "chosen         {}", self.method)?;
        self.reasons.iter().try_for_each(|reason| writeln!(f, "               {reason}"))
    }
}

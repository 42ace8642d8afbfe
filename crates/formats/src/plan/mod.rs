//! A floor plan as its file gives it: the plan, what was dropped, and what passes through.
//!
//! Drawings repeat lines and have lines without length; neither hides anything that others do not. The readers of plans
//! ([`geojson`](crate::geojson), [`dxf`](crate::dxf)) drop them and count what they dropped. [`Plan`] itself stays strict.

mod lines;

pub(crate) use lines::PlanLines;

use sightlines_cells::Plan;

/// A plan, and what its file states about it.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanFile {
    /// The plan.
    pub plan: Plan,
    /// What was left out of it because it hides nothing.
    pub dropped: DroppedLines,
    /// GeoJSON: the member `crs`, its JSON text as it was. It is never interpreted, and coordinates are never transformed.
    pub crs: Option<String>,
    /// DXF: the names of all layers, in the order of the file.
    pub layers: Vec<String>,
    /// What a user should hear of the file, a sentence each.
    pub warnings: Vec<String>,
}

/// How many lines a reader dropped.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct DroppedLines {
    /// Lines without two different positions. Positions that repeat the one before them in a longer line are not counted.
    pub n_without_length: usize,
    /// Lines with the end points of an earlier one, in either direction, and the same properties.
    pub n_doubled: usize,
}

impl DroppedLines {
    /// A sentence for each kind of which there are any.
    fn warnings(self) -> Vec<String> {
        let number = |n: usize, one: &str, many: &str| match n {
            1 => format!("1 {one}"),
            n => format!("{n} {many}"),
        };
        let kinds = [
            (self.n_without_length, number(self.n_without_length, "line without length", "lines without length")),
            (self.n_doubled, number(self.n_doubled, "line that repeats another", "lines that repeat others")),
        ];
        kinds.into_iter().filter(|(n, _)| *n > 0).map(|(_, text)| format!("dropped {text}")).collect()
    }
}

/// How plans are read. Both options are for DXF; GeoJSON has neither layers nor curves.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanReadOptions {
    /// The layers that are read, even if they are frozen or off. `None`: all that are neither.
    pub layers: Option<Vec<String>>,
    /// How far the straight pieces of a curve may be from it, in units of the drawing, above 0. `None`: [`DEFAULT_DEVIATION`](crate::dxf::DEFAULT_DEVIATION)
    /// of the longer side of the plan.
    pub deviation: Option<f64>,
}

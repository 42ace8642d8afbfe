//! A floor plan as its file gives it: the plan, what was dropped, and what passes through.
//!
//! Drawings repeat lines and have lines without length; neither hides anything that others do not. The readers of plans
//! ([`geojson`](crate::geojson), [`dxf`](crate::dxf)) drop them and count what they dropped. [`Plan`] itself stays strict.

use crate::error::counted;
use sightlines_cells::{LineId, Plan, PlanError, PlanLine, PlanObject};
use sightlines_geometry::Point2;
use std::collections::HashSet;

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
    fn warnings(self) -> Vec<String> {
        let kinds = [
            (self.n_without_length, "line without length", "lines without length"),
            (self.n_doubled, "line that repeats another", "lines that repeat others"),
        ];
        let told = kinds.into_iter().filter(|(n, ..)| *n > 0);
        told.map(|(n, one, many)| format!("dropped {}", counted(n, one, many))).collect()
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

/// A line without its direction: the smaller end first, what is on its left and right exchanged if that turns it.
type Undirected = ([u64; 4], bool, bool, [Option<u32>; 2]);

#[derive(Debug, Default)]
pub(crate) struct PlanLines {
    lines: Vec<PlanLine>,
    mirrors: Vec<LineId>,
    seen: HashSet<Undirected>,
    dropped: DroppedLines,
}

impl PlanLines {
    /// Adds a line with checked coordinates, or counts why it is dropped.
    pub(crate) fn push(&mut self, line: PlanLine, is_mirror: bool) {
        if line.a == line.b {
            self.count_without_length();
        } else if !self.seen.insert(undirected(&line, is_mirror)) {
            self.dropped.n_doubled += 1;
        } else {
            // More lines than ids are refused in the end.
            self.mirrors.extend(u32::try_from(self.lines.len()).ok().filter(|_| is_mirror).map(LineId));
            self.lines.push(line);
        }
    }

    /// Counts a line that has no two different positions.
    pub(crate) fn count_without_length(&mut self) {
        self.dropped.n_without_length += 1;
    }

    pub(crate) fn finish(self, objects: Vec<PlanObject>) -> Result<PlanFile, PlanError> {
        let plan = Plan::new(self.lines, objects)?.with_mirrors(self.mirrors)?;
        let warnings = self.dropped.warnings();
        Ok(PlanFile { plan, dropped: self.dropped, crs: None, layers: Vec::new(), warnings })
    }
}

fn undirected(line: &PlanLine, is_mirror: bool) -> Undirected {
    // Checked coordinates have one zero only, so equal points have equal bits.
    let bits = |a: Point2, b: Point2| [a.x, a.y, b.x, b.y].map(f64::to_bits);
    let &PlanLine { a, b, opaque, left, right } = line;
    match (a.x, a.y) <= (b.x, b.y) {
        true => (bits(a, b), opaque, is_mirror, [left, right]),
        false => (bits(b, a), opaque, is_mirror, [right, left]),
    }
}

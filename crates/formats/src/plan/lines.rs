//! The lines of a plan while it is read.

use super::{DroppedLines, PlanFile};
use sightlines_cells::{LineId, Plan, PlanError, PlanLine, PlanObject};
use sightlines_geometry::Point2;
use std::collections::HashSet;

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

//! What was built, in three lines: what was taken for what, by which method into which cells, and the result. Of a scene a fourth says
//! whether it was worth it.

use super::viewers::Surroundings;
use super::{Built, Outcome, worth};
use crate::output::{bytes, count, percent, seconds_of};
use sightlines::report::ViewerShare;
use std::fmt;

/// The three lines.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Brief {
    /// `scene`, `plan` or `map`.
    pub(super) kind: &'static str,
    /// What was read, and what of it is no wall.
    pub(super) taken: String,
    /// The methods.
    pub(super) method: String,
    /// What they were applied to.
    pub(super) cells: String,
    /// The file that was written.
    pub(super) out: String,
    pub(super) n_bytes: usize,
    /// How much is visible.
    pub(super) visible: String,
    pub(super) seconds: f64,
}

/// What a viewer of a scene has, on average.
pub(super) fn of_viewer(viewer: &ViewerShare) -> String {
    let [polygons, objects, cells] = [viewer.polygons, viewer.objects, viewer.cells].map(percent);
    format!("a viewer has {polygons} of the polygons, {objects} of the objects, {cells} of the cells on average")
}

/// The same as a line of a report.
pub(super) fn write_viewer(f: &mut fmt::Formatter<'_>, viewer: &ViewerShare) -> fmt::Result {
    let [polygons, objects, cells] = [viewer.polygons, viewer.objects, viewer.cells].map(percent);
    writeln!(f, "a viewer has   {polygons} of the polygons on average, {objects} of the objects, {cells} of the cells")
}

/// Cells with a word before, and their portals, if they have any.
pub(super) fn of_cells(n_cells: usize, noun: &str, n_portals: usize) -> String {
    let portals = if n_portals == 0 { String::new() } else { format!(", {}", count(n_portals as u64, "portal")) };
    format!("{}{portals}", count(n_cells as u64, noun))
}

impl Built {
    /// Whether the table of a scene is worth it.
    pub(super) fn worth(&self) -> Option<String> {
        let viewer = match &self.outcome {
            Outcome::Scene(outcome) => &outcome.viewer,
            Outcome::Regions(outcome) => &outcome.viewer,
            _ => return None,
        };
        worth::sentence(viewer, self.is_chosen)
    }

    fn three_lines(&self) -> Brief {
        let mut brief = match &self.outcome {
            Outcome::Plan(outcome) => outcome.brief(),
            Outcome::Scene(outcome) => outcome.brief(),
            Outcome::Regions(outcome) => outcome.brief(),
            Outcome::Portals(outcome) => outcome.brief(),
            Outcome::Map(outcome) => outcome.brief(),
            Outcome::Rows(outcome) => outcome.brief(),
        };
        self.surfaces.iter().flat_map(|surfaces| surfaces.all.brief()).for_each(|kind| {
            brief.taken += ", ";
            brief.taken += &kind;
        });
        if let Some(auto) = &self.auto {
            brief.method = auto.brief();
        }
        brief.cells += &self.placed.brief();
        self.viewers.iter().for_each(|viewers| brief.cells += &viewers.brief());
        brief.cells += &Surroundings(&self.surroundings).brief();
        brief
    }

    /// The three lines, and those about what was asked for besides the table.
    pub(super) fn write_brief(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Brief { kind, taken, method, cells, out, n_bytes, visible, seconds: time } = self.three_lines();
        writeln!(f, "{kind:<14} {taken}")?;
        writeln!(f, "method         {method}; {cells}")?;
        let (size, time) = (bytes(n_bytes as u64), seconds_of(time));
        writeln!(f, "wrote          {out}, {size}, in {time}: {visible}")?;
        if let Some(sentence) = self.worth() {
            writeln!(f, "worth it       {sentence}")?;
        }
        self.given_doors.iter().try_for_each(|door| write!(f, "{door}"))?;
        self.stab.iter().try_for_each(|stab| write!(f, "{stab}"))?;
        self.proofs.iter().try_for_each(|proofs| write!(f, "{proofs}"))
    }
}

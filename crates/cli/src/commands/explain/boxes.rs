//! What can be said about two cells without portals: a ray that joins them, or which methods hid them.

use super::report::Reason;
use crate::output::count;
use serde::Serialize;
use sightlines::bake::{BakeRequest, CellsFrom, Gap, SceneMethod, bake};
use sightlines::cells::Scene;
use sightlines::formats::{ViewCell, ViewCells};
use sightlines::geometry::Aabb;
use sightlines::pvs::{CellId, SceneMethods, Table, TableKind};
use sightlines::verify::{VerifyError, along_frame, sight_between};
use std::fmt;

/// What was found about two cells without portals.
#[derive(Debug, Serialize)]
#[serde(tag = "answer", rename_all = "lowercase")]
pub(super) enum BoxReason {
    /// They are one cell.
    Same,
    Visible {
        /// A segment from inside one to inside the other that nothing touches, along the axes of the table.
        segment: [[f64; 3]; 2],
    },
    /// Neither is proven.
    Unknown {
        /// Rays that were aimed from each cell at the other; none without a scene.
        #[serde(skip_serializing_if = "Option::is_none")]
        n_rays: Option<u32>,
        /// Of a hidden pair: the methods of which at least one hid it.
        #[serde(skip_serializing_if = "Vec::is_empty")]
        hidden_by: Vec<String>,
    },
}

impl BoxReason {
    /// What is known from the table, and from the scene that it was made of, if that is given.
    pub(super) fn find(
        table: &Table,
        scene: Option<&Scene>,
        [a, b]: [CellId; 2],
        n_rays: u32,
    ) -> Result<Self, VerifyError> {
        if a == b {
            return Ok(Self::Same);
        }
        let Some(scene) = scene else {
            return Ok(Self::Unknown { n_rays: None, hidden_by: hidden_by(table, [a, b], None) });
        };
        if let Some(segment) = sight_between(table, scene, [a, b], n_rays)? {
            return Ok(Self::Visible { segment });
        }
        let along = along_frame(table, scene)?;
        let scene = along.as_ref().map_or(scene, |(_, scene)| scene);
        Ok(Self::Unknown { n_rays: Some(n_rays), hidden_by: hidden_by(table, [a, b], Some(scene)) })
    }
}

/// The methods that may have hidden a pair; none if the table shows it. With a scene along the axes of the table, sightlines are asked again.
fn hidden_by(table: &Table, [a, b]: [CellId; 2], scene: Option<&Scene>) -> Vec<String> {
    let (TableKind::SceneGivenCells { hidden_by } | TableKind::SceneKdTree { hidden_by }) = table.kind() else {
        return Vec::new();
    };
    if table.sees(a, b) {
        return Vec::new();
    }
    let SceneMethods { sightlines, from_region, .. } = hidden_by;
    let all = table.info_value("method").unwrap_or_default();
    let of_regions = all.strip_prefix("sightlines+").unwrap_or(all);
    let of_regions = if of_regions.is_empty() { "a from-region method" } else { of_regions }.to_owned();
    let lines = "sightlines".to_owned();
    match (sightlines, from_region) {
        (true, false) => vec![lines],
        (false, true) => vec![of_regions],
        (true, true) => match scene.and_then(|scene| is_hidden_by_sightlines(table, scene, [a, b])) {
            // Both may have; one is enough.
            Some(true) => vec![lines],
            // What the others left visible.
            Some(false) => vec![of_regions],
            None => vec![lines, of_regions],
        },
        (false, false) => Vec::new(),
    }
}

/// Whether sightlines alone hide two cells from each other; none if that cannot be told: they were not finished in time, or cannot
/// cut the scene.
fn is_hidden_by_sightlines(table: &Table, scene: &Scene, pair: [CellId; 2]) -> Option<bool> {
    let cell = |id: CellId| {
        let record = &table.cells()[id.idx()];
        ViewCell { id: id.to_string(), bounds: Aabb { min: record.min, max: record.max } }
    };
    if table.info_value("time-limit").is_some() {
        return None;
    }
    let cells = CellsFrom::Boxes(ViewCells { cells: pair.map(cell).to_vec(), axes: None });
    let detail_below = match table.info_value("detail-below") {
        Some(size) => Some(size.parse().ok()?),
        None => None,
    };
    let request = BakeRequest {
        cells: Some(cells),
        method: Some(SceneMethod::Sightlines),
        gap: Gap::Width(0.0),
        detail_below,
        ..BakeRequest::default()
    };
    let two = bake(scene, &request).ok()?.table;
    Some(!two.sees(CellId(0), CellId(1)))
}

impl Reason for BoxReason {
    const UNDECIDED_BUT_LISTED: &'static str = "the table says that they see each other: no method has hidden them";

    fn verdict(&self) -> Option<bool> {
        match self {
            Self::Same | Self::Visible { .. } => Some(true),
            Self::Unknown { .. } => None,
        }
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, [from, to]: [u32; 2], _: usize) -> fmt::Result {
        match self {
            Self::Same => writeln!(f, "both are in cell {from}, and a cell sees itself"),
            Self::Visible { segment: [[ax, ay, az], [bx, by, bz]] } => writeln!(
                f,
                "cell {from} sees cell {to}: nothing is on the segment from ({ax}, {ay}, {az}) to ({bx}, {by}, {bz})"
            ),
            Self::Unknown { n_rays, hidden_by } => {
                match n_rays {
                    None => writeln!(
                        f,
                        "cell {from} and cell {to}: the cells of this table have no portals; with --scene rays are shot between them"
                    )?,
                    Some(n) => writeln!(
                        f,
                        "cell {from} and cell {to}: {} from each found no line between them, which proves nothing",
                        count(*n, "ray")
                    )?,
                }
                match &hidden_by[..] {
                    [] => Ok(()),
                    [one] => writeln!(f, "hidden by {one}"),
                    some => writeln!(f, "hidden by {}; which one is not recorded", some.join(" or ")),
                }
            }
        }
    }
}

//! Two cells without portals: a ray that joins them, or the methods that may have hidden them.

use super::answer::{Answer, ExactLine, SightLine};
use crate::gap::Gap;
use crate::options::SceneMethod;
use crate::region::CellsFrom;
use crate::request::BakeRequest;
use crate::stated::{StatedMethods, stated_methods};
use sightlines_cells::Scene;
use sightlines_formats::{ViewCell, ViewCells};
use sightlines_geometry::Aabb;
use sightlines_pvs::{CellId, Table};
use sightlines_verify::{VerifyError, along_frame, sight_between};

/// What is known from the table, and from the scene that it was made of, if that is given.
pub(super) fn answer(
    table: &Table,
    scene: Option<&Scene>,
    pair: [CellId; 2],
    n_rays: u32,
) -> Result<Answer, VerifyError> {
    if pair[0] == pair[1] {
        return Ok(Answer::Same);
    }
    let Some(scene) = scene else {
        return Ok(Answer::Unknown { n_rays: None, hidden_by: hidden_by(table, pair, None) });
    };
    if let Some(ends) = sight_between(table, scene, pair, n_rays)? {
        let line = SightLine { cells: pair.to_vec(), portals: Vec::new(), ends: Some(ends) };
        return Ok(Answer::Visible(line, ExactLine::Segment));
    }
    let along = along_frame(table, scene)?;
    let scene = along.as_ref().map_or(scene, |(_, scene)| scene);
    Ok(Answer::Unknown { n_rays: Some(n_rays), hidden_by: hidden_by(table, pair, Some(scene)) })
}

/// The methods that may have hidden a pair; none if the table shows it. With a scene along the axes of the table, sightlines are asked again.
fn hidden_by(table: &Table, pair: [CellId; 2], scene: Option<&Scene>) -> Vec<String> {
    let Some(stated) = stated_methods(table).filter(|_| !table.sees(pair[0], pair[1])) else { return Vec::new() };
    let by_lines = stated.sightlines.then(|| SceneMethod::Sightlines.name().to_owned());
    // Both may have; one is enough.
    let repeated = scene
        .filter(|_| by_lines.is_some() && stated.from_region.is_some())
        .and_then(|scene| is_hidden_by_sightlines(table, &stated, scene, pair));
    match repeated {
        Some(true) => by_lines.into_iter().collect(),
        // What sightlines leave visible.
        Some(false) => stated.from_region.into_iter().collect(),
        None => by_lines.into_iter().chain(stated.from_region).collect(),
    }
}

/// Whether sightlines alone hide two cells from each other; none if that cannot be told: they were not finished in time, or cannot
/// cut the scene.
fn is_hidden_by_sightlines(table: &Table, stated: &StatedMethods, scene: &Scene, pair: [CellId; 2]) -> Option<bool> {
    if !stated.is_repeatable {
        return None;
    }
    let cell = |id: CellId| {
        let record = &table.cells()[id.idx()];
        ViewCell { id: id.to_string(), bounds: Aabb { min: record.min, max: record.max } }
    };
    let request = BakeRequest {
        cells: Some(CellsFrom::Boxes(ViewCells { cells: pair.map(cell).to_vec(), axes: None })),
        method: Some(SceneMethod::Sightlines),
        gap: Gap::Width(0.0),
        detail_below: stated.detail_below,
        ..BakeRequest::default()
    };
    let two = crate::run::bake(scene, &request).ok()?.table;
    Some(!two.sees(CellId(0), CellId(1)))
}

//! The buffer as a picture for people.

use super::outcome::Outcome;
use crate::error::{ErrorAbout, Result};
use sightlines::multifocal::Buffer;
use sightlines::pvs::Axis;
use sightlines::report::{BufferChart, buffer_chart_svg};
use std::path::Path;

const AXES: [char; 3] = ['x', 'y', 'z'];

/// The picture of a buffer, with the axis up that is up in the scene, and as it is seen from the volume.
pub(super) fn svg(path: &Path, outcome: &Outcome, buffer: &Buffer, up: Axis) -> Result<String> {
    let plane = outcome.plane;
    let across = [(plane.axis() + 1) % 3, (plane.axis() + 2) % 3];
    let up = match up {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    };
    let is_first_up = across[0] == up;
    // To the right of who looks along the plane's axis is that axis times up; the axes of the window follow it in turn. So the second is to the
    // right of who looks forwards with the first up, and the first to the left with the second up.
    let is_forwards = plane.at() > outcome.volume.max[plane.axis()];
    let title = format!("Multifocal buffer on the plane {} = {}", AXES[plane.axis()], plane.at());
    let values_are = format!("{}, in scene units", outcome.measure);
    let chart = BufferChart {
        title: &title,
        values_are: &values_are,
        texels: plane.texels(),
        values: buffer.values(),
        white: outcome.white,
        unit: outcome.unit,
        axes: across.map(|k| AXES[k]),
        window: [plane.origin(), plane.end()],
        is_first_up,
        is_mirrored: is_forwards != is_first_up,
    };
    buffer_chart_svg(&chart).in_file(path)
}

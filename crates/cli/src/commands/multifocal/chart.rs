//! The buffer as a picture for people.

use super::outcome::Outcome;
use crate::error::{ErrorAbout, Result};
use sightlines::multifocal::Buffer;
use sightlines::pvs::Axis;
use sightlines::report::{BufferChart, buffer_chart_svg};
use std::path::Path;

const AXES: [char; 3] = ['x', 'y', 'z'];

/// The picture of a buffer, with the axis up that is up in the scene, and as it is seen from the volume.
pub(super) fn svg(path: &Path, outcome: &Outcome, buffer: &Buffer, white: u32, up: Axis) -> Result<String> {
    let &Outcome { axis, at, window, texels, unit, .. } = outcome;
    let across = [(axis + 1) % 3, (axis + 2) % 3];
    let is_first_up = across[0] == up.idx();
    // To the right of who looks along the plane's axis is that axis times up; the axes of the window follow it in turn. So the second is to the
    // right of who looks forwards with the first up, and the first to the left with the second up.
    let is_forwards = at > outcome.volume[1][axis];
    let title = format!("Multifocal buffer on the plane {} = {}", AXES[axis], at);
    let values_are = format!("{}, in scene units", outcome.measure);
    let chart = BufferChart {
        title: &title,
        values_are: &values_are,
        texels,
        values: buffer.values(),
        white,
        unit,
        axes: across.map(|k| AXES[k]),
        window,
        is_first_up,
        is_mirrored: is_forwards != is_first_up,
    };
    buffer_chart_svg(&chart).in_file(path)
}

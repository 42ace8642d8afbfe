//! The definition of multifocal buffers, in exact arithmetic.
//!
//! Every texel is compared with every occluder, by all eight corners of the volume and all four of the texel; see
//! `umbra` for what is blocked, `value` from where on, and `sweep` for what is carried from plane to plane. Values
//! are exact, and rounded once, down to whole units. What other backends store is at most this.

mod distance;
mod grid;
mod sweep;
mod umbra;
mod value;

use sightlines_exact::Grid;
use sightlines_geometry::Point3;
use sightlines_multifocal::{BackendError, Buffer, BufferJob, BufferPlane, Measure, MultifocalBackend};
use umbra::Hiding;
use value::Values;

/// The backend that all others are measured by: plain loops, exact arithmetic, one thread.
///
/// O(texels · occluders · corners) exact predicates, and big integers for each texel that is blocked: some microseconds
/// for each texel and occluder, up to a millisecond for distances. For tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Reference;

impl MultifocalBackend for Reference {
    fn name(&self) -> &'static str {
        "cpu-reference"
    }

    fn supports(&self, _: Measure) -> bool {
        true
    }

    fn render(&mut self, job: &BufferJob<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        let grid = grid::grid_of(job);
        out.resize_with(job.planes().len(), Buffer::default);
        for (idx, plane) in job.planes().iter().enumerate() {
            let (before, rest) = out.split_at_mut(idx);
            draw(job, grid, plane, &mut rest[0]);
            if job.carry()
                && let (Some(buffer), Some(nearer)) = (before.last(), idx.checked_sub(1).map(|i| &job.planes()[i]))
            {
                sweep::carry(job, [nearer, plane], buffer, &mut rest[0]);
            }
        }
        Ok(())
    }
}

/// Fills the buffer of a plane with what each occluder blocks by itself.
fn draw(job: &BufferJob<'_>, grid: Grid, plane: &BufferPlane, out: &mut Buffer) {
    let [w, h] = plane.texels();
    out.reset([w, h]);
    for occluder in job.occluders() {
        let Some(hiding) = Hiding::new(occluder, job.volume()) else { continue };
        let values = Values::new(job, grid, plane, &hiding);
        for (i, stored) in out.values_mut().iter_mut().enumerate() {
            let texel = corners(plane, i as u32 % w, i as u32 / w);
            if hiding.hides(&texel) {
                *stored = (*stored).max(values.at(&texel));
            }
        }
    }
}

/// The corners of a texel, once around.
fn corners(plane: &BufferPlane, x: u32, y: u32) -> [Point3; 4] {
    [[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]].map(|[x, y]| plane.corner(x, y))
}

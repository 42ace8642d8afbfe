//! The coordinates of a job as integers.

use sightlines_exact::{BigInt, Grid};
use sightlines_multifocal::BufferJob;

/// A point or a vector in steps of a job's grid.
pub(super) type Integer3 = [BigInt; 3];

/// The grid of all coordinates of a job, and of its unit.
pub(super) fn grid_of(job: &BufferJob<'_>) -> Grid {
    let planes = job.planes().iter().flat_map(|p| {
        let ([a, b], [c, d]) = (p.origin(), p.step());
        [p.at(), a, b, c, d]
    });
    let points = job.occluders().iter().flat_map(|o| o.outline().iter().chain(o.facets().iter().flatten()));
    let bounds = job.occluders().iter().map(|o| o.bounds()).chain([job.volume().bounds()]);
    let corners = bounds.flat_map(|b| b.min.into_iter().chain(b.max));
    let all = planes.chain(points.flatten().copied()).chain(corners).chain([job.unit()]);
    Grid::of(all).expect("a job has checked its coordinates")
}

//! A backend and its reference.

use super::scene::Scene;
use super::{Place, Report, Slack, Violation};
use crate::{Buffer, Job, Measure, MultifocalBackend};

/// The two backends that are compared.
pub(super) struct Pair<'a> {
    pub(super) backend: &'a mut dyn MultifocalBackend,
    pub(super) reference: &'a mut dyn MultifocalBackend,
    pub(super) slack: &'a Slack,
    pub(super) report: &'a mut Report,
}

impl Scene {
    pub(super) fn place(&self, measure: Measure, plane: usize, texel: [u32; 2]) -> Place {
        Place { family: self.family, seed: self.seed, round: self.round, measure, plane, texel }
    }
}

/// The buffers of a backend, checked for their shapes.
pub(super) fn render(
    backend: &mut dyn MultifocalBackend,
    scene: &Scene,
    job: &Job<'_>,
    mut out: Vec<Buffer>,
) -> Result<Vec<Buffer>, Violation> {
    let place = |plane: usize| scene.place(job.measure(), plane, [0, 0]);
    backend.render(job, &mut out).map_err(|error| Violation::Failed { place: place(0), error })?;
    let n_buffers = out.len();
    for (idx, plane) in job.planes().iter().enumerate() {
        let got = out.get(idx).map_or(0, |buffer| buffer.values().len());
        let fits = n_buffers == job.planes().len() && out[idx].texels() == plane.texels();
        if !fits {
            return Err(Violation::Shape { place: place(idx), got, n_buffers });
        }
    }
    Ok(out)
}

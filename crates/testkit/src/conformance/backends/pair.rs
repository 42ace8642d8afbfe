//! A backend and its reference on one scene.

use super::scene::Scene;
use super::{Clause, Report, Slack, Violation};
use sightlines_multifocal::{Buffer, Job, Measure, MultifocalBackend};
use std::fmt::Display;

/// The two backends that are compared.
pub(super) struct Pair<'a> {
    pub(super) backend: &'a mut dyn MultifocalBackend,
    pub(super) reference: &'a mut dyn MultifocalBackend,
    pub(super) slack: Slack,
    pub(super) report: &'a mut Report,
    pub(super) scene: &'a Scene,
    pub(super) measure: Measure,
}

impl Pair<'_> {
    pub(super) fn broken(
        &self,
        clause: Clause,
        (plane, [x, y]): (usize, [u32; 2]),
        expected: impl Display,
        found: impl Display,
    ) -> Violation {
        let (Scene { family, seed, round, .. }, measure) = (self.scene, self.measure.name());
        let case = format!("scene {family} {round} of seed {seed}, {measure}, plane {plane}, texel ({x}, {y})");
        self.report.broken(clause, case, expected, found)
    }

    /// The buffers of the backend.
    pub(super) fn own(&mut self, job: &Job<'_>, mut out: Vec<Buffer>) -> Result<Vec<Buffer>, Violation> {
        let done = self.backend.render(job, &mut out);
        done.map_err(|error| self.broken(Clause::Done, (0, [0; 2]), "buffers", error))?;
        self.check_shapes(job, out)
    }

    /// Those of the reference.
    pub(super) fn exact(&mut self, job: &Job<'_>) -> Result<Vec<Buffer>, Violation> {
        let mut out = Vec::new();
        let done = self.reference.render(job, &mut out);
        done.map_err(|error| self.broken(Clause::Done, (0, [0; 2]), "buffers of the reference", error))?;
        self.check_shapes(job, out)
    }

    fn check_shapes(&self, job: &Job<'_>, out: Vec<Buffer>) -> Result<Vec<Buffer>, Violation> {
        let shapes = |out: &[Buffer]| -> Vec<[u32; 2]> { out.iter().map(Buffer::texels).collect() };
        let wanted: Vec<[u32; 2]> = job.planes().iter().map(|plane| plane.texels()).collect();
        if shapes(&out) != wanted {
            let (wanted, found) = (format!("buffers of {wanted:?}"), format!("{:?}", shapes(&out)));
            return Err(self.broken(Clause::Complete, (0, [0; 2]), wanted, found));
        }
        Ok(out)
    }
}

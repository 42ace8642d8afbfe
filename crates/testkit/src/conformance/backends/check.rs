//! Whole jobs: sound, complete, repeatable.

use super::{Clause, Pair, Violation};
use sightlines_multifocal::{BackendError, Buffer, BufferJob};

/// The previous content of a buffer: of the right size, or of any other size and number.
fn used(job: &BufferJob<'_>, right_size: bool) -> Vec<Buffer> {
    let full = |texels: [u32; 2], value: u32| {
        let mut buffer = Buffer::default();
        buffer.reset(texels);
        buffer.values_mut().fill(value);
        buffer
    };
    if right_size {
        return job.planes().iter().map(|plane| full(plane.texels(), 0x0fff_fff0)).collect();
    }
    vec![full([31, 2], u32::MAX); job.planes().len() + 2]
}

impl Pair<'_> {
    /// All clauses, for one scene and one measure.
    pub(super) fn compare(&mut self) -> Result<(), Violation> {
        if !self.backend.supports(self.measure) {
            return self.refuses();
        }
        self.compare_jobs()?;
        self.compare_single_occluders()
    }

    /// Clauses 1, 3 and 4, and 2 for carried planes.
    fn compare_jobs(&mut self) -> Result<(), Violation> {
        let job = self.scene.job(self.measure);
        let got = self.own(&job, Vec::new())?;
        let again = self.own(&job, Vec::new())?;
        self.all(Clause::Repeatable, [&got, &again], |first, second| first == second)?;
        // Every other pair of scenes, so that both happen with carried planes and without.
        let reused = self.own(&job, used(&job, (self.scene.round / 2).is_multiple_of(2)))?;
        self.all(Clause::Complete, [&got, &reused], |fresh, reused| fresh == reused)?;
        let exact = self.exact(&job)?;
        self.all(Clause::Sound, [&exact, &got], |exact, got| got <= exact)?;
        let mut count = |what: &str, buffers: &[Buffer], n: fn(&Buffer) -> usize| {
            self.report.count(what, buffers.iter().map(n).sum());
        };
        count("texels", &got, |b| b.values().len());
        count("blocked texels", &exact, Buffer::n_blocked);
        count("blocked texels found", &got, Buffer::n_blocked);
        self.report.count("jobs", 3);
        if job.carry() { self.compare_carried(&job, &got) } else { Ok(()) }
    }

    /// Whether `fits` is true of all texels of expected and found buffers.
    fn all(&self, clause: Clause, [a, b]: [&[Buffer]; 2], fits: fn(u32, u32) -> bool) -> Result<(), Violation> {
        for (plane, (a, b)) in a.iter().zip(b).enumerate() {
            if let Some(i) = a.values().iter().zip(b.values()).position(|(&a, &b)| !fits(a, b)) {
                return Err(self.broken(clause, [plane, i], a.values()[i], b.values()[i]));
            }
        }
        Ok(())
    }

    /// A measure that is not supported must be refused.
    fn refuses(&mut self) -> Result<(), Violation> {
        self.report.count("measures not supported", 1);
        match self.backend.render(&self.scene.job(self.measure), &mut Vec::new()) {
            Err(BackendError::Unsupported { .. }) => Ok(()),
            other => Err(self.broken(Clause::Done, [0; 2], "'unsupported'", format_args!("{other:?}"))),
        }
    }
}

//! Somebody who takes over.

use sightlines_multifocal::{BackendError, Buffer, Job, Measure, MultifocalBackend};

/// A backend, and another one that does its jobs once it has failed: the one on a device, and one on the processor.
///
/// A job that the first cannot do (no form of the measure, no memory for it) is done by the second, and the first is
/// asked again for the next one. A device that is lost stays lost, so then the second does all that follow.
#[derive(Debug)]
pub struct WithFallback<A, B> {
    first: A,
    second: B,
    took_over: Option<BackendError>,
}

impl<A: MultifocalBackend, B: MultifocalBackend> WithFallback<A, B> {
    /// Asks `first` as long as it can be asked, else `second`.
    pub const fn new(first: A, second: B) -> Self {
        Self { first, second, took_over: None }
    }

    /// Why the second did the last job; None if the first did.
    pub const fn took_over(&self) -> Option<&BackendError> {
        self.took_over.as_ref()
    }
}

impl<A: MultifocalBackend, B: MultifocalBackend> MultifocalBackend for WithFallback<A, B> {
    fn name(&self) -> &'static str {
        if self.took_over.is_some() { self.second.name() } else { self.first.name() }
    }

    fn supports(&self, measure: Measure) -> bool {
        self.first.supports(measure) || self.second.supports(measure)
    }

    fn render(&mut self, job: &Job<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        if !matches!(self.took_over, Some(BackendError::Lost { .. })) {
            self.took_over = self.first.render(job, out).err();
        }
        if self.took_over.is_some() { self.second.render(job, out) } else { Ok(()) }
    }
}

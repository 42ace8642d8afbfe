//! A backend with another one that takes over its jobs.

use crate::{BackendError, Buffer, BufferJob, Measure, MultifocalBackend};

/// Two backends: the second does the jobs that the first refuses, for example one on a device and one on the processor.
///
/// The first is tried again for the next job, unless its device is lost: then the second does all that follow.
#[derive(Debug)]
pub struct WithFallback<A, B> {
    first: A,
    second: B,
    took_over: Option<BackendError>,
}

impl<A: MultifocalBackend, B: MultifocalBackend> WithFallback<A, B> {
    /// Tries `first`, then `second`.
    pub const fn new(first: A, second: B) -> Self {
        Self { first, second, took_over: None }
    }

    /// The error of the first backend, if the second did the last job.
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

    fn render(&mut self, job: &BufferJob<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        if !matches!(self.took_over, Some(BackendError::Lost { .. })) {
            self.took_over = self.first.render(job, out).err();
        }
        if self.took_over.is_some() { self.second.render(job, out) } else { Ok(()) }
    }
}

/// Fills the buffers of one job by the first backend that does it, and names that one.
///
/// * `refused`: takes the error of each backend before it
///
/// # Errors
/// That of the last backend.
///
/// # Panics
/// If there is none.
pub fn render_by_first(
    backends: Vec<Box<dyn MultifocalBackend>>,
    job: &BufferJob<'_>,
    out: &mut Vec<Buffer>,
    mut refused: impl FnMut(BackendError),
) -> Result<&'static str, BackendError> {
    let last = backends.len().checked_sub(1).expect("there is always a backend");
    for (k, mut backend) in backends.into_iter().enumerate() {
        match backend.render(job, out) {
            Ok(()) => return Ok(backend.name()),
            Err(error) if k == last => return Err(error),
            Err(error) => refused(error),
        }
    }
    unreachable!("the last backend answers")
}

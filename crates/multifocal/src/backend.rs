//! The contract of backends, which fill buffers.

use crate::{Buffer, BufferJob, Measure};
use std::fmt;

/// Why a backend did not do a job.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BackendError {
    /// It does not support this measure.
    #[error("{backend} cannot measure {}", .measure.name())]
    Unsupported {
        /// Its name.
        backend: &'static str,
        /// The requested measure.
        measure: Measure,
    },
    /// The device has no room for the job.
    #[error("{backend} is out of memory: {needed} bytes are needed, {offered} are offered")]
    OutOfMemory {
        /// Its name.
        backend: &'static str,
        /// Bytes of the largest buffer of the job.
        needed: u64,
        /// Bytes that the device offers.
        offered: u64,
    },
    /// The device is gone; every later job fails too.
    #[error("the device of {backend} is lost: {reason}")]
    Lost {
        /// Its name.
        backend: &'static str,
        /// The message of the driver.
        reason: String,
    },
    /// The driver refused something that should have worked.
    #[error("the device of {backend} failed: {reason}")]
    Device {
        /// Its name.
        backend: &'static str,
        /// The message of the driver.
        reason: String,
    },
}

/// Fills the multifocal buffers of a job, one for each plane.
///
/// The guarantees of every implementation, checked by `conformance::Backends` in `crates/testkit` of the repository:
/// 1. sound: a stored value never exceeds the exact one at any point of its texel;
/// 2. tight: where one occluder blocks the whole bundle with room to spare, the texel is blocked, and its value is
///    within the stated slack;
/// 3. complete: every texel of every plane is written, whatever was in the buffer before;
/// 4. repeatable: same job, same bits.
pub trait MultifocalBackend: fmt::Debug + Send {
    /// Stable lower-case name for test titles and charts, such as `"cpu-reference"`.
    fn name(&self) -> &'static str;

    /// Whether it supports `measure`.
    fn supports(&self, measure: Measure) -> bool;

    /// Fills `out`, one buffer for each plane of the job; resizes it to fit. After an error its content is
    /// unspecified.
    ///
    /// # Errors
    /// [`BackendError`]
    fn render(&mut self, job: &BufferJob<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError>;
}

impl<B: MultifocalBackend + ?Sized> MultifocalBackend for Box<B> {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn supports(&self, measure: Measure) -> bool {
        (**self).supports(measure)
    }

    fn render(&mut self, job: &BufferJob<'_>, out: &mut Vec<Buffer>) -> Result<(), BackendError> {
        (**self).render(job, out)
    }
}

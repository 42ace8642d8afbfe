//! The store of a job for a work that names its key late.

use super::{JobError, JobStore};
use crate::inputs::Identity;
use std::sync::OnceLock;

/// Opens a job for a work, once.
#[derive(Debug, Default)]
pub struct JobSlot(OnceLock<JobStore>);

impl JobSlot {
    /// The store, if it was opened.
    pub fn store(&self) -> Option<&JobStore> {
        self.0.get()
    }

    /// Takes the store that `open` opens.
    ///
    /// # Errors
    /// Those of `open`, and [`JobError::OtherWork`] for a job with another key than the work.
    pub fn open(
        &self,
        identity: &Identity,
        open: impl FnOnce() -> Result<JobStore, JobError>,
    ) -> Result<&JobStore, JobError> {
        let store = open()?;
        let job = store.job();
        if job.key() != identity.key() {
            return Err(JobError::OtherWork(job.folder().to_owned()));
        }
        Ok(self.0.get_or_init(|| store))
    }
}
